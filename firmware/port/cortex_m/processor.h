/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Processor: the few instructions and registers of a Cortex-M that C has no words for (ARMv7-M ARM, B1.5, B3.2, B3.4).

#ifndef ELMOPP_PROCESSOR_H
#define ELMOPP_PROCESSOR_H

#include <stdint.h>

/// Nobody interrupts from here on.
static inline void elmopp_interrupts_off(void) {
    __asm__ volatile("cpsid i" : : : "memory");
}

static inline void elmopp_interrupts_on(void) {
    __asm__ volatile("cpsie i" : : : "memory");
}

/// Waits for an interrupt; returns also for one that is pending while they are off.
static inline void elmopp_wait_for_interrupt(void) {
    __asm__ volatile("dsb\n\twfi" : : : "memory");
}

/// Lets a device's interrupt through.
static inline void elmopp_enable_interrupt(uint32_t number) {
    volatile uint32_t *const set_enable = (volatile uint32_t *)0xE000E100U;
    set_enable[number / 32U] = (uint32_t)1U << (number % 32U);
}

/// The whole processor begins anew.
_Noreturn static inline void elmopp_processor_reset(void) {
    volatile uint32_t *const reset_control = (volatile uint32_t *)0xE000ED0CU; /* AIRCR */
    __asm__ volatile("dsb" : : : "memory");
    *reset_control = 0x05FA0004U; /* VECTKEY, SYSRESETREQ */
    for (;;) {
    }
}

#endif
