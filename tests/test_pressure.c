/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/pressure.h"
#include "sites.h"
#include "unity.h"
#include "view.h"

#include <math.h>
#include <string.h>

#define STAGES 4U

/* Four stages of one movement each; saturation flow 1, so the pressure of a queue of at least 1 is the queue. */
static elmopp_junction_t junction;
static elmopp_pressure_t pressure;
static elmopp_chooser_t chooser;
static test_view_t seen;

void setUp(void) {
    junction = test_cross(STAGES);
    for (uint32_t j = 0U; j < STAGES; j++) {
        junction.movement[j].saturation_veh_per_s = 1.0F;
    }
    pressure = (elmopp_pressure_t){ELMOPP_PRESSURE_RATIO, ELMOPP_PRESSURE_MIN_S, ELMOPP_PRESSURE_MAX_S};
    chooser = elmopp_pressure_init(&pressure);
    test_view_init(&seen, &junction);
}
void tearDown(void) {}

static void set_queues(float first, float second, float third, float fourth) {
    const float queue_veh[STAGES] = {first, second, third, fourth};
    (void)memcpy(seen.queue_veh, queue_veh, sizeof queue_veh);
}

static elmopp_stage_t ask(void) {
    return test_view_ask(&seen, &chooser);
}

static elmopp_stage_t ask_in(elmopp_stage_t stage, uint32_t elapsed_ds) {
    test_view_show(&seen, stage, elapsed_ds);
    return ask();
}

static void test_the_parameters_are_those_of_the_specification(void) {
    TEST_ASSERT_EQUAL_FLOAT(3.0F, ELMOPP_PRESSURE_RATIO);
    TEST_ASSERT_EQUAL_UINT(5U, ELMOPP_PRESSURE_MIN_S);
    TEST_ASSERT_EQUAL_UINT(120U, ELMOPP_PRESSURE_MAX_S);
    TEST_ASSERT_EQUAL_UINT16(0U, chooser.horizon_s);
    TEST_ASSERT_EQUAL_PTR(&pressure, chooser.state);
}

/* Greenshields: Q = 200/3 leaves with 1.6, Q = 250 with 1.875. */
static void test_pressure_is_queue_times_flow_summed_over_the_stage(void) {
    test_view_init(&seen, &elmopp_site_paper);
    seen.queue_veh[0] = 200.0F / 3.0F;
    seen.queue_veh[6] = 250.0F;
    TEST_ASSERT_EQUAL_UINT8(0U, ask());
    TEST_ASSERT_FLOAT_WITHIN(1.0e-3F, (1.6F * 200.0F / 3.0F) + (1.875F * 250.0F), seen.score[0]);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, seen.score[1]);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-4F, 1.6F * 200.0F / 3.0F, seen.score[4]);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-3F, 1.875F * 250.0F, seen.score[6]);
}

static void test_a_queue_below_the_flow_presses_with_its_square(void) {
    set_queues(0.5F, 0.0F, 0.0F, 0.0F);
    (void)ask();
    TEST_ASSERT_EQUAL_FLOAT(0.25F, seen.score[0]);
}

static void test_stages_that_do_not_exist_score_zero(void) {
    set_queues(1.0F, 2.0F, 3.0F, 4.0F);
    junction.stage_groups[9] = 0x000FU;
    for (uint32_t count = 1U; count <= STAGES; count++) {
        junction.stage_count = (uint8_t)count;
        TEST_ASSERT_EQUAL_UINT8(count - 1U, ask());
        for (uint32_t s = 0U; s < ELMOPP_STAGE_MAX; s++) {
            TEST_ASSERT_EQUAL_FLOAT((s < count) ? (float)(s + 1U) : 0.0F, seen.score[s]);
        }
    }
}

static void test_the_first_decision_is_the_highest_pressure_at_once(void) {
    set_queues(1.0F, 3.0F, 2.0F, 3.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask());
    set_queues(0.0F, 0.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask());
}

static void test_in_the_intergreen_the_target_stays(void) {
    set_queues(1.0F, 9.0F, 2.0F, 3.0F);
    test_view_clear_to(&seen, 3U);
    TEST_ASSERT_EQUAL_UINT8(3U, ask());
}

static void test_a_stage_is_never_left_before_min(void) {
    set_queues(0.0F, 10.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 1U));
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 49U));
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 50U));
}

static void test_only_more_than_the_ratio_takes_over(void) {
    set_queues(0.0F, 2.0F, 6.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(1U, 300U));
    seen.queue_veh[2] = nextafterf(6.0F, 7.0F);
    TEST_ASSERT_EQUAL_UINT8(2U, ask_in(1U, 300U));
    seen.queue_veh[2] = 5.9F;
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(1U, 300U));
}

static void test_a_ratio_of_one_asks_for_strictly_more(void) {
    pressure.ratio = 1.0F;
    chooser = elmopp_pressure_init(&pressure);
    set_queues(4.0F, 4.0F, 4.0F, 4.0F);
    TEST_ASSERT_EQUAL_UINT8(2U, ask_in(2U, 300U));
    seen.queue_veh[3] = nextafterf(4.0F, 5.0F);
    TEST_ASSERT_EQUAL_UINT8(3U, ask_in(2U, 300U));
}

static void test_at_max_it_leaves_for_the_best_if_that_is_another(void) {
    set_queues(2.0F, 3.0F, 0.0F, 3.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 1199U));
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 1200U));
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, UINT16_MAX));
    set_queues(4.0F, 3.0F, 0.0F, 3.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 1200U));
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, UINT16_MAX));
}

static void test_among_equals_the_lowest_index_wins(void) {
    set_queues(1.0F, 9.0F, 9.0F, 9.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 300U));
    set_queues(9.0F, 9.0F, 9.0F, 9.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(3U, 1200U));
}

/* More vehicles than the capacity, as a camera may report, under each law. */
static void test_overfull_lanes_never_make_it_name_a_stage_that_does_not_exist(void) {
    junction = elmopp_site_paper;
    for (uint8_t law = ELMOPP_DISCHARGE_SATURATION; law <= ELMOPP_DISCHARGE_NOLOCK; law++) {
        junction.discharge = law;
        test_view_init(&seen, &junction);
        for (uint32_t j = 0U; j < 12U; j++) {
            seen.queue_veh[j] = 400.0F;
        }
        TEST_ASSERT_LESS_THAN_UINT8(8U, ask());
        TEST_ASSERT_LESS_THAN_UINT8(8U, ask_in(2U, 1200U));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_parameters_are_those_of_the_specification);
    RUN_TEST(test_pressure_is_queue_times_flow_summed_over_the_stage);
    RUN_TEST(test_a_queue_below_the_flow_presses_with_its_square);
    RUN_TEST(test_stages_that_do_not_exist_score_zero);
    RUN_TEST(test_the_first_decision_is_the_highest_pressure_at_once);
    RUN_TEST(test_in_the_intergreen_the_target_stays);
    RUN_TEST(test_a_stage_is_never_left_before_min);
    RUN_TEST(test_only_more_than_the_ratio_takes_over);
    RUN_TEST(test_a_ratio_of_one_asks_for_strictly_more);
    RUN_TEST(test_at_max_it_leaves_for_the_best_if_that_is_another);
    RUN_TEST(test_among_equals_the_lowest_index_wins);
    RUN_TEST(test_overfull_lanes_never_make_it_name_a_stage_that_does_not_exist);
    return UNITY_END();
}
