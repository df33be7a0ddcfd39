/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// SysTick: the processor's own timer as a clock of milliseconds (ARMv7-M Architecture Reference Manual, B3.3).

#ifndef ELMOPP_SYSTICK_H
#define ELMOPP_SYSTICK_H

#include <stdint.h>

/// Starts the clock at 0. Needs a processor clock of at most 16 GHz.
void elmopp_systick_start(uint32_t processor_hz);

/// Milliseconds since then; wraps.
uint32_t elmopp_systick_ms(void);

/// The handler, in the vector table.
void elmopp_systick_handler(void);

#endif
