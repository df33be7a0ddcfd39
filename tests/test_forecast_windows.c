/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The forecasts `ann` and `gcn`: which windows the networks are shown, how they run on their own output, over which
/// graph, and when the mean speaks for them; and what any forecast does with what a neighbour has announced.

#include "assert_catcher.h"
#include "elmopp/forecast.h"
#include "elmopp_weights.h"
#include "random.h"
#include "sites.h"
#include "unity.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#define HORIZON ELMOPP_HORIZON_MAX
#define PAST ELMOPP_FORECAST_PAST_S
#define SEEN_S 70U

static const uint8_t kinds[2] = {ELMOPP_FORECAST_ANN, ELMOPP_FORECAST_GCN};

static elmopp_junction_t junction;
static elmopp_forecast_t forecast;
static const float *rows[ELMOPP_APPROACH_MAX];
static float seen_veh[SEEN_S][ELMOPP_MOVEMENT_MAX];
static float said[ELMOPP_APPROACH_MAX][PAST + HORIZON]; ///< the test's own windows, in units of the demand scale
static uint64_t random_state;

/* One movement an approach, every pair of which conflicts. */
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
    for (uint32_t n = 0U; n < SEEN_S; n++) {
        for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
            seen_veh[n][j] = (float)random_below(&random_state, 2000U) / 1000.0F;
        }
    }
}
void tearDown(void) {}

static void start(uint8_t kind, const elmopp_weights_t *weights, const float *mean_veh_per_s) {
    const elmopp_forecast_config_t config = {.kind = kind, .mean_veh_per_s = mean_veh_per_s, .weights = weights};
    elmopp_forecast_init(&forecast, &junction, &config);
}

static void observe(uint32_t seconds) {
    for (uint32_t n = 0U; n < seconds; n++) {
        elmopp_forecast_observe(&forecast, seen_veh[n]);
    }
}

static void look(void) {
    TEST_ASSERT_EQUAL_UINT16(HORIZON, elmopp_forecast_look(&forecast, HORIZON, rows));
}

static float held_in(float value, float low, float high) {
    return fminf(fmaxf(value, low), high);
}

static const float mean_veh_per_s[ELMOPP_APPROACH_MAX] = {0.5F, 1.0F, 0.25F, 2.0F, 1.5F, 0.75F, 1.0F, 1.25F};

/* What the kind may see and say of an approach. */
static float held(uint8_t kind, uint32_t approach, float value) {
    const elmopp_weights_t *weights = &elmopp_weights_lstm;
    return (kind == (uint8_t)ELMOPP_FORECAST_GCN)
               ? held_in(value, weights->ar8.low, weights->ar8.high)
               : held_in(value, weights->low[approach % 4U], weights->high[approach % 4U]);
}

/* One step of the test's own run: what comes after `t` seconds of it. */
static void say_by_hand(uint8_t kind, uint32_t t, float next[ELMOPP_APPROACH_MAX]) {
    const float *window[ELMOPP_APPROACH_MAX];
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        window[i] = &said[i][t + ((kind == (uint8_t)ELMOPP_FORECAST_GCN) ? 0U : (PAST - ELMOPP_ANN_WINDOW_S))];
    }
    if (kind == (uint8_t)ELMOPP_FORECAST_GCN) {
        static const uint8_t all[ELMOPP_GCN_NODES_MAX] = {0xFFU, 0xFFU, 0xFFU, 0xFFU, 0xFFU, 0xFFU, 0xFFU, 0xFFU};
        elmopp_gcn_f32_graph_t graph;
        elmopp_gcn_f32_join(&graph, junction.approach_count, all);
        elmopp_gcn_f32_next(&elmopp_weights_lstm.gcn, &graph, window, next);
    } else {
        elmopp_ann_f32_next(&elmopp_weights_lstm.ann, &window[0], &next[0]);
        elmopp_ann_f32_next(&elmopp_weights_lstm.ann, &window[4], &next[4]);
    }
}

