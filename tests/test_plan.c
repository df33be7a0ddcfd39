/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The plan, tick by tick. "Tick t" counts from the first tick with a new wish, which is tick 0.

#include "assert_catcher.h"
#include "elmopp/plan.h"
#include "plan_tick.h"
#include "random.h"
#include "sites.h"
#include "unity.h"

#include <stdio.h>

#define STAGES 3U
#define LONG_TIME 70000U ///< more ticks than an age can count

static elmopp_junction_t junction;
static elmopp_plan_t plan;
static elmopp_lamps_t lamps;

static void start(const elmopp_junction_t *site) {
    junction = *site;
    elmopp_plan_init(&plan, &junction);
    lamps = (elmopp_lamps_t){0U, 0U, 0U, 0U};
}

void setUp(void) {
    const elmopp_junction_t cross = test_cross(STAGES);
    start(&cross);
}
void tearDown(void) {}

/* A street's green rests where nobody waits, so a wish for a stage comes with somebody who wants it. */
static void run(uint32_t ticks, elmopp_stage_t wanted, uint16_t demand) {
    const bool is_stage = (wanted < ELMOPP_STAGE_MAX) && (wanted < junction.stage_count);
    const uint16_t own = is_stage ? junction.stage_groups[wanted] : (uint16_t)0U;
    for (uint32_t i = 0U; i < ticks; i++) {
        lamps = plan_tick(&plan, wanted, (uint16_t)(demand | own));
    }
}

/* Shows the stage for so long that every minimum green has run out. */
static void settle(elmopp_stage_t stage) {
    run(1000U, stage, 0U);
    TEST_ASSERT_EQUAL_UINT8(stage, plan.stage);
}

static bool has(uint16_t mask, uint32_t g) {
    return (((uint32_t)mask >> g) & 1U) != 0U;
}

/* R, Y (amber), G, or B for red and amber both; ? for what no signal may show. */
static char aspect_of(uint32_t g) {
    const uint32_t code =
        (has(lamps.red, g) ? 4U : 0U) | (has(lamps.amber, g) ? 2U : 0U) | (has(lamps.green, g) ? 1U : 0U);
    return "?GY?RBB?"[code];
}

static void expect_aspect(uint32_t g, char aspect, uint32_t tick) {
    if (aspect_of(g) != aspect) {
        char message[80];
        (void)snprintf(message, sizeof message, "group %u at tick %u: %c instead of %c", (unsigned)g, (unsigned)tick,
                       aspect_of(g), aspect);
        TEST_FAIL_MESSAGE(message);
    }
}

/* --- start --- */

static void test_before_the_first_wish_everything_is_red_for_ever(void) {
    run(LONG_TIME, ELMOPP_STAGE_NONE, 0U);
    TEST_ASSERT_EQUAL_HEX16(0x0007U, lamps.red);
    TEST_ASSERT_EQUAL_HEX16(0U, lamps.amber);
    TEST_ASSERT_EQUAL_HEX16(0U, lamps.green);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_STAGE_NONE, plan.stage);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_STAGE_NONE, plan.target);
    TEST_ASSERT_EQUAL_UINT16(0U, plan.elapsed_ds);
}

static void test_the_first_green_waits_as_if_all_had_just_been_green(void) {
    for (uint32_t tick = 0U; tick < 70U; tick++) {
        run(1U, 1U, 0U);
        expect_aspect(0U, 'R', tick);
        expect_aspect(1U, (tick < 45U) ? 'R' : ((tick < CROSS_INTERGREEN_DS) ? 'B' : 'G'), tick);
        TEST_ASSERT_EQUAL_UINT8((tick < CROSS_INTERGREEN_DS) ? ELMOPP_STAGE_NONE : 1U, plan.stage);
        TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
    }
}

static void test_lamps_of_groups_that_do_not_exist_stay_dark(void) {
    settle(2U);
    TEST_ASSERT_EQUAL_HEX16(0x0003U, lamps.red);
    TEST_ASSERT_EQUAL_HEX16(0x0004U, lamps.green);
}

/* --- one change --- */

/* Stage 3 (E.L E.M E.R S.R) to stage 4 (N.M N.R S.M S.R), every signal by hand. */
static void check_tick_of_the_four_way_change(uint32_t tick) {
    for (uint32_t g = 3U; g <= 5U; g++) {
        expect_aspect(g, (tick < 30U) ? 'Y' : 'R', tick); /* E ends with 3 s of amber */
    }
    expect_aspect(7U, (tick < 40U) ? 'R' : ((tick < 50U) ? 'B' : 'G'), tick); /* S.M: 50 after E.L, E.M and E.R */
    expect_aspect(1U, (tick < 50U) ? 'R' : ((tick < 60U) ? 'B' : 'G'), tick); /* N.M: 60 after E.L, 50 after E.M */
    expect_aspect(2U, (tick < 60U) ? 'R' : ((tick < 70U) ? 'B' : 'G'), tick); /* N.R: 70 after E.M */
    expect_aspect(8U, 'G', tick);                                             /* S.R is in both */
    const uint32_t red[] = {0U, 6U, 9U, 10U, 11U};
    for (uint32_t i = 0U; i < 5U; i++) {
        expect_aspect(red[i], 'R', tick);
    }
    TEST_ASSERT_EQUAL_UINT8((tick < 70U) ? ELMOPP_STAGE_NONE : 4U, plan.stage);
    TEST_ASSERT_EQUAL_UINT16((tick < 70U) ? 0U : (tick - 69U), plan.elapsed_ds);
}

