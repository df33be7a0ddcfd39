/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "stack_guard.h"

#include <stdint.h>

#define MPU_CONTROL (*(volatile uint32_t *)0xE000ED94U)
#define MPU_NUMBER (*(volatile uint32_t *)0xE000ED98U)
#define MPU_BASE (*(volatile uint32_t *)0xE000ED9CU)
#define MPU_ATTRIBUTES (*(volatile uint32_t *)0xE000EDA0U)

#define NO_EXECUTION ((uint32_t)1U << 28U) /* and access 000: nobody */
#define SIZE_256 (7U << 1U)                /* 2 to the power of 7 + 1 */
#define ENABLE 1U
#define ELSE_AS_WITHOUT 4U /* PRIVDEFENA: the default map holds everywhere else */

extern const uint8_t elmopp_bss_end[]; /* from the linker script: the stack begins above */

void elmopp_stack_guard_start(void) {
    const uint32_t mask = ELMOPP_STACK_GUARD_BYTES - 1U;
    MPU_NUMBER = 0U;
    MPU_BASE = ((uint32_t)(uintptr_t)elmopp_bss_end + mask) & ~mask;
    MPU_ATTRIBUTES = NO_EXECUTION | SIZE_256 | ENABLE;
    MPU_CONTROL = ENABLE | ELSE_AS_WITHOUT;
    __asm__ volatile("dsb\n\tisb" : : : "memory");
}
