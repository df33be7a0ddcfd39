/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The elementary functions against libm's double ones: test_elementary [--all]. With --all each float is tried.

#include "elmopp/elementary.h"
#include "unity.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define ERROR_BOUND 1.5e-7
#define TANH_ERROR_BOUND 4.5e-7
#define SIGMOID_ERROR_BOUND 3.0e-7
#define INVERSE_ROOT_ERROR_BOUND 5.0e-6
#ifndef SAMPLE_STRIDE /* larger on the emulated board */
#define SAMPLE_STRIDE 64U
#endif
#define SIGN_BIT 0x80000000U

static uint32_t stride = SAMPLE_STRIDE;

void setUp(void) {}
void tearDown(void) {}

static float float_of(uint32_t bits) {
    float value;
    (void)memcpy(&value, &bits, sizeof value);
    return value;
}

static uint32_t bits_of(float value) {
    uint32_t bits;
    (void)memcpy(&bits, &value, sizeof bits);
    return bits;
}

static double relative_error(float x) {
    const double right = exp((double)x);
    return fabs((double)elmopp_exp(x) - right) / right;
}

typedef double (*error_fn_t)(float x);

/* Walks away from zero, so that neighbours in bits are neighbours in value. Negated so that a NaN fails. */
static void check_bound_between_zero_and(float end, error_fn_t error_of, double bound) {
    const uint32_t sign = bits_of(end) & SIGN_BIT;
    const uint32_t last = bits_of(end) & ~SIGN_BIT;
    uint32_t worst_bits = sign;
    double worst = 0.0;
    for (uint32_t bits = 0U; bits <= last; bits += stride) {
        const double error = error_of(float_of(sign | bits));
        if (!(error <= worst)) {
            worst = error;
            worst_bits = sign | bits;
        }
    }
    char message[120];
    (void)snprintf(message, sizeof message, "worst error %.3g at %.9g", worst, (double)float_of(worst_bits));
    TEST_ASSERT_TRUE_MESSAGE(worst <= bound, message);
    TEST_ASSERT_TRUE_MESSAGE(error_of(end) <= bound, "at the end of the range");
}

static void test_error_is_within_the_claim_for_negative_arguments(void) {
    check_bound_between_zero_and(ELMOPP_EXP_MIN, relative_error, ERROR_BOUND);
}

static void test_error_is_within_the_claim_for_positive_arguments(void) {
    check_bound_between_zero_and(ELMOPP_EXP_MAX, relative_error, ERROR_BOUND);
}

static void test_exp_of_zero_is_exactly_one(void) {
    TEST_ASSERT_EQUAL_HEX32(bits_of(1.0F), bits_of(elmopp_exp(0.0F)));
    TEST_ASSERT_EQUAL_HEX32(bits_of(1.0F), bits_of(elmopp_exp(-0.0F)));
}

static void test_arguments_beyond_the_range_are_taken_as_its_ends(void) {
    const uint32_t low = bits_of(elmopp_exp(ELMOPP_EXP_MIN));
    const uint32_t high = bits_of(elmopp_exp(ELMOPP_EXP_MAX));
    TEST_ASSERT_EQUAL_HEX32(low, bits_of(elmopp_exp(nextafterf(ELMOPP_EXP_MIN, -INFINITY))));
    TEST_ASSERT_EQUAL_HEX32(low, bits_of(elmopp_exp(-1.0e30F)));
    TEST_ASSERT_EQUAL_HEX32(low, bits_of(elmopp_exp(-INFINITY)));
    TEST_ASSERT_EQUAL_HEX32(high, bits_of(elmopp_exp(nextafterf(ELMOPP_EXP_MAX, INFINITY))));
    TEST_ASSERT_EQUAL_HEX32(high, bits_of(elmopp_exp(1.0e30F)));
    TEST_ASSERT_EQUAL_HEX32(high, bits_of(elmopp_exp(INFINITY)));
}

static void test_arguments_just_inside_the_range_are_not_cut(void) {
    TEST_ASSERT_TRUE(elmopp_exp(-86.999F) > elmopp_exp(ELMOPP_EXP_MIN));
    TEST_ASSERT_TRUE(elmopp_exp(87.999F) < elmopp_exp(ELMOPP_EXP_MAX));
}

