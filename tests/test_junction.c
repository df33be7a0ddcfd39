/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/junction.h"
#include "sites.h"
#include "unity.h"

#include <math.h>
#include <stddef.h>

#define TENSOR_SIZE 48U
#define GOLDEN_TOLERANCE 1.0e-6F

/* The paper's worked example: quantity, capacity and load of the graph G_alpha, 4 x 4 edges of 3 lanes each. */
static const float q_alpha[TENSOR_SIZE] = {
    0, 0, 0, /**/ 0, 2, 3, /**/ 0, 0, 0, /**/ 0, 6, 4, /* row a */
    0, 0, 3, /**/ 0, 0, 0, /**/ 2, 0, 1, /**/ 0, 0, 0, /* row b */
    0, 0, 0, /**/ 2, 1, 3, /**/ 0, 0, 0, /**/ 4, 5, 4, /* row c */
    7, 7, 7, /**/ 0, 0, 0, /**/ 3, 2, 0, /**/ 0, 0, 0, /* row d */
};
static const float c_alpha[TENSOR_SIZE] = {
    0, 0, 0, /**/ 0, 4, 4, /**/ 0, 0, 0, /**/ 3, 9, 6, /* row a */
    0, 0, 7, /**/ 0, 0, 0, /**/ 3, 2, 4, /**/ 0, 0, 0, /* row b */
    0, 0, 0, /**/ 3, 5, 3, /**/ 0, 0, 0, /**/ 7, 8, 9, /* row c */
    9, 8, 7, /**/ 0, 0, 0, /**/ 4, 5, 5, /**/ 0, 0, 0, /* row d */
};
/* The paper prints fractions; { numerator, denominator }. */
static const double l_alpha[TENSOR_SIZE][2] = {
    {0, 1}, {0, 1}, {0, 1}, {0, 1}, {1, 2}, {3, 4}, {0, 1}, {0, 1}, {0, 1}, {0, 1}, {2, 3}, {2, 3}, /* row a */
    {0, 1}, {0, 1}, {3, 7}, {0, 1}, {0, 1}, {0, 1}, {2, 3}, {0, 1}, {1, 4}, {0, 1}, {0, 1}, {0, 1}, /* row b */
    {0, 1}, {0, 1}, {0, 1}, {2, 3}, {1, 5}, {1, 1}, {0, 1}, {0, 1}, {0, 1}, {4, 7}, {5, 8}, {4, 9}, /* row c */
    {7, 9}, {7, 8}, {1, 1}, {0, 1}, {0, 1}, {0, 1}, {3, 4}, {2, 5}, {0, 1}, {0, 1}, {0, 1}, {0, 1}, /* row d */
};

void setUp(void) {}
void tearDown(void) {}

static elmopp_junction_t with_discharge(uint8_t discharge) {
    elmopp_junction_t junction = elmopp_site_paper;
    junction.discharge = discharge;
    return junction;
}

static float capacity_of(const elmopp_junction_t *junction) {
    return junction->movement[0].capacity_veh;
}

static void test_load_is_the_papers_hadamard_quotient(void) {
    for (uint32_t start = 0U; start < TENSOR_SIZE; start += ELMOPP_MOVEMENT_MAX) {
        elmopp_junction_t junction = {.movement_count = ELMOPP_MOVEMENT_MAX};
        for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
            junction.movement[j].capacity_veh = c_alpha[start + j];
        }
        for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
            const double right = l_alpha[start + j][0] / l_alpha[start + j][1];
            TEST_ASSERT_EQUAL_FLOAT((float)right, elmopp_junction_load(&junction, j, q_alpha[start + j]));
        }
    }
}

static void test_load_without_capacity_is_zero_whatever_waits(void) {
    elmopp_junction_t junction = test_cross(2U);
    junction.movement[1].capacity_veh = 0.0F;
    TEST_ASSERT_EQUAL_FLOAT(0.0F, elmopp_junction_load(&junction, 1U, 0.0F));
    TEST_ASSERT_EQUAL_FLOAT(0.0F, elmopp_junction_load(&junction, 1U, 50.0F));
}

static void test_load_of_a_small_capacity_is_a_quotient_too(void) {
    elmopp_junction_t junction = test_cross(2U);
    junction.movement[0].capacity_veh = 0.25F;
    TEST_ASSERT_EQUAL_FLOAT(2.0F, elmopp_junction_load(&junction, 0U, 0.5F));
}

static void test_load_is_not_capped_at_a_full_lane(void) {
    const elmopp_junction_t junction = test_cross(2U);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, elmopp_junction_load(&junction, 0U, 10.0F));
    TEST_ASSERT_EQUAL_FLOAT(2.5F, elmopp_junction_load(&junction, 0U, 25.0F));
}

