/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Register access: the one way in which this port reads and writes a peripheral.
///
/// Two functions, so that what is linked decides what answers: register_access.c the hardware, tests/stm32f4 a model of
/// it. Each call is exactly one 32-bit access, in program order. They decide nothing and never fail.

#ifndef ELMOPP_REGISTER_ACCESS_H
#define ELMOPP_REGISTER_ACCESS_H

#include <stdint.h>

/// A register of a peripheral, 32 bits wide.
typedef volatile uint32_t elmopp_register_t;

uint32_t elmopp_register_read(const elmopp_register_t *place);
void elmopp_register_write(elmopp_register_t *place, uint32_t value);

#endif
