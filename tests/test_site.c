/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// elmopp_site_check(): each rule broken once, on both sides of each limit.

#include "elmopp/site.h"
#include "sites.h"
#include "unity.h"

#include <math.h>
#include <string.h>

#define GROUPS 4U
#define VEHICLES_MAX 1.0e6F
#define TEN_MINUTES_DS 6000U

static elmopp_junction_t site;

void setUp(void) {
    site = test_cross(GROUPS);
}
void tearDown(void) {}

static void expect(elmopp_site_fault_t fault, uint32_t first, uint32_t second) {
    const elmopp_site_verdict_t verdict = elmopp_site_check(&site);
    TEST_ASSERT_EQUAL_INT(fault, verdict.fault);
    TEST_ASSERT_EQUAL_UINT8(first, verdict.first);
    TEST_ASSERT_EQUAL_UINT8(second, verdict.second);
}

static void expect_ok(void) {
    expect(ELMOPP_SITE_OK, 0U, 0U);
}

static void expect_verdict(elmopp_site_fault_t fault, uint32_t first, elmopp_site_verdict_t verdict) {
    TEST_ASSERT_EQUAL_INT(fault, verdict.fault);
    TEST_ASSERT_EQUAL_UINT8(first, verdict.first);
    TEST_ASSERT_EQUAL_UINT8(0U, verdict.second);
}

/* A programme of two steps, and the movements rescued by their stages. */
static void use_stages(uint8_t one, uint8_t other) {
    site.program[0].step_count = 2U;
    site.program[0].step[0].stage = one;
    site.program[0].step[1].stage = other;
    for (uint32_t j = 0U; j < site.movement_count; j++) {
        const bool first = elmopp_junction_goes(&site, j, site.stage_groups[one]);
        site.rescue_stage[j] = first ? one : other;
    }
}

/* Two groups that may be green together: 2 and 3 of the cross. Then stage 2 holds both, and there is no stage 3. */
static void make_compatible(void) {
    site.conflict[2] = 0x0003U;
    site.conflict[3] = 0x0003U;
    site.intergreen_ds[2][3] = 0U;
    site.intergreen_ds[3][2] = 0U;
    site.stage_groups[2] = 0x000CU;
    site.stage_count = 3U;
    site.rescue_stage[3] = 2U;
    site.program[0].step[3].stage = 2U;
}

static void test_every_generated_site_passes(void) {
    for (uint32_t i = 0U; i < TEST_SITE_COUNT; i++) {
        site = *test_sites[i];
        expect_ok();
    }
}

static void test_made_up_crosses_of_all_sizes_pass(void) {
    for (uint32_t count = 1U; count <= ELMOPP_GROUP_MAX; count++) {
        site = test_cross(count);
        expect_ok();
    }
    site = test_cross(GROUPS);
    make_compatible();
    expect_ok();
}

static void test_approach_count_is_1_to_8(void) {
    site = test_cross(ELMOPP_GROUP_MAX);
    site.approach_count = 8U;
    expect_ok();
    site.approach_count = 9U;
    expect(ELMOPP_SITE_COUNTS, 0U, 0U);
    site = test_cross(1U);
    expect_ok();
    site.approach_count = 0U;
    expect(ELMOPP_SITE_COUNTS, 0U, 0U);
}

static void test_movement_count_is_1_to_24(void) {
    site = test_cross(ELMOPP_APPROACH_MAX);
    for (uint32_t j = ELMOPP_APPROACH_MAX; j < ELMOPP_MOVEMENT_MAX; j++) {
        site.movement[j] = site.movement[j - ELMOPP_APPROACH_MAX];
        site.rescue_stage[j] = site.rescue_stage[j - ELMOPP_APPROACH_MAX];
    }
    site.movement_count = 24U;
    expect_ok();
    site.movement_count = 25U;
    expect(ELMOPP_SITE_COUNTS, 0U, 0U);
    site.movement_count = 0U;
    expect(ELMOPP_SITE_COUNTS, 0U, 0U);
}

static void test_group_count_is_1_to_16(void) {
    site = test_cross(ELMOPP_GROUP_MAX);
    expect_ok();
    site.group_count = 17U;
    expect(ELMOPP_SITE_COUNTS, 0U, 0U);
    site.group_count = 0U;
    expect(ELMOPP_SITE_COUNTS, 0U, 0U);
}

/* Five pairs of groups that exclude each other give 2^5 maximal stages: one group of each pair. */
static void make_32_stages(void) {
    site = test_cross(10U);
    (void)memset(site.intergreen_ds, 0, sizeof site.intergreen_ds);
    for (uint32_t g = 0U; g < 10U; g++) {
        site.conflict[g] = (uint16_t)(1U << (g ^ 1U));
        site.intergreen_ds[g][g ^ 1U] = CROSS_INTERGREEN_DS;
    }
    for (uint32_t s = 0U; s < ELMOPP_STAGE_MAX; s++) {
        uint32_t groups = 0U;
        for (uint32_t pair = 0U; pair < 5U; pair++) {
            groups |= 1U << ((2U * pair) + ((s >> pair) & 1U));
        }
        site.stage_groups[s] = (uint16_t)groups;
    }
    site.stage_count = 32U;
    use_stages(0U, 31U);
}

static void test_stage_count_is_1_to_32(void) {
    make_32_stages();
    expect_ok();
    site.stage_count = 33U;
    expect(ELMOPP_SITE_COUNTS, 0U, 0U);
    site.stage_count = 0U;
    expect(ELMOPP_SITE_COUNTS, 0U, 0U);
}

static void check_count(uint8_t *count, uint32_t bound) {
    const uint8_t before = *count;
    *count = (uint8_t)bound;
    expect_ok();
    *count = (uint8_t)(bound + 1U);
    expect(ELMOPP_SITE_COUNTS, 0U, 0U);
    *count = 255U;
    expect(ELMOPP_SITE_COUNTS, 0U, 0U);
    *count = before;
}

static void test_tables_of_hours_have_no_more_rows_than_there_is_room_for(void) {
    for (uint32_t i = 1U; i < ELMOPP_PROGRAM_MAX; i++) {
        site.program[i] = site.program[0];
    }
    for (uint32_t i = 0U; i < ELMOPP_SCHEDULE_MAX; i++) {
        site.schedule[i].weekdays = 1U;
    }
    check_count(&site.program_count, 4U);
    check_count(&site.schedule_count, 16U);
    check_count(&site.special_day_count, 16U);
}

