/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "assert_catcher.h"
#include "elmopp/sight.h"
#include "random.h"
#include "sites.h"
#include "unity.h"
#include "view.h"

#include <math.h>

#define TRAVEL_S 4U

#ifndef SECONDS
#define SECONDS 100000U
#endif

/* Two stages of one movement each: capacity 10 vehicles, saturation flow 0.5, start-up 2 s, one lane. */
static elmopp_junction_t junction;
static elmopp_sight_t sight;
static test_view_t seen;

static void start(uint16_t travel_s) {
    const elmopp_sight_options_t options = elmopp_sight_defaults(travel_s);
    elmopp_sight_init(&sight, &junction, &options);
    test_view_init(&seen, &junction);
}

void setUp(void) {
    junction = test_cross(2U);
    start(TRAVEL_S);
}
void tearDown(void) {}

/* One second in which so many came to movement 0 and so many are there. */
static void second(float arrived_veh, float present_veh) {
    seen.arrivals_veh[0] = arrived_veh;
    seen.queue_veh[0] = present_veh;
    elmopp_sight_observe(&sight, &seen.view);
}

/* The same so many times, while stage 0 is shown for longer and longer. */
static void seconds_of_green(uint32_t count, float arrived_veh, float present_veh) {
    for (uint32_t t = 0U; t < count; t++) {
        test_view_show(&seen, 0U, (uint32_t)seen.view.elapsed_ds + 10U);
        second(arrived_veh, present_veh);
    }
}

static void seconds_of_red(uint32_t count, float present_veh) {
    test_view_show(&seen, 1U, 10U);
    for (uint32_t t = 0U; t < count; t++) {
        second(0.0F, present_veh);
    }
}

static uint16_t travel_s(float reach_m, uint8_t limit_km_per_h) {
    junction.reach_m = reach_m;
    junction.movement[0].limit_km_per_h = limit_km_per_h;
    return elmopp_sight_travel_s(&junction, 0U);
}

static void test_a_reach_takes_whole_seconds_at_free_flow(void) {
    TEST_ASSERT_EQUAL_UINT16(0U, travel_s(0.0F, 0U));
    TEST_ASSERT_EQUAL_UINT16(1U, travel_s(17.9F, 0U));
    TEST_ASSERT_EQUAL_UINT16(2U, travel_s(18.0F, 0U));
    TEST_ASSERT_EQUAL_UINT16(8U, travel_s(100.0F, 0U));
    TEST_ASSERT_EQUAL_UINT16(12U, travel_s(144.0F, 0U));
    TEST_ASSERT_EQUAL_UINT16(12U, travel_s(1.0e6F, 0U));
}

/* 0.864 of the limit: 100 m at 70 km/h take 5.95 s, at 40 km/h 10.4, at 30 km/h 13.9. */
static void test_a_reach_takes_longer_where_the_limit_is_lower(void) {
    TEST_ASSERT_EQUAL_UINT16(8U, travel_s(100.0F, 50U));
    TEST_ASSERT_EQUAL_UINT16(6U, travel_s(100.0F, 70U));
    TEST_ASSERT_EQUAL_UINT16(10U, travel_s(100.0F, 40U));
    TEST_ASSERT_EQUAL_UINT16(12U, travel_s(100.0F, 30U));
}

static void test_a_site_gives_each_movement_the_travel_time_of_its_approach(void) {
    junction.reach_m = 100.0F;
    junction.movement[1].limit_km_per_h = 70U;
    const elmopp_sight_options_t options = elmopp_sight_of_site(&junction);
    TEST_ASSERT_EQUAL_UINT16(8U, options.travel_s[0]);
    TEST_ASSERT_EQUAL_UINT16(6U, options.travel_s[1]);
    elmopp_sight_init(&sight, &junction, &options);
    test_view_init(&seen, &junction);
    seen.arrivals_veh[1] = 1.0F;
    seen.queue_veh[1] = 1.0F;
    second(1.0F, 1.0F);
    seen.arrivals_veh[1] = 0.0F;
    for (uint32_t t = 1U; t < 6U; t++) {
        second(0.0F, 1.0F);
        TEST_ASSERT_EQUAL_FLOAT(0.0F, sight.queued_veh[1]);
    }
    second(0.0F, 1.0F);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, sight.queued_veh[1]);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, sight.queued_veh[0]);
}

