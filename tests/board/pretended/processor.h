/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Stands for firmware/port/cortex_m/processor.h where a driver is tested without its processor: nobody interrupts, but
/// a test that calls the handler.

#ifndef ELMOPP_PROCESSOR_H
#define ELMOPP_PROCESSOR_H

static inline void elmopp_interrupts_off(void) {}
static inline void elmopp_interrupts_on(void) {}

#endif