static void test_the_first_stage_exists(void) {
    site.first_stage = GROUPS - 1U;
    expect_ok();
    site.first_stage = GROUPS;
    expect(ELMOPP_SITE_START, 0U, 0U);
    site.first_stage = ELMOPP_STAGE_NONE;
    expect(ELMOPP_SITE_START, 0U, 0U);
}

static void test_cameras_look_at_approaches_that_exist(void) {
    site.cameras = 0U; /* everybody on recall */
    expect_ok();
    site.cameras = 0x0FU;
    expect_ok();
    site.cameras = 0x10U;
    expect(ELMOPP_SITE_START, 0U, 0U);
    site.cameras = 0x81U;
    expect(ELMOPP_SITE_START, 0U, 0U);
    site = test_cross(ELMOPP_APPROACH_MAX);
    site.cameras = 0xFFU;
    expect_ok();
}

static void check_start_time(uint16_t *time_ds) {
    *time_ds = TEN_MINUTES_DS;
    expect_ok();
    *time_ds = TEN_MINUTES_DS + 1U;
    expect(ELMOPP_SITE_START, 0U, 0U);
    *time_ds = 65535U;
    expect(ELMOPP_SITE_START, 0U, 0U);
    *time_ds = 0U;
    expect_ok();
}

static void test_a_start_takes_ten_minutes_of_each_at_most(void) {
    check_start_time(&site.start_flash_ds);
    check_start_time(&site.start_red_ds);
}

static void test_a_change_waits_ten_seconds_for_the_junction_at_most(void) {
    site.red_bound_ds = 0U;
    site.simulation_only = 1U;
    for (uint32_t wait_ds = 0U; wait_ds <= UINT16_MAX; wait_ds++) {
        site.junction_wait_ds = (uint16_t)wait_ds;
        if (wait_ds <= ELMOPP_SITE_JUNCTION_WAIT_MAX_DS) {
            expect_ok();
        } else {
            expect(ELMOPP_SITE_WAIT, 0U, 0U);
        }
    }
}

static void test_detectors_may_have_any_limits(void) {
    site.no_activity_min = 255U;
    site.max_presence_min = 255U;
    site.erratic_per_min = 255U;
    expect_ok();
}

static void test_codes_are_known(void) {
    uint8_t *const code[] = {&site.simulation_only, &site.discharge, &site.chooser, &site.forecast};
    const uint8_t last[] = {1U, ELMOPP_DISCHARGE_NOLOCK, ELMOPP_CHOOSER_COUNT - 1U, ELMOPP_FORECAST_COUNT - 1U};
    site.free_flow_m_per_s = 10.0F;
    for (uint32_t i = 0U; i < 4U; i++) {
        site.simulation_only = 1U; /* a street has but one law of discharge */
        *code[i] = last[i];
        expect_ok();
        *code[i] = (uint8_t)(last[i] + 1U);
        expect(ELMOPP_SITE_COUNTS, 0U, 0U);
        *code[i] = 255U;
        expect(ELMOPP_SITE_COUNTS, 0U, 0U);
        *code[i] = 0U;
    }
}

/* Only what somebody looks at, and what there is a learner for. */
static void test_a_forecast_learns_that_can_and_that_somebody_looks_at(void) {
    for (uint32_t chooser = 0U; chooser < ELMOPP_CHOOSER_COUNT; chooser++) {
        for (uint32_t forecast = 0U; forecast < ELMOPP_FORECAST_COUNT; forecast++) {
            site.chooser = (uint8_t)chooser;
            site.forecast = (uint8_t)forecast;
            site.learning = 0U;
            expect_ok();
            site.learning = 1U;
            const bool looks = (chooser == ELMOPP_CHOOSER_CUMULATIVE) || (chooser == ELMOPP_CHOOSER_ROLLOUT);
            TEST_ASSERT_EQUAL(looks, elmopp_junction_looks_ahead(&site));
            if (looks && ((forecast == ELMOPP_FORECAST_LSTM) || (forecast == ELMOPP_FORECAST_NLSTM))) {
                expect_ok();
                site.learning = 2U;
                expect(ELMOPP_SITE_COUNTS, 0U, 0U);
            } else {
                expect(ELMOPP_SITE_COUNTS, 0U, 0U);
            }
        }
    }
}

static void test_greenshields_needs_a_free_flow_up_to_100(void) {
    const float good[] = {1.0e-6F, 10.0F, 100.0F};
    const float bad[] = {0.0F, -1.0F, 100.001F, INFINITY, NAN};
    site.simulation_only = 1U;
    for (uint32_t i = 0U; i < 3U; i++) {
        site.discharge = ELMOPP_DISCHARGE_GREENSHIELDS;
        site.free_flow_m_per_s = good[i];
        expect_ok();
    }
    for (uint32_t i = 0U; i < 5U; i++) {
        site.free_flow_m_per_s = bad[i];
        site.discharge = ELMOPP_DISCHARGE_GREENSHIELDS;
        expect(ELMOPP_SITE_COUNTS, 0U, 0U);
        site.discharge = ELMOPP_DISCHARGE_NOLOCK;
        expect(ELMOPP_SITE_COUNTS, 0U, 0U);
    }
    site.discharge = ELMOPP_DISCHARGE_SATURATION;
    site.free_flow_m_per_s = 0.0F;
    expect_ok();
}

/* A name of the greatest length passes, one character more has no room for the zero. */
static void check_name(char *name, uint32_t size) {
    (void)memset(name, 'x', size - 1U);
    expect_ok();
    name[size - 1U] = 'x';
    expect(ELMOPP_SITE_NAME, 0U, 0U);
    (void)memset(name, 0, size);
    name[0] = 'x';
    expect_ok();
    name[0] = '\0';
    expect(ELMOPP_SITE_NAME, 0U, 0U);
    name[0] = 'x';
}

static void test_every_name_that_exists_ends_with_a_zero_and_is_not_empty(void) {
    check_name(site.name, ELMOPP_SITE_NAME_SIZE);
    for (uint32_t i = 0U; i < GROUPS; i++) {
        check_name(site.approach_name[i], ELMOPP_NAME_SIZE);
        check_name(site.movement[i].name, ELMOPP_NAME_SIZE);
        check_name(site.group[i].name, ELMOPP_NAME_SIZE);
    }
}

static void set_hold(uint32_t min_s, uint32_t max_s) {
    site.hold_min_s = (uint16_t)min_s;
    site.hold_max_s = (uint16_t)max_s;
}

