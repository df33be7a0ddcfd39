/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "assert_catcher.h"
#include "elmopp/age.h"
#include "elmopp/priced.h"
#include "random.h"
#include "sites.h"
#include "unity.h"
#include "view.h"

#include <math.h>

#ifndef DECISIONS
#define DECISIONS 200000U
#endif

#define MIN_S 5U
#define MAX_S 60U
#define OLD_DS 600U /* of red: a vehicle counts 1, as on green */

/* Stages of one movement each: saturation flow 0.5, capacity 10, start-up 2 s, intergreen 5.5 s. A change there and
   back costs 2 (5.5 + 2 - 1) = 13 s. */
static elmopp_junction_t junction;
static elmopp_priced_t priced;
static elmopp_chooser_t chooser;
static test_view_t seen;

static void start(void) {
    chooser = elmopp_priced_init(&priced, MIN_S, MAX_S);
    test_view_init(&seen, &junction);
    for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
        seen.red_ds[j] = OLD_DS;
    }
}

void setUp(void) {
    junction = test_cross(3U);
    start();
}
void tearDown(void) {}

static void set_queues(float first, float second, float third) {
    seen.queue_veh[0] = first;
    seen.queue_veh[1] = second;
    seen.queue_veh[2] = third;
}

static elmopp_stage_t ask_in(elmopp_stage_t stage, uint32_t elapsed_ds) {
    test_view_show(&seen, stage, elapsed_ds);
    return test_view_ask(&seen, &chooser);
}

static void test_the_age_is_the_papers_exponential(void) {
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, expf(-1.0F), elmopp_age_factor(0U, 60U));
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 1.0F, elmopp_age_factor(600U, 60U));
    TEST_ASSERT_FLOAT_WITHIN(1.0e-5F, expf(0.5F), elmopp_age_factor(900U, 60U));
    TEST_ASSERT_TRUE(isfinite(elmopp_age_factor(UINT16_MAX, 1U)));
    TEST_EXPECT_ASSERT((void)elmopp_age_factor(0U, 0U));
}

static void test_a_price_is_intergreen_and_startup_less_the_amber_that_is_driven(void) {
    (void)ask_in(0U, 100U);
    TEST_ASSERT_EQUAL_FLOAT(6.5F, priced.price_s[0][1]);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, priced.price_s[1][1]);
    junction.group[0].amber_ds = 4U;
    junction.intergreen_ds[0][2] = 91U;
    junction.movement[2].startup_ds = 15U;
    start();
    (void)ask_in(0U, 100U);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 9.1F + 1.5F - 0.4F, priced.price_s[0][2]);
}

static void test_what_changes_for_nothing_costs_nothing(void) {
    junction = elmopp_site_paper; /* no amber, no intergreen: the start-up alone, and none where nothing new goes */
    junction.stage_groups[1] = (uint16_t)(junction.stage_groups[0] & (uint32_t)(junction.stage_groups[0] - 1U));
    start();
    (void)ask_in(0U, 100U);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, priced.price_s[0][1]);
    TEST_ASSERT_EQUAL_FLOAT(1.5F, priced.price_s[0][2]);
}

static void test_a_lead_is_the_difference_of_two_rates(void) {
    set_queues(1.0F, 10.0F, 4.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 100U));
    TEST_ASSERT_EQUAL_FLOAT(0.0F, seen.score[0]);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, (1.0F / 33.0F) - 0.025F, seen.score[1]); /* 1 of load in 20 s; 0.1 in 4 s */
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, (0.4F / 21.0F) - 0.025F, seen.score[2]);
}

static void test_a_queue_that_leaves_is_not_left(void) {
    set_queues(4.0F, 10.0F, 10.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 100U));
    set_queues(1.3F, 10.0F, 10.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 100U));
    set_queues(1.2F, 10.0F, 10.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 100U));
}

static void test_the_longer_the_change_the_less_it_is_worth(void) {
    set_queues(1.0F, 10.0F, 0.0F);
    junction.intergreen_ds[0][1] = 90U; /* 2 (9 + 2 - 1) = 20 s: a load of 1 in 40 s is no more than 0.025 */
    start();
    set_queues(1.0F, 10.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 100U));
}

static void test_who_has_waited_longer_counts_more(void) {
    set_queues(4.0F, 10.0F, 10.0F);
    seen.red_ds[2] = 1200U;
    TEST_ASSERT_EQUAL_UINT8(2U, ask_in(0U, 100U));
    seen.red_ds[2] = 0U;
    seen.red_ds[1] = 0U;
    set_queues(0.5F, 10.0F, 10.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 100U));
}

static void test_what_goes_in_both_is_on_neither_side(void) {
    junction.stage_groups[1] = 0x0003U; /* the first movement goes on */
    start();
    set_queues(9.0F, 2.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 100U));
    TEST_ASSERT_TRUE(seen.score[1] > 0.0F);
}

static void test_a_stage_is_left_within_its_window_only(void) {
    set_queues(0.0F, 10.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 49U));
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 50U));
    set_queues(10.0F, 1.0F, 2.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 599U));
    TEST_ASSERT_EQUAL_UINT8(2U, ask_in(0U, 600U));
    set_queues(10.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 900U));
}

