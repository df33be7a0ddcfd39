/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Repeatable random numbers for property tests (SplitMix64).

#ifndef ELMOPP_TEST_RANDOM_H
#define ELMOPP_TEST_RANDOM_H

#include <stdint.h>

static inline uint64_t random_next(uint64_t *state) {
    *state += 0x9E3779B97F4A7C15ULL;
    uint64_t z = *state;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
}

/// 0 to `bound` - 1.
static inline uint32_t random_below(uint64_t *state, uint32_t bound) {
    return (uint32_t)((random_next(state) >> 32U) % bound);
}

/// `low` to `high`, both included.
static inline uint16_t random_between(uint64_t *state, uint32_t low, uint32_t high) {
    return (uint16_t)(low + random_below(state, (high - low) + 1U));
}

#endif
