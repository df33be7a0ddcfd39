/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The detector: no vehicle lost, nobody believed who should not be.

#include "assert_catcher.h"
#include "elmopp/detector.h"
#include "random.h"
#include "sites.h"
#include "unity.h"

#define SECONDS_PER_MINUTE 60U

static elmopp_junction_t junction;
static elmopp_detector_t detector;
static elmopp_detector_report_t report[ELMOPP_APPROACH_MOVEMENT_MAX];
static uint16_t red_ds[ELMOPP_MOVEMENT_MAX];
static float present_veh[ELMOPP_MOVEMENT_MAX];
static float arrived_veh[ELMOPP_MOVEMENT_MAX];

void setUp(void) {
    junction = test_cross(4U);
    junction.approach_count = 2U;
    junction.movement[2].approach = 0U; /* approach 0 has movements 0 and 2, approach 1 has 1 and 3 */
    junction.movement[3].approach = 1U;
    elmopp_detector_init(&detector, &junction);
    for (uint32_t k = 0U; k < ELMOPP_APPROACH_MOVEMENT_MAX; k++) {
        report[k] = (elmopp_detector_report_t){.present_veh = 0U, .arrivals = 0U, .valid = true};
    }
    for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
        red_ds[j] = 0U;
    }
}
void tearDown(void) {}

static void take(void) {
    elmopp_detector_take(&detector, 0U, report, 0U);
}

static void second(void) {
    elmopp_detector_second(&detector);
    elmopp_detector_counts(&detector, red_ds, present_veh, arrived_veh);
}

static void good_seconds(uint32_t count) {
    for (uint32_t i = 0U; i < count; i++) {
        take();
        second();
    }
}

static bool is_trusted(uint32_t j) {
    return ((detector.trusted >> j) & 1U) != 0U;
}

/* --- trust --- */

static void test_nobody_is_trusted_at_first_and_after_five_good_seconds_those_who_report(void) {
    second();
    TEST_ASSERT_EQUAL_HEX32(0U, detector.trusted);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_REASON_STALE, detector.lane[0].reason);
    good_seconds(ELMOPP_DETECTOR_RECOVER_S - 1U);
    TEST_ASSERT_EQUAL_HEX32(0U, detector.trusted);
    good_seconds(1U);
    TEST_ASSERT_EQUAL_HEX32(0x5U, detector.trusted);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_REASON_OK, detector.lane[0].reason);
}

static void test_a_frame_is_stale_after_three_seconds(void) {
    good_seconds(10U);
    for (uint32_t i = 0U; i < ELMOPP_DETECTOR_STALE_S; i++) {
        second();
        TEST_ASSERT_TRUE(is_trusted(0U));
    }
    second();
    TEST_ASSERT_FALSE(is_trusted(0U));
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_REASON_STALE, detector.lane[0].reason);
    good_seconds(ELMOPP_DETECTOR_RECOVER_S - 1U);
    TEST_ASSERT_FALSE(is_trusted(0U));
    good_seconds(1U);
    TEST_ASSERT_TRUE(is_trusted(0U));
}

static void test_a_movement_marked_invalid_or_with_unknown_presence_is_not_believed(void) {
    good_seconds(10U);
    report[1].valid = false;
    elmopp_detector_take(&detector, 0U, report, 4U);
    second();
    TEST_ASSERT_TRUE(is_trusted(0U));
    TEST_ASSERT_FALSE(is_trusted(2U));
    TEST_ASSERT_EQUAL_UINT8(4U, detector.lane[2].reason);
    report[1].valid = true;
    good_seconds(10U);
    TEST_ASSERT_TRUE(is_trusted(2U));
    report[0].present_veh = ELMOPP_DETECTOR_UNKNOWN;
    good_seconds(1U);
    TEST_ASSERT_FALSE(is_trusted(0U));
    report[0].present_veh = ELMOPP_DETECTOR_UNKNOWN - 1U;
    good_seconds(ELMOPP_DETECTOR_RECOVER_S);
    TEST_ASSERT_TRUE(is_trusted(0U));
    TEST_ASSERT_EQUAL_FLOAT(510.0F, present_veh[0]);
}

