/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The LSTM in whole numbers: tables as near as they say, steps near those in float, cells that end where they must.
/// That every bit is right is shown against an independent implementation (tests/python/test_lstm_q15.py).

#include "elmopp/lstm_q15.h"
#include "elmopp/lstm_q15_table.h"
#include "elmopp/lstm_quantize.h"
#include "random.h"
#include "unity.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#ifndef REACH_STRIDE
#define REACH_STRIDE 7 ///< of both tables, and a stretch beyond; prime to a stretch's length
#endif
#define REACH_END (((int32_t)1 << 24) + 40000)
#define UNITS ELMOPP_LSTM_UNITS
#define GATES ELMOPP_LSTM_GATES
#define BAND ELMOPP_LSTM_Q15_BAND
#define CELL_ONE ((int32_t)1 << 21)

static elmopp_lstm_f32_weights_t weights;
static elmopp_lstm_f32_state_t state;
static elmopp_lstm_q15_weights_t whole_weights;
static elmopp_lstm_q15_state_t whole_state;
static const float low[ELMOPP_LSTM_INPUTS] = {-2.0F, -2.0F, -2.0F, -2.0F};
static const float high[ELMOPP_LSTM_INPUTS] = {2.0F, 2.0F, 2.0F, 2.0F};

void setUp(void) {
    (void)memset(&weights, 0, sizeof weights);
    (void)memset(&state, 0, sizeof state);
    (void)memset(&whole_state, 0, sizeof whole_state);
    weights.levels = 1U;
}
void tearDown(void) {}

/* --- tables, read by way of rows that are biases alone --- */

static elmopp_lstm_q15_outer_t bands[ELMOPP_LSTM_Q15_BANDS];

static void open_at(int32_t reach, int32_t gate[GATES]) {
    _Alignas(4) static const int16_t nothing[ELMOPP_LSTM_OUTER_ROWS];
    for (uint32_t k = 0U; k < GATES; k++) {
        bands[k / BAND].bias[k % BAND] = reach + ((int32_t)(k % UNITS) * REACH_STRIDE);
    }
    elmopp_lstm_q15_kernel_outer(bands, nothing, gate);
}

static double worst_of(uint32_t first_gate, bool is_sigmoid) {
    double worst = 0.0;
    int32_t gate[GATES];
    for (int32_t reach = -REACH_END; reach < REACH_END; reach += (int32_t)UNITS * REACH_STRIDE) {
        open_at(reach, gate);
        for (uint32_t k = 0U; k < UNITS; k++) {
            const double at = (double)(reach + ((int32_t)k * REACH_STRIDE)) / (double)CELL_ONE;
            const double right = is_sigmoid ? (0.5 + (0.5 * tanh(at))) : tanh(at);
            const double error = fabs(((double)gate[first_gate + k] / 2147483648.0) - right);
            worst = (error > worst) ? error : worst;
        }
    }
    return worst;
}

static void test_tables_are_as_near_as_they_say(void) {
    TEST_ASSERT_TRUE(worst_of(ELMOPP_LSTM_GATE_I, true) <= ELMOPP_LSTM_Q15_TABLE_ERROR);
    TEST_ASSERT_TRUE(worst_of(ELMOPP_LSTM_GATE_G, false) <= ELMOPP_LSTM_Q15_TABLE_ERROR);
}

static void test_results_leave_room_for_their_products(void) {
    int32_t gate[GATES];
    for (int32_t reach = -REACH_END; reach < REACH_END; reach += (int32_t)UNITS * REACH_STRIDE) {
        open_at(reach, gate);
        for (uint32_t k = 0U; k < UNITS; k++) {
            TEST_ASSERT_TRUE(gate[k] >= 0);
            TEST_ASSERT_TRUE(gate[ELMOPP_LSTM_GATE_G + k] > (INT32_MIN + 32768));
            TEST_ASSERT_TRUE(gate[ELMOPP_LSTM_GATE_G + k] < (INT32_MAX - 32767));
        }
    }
}

static void expect_ends(int32_t reach, int32_t least_sigmoid, int32_t most_sigmoid) {
    int32_t gate[GATES];
    open_at(reach, gate);
    TEST_ASSERT_TRUE((gate[0] >= least_sigmoid) && (gate[0] <= most_sigmoid));
    TEST_ASSERT_TRUE((reach < 0) == (gate[ELMOPP_LSTM_GATE_G] < -2147352576));
    TEST_ASSERT_TRUE((reach > 0) == (gate[ELMOPP_LSTM_GATE_G] > 2147352576));
}

static void test_reaches_to_the_ends_of_their_words_are_shut_or_open(void) {
    expect_ends(INT32_MAX - 65536, 2147352576, INT32_MAX);
    expect_ends((int32_t)1 << 28, 2147352576, INT32_MAX);
    expect_ends(INT32_MIN, 0, 65536);
    expect_ends(-((int32_t)1 << 28), 0, 65536);
}

/* --- steps --- */

static void fill(uint64_t *random, float *values, uint32_t count, float size) {
    for (uint32_t i = 0U; i < count; i++) {
        values[i] = ((float)random_below(random, 1U << 24U) - 8388608.0F) * (size / 8388608.0F);
    }
}

static void make_weights(uint32_t levels) {
    uint64_t random = 40U + levels;
    weights.levels = levels;
    fill(&random, weights.head_bias, ELMOPP_LSTM_INPUTS, 0.2F);
    fill(&random, weights.head_row[0], UNITS * ELMOPP_LSTM_INPUTS, 0.3F);
    fill(&random, weights.outer.bias, GATES, 1.0F);
    fill(&random, weights.outer.row[0], ELMOPP_LSTM_OUTER_ROWS * GATES, 0.6F);
    for (uint32_t i = 0U; (i + 1U) < levels; i++) {
        fill(&random, weights.inner[i].bias, GATES, 1.0F);
        fill(&random, weights.inner[i].row[0], ELMOPP_LSTM_INNER_ROWS * GATES, 0.6F);
    }
    TEST_ASSERT_TRUE(elmopp_lstm_quantize(&weights, low, high, &whole_weights).made);
}

