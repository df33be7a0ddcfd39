/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Dense: rows of weights times inputs, summed column by column, as the networks want it outside their kernels. There
/// is no source file: a compiler makes it part of whoever sums.
///
/// Every sum runs over its inputs in index order, products and sums rounded separately: the same bits everywhere. It
/// knows no network and no traffic; arrays belong to the caller. No allocation.

#ifndef ELMOPP_DENSE_H
#define ELMOPP_DENSE_H

#include <stdint.h>

#define ELMOPP_DENSE_UNITS 16U ///< columns of a hidden layer

#define ELMOPP_DENSE_AT_ONCE 4U      ///< columns that are summed at once ...
#define ELMOPP_DENSE_ROWS_AT_ONCE 2U ///< ... and rows: inputs are a multiple of them

/// Four columns of the sums, from `column` on, in locals: gcc keeps an array in memory on a Cortex-M4, and makes one
/// vector of four on a host.
static inline void elmopp_dense_add_four(const float (*row)[ELMOPP_DENSE_UNITS], const float *input, uint32_t count,
                                         uint32_t column, float sum[ELMOPP_DENSE_UNITS]) {
    float a = sum[column];
    float b = sum[column + 1U];
    float c = sum[column + 2U];
    float d = sum[column + 3U];
    for (uint32_t k = 0U; k < count; k += ELMOPP_DENSE_ROWS_AT_ONCE) {
        const float *first = &row[k][column];
        const float *second = &row[k + 1U][column];
        const float one = input[k];
        const float other = input[k + 1U];
        a = (a + (first[0] * one)) + (second[0] * other);
        b = (b + (first[1] * one)) + (second[1] * other);
        c = (c + (first[2] * one)) + (second[2] * other);
        d = (d + (first[3] * one)) + (second[3] * other);
    }
    sum[column] = a;
    sum[column + 1U] = b;
    sum[column + 2U] = c;
    sum[column + 3U] = d;
}

/// Adds `count` rows, each times its input, to a hidden layer's sums.
static inline void elmopp_dense_add(const float (*row)[ELMOPP_DENSE_UNITS], const float *input, uint32_t count,
                                    float sum[ELMOPP_DENSE_UNITS]) {
    for (uint32_t column = 0U; column < ELMOPP_DENSE_UNITS; column += ELMOPP_DENSE_AT_ONCE) {
        elmopp_dense_add_four(row, input, count, column, sum);
    }
}

/// The same of two layers with the same weights, four columns: a weight is loaded once for both.
static inline void elmopp_dense_add_four_twice(const float (*row)[ELMOPP_DENSE_UNITS], const float *one_input,
                                               const float *other_input, uint32_t count, uint32_t column,
                                               float one_sum[ELMOPP_DENSE_UNITS], float other_sum[ELMOPP_DENSE_UNITS]) {
    float a = one_sum[column];
    float b = one_sum[column + 1U];
    float c = one_sum[column + 2U];
    float d = one_sum[column + 3U];
    float e = other_sum[column];
    float f = other_sum[column + 1U];
    float g = other_sum[column + 2U];
    float h = other_sum[column + 3U];
    for (uint32_t k = 0U; k < count; k++) {
        const float *weight = &row[k][column];
        const float one = one_input[k];
        const float other = other_input[k];
        a += weight[0] * one;
        b += weight[1] * one;
        c += weight[2] * one;
        d += weight[3] * one;
        e += weight[0] * other;
        f += weight[1] * other;
        g += weight[2] * other;
        h += weight[3] * other;
    }
    one_sum[column] = a;
    one_sum[column + 1U] = b;
    one_sum[column + 2U] = c;
    one_sum[column + 3U] = d;
    other_sum[column] = e;
    other_sum[column + 1U] = f;
    other_sum[column + 2U] = g;
    other_sum[column + 3U] = h;
}

/// elmopp_dense_add() for two layers with the same weights.
static inline void elmopp_dense_add_twice(const float (*row)[ELMOPP_DENSE_UNITS], const float *one_input,
                                          const float *other_input, uint32_t count, float one_sum[ELMOPP_DENSE_UNITS],
                                          float other_sum[ELMOPP_DENSE_UNITS]) {
    for (uint32_t column = 0U; column < ELMOPP_DENSE_UNITS; column += ELMOPP_DENSE_AT_ONCE) {
        elmopp_dense_add_four_twice(row, one_input, other_input, count, column, one_sum, other_sum);
    }
}

#endif
