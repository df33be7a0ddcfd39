/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "systick.h"

#define SYSTICK_CONTROL (*(volatile uint32_t *)0xE000E010U)
#define SYSTICK_RELOAD (*(volatile uint32_t *)0xE000E014U)
#define SYSTICK_VALUE (*(volatile uint32_t *)0xE000E018U)
#define ENABLE 1U
#define INTERRUPT 2U
#define PROCESSOR_CLOCK 4U
#define MS_PER_S 1000U

static volatile uint32_t ms;

void elmopp_systick_start(uint32_t processor_hz) {
    ms = 0U;
    SYSTICK_RELOAD = (processor_hz / MS_PER_S) - 1U;
    SYSTICK_VALUE = 0U;
    SYSTICK_CONTROL = ENABLE | INTERRUPT | PROCESSOR_CLOCK;
}

uint32_t elmopp_systick_ms(void) {
    return ms;
}

void elmopp_systick_handler(void) {
    ms = ms + 1U;
}
