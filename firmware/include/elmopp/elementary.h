/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Elementary functions, our own, because results must be the same bits on every target and libm's are not.
///
/// Only IEEE 754 single-precision additions, multiplications and divisions in a fixed order (build: -ffp-contract=off),
/// no table, no libm. tanh, sigmoid and the inverse root take the same number of instructions for every argument
/// (tests/board/test_lstm_count.c).

#ifndef ELMOPP_ELEMENTARY_H
#define ELMOPP_ELEMENTARY_H

#include <stdint.h>
#include <string.h>

/// Arguments beyond these are taken as these, so that the result is always finite and above zero.
#define ELMOPP_EXP_MIN (-87.0F)
#define ELMOPP_EXP_MAX 88.0F

/// e^x. Relative error at most 1.5e-7 for every float in [-87, 88] (tests/test_elementary.c tries each 64th of them,
/// and --all each one). A NaN is taken as ELMOPP_EXP_MIN.
float elmopp_exp(float x);

/// Arguments of tanh beyond +-this are taken as these: tanh(7.9) is 1 - 2.8e-7, and no result is above 1.
#define ELMOPP_TANH_MAX 7.9F

/// tanh x. Relative error at most 4.5e-7 for every float of at least 1.2e-38 in size (below, at most two steps of the
/// subnormal numbers), odd to the bit, never above 1 in size; tests/test_elementary.c tries them as for elmopp_exp(). A
/// NaN is taken as ELMOPP_TANH_MAX with the NaN's sign.
float elmopp_tanh(float x);

/// 1 / (1 + e^-x) = 1/2 + tanh(x/2)/2. Absolute error at most 3e-7 for every float, always in [0, 1].
float elmopp_sigmoid(float x);

/// The same for `count` values in place, to the bit: a loop that a compiler can run several values at a time.
void elmopp_tanh_each(float *value, uint32_t count);
void elmopp_sigmoid_each(float *value, uint32_t count);

/// 1 / sqrt x for a normal x > 0: relative error at most 5e-6, by multiplications alone, for an optimizer that needs no
/// more. The same number of instructions for every argument; finite for 0.
float elmopp_inverse_root(float x);

/// The lesser and the greater of two, and a value held between two bounds (low <= high). Here for the choosers, which
/// call them thousands of times a decision. Of a NaN they make `other`, and `low`.
static inline float elmopp_lesser(float one, float other) {
    return (one < other) ? one : other;
}
static inline float elmopp_greater(float one, float other) {
    return (one > other) ? one : other;
}
static inline float elmopp_within(float value, float low, float high) {
    return (value > low) ? elmopp_lesser(value, high) : low;
}

/// The bits of a float, and the float of bits.
static inline uint32_t elmopp_bits_of(float x) {
    uint32_t bits;
    (void)memcpy(&bits, &x, sizeof bits);
    return bits;
}
static inline float elmopp_float_of(uint32_t bits) {
    float x;
    (void)memcpy(&x, &bits, sizeof x);
    return x;
}

/// The size of one number with the sign of another; a number held within +-limit (limit >= 0), a NaN taken as the limit
/// with the NaN's sign; and the larger of two sizes (>= 0), a NaN larger than all. By bits, which of one sign are in
/// their numbers' order: a comparison of floats may be a branch on a Cortex-M4.
static inline float elmopp_with_sign(float size, float sign) {
    return elmopp_float_of((elmopp_bits_of(size) & 0x7FFFFFFFU) | (elmopp_bits_of(sign) & 0x80000000U));
}
static inline float elmopp_bounded(float x, float limit) {
    const uint32_t bits = elmopp_bits_of(x);
    const uint32_t limit_bits = elmopp_bits_of(limit);
    const uint32_t size = bits & 0x7FFFFFFFU;
    return elmopp_float_of((bits & 0x80000000U) | ((size < limit_bits) ? size : limit_bits));
}
static inline float elmopp_larger(float one, float other) {
    const uint32_t one_bits = elmopp_bits_of(one);
    const uint32_t other_bits = elmopp_bits_of(other);
    return elmopp_float_of((one_bits > other_bits) ? one_bits : other_bits);
}

/// A running mean takes its `seen`-th value (from 1): weighted by 1 / min(seen, window), which is the exact average
/// until the window is full and an exponential one after it. No ring of values is needed.
void elmopp_average(float *mean, float value, uint32_t seen, uint32_t window);

#endif
