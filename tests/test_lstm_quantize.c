/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Quantising an LSTM: what is refused is named and leaves everything as it was, and what is made stays in its words.
/// That every bit is right is shown against an independent implementation (tests/python/test_lstm_q15.py).

#include "elmopp/lstm_quantize.h"
#include "elmopp_weights.h"
#include "random.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define UNITS ELMOPP_LSTM_UNITS
#define GATES ELMOPP_LSTM_GATES
#define REACH ELMOPP_LSTM_QUANTIZE_REACH_MAX

static elmopp_lstm_f32_weights_t weights;
static elmopp_lstm_q15_weights_t made;
static elmopp_lstm_q15_weights_t before;
static const float low[ELMOPP_LSTM_INPUTS] = {0.0F, 0.0F, 0.0F, 0.0F};
static const float high[ELMOPP_LSTM_INPUTS] = {4.0F, 4.0F, 4.0F, 4.0F};

void setUp(void) {
    (void)memset(&weights, 0, sizeof weights);
    (void)memset(&made, 0xA5, sizeof made);
    before = made;
    weights.levels = ELMOPP_LSTM_LEVELS_MAX;
}
void tearDown(void) {}

static void expect_made(void) {
    TEST_ASSERT_TRUE(elmopp_lstm_quantize_check(&weights, low, high).made);
    TEST_ASSERT_TRUE(elmopp_lstm_quantize(&weights, low, high, &made).made);
    TEST_ASSERT_EQUAL_UINT32(weights.levels, made.levels);
}

static void expect_refused(uint32_t level, uint32_t column) {
    const elmopp_lstm_quantized_t found = elmopp_lstm_quantize(&weights, low, high, &made);
    const elmopp_lstm_quantized_t checked = elmopp_lstm_quantize_check(&weights, low, high);
    TEST_ASSERT_FALSE(found.made);
    TEST_ASSERT_FALSE(checked.made);
    TEST_ASSERT_EQUAL_UINT32(level, found.level);
    TEST_ASSERT_EQUAL_UINT32(column, found.column);
    TEST_ASSERT_EQUAL_UINT32(level, checked.level);
    TEST_ASSERT_EQUAL_UINT32(column, checked.column);
    TEST_ASSERT_FALSE(found.reach < REACH);
    TEST_ASSERT_EQUAL_MEMORY(&before, &made, sizeof made);
}

static void test_a_row_of_each_level_that_reaches_the_bound_is_refused(void) {
    weights.outer.bias[5] = -REACH;
    expect_refused(0U, 5U);
    weights.outer.bias[5] = 0.0F;
    weights.inner[0].bias[63] = REACH;
    expect_refused(1U, 63U);
    weights.inner[0].bias[63] = 0.0F;
    weights.inner[1].row[31][0] = -REACH;
    expect_refused(2U, 0U);
    weights.inner[1].row[31][0] = -nextafterf(REACH, 0.0F);
    expect_made();
}

static void test_what_may_be_fed_counts(void) {
    /* An input is within 0..4: 2 either side of 2. */
    weights.outer.row[3][9] = 32.0F;
    expect_refused(0U, 9U);
    weights.outer.row[3][9] = 31.99F;
    expect_made();
}

static void test_the_first_row_that_could_overflow_is_named(void) {
    weights.inner[1].bias[1] = 200.0F;
    weights.inner[0].bias[60] = 200.0F;
    weights.inner[0].bias[30] = 200.0F;
    expect_refused(1U, 30U);
}

static void test_an_unused_level_is_not_looked_at(void) {
    weights.inner[1].bias[1] = 200.0F;
    weights.levels = 2U;
    expect_made();
}

static void test_what_is_no_number_is_refused(void) {
    weights.outer.row[7][40] = NAN;
    expect_refused(0U, 40U);
    weights.outer.row[7][40] = INFINITY;
    expect_refused(0U, 40U);
}

