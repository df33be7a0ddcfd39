/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Every promise that only a bug can break ends in elmopp_assert_failed().

#include "assert_catcher.h"
#include "elmopp/pilot.h"
#include "elmopp/pressure.h"
#include "elmopp/urgency.h"
#include "sites.h"
#include "unity.h"
#include "view.h"

#include <stddef.h>

static elmopp_junction_t junction;
static elmopp_forecast_t forecast;
static elmopp_urgency_t urgency;
static elmopp_plan_t plan;
static elmopp_pilot_t pilot;
static elmopp_stage_t answer;
static const float nothing_veh[ELMOPP_MOVEMENT_MAX];
static const elmopp_counts_t empty_road = {nothing_veh, nothing_veh, 0U, NULL};

static elmopp_stage_t choose_answer(void *state, const elmopp_view_t *view, float score[ELMOPP_STAGE_MAX]) {
    (void)state;
    (void)view;
    score[0] = 0.0F;
    return answer;
}

static const elmopp_forecast_config_t no_forecast = {.kind = ELMOPP_FORECAST_NONE};
static const elmopp_chooser_t scripted = {.choose = choose_answer};

void setUp(void) {
    junction = test_cross(4U);
    answer = 0U;
}
void tearDown(void) {}

static void test_an_assert_that_holds_goes_on(void) {
    ELMOPP_ASSERT(junction.group_count == 4U);
}

static void test_an_assert_takes_a_condition_of_any_precedence(void) {
    TEST_EXPECT_ASSERT(ELMOPP_ASSERT(junction.group_count == 4U && junction.stage_count == 5U));
    ELMOPP_ASSERT(junction.group_count == 5U || junction.stage_count == 4U);
}

static void test_load_asserts_the_movement(void) {
    TEST_EXPECT_ASSERT((void)elmopp_junction_load(&junction, 4U, 1.0F));
    TEST_EXPECT_ASSERT((void)elmopp_junction_load(&junction, 5U, 1.0F));
    (void)elmopp_junction_load(&junction, 3U, 1.0F);
}

static void test_goes_asserts_the_movement(void) {
    TEST_EXPECT_ASSERT((void)elmopp_junction_goes(&junction, 4U, 1U));
    TEST_EXPECT_ASSERT((void)elmopp_junction_goes(&junction, 5U, 1U));
    (void)elmopp_junction_goes(&junction, 3U, 1U);
}

static void expect_discharge_asserts_the_movement(uint8_t law) {
    junction.discharge = law;
    (void)elmopp_junction_discharge(&junction, 3U, 1.0F);
    TEST_EXPECT_ASSERT((void)elmopp_junction_discharge(&junction, 4U, 1.0F));
    TEST_EXPECT_ASSERT((void)elmopp_junction_discharge(&junction, 5U, 1.0F));
}

static void test_discharge_asserts_the_movement_under_each_law(void) {
    expect_discharge_asserts_the_movement(ELMOPP_DISCHARGE_SATURATION);
    expect_discharge_asserts_the_movement(ELMOPP_DISCHARGE_GREENSHIELDS);
    expect_discharge_asserts_the_movement(ELMOPP_DISCHARGE_NOLOCK);
}

static void start_forecast(uint8_t kind, const elmopp_ar8_t *ar8) {
    const elmopp_forecast_config_t config = {.kind = kind, .ar8 = ar8};
    elmopp_forecast_init(&forecast, &junction, &config);
}

static void test_forecast_asserts_a_known_kind(void) {
    start_forecast(ELMOPP_FORECAST_EWMA, NULL);
    TEST_EXPECT_ASSERT(start_forecast(ELMOPP_FORECAST_COUNT, NULL));
    TEST_EXPECT_ASSERT(start_forecast(255U, NULL));
}

static void test_forecast_asserts_coefficients_for_ar8(void) {
    static const elmopp_ar8_t model[ELMOPP_APPROACH_MAX];
    start_forecast(ELMOPP_FORECAST_AR8, model);
    TEST_EXPECT_ASSERT(start_forecast(ELMOPP_FORECAST_AR8, NULL));
}

static void test_forecast_asserts_the_steps(void) {
    const float *rows[ELMOPP_APPROACH_MAX];
    start_forecast(ELMOPP_FORECAST_MEAN, NULL);
    (void)elmopp_forecast_look(&forecast, ELMOPP_HORIZON_MAX, rows);
    TEST_EXPECT_ASSERT((void)elmopp_forecast_look(&forecast, ELMOPP_HORIZON_MAX + 1U, rows));
    start_forecast(ELMOPP_FORECAST_NONE, NULL);
    TEST_EXPECT_ASSERT((void)elmopp_forecast_look(&forecast, ELMOPP_HORIZON_MAX + 1U, rows));
}

static void start_urgency(uint32_t min_s, uint32_t max_s, float hysteresis) {
    const elmopp_urgency_options_t options = {
        .min_s = (uint16_t)min_s, .max_s = (uint16_t)max_s, .hysteresis = hysteresis};
    (void)elmopp_urgency_init(&urgency, &options);
}

