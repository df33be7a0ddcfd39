/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// elmopp_lstm_f32_step() and its head, against the equations of its header worked out here in double for a few
/// weights. tests/python/test_lstm_reference.py does it for whole random networks, tests/python/test_bit_identity.py
/// for the bits.

#include "assert_catcher.h"
#include "elmopp/lstm_f32.h"
#include "random.h"
#include "unity.h"

#include <math.h>
#include <string.h>

#define UNITS ELMOPP_LSTM_UNITS
#define GATES ELMOPP_LSTM_GATES
#define TOLERANCE 2.0e-6

static elmopp_lstm_f32_weights_t weights;
static elmopp_lstm_f32_state_t state;

void setUp(void) {
    (void)memset(&weights, 0, sizeof weights);
    (void)memset(&state, 0, sizeof state);
    weights.levels = 1U;
}
void tearDown(void) {}

static double sigmoid(double x) {
    return 1.0 / (1.0 + exp(-x));
}

static float between(uint64_t *random, float low, float high) {
    return low + ((high - low) * ((float)(random_next(random) >> 40U) / 16777216.0F));
}

static void fill(float *value, uint32_t count, uint64_t *random) {
    for (uint32_t k = 0U; k < count; k++) {
        value[k] = between(random, -0.6F, 0.6F);
    }
}

static void fill_weights(uint64_t seed) {
    uint64_t random = seed;
    fill(weights.head_bias, ELMOPP_LSTM_INPUTS, &random);
    fill(&weights.head_row[0][0], UNITS * ELMOPP_LSTM_INPUTS, &random);
    fill(weights.outer.bias, GATES, &random);
    fill(&weights.outer.row[0][0], ELMOPP_LSTM_OUTER_ROWS * GATES, &random);
    for (uint32_t level = 0U; level < (ELMOPP_LSTM_LEVELS_MAX - 1U); level++) {
        fill(weights.inner[level].bias, GATES, &random);
        fill(&weights.inner[level].row[0][0], ELMOPP_LSTM_INNER_ROWS * GATES, &random);
    }
}

static void step_with(float a, float b, float c, float d) {
    const float input[ELMOPP_LSTM_INPUTS] = {a, b, c, d};
    elmopp_lstm_f32_step(&weights, &state, input);
}

static void test_without_weights_half_of_the_cell_is_kept_and_nothing_comes_in(void) {
    for (uint32_t r = 0U; r < UNITS; r++) {
        state.cell[0][r] = (float)r;
    }
    step_with(1.0F, 2.0F, 3.0F, 4.0F);
    for (uint32_t r = 0U; r < UNITS; r++) {
        TEST_ASSERT_EQUAL_FLOAT(0.5F * (float)r, state.cell[0][r]);
        TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, 0.5 * tanh(0.5 * (double)r), (double)state.hidden[r]);
    }
}

/* Unit 3 alone: a different number for each gate says which column and which row is whose. */
static void test_every_gate_reads_its_own_column_and_every_row_its_own_input(void) {
    static const float bias[4] = {0.1F, -0.2F, 0.3F, -0.4F};
    static const float from_input[4] = {0.5F, -0.6F, 0.7F, 0.8F};
    static const float from_hidden[4] = {-0.9F, 1.0F, 1.1F, -1.2F};
    double sum[4];
    state.hidden[5] = 0.25F;
    state.cell[0][3] = -0.75F;
    for (uint32_t gate = 0U; gate < 4U; gate++) {
        const uint32_t column = (gate * UNITS) + 3U;
        weights.outer.bias[column] = bias[gate];
        weights.outer.row[2][column] = from_input[gate];
        weights.outer.row[ELMOPP_LSTM_INPUTS + 5U][column] = from_hidden[gate];
        sum[gate] = (double)bias[gate] + (1.5 * (double)from_input[gate]) + (0.25 * (double)from_hidden[gate]);
    }
    step_with(0.0F, 0.0F, 1.5F, 0.0F);
    const double cell = (sigmoid(sum[1]) * -0.75) + (sigmoid(sum[0]) * tanh(sum[3]));
    TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, cell, (double)state.cell[0][3]);
    TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, sigmoid(sum[2]) * tanh(cell), (double)state.hidden[3]);
}

static void test_the_head_is_linear_in_the_hidden_state(void) {
    weights.head_bias[1] = 0.5F;
    weights.head_row[7][1] = 2.0F;
    weights.head_row[15][1] = -3.0F;
    weights.head_row[15][2] = 4.0F;
    state.hidden[7] = 0.125F;
    state.hidden[15] = 0.25F;
    float output[ELMOPP_LSTM_INPUTS];
    elmopp_lstm_f32_output(&weights, &state, output);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, output[0]);
    TEST_ASSERT_EQUAL_FLOAT(0.5F + 0.25F - 0.75F, output[1]);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, output[2]);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, output[3]);
}

/* What one level makes of its input and hidden input, in double: gates by unit. */
static void gates_of(const float *bias, float (*row)[GATES], const double *fed, uint32_t rows, double gate[GATES]) {
    for (uint32_t r = 0U; r < GATES; r++) {
        double sum = (double)bias[r];
        for (uint32_t k = 0U; k < rows; k++) {
            sum += (double)row[k][r] * fed[k];
        }
        gate[r] = (r < (3U * UNITS)) ? sigmoid(sum) : tanh(sum);
    }
}

