/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/station.h"

#include "bench.h"
#include "elmopp_weights.h"
#include "sites.h"

#include "unity.h"

static elmopp_station_t station;
static elmopp_junction_t site;
static const elmopp_ar8_t ar8 = {.intercept = 0.25F};
static elmopp_weights_t weights;

void setUp(void) {
    site = bench_cross(4U);
    site.hold_min_s = 7U;
    site.hold_max_s = 77U;
}

void tearDown(void) {}

static const elmopp_forecast_config_t *forecast(void) {
    return &station.controller.pilot.forecast.config;
}

static void build(uint8_t chooser, uint8_t kind) {
    site.chooser = chooser;
    site.forecast = kind;
    const elmopp_station_weights_t none_learnt = {.base = &weights, .learnt = NULL};
    const elmopp_station_room_t no_room = {.learning = NULL, .inner = NULL};
    elmopp_station_init(&station, &site, &ar8, &none_learnt, &no_room);
}

static void test_naive_has_the_sites_window_and_no_forecast(void) {
    build(ELMOPP_CHOOSER_NAIVE, ELMOPP_FORECAST_LSTM);
    TEST_ASSERT_EQUAL_PTR(&station.urgency, station.controller.pilot.chooser.state);
    TEST_ASSERT_EQUAL_UINT16(7U, station.urgency.options.min_s);
    TEST_ASSERT_EQUAL_UINT16(77U, station.urgency.options.max_s);
    TEST_ASSERT_FALSE(station.urgency.options.cumulative);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_FORECAST_NONE, forecast()->kind);
    TEST_ASSERT_NULL(forecast()->weights);
}

static void test_cumulative_has_the_forecast_that_the_site_names(void) {
    for (uint8_t kind = 0U; kind < (uint8_t)ELMOPP_FORECAST_COUNT; kind++) {
        build(ELMOPP_CHOOSER_CUMULATIVE, kind);
        const bool network = kind >= (uint8_t)ELMOPP_FORECAST_LSTM; /* these four, whatever comes later */
        TEST_ASSERT_EQUAL(network, elmopp_forecast_is_network(kind));
        TEST_ASSERT_TRUE(station.urgency.options.cumulative);
        TEST_ASSERT_EQUAL_UINT8(kind, forecast()->kind);
        TEST_ASSERT_EQUAL_PTR(network ? &weights : NULL, forecast()->weights);
        TEST_ASSERT_EQUAL_FLOAT(0.25F, forecast()->ar8[site.approach_count - 1U].intercept);
        TEST_ASSERT_NULL(forecast()->mean_veh_per_s);
    }
}

static void test_pressure_has_the_sites_window(void) {
    build(ELMOPP_CHOOSER_PRESSURE, ELMOPP_FORECAST_NONE);
    TEST_ASSERT_EQUAL_PTR(&station.pressure, station.controller.pilot.chooser.state);
    TEST_ASSERT_EQUAL_UINT16(7U, station.pressure.min_s);
    TEST_ASSERT_EQUAL_UINT16(77U, station.pressure.max_s);
}

static void test_priced_has_the_sites_window_and_no_forecast(void) {
    build(ELMOPP_CHOOSER_PRICED, ELMOPP_FORECAST_LSTM);
    TEST_ASSERT_EQUAL_PTR(&station.priced, station.controller.pilot.chooser.state);
    TEST_ASSERT_EQUAL_UINT16(7U, station.priced.min_s);
    TEST_ASSERT_EQUAL_UINT16(77U, station.priced.max_s);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_FORECAST_NONE, forecast()->kind);
}

static void test_the_rollout_has_the_sites_window_reach_and_forecast(void) {
    site.reach_m = 100.0F;
    build(ELMOPP_CHOOSER_ROLLOUT, ELMOPP_FORECAST_LSTM);
    TEST_ASSERT_EQUAL_PTR(&station.rollout, station.controller.pilot.chooser.state);
    TEST_ASSERT_EQUAL_UINT16(7U, station.rollout.options.future.min_s);
    TEST_ASSERT_EQUAL_UINT16(77U, station.rollout.options.future.max_s);
    TEST_ASSERT_EQUAL_UINT16(8U, station.rollout.options.sight.travel_s[0]);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_FORECAST_LSTM, forecast()->kind);
    TEST_ASSERT_EQUAL_PTR(&weights, forecast()->weights);
}

/* --- learning on --- */

static elmopp_learning_t learning;
static elmopp_trainer_inner_memory_t inner;
static elmopp_weights_t shipped;
static elmopp_weights_t kept;
static elmopp_station_room_t room;

static void start_to_learn(uint8_t kind, const elmopp_weights_t *stored) {
    site.chooser = ELMOPP_CHOOSER_ROLLOUT;
    site.forecast = kind;
    site.learning = 1U;
    const elmopp_station_weights_t chosen = elmopp_station_weights(&site, &shipped, stored);
    elmopp_station_init(&station, &site, &ar8, &chosen, &room);
}

static void start_with_room(void) {
    room = (elmopp_station_room_t){.learning = &learning, .inner = &inner};
    shipped = elmopp_weights_lstm;
    kept = shipped;
    kept.lstm.head_bias[1] += 0.5F;
}

static void test_a_site_that_learns_has_a_learner_that_begins_with_the_shipped_weights(void) {
    start_with_room();
    start_to_learn(ELMOPP_FORECAST_LSTM, NULL);
    TEST_ASSERT_EQUAL_PTR(&learning.learner, forecast()->learner);
    TEST_ASSERT_EQUAL_PTR(&shipped, learning.learner.shipped);
    TEST_ASSERT_FALSE(elmopp_learner_is_in_use(&learning.learner));
    TEST_ASSERT_TRUE(elmopp_station_learns_as_asked(&station));
    site.learning = 0U;
    const elmopp_station_weights_t chosen = {.base = &shipped, .learnt = NULL};
    elmopp_station_init(&station, &site, &ar8, &chosen, &room);
    TEST_ASSERT_NULL(forecast()->learner);
    TEST_ASSERT_TRUE(elmopp_station_learns_as_asked(&station));
}

