/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The forecasts `lstm` and `nlstm`, in float and in whole numbers: what the network is shown, how it runs on its own
/// output, when the mean speaks for it, and the account that is kept of every forecast's error.

#include "elmopp/forecast.h"
#include "elmopp_weights.h"
#include "random.h"
#include "sites.h"
#include "unity.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define HORIZON ELMOPP_HORIZON_MAX
#define PROBE ELMOPP_ACCOUNT_PROBE_S

static elmopp_junction_t junction;
static elmopp_forecast_t forecast;
static const float *rows[ELMOPP_APPROACH_MAX];
static uint64_t random_state;

/* One movement an approach. */
static void set_approaches(uint32_t count) {
    junction = test_cross(count);
    junction.approach_count = (uint8_t)count;
    for (uint32_t j = 0U; j < count; j++) {
        junction.movement[j].approach = (uint8_t)j;
    }
}

void setUp(void) {
    set_approaches(4U);
    (void)memset(&forecast, 0xA5, sizeof forecast);
    random_state = 5U;
}
void tearDown(void) {}

static void start(uint8_t kind, const elmopp_weights_t *weights, const float *mean_veh_per_s) {
    const elmopp_forecast_config_t config = {.kind = kind, .mean_veh_per_s = mean_veh_per_s, .weights = weights};
    elmopp_forecast_init(&forecast, &junction, &config);
}

static float some_vehicles(void) {
    return (float)random_below(&random_state, 2000U) / 1000.0F;
}

static void observe_some(uint32_t seconds) {
    for (uint32_t t = 0U; t < seconds; t++) {
        float arrivals_veh[ELMOPP_MOVEMENT_MAX];
        for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
            arrivals_veh[j] = some_vehicles();
        }
        elmopp_forecast_observe(&forecast, arrivals_veh);
    }
}

static void observe_all(float vehicles) {
    float arrivals_veh[ELMOPP_MOVEMENT_MAX];
    for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
        arrivals_veh[j] = vehicles;
    }
    elmopp_forecast_observe(&forecast, arrivals_veh);
}

static void look(uint16_t steps) {
    TEST_ASSERT_EQUAL_UINT16(steps, elmopp_forecast_look(&forecast, steps, rows));
}

static void expect_mean(const float *mean_veh_per_s) {
    look(HORIZON);
    for (uint32_t i = 0U; i < junction.approach_count; i++) {
        for (uint32_t t = 0U; t < HORIZON; t++) {
            TEST_ASSERT_EQUAL_FLOAT(mean_veh_per_s[i], rows[i][t]);
        }
    }
}

static float held_in(float value, float low, float high) {
    return fminf(fmaxf(value, low), high);
}

/* The same by hand: absorb in units of the mean, run on the clamped output, give back vehicles. Bit for bit. */
static void expect_like_the_network(const elmopp_weights_t *weights, uint8_t kind) {
    static const float mean_veh_per_s[4] = {0.5F, 1.0F, 0.25F, 2.0F};
    elmopp_lstm_f32_state_t state = {.hidden = {0.0F}};
    start(kind, weights, mean_veh_per_s);
    for (uint32_t n = 0U; n < 70U; n++) {
        float arrivals_veh[4];
        float input[4];
        for (uint32_t i = 0U; i < 4U; i++) {
            arrivals_veh[i] = (n == 33U) ? 100.0F : some_vehicles(); /* once far out of the range */
            input[i] = held_in(arrivals_veh[i] / mean_veh_per_s[i], weights->low[i], weights->high[i]);
        }
        elmopp_forecast_observe(&forecast, arrivals_veh);
        elmopp_lstm_f32_step(&weights->lstm, &state, input);
    }
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORECAST_READY, elmopp_forecast_status(&forecast));
    look(HORIZON);
    for (uint32_t t = 0U; t < HORIZON; t++) {
        float said[4];
        elmopp_lstm_f32_output(&weights->lstm, &state, said);
        for (uint32_t i = 0U; i < 4U; i++) {
            said[i] = held_in(said[i], weights->low[i], weights->high[i]);
            TEST_ASSERT_TRUE(said[i] * mean_veh_per_s[i] == rows[i][t]);
        }
        elmopp_lstm_f32_step(&weights->lstm, &state, said);
    }
}