static void test_reports_are_those_of_the_approachs_movements_in_site_order(void) {
    report[0].present_veh = 3U;
    report[1].present_veh = 7U;
    good_seconds(10U);
    TEST_ASSERT_EQUAL_FLOAT(3.0F, present_veh[0]);
    TEST_ASSERT_EQUAL_FLOAT(7.0F, present_veh[2]);
    TEST_ASSERT_FALSE(is_trusted(1U));
    TEST_ASSERT_FALSE(is_trusted(3U));
}

/* --- counting --- */

static void test_arrivals_run_round_without_losing_a_vehicle(void) {
    uint32_t total = 0U;
    float counted = 0.0F;
    good_seconds(10U);
    for (uint32_t i = 0U; i < 1000U; i++) {
        total += i % 5U;
        report[0].arrivals = (uint8_t)(total % ELMOPP_DETECTOR_MODULO);
        take();
        second();
        counted += arrived_veh[0];
    }
    TEST_ASSERT_EQUAL_FLOAT((float)total, counted);
}

static void test_lost_frames_lose_no_vehicle(void) {
    uint64_t seed = 7U;
    uint32_t total = 0U;
    float counted = 0.0F;
    good_seconds(10U);
    for (uint32_t i = 0U; i < 20000U; i++) {
        total += random_below(&seed, 3U);
        report[0].arrivals = (uint8_t)(total % ELMOPP_DETECTOR_MODULO);
        if ((detector.lane[0].age_s >= ELMOPP_DETECTOR_STALE_S) || (random_below(&seed, 3U) != 0U)) {
            take();
        }
        second();
        counted += arrived_veh[0];
    }
    take();
    second();
    TEST_ASSERT_EQUAL_FLOAT((float)total, counted + arrived_veh[0]);
}

/* Trusted, then silent for so many seconds, then 20 vehicles further. */
static uint16_t counted_after(uint32_t silent_s) {
    setUp();
    good_seconds(10U);
    for (uint32_t i = 0U; i < silent_s; i++) {
        second();
    }
    report[0].arrivals = 20U;
    take();
    return detector.lane[0].arrived_veh;
}

static void test_after_a_long_gap_the_counter_is_taken_up_anew(void) {
    TEST_ASSERT_EQUAL_UINT16(20U, counted_after(ELMOPP_DETECTOR_GAP_S - 1U));
    TEST_ASSERT_EQUAL_UINT16(0U, counted_after(ELMOPP_DETECTOR_GAP_S));
}

static void test_a_jump_that_no_lane_makes_is_erratic_and_counts_nothing(void) {
    good_seconds(10U);
    report[0].arrivals = 2U * ELMOPP_DETECTOR_RATE_VEH; /* a frame a second: age 1 when it comes */
    take();
    second();
    TEST_ASSERT_EQUAL_FLOAT(8.0F, arrived_veh[0]);
    TEST_ASSERT_TRUE(is_trusted(0U));
    report[0].arrivals = (uint8_t)(report[0].arrivals + (2U * ELMOPP_DETECTOR_RATE_VEH) + 1U);
    take();
    second();
    TEST_ASSERT_FALSE(is_trusted(0U));
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_REASON_ERRATIC, detector.lane[0].reason);
    report[0].arrivals++;
    take();
    TEST_ASSERT_EQUAL_UINT16(1U, detector.lane[0].arrived_veh);
}

static void test_two_lanes_bring_twice_as_many(void) {
    junction.movement[0].lanes = 2U;
    good_seconds(10U);
    report[0].arrivals = 4U * ELMOPP_DETECTOR_RATE_VEH;
    good_seconds(1U);
    TEST_ASSERT_TRUE(is_trusted(0U));
}