static void test_a_street_discharges_by_saturation_flow(void) {
    site.free_flow_m_per_s = 10.0F;
    site.discharge = ELMOPP_DISCHARGE_GREENSHIELDS;
    expect(ELMOPP_SITE_COUNTS, 0U, 0U);
    site.discharge = ELMOPP_DISCHARGE_NOLOCK;
    expect(ELMOPP_SITE_COUNTS, 0U, 0U);
    site.simulation_only = 1U;
    expect_ok();
}

static void test_reach_is_a_length(void) {
    const float bad[] = {-1.0e-3F, 100001.0F, INFINITY, NAN};
    for (uint32_t i = 0U; i < 4U; i++) {
        site.reach_m = bad[i];
        expect(ELMOPP_SITE_COUNTS, 0U, 0U);
    }
    site.reach_m = 100000.0F;
    expect_ok();
    site.reach_m = 0.0F;
    expect_ok();
}

static void test_hold_window_is_within_1_and_the_horizon(void) {
    set_hold(1U, 1U);
    expect_ok();
    set_hold(ELMOPP_HORIZON_MAX, ELMOPP_HORIZON_MAX);
    expect_ok();
    set_hold(0U, 60U);
    expect(ELMOPP_SITE_HOLD, 0U, 0U);
    set_hold(31U, 30U);
    expect(ELMOPP_SITE_HOLD, 0U, 0U);
    set_hold(10U, ELMOPP_HORIZON_MAX + 1U);
    expect(ELMOPP_SITE_HOLD, 0U, 0U);
}

static void test_capacity_is_0_to_a_million(void) {
    const float good[] = {0.0F, 1.0e-3F, VEHICLES_MAX};
    const float bad[] = {-1.0e-3F, nextafterf(VEHICLES_MAX, INFINITY), INFINITY, -INFINITY, NAN};
    for (uint32_t i = 0U; i < 3U; i++) {
        site.movement[2].capacity_veh = good[i];
        expect_ok();
    }
    for (uint32_t i = 0U; i < 5U; i++) {
        site.movement[2].capacity_veh = bad[i];
        expect(ELMOPP_SITE_MOVEMENT, 2U, 0U);
    }
}

static void test_saturation_flow_is_above_0(void) {
    const float good[] = {1.0e-6F, VEHICLES_MAX};
    const float bad[] = {0.0F, -1.0F, nextafterf(VEHICLES_MAX, INFINITY), INFINITY, NAN};
    for (uint32_t i = 0U; i < 2U; i++) {
        site.movement[3].saturation_veh_per_s = good[i];
        expect_ok();
    }
    for (uint32_t i = 0U; i < 5U; i++) {
        site.movement[3].saturation_veh_per_s = bad[i];
        expect(ELMOPP_SITE_MOVEMENT, 3U, 0U);
    }
}

static void test_a_movement_has_a_lane(void) {
    site.movement[0].lanes = 0U;
    expect(ELMOPP_SITE_MOVEMENT, 0U, 0U);
    site.movement[0].lanes = 255U;
    expect_ok();
}

static void test_a_speed_limit_is_none_or_5_to_200(void) {
    const uint8_t good[] = {0U, 5U, 200U};
    const uint8_t bad[] = {1U, 4U, 201U, 255U};
    for (uint32_t i = 0U; i < 3U; i++) {
        site.movement[2].limit_km_per_h = good[i];
        expect_ok();
    }
    for (uint32_t i = 0U; i < 4U; i++) {
        site.movement[2].limit_km_per_h = bad[i];
        expect(ELMOPP_SITE_MOVEMENT, 2U, 0U);
    }
}

static void test_a_movement_names_an_approach_that_exists(void) {
    site.movement[1].approach = 3U;
    expect_ok();
    site.movement[1].approach = 4U;
    expect(ELMOPP_SITE_MOVEMENT, 1U, 0U);
    site.movement[1].approach = 255U;
    expect(ELMOPP_SITE_MOVEMENT, 1U, 0U);
}

static void test_a_movement_names_groups_that_exist(void) {
    site.movement[1].groups = 0x0008U;
    site.rescue_stage[1] = 3U;
    expect_ok();
    site.movement[1].groups = 0x0010U;
    expect(ELMOPP_SITE_MOVEMENT, 1U, 0U);
    site.movement[1].groups = 0x8002U;
    expect(ELMOPP_SITE_MOVEMENT, 1U, 0U);
    site.movement[1].groups = 0U;
    expect(ELMOPP_SITE_MOVEMENT, 1U, 0U);
}

static void test_a_movement_is_served_by_a_stage(void) {
    site.movement[1].groups = 0x000CU;
    site.stage_groups[GROUPS] = 0x000CU; /* not counted, so no stage */
    expect(ELMOPP_SITE_MOVEMENT, 1U, 0U);
    make_compatible();
    site.rescue_stage[1] = 2U;
    expect_ok();
}

static void test_an_approach_has_3_movements_at_most(void) {
    site.movement[0].approach = 2U;
    site.movement[1].approach = 2U;
    expect_ok();
    site.movement[3].approach = 2U;
    expect(ELMOPP_SITE_APPROACH, 2U, 0U);
    site.movement_count = 3U;
    expect_ok();
}

static void test_a_movement_is_rescued_by_a_stage_that_serves_it(void) {
    site.rescue_stage[2] = 1U;
    expect(ELMOPP_SITE_RESCUE, 2U, 0U);
    site.rescue_stage[2] = 2U;
    expect_ok();
    site.rescue_stage[3] = GROUPS;
    site.stage_groups[GROUPS] = 0x000FU; /* not counted, so no stage */
    expect(ELMOPP_SITE_RESCUE, 3U, 0U);
    site.rescue_stage[3] = 255U;
    expect(ELMOPP_SITE_RESCUE, 3U, 0U);
}

static void test_one_of_a_movements_groups_is_no_rescue(void) {
    make_compatible();
    site.movement[0].groups = 0x000CU;
    site.rescue_stage[0] = 2U;
    expect_ok();
    site.stage_groups[2] = 0x0004U;
    site.stage_groups[3] = 0x000CU;
    site.stage_count = 4U;
    expect(ELMOPP_SITE_RESCUE, 0U, 0U);
}

/* Movement 2 gives way to movement 3; both go in stage 2, nobody else does. */
static void let_give_way(void) {
    make_compatible();
    site.gives_way[2] = 0x8U;
    site.movement[2].gives_way_percent = 100U;
}