static void test_lstm_absorbs_every_second_and_runs_on_its_own_output(void) {
    expect_like_the_network(&elmopp_weights_lstm, ELMOPP_FORECAST_LSTM);
}

static void test_nlstm_absorbs_every_second_and_runs_on_its_own_output(void) {
    expect_like_the_network(&elmopp_weights_nlstm, ELMOPP_FORECAST_NLSTM);
}

/* --- counts of whole vehicles --- */

static void start_counting(uint8_t kind, const elmopp_weights_t *weights, const float *mean_veh_per_s) {
    const elmopp_forecast_config_t config = {
        .kind = kind, .mean_veh_per_s = mean_veh_per_s, .weights = weights, .whole = true};
    elmopp_forecast_init(&forecast, &junction, &config);
}

/* By hand: what the network would have said, and a tenth of what the count says more. Whole vehicles would be clamped.
 */
static void expect_like_the_observer(const elmopp_weights_t *weights, uint8_t kind) {
    static const float mean_veh_per_s[4] = {0.5F, 0.1F, 0.25F, 2.0F};
    elmopp_lstm_f32_state_t state = {.hidden = {0.0F}};
    start_counting(kind, weights, mean_veh_per_s);
    for (uint32_t n = 0U; n < 90U; n++) {
        float arrivals_veh[4];
        float input[4];
        elmopp_lstm_f32_output(&weights->lstm, &state, input);
        const float gain = fmaxf(0.1F, 1.0F / (float)(n + 1U));
        for (uint32_t i = 0U; i < 4U; i++) {
            arrivals_veh[i] = (float)random_below(&random_state, 3U);
            const float said_veh = held_in(input[i], weights->low[i], weights->high[i]) * mean_veh_per_s[i];
            const float believed_veh = said_veh + (gain * (arrivals_veh[i] - said_veh));
            input[i] = held_in(believed_veh / mean_veh_per_s[i], weights->low[i], weights->high[i]);
        }
        elmopp_forecast_observe(&forecast, arrivals_veh);
        elmopp_lstm_f32_step(&weights->lstm, &state, input);
    }
    look(1U);
    float said[4];
    elmopp_lstm_f32_output(&weights->lstm, &state, said);
    for (uint32_t i = 0U; i < 4U; i++) {
        const float held = held_in(said[i], weights->low[i], weights->high[i]);
        TEST_ASSERT_TRUE(held * mean_veh_per_s[i] == rows[i][0]);
    }
}

static void test_a_network_that_is_shown_counts_is_corrected_by_a_tenth_of_their_surprise(void) {
    expect_like_the_observer(&elmopp_weights_lstm, ELMOPP_FORECAST_LSTM);
    expect_like_the_observer(&elmopp_weights_nlstm, ELMOPP_FORECAST_NLSTM);
}

/* Counts that come as it has said change nothing, whatever their gain: it goes on along its own rows. */
static void test_counts_that_come_as_they_were_said_leave_the_rows_as_they_were(void) {
    static const uint8_t kinds[2] = {ELMOPP_FORECAST_LSTM, ELMOPP_FORECAST_LSTM_Q15};
    static const float mean_veh_per_s[4] = {0.5F, 1.0F, 0.25F, 2.0F};
    float said[4][HORIZON];
    for (uint32_t k = 0U; k < 2U; k++) {
        start_counting(kinds[k], &elmopp_weights_lstm, mean_veh_per_s);
        observe_some(80U);
        look(HORIZON);
        for (uint32_t i = 0U; i < 4U; i++) {
            (void)memcpy(said[i], rows[i], sizeof said[i]);
        }
        for (uint32_t t = 0U; t < 20U; t++) {
            const float arrivals_veh[ELMOPP_MOVEMENT_MAX] = {said[0][t], said[1][t], said[2][t], said[3][t]};
            elmopp_forecast_observe(&forecast, arrivals_veh);
        }
        look(40U);
        for (uint32_t i = 0U; i < 4U; i++) {
            for (uint32_t t = 0U; t < 40U; t++) {
                TEST_ASSERT_FLOAT_WITHIN(0.01F * mean_veh_per_s[i], said[i][t + 20U], rows[i][t]);
            }
        }
    }
}