/* The same by hand: windows in units of the mean, run on the clamped output, give back vehicles. Bit for bit. */
static void expect_like_the_network(uint8_t kind) {
    start(kind, &elmopp_weights_lstm, mean_veh_per_s);
    seen_veh[SEEN_S - 5U][0] = 100.0F; /* far out of the range */
    observe(SEEN_S);
    (void)memset(said, 0, sizeof said);
    for (uint32_t i = 0U; i < junction.approach_count; i++) {
        for (uint32_t k = 0U; k < PAST; k++) {
            said[i][k] = held(kind, i, seen_veh[(SEEN_S - PAST) + k][i] / mean_veh_per_s[i]);
        }
    }
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORECAST_READY, elmopp_forecast_status(&forecast));
    look();
    for (uint32_t t = 0U; t < HORIZON; t++) {
        float next[ELMOPP_APPROACH_MAX];
        say_by_hand(kind, t, next);
        for (uint32_t i = 0U; i < junction.approach_count; i++) {
            said[i][PAST + t] = held(kind, i, next[i]);
            TEST_ASSERT_TRUE((said[i][PAST + t] * mean_veh_per_s[i]) == rows[i][t]);
        }
    }
}

static void test_the_networks_see_the_last_seconds_and_run_on_their_own_output(void) {
    for (uint32_t k = 0U; k < 2U; k++) {
        expect_like_the_network(kinds[k]);
    }
}

/* ann in two groups, the second with inputs of 0; gcn with a node for each, also for one alone and for eight. */
static void test_any_number_of_approaches_is_forecast(void) {
    static const uint32_t counts[4] = {1U, 3U, 5U, ELMOPP_APPROACH_MAX};
    for (uint32_t c = 0U; c < 4U; c++) {
        set_approaches(counts[c]);
        expect_like_the_network(ELMOPP_FORECAST_ANN);
        expect_like_the_network(ELMOPP_FORECAST_GCN);
    }
}

/* By hand: what the network would have said, and a twentieth of what the count says more. */
static void expect_like_the_observer(uint8_t kind) {
    const elmopp_forecast_config_t config = {
        .kind = kind, .mean_veh_per_s = mean_veh_per_s, .weights = &elmopp_weights_lstm, .whole = true};
    elmopp_forecast_init(&forecast, &junction, &config);
    (void)memset(said, 0, sizeof said);
    for (uint32_t n = 0U; n < SEEN_S; n++) {
        float next[ELMOPP_APPROACH_MAX];
        float counted_veh[ELMOPP_MOVEMENT_MAX];
        say_by_hand(kind, n, next);
        for (uint32_t i = 0U; i < junction.approach_count; i++) {
            counted_veh[i] = (float)random_below(&random_state, 3U);
            const float said_veh = held(kind, i, next[i]) * mean_veh_per_s[i];
            const float gain = fmaxf(0.05F, 1.0F / (float)(n + 1U));
            const float believed_veh = said_veh + (gain * (counted_veh[i] - said_veh));
            said[i][PAST + n] = held(kind, i, believed_veh / mean_veh_per_s[i]);
        }
        elmopp_forecast_observe(&forecast, counted_veh);
    }
    look();
    float next[ELMOPP_APPROACH_MAX];
    say_by_hand(kind, SEEN_S, next);
    for (uint32_t i = 0U; i < junction.approach_count; i++) {
        TEST_ASSERT_TRUE((held(kind, i, next[i]) * mean_veh_per_s[i]) == rows[i][0]);
    }
}

static void test_windows_that_are_shown_counts_are_corrected_by_a_twentieth_of_their_surprise(void) {
    for (uint32_t k = 0U; k < 2U; k++) {
        expect_like_the_observer(kinds[k]);
    }
}

static void test_looking_twice_says_the_same(void) {
    for (uint32_t k = 0U; k < 2U; k++) {
        static float before[ELMOPP_APPROACH_MAX][HORIZON];
        start(kinds[k], &elmopp_weights_lstm, NULL);
        observe(SEEN_S);
        look();
        (void)memcpy(before, forecast.row_veh, sizeof before);
        look();
        TEST_ASSERT_EQUAL_MEMORY(before, forecast.row_veh, sizeof before);
    }
}