static void test_a_flood_of_frames_overflows_nothing(void) {
    good_seconds(10U);
    for (uint32_t i = 0U; i < 200000U; i++) {
        report[0].arrivals = (uint8_t)((report[0].arrivals + 3U) % ELMOPP_DETECTOR_MODULO);
        take();
    }
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, detector.lane[0].arrived_veh);
    second();
    TEST_ASSERT_EQUAL_FLOAT(65535.0F, arrived_veh[0]);
}

/* --- the three diagnoses --- */

static void test_no_activity_is_found_in_its_minute_and_gone_with_a_vehicle(void) {
    junction.no_activity_min = 2U;
    good_seconds((2U * SECONDS_PER_MINUTE) - 1U);
    TEST_ASSERT_TRUE(is_trusted(0U));
    good_seconds(1U);
    TEST_ASSERT_FALSE(is_trusted(0U));
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_REASON_NO_ACTIVITY, detector.lane[0].reason);
    report[0].arrivals++;
    good_seconds(ELMOPP_DETECTOR_RECOVER_S - 1U);
    TEST_ASSERT_FALSE(is_trusted(0U));
    good_seconds(1U);
    TEST_ASSERT_TRUE(is_trusted(0U));
}

static void test_maximum_presence_is_found_in_its_minute_and_gone_with_a_gap(void) {
    junction.max_presence_min = 1U;
    report[0].present_veh = 1U;
    good_seconds(SECONDS_PER_MINUTE - 1U);
    TEST_ASSERT_TRUE(is_trusted(0U));
    good_seconds(1U);
    TEST_ASSERT_FALSE(is_trusted(0U));
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_REASON_MAX_PRESENCE, detector.lane[0].reason);
    report[0].present_veh = 0U;
    good_seconds(ELMOPP_DETECTOR_RECOVER_S);
    TEST_ASSERT_TRUE(is_trusted(0U));
}

static void test_erratic_counts_are_found_in_the_minute_and_gone_after_a_calm_one(void) {
    junction.erratic_per_min = 30U;
    good_seconds(SECONDS_PER_MINUTE);
    for (uint32_t i = 0U; i < 30U; i++) {
        report[0].arrivals = (uint8_t)((report[0].arrivals + 1U) % ELMOPP_DETECTOR_MODULO);
        good_seconds(1U);
        TEST_ASSERT_TRUE(is_trusted(0U));
    }
    report[0].arrivals = (uint8_t)((report[0].arrivals + 1U) % ELMOPP_DETECTOR_MODULO);
    good_seconds(1U);
    TEST_ASSERT_FALSE(is_trusted(0U));
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_REASON_ERRATIC, detector.lane[0].reason);
    good_seconds(29U + SECONDS_PER_MINUTE - 1U);
    TEST_ASSERT_FALSE(is_trusted(0U));
    good_seconds(1U + ELMOPP_DETECTOR_RECOVER_S);
    TEST_ASSERT_TRUE(is_trusted(0U));
}

static void test_a_limit_of_zero_finds_nothing(void) {
    report[0].present_veh = 400U;
    for (uint32_t i = 0U; i < 70000U; i++) {
        report[0].arrivals = (uint8_t)((report[0].arrivals + ((i < 35000U) ? 0U : 3U)) % ELMOPP_DETECTOR_MODULO);
        good_seconds(1U);
        TEST_ASSERT_TRUE((i < ELMOPP_DETECTOR_RECOVER_S) || is_trusted(0U));
    }
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, detector.lane[0].busy_s);
}

/* --- recall --- */

