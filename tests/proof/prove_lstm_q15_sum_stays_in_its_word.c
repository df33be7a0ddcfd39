/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Part 0, a product: any weight times anything fed is at most 2^15 times the weight's size.
///
/// Part 1, the accumulator. The next product of a row, of which this assumes what part 0 claims, added to any sum that
/// is at most 2^15 times the sizes of the weights before it: it is at most 2^15 times the sizes up to this one, and
/// nothing overflows while those are at most ELMOPP_LSTM_Q15_SUM_MAX, which elmopp_lstm_quantize() asserts of every
/// row. From a sum of 0, product by product, that is every row of any length. (Both in one harness take twelve times as
/// long.)
///
/// Part 2, the tables. Whatever a row has reached, to the ends of a word: the entry is inside the table, the line does
/// not overflow, and what comes of it is within what the table promises, so that products of two results stay in
/// theirs.

#include "claims.h"

#include "lstm_q15_kernel.c"

int16_t nondet_i16(void);
int32_t nondet_i32(void);

static int64_t size_of(int64_t value) {
    return (value < 0) ? -value : value;
}

#if PART < 2

void harness(void) {
    const int16_t weight = nondet_i16();
    const int16_t fed = nondet_i16();
    const int64_t most = size_of(weight) * 32768;
    const int64_t product = add_products(0, &weight, &fed, 1U);
    const bool is_bounded = size_of(product) <= most;
#if PART == 0
    CLAIM(is_bounded, "a product is bounded by the size of its weight");
#else
    const int32_t sum = nondet_i32();
    const int64_t before = nondet_u16();
    ASSUME(is_bounded && (size_of(sum) <= (before * 32768)));
    ASSUME((before + size_of(weight)) <= ELMOPP_LSTM_Q15_SUM_MAX);
    const int64_t result = add_products(sum, &weight, &fed, 1U);
    CLAIM(result == (sum + product), "a product is added as it is by itself");
    CLAIM(size_of(result) <= ((before * 32768) + most), "a sum is bounded by the sizes of its weights");
#endif
    REACHABLE();
}

#else

void harness(void) {
    const int32_t reach = nondet_i32();
    const int32_t sigmoid = activate(elmopp_lstm_q15_sigmoid, reach);
    const int32_t tanh = activate(elmopp_lstm_q15_tanh, reach);
    CLAIM(sigmoid >= 0, "a sigmoid is not negative");
    CLAIM(size_of(tanh) < (INT32_MAX - 32767), "a tanh leaves room for its product");
    REACHABLE();
}

#endif