static int32_t sum_of_row(const elmopp_lstm_q15_outer_t *band, uint32_t r) {
    int32_t sum = 0;
    for (uint32_t k = 0U; k < ELMOPP_LSTM_INPUTS; k++) {
        sum += abs(band->input[r][k]);
    }
    for (uint32_t run = 0U; run < ELMOPP_LSTM_Q15_OUTER_RUNS; run++) {
        for (uint32_t k = 0U; k < ELMOPP_LSTM_Q15_RUN; k++) {
            sum += abs(band->hidden[run][r][k]);
        }
    }
    return sum;
}

/* Rows of one large weight, of many equal ones, and of none. */
static void test_no_weight_and_no_sum_leaves_its_word(void) {
    static const float size[] = {0.0F, 1.0e-9F, 0.001F, 0.3F, 3.0F};
    for (uint32_t i = 0U; i < (sizeof size / sizeof size[0]); i++) {
        for (uint32_t c = 0U; c < GATES; c++) {
            for (uint32_t k = 0U; k < ELMOPP_LSTM_OUTER_ROWS; k++) {
                weights.outer.row[k][c] = ((c % 2U) == 0U) ? size[i] : ((k == 12U) ? -size[i] : 0.0F);
            }
        }
        expect_made();
        for (uint32_t b = 0U; b < ELMOPP_LSTM_Q15_BANDS; b++) {
            for (uint32_t r = 0U; r < ELMOPP_LSTM_Q15_BAND; r++) {
                const int32_t sum = sum_of_row(&made.outer[b], r);
                TEST_ASSERT_TRUE(sum <= ELMOPP_LSTM_Q15_SUM_MAX);
                TEST_ASSERT_TRUE((size[i] < 0.01F) || (sum >= 32767));
                TEST_ASSERT_TRUE(made.outer[b].scale[r] > 0);
            }
        }
    }
}

static void test_a_narrow_range_of_an_input_divides_by_no_zero(void) {
    weights.outer.row[0][0] = 1.0F;
    TEST_ASSERT_TRUE(elmopp_lstm_quantize(&weights, high, high, &made).made);
    TEST_ASSERT_TRUE((made.input_gain[0] > 0.0F) && (made.input_gain[0] < 1.0e11F));
}

static void test_shipped_weights_can_be_quantised(void) {
    const elmopp_weights_t *const shipped[] = {&elmopp_weights_lstm, &elmopp_weights_nlstm};
    for (uint32_t i = 0U; i < 2U; i++) {
        TEST_ASSERT_TRUE(elmopp_lstm_quantize(&shipped[i]->lstm, low, shipped[i]->high, &made).made);
        TEST_ASSERT_EQUAL_MEMORY(shipped[i]->lstm.head_bias, made.head_bias, sizeof made.head_bias);
    }
}

static void test_the_same_weights_give_the_same_bits_in_any_memory(void) {
    TEST_ASSERT_TRUE(elmopp_lstm_quantize(&elmopp_weights_lstm.lstm, low, high, &made).made);
    (void)memset(&before, 0, sizeof before);
    TEST_ASSERT_TRUE(elmopp_lstm_quantize(&elmopp_weights_lstm.lstm, low, high, &before).made);
    TEST_ASSERT_EQUAL_MEMORY(&before, &made, sizeof made);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_row_of_each_level_that_reaches_the_bound_is_refused);
    RUN_TEST(test_what_may_be_fed_counts);
    RUN_TEST(test_the_first_row_that_could_overflow_is_named);
    RUN_TEST(test_an_unused_level_is_not_looked_at);
    RUN_TEST(test_what_is_no_number_is_refused);
    RUN_TEST(test_no_weight_and_no_sum_leaves_its_word);
    RUN_TEST(test_a_narrow_range_of_an_input_divides_by_no_zero);
    RUN_TEST(test_shipped_weights_can_be_quantised);
    RUN_TEST(test_the_same_weights_give_the_same_bits_in_any_memory);
    return UNITY_END();
}