/* The mean, the account and all kinds without a network see the counts as they are. */
static void test_only_a_network_is_shown_less_than_a_count(void) {
    start_counting(ELMOPP_FORECAST_PERSISTENCE, NULL, NULL);
    for (uint32_t n = 0U; n < 50U; n++) {
        observe_all((float)(n % 5U));
    }
    look(1U);
    TEST_ASSERT_EQUAL_FLOAT(4.0F, rows[0][0]);
    start_counting(ELMOPP_FORECAST_LSTM, &elmopp_weights_lstm, NULL);
    for (uint32_t n = 0U; n < 50U; n++) {
        observe_all((float)(n % 5U));
    }
    look(1U);
    TEST_ASSERT_FLOAT_WITHIN(1e-5F, 2.0F, rows[0][0]);
}

/* The same in whole numbers, made of the same weights. */
static void expect_like_the_whole_network(const elmopp_weights_t *weights, uint8_t kind) {
    static const float mean_veh_per_s[4] = {0.5F, 1.0F, 0.25F, 2.0F};
    static const float least[4] = {0.0F, 0.0F, 0.0F, 0.0F};
    static elmopp_lstm_q15_weights_t whole;
    elmopp_lstm_q15_state_t state = {.hidden = {0}};
    TEST_ASSERT_TRUE(elmopp_lstm_quantize(&weights->lstm, least, weights->high, &whole).made);
    start(kind, weights, mean_veh_per_s);
    for (uint32_t n = 0U; n < 70U; n++) {
        float arrivals_veh[4];
        float input[4];
        for (uint32_t i = 0U; i < 4U; i++) {
            arrivals_veh[i] = some_vehicles();
            input[i] = held_in(arrivals_veh[i] / mean_veh_per_s[i], weights->low[i], weights->high[i]);
        }
        elmopp_forecast_observe(&forecast, arrivals_veh);
        elmopp_lstm_q15_step(&whole, &state, input);
    }
    look(HORIZON);
    for (uint32_t t = 0U; t < HORIZON; t++) {
        float said[4];
        elmopp_lstm_q15_output(&whole, &state, said);
        for (uint32_t i = 0U; i < 4U; i++) {
            said[i] = held_in(said[i], weights->low[i], weights->high[i]);
            TEST_ASSERT_TRUE(said[i] * mean_veh_per_s[i] == rows[i][t]);
        }
        elmopp_lstm_q15_step(&whole, &state, said);
    }
}

static void test_lstm_q15_runs_on_its_own_output_in_whole_numbers(void) {
    expect_like_the_whole_network(&elmopp_weights_lstm, ELMOPP_FORECAST_LSTM_Q15);
}

static void test_nlstm_q15_runs_on_its_own_output_in_whole_numbers(void) {
    expect_like_the_whole_network(&elmopp_weights_nlstm, ELMOPP_FORECAST_NLSTM_Q15);
}

static void expect_rows(bool same, const float before[4][HORIZON]) {
    look(HORIZON);
    TEST_ASSERT_TRUE(same == (memcmp(before, forecast.row_veh, sizeof(float) * 4U * HORIZON) == 0));
}