static void test_before_the_first_stage_and_in_the_intergreen(void) {
    set_queues(1.0F, 3.0F, 2.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, test_view_ask(&seen, &chooser));
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 0.3F, seen.score[1]);
    test_view_clear_to(&seen, 2U);
    TEST_ASSERT_EQUAL_UINT8(2U, test_view_ask(&seen, &chooser));
    TEST_ASSERT_EQUAL_FLOAT(0.0F, seen.score[1]);
}

static void test_among_equals_the_lowest_index_wins(void) {
    set_queues(0.0F, 10.0F, 10.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 100U));
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(2U, 700U));
    set_queues(5.0F, 5.0F, 5.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(2U, 700U));
}

static void test_a_movement_without_room_has_no_urgency(void) {
    junction.movement[1].capacity_veh = 0.0F;
    start();
    set_queues(0.0F, 10.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 100U));
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 600U)); /* but somebody is there */
}

static void random_times(uint64_t *random) {
    for (uint32_t g = 0U; g < junction.group_count; g++) {
        junction.group[g].amber_ds = random_between(random, 0U, 600U);
        for (uint32_t h = 0U; h < junction.group_count; h++) {
            junction.intergreen_ds[g][h] = random_between(random, 0U, 6000U);
        }
    }
    for (uint32_t j = 0U; j < junction.movement_count; j++) {
        junction.movement[j].startup_ds = random_between(random, 0U, 600U);
        junction.movement[j].groups = random_between(random, 0U, (1U << junction.group_count) - 1U);
        junction.movement[j].capacity_veh = (float)random_below(random, 400U);
        junction.movement[j].saturation_veh_per_s = (float)random_below(random, 300U) / 100.0F;
    }
    for (uint32_t s = 0U; s < ELMOPP_STAGE_MAX; s++) {
        junction.stage_groups[s] = random_between(random, 0U, (1U << junction.group_count) - 1U);
    }
    junction.stage_count = (uint8_t)random_between(random, 1U, ELMOPP_STAGE_MAX);
    junction.discharge = (uint8_t)random_below(random, 3U);
    junction.free_flow_m_per_s = 10.0F;
}

static void see_anything(uint64_t *random) {
    test_view_show_any(&seen, random);
    for (uint32_t j = 0U; j < junction.movement_count; j++) {
        seen.queue_veh[j] = test_view_any_count(random);
        seen.red_ds[j] = random_between(random, 0U, (random_below(random, 4U) == 0U) ? UINT16_MAX : 1200U);
    }
}

static void test_whatever_is_seen_it_names_a_stage_and_finite_scores_and_again(void) {
    static elmopp_priced_t other;
    for (uint64_t seed = 0U; seed < 50U; seed++) {
        uint64_t random = seed;
        junction = test_cross(random_between(&random, 1U, 16U));
        random_times(&random);
        const uint16_t min_s = random_between(&random, 1U, 60U);
        start();
        chooser = elmopp_priced_init(&priced, min_s, random_between(&random, min_s, 600U));
        const elmopp_chooser_t again = elmopp_priced_init(&other, min_s, priced.max_s);
        for (uint32_t t = 0U; t < (DECISIONS / 50U); t++) {
            see_anything(&random);
            (void)test_view_ask_both(&seen, &chooser, &again); /* fails if there is no such stage */
            for (uint32_t s = 0U; s < ELMOPP_STAGE_MAX; s++) {
                TEST_ASSERT_TRUE(isfinite(seen.score[s]));
            }
        }
    }
}

static void test_a_window_that_makes_no_sense_is_a_bug(void) {
    TEST_EXPECT_ASSERT((void)elmopp_priced_init(&priced, 0U, 60U));
    TEST_EXPECT_ASSERT((void)elmopp_priced_init(&priced, 61U, 60U));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_age_is_the_papers_exponential);
    RUN_TEST(test_a_price_is_intergreen_and_startup_less_the_amber_that_is_driven);
    RUN_TEST(test_what_changes_for_nothing_costs_nothing);
    RUN_TEST(test_a_lead_is_the_difference_of_two_rates);
    RUN_TEST(test_a_queue_that_leaves_is_not_left);
    RUN_TEST(test_the_longer_the_change_the_less_it_is_worth);
    RUN_TEST(test_who_has_waited_longer_counts_more);
    RUN_TEST(test_what_goes_in_both_is_on_neither_side);
    RUN_TEST(test_a_stage_is_left_within_its_window_only);
    RUN_TEST(test_before_the_first_stage_and_in_the_intergreen);
    RUN_TEST(test_among_equals_the_lowest_index_wins);
    RUN_TEST(test_a_movement_without_room_has_no_urgency);
    RUN_TEST(test_whatever_is_seen_it_names_a_stage_and_finite_scores_and_again);
    RUN_TEST(test_a_window_that_makes_no_sense_is_a_bug);
    return UNITY_END();
}