static void test_a_movement_gives_way_to_one_that_goes_with_it(void) {
    let_give_way();
    expect_ok();
    site.gives_way[2] = 0xAU;
    expect(ELMOPP_SITE_GIVES_WAY, 2U, 1U);
    site.gives_way[2] = 0xBU;
    expect(ELMOPP_SITE_GIVES_WAY, 2U, 0U);
}

static void test_nobody_gives_way_to_himself_or_to_none_that_exists(void) {
    let_give_way();
    site.gives_way[2] = 0xCU;
    expect(ELMOPP_SITE_GIVES_WAY, 2U, 2U);
    site.gives_way[2] = 0x8U | (1U << GROUPS);
    expect(ELMOPP_SITE_GIVES_WAY, 2U, 2U);
    site.gives_way[2] = 0x80000000U;
    expect(ELMOPP_SITE_GIVES_WAY, 2U, 2U);
}

static void test_who_gives_way_says_by_what_share(void) {
    let_give_way();
    site.movement[2].gives_way_percent = 1U;
    expect_ok();
    site.movement[2].gives_way_percent = 0U;
    expect(ELMOPP_SITE_GIVES_WAY, 2U, 2U);
    site.movement[2].gives_way_percent = 101U;
    expect(ELMOPP_SITE_GIVES_WAY, 2U, 2U);
    site.movement[2].gives_way_percent = 100U;
    site.movement[1].gives_way_percent = 1U;
    expect(ELMOPP_SITE_GIVES_WAY, 1U, 1U);
}

static void test_nobody_gives_way_under_a_law_of_the_queue(void) {
    let_give_way();
    site.simulation_only = 1U;
    expect_ok();
    site.discharge = ELMOPP_DISCHARGE_NOLOCK;
    site.free_flow_m_per_s = 10.0F;
    expect(ELMOPP_SITE_GIVES_WAY, 2U, 2U);
    site.gives_way[2] = 0U;
    site.movement[2].gives_way_percent = 0U;
    expect_ok();
}

static void test_a_street_has_3_to_6_seconds_of_amber(void) {
    for (uint32_t amber_ds = 30U; amber_ds <= 60U; amber_ds += 30U) {
        site.group[2].amber_ds = (uint16_t)amber_ds;
        for (uint32_t g = 0U; g < GROUPS; g++) {
            site.intergreen_ds[2][g] = (g == 2U) ? 0U : 70U;
        }
        expect_ok();
    }
    site.group[2].amber_ds = 29U;
    expect(ELMOPP_SITE_GROUP, 2U, 0U);
    site.group[2].amber_ds = 61U;
    expect(ELMOPP_SITE_GROUP, 2U, 0U);
}

static void test_a_simulation_may_have_no_amber(void) {
    site.group[2].amber_ds = 0U;
    expect(ELMOPP_SITE_GROUP, 2U, 0U);
    site.simulation_only = 1U;
    expect_ok();
}

static void test_a_street_has_5_seconds_of_green_a_simulation_1(void) {
    site.group[3].min_green_ds = 50U;
    expect_ok();
    site.group[3].min_green_ds = 49U;
    expect(ELMOPP_SITE_GROUP, 3U, 0U);
    site.simulation_only = 1U;
    expect_ok();
    site.group[3].min_green_ds = 10U;
    expect_ok();
    site.group[3].min_green_ds = 9U;
    expect(ELMOPP_SITE_GROUP, 3U, 0U);
}

static void test_maximum_green_is_not_below_the_minimum(void) {
    site.group[1].max_green_ds = CROSS_MIN_GREEN_DS;
    expect_ok();
    site.group[1].max_green_ds = CROSS_MIN_GREEN_DS - 1U;
    expect(ELMOPP_SITE_GROUP, 1U, 0U);
    site.group[1].max_green_ds = 1U;
    expect(ELMOPP_SITE_GROUP, 1U, 0U);
}

static void test_only_a_simulation_has_greens_without_a_maximum(void) {
    site.group[1].max_green_ds = 0U;
    expect(ELMOPP_SITE_GROUP, 1U, 0U);
    site.simulation_only = 1U;
    expect_ok();
    site.group[1].max_green_ds = CROSS_MIN_GREEN_DS - 1U;
    expect(ELMOPP_SITE_GROUP, 1U, 0U);
}

static void check_group_time(uint16_t *time_ds) {
    *time_ds = TEN_MINUTES_DS;
    expect_verdict(ELMOPP_SITE_OK, 0U, elmopp_site_check_group(&site, 2U));
    *time_ds = TEN_MINUTES_DS + 1U;
    expect_verdict(ELMOPP_SITE_GROUP, 2U, elmopp_site_check_group(&site, 2U));
    *time_ds = 65535U;
    expect_verdict(ELMOPP_SITE_GROUP, 2U, elmopp_site_check_group(&site, 2U));
}

/* In a simulation, where amber has no street's limit. */
static void test_no_time_of_a_group_is_above_ten_minutes(void) {
    uint16_t *const time_ds[] = {&site.group[2].amber_ds, &site.group[2].red_amber_ds, &site.group[2].min_green_ds,
                                 &site.group[2].max_green_ds};
    for (uint32_t i = 0U; i < 4U; i++) {
        site = test_cross(GROUPS);
        site.simulation_only = 1U;
        site.group[2].max_green_ds = 0U;
        check_group_time(time_ds[i]);
    }
}

static void test_a_group_has_one_of_8_lamp_nodes(void) {
    site.group[0].node = 7U;
    expect_ok();
    site.group[0].node = 8U;
    expect(ELMOPP_SITE_GROUP, 0U, 0U);
    site.group[0].node = 255U;
    expect(ELMOPP_SITE_GROUP, 0U, 0U);
}

static void test_a_group_flashes_amber_or_red_or_not_at_all(void) {
    for (uint8_t flash = ELMOPP_FLASH_AMBER; flash <= ELMOPP_FLASH_DARK; flash++) {
        site.group[3].flash = flash;
        expect_ok();
    }
    site.group[3].flash = ELMOPP_FLASH_DARK + 1U;
    expect(ELMOPP_SITE_GROUP, 3U, 0U);
    site.group[3].flash = 255U;
    expect(ELMOPP_SITE_GROUP, 3U, 0U);
}

static void test_conflicts_are_symmetric(void) {
    site.conflict[1] &= 0x000DU;
    site.conflict[1] &= (uint16_t)~0x0004U;
    expect(ELMOPP_SITE_CONFLICT, 1U, 2U);
    site = test_cross(GROUPS);
    site.conflict[3] = 0x0003U;
    expect(ELMOPP_SITE_CONFLICT, 2U, 3U);
}

