/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/station.h"

#include "bench.h"
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
    elmopp_station_init(&station, &site, &ar8, &weights);
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

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_naive_has_the_sites_window_and_no_forecast);
    RUN_TEST(test_cumulative_has_the_forecast_that_the_site_names);
    RUN_TEST(test_pressure_has_the_sites_window);
    RUN_TEST(test_priced_has_the_sites_window_and_no_forecast);
    RUN_TEST(test_the_rollout_has_the_sites_window_reach_and_forecast);
    return UNITY_END();
}
