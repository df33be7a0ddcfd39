/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "memory_test.h"

#define ZEROS 0x00000000U
#define ONES 0xFFFFFFFFU

/* One element of the march: every word must hold `old` and gets `new`. The words are not copied, nor is a stack
   needed beyond the call's own: the caller's may lie in what another call tests. */
static bool march_up(volatile uint32_t *begin, const volatile uint32_t *end, uint32_t old, uint32_t new) {
    bool good = true;
    for (volatile uint32_t *word = begin; word < end; word++) {
        good = (*word == old) && good;
        *word = new;
    }
    return good;
}

static bool march_down(const volatile uint32_t *begin, volatile uint32_t *end, uint32_t old, uint32_t new) {
    bool good = true;
    for (volatile uint32_t *word = end; word > begin; word--) {
        good = (word[-1] == old) && good;
        word[-1] = new;
    }
    return good;
}

bool elmopp_memory_test(volatile uint32_t *begin, volatile uint32_t *end) {
    for (volatile uint32_t *word = begin; word < end; word++) {
        *word = ZEROS;
    }
    bool good = march_up(begin, end, ZEROS, ONES);
    good = march_up(begin, end, ONES, ZEROS) && good;
    good = march_down(begin, end, ZEROS, ONES) && good;
    good = march_down(begin, end, ONES, ZEROS) && good;
    return march_up(begin, end, ZEROS, ZEROS) && good;
}
