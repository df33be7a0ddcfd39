/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The trainer: what a batch is, what an update does and does not, what it refuses. Its slopes, one by one, are held
/// against an independent implementation in tests/python/test_trainer_reference.py.

#include "assert_catcher.h"
#include "elmopp/lstm_q15.h"
#include "elmopp/lstm_quantize.h"
#include "elmopp/trainer.h"
#include "random.h"
#include "unity.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define WINDOW ELMOPP_TRAINER_WINDOW
#define INPUTS ELMOPP_LSTM_INPUTS

static elmopp_lstm_f32_weights_t weights;
static elmopp_lstm_f32_weights_t learnt;
static elmopp_lstm_q15_weights_t whole;
static elmopp_trainer_memory_t memory;
static elmopp_trainer_inner_memory_t inner;
static elmopp_trainer_t trainer;
static elmopp_lstm_f32_state_t before;
static float seen[WINDOW + 1U][INPUTS];
static const float low[INPUTS] = {0.0F, 0.0F, 0.0F, 0.0F};
static const float high[INPUTS] = {4.0F, 4.0F, 4.0F, 4.0F};
static uint64_t seed;

static void fill(float *values, uint32_t count, float size) {
    for (uint32_t k = 0U; k < count; k++) {
        values[k] = ((float)random_below(&seed, 20001U) - 10000.0F) * (size / 10000.0F);
    }
}

static void make_weights(uint32_t levels) {
    (void)memset(&weights, 0, sizeof weights);
    weights.levels = levels;
    fill(weights.head_row[0], ELMOPP_LSTM_UNITS * INPUTS, 0.3F);
    fill(weights.outer.bias, ELMOPP_LSTM_GATES, 0.5F);
    fill(weights.outer.row[0], ELMOPP_LSTM_OUTER_ROWS * ELMOPP_LSTM_GATES, 0.5F);
    for (uint32_t k = 0U; (k + 1U) < levels; k++) {
        fill(weights.inner[k].bias, ELMOPP_LSTM_GATES, 0.5F);
        fill(weights.inner[k].row[0], ELMOPP_LSTM_INNER_ROWS * ELMOPP_LSTM_GATES, 0.5F);
    }
    for (uint32_t k = 0U; k < INPUTS; k++) {
        weights.head_bias[k] = 1.0F;
    }
}

/* A wave in each input, of its own period. */
static void make_waves(void) {
    for (uint32_t t = 0U; t <= WINDOW; t++) {
        for (uint32_t k = 0U; k < INPUTS; k++) {
            seen[t][k] = 1.0F + (0.6F * sinf((float)t * 6.2831853F / (16.0F + (5.0F * (float)k))));
        }
    }
}

static void begin(uint32_t levels) {
    seed = levels;
    make_weights(levels);
    make_waves();
    (void)memset(&before, 0, sizeof before);
    (void)memset(&memory, 0xA5, sizeof memory);
    (void)memset(&inner, 0xA5, sizeof inner);
    elmopp_trainer_init(&trainer, &memory, &inner, &weights);
}

void setUp(void) {
    begin(1U);
}
void tearDown(void) {}

static elmopp_trainer_sample_t sample_of_waves(void) {
    const elmopp_trainer_sample_t sample = {.before = &before,
                                            .seen = (const float (*)[INPUTS])seen,
                                            .steps = WINDOW,
                                            .fed = 10U,
                                            .unscored = 5U,
                                            .inputs = INPUTS,
                                            .low = low,
                                            .high = high};
    return sample;
}

static float take(void) {
    const elmopp_trainer_sample_t sample = sample_of_waves();
    return elmopp_trainer_take(&trainer, &sample);
}

static void copy(elmopp_lstm_f32_weights_t *out) {
    (void)memset(out, 0xA5, sizeof *out);
    elmopp_trainer_copy(&trainer, out);
}

static void test_it_begins_with_the_weights_that_it_is_given(void) {
    for (uint32_t levels = 1U; levels <= ELMOPP_LSTM_LEVELS_MAX; levels++) {
        begin(levels);
        copy(&learnt);
        TEST_ASSERT_EQUAL_MEMORY(&weights, &learnt, sizeof weights);
    }
}

static void test_its_network_says_what_the_weights_say(void) {
    for (uint32_t levels = 1U; levels <= ELMOPP_LSTM_LEVELS_MAX; levels++) {
        begin(levels);
        elmopp_lstm_f32_state_t one = before;
        elmopp_lstm_f32_state_t other = before;
        const elmopp_lstm_f32_net_t net = elmopp_trainer_net(&trainer);
        for (uint32_t t = 0U; t < WINDOW; t++) {
            elmopp_lstm_f32_step(&weights, &one, seen[t]);
            elmopp_lstm_f32_net_step(&net, &other, seen[t]);
        }
        TEST_ASSERT_EQUAL_MEMORY(&one, &other, sizeof one);
    }
}