static void test_four_way_change_is_exact_in_every_tick(void) {
    start(&elmopp_site_four_way);
    settle(3U);
    for (uint32_t tick = 0U; tick < 120U; tick++) {
        run(1U, 4U, 0U);
        check_tick_of_the_four_way_change(tick);
    }
}

/* And back as early as possible: each signal keeps its own 5 s. S.M is green from 50, N.M from 60, N.R from 70. The
   wish for stage 3 is heard at 71, when stage 4 is up. */
static void test_four_way_keeps_the_minimum_green_of_each_group(void) {
    start(&elmopp_site_four_way);
    settle(3U);
    run(71U, 4U, 0U);
    for (uint32_t tick = 71U; tick < 220U; tick++) {
        run(1U, 3U, 0U);
        expect_aspect(7U, (tick < 100U) ? 'G' : ((tick < 130U) ? 'Y' : 'R'), tick);
        expect_aspect(1U, (tick < 110U) ? 'G' : ((tick < 140U) ? 'Y' : 'R'), tick);
        expect_aspect(2U, (tick < 120U) ? 'G' : ((tick < 150U) ? 'Y' : 'R'), tick);
        expect_aspect(8U, 'G', tick);
        /* E.M: 50 after N.M, N.R, S.M; E.L: 60 after N.M, 50 after S.M; E.R: 70 after S.M. */
        expect_aspect(4U, (tick < 160U) ? 'R' : ((tick < 170U) ? 'B' : 'G'), tick);
        expect_aspect(3U, (tick < 160U) ? 'R' : ((tick < 170U) ? 'B' : 'G'), tick);
        expect_aspect(5U, (tick < 160U) ? 'R' : ((tick < 170U) ? 'B' : 'G'), tick);
        TEST_ASSERT_EQUAL_UINT8((tick < 170U) ? ELMOPP_STAGE_NONE : 3U, plan.stage);
    }
}

static void test_times_of_each_group_are_its_own(void) {
    junction.group[0].amber_ds = 42U;
    junction.group[1].red_amber_ds = 7U;
    junction.intergreen_ds[0][1] = 61U;
    settle(0U);
    for (uint32_t tick = 0U; tick < 80U; tick++) {
        run(1U, 1U, 0U);
        expect_aspect(0U, (tick < 42U) ? 'Y' : 'R', tick);
        expect_aspect(1U, (tick < 54U) ? 'R' : ((tick < 61U) ? 'B' : 'G'), tick);
        expect_aspect(2U, 'R', tick);
    }
}

static void test_the_shortest_intergreen_lets_red_amber_follow_amber_at_once(void) {
    junction.intergreen_ds[0][1] = CROSS_AMBER_DS + CROSS_RED_AMBER_DS;
    settle(0U);
    for (uint32_t tick = 0U; tick < 60U; tick++) {
        run(1U, 1U, 0U);
        expect_aspect(0U, (tick < 30U) ? 'Y' : 'R', tick);
        expect_aspect(1U, (tick < 30U) ? 'R' : ((tick < 40U) ? 'B' : 'G'), tick);
    }
}

/* Group 0 ended long ago, but its intergreen towards 2 is longer than the stage between. */
static void test_an_intergreen_reaches_across_a_stage_between(void) {
    junction.intergreen_ds[0][2] = 400U;
    junction.intergreen_ds[1][2] = 40U;
    settle(0U);
    run(100U, 1U, 0U);
    for (uint32_t tick = 100U; tick < 450U; tick++) {
        run(1U, 2U, 0U);
        expect_aspect(2U, (tick < 390U) ? 'R' : ((tick < 400U) ? 'B' : 'G'), tick);
    }
}

static void test_without_red_amber_red_turns_to_green_in_one_tick(void) {
    junction.group[1].red_amber_ds = 0U;
    settle(0U);
    for (uint32_t tick = 0U; tick < 70U; tick++) {
        run(1U, 1U, 0U);
        expect_aspect(1U, (tick < CROSS_INTERGREEN_DS) ? 'R' : 'G', tick);
    }
}

static void test_a_zero_clearance_site_changes_between_any_two_stages_in_one_tick(void) {
    for (uint32_t from = 0U; from < 8U; from++) {
        for (uint32_t to = 0U; to < 8U; to++) {
            start(&elmopp_site_paper);
            run(10U, (elmopp_stage_t)from, 0U);
            TEST_ASSERT_EQUAL_HEX16(junction.stage_groups[from], lamps.green);
            run(1U, (elmopp_stage_t)to, 0U);
            TEST_ASSERT_EQUAL_HEX16(junction.stage_groups[to], lamps.green);
            TEST_ASSERT_EQUAL_HEX16(0x0FFFU & ~(uint32_t)lamps.green, lamps.red);
            TEST_ASSERT_EQUAL_HEX16(0U, lamps.amber);
            TEST_ASSERT_EQUAL_UINT8(to, plan.stage);
            TEST_ASSERT_EQUAL_UINT16((from == to) ? 11U : 1U, plan.elapsed_ds);
        }
    }
}