static void test_no_group_conflicts_with_itself(void) {
    site.conflict[2] |= 0x0004U;
    expect(ELMOPP_SITE_CONFLICT, 2U, 2U);
}

static void test_no_group_conflicts_with_one_that_does_not_exist(void) {
    site.conflict[0] |= 0x0010U;
    TEST_ASSERT_EQUAL_INT(ELMOPP_SITE_CONFLICT, elmopp_site_check(&site).fault);
    TEST_ASSERT_EQUAL_UINT8(0U, elmopp_site_check(&site).first);
    site = test_cross(GROUPS);
    site.conflict[3] |= 0x8000U;
    TEST_ASSERT_EQUAL_INT(ELMOPP_SITE_CONFLICT, elmopp_site_check(&site).fault);
    TEST_ASSERT_EQUAL_UINT8(3U, elmopp_site_check(&site).first);
}

static void test_intergreen_is_at_least_amber_of_the_ending_and_red_amber_of_the_starting(void) {
    site.group[1].amber_ds = 31U;
    site.group[2].red_amber_ds = 17U;
    site.intergreen_ds[1][2] = 48U;
    site.intergreen_ds[2][1] = 40U;
    expect_ok();
    site.intergreen_ds[1][2] = 47U;
    expect(ELMOPP_SITE_INTERGREEN, 1U, 2U);
    site.intergreen_ds[1][2] = 48U;
    site.intergreen_ds[2][1] = 39U;
    expect(ELMOPP_SITE_INTERGREEN, 2U, 1U);
}

static void test_a_simulation_too_has_an_intergreen_as_long_as_its_lamps(void) {
    site.simulation_only = 1U;
    site.intergreen_ds[0][3] = CROSS_AMBER_DS + CROSS_RED_AMBER_DS - 1U;
    expect(ELMOPP_SITE_INTERGREEN, 0U, 3U);
    site.intergreen_ds[0][3] = CROSS_AMBER_DS + CROSS_RED_AMBER_DS;
    expect_ok();
}

static void test_compatible_groups_have_no_intergreen(void) {
    make_compatible();
    site.intergreen_ds[3][2] = 1U;
    expect(ELMOPP_SITE_INTERGREEN, 3U, 2U);
    make_compatible();
    site.intergreen_ds[1][1] = 55U;
    expect(ELMOPP_SITE_INTERGREEN, 1U, 1U);
}

static void test_sums_of_lamps_do_not_wrap(void) {
    site.group[1].red_amber_ds = 65535U;
    const elmopp_site_verdict_t verdict = elmopp_site_check_pair(&site, 0U, 1U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_SITE_INTERGREEN, verdict.fault);
    TEST_ASSERT_EQUAL_UINT8(0U, verdict.first);
    TEST_ASSERT_EQUAL_UINT8(1U, verdict.second);
}

static void test_no_intergreen_is_above_ten_minutes(void) {
    site.simulation_only = 1U;
    site.red_bound_ds = 0U;
    site.intergreen_ds[2][0] = TEN_MINUTES_DS;
    expect_ok();
    site.intergreen_ds[2][0] = TEN_MINUTES_DS + 1U;
    expect(ELMOPP_SITE_INTERGREEN, 2U, 0U);
    site.intergreen_ds[2][0] = 65535U;
    expect(ELMOPP_SITE_INTERGREEN, 2U, 0U);
}

static void test_a_stage_is_not_empty(void) {
    site.stage_groups[2] = 0U;
    TEST_ASSERT_EQUAL_INT(ELMOPP_SITE_STAGE, elmopp_site_check_stage(&site, 2U).fault);
    TEST_ASSERT_EQUAL_UINT8(2U, elmopp_site_check_stage(&site, 2U).first);
    site = test_cross(GROUPS);
    site.stage_groups[4] = 0U;
    site.stage_count = 5U;
    expect(ELMOPP_SITE_STAGE, 4U, 0U);
}

static void test_a_stage_names_groups_that_exist(void) {
    site.stage_groups[1] |= 0x0010U;
    expect(ELMOPP_SITE_STAGE, 1U, 0U);
}

static void test_no_stage_is_repeated(void) {
    site.stage_count = 5U;
    for (uint32_t s = 0U; s < 4U; s++) {
        site.stage_groups[4] = site.stage_groups[s];
        expect(ELMOPP_SITE_STAGE, 4U, s);
    }
}

static void test_every_group_is_in_a_stage(void) {
    site.movement_count = 3U;
    site.stage_count = 3U;
    expect(ELMOPP_SITE_STAGE, 3U, 0U);
}

static void test_no_stage_holds_two_groups_that_conflict(void) {
    site.stage_groups[2] = 0x000CU;
    expect(ELMOPP_SITE_STAGE_CONFLICT, 2U, 3U);
    site = test_cross(GROUPS);
    site.stage_groups[0] = 0x0009U;
    expect(ELMOPP_SITE_STAGE_CONFLICT, 0U, 3U);
}

static void test_every_stage_is_maximal(void) {
    make_compatible();
    site.stage_groups[2] = 0x0008U;
    site.stage_groups[3] = 0x0004U;
    site.stage_count = 4U;
    site.rescue_stage[2] = 3U;
    expect(ELMOPP_SITE_STAGE_NOT_MAXIMAL, 2U, 2U);
    site.stage_groups[2] = 0x0004U;
    site.stage_groups[3] = 0x0008U;
    site.rescue_stage[2] = 2U;
    site.rescue_stage[3] = 3U;
    expect(ELMOPP_SITE_STAGE_NOT_MAXIMAL, 2U, 3U);
}

/* Somebody else's signal may have any stages, but they must be compatible, different and not empty as well. */
static void test_a_simulation_may_have_stages_that_are_not_maximal(void) {
    make_compatible();
    site.simulation_only = 1U;
    site.stage_groups[2] = 0x0008U;
    site.stage_groups[3] = 0x0004U;
    site.stage_count = 4U;
    site.rescue_stage[2] = 3U;
    site.rescue_stage[3] = 2U;
    site.program[0].step[3].stage = 3U;
    expect_ok();
    site.stage_groups[4] = 0x0008U;
    site.stage_count = 5U;
    expect(ELMOPP_SITE_STAGE, 4U, 2U);
    site.stage_groups[4] = 0x0009U;
    expect(ELMOPP_SITE_STAGE_CONFLICT, 0U, 3U);
}