static void hold(float said[INPUTS]) {
    for (uint32_t k = 0U; k < INPUTS; k++) {
        said[k] = fminf(fmaxf(said[k], low[k]), high[k]);
    }
}

static float squares_of(const float said[INPUTS], const float came[INPUTS]) {
    float squares = 0.0F;
    for (uint32_t k = 0U; k < INPUTS; k++) {
        squares += (said[k] - came[k]) * (said[k] - came[k]);
    }
    return squares;
}

/* By the forecast's own rule, worked out here: fed, then on its own output in the clamp. */
static void test_a_samples_error_is_that_of_a_forecast(void) {
    const elmopp_trainer_sample_t sample = sample_of_waves();
    elmopp_lstm_f32_state_t state = before;
    float said[INPUTS];
    float squares = 0.0F;
    for (uint32_t t = 0U; t < WINDOW; t++) {
        elmopp_lstm_f32_step(&weights, &state, (t < sample.fed) ? seen[t] : said);
        elmopp_lstm_f32_output(&weights, &state, said);
        hold(said);
        squares += (t >= sample.unscored) ? squares_of(said, seen[t + 1U]) : 0.0F;
    }
    TEST_ASSERT_FLOAT_WITHIN(1e-6F, squares / (25.0F * 4.0F), take());
}

static void test_a_few_hundred_updates_learn_a_wave_at_every_depth(void) {
    for (uint32_t levels = 1U; levels <= ELMOPP_LSTM_LEVELS_MAX; levels++) {
        begin(levels);
        const float first = take();
        TEST_ASSERT_TRUE(elmopp_trainer_update(&trainer, 3.0e-3F));
        for (uint32_t n = 1U; n < 150U; n++) {
            (void)take();
            TEST_ASSERT_TRUE(elmopp_trainer_update(&trainer, 3.0e-3F));
        }
        TEST_ASSERT_TRUE(take() < (0.1F * first));
        TEST_ASSERT_EQUAL_UINT32(150U, trainer.updates);
    }
}

/* The error of a sample, by a network in whole numbers. */
static float error_in_whole_numbers(void) {
    const elmopp_trainer_sample_t sample = sample_of_waves();
    elmopp_lstm_q15_state_t state;
    (void)memset(&state, 0, sizeof state);
    float said[INPUTS];
    float squares = 0.0F;
    for (uint32_t t = 0U; t < WINDOW; t++) {
        elmopp_lstm_q15_step(&whole, &state, (t < sample.fed) ? seen[t] : said);
        elmopp_lstm_q15_output(&whole, &state, said);
        hold(said);
        squares += (t >= sample.unscored) ? squares_of(said, seen[t + 1U]) : 0.0F;
    }
    return squares / (25.0F * 4.0F);
}

static void test_what_was_learnt_is_quantised_again_and_knows_it_in_whole_numbers(void) {
    for (uint32_t levels = 1U; levels <= ELMOPP_LSTM_LEVELS_MAX; levels++) {
        begin(levels);
        TEST_ASSERT_TRUE(elmopp_lstm_quantize(&weights, low, high, &whole).made);
        const float first = error_in_whole_numbers();
        for (uint32_t n = 0U; n < 150U; n++) {
            (void)take();
            TEST_ASSERT_TRUE(elmopp_trainer_update(&trainer, 3.0e-3F));
        }
        const float in_float = take();
        copy(&learnt);
        TEST_ASSERT_TRUE(elmopp_lstm_quantize(&learnt, low, high, &whole).made);
        TEST_ASSERT_TRUE(error_in_whole_numbers() < (0.1F * first));
        TEST_ASSERT_FLOAT_WITHIN(0.02F * in_float, in_float, error_in_whole_numbers());
    }
}

/* The mean slope of a sample taken twice is that of the sample; a sum of the two would go no further, as Adam goes, but
 * would be shortened. */
static void test_a_batch_of_the_same_is_the_same(void) {
    (void)take();
    TEST_ASSERT_TRUE(elmopp_trainer_update(&trainer, 1.0e-3F));
    copy(&learnt);
    begin(1U);
    (void)take();
    (void)take();
    TEST_ASSERT_EQUAL_UINT32(2U, trainer.samples);
    TEST_ASSERT_TRUE(elmopp_trainer_update(&trainer, 1.0e-3F));
    elmopp_lstm_f32_weights_t twice;
    copy(&twice);
    for (uint32_t u = 0U; u < ELMOPP_LSTM_GATES; u++) {
        TEST_ASSERT_FLOAT_WITHIN(1.0e-7F, learnt.outer.bias[u], twice.outer.bias[u]);
    }
}