static void test_the_defaults_are_those_of_the_research(void) {
    const elmopp_sight_options_t options = elmopp_sight_defaults(8U);
    TEST_ASSERT_EQUAL_UINT16(8U, options.travel_s[0]);
    TEST_ASSERT_EQUAL_UINT16(8U, options.travel_s[ELMOPP_MOVEMENT_MAX - 1U]);
    TEST_ASSERT_EQUAL_UINT16(120U, options.mean_window_s);
    TEST_ASSERT_EQUAL_UINT16(8U, options.block_s);
    TEST_ASSERT_EQUAL_FLOAT(30.0F, options.prior_s);
    TEST_ASSERT_EQUAL_FLOAT(1.0F / 600.0F, options.forget_per_s);
}

static void test_who_has_just_come_drives_for_travel_s_and_is_queued_then(void) {
    second(2.0F, 2.0F);
    for (uint32_t t = 0U; t < TRAVEL_S; t++) {
        TEST_ASSERT_EQUAL_FLOAT(0.0F, sight.queued_veh[0]);
        TEST_ASSERT_EQUAL_FLOAT(2.0F, sight.due_veh[0][TRAVEL_S - 1U - t]);
        second(0.0F, 2.0F);
    }
    TEST_ASSERT_EQUAL_FLOAT(2.0F, sight.queued_veh[0]);
}

static void test_who_was_there_at_the_start_is_queued(void) {
    second(1.0F, 5.0F);
    TEST_ASSERT_EQUAL_FLOAT(4.0F, sight.queued_veh[0]);
}

static void test_if_fewer_are_there_than_drive_the_oldest_have_left(void) {
    second(1.0F, 1.0F);
    second(1.0F, 2.0F);
    second(1.0F, 1.5F);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, sight.queued_veh[0]);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, sight.due_veh[0][1]);
    TEST_ASSERT_EQUAL_FLOAT(0.5F, sight.due_veh[0][2]);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, sight.due_veh[0][3]);
}

static void test_without_a_reach_everybody_is_queued(void) {
    start(0U);
    second(3.0F, 7.0F);
    TEST_ASSERT_EQUAL_FLOAT(7.0F, sight.queued_veh[0]);
}

static void test_the_mean_of_arrivals_is_exact_at_first(void) {
    second(1.0F, 1.0F);
    second(0.0F, 1.0F);
    second(2.0F, 3.0F);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 1.0F, sight.mean_veh_per_s[0]);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, sight.mean_veh_per_s[1]);
}

static void test_the_mean_of_arrivals_forgets_over_its_window(void) {
    for (uint32_t t = 0U; t < 120U; t++) {
        second(1.0F, 1.0F);
    }
    second(0.0F, 1.0F);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 119.0F / 120.0F, sight.mean_veh_per_s[0]);
}

/* 0.85 of 10 vehicles are a full reach. Half a vehicle a second should come. */
static void test_behind_a_full_reach_those_stand_who_should_have_come(void) {
    second(0.5F, 0.5F);
    second(0.0F, 8.5F);
    second(0.0F, 8.5F);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, sight.hidden_veh[0]);
    TEST_ASSERT_EQUAL_FLOAT(0.5F, sight.mean_veh_per_s[0]);
    second(1.0F, 9.5F);
    TEST_ASSERT_EQUAL_FLOAT(0.5F, sight.hidden_veh[0]);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 0.5F + (0.5F / 4.0F), sight.mean_veh_per_s[0]);
    second(0.0F, 8.4F);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, sight.hidden_veh[0]);
}

static void test_no_more_are_hidden_than_the_reach_holds(void) {
    second(5.0F, 5.0F);
    for (uint32_t t = 0U; t < 10U; t++) {
        second(0.0F, 10.0F);
    }
    TEST_ASSERT_EQUAL_FLOAT(10.0F, sight.hidden_veh[0]);
}