/* One way to leave each group of a pair out: 0 and 1 may be green together, and so may 2 and 3. */
static void test_maximality_looks_at_every_group(void) {
    for (uint32_t left_out = 0U; left_out < GROUPS; left_out++) {
        make_compatible();
        site.conflict[0] = 0x000CU;
        site.conflict[1] = 0x000CU;
        site.intergreen_ds[0][1] = 0U;
        site.intergreen_ds[1][0] = 0U;
        site.stage_groups[0] = 0x0003U;
        site.stage_groups[1] = 0x000CU;
        site.stage_count = 2U;
        use_stages(0U, 1U);
        expect_ok();
        site.stage_groups[2] = (uint16_t)(1U << (left_out ^ 1U));
        site.stage_count = 3U;
        expect(ELMOPP_SITE_STAGE_NOT_MAXIMAL, 2U, left_out);
    }
}

/* What the shipped sites rely on, found by hand: one bit of a real conflict table set or cleared. */
static void test_a_changed_conflict_bit_of_a_shipped_site_is_found(void) {
    for (uint32_t i = 0U; i < TEST_SITE_COUNT; i++) {
        for (uint32_t g = 0U; g < test_sites[i]->group_count; g++) {
            for (uint32_t h = 0U; h < ELMOPP_GROUP_MAX; h++) {
                site = *test_sites[i];
                site.conflict[g] ^= (uint16_t)(1U << h);
                TEST_ASSERT_EQUAL_INT(ELMOPP_SITE_CONFLICT, elmopp_site_check(&site).fault);
            }
        }
    }
}

/* The cross changes within minimum green, intergreen and two ticks; each of its movements has a stage of its own. */
#define CHANGE_DS (CROSS_MIN_GREEN_DS + CROSS_INTERGREEN_DS + 2U)

static void expect_least_red_bound(uint32_t least_ds) {
    TEST_ASSERT_EQUAL_UINT32(least_ds, elmopp_site_red_bound_min_ds(&site));
    site.red_bound_ds = (uint16_t)least_ds;
    expect_ok();
    site.red_bound_ds = (uint16_t)(least_ds - 1U);
    expect(ELMOPP_SITE_RED_BOUND, 0U, 0U);
}

static void test_a_bound_on_red_leaves_time_for_a_change_to_every_rescue_stage_and_one_before(void) {
    TEST_ASSERT_EQUAL_UINT32(107U, CHANGE_DS);
    for (uint32_t count = 1U; count <= ELMOPP_GROUP_MAX; count++) {
        site = test_cross(count);
        /* Alone, a group has no intergreen: its own amber and red-amber are what takes time. */
        const uint32_t alone_ds = CROSS_MIN_GREEN_DS + CROSS_AMBER_DS + CROSS_RED_AMBER_DS + 2U;
        expect_least_red_bound((count == 1U) ? (2U * alone_ds) : ((1U + count) * CHANGE_DS));
    }
    TEST_ASSERT_EQUAL_UINT32(1819U, elmopp_site_red_bound_min_ds(&site));
}

static void test_a_rescue_stage_of_several_movements_counts_once(void) {
    make_compatible();
    expect_least_red_bound((1U + 3U) * CHANGE_DS);
    make_32_stages();
    expect_least_red_bound((1U + 2U) * CHANGE_DS);
}

static void test_rows_behind_the_last_movement_do_not_count_for_the_bound(void) {
    site.movement_count = GROUPS - 1U;
    expect_least_red_bound((1U + GROUPS - 1U) * CHANGE_DS);
}

static void test_the_bound_counts_on_the_longest_green_and_clearance(void) {
    site.group[1].min_green_ds = 90U;
    site.program[0].step[1].green_ds = 90U;
    site.intergreen_ds[3][2] = 80U;
    expect_least_red_bound((1U + GROUPS) * (90U + 80U + 2U));
}

static void test_a_bound_on_red_is_ten_minutes_at_most(void) {
    site.red_bound_ds = TEN_MINUTES_DS;
    expect_ok();
    site.red_bound_ds = TEN_MINUTES_DS + 1U;
    expect(ELMOPP_SITE_RED_BOUND, 0U, 0U);
    site.red_bound_ds = 65535U;
    expect(ELMOPP_SITE_RED_BOUND, 0U, 0U);
}

/* Ten minutes of green and of clearance, and a rescue stage for each of 24 movements: 25 x 1200.2 s. */
static void test_the_least_bound_does_not_wrap(void) {
    make_32_stages();
    site.movement_count = ELMOPP_MOVEMENT_MAX;
    for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
        site.rescue_stage[j] = (uint8_t)(31U - j);
    }
    site.group[0].min_green_ds = TEN_MINUTES_DS;
    site.intergreen_ds[0][1] = TEN_MINUTES_DS;
    TEST_ASSERT_EQUAL_UINT32(25U * 12002U, elmopp_site_red_bound_min_ds(&site));
    expect_verdict(ELMOPP_SITE_RED_BOUND, 0U, elmopp_site_check_red_bound(&site));
    for (uint32_t stage = 32U; stage < 256U; stage++) {
        site.rescue_stage[5] = (uint8_t)stage; /* none that there is */
        TEST_ASSERT_EQUAL_UINT32(24U * 12002U, elmopp_site_red_bound_min_ds(&site));
    }
}

static void test_only_a_simulation_has_no_bound_on_red(void) {
    site.red_bound_ds = 0U;
    expect(ELMOPP_SITE_RED_BOUND, 0U, 0U);
    site.simulation_only = 1U;
    expect_ok();
    expect_least_red_bound((1U + GROUPS) * CHANGE_DS);
}

static void test_only_a_simulation_has_no_programme(void) {
    site.program_count = 0U;
    expect(ELMOPP_SITE_PROGRAM, 0U, ELMOPP_STEP_MAX);
    site.simulation_only = 1U;
    expect_ok();
}

static void test_a_programme_has_1_to_16_steps(void) {
    site.program_count = 2U;
    site.program[1] = site.program[0];
    for (uint32_t i = GROUPS; i < ELMOPP_STEP_MAX; i++) {
        site.program[1].step[i] = site.program[1].step[0];
    }
    site.program[1].step_count = 16U;
    expect_ok();
    site.program[1].step_count = 17U;
    expect(ELMOPP_SITE_PROGRAM, 1U, ELMOPP_STEP_MAX);
    site.program[1].step_count = 0U;
    expect(ELMOPP_SITE_PROGRAM, 1U, ELMOPP_STEP_MAX);
    site = test_cross(1U);
    site.program[0].step_count = 1U;
    expect_ok();
}