static void test_without_room_a_site_runs_with_the_weights_as_they_are_and_it_is_told(void) {
    start_with_room();
    room.learning = NULL;
    start_to_learn(ELMOPP_FORECAST_LSTM, &kept);
    TEST_ASSERT_NULL(forecast()->learner);
    TEST_ASSERT_EQUAL_PTR(&shipped, forecast()->weights);
    TEST_ASSERT_FALSE(elmopp_station_learns_as_asked(&station));
    start_with_room();
    room.inner = NULL; /* as a board has it */
    shipped = elmopp_weights_nlstm;
    start_to_learn(ELMOPP_FORECAST_NLSTM, NULL);
    TEST_ASSERT_NULL(forecast()->learner);
    TEST_ASSERT_FALSE(elmopp_station_learns_as_asked(&station));
    room.inner = &inner;
    start_to_learn(ELMOPP_FORECAST_NLSTM, NULL);
    TEST_ASSERT_EQUAL_PTR(&learning.learner, forecast()->learner);
    TEST_ASSERT_TRUE(elmopp_station_learns_as_asked(&station));
}

static void test_what_was_learnt_is_where_it_goes_on_and_the_shipped_weights_are_what_is_watched(void) {
    elmopp_lstm_f32_weights_t used;
    start_with_room();
    start_to_learn(ELMOPP_FORECAST_LSTM, &kept);
    TEST_ASSERT_EQUAL_PTR(&shipped, forecast()->weights);
    TEST_ASSERT_EQUAL_PTR(&shipped, learning.learner.shipped);
    TEST_ASSERT_TRUE(elmopp_learner_is_in_use(&learning.learner));
    elmopp_learner_copy(&learning.learner, &used);
    TEST_ASSERT_EQUAL_MEMORY(&kept.lstm, &used, sizeof used);
}

static void test_what_was_kept_and_not_learnt_from_the_shipped_weights_takes_their_place(void) {
    start_with_room();
    kept.gcn.head[0] += 0.5F; /* somebody sent it */
    start_to_learn(ELMOPP_FORECAST_LSTM, &kept);
    TEST_ASSERT_EQUAL_PTR(&kept, forecast()->weights);
    TEST_ASSERT_EQUAL_PTR(&kept, learning.learner.shipped);
    TEST_ASSERT_FALSE(elmopp_learner_is_in_use(&learning.learner));
    kept = elmopp_weights_nlstm; /* of no use at this site */
    start_to_learn(ELMOPP_FORECAST_LSTM, &kept);
    TEST_ASSERT_EQUAL_PTR(&shipped, forecast()->weights);
}

static void test_a_site_that_does_not_learn_uses_what_was_kept_as_it_is(void) {
    start_with_room();
    site.learning = 0U;
    site.forecast = ELMOPP_FORECAST_LSTM;
    const elmopp_station_weights_t chosen = elmopp_station_weights(&site, &shipped, &kept);
    TEST_ASSERT_EQUAL_PTR(&kept, chosen.base);
    TEST_ASSERT_NULL(chosen.learnt);
}

static void test_other_weights_in_the_middle_are_learnt_on_from_and_what_was_learnt_comes_back(void) {
    static elmopp_weights_t sent;
    start_with_room();
    start_to_learn(ELMOPP_FORECAST_LSTM, &kept);
    sent = shipped;
    sent.gcn.head[0] += 0.5F;
    const elmopp_station_weights_t trial = elmopp_station_weights(&site, &shipped, &sent);
    elmopp_station_use_weights(&station, &trial);
    TEST_ASSERT_EQUAL_PTR(&sent, forecast()->weights);
    TEST_ASSERT_EQUAL_PTR(&sent, learning.learner.shipped);
    TEST_ASSERT_FALSE(elmopp_learner_is_in_use(&learning.learner));
    const elmopp_station_weights_t withdrawn = elmopp_station_weights(&site, &shipped, &kept);
    elmopp_station_use_weights(&station, &withdrawn);
    TEST_ASSERT_EQUAL_PTR(&shipped, learning.learner.shipped);
    TEST_ASSERT_TRUE(elmopp_learner_is_in_use(&learning.learner));
    TEST_ASSERT_EQUAL_MEMORY(kept.lstm.head_bias, learning.trainer.weight.head_bias, sizeof kept.lstm.head_bias);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_naive_has_the_sites_window_and_no_forecast);
    RUN_TEST(test_cumulative_has_the_forecast_that_the_site_names);
    RUN_TEST(test_pressure_has_the_sites_window);
    RUN_TEST(test_priced_has_the_sites_window_and_no_forecast);
    RUN_TEST(test_the_rollout_has_the_sites_window_reach_and_forecast);
    RUN_TEST(test_a_site_that_learns_has_a_learner_that_begins_with_the_shipped_weights);
    RUN_TEST(test_without_room_a_site_runs_with_the_weights_as_they_are_and_it_is_told);
    RUN_TEST(test_what_was_learnt_is_where_it_goes_on_and_the_shipped_weights_are_what_is_watched);
    RUN_TEST(test_what_was_kept_and_not_learnt_from_the_shipped_weights_takes_their_place);
    RUN_TEST(test_a_site_that_does_not_learn_uses_what_was_kept_as_it_is);
    RUN_TEST(test_other_weights_in_the_middle_are_learnt_on_from_and_what_was_learnt_comes_back);
    return UNITY_END();
}