static void expect_mean(void) {
    look();
    for (uint32_t i = 0U; i < junction.approach_count; i++) {
        for (uint32_t t = 0U; t < HORIZON; t++) {
            TEST_ASSERT_EQUAL_FLOAT(mean_veh_per_s[i], rows[i][t]);
        }
    }
}

static void test_the_mean_speaks_until_60_seconds_have_been_seen(void) {
    for (uint32_t k = 0U; k < 2U; k++) {
        start(kinds[k], &elmopp_weights_lstm, mean_veh_per_s);
        observe(59U);
        TEST_ASSERT_EQUAL_INT(ELMOPP_FORECAST_COLD, elmopp_forecast_status(&forecast));
        expect_mean();
        observe(1U);
        TEST_ASSERT_EQUAL_INT(ELMOPP_FORECAST_READY, elmopp_forecast_status(&forecast));
        look();
        TEST_ASSERT_FALSE(rows[0][0] == mean_veh_per_s[0]);
    }
}

static void expect_unarmed(uint8_t kind, const elmopp_weights_t *weights) {
    TEST_ASSERT_FALSE(elmopp_forecast_fits(kind, weights));
    start(kind, weights, mean_veh_per_s);
    observe(SEEN_S);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORECAST_UNARMED, elmopp_forecast_status(&forecast));
    expect_mean();
}

/* A fault anywhere refuses the whole image, also one in a network that is not asked. */
static void test_weights_that_cannot_be_used_leave_the_mean_and_are_told(void) {
    static elmopp_weights_t broken;
    for (uint32_t k = 0U; k < 2U; k++) {
        expect_unarmed(kinds[k], NULL);
        broken = elmopp_weights_lstm;
        broken.ann.second_row[3][5] = NAN;
        expect_unarmed(kinds[k], &broken);
        broken = elmopp_weights_lstm;
        broken.gcn.head_bias = INFINITY;
        expect_unarmed(kinds[k], &broken);
        broken = elmopp_weights_nlstm;
        broken.lstm.levels = 4U;
        expect_unarmed(kinds[k], &broken);
    }
}

static void test_both_images_hold_both_networks_and_a_recurrent_one(void) {
    for (uint32_t k = 0U; k < 2U; k++) {
        TEST_ASSERT_TRUE(elmopp_forecast_fits(kinds[k], &elmopp_weights_lstm));
        TEST_ASSERT_TRUE(elmopp_forecast_fits(kinds[k], &elmopp_weights_nlstm));
    }
    TEST_ASSERT_TRUE(elmopp_forecast_fits(ELMOPP_FORECAST_LSTM, &elmopp_weights_lstm));
    TEST_ASSERT_FALSE(elmopp_forecast_fits(ELMOPP_FORECAST_LSTM, &elmopp_weights_nlstm));
    TEST_ASSERT_TRUE(elmopp_forecast_fits(ELMOPP_FORECAST_NLSTM, &elmopp_weights_nlstm));
    TEST_ASSERT_FALSE(elmopp_forecast_fits(ELMOPP_FORECAST_NLSTM, &elmopp_weights_lstm));
    TEST_ASSERT_FALSE(elmopp_forecast_fits(ELMOPP_FORECAST_AR8, &elmopp_weights_lstm));
}

/* The plain network's clamp is each input's, the graph's is one for all of its nodes. */
static void test_what_they_say_is_held_in_the_clamp(void) {
    static elmopp_weights_t loud;
    loud = elmopp_weights_lstm;
    loud.ann.head_bias[0] = 900.0F;
    loud.ann.head_bias[1] = -900.0F;
    loud.gcn.head_bias = 900.0F;
    start(ELMOPP_FORECAST_ANN, &loud, mean_veh_per_s);
    observe(SEEN_S);
    look();
    for (uint32_t t = 0U; t < HORIZON; t++) {
        TEST_ASSERT_TRUE(rows[0][t] == (loud.high[0] * mean_veh_per_s[0]));
        TEST_ASSERT_TRUE(rows[1][t] == (loud.low[1] * mean_veh_per_s[1]));
    }
    start(ELMOPP_FORECAST_GCN, &loud, mean_veh_per_s);
    observe(SEEN_S);
    look();
    for (uint32_t i = 0U; i < 4U; i++) {
        TEST_ASSERT_TRUE(rows[i][HORIZON - 1U] == (loud.ar8.high * mean_veh_per_s[i]));
    }
}