static void test_urgency_asserts_its_window_and_hysteresis(void) {
    start_urgency(1U, 1U, 1.0F);
    start_urgency(ELMOPP_HORIZON_MAX, ELMOPP_HORIZON_MAX, 9.0F);
    TEST_EXPECT_ASSERT(start_urgency(0U, 60U, 1.0F));
    TEST_EXPECT_ASSERT(start_urgency(61U, 60U, 1.0F));
    TEST_EXPECT_ASSERT(start_urgency(10U, ELMOPP_HORIZON_MAX + 1U, 1.0F));
    TEST_EXPECT_ASSERT(start_urgency(10U, 60U, 0.999F));
}

static void start_pressure(float ratio, uint32_t min_s, uint32_t max_s) {
    elmopp_pressure_t pressure = {ratio, (uint16_t)min_s, (uint16_t)max_s};
    (void)elmopp_pressure_init(&pressure);
}

static void test_pressure_asserts_its_window_and_ratio(void) {
    start_pressure(1.0F, 5U, 5U);
    TEST_EXPECT_ASSERT(start_pressure(1.0F, 6U, 5U));
    TEST_EXPECT_ASSERT(start_pressure(0.999F, 5U, 120U));
}

static void start_pilot(const elmopp_chooser_t *chooser) {
    elmopp_pilot_init(&pilot, &junction, chooser, &no_forecast);
}

static void expect_count_asserted(uint8_t *count, uint8_t wrong) {
    junction = test_cross(4U);
    start_pilot(&scripted);
    *count = wrong;
    TEST_EXPECT_ASSERT(start_pilot(&scripted));
}

static void test_pilot_asserts_the_upper_bounds_of_the_counts(void) {
    expect_count_asserted(&junction.approach_count, ELMOPP_APPROACH_MAX + 1U);
    expect_count_asserted(&junction.movement_count, ELMOPP_MOVEMENT_MAX + 1U);
    expect_count_asserted(&junction.group_count, ELMOPP_GROUP_MAX + 1U);
    expect_count_asserted(&junction.stage_count, ELMOPP_STAGE_MAX + 1U);
}

static void test_pilot_asserts_that_nothing_counts_zero(void) {
    expect_count_asserted(&junction.approach_count, 0U);
    expect_count_asserted(&junction.movement_count, 0U);
    expect_count_asserted(&junction.group_count, 0U);
    expect_count_asserted(&junction.stage_count, 0U);
}

static void test_pilot_asserts_the_chooser(void) {
    elmopp_chooser_t chooser = scripted;
    chooser.horizon_s = ELMOPP_HORIZON_MAX;
    start_pilot(&chooser);
    chooser.horizon_s = ELMOPP_HORIZON_MAX + 1U;
    TEST_EXPECT_ASSERT(start_pilot(&chooser));
    chooser.horizon_s = 0U;
    chooser.choose = NULL;
    TEST_EXPECT_ASSERT(start_pilot(&chooser));
}

static void test_pilot_asserts_the_steps_of_an_oracle(void) {
    static const float row_veh[ELMOPP_HORIZON_MAX + 1U];
    elmopp_foreseen_t oracle = {.row_veh = {row_veh, row_veh, row_veh, row_veh}, .steps = ELMOPP_HORIZON_MAX};
    start_pilot(&scripted);
    TEST_ASSERT_TRUE(elmopp_pilot_step(&pilot, &empty_road, &oracle));
    oracle.steps = ELMOPP_HORIZON_MAX + 1U;
    TEST_EXPECT_ASSERT((void)elmopp_pilot_step(&pilot, &empty_road, &oracle));
}

static void test_plan_asserts_the_wish(void) {
    elmopp_plan_init(&plan, &junction);
    (void)elmopp_plan_step(&plan, 3U, 0U, false);
    (void)elmopp_plan_step(&plan, ELMOPP_STAGE_NONE, 0U, false);
    (void)elmopp_plan_step(&plan, ELMOPP_STAGE_RED, 0U, false);
    TEST_EXPECT_ASSERT((void)elmopp_plan_step(&plan, 4U, 0U, false));
    TEST_EXPECT_ASSERT((void)elmopp_plan_step(&plan, 61U, 0U, false));
    TEST_EXPECT_ASSERT((void)elmopp_plan_step(&plan, 64U, 0U, false));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_an_assert_that_holds_goes_on);
    RUN_TEST(test_an_assert_takes_a_condition_of_any_precedence);
    RUN_TEST(test_load_asserts_the_movement);
    RUN_TEST(test_goes_asserts_the_movement);
    RUN_TEST(test_discharge_asserts_the_movement_under_each_law);
    RUN_TEST(test_forecast_asserts_a_known_kind);
    RUN_TEST(test_forecast_asserts_coefficients_for_ar8);
    RUN_TEST(test_forecast_asserts_the_steps);
    RUN_TEST(test_urgency_asserts_its_window_and_hysteresis);
    RUN_TEST(test_pressure_asserts_its_window_and_ratio);
    RUN_TEST(test_pilot_asserts_the_upper_bounds_of_the_counts);
    RUN_TEST(test_pilot_asserts_that_nothing_counts_zero);
    RUN_TEST(test_pilot_asserts_the_chooser);
    RUN_TEST(test_pilot_asserts_the_steps_of_an_oracle);
    RUN_TEST(test_plan_asserts_the_wish);
    return UNITY_END();
}