static void test_a_zero_clearance_site_keeps_its_minimum_green_of_one_second(void) {
    start(&elmopp_site_paper);
    run(9U, 0U, 0U);
    run(1U, 1U, 0U);
    TEST_ASSERT_EQUAL_HEX16(junction.stage_groups[0], lamps.green);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_STAGE_NONE, plan.stage);
    run(1U, 1U, 0U);
    TEST_ASSERT_EQUAL_HEX16(junction.stage_groups[1], lamps.green);
}

/* --- wishes --- */

static void test_a_wish_is_ignored_until_the_last_one_is_fulfilled(void) {
    settle(0U);
    run(1U, 1U, 0U);
    for (uint32_t tick = 1U; tick < CROSS_INTERGREEN_DS; tick++) {
        run(1U, ((tick % 2U) == 0U) ? 0U : 2U, 0U);
        TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
        TEST_ASSERT_EQUAL_UINT8(ELMOPP_STAGE_NONE, plan.stage);
    }
    run(1U, 2U, 0U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.stage);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
    run(1U, 2U, 0U);
    TEST_ASSERT_EQUAL_UINT8(2U, plan.target);
}

static void test_no_wish_keeps_what_is_shown(void) {
    settle(1U);
    run(LONG_TIME, ELMOPP_STAGE_NONE, 0U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.stage);
    TEST_ASSERT_EQUAL_HEX16(0x0002U, lamps.green);
}

static void test_no_wish_lets_a_change_go_on(void) {
    settle(0U);
    run(1U, 1U, 0U);
    run(CROSS_INTERGREEN_DS, ELMOPP_STAGE_NONE, 0U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.stage);
}

static void test_the_first_wish_is_followed_to_its_end_too(void) {
    run(1U, 1U, 0U);
    run(CROSS_INTERGREEN_DS, 2U, 0U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.stage);
}

/* --- elapsed --- */

static void test_elapsed_is_10_after_one_second_of_a_stage(void) {
    run(CROSS_INTERGREEN_DS, 0U, 0U);
    TEST_ASSERT_EQUAL_UINT16(0U, plan.elapsed_ds);
    run(10U, 0U, 0U);
    TEST_ASSERT_EQUAL_UINT16(10U, plan.elapsed_ds);
    run(1U, 1U, 0U);
    TEST_ASSERT_EQUAL_UINT16(0U, plan.elapsed_ds);
}

static void test_elapsed_and_ages_saturate(void) {
    junction.group[0].max_green_ds = 0U;
    junction.red_bound_ds = 0U;
    run(CROSS_INTERGREEN_DS + LONG_TIME, 0U, 0x0002U);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, plan.elapsed_ds);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, plan.group[0].age_ds);
    TEST_ASSERT_EQUAL_UINT16(0U, plan.group[0].since_green_ds);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, plan.group[0].contested_ds);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, plan.group[1].since_green_ds);
}

static void test_after_a_saturated_green_the_change_is_the_same(void) {
    junction.group[0].max_green_ds = 0U;
    junction.red_bound_ds = 0U;
    run(LONG_TIME, 0U, 0x0002U);
    for (uint32_t tick = 0U; tick < 70U; tick++) {
        run(1U, 1U, 0U);
        expect_aspect(0U, (tick < 30U) ? 'Y' : 'R', tick);
        expect_aspect(1U, (tick < 45U) ? 'R' : ((tick < 55U) ? 'B' : 'G'), tick);
    }
}

/* --- maximum green --- */

static void test_maximum_green_counts_from_the_first_conflicting_demand(void) {
    settle(0U);
    run(CROSS_MAX_GREEN_DS, 0U, 0x0002U);
    expect_aspect(0U, 'G', CROSS_MAX_GREEN_DS - 1U);
    TEST_ASSERT_EQUAL_UINT8(0U, plan.stage);
    run(1U, 0U, 0x0002U);
    expect_aspect(0U, 'Y', CROSS_MAX_GREEN_DS);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
    TEST_ASSERT_TRUE(plan.forced);
}

static void test_green_goes_on_without_demand(void) {
    settle(0U);
    run(LONG_TIME, 0U, 0U);
    TEST_ASSERT_EQUAL_UINT8(0U, plan.stage);
    TEST_ASSERT_FALSE(plan.forced);
}

static void test_demand_of_the_green_group_itself_contests_nothing(void) {
    settle(0U);
    run(10U * CROSS_MAX_GREEN_DS, 0U, 0x0001U);
    TEST_ASSERT_EQUAL_UINT8(0U, plan.stage);
}

static void test_a_maximum_of_zero_never_forces(void) {
    junction.group[0].max_green_ds = 0U;
    junction.red_bound_ds = 0U;
    settle(0U);
    run(LONG_TIME, 0U, 0x0006U);
    TEST_ASSERT_EQUAL_UINT8(0U, plan.stage);
}