static void test_an_untrusted_movement_has_its_average_and_at_least_one_vehicle(void) {
    for (uint32_t i = 0U; i < 400U; i++) { /* a vehicle every other second */
        report[0].arrivals = (uint8_t)((report[0].arrivals + (i % 2U)) % ELMOPP_DETECTOR_MODULO);
        good_seconds(1U);
    }
    report[0].valid = false;
    red_ds[0] = 100U;
    good_seconds(1U);
    TEST_ASSERT_FLOAT_WITHIN(0.02F, 0.5F, arrived_veh[0]);
    TEST_ASSERT_FLOAT_WITHIN(0.2F, 5.0F, present_veh[0]);
    red_ds[0] = 0U;
    second();
    TEST_ASSERT_EQUAL_FLOAT(1.0F, present_veh[0]);
    red_ds[0] = UINT16_MAX;
    second();
    TEST_ASSERT_EQUAL_FLOAT(junction.movement[0].capacity_veh, present_veh[0]);
}

static void test_a_movement_that_nobody_ever_saw_has_one_vehicle_and_no_arrivals(void) {
    red_ds[1] = 5000U;
    second();
    TEST_ASSERT_EQUAL_FLOAT(1.0F, present_veh[1]);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, arrived_veh[1]);
}

/* --- beyond every site --- */

static void test_a_movement_beyond_those_that_a_frame_carries_hears_nothing(void) {
    junction.approach_count = 1U;
    junction.movement[1].approach = 0U;
    junction.movement[3].approach = 0U;
    good_seconds(ELMOPP_DETECTOR_RECOVER_S);
    TEST_ASSERT_EQUAL_HEX32(0x7U, detector.trusted);
}

static void test_a_mean_goes_on_when_its_seconds_no_longer_count(void) {
    good_seconds(ELMOPP_DETECTOR_RECOVER_S);
    detector.lane[0].seen_s = UINT32_MAX;
    detector.lane[0].mean_veh_per_s = 0.5F;
    good_seconds(1U);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, detector.lane[0].seen_s);
    TEST_ASSERT_FLOAT_WITHIN(0.01F, 0.5F, detector.lane[0].mean_veh_per_s);
}

static void test_a_reason_that_the_bus_does_not_know_is_a_mistake_of_the_caller(void) {
    TEST_EXPECT_ASSERT(elmopp_detector_take(&detector, 0U, report, (uint8_t)ELMOPP_REASON_COUNT));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_nobody_is_trusted_at_first_and_after_five_good_seconds_those_who_report);
    RUN_TEST(test_a_frame_is_stale_after_three_seconds);
    RUN_TEST(test_a_movement_marked_invalid_or_with_unknown_presence_is_not_believed);
    RUN_TEST(test_reports_are_those_of_the_approachs_movements_in_site_order);
    RUN_TEST(test_arrivals_run_round_without_losing_a_vehicle);
    RUN_TEST(test_lost_frames_lose_no_vehicle);
    RUN_TEST(test_after_a_long_gap_the_counter_is_taken_up_anew);
    RUN_TEST(test_a_jump_that_no_lane_makes_is_erratic_and_counts_nothing);
    RUN_TEST(test_two_lanes_bring_twice_as_many);
    RUN_TEST(test_a_flood_of_frames_overflows_nothing);
    RUN_TEST(test_no_activity_is_found_in_its_minute_and_gone_with_a_vehicle);
    RUN_TEST(test_maximum_presence_is_found_in_its_minute_and_gone_with_a_gap);
    RUN_TEST(test_erratic_counts_are_found_in_the_minute_and_gone_after_a_calm_one);
    RUN_TEST(test_a_limit_of_zero_finds_nothing);
    RUN_TEST(test_an_untrusted_movement_has_its_average_and_at_least_one_vehicle);
    RUN_TEST(test_a_movement_that_nobody_ever_saw_has_one_vehicle_and_no_arrivals);
    RUN_TEST(test_a_movement_beyond_those_that_a_frame_carries_hears_nothing);
    RUN_TEST(test_a_mean_goes_on_when_its_seconds_no_longer_count);
    RUN_TEST(test_a_reason_that_the_bus_does_not_know_is_a_mistake_of_the_caller);
    return UNITY_END();
}