/* What they are fed is the same, so that errors do not grow by themselves. */
static void expect_near_float(uint32_t levels, float most) {
    uint64_t random = 1U;
    make_weights(levels);
    for (uint32_t t = 0U; t < 300U; t++) {
        float input[ELMOPP_LSTM_INPUTS];
        float in_float[ELMOPP_LSTM_INPUTS];
        float in_whole[ELMOPP_LSTM_INPUTS];
        fill(&random, input, ELMOPP_LSTM_INPUTS, 2.0F);
        elmopp_lstm_f32_step(&weights, &state, input);
        elmopp_lstm_f32_output(&weights, &state, in_float);
        elmopp_lstm_q15_step(&whole_weights, &whole_state, input);
        elmopp_lstm_q15_output(&whole_weights, &whole_state, in_whole);
        for (uint32_t k = 0U; k < ELMOPP_LSTM_INPUTS; k++) {
            TEST_ASSERT_FLOAT_WITHIN(most, in_float[k], in_whole[k]);
        }
    }
}

static void test_one_level_is_near_the_float_one(void) {
    expect_near_float(1U, 2.0e-4F);
}

static void test_two_levels_are_near_the_float_ones(void) {
    expect_near_float(2U, 2.0e-4F);
}

static void test_three_levels_are_near_the_float_ones(void) {
    expect_near_float(3U, 2.0e-4F);
}

static void test_unused_levels_are_left_alone(void) {
    make_weights(1U);
    const float input[ELMOPP_LSTM_INPUTS] = {1.0F, -1.0F, 0.5F, 2.0F};
    (void)memset(whole_state.cell[1], 0x5A, 2U * sizeof whole_state.cell[1]);
    elmopp_lstm_q15_step(&whole_weights, &whole_state, input);
    TEST_ASSERT_EACH_EQUAL_HEX8(0x5A, whole_state.cell[1], 2U * sizeof whole_state.cell[1]);
}

/* Every gate open: the cell grows by 1 a step, and would leave its word after 1,024. */
static void expect_cell_to_end_at(float candidate_bias, int32_t end) {
    const float input[ELMOPP_LSTM_INPUTS] = {0.0F, 0.0F, 0.0F, 0.0F};
    for (uint32_t k = 0U; k < GATES; k++) {
        weights.outer.bias[k] = (k < ELMOPP_LSTM_GATE_G) ? 40.0F : candidate_bias;
    }
    TEST_ASSERT_TRUE(elmopp_lstm_quantize(&weights, low, high, &whole_weights).made);
    for (uint32_t k = 0U; k < UNITS; k++) {
        whole_state.cell[0][k] = end - (end / 512);
    }
    const int32_t before = whole_state.cell[0][0];
    elmopp_lstm_q15_step(&whole_weights, &whole_state, input);
    TEST_ASSERT_TRUE((end > 0) == (whole_state.cell[0][0] > before));
    for (uint32_t t = 0U; t < 10U; t++) {
        elmopp_lstm_q15_step(&whole_weights, &whole_state, input);
    }
    TEST_ASSERT_EQUAL_INT32(end, whole_state.cell[0][7]);
    TEST_ASSERT_INT32_WITHIN(8, (end > 0) ? 32767 : -32767, whole_state.hidden[7]);
}

static void test_a_cell_that_would_leave_its_word_stays_at_its_end(void) {
    expect_cell_to_end_at(40.0F, INT32_MAX);
    expect_cell_to_end_at(-40.0F, INT32_MIN);
}

/* --- inputs --- */

static void step_with(float value, elmopp_lstm_q15_state_t *after) {
    const float input[ELMOPP_LSTM_INPUTS] = {value, value, value, value};
    (void)memset(after, 0, sizeof *after);
    elmopp_lstm_q15_step(&whole_weights, after, input);
}

static void test_an_input_beyond_its_range_is_taken_as_its_end(void) {
    elmopp_lstm_q15_state_t at_end;
    elmopp_lstm_q15_state_t beyond;
    make_weights(1U);
    step_with(2.0F, &at_end);
    step_with(2.1F, &beyond);
    TEST_ASSERT_EQUAL_MEMORY(&at_end, &beyond, sizeof at_end);
    step_with(3.0e38F, &beyond);
    TEST_ASSERT_EQUAL_MEMORY(&at_end, &beyond, sizeof at_end);
    step_with(-2.0F, &at_end);
    step_with(-3.0e38F, &beyond);
    TEST_ASSERT_EQUAL_MEMORY(&at_end, &beyond, sizeof at_end);
    step_with(-1.99F, &beyond);
    TEST_ASSERT_TRUE(memcmp(&at_end, &beyond, sizeof at_end) != 0);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_tables_are_as_near_as_they_say);
    RUN_TEST(test_results_leave_room_for_their_products);
    RUN_TEST(test_reaches_to_the_ends_of_their_words_are_shut_or_open);
    RUN_TEST(test_one_level_is_near_the_float_one);
    RUN_TEST(test_two_levels_are_near_the_float_ones);
    RUN_TEST(test_three_levels_are_near_the_float_ones);
    RUN_TEST(test_unused_levels_are_left_alone);
    RUN_TEST(test_a_cell_that_would_leave_its_word_stays_at_its_end);
    RUN_TEST(test_an_input_beyond_its_range_is_taken_as_its_end);
    return UNITY_END();
}
