/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/elementary.h"

#include <stdint.h>
#include <string.h>

/* ln 2 in two parts (Cody and Waite): the first has so few bits that n * LN2_HIGH is exact for |n| <= 128. */
#define LN2_HIGH 0.693359375F
#define LN2_LOW (-2.12194440e-4F)
#define LOG2_E 1.44269504F
#define EXPONENT_BIAS 127
#define MANTISSA_BITS 23U

/* 2^n for a normal result: the exponent field is all there is. */
static float power_of_two(int32_t n) {
    const int32_t exponent = n + EXPONENT_BIAS;
    const uint32_t bits = (uint32_t)exponent << MANTISSA_BITS;
    float result;
    (void)memcpy(&result, &bits, sizeof result);
    return result;
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