/* What is learnt on the device changes the weights that the forecast points at. */
static void expect_rearmed(uint8_t kind) {
    static elmopp_weights_t learnt;
    static float before[4][HORIZON];
    const bool whole = kind == (uint8_t)ELMOPP_FORECAST_LSTM_Q15;
    learnt = elmopp_weights_lstm;
    start(kind, &learnt, NULL);
    observe_some(100U);
    look(HORIZON);
    (void)memcpy(before, forecast.row_veh, sizeof before);
    learnt.lstm.head_row[3][0] += 0.25F;
    expect_rows(whole, (const float (*)[HORIZON])before); /* in whole numbers not before it is told */
    elmopp_forecast_rearm(&forecast, &learnt, false);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORECAST_READY, elmopp_forecast_status(&forecast));
    expect_rows(false, (const float (*)[HORIZON])before);
    (void)memcpy(before, forecast.row_veh, sizeof before);
    learnt.lstm.outer.row[0][0] = NAN;
    elmopp_forecast_rearm(&forecast, &learnt, false);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORECAST_UNARMED, elmopp_forecast_status(&forecast));
    expect_rows(false, (const float (*)[HORIZON])before); /* the mean */
    learnt.lstm.outer.row[0][0] = elmopp_weights_lstm.lstm.outer.row[0][0];
    elmopp_forecast_rearm(&forecast, &learnt, false);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORECAST_READY, elmopp_forecast_status(&forecast));
    expect_rows(true, (const float (*)[HORIZON])before);
}

static void test_weights_that_were_learnt_are_used_once_it_is_told(void) {
    expect_rearmed(ELMOPP_FORECAST_LSTM);
    expect_rearmed(ELMOPP_FORECAST_LSTM_Q15);
}

/* Looking is free of consequences: the memory of what was seen is not what ran ahead. */
static void test_looking_twice_says_the_same(void) {
    static float before[4][HORIZON];
    start(ELMOPP_FORECAST_LSTM, &elmopp_weights_lstm, NULL);
    observe_some(100U);
    look(HORIZON);
    (void)memcpy(before, forecast.row_veh, sizeof before);
    look(HORIZON);
    TEST_ASSERT_EQUAL_MEMORY(before, forecast.row_veh, sizeof before);
    look(60U);
    TEST_ASSERT_EQUAL_MEMORY(before[3], forecast.row_veh[3], 60U * sizeof(float));
}

static void test_the_mean_speaks_until_60_seconds_have_been_seen(void) {
    static const float mean_veh_per_s[4] = {1.0F, 2.0F, 3.0F, 4.0F};
    start(ELMOPP_FORECAST_LSTM, &elmopp_weights_lstm, mean_veh_per_s);
    observe_some(59U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORECAST_COLD, elmopp_forecast_status(&forecast));
    expect_mean(mean_veh_per_s);
    observe_some(1U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORECAST_READY, elmopp_forecast_status(&forecast));
    look(1U);
    TEST_ASSERT_FALSE(rows[0][0] == 1.0F);
}

static void expect_unarmed(uint8_t kind, const elmopp_weights_t *weights) {
    static const float mean_veh_per_s[4] = {1.0F, 2.0F, 3.0F, 4.0F};
    start(kind, weights, mean_veh_per_s);
    observe_some(100U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORECAST_UNARMED, elmopp_forecast_status(&forecast));
    expect_mean(mean_veh_per_s);
}

