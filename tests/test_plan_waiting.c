/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Whom a maximum green turns to when a movement needs two groups at once: each of them alone would never let it go.

#include "elmopp/plan.h"
#include "sites.h"
#include "unity.h"

#define GROUPS 5U
#define MOVEMENTS 4U
#define EVERYBODY 0x000FU
#define BOTH_GROUPS 3U ///< the movement that needs groups 1 and 2
#define HOURS_TWO_TICKS 72000U

static elmopp_junction_t junction;
static elmopp_plan_t plan;
static uint16_t red_ds[ELMOPP_MOVEMENT_MAX];

/* Stages {0}, {1, 3}, {2, 4}, {1, 2}: groups 1 and 2 are also green apart, for movements 1 and 2 on groups 3 and 4. */
void setUp(void) {
    static const uint16_t stages[] = {0x0001U, 0x000AU, 0x0014U, 0x0006U};
    static const uint16_t movements[MOVEMENTS] = {0x0001U, 0x0008U, 0x0010U, 0x0006U};
    junction = test_cross(GROUPS);
    junction.movement_count = MOVEMENTS;
    junction.stage_count = 4U;
    for (uint32_t j = 0U; j < MOVEMENTS; j++) {
        junction.movement[j].groups = movements[j];
        red_ds[j] = 0U;
    }
    for (uint32_t s = 0U; s < 4U; s++) {
        junction.stage_groups[s] = stages[s];
    }
    static const uint32_t friends[][2] = {{1U, 3U}, {2U, 4U}, {1U, 2U}};
    for (uint32_t i = 0U; i < 3U; i++) {
        const uint32_t a = friends[i][0];
        const uint32_t b = friends[i][1];
        junction.conflict[a] &= (uint16_t)~(1U << b);
        junction.conflict[b] &= (uint16_t)~(1U << a);
        junction.intergreen_ds[a][b] = 0U;
        junction.intergreen_ds[b][a] = 0U;
    }
    elmopp_plan_init(&plan, &junction);
}
void tearDown(void) {}

static void tick(elmopp_stage_t wanted, uint32_t waiting_movements) {
    const elmopp_lamps_t lamps = elmopp_plan_step(&plan, wanted, waiting_movements, false);
    for (uint32_t j = 0U; j < MOVEMENTS; j++) {
        const bool goes = elmopp_junction_goes(&junction, j, lamps.green);
        red_ds[j] = goes ? (uint16_t)0U : (uint16_t)(red_ds[j] + 1U);
    }
}

static uint32_t waiting_now(void) {
    uint32_t waiting = 0U;
    for (uint32_t j = 0U; j < MOVEMENTS; j++) {
        waiting |= (red_ds[j] > 0U) ? ((uint32_t)1U << j) : 0U;
    }
    return waiting;
}

static void test_the_junction_is_a_site(void) {
    /* Group 1 alone serves nobody, which a site may have. */
    TEST_ASSERT_EQUAL_HEX16(0x0006U, junction.movement[BOTH_GROUPS].groups);
    TEST_ASSERT_TRUE(elmopp_junction_goes(&junction, BOTH_GROUPS, junction.stage_groups[3]));
    TEST_ASSERT_FALSE(elmopp_junction_goes(&junction, BOTH_GROUPS, junction.stage_groups[1]));
}

static void test_a_movement_with_two_groups_is_served_when_all_others_wait_too(void) {
    const uint32_t bound_ds = MOVEMENTS * (CROSS_MAX_GREEN_DS + CROSS_MIN_GREEN_DS + CROSS_INTERGREEN_DS);
    for (uint32_t t = 0U; t < HOURS_TWO_TICKS; t++) {
        tick(0U, waiting_now());
        for (uint32_t j = 0U; j < MOVEMENTS; j++) {
            TEST_ASSERT_LESS_THAN_MESSAGE(2U * bound_ds, red_ds[j], "a waiting movement starves");
        }
    }
}

static void test_a_movement_with_two_groups_alone_is_served_at_the_first_force(void) {
    for (uint32_t t = 0U; t < 1000U; t++) {
        tick(0U, (uint32_t)1U << BOTH_GROUPS);
        if (plan.forced) {
            TEST_ASSERT_EQUAL_UINT8(3U, plan.target);
            return;
        }
    }
    TEST_FAIL_MESSAGE("the maximum green never ran out");
}

static void test_equal_waits_go_to_the_lowest_movement(void) {
    for (uint32_t t = 0U; t < 1000U; t++) {
        tick(0U, EVERYBODY & ~1U & ~(1U << BOTH_GROUPS));
        if (plan.forced) {
            TEST_ASSERT_EQUAL_UINT8(1U, plan.target);
            return;
        }
    }
    TEST_FAIL_MESSAGE("the maximum green never ran out");
}

/* The controller marks all movements there could be when it is blind. */
static void test_movements_that_do_not_exist_contest_nothing_and_are_turned_to_by_nothing(void) {
    const uint32_t beyond = ~(uint32_t)EVERYBODY;
    junction.movement[MOVEMENTS].groups = 0x0008U;
    for (uint32_t t = 0U; t < 1000U; t++) {
        tick(0U, beyond);
    }
    TEST_ASSERT_EQUAL_UINT16(0U, plan.group[0].contested_ds);
    TEST_ASSERT_FALSE(plan.forced);
    TEST_ASSERT_EQUAL_UINT8(0U, plan.stage);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_junction_is_a_site);
    RUN_TEST(test_a_movement_with_two_groups_is_served_when_all_others_wait_too);
    RUN_TEST(test_a_movement_with_two_groups_alone_is_served_at_the_first_force);
    RUN_TEST(test_equal_waits_go_to_the_lowest_movement);
    RUN_TEST(test_movements_that_do_not_exist_contest_nothing_and_are_turned_to_by_nothing);
    return UNITY_END();
}
