/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// In place of cortex_m/processor.h, for the port on this machine: what waits for an interrupt hands over to the test.

#ifndef ELMOPP_PROCESSOR_H
#define ELMOPP_PROCESSOR_H

#include <stdint.h>

void pretended_interrupts(int on);
void pretended_wait(void);
void pretended_enable(uint32_t number);
_Noreturn void pretended_reset(void);

static inline void elmopp_interrupts_off(void) {
    pretended_interrupts(0);
}

static inline void elmopp_interrupts_on(void) {
    pretended_interrupts(1);
}

static inline void elmopp_wait_for_interrupt(void) {
    pretended_wait();
}

static inline void elmopp_enable_interrupt(uint32_t number) {
    pretended_enable(number);
}

_Noreturn static inline void elmopp_processor_reset(void) {
    pretended_reset();
}

#endif
