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

/* Two groups that may be green together: 2 and 3 of the cross. Then stage 2 holds both, and there is no stage 3. */
static void make_compatible(void) {
    site.conflict[2] = 0x0003U;
    site.conflict[3] = 0x0003U;
    site.intergreen_ds[2][3] = 0U;
    site.intergreen_ds[3][2] = 0U;
    site.stage_groups[2] = 0x000CU;
    site.stage_count = 3U;
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
    for (uint32_t j = GROUPS; j < ELMOPP_MOVEMENT_MAX; j++) {
        site.movement[j] = site.movement[0];
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
}

static void test_stage_count_is_1_to_32(void) {
    make_32_stages();
    expect_ok();
    site.stage_count = 33U;
    expect(ELMOPP_SITE_COUNTS, 0U, 0U);
    site.stage_count = 0U;
    expect(ELMOPP_SITE_COUNTS, 0U, 0U);
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

static void test_maximum_green_is_0_or_not_below_the_minimum(void) {
    site.group[1].max_green_ds = 0U;
    expect_ok();
    site.group[1].max_green_ds = CROSS_MIN_GREEN_DS + 1U;
    expect_ok();
    site.group[1].max_green_ds = CROSS_MIN_GREEN_DS - 1U;
    expect(ELMOPP_SITE_GROUP, 1U, 0U);
    site.group[1].max_green_ds = 1U;
    expect(ELMOPP_SITE_GROUP, 1U, 0U);
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
    expect(ELMOPP_SITE_INTERGREEN, 0U, 1U);
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
    expect(ELMOPP_SITE_STAGE_NOT_MAXIMAL, 2U, 2U);
    site.stage_groups[2] = 0x0004U;
    site.stage_groups[3] = 0x0008U;
    expect(ELMOPP_SITE_STAGE_NOT_MAXIMAL, 2U, 3U);
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

static void test_the_first_fault_in_the_order_of_the_list_is_told(void) {
    site.stage_groups[0] = 0U;
    site.conflict[0] = 0U;
    site.group[0].amber_ds = 0U;
    site.hold_min_s = 0U;
    site.name[0] = '\0';
    site.forecast = 200U;
    expect(ELMOPP_SITE_COUNTS, 0U, 0U);
    site.forecast = 0U;
    expect(ELMOPP_SITE_NAME, 0U, 0U);
    site.name[0] = 'x';
    expect(ELMOPP_SITE_HOLD, 0U, 0U);
    site.hold_min_s = 1U;
    expect(ELMOPP_SITE_MOVEMENT, 0U, 0U);
    site.movement[0] = site.movement[1];
    expect(ELMOPP_SITE_GROUP, 0U, 0U);
    site.group[0].amber_ds = 30U;
    expect(ELMOPP_SITE_CONFLICT, 0U, 1U);
    site.conflict[0] = 0x000EU;
    expect(ELMOPP_SITE_STAGE, 0U, 0U);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_every_generated_site_passes);
    RUN_TEST(test_made_up_crosses_of_all_sizes_pass);
    RUN_TEST(test_approach_count_is_1_to_8);
    RUN_TEST(test_movement_count_is_1_to_24);
    RUN_TEST(test_group_count_is_1_to_16);
    RUN_TEST(test_stage_count_is_1_to_32);
    RUN_TEST(test_codes_are_known);
    RUN_TEST(test_greenshields_needs_a_free_flow_up_to_100);
    RUN_TEST(test_every_name_that_exists_ends_with_a_zero_and_is_not_empty);
    RUN_TEST(test_a_street_discharges_by_saturation_flow);
    RUN_TEST(test_reach_is_a_length);
    RUN_TEST(test_hold_window_is_within_1_and_the_horizon);
    RUN_TEST(test_capacity_is_0_to_a_million);
    RUN_TEST(test_saturation_flow_is_above_0);
    RUN_TEST(test_a_movement_has_a_lane);
    RUN_TEST(test_a_movement_names_an_approach_that_exists);
    RUN_TEST(test_a_movement_names_groups_that_exist);
    RUN_TEST(test_a_movement_is_served_by_a_stage);
    RUN_TEST(test_a_street_has_3_to_6_seconds_of_amber);
    RUN_TEST(test_a_simulation_may_have_no_amber);
    RUN_TEST(test_a_street_has_5_seconds_of_green_a_simulation_1);
    RUN_TEST(test_maximum_green_is_0_or_not_below_the_minimum);
    RUN_TEST(test_conflicts_are_symmetric);
    RUN_TEST(test_no_group_conflicts_with_itself);
    RUN_TEST(test_no_group_conflicts_with_one_that_does_not_exist);
    RUN_TEST(test_intergreen_is_at_least_amber_of_the_ending_and_red_amber_of_the_starting);
    RUN_TEST(test_a_simulation_too_has_an_intergreen_as_long_as_its_lamps);
    RUN_TEST(test_compatible_groups_have_no_intergreen);
    RUN_TEST(test_sums_of_lamps_do_not_wrap);
    RUN_TEST(test_a_stage_is_not_empty);
    RUN_TEST(test_a_stage_names_groups_that_exist);
    RUN_TEST(test_no_stage_is_repeated);
    RUN_TEST(test_every_group_is_in_a_stage);
    RUN_TEST(test_no_stage_holds_two_groups_that_conflict);
    RUN_TEST(test_every_stage_is_maximal);
    RUN_TEST(test_maximality_looks_at_every_group);
    RUN_TEST(test_a_changed_conflict_bit_of_a_shipped_site_is_found);
    RUN_TEST(test_the_first_fault_in_the_order_of_the_list_is_told);
    return UNITY_END();
}