static void test_weights_that_cannot_be_used_leave_the_mean_and_are_told(void) {
    static elmopp_weights_t broken;
    expect_unarmed(ELMOPP_FORECAST_LSTM, NULL);
    expect_unarmed(ELMOPP_FORECAST_LSTM, &elmopp_weights_nlstm);
    expect_unarmed(ELMOPP_FORECAST_NLSTM, &elmopp_weights_lstm);
    expect_unarmed(ELMOPP_FORECAST_LSTM_Q15, NULL);
    expect_unarmed(ELMOPP_FORECAST_LSTM_Q15, &elmopp_weights_nlstm);
    expect_unarmed(ELMOPP_FORECAST_NLSTM_Q15, &elmopp_weights_lstm);
    broken = elmopp_weights_lstm;
    broken.lstm.outer.row[3][5] = NAN;
    expect_unarmed(ELMOPP_FORECAST_LSTM, &broken);
    broken = elmopp_weights_lstm;
    broken.lstm.outer.bias[5] = 200.0F; /* in float that is a gate that is always open */
    expect_unarmed(ELMOPP_FORECAST_LSTM_Q15, &broken);
    start(ELMOPP_FORECAST_LSTM, &broken, NULL);
    observe_some(100U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORECAST_READY, elmopp_forecast_status(&forecast));
    broken = elmopp_weights_nlstm;
    broken.lstm.levels = 4U;
    expect_unarmed(ELMOPP_FORECAST_NLSTM, &broken);
    broken = elmopp_weights_nlstm;
    broken.high[2] = -1.0F;
    expect_unarmed(ELMOPP_FORECAST_NLSTM, &broken);
}

static void test_what_it_says_is_held_in_the_clamp(void) {
    static elmopp_weights_t loud;
    static const float mean_veh_per_s[4] = {1.0F, 2.0F, 1.0F, 1.0F};
    loud = elmopp_weights_lstm;
    loud.lstm.head_bias[0] = 900.0F;
    loud.lstm.head_bias[1] = -900.0F;
    loud.low[1] = 0.25F;
    start(ELMOPP_FORECAST_LSTM, &loud, mean_veh_per_s);
    observe_some(60U);
    look(HORIZON);
    for (uint32_t t = 0U; t < HORIZON; t++) {
        TEST_ASSERT_EQUAL_FLOAT(loud.high[0], rows[0][t]);
        TEST_ASSERT_EQUAL_FLOAT(0.5F, rows[1][t]);
    }
}

static void test_an_approach_without_any_traffic_is_foreseen_without(void) {
    start(ELMOPP_FORECAST_LSTM, &elmopp_weights_lstm, NULL);
    for (uint32_t n = 0U; n < 80U; n++) {
        const float arrivals_veh[ELMOPP_MOVEMENT_MAX] = {some_vehicles(), 0.0F, some_vehicles(), some_vehicles()};
        elmopp_forecast_observe(&forecast, arrivals_veh);
    }
    look(HORIZON);
    for (uint32_t t = 0U; t < HORIZON; t++) {
        TEST_ASSERT_EQUAL_FLOAT(0.0F, rows[1][t]);
        TEST_ASSERT_TRUE(isfinite(rows[0][t]));
    }
}

/* Five approaches: the fifth is the first input of a second state with three inputs of 0, and the first four do not
 * notice it. */
static void test_approaches_are_dealt_in_groups_of_four(void) {
    static float four[4][HORIZON];
    static float arrivals_veh[90][ELMOPP_MOVEMENT_MAX];
    for (uint32_t n = 0U; n < 90U; n++) {
        for (uint32_t j = 0U; j < 5U; j++) {
            arrivals_veh[n][j] = some_vehicles();
        }
    }
    start(ELMOPP_FORECAST_LSTM, &elmopp_weights_lstm, NULL);
    for (uint32_t n = 0U; n < 90U; n++) {
        elmopp_forecast_observe(&forecast, arrivals_veh[n]);
    }
    look(HORIZON);
    (void)memcpy(four, forecast.row_veh, sizeof four);

    set_approaches(5U);
    start(ELMOPP_FORECAST_LSTM, &elmopp_weights_lstm, NULL);
    for (uint32_t n = 0U; n < 90U; n++) {
        elmopp_forecast_observe(&forecast, arrivals_veh[n]);
    }
    look(HORIZON);
    TEST_ASSERT_EQUAL_MEMORY(four, forecast.row_veh, sizeof four);
    static float fifth[HORIZON];
    (void)memcpy(fifth, rows[4], sizeof fifth);
    float sum_veh = 0.0F;
    for (uint32_t t = 0U; t < HORIZON; t++) {
        sum_veh += fifth[t];
    }
    TEST_ASSERT_TRUE(sum_veh > 1.0F); /* rows that nobody filled would be alike, too */

    set_approaches(1U);
    start(ELMOPP_FORECAST_LSTM, &elmopp_weights_lstm, NULL);
    for (uint32_t n = 0U; n < 90U; n++) {
        elmopp_forecast_observe(&forecast, &arrivals_veh[n][4]);
    }
    look(HORIZON);
    TEST_ASSERT_EQUAL_MEMORY(fifth, forecast.row_veh[0], sizeof fifth);
}