/* Two levels written out, not as a loop: x = i * g and h = f * c go in, the inner level's output is the outer cell. */
static void test_two_levels_are_the_nested_equations(void) {
    weights.levels = 2U;
    fill_weights(7U);
    double hidden[UNITS] = {0.0};
    double outer_cell[UNITS] = {0.0};
    double inner_cell[UNITS] = {0.0};
    uint64_t random = 11U;
    for (uint32_t t = 0U; t < 30U; t++) {
        double fed[ELMOPP_LSTM_INNER_ROWS];
        float input[ELMOPP_LSTM_INPUTS];
        fill(input, ELMOPP_LSTM_INPUTS, &random);
        for (uint32_t k = 0U; k < ELMOPP_LSTM_INPUTS; k++) {
            fed[k] = (double)input[k];
        }
        (void)memcpy(&fed[ELMOPP_LSTM_INPUTS], hidden, sizeof hidden);
        double outer[GATES];
        double inner[GATES];
        gates_of(weights.outer.bias, weights.outer.row, fed, ELMOPP_LSTM_OUTER_ROWS, outer);
        for (uint32_t r = 0U; r < UNITS; r++) {
            fed[r] = outer[r] * outer[(3U * UNITS) + r];
            fed[UNITS + r] = outer[UNITS + r] * outer_cell[r];
        }
        gates_of(weights.inner[0].bias, weights.inner[0].row, fed, ELMOPP_LSTM_INNER_ROWS, inner);
        for (uint32_t r = 0U; r < UNITS; r++) {
            inner_cell[r] = (inner[UNITS + r] * inner_cell[r]) + (inner[r] * inner[(3U * UNITS) + r]);
            outer_cell[r] = inner[(2U * UNITS) + r] * tanh(inner_cell[r]);
            hidden[r] = outer[(2U * UNITS) + r] * tanh(outer_cell[r]);
        }
        elmopp_lstm_f32_step(&weights, &state, input);
        for (uint32_t r = 0U; r < UNITS; r++) {
            TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, inner_cell[r], (double)state.cell[1][r]);
            TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, outer_cell[r], (double)state.cell[0][r]);
            TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, hidden[r], (double)state.hidden[r]);
        }
    }
}

/* Levels that do not exist neither matter nor change. */
static void test_unused_levels_are_left_alone(void) {
    for (uint32_t levels = 1U; levels < ELMOPP_LSTM_LEVELS_MAX; levels++) {
        fill_weights(3U);
        weights.levels = levels;
        (void)memset(&state, 0, sizeof state);
        step_with(0.5F, 1.0F, 0.0F, 2.0F);
        const elmopp_lstm_f32_state_t right = state;
        for (uint32_t level = levels; level < ELMOPP_LSTM_LEVELS_MAX; level++) {
            (void)memset(&weights.inner[level - 1U], 0x7F, sizeof weights.inner[0]);
            for (uint32_t r = 0U; r < UNITS; r++) {
                TEST_ASSERT_EQUAL_FLOAT(0.0F, state.cell[level][r]);
            }
        }
        (void)memset(&state, 0, sizeof state);
        step_with(0.5F, 1.0F, 0.0F, 2.0F);
        TEST_ASSERT_EQUAL_MEMORY(&right, &state, sizeof state);
    }
}

static void test_it_stays_finite_whatever_comes_in(void) {
    for (uint32_t levels = 1U; levels <= ELMOPP_LSTM_LEVELS_MAX; levels++) {
        fill_weights(5U);
        weights.levels = levels;
        for (uint32_t t = 0U; t < 200U; t++) {
            const float loud = ((t % 2U) == 0U) ? 1.0e6F : -1.0e6F;
            step_with(loud, -loud, loud, 0.0F);
            for (uint32_t r = 0U; r < UNITS; r++) {
                TEST_ASSERT_TRUE(fabsf(state.hidden[r]) <= 1.0F);
                TEST_ASSERT_TRUE(isfinite(state.cell[levels - 1U][r]));
            }
        }
    }
}

static void test_levels_out_of_range_are_a_bug(void) {
    weights.levels = 0U;
    TEST_EXPECT_ASSERT(step_with(0.0F, 0.0F, 0.0F, 0.0F));
    weights.levels = ELMOPP_LSTM_LEVELS_MAX + 1U;
    TEST_EXPECT_ASSERT(step_with(0.0F, 0.0F, 0.0F, 0.0F));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_without_weights_half_of_the_cell_is_kept_and_nothing_comes_in);
    RUN_TEST(test_every_gate_reads_its_own_column_and_every_row_its_own_input);
    RUN_TEST(test_the_head_is_linear_in_the_hidden_state);
    RUN_TEST(test_two_levels_are_the_nested_equations);
    RUN_TEST(test_unused_levels_are_left_alone);
    RUN_TEST(test_it_stays_finite_whatever_comes_in);
    RUN_TEST(test_levels_out_of_range_are_a_bug);
    return UNITY_END();
}