static void test_greenshields_golden_values(void) {
    const elmopp_junction_t junction = with_discharge(ELMOPP_DISCHARGE_GREENSHIELDS);
    TEST_ASSERT_FLOAT_WITHIN(1.6F * GOLDEN_TOLERANCE, 1.6F, elmopp_junction_discharge(&junction, 0U, 200.0F / 3.0F));
    TEST_ASSERT_FLOAT_WITHIN(1.875F * GOLDEN_TOLERANCE, 1.875F, elmopp_junction_discharge(&junction, 0U, 250.0F));
    TEST_ASSERT_FLOAT_WITHIN(GOLDEN_TOLERANCE, 0.0F, elmopp_junction_discharge(&junction, 0U, 1000.0F / 3.0F));
}

static void test_nolock_golden_values(void) {
    const elmopp_junction_t junction = with_discharge(ELMOPP_DISCHARGE_NOLOCK);
    TEST_ASSERT_FLOAT_WITHIN(1.6F * GOLDEN_TOLERANCE, 1.6F, elmopp_junction_discharge(&junction, 0U, 200.0F / 3.0F));
    TEST_ASSERT_FLOAT_WITHIN(2.5F * GOLDEN_TOLERANCE, 2.5F, elmopp_junction_discharge(&junction, 0U, 250.0F));
    TEST_ASSERT_FLOAT_WITHIN(2.5F * GOLDEN_TOLERANCE, 2.5F, elmopp_junction_discharge(&junction, 0U, 1000.0F / 3.0F));
}

static void test_nolock_differs_only_above_half_a_load(void) {
    const elmopp_junction_t printed = with_discharge(ELMOPP_DISCHARGE_GREENSHIELDS);
    const elmopp_junction_t nolock = with_discharge(ELMOPP_DISCHARGE_NOLOCK);
    const float half_veh = 0.5F * capacity_of(&printed);
    TEST_ASSERT_EQUAL_FLOAT(2.5F, elmopp_junction_discharge(&nolock, 0U, half_veh));
    TEST_ASSERT_EQUAL_FLOAT(2.5F, elmopp_junction_discharge(&printed, 0U, half_veh));
    TEST_ASSERT_TRUE(elmopp_junction_discharge(&nolock, 0U, half_veh - 40.0F) < 2.5F);
    TEST_ASSERT_EQUAL_FLOAT(elmopp_junction_discharge(&printed, 0U, half_veh - 40.0F),
                            elmopp_junction_discharge(&nolock, 0U, half_veh - 40.0F));
    TEST_ASSERT_TRUE(elmopp_junction_discharge(&printed, 0U, half_veh + 40.0F) < 2.5F);
    TEST_ASSERT_EQUAL_FLOAT(2.5F, elmopp_junction_discharge(&nolock, 0U, half_veh + 40.0F));
}

static void test_saturation_flow_is_the_movements_own(void) {
    const elmopp_junction_t *const junction = &elmopp_site_four_way;
    TEST_ASSERT_EQUAL_FLOAT(0.5F, elmopp_junction_discharge(junction, 0U, 100.0F));
    TEST_ASSERT_EQUAL_FLOAT(1.0F, elmopp_junction_discharge(junction, 1U, 100.0F));
    TEST_ASSERT_EQUAL_FLOAT(0.45F, elmopp_junction_discharge(junction, 2U, 100.0F));
    TEST_ASSERT_EQUAL_FLOAT(0.5F, elmopp_junction_discharge(junction, 0U, 0.5F));
    TEST_ASSERT_EQUAL_FLOAT(0.49F, elmopp_junction_discharge(junction, 0U, 0.49F));
}

/* With 1,000 m/s and 10 vehicles the parabola is far above the queue. */
static void test_no_law_lets_more_leave_than_there_are(void) {
    for (uint8_t law = ELMOPP_DISCHARGE_SATURATION; law <= ELMOPP_DISCHARGE_NOLOCK; law++) {
        elmopp_junction_t junction = test_cross(2U);
        junction.discharge = law;
        junction.free_flow_m_per_s = 1000.0F;
        junction.movement[0].saturation_veh_per_s = 100.0F;
        for (uint32_t i = 0U; i < 90U; i++) {
            const float queue_veh = 0.1F * (float)i;
            TEST_ASSERT_EQUAL_FLOAT(queue_veh, elmopp_junction_discharge(&junction, 0U, queue_veh));
        }
    }
}