/* Run it with sanitizers: a step beyond any array shows there. */
static void test_the_largest_junction_is_forecast_within_its_arrays(void) {
    set_approaches(ELMOPP_APPROACH_MAX);
    start(ELMOPP_FORECAST_NLSTM, &elmopp_weights_nlstm, NULL);
    for (uint32_t n = 0U; n < 100U; n++) {
        observe_some(1U);
        look(HORIZON);
    }
    TEST_ASSERT_TRUE(isfinite(rows[7][HORIZON - 1U]));
}

/* --- the account --- */

static void test_nothing_is_compared_before_the_probe_has_fallen_due(void) {
    start(ELMOPP_FORECAST_MEAN, NULL, NULL);
    for (uint32_t n = 0U; n < PROBE; n++) {
        observe_all(1.0F);
        look(60U);
        TEST_ASSERT_EQUAL_UINT32(0U, elmopp_forecast_error(&forecast).compared_s);
    }
    observe_all(1.0F);
    TEST_ASSERT_EQUAL_UINT32(1U, elmopp_forecast_error(&forecast).compared_s);
}

/* A flat past and a jump of 1: everything that was said before it is wrong by 1, for 30 seconds. */
static void test_the_account_is_the_mean_squared_error_of_what_was_said_30_seconds_before(void) {
    static const float mean_veh_per_s[4] = {3.0F, 3.0F, 3.0F, 3.0F};
    start(ELMOPP_FORECAST_PERSISTENCE, NULL, mean_veh_per_s);
    for (uint32_t n = 0U; n < PROBE; n++) {
        observe_all(1.0F);
        look(60U);
    }
    observe_all(2.0F);
    elmopp_account_error_t error = elmopp_forecast_error(&forecast);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, error.forecast);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, error.persistence);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, error.mean);
    look(60U);
    for (uint32_t n = 1U; n < (4U * PROBE); n++) {
        observe_all(2.0F);
        look(60U);
    }
    error = elmopp_forecast_error(&forecast);
    TEST_ASSERT_EQUAL_UINT32(4U * PROBE, error.compared_s);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 0.25F, error.persistence);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 0.25F, error.forecast);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, error.mean);
}

static void test_every_approach_counts_in_the_account(void) {
    start(ELMOPP_FORECAST_PERSISTENCE, NULL, NULL);
    for (uint32_t n = 0U; n < PROBE; n++) {
        observe_all(1.0F);
        look(60U);
    }
    const float arrivals_veh[4] = {1.0F, 1.0F, 1.0F, 5.0F};
    elmopp_forecast_observe(&forecast, arrivals_veh);
    TEST_ASSERT_EQUAL_FLOAT(4.0F, elmopp_forecast_error(&forecast).forecast);
}

/* Seconds in which nothing was asked leave no trace: a warm start, or rows that end before the probe. */
static void test_what_was_not_said_is_not_compared(void) {
    start(ELMOPP_FORECAST_PERSISTENCE, NULL, NULL);
    for (uint32_t n = 0U; n < (3U * PROBE); n++) {
        observe_some(1U);
    }
    look((uint16_t)(PROBE - 1U));
    observe_some(3U * PROBE);
    TEST_ASSERT_EQUAL_UINT32(0U, elmopp_forecast_error(&forecast).compared_s);
    look((uint16_t)PROBE);
    observe_some(3U * PROBE);
    TEST_ASSERT_EQUAL_UINT32(1U, elmopp_forecast_error(&forecast).compared_s);
}