static void test_the_ends_are_finite_normal_and_above_zero(void) {
    TEST_ASSERT_TRUE(isnormal(elmopp_exp(ELMOPP_EXP_MIN)));
    TEST_ASSERT_TRUE(isnormal(elmopp_exp(ELMOPP_EXP_MAX)));
    TEST_ASSERT_TRUE(elmopp_exp(ELMOPP_EXP_MIN) > 0.0F);
}

static void test_nan_is_taken_as_the_lower_end(void) {
    TEST_ASSERT_EQUAL_HEX32(bits_of(elmopp_exp(ELMOPP_EXP_MIN)), bits_of(elmopp_exp(NAN)));
    TEST_ASSERT_EQUAL_HEX32(bits_of(elmopp_exp(ELMOPP_EXP_MIN)), bits_of(elmopp_exp(-NAN)));
}

/* Subnormal numbers are beyond the claim. */
static double inverse_root_error(float x) {
    const double right = 1.0 / sqrt((double)x);
    return isnormal(x) ? fabs(((double)elmopp_inverse_root(x) / right) - 1.0) : 0.0;
}

static void test_the_inverse_root_is_within_its_claim_for_every_normal_number(void) {
    check_bound_between_zero_and(3.4e38F, inverse_root_error, INVERSE_ROOT_ERROR_BOUND);
    TEST_ASSERT_TRUE(isfinite(elmopp_inverse_root(0.0F)));
}

/* A grid of 1/64, on which e^x grows by 1.6 % a step: far above the error, also where the reduction changes its n. */
static void test_it_grows_over_a_grid(void) {
    for (int32_t i = -87 * 64; i < 88 * 64; i++) {
        const float x = (float)i / 64.0F;
        if (!(elmopp_exp(x + (1.0F / 64.0F)) > elmopp_exp(x))) {
            char message[60];
            (void)snprintf(message, sizeof message, "not above its left neighbour: %.9g", (double)x);
            TEST_FAIL_MESSAGE(message);
        }
    }
}

/* A result beyond +-1, or of another sign than its mirror image, counts as an error of 1. */
static double tanh_error(float x) {
    const float result = elmopp_tanh(x);
    if (!(fabsf(result) <= 1.0F) || (bits_of(elmopp_tanh(-x)) != (bits_of(result) ^ SIGN_BIT))) {
        return 1.0;
    }
    const double right = tanh((double)x);
    const double apart = fabs((double)result - right);
    if (fabsf(x) < 1.2e-38F) {
        return (apart <= 3.0e-45) ? 0.0 : 1.0; /* among subnormal numbers a step is large: two of them are allowed */
    }
    return apart / fabs(right);
}

static double sigmoid_error(float x) {
    const float result = elmopp_sigmoid(x);
    return ((result >= 0.0F) && (result <= 1.0F)) ? fabs((double)result - (1.0 / (1.0 + exp(-(double)x)))) : 1.0;
}

static void test_tanh_is_within_the_claim_odd_and_never_above_one(void) {
    check_bound_between_zero_and(3.0e38F, tanh_error, TANH_ERROR_BOUND);
    TEST_ASSERT_TRUE(tanh_error(INFINITY) <= TANH_ERROR_BOUND);
}

static void test_sigmoid_is_within_the_claim_and_between_zero_and_one(void) {
    check_bound_between_zero_and(3.0e38F, sigmoid_error, SIGMOID_ERROR_BOUND);
    check_bound_between_zero_and(-3.0e38F, sigmoid_error, SIGMOID_ERROR_BOUND);
    TEST_ASSERT_TRUE(sigmoid_error(INFINITY) <= SIGMOID_ERROR_BOUND);
    TEST_ASSERT_TRUE(sigmoid_error(-INFINITY) <= SIGMOID_ERROR_BOUND);
}

static void test_tanh_and_sigmoid_of_zero_are_exact(void) {
    TEST_ASSERT_EQUAL_HEX32(bits_of(0.0F), bits_of(elmopp_tanh(0.0F)));
    TEST_ASSERT_EQUAL_HEX32(bits_of(-0.0F), bits_of(elmopp_tanh(-0.0F)));
    TEST_ASSERT_EQUAL_HEX32(bits_of(0.5F), bits_of(elmopp_sigmoid(0.0F)));
}