/* The first step of Adam goes by the rate wherever there is a slope at all. */
static void test_the_first_step_is_the_rate_and_against_the_slope(void) {
    (void)take();
    const float slope = memory.slope.head_bias[0];
    TEST_ASSERT_TRUE(fabsf(slope) > 1.0e-3F);
    TEST_ASSERT_TRUE(elmopp_trainer_update(&trainer, 1.0e-3F));
    const float way = memory.weight.head_bias[0] - weights.head_bias[0];
    TEST_ASSERT_FLOAT_WITHIN(2.0e-6F, (slope > 0.0F) ? -1.0e-3F : 1.0e-3F, way);
}

static void test_long_slopes_are_shortened_to_the_limit(void) {
    for (uint32_t t = 0U; t <= WINDOW; t++) {
        for (uint32_t k = 0U; k < INPUTS; k++) {
            seen[t][k] *= 100.0F;
        }
    }
    (void)take();
    float squares = 0.0F;
    const float *slope = memory.slope.head_bias;
    for (uint32_t k = 0U; k < INPUTS; k++) {
        squares += slope[k] * slope[k];
    }
    TEST_ASSERT_TRUE(squares > (4.0F * ELMOPP_TRAINER_NORM_MAX));
    TEST_ASSERT_TRUE(elmopp_trainer_update(&trainer, 1.0e-3F));
    squares = 0.0F;
    for (uint32_t k = 0U; k < INPUTS; k++) {
        squares += memory.mean.head_bias[k] * memory.mean.head_bias[k];
    }
    TEST_ASSERT_TRUE(squares <= (0.01F * 1.0001F * ELMOPP_TRAINER_NORM_MAX)); /* a tenth of it has gone into the mean */
}

static void test_slopes_are_gone_after_an_update(void) {
    (void)take();
    TEST_ASSERT_TRUE(elmopp_trainer_update(&trainer, 1.0e-3F));
    static const elmopp_trainer_plain_t none;
    TEST_ASSERT_EQUAL_MEMORY(&none, &memory.slope, sizeof none);
    TEST_ASSERT_EQUAL_UINT32(0U, trainer.samples);
}

static void test_slopes_that_are_no_numbers_move_nothing_and_are_thrown_away(void) {
    (void)take();
    memory.slope.outer.row[3][5] = NAN;
    TEST_ASSERT_FALSE(elmopp_trainer_update(&trainer, 1.0e-3F));
    copy(&learnt);
    TEST_ASSERT_EQUAL_MEMORY(&weights, &learnt, sizeof weights);
    TEST_ASSERT_EQUAL_UINT32(0U, trainer.updates);
    (void)take();
    TEST_ASSERT_TRUE(elmopp_trainer_update(&trainer, 1.0e-3F));
    memory.slope.outer.row[3][5] = INFINITY;
    (void)take();
    TEST_ASSERT_FALSE(elmopp_trainer_update(&trainer, 1.0e-3F));
}

static void test_a_reset_is_as_new(void) {
    for (uint32_t n = 0U; n < 3U; n++) {
        (void)take();
        TEST_ASSERT_TRUE(elmopp_trainer_update(&trainer, 1.0e-2F));
    }
    elmopp_trainer_reset(&trainer, &weights);
    (void)take();
    TEST_ASSERT_TRUE(elmopp_trainer_update(&trainer, 1.0e-3F));
    copy(&learnt);
    elmopp_lstm_f32_weights_t fresh;
    begin(1U);
    (void)take();
    TEST_ASSERT_TRUE(elmopp_trainer_update(&trainer, 1.0e-3F));
    copy(&fresh);
    TEST_ASSERT_EQUAL_MEMORY(&fresh, &learnt, sizeof fresh);
}

static void test_inputs_without_an_approach_teach_nothing(void) {
    elmopp_trainer_sample_t sample = sample_of_waves();
    sample.inputs = 3U;
    for (uint32_t t = 0U; t <= WINDOW; t++) {
        seen[t][3] = 0.0F;
    }
    (void)elmopp_trainer_take(&trainer, &sample);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, memory.slope.head_bias[3]);
    for (uint32_t u = 0U; u < ELMOPP_LSTM_UNITS; u++) {
        TEST_ASSERT_EQUAL_FLOAT(0.0F, memory.slope.head_row[u][3]);
    }
    for (uint32_t g = 0U; g < ELMOPP_LSTM_GATES; g++) {
        TEST_ASSERT_EQUAL_FLOAT(0.0F, memory.slope.outer.row[3][g]);
    }
    TEST_ASSERT_TRUE(memory.slope.head_bias[2] != 0.0F);
}