static void test_without_a_reach_nobody_is_hidden(void) {
    start(0U);
    second(0.5F, 10.0F);
    second(0.0F, 10.0F);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, sight.hidden_veh[0]);
}

static void test_the_clock_starts_when_somebody_is_there(void) {
    seconds_of_red(5U, 0.0F);
    TEST_ASSERT_EQUAL_UINT16(0U, sight.red_s[0]);
    seconds_of_red(5U, 1.0F);
    TEST_ASSERT_EQUAL_UINT16(5U, sight.red_s[0]);
}

static void test_the_clock_restarts_on_a_departure_and_not_on_green(void) {
    seconds_of_red(5U, 3.0F);
    seconds_of_green(4U, 0.0F, 3.0F);
    TEST_ASSERT_EQUAL_UINT16(9U, sight.red_s[0]);
    seconds_of_green(1U, 0.0F, 2.0F);
    TEST_ASSERT_EQUAL_UINT16(0U, sight.red_s[0]);
}

static void test_who_leaves_on_red_does_not_restart_the_clock(void) {
    seconds_of_red(5U, 3.0F);
    seconds_of_red(1U, 2.0F);
    TEST_ASSERT_EQUAL_UINT16(6U, sight.red_s[0]);
}

static void test_a_green_with_nobody_there_restarts_the_clock(void) {
    seconds_of_red(5U, 1.0F);
    seconds_of_red(1U, 0.0F);
    TEST_ASSERT_EQUAL_UINT16(6U, sight.red_s[0]);
    seconds_of_green(2U, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT16(0U, sight.red_s[0]);
}

static void test_the_clock_saturates(void) {
    seconds_of_red(70000U, 1.0F);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, sight.red_s[0]);
}

static void test_at_first_a_stage_has_the_sites_flows(void) {
    TEST_ASSERT_EQUAL_FLOAT(0.5F, sight.flow_veh_per_s[0][0]);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, sight.flow_veh_per_s[0][1]);
    TEST_ASSERT_EQUAL_FLOAT(0.5F, sight.flow_veh_per_s[1][1]);
}

/* A queue of 9 that is kept up: what comes leaves, 0.7 vehicles a second. Shown for more than 3.0 s and queued a second
   ago, it tells; the prior is 30 s of 0.5. */
static void test_a_standing_queue_teaches_the_flow(void) {
    start(0U);
    seconds_of_green(3U, 0.7F, 9.0F);
    TEST_ASSERT_EQUAL_FLOAT(0.5F, sight.flow_veh_per_s[0][0]);
    seconds_of_green(1U, 0.7F, 9.0F);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, (15.0F + 0.7F) / 31.0F, sight.flow_veh_per_s[0][0]);
    seconds_of_green(1U, 0.7F, 9.0F);
    const float kept = 1.0F - (1.0F / 600.0F);
    const float mean = (15.0F + (0.7F * kept) + 0.7F) / (31.0F + kept);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, mean, sight.flow_veh_per_s[0][0]);
}

static void test_a_short_queue_teaches_nothing(void) {
    start(0U);
    seconds_of_green(30U, 0.1F, 1.9F);
    TEST_ASSERT_EQUAL_FLOAT(0.5F, sight.flow_veh_per_s[0][0]);
}

static void test_another_stage_keeps_its_own_flow(void) {
    junction.stage_groups[1] = 3U; /* serves both */
    start(0U);
    seconds_of_green(30U, 0.9F, 9.0F);
    TEST_ASSERT_TRUE(sight.flow_veh_per_s[0][0] > 0.5F);
    TEST_ASSERT_EQUAL_FLOAT(0.5F, sight.flow_veh_per_s[1][0]);
}

static void test_a_learnt_flow_stays_within_bounds(void) {
    start(0U);
    seconds_of_green(2000U, 1.0e6F, 9.0F);
    TEST_ASSERT_EQUAL_FLOAT(0.7F, sight.flow_veh_per_s[0][0]);
    seconds_of_green(6000U, 0.0F, 9.0F);
    TEST_ASSERT_EQUAL_FLOAT(0.05F, sight.flow_veh_per_s[0][0]);
    TEST_ASSERT_FALSE(elmopp_sight_is_served(&sight, 0U, 0U));
    TEST_ASSERT_TRUE(elmopp_sight_is_served(&sight, 1U, 1U));
}