static void test_a_step_shows_a_stage_that_exists(void) {
    site.program_count = 2U;
    site.program[1] = site.program[0];
    site.program[1].step[2].stage = GROUPS;
    site.stage_groups[GROUPS] = 0x0004U; /* not counted, so no stage */
    expect(ELMOPP_SITE_PROGRAM, 1U, 2U);
    site.program[1].step[2].stage = 255U;
    expect(ELMOPP_SITE_PROGRAM, 1U, 2U);
    site.program_count = 1U;
    expect_ok();
}

static void test_a_step_is_as_long_as_its_longest_minimum_green_and_ten_minutes_at_most(void) {
    make_compatible();
    site.group[3].min_green_ds = 60U; /* stage 2 holds groups 2 and 3 */
    site.program[0].step[2].green_ds = 60U;
    site.program[0].step[1].green_ds = CROSS_MIN_GREEN_DS;
    expect_ok();
    site.program[0].step[2].green_ds = 59U;
    expect(ELMOPP_SITE_PROGRAM, 0U, 2U);
    site.program[0].step[2].green_ds = TEN_MINUTES_DS;
    expect_ok();
    site.program[0].step[2].green_ds = TEN_MINUTES_DS + 1U;
    expect(ELMOPP_SITE_PROGRAM, 0U, 2U);
}

static void test_a_programme_serves_every_movement(void) {
    site.program[0].step[1].stage = 0U;
    expect(ELMOPP_SITE_PROGRAM, 0U, ELMOPP_STEP_MAX + 1U);
    site.program[0].step[0].stage = 1U;
    expect_ok();
    site.program[0].step[1].stage = 1U;
    expect(ELMOPP_SITE_PROGRAM, 0U, ELMOPP_STEP_MAX + 0U);
    site.program[0].step[1].stage = 0U;
    site.program[0].step_count = 3U;
    expect(ELMOPP_SITE_PROGRAM, 0U, ELMOPP_STEP_MAX + 3U);
}

static void test_a_simulations_programme_keeps_the_rules_too(void) {
    site.simulation_only = 1U;
    site.program[0].step[3].green_ds = CROSS_MIN_GREEN_DS - 1U;
    expect(ELMOPP_SITE_PROGRAM, 0U, 3U);
}

static void make_schedule(void) {
    site.program_count = 2U;
    site.program[1] = site.program[0];
    site.schedule_count = 3U;
    for (uint32_t i = 0U; i < 3U; i++) {
        site.schedule[i] = (elmopp_schedule_t){.from_min = (uint16_t)(60U * i), .weekdays = 0x1FU, .program = 1U};
    }
    site.schedule[2].program = ELMOPP_SCHEDULE_FLASH;
    expect_ok();
}

static void test_a_line_of_the_schedule_begins_at_a_minute_of_a_day(void) {
    make_schedule();
    site.schedule[1].from_min = 1439U;
    expect_ok();
    site.schedule[1].from_min = 1440U;
    expect(ELMOPP_SITE_SCHEDULE, 1U, 0U);
    site.schedule[1].from_min = 65535U;
    expect(ELMOPP_SITE_SCHEDULE, 1U, 0U);
}

static void test_a_line_of_the_schedule_holds_on_a_weekday(void) {
    make_schedule();
    site.schedule[0].weekdays = 127U;
    expect_ok();
    site.schedule[0].weekdays = 128U;
    expect(ELMOPP_SITE_SCHEDULE, 0U, 0U);
    site.schedule[0].weekdays = 0U;
    expect(ELMOPP_SITE_SCHEDULE, 0U, 0U);
    site.schedule[0].weekdays = 1U;
    expect_ok();
}

static void test_a_line_of_the_schedule_starts_a_programme_or_flashing(void) {
    make_schedule();
    site.schedule[2].program = 2U;
    expect(ELMOPP_SITE_SCHEDULE, 2U, 0U);
    site.schedule[2].program = ELMOPP_SCHEDULE_FLASH - 1U;
    expect(ELMOPP_SITE_SCHEDULE, 2U, 0U);
    site.schedule_count = 2U;
    expect_ok();
}

static void test_a_special_day_follows_a_weekday(void) {
    site.special_day_count = 2U;
    site.special_day[1] = (elmopp_special_day_t){.day = 65535U, .weekday = 6U};
    expect_ok();
    site.special_day[1].weekday = 7U;
    expect(ELMOPP_SITE_SPECIAL_DAY, 1U, 0U);
    site.special_day[1].weekday = 255U;
    expect(ELMOPP_SITE_SPECIAL_DAY, 1U, 0U);
    site.special_day_count = 1U;
    expect_ok();
}

static void break_everything(void) {
    make_schedule();
    site.special_day_count = 1U;
    site.special_day[0].weekday = 7U;
    site.schedule[0].weekdays = 0U;
    site.program[0].step[0].green_ds = 0U;
    site.red_bound_ds = 1U;
    site.stage_groups[1] = 0U;
    site.conflict[0] = 0U;
    site.group[0].amber_ds = 0U;
    site.rescue_stage[0] = 3U;
    site.movement[0].lanes = 0U;
    site.movement[0].approach = 3U;
    site.movement[1].approach = 3U;
    site.movement[2].approach = 3U;
    site.junction_wait_ds = 101U;
    site.first_stage = 77U;
    site.hold_min_s = 0U;
    site.name[0] = '\0';
    site.forecast = 200U;
}