static void test_a_nan_is_taken_as_the_end_of_its_sign(void) {
    const float positive = float_of(0x7FC00000U);
    const float negative = float_of(0xFFC00000U);
    TEST_ASSERT_EQUAL_HEX32(bits_of(elmopp_tanh(ELMOPP_TANH_MAX)), bits_of(elmopp_tanh(positive)));
    TEST_ASSERT_EQUAL_HEX32(bits_of(elmopp_tanh(-ELMOPP_TANH_MAX)), bits_of(elmopp_tanh(negative)));
}

/* Lengths around those at which a compiler changes from several values at a time to one. */
static void test_each_is_the_same_to_the_bit_and_touches_no_neighbour(void) {
    float tanhs[40];
    float sigmoids[40];
    for (uint32_t count = 0U; count < 40U; count++) {
        for (uint32_t k = 0U; k < 40U; k++) {
            tanhs[k] = ((float)k - 17.3F) * 0.61F;
            sigmoids[k] = tanhs[k];
        }
        elmopp_tanh_each(tanhs, count);
        elmopp_sigmoid_each(sigmoids, count);
        for (uint32_t k = 0U; k < 40U; k++) {
            const float x = ((float)k - 17.3F) * 0.61F;
            TEST_ASSERT_EQUAL_HEX32(bits_of((k < count) ? elmopp_tanh(x) : x), bits_of(tanhs[k]));
            TEST_ASSERT_EQUAL_HEX32(bits_of((k < count) ? elmopp_sigmoid(x) : x), bits_of(sigmoids[k]));
        }
    }
}

/* 3, 5, 10: exact averages while the window of two fills, then half of each new value. */
static void test_an_average_is_exact_until_its_window_is_full(void) {
    float mean = 99.0F;
    elmopp_average(&mean, 3.0F, 1U, 2U);
    TEST_ASSERT_EQUAL_FLOAT(3.0F, mean);
    elmopp_average(&mean, 5.0F, 2U, 2U);
    TEST_ASSERT_EQUAL_FLOAT(4.0F, mean);
    elmopp_average(&mean, 10.0F, 3U, 2U);
    TEST_ASSERT_EQUAL_FLOAT(7.0F, mean);
    elmopp_average(&mean, 7.0F, UINT32_MAX, 2U);
    TEST_ASSERT_EQUAL_FLOAT(7.0F, mean);
}

int main(int argc, char **argv) {
    if ((argc == 2) && (strcmp(argv[1], "--all") == 0)) {
        stride = 1U;
    } else if (argc != 1) {
        (void)fprintf(stderr, "usage: test_elementary [--all]\n");
        return 2;
    }
    UNITY_BEGIN();
    RUN_TEST(test_error_is_within_the_claim_for_negative_arguments);
    RUN_TEST(test_error_is_within_the_claim_for_positive_arguments);
    RUN_TEST(test_exp_of_zero_is_exactly_one);
    RUN_TEST(test_arguments_beyond_the_range_are_taken_as_its_ends);
    RUN_TEST(test_arguments_just_inside_the_range_are_not_cut);
    RUN_TEST(test_the_ends_are_finite_normal_and_above_zero);
    RUN_TEST(test_nan_is_taken_as_the_lower_end);
    RUN_TEST(test_the_inverse_root_is_within_its_claim_for_every_normal_number);
    RUN_TEST(test_it_grows_over_a_grid);
    RUN_TEST(test_an_average_is_exact_until_its_window_is_full);
    RUN_TEST(test_tanh_is_within_the_claim_odd_and_never_above_one);
    RUN_TEST(test_sigmoid_is_within_the_claim_and_between_zero_and_one);
    RUN_TEST(test_tanh_and_sigmoid_of_zero_are_exact);
    RUN_TEST(test_a_nan_is_taken_as_the_end_of_its_sign);
    RUN_TEST(test_each_is_the_same_to_the_bit_and_touches_no_neighbour);
    return UNITY_END();
}