/* The flow may move by no more than one vehicle a lane in 31 s. */
static void test_one_wild_count_spoils_nothing(void) {
    start(0U);
    seconds_of_green(4U, 0.0F, 9.0F);
    const float before = sight.flow_veh_per_s[0][0];
    seconds_of_green(1U, 1.0e6F, 9.0F);
    TEST_ASSERT_TRUE(sight.flow_veh_per_s[0][0] < (before + (1.0F / 31.0F)));
}

static void test_with_a_law_that_depends_on_the_queue_nothing_is_learnt(void) {
    junction.discharge = (uint8_t)ELMOPP_DISCHARGE_GREENSHIELDS;
    junction.free_flow_m_per_s = 10.0F;
    start(0U);
    seconds_of_green(60U, 0.0F, 9.0F);
    TEST_ASSERT_EQUAL_FLOAT(2.5F, sight.flow_veh_per_s[0][0]);
    TEST_ASSERT_FALSE(elmopp_sight_is_blocked(&sight, 0U));
}

static void test_a_green_queue_that_nobody_leaves_is_blocked_after_8_s(void) {
    start(0U);
    seconds_of_green(3U, 0.0F, 4.0F); /* start-up and a second to settle */
    seconds_of_green(7U, 0.0F, 4.0F);
    TEST_ASSERT_FALSE(elmopp_sight_is_blocked(&sight, 0U));
    seconds_of_green(1U, 0.0F, 4.0F);
    TEST_ASSERT_TRUE(elmopp_sight_is_blocked(&sight, 0U));
    seconds_of_green(1U, 0.0F, 3.0F);
    TEST_ASSERT_FALSE(elmopp_sight_is_blocked(&sight, 0U));
}

static void test_a_change_of_stage_ends_a_block(void) {
    start(0U);
    seconds_of_green(20U, 0.0F, 4.0F);
    TEST_ASSERT_TRUE(elmopp_sight_is_blocked(&sight, 0U));
    test_view_clear_to(&seen, 1U);
    second(0.0F, 4.0F);
    TEST_ASSERT_FALSE(elmopp_sight_is_blocked(&sight, 0U));
}

static float any_count(uint64_t *random) {
    static const float size[4] = {0.0F, 3.0F, 40.0F, 1.0e6F};
    return size[random_below(random, 4U)] * ((float)random_below(random, 1001U) / 1000.0F);
}

static void expect_sane(float value) {
    if (!isfinite(value) || (value < 0.0F)) {
        TEST_FAIL_MESSAGE("a value is negative or not finite");
    }
}

static void expect_all_sane(void) {
    for (uint32_t j = 0U; j < junction.movement_count; j++) {
        expect_sane(sight.queued_veh[j]);
        expect_sane(sight.mean_veh_per_s[j]);
        expect_sane(sight.hidden_veh[j]);
        for (uint32_t t = 0U; t < ELMOPP_SIGHT_TRAVEL_MAX_S; t++) {
            expect_sane(sight.due_veh[j][t]);
        }
        for (uint32_t s = 0U; s < junction.stage_count; s++) {
            expect_sane(sight.flow_veh_per_s[s][j]);
        }
    }
}

static void test_whatever_is_counted_every_value_is_finite_and_not_negative(void) {
    uint64_t random = 1U;
    junction = elmopp_site_four_way;
    start(ELMOPP_SIGHT_TRAVEL_MAX_S);
    for (uint32_t t = 0U; t < SECONDS; t++) {
        if (random_below(&random, 10U) == 0U) {
            test_view_clear_to(&seen, 0U);
        } else {
            test_view_show(&seen, (elmopp_stage_t)random_below(&random, 2U), random_below(&random, 900U));
        }
        for (uint32_t j = 0U; j < junction.movement_count; j++) {
            seen.arrivals_veh[j] = any_count(&random);
            seen.queue_veh[j] = any_count(&random);
        }
        elmopp_sight_observe(&sight, &seen.view);
        expect_all_sane();
    }
}

