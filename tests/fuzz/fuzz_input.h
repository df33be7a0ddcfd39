/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// What a fuzz target reads its bytes with, and how it says that something is wrong: by aborting, which libFuzzer turns
/// into a file with the bytes that did it.

#ifndef ELMOPP_FUZZ_INPUT_H
#define ELMOPP_FUZZ_INPUT_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#define FUZZ_CHECK(condition)                                                                                          \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            (void)fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition);                              \
            abort();                                                                                                   \
        }                                                                                                              \
    } while (0)

/// The bytes that are left.
typedef struct {
    const uint8_t *at;
    size_t left;
} fuzz_input_t;

/// The next byte; 0 when none is left.
static inline uint8_t fuzz_byte(fuzz_input_t *input) {
    uint8_t byte = 0U;
    if (input->left > 0U) {
        byte = *input->at;
        input->at++;
        input->left--;
    }
    return byte;
}

static inline uint16_t fuzz_two_bytes(fuzz_input_t *input) {
    const uint32_t low = fuzz_byte(input);
    return (uint16_t)(low | ((uint32_t)fuzz_byte(input) << 8U));
}

/// Changes bytes of `body` at places that the input names, until it is used up: one change is a place and a byte.
static inline void fuzz_change(fuzz_input_t *input, uint8_t *body, size_t length) {
    while (input->left >= 3U) {
        const size_t place = fuzz_two_bytes(input) % length;
        body[place] = fuzz_byte(input);
    }
}

/// What a target does with its bytes.
void fuzz_try(fuzz_input_t *input);

#endif