static void test_the_first_fault_in_the_order_of_the_list_is_told(void) {
    break_everything();
    expect(ELMOPP_SITE_COUNTS, 0U, 0U);
    site.forecast = 0U;
    expect(ELMOPP_SITE_NAME, 0U, 0U);
    site.name[0] = 'x';
    expect(ELMOPP_SITE_HOLD, 0U, 0U);
    site.hold_min_s = 1U;
    expect(ELMOPP_SITE_START, 0U, 0U);
    site.first_stage = 0U;
    expect(ELMOPP_SITE_WAIT, 0U, 0U);
    site.junction_wait_ds = 0U;
    expect(ELMOPP_SITE_APPROACH, 3U, 0U);
    site.movement[1].approach = 0U;
    expect(ELMOPP_SITE_MOVEMENT, 0U, 0U);
    site.movement[0].lanes = 1U;
    site.stage_groups[1] = 0x0002U; /* without it movement 1 is none */
    expect(ELMOPP_SITE_RESCUE, 0U, 0U);
    site.rescue_stage[0] = 0U;
    expect(ELMOPP_SITE_GROUP, 0U, 0U);
    site.group[0].amber_ds = 30U;
    expect(ELMOPP_SITE_CONFLICT, 0U, 1U);
    site.conflict[0] = 0x000EU;
    expect(ELMOPP_SITE_RED_BOUND, 0U, 0U);
    site.red_bound_ds = CROSS_RED_BOUND_DS;
    expect(ELMOPP_SITE_PROGRAM, 0U, 0U);
    site.program[0].step[0].green_ds = CROSS_MIN_GREEN_DS;
    expect(ELMOPP_SITE_SCHEDULE, 0U, 0U);
    site.schedule[0].weekdays = 1U;
    expect(ELMOPP_SITE_SPECIAL_DAY, 0U, 0U);
    site.special_day[0].weekday = 0U;
    expect_ok();
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_every_generated_site_passes);
    RUN_TEST(test_made_up_crosses_of_all_sizes_pass);
    RUN_TEST(test_approach_count_is_1_to_8);
    RUN_TEST(test_movement_count_is_1_to_24);
    RUN_TEST(test_group_count_is_1_to_16);
    RUN_TEST(test_stage_count_is_1_to_32);
    RUN_TEST(test_tables_of_hours_have_no_more_rows_than_there_is_room_for);
    RUN_TEST(test_the_first_stage_exists);
    RUN_TEST(test_cameras_look_at_approaches_that_exist);
    RUN_TEST(test_a_start_takes_ten_minutes_of_each_at_most);
    RUN_TEST(test_a_change_waits_ten_seconds_for_the_junction_at_most);
    RUN_TEST(test_detectors_may_have_any_limits);
    RUN_TEST(test_codes_are_known);
    RUN_TEST(test_a_forecast_learns_that_can_and_that_somebody_looks_at);
    RUN_TEST(test_greenshields_needs_a_free_flow_up_to_100);
    RUN_TEST(test_every_name_that_exists_ends_with_a_zero_and_is_not_empty);
    RUN_TEST(test_a_street_discharges_by_saturation_flow);
    RUN_TEST(test_reach_is_a_length);
    RUN_TEST(test_hold_window_is_within_1_and_the_horizon);
    RUN_TEST(test_capacity_is_0_to_a_million);
    RUN_TEST(test_saturation_flow_is_above_0);
    RUN_TEST(test_a_movement_has_a_lane);
    RUN_TEST(test_a_speed_limit_is_none_or_5_to_200);
    RUN_TEST(test_a_movement_names_an_approach_that_exists);
    RUN_TEST(test_a_movement_names_groups_that_exist);
    RUN_TEST(test_a_movement_is_served_by_a_stage);
    RUN_TEST(test_an_approach_has_3_movements_at_most);
    RUN_TEST(test_a_movement_is_rescued_by_a_stage_that_serves_it);
    RUN_TEST(test_one_of_a_movements_groups_is_no_rescue);
    RUN_TEST(test_a_movement_gives_way_to_one_that_goes_with_it);
    RUN_TEST(test_nobody_gives_way_to_himself_or_to_none_that_exists);
    RUN_TEST(test_who_gives_way_says_by_what_share);
    RUN_TEST(test_nobody_gives_way_under_a_law_of_the_queue);
    RUN_TEST(test_a_street_has_3_to_6_seconds_of_amber);
    RUN_TEST(test_a_simulation_may_have_no_amber);
    RUN_TEST(test_a_street_has_5_seconds_of_green_a_simulation_1);
    RUN_TEST(test_maximum_green_is_not_below_the_minimum);
    RUN_TEST(test_only_a_simulation_has_greens_without_a_maximum);
    RUN_TEST(test_no_time_of_a_group_is_above_ten_minutes);
    RUN_TEST(test_a_group_has_one_of_8_lamp_nodes);
    RUN_TEST(test_a_group_flashes_amber_or_red_or_not_at_all);
    RUN_TEST(test_conflicts_are_symmetric);
    RUN_TEST(test_no_group_conflicts_with_itself);
    RUN_TEST(test_no_group_conflicts_with_one_that_does_not_exist);
    RUN_TEST(test_intergreen_is_at_least_amber_of_the_ending_and_red_amber_of_the_starting);
    RUN_TEST(test_a_simulation_too_has_an_intergreen_as_long_as_its_lamps);
    RUN_TEST(test_compatible_groups_have_no_intergreen);
    RUN_TEST(test_sums_of_lamps_do_not_wrap);
    RUN_TEST(test_no_intergreen_is_above_ten_minutes);
    RUN_TEST(test_a_stage_is_not_empty);
    RUN_TEST(test_a_stage_names_groups_that_exist);
    RUN_TEST(test_no_stage_is_repeated);
    RUN_TEST(test_every_group_is_in_a_stage);
    RUN_TEST(test_no_stage_holds_two_groups_that_conflict);
    RUN_TEST(test_every_stage_is_maximal);
    RUN_TEST(test_a_simulation_may_have_stages_that_are_not_maximal);
    RUN_TEST(test_maximality_looks_at_every_group);
    RUN_TEST(test_a_changed_conflict_bit_of_a_shipped_site_is_found);
    RUN_TEST(test_a_bound_on_red_leaves_time_for_a_change_to_every_rescue_stage_and_one_before);
    RUN_TEST(test_a_rescue_stage_of_several_movements_counts_once);
    RUN_TEST(test_rows_behind_the_last_movement_do_not_count_for_the_bound);
    RUN_TEST(test_the_bound_counts_on_the_longest_green_and_clearance);
    RUN_TEST(test_a_bound_on_red_is_ten_minutes_at_most);
    RUN_TEST(test_the_least_bound_does_not_wrap);
    RUN_TEST(test_only_a_simulation_has_no_bound_on_red);
    RUN_TEST(test_only_a_simulation_has_no_programme);
    RUN_TEST(test_a_programme_has_1_to_16_steps);
    RUN_TEST(test_a_step_shows_a_stage_that_exists);
    RUN_TEST(test_a_step_is_as_long_as_its_longest_minimum_green_and_ten_minutes_at_most);
    RUN_TEST(test_a_programme_serves_every_movement);
    RUN_TEST(test_a_simulations_programme_keeps_the_rules_too);
    RUN_TEST(test_a_line_of_the_schedule_begins_at_a_minute_of_a_day);
    RUN_TEST(test_a_line_of_the_schedule_holds_on_a_weekday);
    RUN_TEST(test_a_line_of_the_schedule_starts_a_programme_or_flashing);
    RUN_TEST(test_a_special_day_follows_a_weekday);
    RUN_TEST(test_the_first_fault_in_the_order_of_the_list_is_told);
    return UNITY_END();
}