static void test_options_that_make_no_sense_are_a_bug(void) {
    elmopp_sight_options_t options = elmopp_sight_defaults(ELMOPP_SIGHT_TRAVEL_MAX_S + 1U);
    TEST_EXPECT_ASSERT(elmopp_sight_init(&sight, &junction, &options));
    options = elmopp_sight_defaults(0U);
    options.mean_window_s = 0U;
    TEST_EXPECT_ASSERT(elmopp_sight_init(&sight, &junction, &options));
    options = elmopp_sight_defaults(0U);
    options.prior_s = 0.0F;
    TEST_EXPECT_ASSERT(elmopp_sight_init(&sight, &junction, &options));
    options = elmopp_sight_defaults(0U);
    options.forget_per_s = 1.5F;
    TEST_EXPECT_ASSERT(elmopp_sight_init(&sight, &junction, &options));
}

/* --- who gives way --- */

/* Both movements go in stage 0, and movement 0 gives way to movement 1. */
static void start_giving_way(uint8_t percent, bool heeded) {
    junction.stage_groups[0] = 0x3U;
    junction.gives_way[0] = 0x2U;
    junction.movement[0].gives_way_percent = percent;
    elmopp_sight_options_t options = elmopp_sight_defaults(0U);
    options.gives_way = heeded;
    elmopp_sight_init(&sight, &junction, &options);
    test_view_init(&seen, &junction);
}

/* Stage 0 is shown, five wait on movement 0 and none of them leaves, so many are on movement 1. */
static void wait_for(uint32_t seconds, float opposing_veh) {
    seen.queue_veh[1] = opposing_veh;
    seconds_of_green(seconds, 0.0F, 5.0F);
}

static void test_who_waits_for_a_gap_does_not_lower_the_saturation_flow(void) {
    start_giving_way(100U, true);
    wait_for(60U, 3.0F);
    TEST_ASSERT_EQUAL_FLOAT(0.5F, sight.flow_veh_per_s[0][0]);
    start_giving_way(100U, false);
    wait_for(60U, 3.0F);
    TEST_ASSERT_TRUE(sight.flow_veh_per_s[0][0] < 0.25F);
}

static void test_the_flow_is_learnt_while_nobody_is_there_who_goes_first(void) {
    start_giving_way(100U, true);
    wait_for(60U, 0.0F);
    TEST_ASSERT_TRUE(sight.flow_veh_per_s[0][0] < 0.25F);
    TEST_ASSERT_TRUE(sight.flow_veh_per_s[0][0] >= 0.05F);
    start_giving_way(100U, true);
    TEST_ASSERT_EQUAL_FLOAT(0.5F, sight.flow_veh_per_s[0][0]);
}

static void test_who_waits_for_a_gap_is_not_blocked(void) {
    start_giving_way(100U, true);
    wait_for(60U, 3.0F);
    TEST_ASSERT_FALSE(elmopp_sight_is_blocked(&sight, 0U));
    wait_for(20U, 0.0F);
    TEST_ASSERT_TRUE(elmopp_sight_is_blocked(&sight, 0U));
    wait_for(20U, 3.0F);
    TEST_ASSERT_TRUE(elmopp_sight_is_blocked(&sight, 0U));
    second(0.0F, 4.0F);
    TEST_ASSERT_FALSE(elmopp_sight_is_blocked(&sight, 0U));
}

static void test_the_usual_flow_is_what_gaps_in_the_mean_arrivals_let_through(void) {
    start_giving_way(100U, true);
    TEST_ASSERT_EQUAL_FLOAT(0.4F, elmopp_sight_usual(&sight, 0U, 0U));
    seen.arrivals_veh[1] = 0.2F;
    wait_for(5U, 1.0F);
    TEST_ASSERT_FLOAT_WITHIN(0.0006F, 0.20666F, elmopp_sight_usual(&sight, 0U, 0U));
    TEST_ASSERT_TRUE(elmopp_sight_is_served(&sight, 0U, 0U));
    seen.arrivals_veh[1] = 1.0F;
    wait_for(100U, 1.0F);
    TEST_ASSERT_FALSE(elmopp_sight_is_served(&sight, 0U, 0U));
    TEST_ASSERT_EQUAL_FLOAT(0.5F, elmopp_sight_usual(&sight, 0U, 1U));
    start_giving_way(25U, true);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 0.47058824F, elmopp_sight_usual(&sight, 0U, 0U));
}