static void test_a_demand_that_the_camera_lost_is_remembered(void) {
    settle(0U);
    run(1U, 0U, 0x0002U);
    run(CROSS_MAX_GREEN_DS - 1U, 0U, 0U);
    TEST_ASSERT_EQUAL_UINT8(0U, plan.stage);
    run(1U, 0U, 0U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
    expect_aspect(0U, 'Y', 0U);
}

static void test_the_count_starts_anew_with_each_green(void) {
    settle(0U);
    run(CROSS_MAX_GREEN_DS - 1U, 0U, 0x0002U);
    run(300U, 1U, 0U);
    run(CROSS_INTERGREEN_DS, 0U, 0U);
    run(1U, 0U, 0U);
    TEST_ASSERT_EQUAL_UINT8(0U, plan.stage);
    TEST_ASSERT_EQUAL_UINT16(0U, plan.group[0].contested_ds);
    run(CROSS_MAX_GREEN_DS, 0U, 0x0002U);
    TEST_ASSERT_EQUAL_UINT8(0U, plan.stage);
    run(1U, 0U, 0x0002U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
}

static void test_force_turns_to_the_movement_that_has_waited_longest(void) {
    settle(2U);
    run(1U, 2U, 0x0002U);
    run(CROSS_MAX_GREEN_DS, 2U, 0x0003U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
    setUp();
    settle(2U);
    run(1U, 2U, 0x0001U);
    run(CROSS_MAX_GREEN_DS, 2U, 0x0003U);
    TEST_ASSERT_EQUAL_UINT8(0U, plan.target);
}

static void test_force_turns_only_to_a_group_that_waits(void) {
    settle(0U);
    settle(1U);
    settle(2U);
    run(CROSS_MAX_GREEN_DS + 1U, 2U, 0x0002U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
}

static void test_force_among_equals_takes_the_lowest_group(void) {
    settle(0U);
    run(CROSS_MAX_GREEN_DS + 1U, 0U, 0x0006U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
}

static void test_a_wish_is_heard_again_when_the_forced_stage_is_up(void) {
    settle(0U);
    run(CROSS_MAX_GREEN_DS + 1U, 0U, 0x0002U);
    for (uint32_t tick = 1U; tick < CROSS_INTERGREEN_DS; tick++) {
        run(1U, 0U, 0x0002U);
        TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
        TEST_ASSERT_TRUE(plan.forced);
    }
    run(1U, 0U, 0U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.stage);
    run(1U, 0U, 0U);
    TEST_ASSERT_EQUAL_UINT8(0U, plan.target);
    TEST_ASSERT_FALSE(plan.forced);
}

static void test_force_overrules_another_wish_of_the_same_tick(void) {
    settle(0U);
    run(CROSS_MAX_GREEN_DS, 0U, 0x0002U);
    run(1U, 2U, 0x0002U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
}

/* Three_way, stage 1 (E.M S.R W.R). W.M contests S.R but not E.M. */
static void test_only_conflicting_demand_counts_against_a_group(void) {
    start(&elmopp_site_three_way);
    for (uint32_t g = 0U; g < 6U; g++) {
        junction.group[g].max_green_ds = (g == 1U) ? 100U : 0U;
    }
    junction.red_bound_ds = 0U;
    settle(1U);
    run(1000U, 1U, 0x0011U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.stage);
    TEST_ASSERT_EQUAL_UINT16(0U, plan.group[1].contested_ds);
    run(100U, 1U, 0x0004U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.stage);
    run(1U, 1U, 0x0004U);
    TEST_ASSERT_EQUAL_UINT8(2U, plan.target);
}

static void test_force_looks_at_groups_that_conflict_with_the_one_that_is_over(void) {
    start(&elmopp_site_three_way);
    settle(3U);
    settle(1U);
    for (uint32_t g = 0U; g < 6U; g++) {
        junction.group[g].max_green_ds = (g == 1U) ? 100U : 0U;
    }
    /* E.L has never been green and waits, but only S.L conflicts with E.M. */
    run(101U, 1U, 0x0005U);
    TEST_ASSERT_EQUAL_UINT8(2U, plan.target);
}

static void test_force_takes_the_first_stage_that_holds_the_group(void) {
    start(&elmopp_site_three_way);
    settle(3U);
    run(601U, 3U, 0x0008U);
    TEST_ASSERT_EQUAL_UINT8(0U, plan.target);
}

static void test_a_green_kept_over_a_change_of_stages_keeps_its_count(void) {
    start(&elmopp_site_three_way);
    junction.group[1].max_green_ds = 200U;
    settle(0U);
    run(50U, 0U, 0x0004U);
    run(150U, 1U, 0x0004U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.stage);
    expect_aspect(1U, 'G', 199U);
    run(1U, 1U, 0x0004U);
    TEST_ASSERT_EQUAL_UINT8(2U, plan.target);
    expect_aspect(1U, 'Y', 200U);
}

/* E.M outlasts its maximum during the change from stage 0 to 1: it is forced when stage 1 is up, not before. */
static void test_a_maximum_that_falls_into_a_change_waits_for_its_end(void) {
    start(&elmopp_site_three_way);
    junction.group[1].max_green_ds = 200U;
    settle(0U);
    run(190U, 0U, 0x0004U);
    for (uint32_t tick = 0U; tick < 70U; tick++) {
        run(1U, 1U, 0x0004U);
        TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
    }
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_STAGE_NONE, plan.stage);
    run(1U, 1U, 0x0004U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.stage);
    run(1U, 1U, 0x0004U);
    TEST_ASSERT_EQUAL_UINT8(2U, plan.target);
}

/* --- rest --- */

static void test_a_street_rests_in_green_while_nobody_waits(void) {
    settle(0U);
    for (uint32_t i = 0U; i < LONG_TIME; i++) {
        lamps = plan_tick(&plan, (elmopp_stage_t)(i % STAGES), 0x0001U);
    }
    TEST_ASSERT_EQUAL_UINT8(0U, plan.stage);
    run(1U, 1U, 0U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
}

static void test_a_simulation_does_not_rest(void) {
    junction.simulation_only = 1U;
    settle(0U);
    lamps = plan_tick(&plan, 1U, 0U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
}

static void test_all_red_is_no_rest(void) {
    lamps = plan_tick(&plan, 1U, 0U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
}

/* --- red everywhere --- */

static void test_all_red_ends_every_green_through_amber_and_keeps_its_minimum(void) {
    run(CROSS_INTERGREEN_DS + 1U, 0U, 0U);
    for (uint32_t tick = 1U; tick < 120U; tick++) {
        run(1U, ELMOPP_STAGE_RED, 0x0007U);
        expect_aspect(0U, (tick < CROSS_MIN_GREEN_DS) ? 'G' : ((tick < 80U) ? 'Y' : 'R'), tick);
        TEST_ASSERT_EQUAL_INT(tick >= 80U, plan.settled);
        TEST_ASSERT_EQUAL_UINT8(ELMOPP_STAGE_NONE, plan.target);
        TEST_ASSERT_EQUAL_UINT8((tick == 0U) ? 0U : ELMOPP_STAGE_NONE, plan.stage);
    }
}

static void test_nobody_is_rescued_from_all_red_and_the_wait_begins_anew(void) {
    junction.red_bound_ds = 450U; /* 4 changes of 107 ds */
    settle(0U);
    run(5000U, ELMOPP_STAGE_RED, 0x0007U);
    TEST_ASSERT_EQUAL_HEX16(0U, lamps.green);
    TEST_ASSERT_EQUAL_UINT16(0U, plan.wait_ds[1]);
    run(1U, 0U, 0x0007U);
    TEST_ASSERT_EQUAL_UINT16(1U, plan.wait_ds[1]);
}

/* --- the bound on red --- */

/* One waits against a green without maximum: rescued when a change under way and its own are all that is left. */
static void test_a_rescue_begins_when_the_time_left_is_just_enough(void) {
    const uint16_t change_ds = CROSS_MIN_GREEN_DS + CROSS_INTERGREEN_DS + 2U;
    junction.group[0].max_green_ds = 0U;
    junction.red_bound_ds = 800U;
    settle(0U);
    const uint32_t last_calm = 800U - (2U * change_ds) - 1U;
    for (uint32_t tick = 1U; tick <= last_calm; tick++) {
        run(1U, 0U, 0x0002U);
        TEST_ASSERT_EQUAL_UINT8(0U, plan.target);
    }
    run(1U, 0U, 0x0002U);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
    TEST_ASSERT_TRUE(plan.forced);
    TEST_ASSERT_EQUAL_UINT16(last_calm + 1U, plan.wait_ds[1]);
}

static void test_without_a_bound_nobody_is_rescued(void) {
    junction.group[0].max_green_ds = 0U;
    junction.red_bound_ds = 0U;
    settle(0U);
    run(LONG_TIME, 0U, 0x0002U);
    TEST_ASSERT_EQUAL_UINT8(0U, plan.target);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, plan.wait_ds[1]);
}

/* Two wait: the older one first, and then the other after no more than the minimum green. */
static void test_the_oldest_is_rescued_first_and_greens_are_cut_to_their_minimum(void) {
    junction.group[0].max_green_ds = 0U;
    junction.red_bound_ds = 800U;
    settle(0U);
    run(1U, 0U, 0x0004U);
    uint32_t tick = 0U;
    while ((plan.target == 0U) && (tick < 1000U)) {
        run(1U, 0U, 0x0006U);
        tick++;
    }
    TEST_ASSERT_EQUAL_UINT8(2U, plan.target);
    while ((plan.target == 2U) && (tick < 1000U)) {
        run(1U, 2U, 0U);
        tick++;
    }
    /* 2 changes of 107 ds are left; the green has had its minimum, and nobody asks for its stage any more. */
    TEST_ASSERT_EQUAL_UINT16(800U - (2U * 107U), plan.wait_ds[1]);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
    expect_aspect(2U, 'Y', tick);
    run(CROSS_INTERGREEN_DS, 2U, 0U);
    expect_aspect(1U, 'G', tick);
}

/* Group 1 alone is green; the movement that needs 1 and 2 goes on waiting. */
static void test_a_movement_that_is_partly_served_goes_on_waiting(void) {
    junction.movement[2].groups = 0x0006U;
    junction.stage_groups[2] = 0x0006U;
    junction.conflict[1] = 0x0001U;
    junction.conflict[2] = 0x0001U;
    for (uint32_t i = 0U; i < 300U; i++) {
        (void)elmopp_plan_step(&plan, 1U, 0x4U, false);
    }
    TEST_ASSERT_EQUAL_HEX16(0x0002U, junction.stage_groups[1]);
    TEST_ASSERT_EQUAL_UINT8(1U, plan.stage);
    TEST_ASSERT_EQUAL_UINT16(300U, plan.wait_ds[2]);
}

static void test_movements_that_do_not_exist_never_wait(void) {
    settle(0U);
    for (uint32_t i = 0U; i < 100U; i++) {
        (void)elmopp_plan_step(&plan, 0U, 0xFFFFFFF8U, false);
    }
    for (uint32_t j = STAGES; j < ELMOPP_MOVEMENT_MAX; j++) {
        TEST_ASSERT_EQUAL_UINT16(0U, plan.wait_ds[j]);
    }
}

/* --- an occupied junction --- */

/* As run(), with somebody in the junction in the ticks whose number is in [from, to). */
static void run_occupied(uint32_t ticks, elmopp_stage_t wanted, uint32_t from, uint32_t to) {
    const uint32_t demand = elmopp_junction_served(&junction, junction.stage_groups[wanted]);
    for (uint32_t tick = 0U; tick < ticks; tick++) {
        lamps = elmopp_plan_step(&plan, wanted, demand, (tick >= from) && (tick < to));
    }
}

/* Ticks of a change from stage 0 to 1 until its green, of which [from, to) are occupied. */
static uint32_t change_occupied(uint16_t wait_ds, uint32_t from, uint32_t to) {
    setUp();
    junction.junction_wait_ds = wait_ds;
    settle(0U);
    uint32_t tick = 0U;
    while ((!has(lamps.green, 1U)) && (tick < 1000U)) {
        lamps = elmopp_plan_step(&plan, 1U, 0x2U, (tick >= from) && (tick < to));
        const bool before = tick < (CROSS_INTERGREEN_DS - CROSS_RED_AMBER_DS);
        TEST_ASSERT_TRUE_MESSAGE(before || (!has(lamps.amber, 0U)), "the wait lengthens an amber");
        tick++;
    }
    TEST_ASSERT_FALSE(has(lamps.green, 0U));
    return tick - 1U;
}

#define BEGINS (CROSS_INTERGREEN_DS - CROSS_RED_AMBER_DS) ///< tick in which red-amber begins in an empty junction

static void test_a_change_waits_while_the_junction_is_occupied(void) {
    for (uint32_t to = 0U; to <= 130U; to++) {
        const uint32_t over = (to > BEGINS) ? (to - BEGINS) : 0U;
        const uint32_t waited = (over < 60U) ? over : 60U;
        TEST_ASSERT_EQUAL_UINT32(CROSS_INTERGREEN_DS + waited, change_occupied(60U, 0U, to));
    }
}

static void test_without_a_wait_of_the_site_an_occupied_junction_changes_nothing(void) {
    TEST_ASSERT_EQUAL_UINT32(CROSS_INTERGREEN_DS, change_occupied(0U, 0U, 1000U));
}

static void test_who_enters_the_junction_when_red_amber_has_begun_is_too_late(void) {
    TEST_ASSERT_EQUAL_UINT32(CROSS_INTERGREEN_DS, change_occupied(60U, BEGINS + 1U, 1000U));
    TEST_ASSERT_EQUAL_UINT32(CROSS_INTERGREEN_DS + 60U, change_occupied(60U, BEGINS, 1000U));
}

/* Ticks in which nobody could have started anyway cost nothing of the wait. */
static void test_the_wait_begins_when_the_clearance_is_over(void) {
    TEST_ASSERT_EQUAL_UINT32(CROSS_INTERGREEN_DS, change_occupied(10U, 0U, BEGINS));
    TEST_ASSERT_EQUAL_UINT32(CROSS_INTERGREEN_DS + 10U, change_occupied(10U, 0U, 1000U));
}

static void test_each_change_has_the_whole_wait(void) {
    junction.junction_wait_ds = 30U;
    junction.red_bound_ds = 0U;
    settle(0U);
    for (elmopp_stage_t stage = 1U; stage < STAGES; stage++) {
        run_occupied(CROSS_INTERGREEN_DS + 30U, stage, 0U, 1000U);
        TEST_ASSERT_FALSE(has(lamps.green, stage));
        TEST_ASSERT_EQUAL_UINT16(30U, plan.waited_ds);
        run_occupied(1U, stage, 0U, 1000U);
        TEST_ASSERT_TRUE(has(lamps.green, stage));
        run_occupied(1U, stage, 0U, 1000U);
        TEST_ASSERT_EQUAL_UINT16(0U, plan.waited_ds);
        run_occupied(CROSS_MIN_GREEN_DS, stage, 0U, 1000U);
    }
}

static void test_the_wait_is_counted_over_its_interruptions(void) {
    junction.junction_wait_ds = 20U;
    settle(0U);
    /* 10 ticks held, 1 that is not: in it the red-amber begins. */
    run_occupied(BEGINS + 11U, 1U, BEGINS, BEGINS + 10U);
    TEST_ASSERT_TRUE(has(lamps.amber, 1U));
    run_occupied(CROSS_RED_AMBER_DS, 1U, 0U, 1000U);
    TEST_ASSERT_TRUE(has(lamps.green, 1U));
}

/* The first green of all, after red everywhere, waits too. */
static void test_the_first_green_waits_for_the_junction(void) {
    junction.junction_wait_ds = 40U;
    run_occupied(CROSS_INTERGREEN_DS + 40U, 1U, 0U, 1000U);
    TEST_ASSERT_EQUAL_HEX16(0U, lamps.green);
    run_occupied(1U, 1U, 0U, 1000U);
    TEST_ASSERT_EQUAL_HEX16(0x2U, lamps.green);
}

/* Stage 3 to 4 of four_way: S.R is in both; the others begin in three different ticks, 40, 50 and 60. */
static void test_what_is_green_in_both_stages_stays_green_and_all_starts_wait_together(void) {
    start(&elmopp_site_four_way);
    junction.junction_wait_ds = 25U;
    junction.red_bound_ds = 0U;
    settle(3U);
    for (uint32_t tick = 0U; tick < 100U; tick++) {
        lamps = elmopp_plan_step(&plan, 4U, elmopp_junction_served(&junction, junction.stage_groups[4]), true);
        expect_aspect(8U, 'G', tick);
        expect_aspect(7U, (tick < 65U) ? 'R' : ((tick < 75U) ? 'B' : 'G'), tick);
        expect_aspect(1U, (tick < 65U) ? 'R' : ((tick < 75U) ? 'B' : 'G'), tick);
        expect_aspect(2U, (tick < 65U) ? 'R' : ((tick < 75U) ? 'B' : 'G'), tick);
        for (uint32_t g = 3U; g <= 5U; g++) {
            expect_aspect(g, (tick < 30U) ? 'Y' : 'R', tick);
        }
    }
}

static void test_all_red_ends_greens_in_an_occupied_junction_as_in_an_empty_one(void) {
    junction.junction_wait_ds = 100U;
    settle(0U);
    for (uint32_t tick = 0U; tick < 60U; tick++) {
        lamps = elmopp_plan_step(&plan, ELMOPP_STAGE_RED, 0U, true);
        expect_aspect(0U, (tick < 30U) ? 'Y' : 'R', tick);
    }
    TEST_ASSERT_TRUE(plan.settled);
    TEST_ASSERT_EQUAL_UINT16(0U, plan.waited_ds);
}

/* --- what does not exist --- */

/* Says the worst of every group, movement and stage beyond the counts of a damaged site. */
static void damage(elmopp_junction_t *site, elmopp_plan_t *state) {
    const uint16_t beyond = (uint16_t)(UINT16_MAX << site->group_count);
    for (uint32_t g = site->group_count; g < ELMOPP_GROUP_MAX; g++) {
        site->group[g] = (elmopp_group_t){.max_green_ds = 1U};
        site->conflict[g] = UINT16_MAX;
        state->group[g] = (elmopp_plan_group_t){ELMOPP_ASPECT_GREEN, UINT16_MAX, 0U, UINT16_MAX};
        for (uint32_t h = 0U; h < ELMOPP_GROUP_MAX; h++) {
            site->intergreen_ds[g][h] = UINT16_MAX;
            site->conflict[h] |= beyond;
        }
    }
    for (uint32_t j = site->movement_count; j < ELMOPP_MOVEMENT_MAX; j++) {
        site->movement[j].groups = UINT16_MAX;
        site->rescue_stage[j] = 1U;
        state->wait_ds[j] = UINT16_MAX;
    }
}

static void test_groups_and_movements_that_do_not_exist_change_nothing(void) {
    uint64_t random = 1U;
    junction.red_bound_ds = 800U;
    elmopp_plan_init(&plan, &junction);
    elmopp_junction_t damaged = junction;
    elmopp_plan_t other = plan;
    other.junction = &damaged;
    damage(&damaged, &other);
    for (uint32_t tick = 0U; tick < LONG_TIME; tick++) {
        const bool again = (random_next(&random) % 64U) == 0U;
        const elmopp_stage_t wanted = again ? (elmopp_stage_t)random_below(&random, STAGES) : plan.target;
        const uint32_t demand = again ? random_below(&random, 8U) : 0U;
        lamps = elmopp_plan_step(&plan, wanted, demand, false);
        const elmopp_lamps_t same = elmopp_plan_step(&other, wanted, demand, false);
        TEST_ASSERT_EQUAL_HEX16(lamps.green, same.green);
        TEST_ASSERT_EQUAL_HEX16(lamps.amber, same.amber);
        TEST_ASSERT_EQUAL_UINT8(plan.target, other.target);
        TEST_ASSERT_EQUAL_UINT16(plan.group[0].contested_ds, other.group[0].contested_ds);
    }
}

static void test_a_group_that_does_not_exist_is_never_green(void) {
    junction.movement[0].groups = (uint16_t)(1U << STAGES);
    plan.group[STAGES].aspect = ELMOPP_ASPECT_GREEN;
    (void)elmopp_plan_step(&plan, ELMOPP_STAGE_NONE, 1U, false);
    TEST_ASSERT_EQUAL_UINT16(1U, plan.wait_ds[0]);
}

static void test_a_new_group_has_been_red_for_a_tick(void) {
    for (uint32_t g = 0U; g < ELMOPP_GROUP_MAX; g++) {
        TEST_ASSERT_EQUAL_UINT16(1U, plan.group[g].age_ds);
    }
}

static void test_a_green_once_contested_counts_on(void) {
    const elmopp_plan_group_t green = {.aspect = ELMOPP_ASPECT_GREEN, .age_ds = 5U, .contested_ds = 1U};
    TEST_ASSERT_EQUAL_UINT16(2U, elmopp_plan_older(green, false).contested_ds);
}

static void test_a_stage_that_does_not_exist_is_a_mistake_of_the_caller(void) {
    TEST_EXPECT_ASSERT(elmopp_plan_step(&plan, STAGES, 0U, false));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_before_the_first_wish_everything_is_red_for_ever);
    RUN_TEST(test_the_first_green_waits_as_if_all_had_just_been_green);
    RUN_TEST(test_lamps_of_groups_that_do_not_exist_stay_dark);
    RUN_TEST(test_four_way_change_is_exact_in_every_tick);
    RUN_TEST(test_four_way_keeps_the_minimum_green_of_each_group);
    RUN_TEST(test_times_of_each_group_are_its_own);
    RUN_TEST(test_the_shortest_intergreen_lets_red_amber_follow_amber_at_once);
    RUN_TEST(test_an_intergreen_reaches_across_a_stage_between);
    RUN_TEST(test_without_red_amber_red_turns_to_green_in_one_tick);
    RUN_TEST(test_a_zero_clearance_site_changes_between_any_two_stages_in_one_tick);
    RUN_TEST(test_a_zero_clearance_site_keeps_its_minimum_green_of_one_second);
    RUN_TEST(test_a_wish_is_ignored_until_the_last_one_is_fulfilled);
    RUN_TEST(test_no_wish_keeps_what_is_shown);
    RUN_TEST(test_no_wish_lets_a_change_go_on);
    RUN_TEST(test_the_first_wish_is_followed_to_its_end_too);
    RUN_TEST(test_elapsed_is_10_after_one_second_of_a_stage);
    RUN_TEST(test_elapsed_and_ages_saturate);
    RUN_TEST(test_after_a_saturated_green_the_change_is_the_same);
    RUN_TEST(test_maximum_green_counts_from_the_first_conflicting_demand);
    RUN_TEST(test_green_goes_on_without_demand);
    RUN_TEST(test_demand_of_the_green_group_itself_contests_nothing);
    RUN_TEST(test_a_maximum_of_zero_never_forces);
    RUN_TEST(test_a_demand_that_the_camera_lost_is_remembered);
    RUN_TEST(test_the_count_starts_anew_with_each_green);
    RUN_TEST(test_force_turns_to_the_movement_that_has_waited_longest);
    RUN_TEST(test_force_turns_only_to_a_group_that_waits);
    RUN_TEST(test_force_among_equals_takes_the_lowest_group);
    RUN_TEST(test_a_wish_is_heard_again_when_the_forced_stage_is_up);
    RUN_TEST(test_force_overrules_another_wish_of_the_same_tick);
    RUN_TEST(test_only_conflicting_demand_counts_against_a_group);
    RUN_TEST(test_force_looks_at_groups_that_conflict_with_the_one_that_is_over);
    RUN_TEST(test_force_takes_the_first_stage_that_holds_the_group);
    RUN_TEST(test_a_green_kept_over_a_change_of_stages_keeps_its_count);
    RUN_TEST(test_a_maximum_that_falls_into_a_change_waits_for_its_end);
    RUN_TEST(test_a_street_rests_in_green_while_nobody_waits);
    RUN_TEST(test_a_simulation_does_not_rest);
    RUN_TEST(test_all_red_is_no_rest);
    RUN_TEST(test_all_red_ends_every_green_through_amber_and_keeps_its_minimum);
    RUN_TEST(test_nobody_is_rescued_from_all_red_and_the_wait_begins_anew);
    RUN_TEST(test_a_rescue_begins_when_the_time_left_is_just_enough);
    RUN_TEST(test_without_a_bound_nobody_is_rescued);
    RUN_TEST(test_the_oldest_is_rescued_first_and_greens_are_cut_to_their_minimum);
    RUN_TEST(test_a_change_waits_while_the_junction_is_occupied);
    RUN_TEST(test_without_a_wait_of_the_site_an_occupied_junction_changes_nothing);
    RUN_TEST(test_who_enters_the_junction_when_red_amber_has_begun_is_too_late);
    RUN_TEST(test_the_wait_begins_when_the_clearance_is_over);
    RUN_TEST(test_each_change_has_the_whole_wait);
    RUN_TEST(test_the_wait_is_counted_over_its_interruptions);
    RUN_TEST(test_the_first_green_waits_for_the_junction);
    RUN_TEST(test_what_is_green_in_both_stages_stays_green_and_all_starts_wait_together);
    RUN_TEST(test_all_red_ends_greens_in_an_occupied_junction_as_in_an_empty_one);
    RUN_TEST(test_a_movement_that_is_partly_served_goes_on_waiting);
    RUN_TEST(test_movements_that_do_not_exist_never_wait);
    RUN_TEST(test_groups_and_movements_that_do_not_exist_change_nothing);
    RUN_TEST(test_a_group_that_does_not_exist_is_never_green);
    RUN_TEST(test_a_new_group_has_been_red_for_a_tick);
    RUN_TEST(test_a_green_once_contested_counts_on);
    RUN_TEST(test_a_stage_that_does_not_exist_is_a_mistake_of_the_caller);
    return UNITY_END();
}
