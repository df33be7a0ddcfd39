/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// elmopp_ann_f32_next() against the equations of its header, worked out here in double for a few weights.
/// tests/python/test_window_reference.py does it for whole random networks, tests/python/test_bit_identity.py for the
/// bits.

#include "elmopp/ann_f32.h"
#include "unity.h"

#include <math.h>
#include <string.h>

#define INPUTS ELMOPP_ANN_INPUTS
#define WINDOW ELMOPP_ANN_WINDOW_S
#define TOLERANCE 1.0e-6

static elmopp_ann_f32_weights_t weights;
static float past[INPUTS][WINDOW];
static float next[INPUTS];

void setUp(void) {
    (void)memset(&weights, 0, sizeof weights);
    for (uint32_t i = 0U; i < INPUTS; i++) {
        for (uint32_t k = 0U; k < WINDOW; k++) {
            past[i][k] = (0.25F * (float)i) + (0.0625F * (float)k);
        }
    }
}
void tearDown(void) {}

static void say(void) {
    const float *const windows[INPUTS] = {past[0], past[1], past[2], past[3]};
    elmopp_ann_f32_next(&weights, windows, next);
}

static void test_without_weights_it_says_persistence(void) {
    say();
    for (uint32_t i = 0U; i < INPUTS; i++) {
        TEST_ASSERT_TRUE(next[i] == past[i][WINDOW - 1U]);
    }
}

static void test_the_bias_of_the_head_is_a_change_of_its_output_alone(void) {
    weights.head_bias[2] = 0.5F;
    say();
    TEST_ASSERT_TRUE(next[1] == past[1][WINDOW - 1U]);
    TEST_ASSERT_TRUE(next[2] == (past[2][WINDOW - 1U] + 0.5F));
}

/* One path through the network: a second of one input, a unit of each layer, an output. */
static void expect_path(uint32_t input, uint32_t second) {
    (void)memset(&weights, 0, sizeof weights);
    weights.first_row[(input * WINDOW) + second][3] = 0.75F;
    weights.first_bias[3] = 0.125F;
    weights.second_row[3][7] = -0.5F;
    weights.second_bias[7] = 0.25F;
    weights.head_row[7][1] = 2.0F;
    say();
    const double first = tanh((0.75 * (double)past[input][second]) + 0.125);
    const double second_unit = tanh((-0.5 * first) + 0.25);
    const double said = (double)past[1][WINDOW - 1U] + (2.0 * second_unit);
    TEST_ASSERT_TRUE(fabs((double)next[1] - said) < TOLERANCE);
    TEST_ASSERT_TRUE(next[0] == past[0][WINDOW - 1U]);
}

static void test_every_second_of_every_input_goes_its_way_through_both_layers(void) {
    for (uint32_t i = 0U; i < INPUTS; i++) {
        for (uint32_t k = 0U; k < WINDOW; k++) {
            expect_path(i, k);
        }
    }
}

/* Products and sums each rounded, from the bias on in index order: these three sum to 0 in any other order. */
static void test_a_sum_begins_with_the_bias_and_takes_its_inputs_in_order(void) {
    past[0][0] = 1.0F;
    past[3][WINDOW - 1U] = 1.0F;
    weights.first_bias[0] = 1.0F;
    weights.first_row[0][0] = 1.0e8F;
    weights.first_row[(INPUTS * WINDOW) - 1U][0] = -1.0e8F;
    weights.second_row[0][0] = 1.0F;
    weights.head_row[0][0] = 1.0F;
    say();
    TEST_ASSERT_TRUE(next[0] == past[0][WINDOW - 1U]); /* the 1 is lost beside 1e8 */
    past[0][0] = 0.0F;
    past[3][WINDOW - 1U] = 0.0F;
    say();
    TEST_ASSERT_FALSE(next[0] == past[0][WINDOW - 1U]);
}

static void test_saturated_units_stay_finite(void) {
    for (uint32_t k = 0U; k < (INPUTS * WINDOW); k++) {
        for (uint32_t r = 0U; r < ELMOPP_ANN_UNITS; r++) {
            weights.first_row[k][r] = 1000.0F;
        }
    }
    for (uint32_t r = 0U; r < ELMOPP_ANN_UNITS; r++) {
        weights.second_row[r][0] = 1000.0F;
    }
    weights.head_row[0][0] = 1.0F;
    past[0][0] = 1000.0F;
    say();
    TEST_ASSERT_TRUE(fabs((double)next[0] - ((double)past[0][WINDOW - 1U] + 1.0)) < 1.0e-5);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_without_weights_it_says_persistence);
    RUN_TEST(test_the_bias_of_the_head_is_a_change_of_its_output_alone);
    RUN_TEST(test_every_second_of_every_input_goes_its_way_through_both_layers);
    RUN_TEST(test_a_sum_begins_with_the_bias_and_takes_its_inputs_in_order);
    RUN_TEST(test_saturated_units_stay_finite);
    return UNITY_END();
}