static void test_nobody_gives_way_to_whom_has_red(void) {
    start_giving_way(100U, true);
    TEST_ASSERT_EQUAL_HEX32(0x1U, sight.yields[0]);
    junction.stage_groups[0] = 0x1U;
    const elmopp_sight_options_t options = elmopp_sight_defaults(0U);
    elmopp_sight_init(&sight, &junction, &options);
    TEST_ASSERT_EQUAL_HEX32(0x0U, sight.yields[0]);
    TEST_ASSERT_EQUAL_FLOAT(0.5F, elmopp_sight_usual(&sight, 0U, 0U));
    wait_for(60U, 3.0F);
    TEST_ASSERT_TRUE(elmopp_sight_is_blocked(&sight, 0U));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_reach_takes_whole_seconds_at_free_flow);
    RUN_TEST(test_a_reach_takes_longer_where_the_limit_is_lower);
    RUN_TEST(test_a_site_gives_each_movement_the_travel_time_of_its_approach);
    RUN_TEST(test_the_defaults_are_those_of_the_research);
    RUN_TEST(test_who_has_just_come_drives_for_travel_s_and_is_queued_then);
    RUN_TEST(test_who_was_there_at_the_start_is_queued);
    RUN_TEST(test_if_fewer_are_there_than_drive_the_oldest_have_left);
    RUN_TEST(test_without_a_reach_everybody_is_queued);
    RUN_TEST(test_the_mean_of_arrivals_is_exact_at_first);
    RUN_TEST(test_the_mean_of_arrivals_forgets_over_its_window);
    RUN_TEST(test_behind_a_full_reach_those_stand_who_should_have_come);
    RUN_TEST(test_no_more_are_hidden_than_the_reach_holds);
    RUN_TEST(test_without_a_reach_nobody_is_hidden);
    RUN_TEST(test_the_clock_starts_when_somebody_is_there);
    RUN_TEST(test_the_clock_restarts_on_a_departure_and_not_on_green);
    RUN_TEST(test_who_leaves_on_red_does_not_restart_the_clock);
    RUN_TEST(test_a_green_with_nobody_there_restarts_the_clock);
    RUN_TEST(test_the_clock_saturates);
    RUN_TEST(test_at_first_a_stage_has_the_sites_flows);
    RUN_TEST(test_a_standing_queue_teaches_the_flow);
    RUN_TEST(test_a_short_queue_teaches_nothing);
    RUN_TEST(test_another_stage_keeps_its_own_flow);
    RUN_TEST(test_a_learnt_flow_stays_within_bounds);
    RUN_TEST(test_one_wild_count_spoils_nothing);
    RUN_TEST(test_with_a_law_that_depends_on_the_queue_nothing_is_learnt);
    RUN_TEST(test_a_green_queue_that_nobody_leaves_is_blocked_after_8_s);
    RUN_TEST(test_a_change_of_stage_ends_a_block);
    RUN_TEST(test_whatever_is_counted_every_value_is_finite_and_not_negative);
    RUN_TEST(test_options_that_make_no_sense_are_a_bug);
    RUN_TEST(test_who_waits_for_a_gap_does_not_lower_the_saturation_flow);
    RUN_TEST(test_the_flow_is_learnt_while_nobody_is_there_who_goes_first);
    RUN_TEST(test_who_waits_for_a_gap_is_not_blocked);
    RUN_TEST(test_the_usual_flow_is_what_gaps_in_the_mean_arrivals_let_through);
    RUN_TEST(test_nobody_gives_way_to_whom_has_red);
    return UNITY_END();
}
