/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/elementary.h"

#include <stdint.h>

/* ln 2 in two parts (Cody and Waite): the first has so few bits that n * LN2_HIGH is exact for |n| <= 128. */
#define LN2_HIGH 0.693359375F
#define LN2_LOW (-2.12194440e-4F)
#define LOG2_E 1.44269504F
#define EXPONENT_BIAS 127
#define MANTISSA_BITS 23U

/* 2^n for a normal result: the exponent field is all there is. */
static float power_of_two(int32_t n) {
    const int32_t exponent = n + EXPONENT_BIAS;
    return elmopp_float_of((uint32_t)exponent << MANTISSA_BITS);
}

float elmopp_exp(float x) {
    float bounded = (x > ELMOPP_EXP_MIN) ? x : ELMOPP_EXP_MIN;
    bounded = (bounded < ELMOPP_EXP_MAX) ? bounded : ELMOPP_EXP_MAX;
    const float half = (bounded < 0.0F) ? -0.5F : 0.5F;
    const int32_t n = (int32_t)((bounded * LOG2_E) + half);
    const float steps = (float)n;
    const float r = (bounded - (steps * LN2_HIGH)) - (steps * LN2_LOW);
    /* Taylor about 0 is enough: |r| <= ln(2)/2, so the first term left out, r^8/8!, is below 6e-9. */
    float sum = 1.0F / 5040.0F;
    sum = (sum * r) + (1.0F / 720.0F);
    sum = (sum * r) + (1.0F / 120.0F);
    sum = (sum * r) + (1.0F / 24.0F);
    sum = (sum * r) + (1.0F / 6.0F);
    sum = (sum * r) + 0.5F;
    sum = (sum * r * r) + r;
    return (sum + 1.0F) * power_of_two(n);
}

void elmopp_average(float *mean, float value, uint32_t seen, uint32_t window) {
    const uint32_t weight = (seen < window) ? seen : window;
    *mean += (value - *mean) / (float)weight;
}

/* x P(x^2) / Q(x^2), P of degree 3 and Q of degree 4: the quotient with the least relative error on [0, 7.9], 1.3e-7
 * before rounding, found by weighted least squares (Lawson). Cut in pairs (Estrin), so that a processor can overlap
 * them. */
static inline float tanh_of(float x) {
    const float bounded = elmopp_bounded(x, ELMOPP_TANH_MAX);
    const float square = bounded * bounded;
    const float fourth = square * square;
    const float above =
        (((0x1.59c1p-16F * square) + 0x1.5aba82p-8F) * fourth) + ((0x1.d96592p-3F * square) + 0x1.c97f42p+0F);
    const float high = (0x1.de4a7ap-22F * fourth) + ((0x1.c1c2cp-12F * square) + 0x1.5d38bep-5F);
    const float below = (high * fourth) + ((0x1.a758a8p-1F * square) + 0x1.c97f46p+0F);
    return (above * bounded) / below;
}

static inline float sigmoid_of(float x) {
    return 0.5F + (0.5F * tanh_of(0.5F * x));
}

float elmopp_tanh(float x) {
    return tanh_of(x);
}

float elmopp_sigmoid(float x) {
    return sigmoid_of(x);
}

void elmopp_tanh_each(float *value, uint32_t count) {
    for (uint32_t k = 0U; k < count; k++) {
        value[k] = tanh_of(value[k]);
    }
}

void elmopp_sigmoid_each(float *value, uint32_t count) {
    for (uint32_t k = 0U; k < count; k++) {
        value[k] = sigmoid_of(value[k]);
    }
}

/* Half the exponent, negated, in whole numbers, and two steps of Newton (the constant and its 0.2 % are folklore). */
float elmopp_inverse_root(float x) {
    const float half = 0.5F * x;
    float root = elmopp_float_of(0x5F3759DFU - (elmopp_bits_of(x) >> 1U));
    root = root * (1.5F - ((half * root) * root));
    return root * (1.5F - ((half * root) * root));
}