static void test_falling_back_gives_the_mean_and_leaves_the_account(void) {
    static const float mean_veh_per_s[4] = {1.0F, 2.0F, 3.0F, 4.0F};
    start(ELMOPP_FORECAST_LSTM, &elmopp_weights_lstm, mean_veh_per_s);
    observe_some(70U);
    look(60U);
    const elmopp_account_probe_t said = forecast.account.probe[(forecast.account.due + PROBE - 1U) % PROBE];
    TEST_ASSERT_TRUE(said.said);
    for (uint32_t i = 0U; i < 4U; i++) {
        TEST_ASSERT_TRUE(said.forecast_veh[i] == rows[i][PROBE - 1U]);
        TEST_ASSERT_FALSE(rows[i][PROBE - 2U] == rows[i][PROBE - 1U]);
        TEST_ASSERT_FALSE(rows[i][PROBE] == rows[i][PROBE - 1U]);
    }
    TEST_ASSERT_EQUAL_UINT16(60U, elmopp_forecast_fall_back(&forecast, 60U, rows));
    for (uint32_t i = 0U; i < 4U; i++) {
        TEST_ASSERT_EQUAL_FLOAT(mean_veh_per_s[i], rows[i][0]);
        TEST_ASSERT_EQUAL_FLOAT(mean_veh_per_s[i], rows[i][59]);
        TEST_ASSERT_FALSE(said.forecast_veh[i] == mean_veh_per_s[i]);
    }
    TEST_ASSERT_NULL(rows[4]);
    TEST_ASSERT_EQUAL_MEMORY(&said, &forecast.account.probe[(forecast.account.due + PROBE - 1U) % PROBE], sizeof said);
    start(ELMOPP_FORECAST_NONE, NULL, NULL);
    TEST_ASSERT_EQUAL_UINT16(0U, elmopp_forecast_fall_back(&forecast, 60U, rows));
    TEST_ASSERT_NULL(rows[0]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_lstm_absorbs_every_second_and_runs_on_its_own_output);
    RUN_TEST(test_nlstm_absorbs_every_second_and_runs_on_its_own_output);
    RUN_TEST(test_a_network_that_is_shown_counts_is_corrected_by_a_tenth_of_their_surprise);
    RUN_TEST(test_counts_that_come_as_they_were_said_leave_the_rows_as_they_were);
    RUN_TEST(test_only_a_network_is_shown_less_than_a_count);
    RUN_TEST(test_lstm_q15_runs_on_its_own_output_in_whole_numbers);
    RUN_TEST(test_nlstm_q15_runs_on_its_own_output_in_whole_numbers);
    RUN_TEST(test_weights_that_were_learnt_are_used_once_it_is_told);
    RUN_TEST(test_looking_twice_says_the_same);
    RUN_TEST(test_the_mean_speaks_until_60_seconds_have_been_seen);
    RUN_TEST(test_weights_that_cannot_be_used_leave_the_mean_and_are_told);
    RUN_TEST(test_what_it_says_is_held_in_the_clamp);
    RUN_TEST(test_an_approach_without_any_traffic_is_foreseen_without);
    RUN_TEST(test_approaches_are_dealt_in_groups_of_four);
    RUN_TEST(test_the_largest_junction_is_forecast_within_its_arrays);
    RUN_TEST(test_nothing_is_compared_before_the_probe_has_fallen_due);
    RUN_TEST(test_the_account_is_the_mean_squared_error_of_what_was_said_30_seconds_before);
    RUN_TEST(test_every_approach_counts_in_the_account);
    RUN_TEST(test_what_was_not_said_is_not_compared);
    RUN_TEST(test_falling_back_gives_the_mean_and_leaves_the_account);
    return UNITY_END();
}