static void test_no_law_lets_vehicles_come_back_out_of_an_overfull_lane(void) {
    for (uint8_t law = ELMOPP_DISCHARGE_SATURATION; law <= ELMOPP_DISCHARGE_NOLOCK; law++) {
        const elmopp_junction_t junction = with_discharge(law);
        TEST_ASSERT_TRUE(elmopp_junction_discharge(&junction, 0U, capacity_of(&junction)) >= 0.0F);
        TEST_ASSERT_TRUE(elmopp_junction_discharge(&junction, 0U, 1.001F * capacity_of(&junction)) >= 0.0F);
        TEST_ASSERT_TRUE(elmopp_junction_discharge(&junction, 0U, 5000.0F) >= 0.0F);
    }
}

static void test_a_movement_goes_when_all_of_its_groups_are_green(void) {
    elmopp_junction_t junction = test_cross(16U);
    junction.movement[3].groups = 0x8005U;
    TEST_ASSERT_TRUE(elmopp_junction_goes(&junction, 3U, 0x8005U));
    TEST_ASSERT_TRUE(elmopp_junction_goes(&junction, 3U, 0xFFFFU));
    TEST_ASSERT_FALSE(elmopp_junction_goes(&junction, 3U, 0x0005U));
    TEST_ASSERT_FALSE(elmopp_junction_goes(&junction, 3U, 0x8004U));
    TEST_ASSERT_FALSE(elmopp_junction_goes(&junction, 3U, 0x7FFAU));
    TEST_ASSERT_FALSE(elmopp_junction_goes(&junction, 3U, 0U));
}

static void test_served_is_the_mask_of_the_movements_that_go(void) {
    TEST_ASSERT_EQUAL_HEX32(0x0041U, elmopp_junction_served(&elmopp_site_paper, 0x0041U));
    TEST_ASSERT_EQUAL_HEX32(0x0FFFU, elmopp_junction_served(&elmopp_site_paper, 0xFFFFU));
    TEST_ASSERT_EQUAL_HEX32(0U, elmopp_junction_served(&elmopp_site_paper, 0U));
}

static void test_served_reaches_the_last_movement_and_none_beyond_the_count(void) {
    elmopp_junction_t junction = {.movement_count = ELMOPP_MOVEMENT_MAX};
    for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
        junction.movement[j].groups = ((j % 2U) == 0U) ? 1U : 3U;
    }
    TEST_ASSERT_EQUAL_HEX32(0x555555U, elmopp_junction_served(&junction, 1U));
    TEST_ASSERT_EQUAL_HEX32(0xFFFFFFU, elmopp_junction_served(&junction, 3U));
    junction.movement_count = ELMOPP_MOVEMENT_MAX - 1U;
    TEST_ASSERT_EQUAL_HEX32(0x7FFFFFU, elmopp_junction_served(&junction, 3U));
}

static void test_nodes_and_their_groups_are_those_of_the_site(void) {
    elmopp_junction_t junction = test_cross(4U);
    junction.group[1].node = 7U;
    junction.group[3].node = 7U;
    junction.group[5].node = 3U; /* no group of the site */
    TEST_ASSERT_EQUAL_HEX8(0x81U, elmopp_junction_nodes(&junction));
    TEST_ASSERT_EQUAL_HEX16(0x5U, elmopp_junction_groups_of_node(&junction, 0U));
    TEST_ASSERT_EQUAL_HEX16(0xAU, elmopp_junction_groups_of_node(&junction, 7U));
    TEST_ASSERT_EQUAL_HEX16(0U, elmopp_junction_groups_of_node(&junction, 3U));
}

/* Every time of a change is in it, whichever group or pair has it: one after the other is made the longest by far. */
static void test_a_change_holds_every_time_of_every_group_and_pair(void) {
    const uint16_t long_ds = 900U;
    for (uint32_t g = 0U; g < 4U; g++) {
        elmopp_junction_t junction = test_cross(4U);
        const uint32_t others_ds = CROSS_MIN_GREEN_DS + CROSS_INTERGREEN_DS + 2U;
        TEST_ASSERT_EQUAL_UINT32(others_ds, elmopp_junction_change_ds(&junction));
        junction.group[g].min_green_ds = long_ds;
        TEST_ASSERT_EQUAL_UINT32(long_ds + CROSS_INTERGREEN_DS + 2U, elmopp_junction_change_ds(&junction));
        junction = test_cross(4U);
        junction.group[g].amber_ds = long_ds;
        TEST_ASSERT_EQUAL_UINT32(CROSS_MIN_GREEN_DS + long_ds + CROSS_RED_AMBER_DS + 2U,
                                 elmopp_junction_change_ds(&junction));
        for (uint32_t h = 0U; h < 4U; h++) {
            junction = test_cross(4U);
            junction.intergreen_ds[g][h] = long_ds;
            TEST_ASSERT_EQUAL_UINT32(CROSS_MIN_GREEN_DS + long_ds + 2U, elmopp_junction_change_ds(&junction));
        }
    }
}

