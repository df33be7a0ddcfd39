/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Whether a function in assembly keeps the registers that are its caller's: s16 to s31 and r4 to r11. To be included
/// once in a program.

#ifndef KEPT_REGISTERS_H
#define KEPT_REGISTERS_H

#include "unity.h"

#include <stdint.h>

#define KEPT 24U ///< s16 to s31, r4 to r11

/* A function with up to five arguments, and what the registers that it must keep hold before and after it. */
typedef struct {
    uintptr_t function;
    uintptr_t argument[5];
} call_t;

void call_and_record(const call_t *call, const uint32_t before[KEPT], uint32_t after[KEPT]);
__asm__(".thumb_func\ncall_and_record:\n\t"
        "push {r4-r11, lr}\n\tvpush {s16-s31}\n\tpush {r1-r3}\n\t"
        "vldmia r1!, {s16-s31}\n\tldm r1, {r4-r11}\n\t"
        "ldr r12, [r0]\n\tldr r3, [r0, #20]\n\tpush {r3, r12}\n\t"
        "ldr r1, [r0, #8]\n\tldr r2, [r0, #12]\n\tldr r3, [r0, #16]\n\tldr r0, [r0, #4]\n\tblx r12\n\t"
        "add sp, #8\n\tpop {r1-r3}\n\tvstmia r2!, {s16-s31}\n\tstmia r2, {r4-r11}\n\t"
        "vpop {s16-s31}\n\tpop {r4-r11, pc}");

static void expect_registers_kept(const call_t *call) {
    uint32_t before[KEPT];
    uint32_t after[KEPT] = {0U};
    for (uint32_t i = 0U; i < KEPT; i++) {
        before[i] = 0x3F000000U + (i * 0x01010101U);
    }
    call_and_record(call, before, after);
    TEST_ASSERT_EQUAL_HEX32_ARRAY(before, after, KEPT);
}

#endif
