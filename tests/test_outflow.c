/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/outflow.h"
#include "unity.h"

#define STEPS 70U
#define UNTOUCHED 9.0F

static float row_veh[STEPS];

void setUp(void) {
    for (uint32_t t = 0U; t < STEPS; t++) {
        row_veh[t] = UNTOUCHED;
    }
}
void tearDown(void) {}

static void expect_span(uint32_t from, uint32_t until, float each_veh) {
    for (uint32_t t = from; t < until; t++) {
        TEST_ASSERT_EQUAL_FLOAT(each_veh, row_veh[t]);
    }
}

static void test_each_span_is_spread_evenly_over_its_seconds(void) {
    const elmopp_outflow_t outflow = {.next10_veh = 2.0F, .next30_veh = 3.0F, .next60_veh = 9.0F, .ahead_s = 60U};
    elmopp_outflow_lay(&outflow, row_veh, STEPS);
    expect_span(0U, 10U, 0.2F);
    expect_span(10U, 30U, 0.05F);
    expect_span(30U, 60U, 0.2F);
    expect_span(60U, STEPS, UNTOUCHED);
}

/* 3 in 10 to 30 s, but all of them before 14 s: the road takes no longer. */
static void test_nothing_is_said_beyond_the_time_that_the_road_takes(void) {
    const elmopp_outflow_t outflow = {.next10_veh = 1.0F, .next30_veh = 4.0F, .next60_veh = 4.0F, .ahead_s = 14U};
    elmopp_outflow_lay(&outflow, row_veh, STEPS);
    expect_span(0U, 10U, 0.1F);
    expect_span(10U, 14U, 0.75F);
    expect_span(14U, STEPS, UNTOUCHED);
}

static void test_what_was_said_some_seconds_ago_is_so_much_nearer(void) {
    const elmopp_outflow_t outflow = {
        .next10_veh = 1.0F, .next30_veh = 4.0F, .next60_veh = 4.0F, .ahead_s = 14U, .age_s = 2U};
    elmopp_outflow_lay(&outflow, row_veh, STEPS);
    expect_span(0U, 8U, 0.1F);
    expect_span(8U, 12U, 0.75F);
    expect_span(12U, STEPS, UNTOUCHED);
}

static void test_a_row_is_never_written_beyond_its_end(void) {
    const elmopp_outflow_t outflow = {.next10_veh = 10.0F, .next30_veh = 30.0F, .next60_veh = 60.0F, .ahead_s = 60U};
    for (uint32_t steps = 0U; steps < 60U; steps++) {
        setUp();
        elmopp_outflow_lay(&outflow, row_veh, steps);
        expect_span(0U, steps, 1.0F);
        expect_span(steps, STEPS, UNTOUCHED);
    }
}

static void test_a_span_that_holds_fewer_than_the_one_before_it_is_empty(void) {
    const elmopp_outflow_t outflow = {.next10_veh = 5.0F, .next30_veh = 2.0F, .next60_veh = 3.0F, .ahead_s = 60U};
    elmopp_outflow_lay(&outflow, row_veh, STEPS);
    expect_span(0U, 10U, 0.5F);
    expect_span(10U, 30U, 0.0F);
    expect_span(30U, 60U, 1.0F / 30.0F);
}

static void test_it_is_known_as_long_as_it_speaks_of_seconds_to_come(void) {
    const elmopp_outflow_t nobody = {.next10_veh = 0.0F};
    const elmopp_outflow_t nothing_comes = {.ahead_s = 1U};
    const elmopp_outflow_t last = {.ahead_s = 3U, .age_s = 2U};
    const elmopp_outflow_t over = {.next10_veh = 1.0F, .ahead_s = 3U, .age_s = 3U};
    TEST_ASSERT_FALSE(elmopp_outflow_is_known(&nobody));
    TEST_ASSERT_TRUE(elmopp_outflow_is_known(&nothing_comes));
    TEST_ASSERT_TRUE(elmopp_outflow_is_known(&last));
    TEST_ASSERT_FALSE(elmopp_outflow_is_known(&over));
    elmopp_outflow_lay(&over, row_veh, STEPS);
    expect_span(0U, STEPS, UNTOUCHED);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_each_span_is_spread_evenly_over_its_seconds);
    RUN_TEST(test_nothing_is_said_beyond_the_time_that_the_road_takes);
    RUN_TEST(test_what_was_said_some_seconds_ago_is_so_much_nearer);
    RUN_TEST(test_a_row_is_never_written_beyond_its_end);
    RUN_TEST(test_a_span_that_holds_fewer_than_the_one_before_it_is_empty);
    RUN_TEST(test_it_is_known_as_long_as_it_speaks_of_seconds_to_come);
    return UNITY_END();
}