static void test_nothing_beyond_the_samples_seconds_is_read(void) {
    elmopp_trainer_sample_t sample = sample_of_waves();
    sample.steps = 12U;
    const float right = elmopp_trainer_take(&trainer, &sample);
    const elmopp_trainer_plain_t slope = memory.slope;
    begin(1U);
    for (uint32_t t = 13U; t <= WINDOW; t++) {
        for (uint32_t k = 0U; k < INPUTS; k++) {
            seen[t][k] = NAN;
        }
    }
    TEST_ASSERT_EQUAL_FLOAT(right, elmopp_trainer_take(&trainer, &sample));
    TEST_ASSERT_EQUAL_MEMORY(&slope, &memory.slope, sizeof slope);
}

static void test_it_takes_the_memory_that_was_promised(void) {
    /* One level, window 30, weights included: at most 35 kB. */
    TEST_ASSERT_EQUAL_UINT32(30U, WINDOW);
    TEST_ASSERT_TRUE((sizeof memory + sizeof trainer) <= 35000U);
}

static void take_as(uint32_t steps, uint32_t fed, uint32_t unscored, uint32_t inputs) {
    elmopp_trainer_sample_t sample = sample_of_waves();
    sample.steps = steps;
    sample.fed = fed;
    sample.unscored = unscored;
    sample.inputs = inputs;
    (void)elmopp_trainer_take(&trainer, &sample);
}

static void test_samples_beyond_the_bounds_are_a_bug(void) {
    take_as(WINDOW, WINDOW, WINDOW - 1U, INPUTS);
    take_as(1U, 1U, 0U, 1U);
    TEST_EXPECT_ASSERT(take_as(0U, 1U, 0U, 4U));
    TEST_EXPECT_ASSERT(take_as(WINDOW + 1U, 1U, 0U, 4U));
    TEST_EXPECT_ASSERT(take_as(10U, 0U, 0U, 4U));
    TEST_EXPECT_ASSERT(take_as(10U, 11U, 0U, 4U));
    TEST_EXPECT_ASSERT(take_as(10U, 10U, 10U, 4U));
    TEST_EXPECT_ASSERT(take_as(10U, 10U, 0U, 0U));
    TEST_EXPECT_ASSERT(take_as(10U, 10U, 0U, 5U));
}

static void test_what_it_has_no_memory_for_is_a_bug(void) {
    make_weights(2U);
    TEST_EXPECT_ASSERT(elmopp_trainer_init(&trainer, &memory, NULL, &weights));
    TEST_EXPECT_ASSERT(elmopp_trainer_init(&trainer, NULL, &inner, &weights));
    begin(1U);
    TEST_EXPECT_ASSERT((void)elmopp_trainer_update(&trainer, 1.0e-3F));
    make_weights(2U);
    TEST_EXPECT_ASSERT(elmopp_trainer_reset(&trainer, &weights));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_it_begins_with_the_weights_that_it_is_given);
    RUN_TEST(test_its_network_says_what_the_weights_say);
    RUN_TEST(test_a_samples_error_is_that_of_a_forecast);
    RUN_TEST(test_a_few_hundred_updates_learn_a_wave_at_every_depth);
    RUN_TEST(test_what_was_learnt_is_quantised_again_and_knows_it_in_whole_numbers);
    RUN_TEST(test_a_batch_of_the_same_is_the_same);
    RUN_TEST(test_the_first_step_is_the_rate_and_against_the_slope);
    RUN_TEST(test_long_slopes_are_shortened_to_the_limit);
    RUN_TEST(test_slopes_are_gone_after_an_update);
    RUN_TEST(test_slopes_that_are_no_numbers_move_nothing_and_are_thrown_away);
    RUN_TEST(test_a_reset_is_as_new);
    RUN_TEST(test_inputs_without_an_approach_teach_nothing);
    RUN_TEST(test_nothing_beyond_the_samples_seconds_is_read);
    RUN_TEST(test_it_takes_the_memory_that_was_promised);
    RUN_TEST(test_samples_beyond_the_bounds_are_a_bug);
    RUN_TEST(test_what_it_has_no_memory_for_is_a_bug);
    return UNITY_END();
}