static void test_an_approach_without_any_traffic_is_foreseen_without(void) {
    for (uint32_t n = 0U; n < SEEN_S; n++) {
        seen_veh[n][1] = 0.0F;
    }
    for (uint32_t k = 0U; k < 2U; k++) {
        start(kinds[k], &elmopp_weights_lstm, NULL);
        observe(SEEN_S);
        look();
        for (uint32_t t = 0U; t < HORIZON; t++) {
            TEST_ASSERT_EQUAL_FLOAT(0.0F, rows[1][t]);
            TEST_ASSERT_TRUE(isfinite(rows[0][t]));
        }
    }
}

/* --- the graph --- */

static bool meet(uint32_t a, uint32_t b) {
    return forecast.graph.mix[a][b] > 0.0F;
}

/* Groups 0 and 1 may be green together, so their approaches do not meet; every other pair does. */
static void test_approaches_are_joined_that_meet_in_the_junction(void) {
    junction.conflict[0] &= (uint16_t)~2U;
    junction.conflict[1] &= (uint16_t)~1U;
    start(ELMOPP_FORECAST_GCN, &elmopp_weights_lstm, NULL);
    TEST_ASSERT_EQUAL_UINT32(4U, forecast.graph.nodes);
    for (uint32_t a = 0U; a < 4U; a++) {
        for (uint32_t b = 0U; b < 4U; b++) {
            TEST_ASSERT_EQUAL((a == b) || ((a + b) != 1U), meet(a, b));
        }
    }
}

/* One movement that is in the way of another approach's is enough. */
static void test_an_approach_meets_by_any_of_its_movements(void) {
    junction = test_cross(4U);
    junction.approach_count = 2U;
    for (uint32_t j = 0U; j < 4U; j++) {
        junction.movement[j].approach = (uint8_t)(j / 2U);
        junction.conflict[j] = 0U;
    }
    start(ELMOPP_FORECAST_GCN, &elmopp_weights_lstm, NULL);
    TEST_ASSERT_FALSE(meet(0U, 1U));
    junction.conflict[1] = 8U;
    junction.conflict[3] = 2U;
    start(ELMOPP_FORECAST_GCN, &elmopp_weights_lstm, NULL);
    TEST_ASSERT_TRUE(meet(0U, 1U));
    TEST_ASSERT_TRUE(meet(1U, 0U));
}

/* It was trained on that graph. */
static void test_the_papers_junction_is_a_complete_graph(void) {
    junction = elmopp_site_paper;
    start(ELMOPP_FORECAST_GCN, &elmopp_weights_lstm, NULL);
    for (uint32_t a = 0U; a < 4U; a++) {
        for (uint32_t b = 0U; b < 4U; b++) {
            TEST_ASSERT_EQUAL_FLOAT(0.25F, forecast.graph.mix[a][b]);
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_networks_see_the_last_seconds_and_run_on_their_own_output);
    RUN_TEST(test_any_number_of_approaches_is_forecast);
    RUN_TEST(test_windows_that_are_shown_counts_are_corrected_by_a_twentieth_of_their_surprise);
    RUN_TEST(test_looking_twice_says_the_same);
    RUN_TEST(test_the_mean_speaks_until_60_seconds_have_been_seen);
    RUN_TEST(test_weights_that_cannot_be_used_leave_the_mean_and_are_told);
    RUN_TEST(test_both_images_hold_both_networks_and_a_recurrent_one);
    RUN_TEST(test_what_they_say_is_held_in_the_clamp);
    RUN_TEST(test_an_approach_without_any_traffic_is_foreseen_without);
    RUN_TEST(test_approaches_are_joined_that_meet_in_the_junction);
    RUN_TEST(test_an_approach_meets_by_any_of_its_movements);
    RUN_TEST(test_the_papers_junction_is_a_complete_graph);
    return UNITY_END();
}