static void test_a_change_holds_the_wait_for_an_occupied_junction(void) {
    elmopp_junction_t junction = test_cross(4U);
    for (uint16_t wait_ds = 0U; wait_ds <= 100U; wait_ds++) {
        junction.junction_wait_ds = wait_ds;
        TEST_ASSERT_EQUAL_UINT32(CROSS_MIN_GREEN_DS + CROSS_INTERGREEN_DS + wait_ds + 2U,
                                 elmopp_junction_change_ds(&junction));
    }
}

/* It conflicts with nobody, so that no intergreen holds its red-amber. */
static void test_a_change_holds_the_red_amber_of_a_group_without_conflicts(void) {
    elmopp_junction_t junction = test_cross(1U);
    junction.group[0].red_amber_ds = 700U;
    TEST_ASSERT_EQUAL_UINT32(CROSS_MIN_GREEN_DS + CROSS_AMBER_DS + 700U + 2U, elmopp_junction_change_ds(&junction));
}

static void test_a_change_takes_what_ends_and_what_starts(void) {
    elmopp_junction_t junction = test_cross(3U);
    junction.group[0].amber_ds = 31U;
    junction.group[2].red_amber_ds = 12U;
    junction.movement[2].startup_ds = 17U;
    TEST_ASSERT_EQUAL_UINT32(CROSS_INTERGREEN_DS, elmopp_junction_clearing_ds(&junction, 0x1U, 0x2U));
    junction.intergreen_ds[0][1] = 70U;
    TEST_ASSERT_EQUAL_UINT32(70U, elmopp_junction_clearing_ds(&junction, 0x1U, 0x2U));
    TEST_ASSERT_EQUAL_UINT32(CROSS_INTERGREEN_DS, elmopp_junction_clearing_ds(&junction, 0x2U, 0x1U));
    TEST_ASSERT_EQUAL_UINT32(31U, elmopp_junction_clearing_ds(&junction, 0x1U, 0U));   /* nobody starts */
    TEST_ASSERT_EQUAL_UINT32(12U, elmopp_junction_clearing_ds(&junction, 0x1U, 0x5U)); /* nobody ends */
    TEST_ASSERT_EQUAL_UINT32(0U, elmopp_junction_clearing_ds(&junction, 0x3U, 0x3U));
    TEST_ASSERT_EQUAL_UINT32(17U, elmopp_junction_starting_ds(&junction, 0x3U, 0x4U));
    TEST_ASSERT_EQUAL_UINT32(20U, elmopp_junction_starting_ds(&junction, 0x4U, 0x6U)); /* the third goes on */
    TEST_ASSERT_EQUAL_UINT32(0U, elmopp_junction_starting_ds(&junction, 0x7U, 0x1U));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_load_is_the_papers_hadamard_quotient);
    RUN_TEST(test_load_without_capacity_is_zero_whatever_waits);
    RUN_TEST(test_load_of_a_small_capacity_is_a_quotient_too);
    RUN_TEST(test_load_is_not_capped_at_a_full_lane);
    RUN_TEST(test_greenshields_golden_values);
    RUN_TEST(test_nolock_golden_values);
    RUN_TEST(test_nolock_differs_only_above_half_a_load);
    RUN_TEST(test_saturation_flow_is_the_movements_own);
    RUN_TEST(test_no_law_lets_more_leave_than_there_are);
    RUN_TEST(test_no_law_lets_vehicles_come_back_out_of_an_overfull_lane);
    RUN_TEST(test_a_movement_goes_when_all_of_its_groups_are_green);
    RUN_TEST(test_served_is_the_mask_of_the_movements_that_go);
    RUN_TEST(test_served_reaches_the_last_movement_and_none_beyond_the_count);
    RUN_TEST(test_nodes_and_their_groups_are_those_of_the_site);
    RUN_TEST(test_a_change_holds_every_time_of_every_group_and_pair);
    RUN_TEST(test_a_change_holds_the_wait_for_an_occupied_junction);
    RUN_TEST(test_a_change_holds_the_red_amber_of_a_group_without_conflicts);
    RUN_TEST(test_a_change_takes_what_ends_and_what_starts);
    return UNITY_END();
}
