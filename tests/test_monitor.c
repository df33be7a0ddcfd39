/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The monitor: every rule broken, on both sides of its limit.

#include "elmopp/monitor.h"
#include "sites.h"
#include "unity.h"

#define GROUPS 3U
#define ALL 0x0007U

static elmopp_junction_t junction;
static elmopp_monitor_t monitor;
static elmopp_monitor_input_t input;
static bool measures_itself; ///< the lamps report what the last command was

void setUp(void) {
    junction = test_cross(GROUPS);
    elmopp_monitor_init(&monitor, &junction);
    input = (elmopp_monitor_input_t){.fresh = ALL, .mode = ELMOPP_MODE_AUTOMATIC};
    measures_itself = true;
}
void tearDown(void) {}

/* One letter a group: R, B (red and amber), G, A, . (dark), a and r (flashing), X (red and green), 2 (amber and green).
 */
static elmopp_lamps_t lamps_of(const char *text) {
    elmopp_lamps_t lamps = {0U, 0U, 0U, 0U};
    for (uint32_t g = 0U; text[g] != '\0'; g++) {
        const uint16_t own = (uint16_t)(1U << g);
        const char c = text[g];
        lamps.red |= ((c == 'R') || (c == 'B') || (c == 'r') || (c == 'X')) ? own : (uint16_t)0U;
        lamps.amber |= ((c == 'A') || (c == 'B') || (c == 'a') || (c == '2')) ? own : (uint16_t)0U;
        lamps.green |= ((c == 'G') || (c == 'X') || (c == '2')) ? own : (uint16_t)0U;
        lamps.flash |= ((c == 'a') || (c == 'r')) ? own : (uint16_t)0U;
    }
    return lamps;
}

static elmopp_fault_t show(const char *text) {
    input.command = lamps_of(text);
    input.measured = measures_itself ? monitor.last : input.measured;
    return elmopp_monitor_check(&monitor, &input);
}

static void good(const char *text, uint32_t ticks) {
    for (uint32_t i = 0U; i < ticks; i++) {
        TEST_ASSERT_EQUAL_STRING_MESSAGE("none", elmopp_fault_name(show(text)), text);
    }
}

static void bad(elmopp_fault_t fault, uint32_t group, const char *text) {
    TEST_ASSERT_EQUAL_STRING_MESSAGE(elmopp_fault_name(fault), elmopp_fault_name(show(text)), text);
    TEST_ASSERT_EQUAL_INT(fault, monitor.first);
    TEST_ASSERT_EQUAL_UINT8(group, monitor.first_group);
}

/* Group 0 is just turning green. */
static void prepare(uint32_t red_amber_ticks) {
    good("RRR", CROSS_INTERGREEN_DS);
    good("BRR", red_amber_ticks);
}

/* Group 0 has been green for its minimum. */
static void bring_up_green(void) {
    prepare(CROSS_RED_AMBER_DS);
    good("GRR", CROSS_MIN_GREEN_DS);
}

/* From group 0's green until group 1 may be tried: so many ticks after the end of the green. */
static void clear_for(uint32_t ticks) {
    good("ARR", CROSS_AMBER_DS);
    good("RRR", ticks - CROSS_AMBER_DS - CROSS_RED_AMBER_DS);
    good("RBR", CROSS_RED_AMBER_DS);
}

/* --- good lives --- */

static void test_a_whole_cycle_passes(void) {
    bring_up_green();
    for (uint32_t i = 0U; i < 3U; i++) {
        good("ARR", CROSS_AMBER_DS);
        good("RRR", CROSS_INTERGREEN_DS - CROSS_AMBER_DS - CROSS_RED_AMBER_DS);
        good("RBR", CROSS_RED_AMBER_DS);
        good("RGR", CROSS_MIN_GREEN_DS);
        good("RAR", CROSS_AMBER_DS);
        good("RRR", CROSS_INTERGREEN_DS - CROSS_AMBER_DS - CROSS_RED_AMBER_DS);
        good("BRR", CROSS_RED_AMBER_DS);
        good("GRR", 70000U);
    }
}

static void test_without_amber_and_red_amber_red_and_green_follow_each_other(void) {
    for (uint32_t g = 0U; g < GROUPS; g++) {
        junction.group[g].amber_ds = 0U;
        junction.group[g].red_amber_ds = 0U;
        for (uint32_t h = 0U; h < GROUPS; h++) {
            junction.intergreen_ds[g][h] = 0U;
        }
    }
    good("RRR", 1U);
    good("GRR", CROSS_MIN_GREEN_DS);
    good("RGR", CROSS_MIN_GREEN_DS);
    good("RAR", 1U);
    bad(ELMOPP_FAULT_SEQUENCE, 2U, "RRB");
}

static void test_compatible_groups_may_be_green_together(void) {
    junction.conflict[0] = 0x0002U;
    junction.conflict[2] = 0x0002U;
    good("RRR", CROSS_INTERGREEN_DS);
    good("BRB", CROSS_RED_AMBER_DS);
    good("GRG", CROSS_MIN_GREEN_DS);
}

/* --- conflict --- */

static void test_no_two_conflicting_groups_are_off_red(void) {
    static const char *const bads[] = {"GGR", "GAR", "GBR", "AGR", "AAR", "ABR", "BGR", "BAR", "BBR"};
    for (uint32_t i = 0U; i < (sizeof bads / sizeof bads[0]); i++) {
        setUp();
        good("RRR", CROSS_INTERGREEN_DS);
        bad(ELMOPP_FAULT_CONFLICT, 0U, bads[i]);
    }
}

/* --- intergreen --- */

static void try_green_after(uint32_t red_ticks, bool is_good) {
    setUp();
    bring_up_green();
    clear_for(red_ticks);
    if (is_good) {
        good("RGR", 1U);
    } else {
        bad(ELMOPP_FAULT_SHORT_INTERGREEN, 1U, "RGR");
    }
}

static void test_a_green_one_tick_before_its_intergreen_is_a_fault(void) {
    try_green_after(CROSS_INTERGREEN_DS, true);
    try_green_after(CROSS_INTERGREEN_DS - 1U, false);
}

static void test_intergreens_are_read_from_the_ending_to_the_starting_group(void) {
    const uint16_t longer_ds = CROSS_INTERGREEN_DS + 10U;
    setUp();
    junction.intergreen_ds[1][0] = longer_ds; /* the other way round: does not matter */
    bring_up_green();
    TEST_ASSERT_EQUAL_UINT16(longer_ds, junction.intergreen_ds[1][0]);
    clear_for(CROSS_INTERGREEN_DS);
    good("RGR", 1U);
    setUp();
    junction.intergreen_ds[0][1] = longer_ds;
    bring_up_green();
    clear_for(CROSS_INTERGREEN_DS);
    bad(ELMOPP_FAULT_SHORT_INTERGREEN, 1U, "RGR");
}

static void test_the_first_green_counts_its_intergreen_from_the_flashing_before(void) {
    good("RRR", CROSS_INTERGREEN_DS - CROSS_RED_AMBER_DS - 1U);
    good("BRR", CROSS_RED_AMBER_DS);
    bad(ELMOPP_FAULT_SHORT_INTERGREEN, 0U, "GRR");
}

/* --- times --- */

static void test_amber_one_tick_short_is_a_fault(void) {
    bring_up_green();
    good("ARR", CROSS_AMBER_DS - 1U);
    bad(ELMOPP_FAULT_SHORT_AMBER, 0U, "RRR");
}

static void test_no_amber_at_all_is_a_fault(void) {
    bring_up_green();
    bad(ELMOPP_FAULT_SHORT_AMBER, 0U, "RRR");
}

static void test_red_amber_one_tick_short_is_a_fault(void) {
    prepare(CROSS_RED_AMBER_DS - 1U);
    bad(ELMOPP_FAULT_SHORT_RED_AMBER, 0U, "GRR");
}

static void test_no_red_amber_at_all_is_a_fault(void) {
    good("RRR", CROSS_INTERGREEN_DS);
    bad(ELMOPP_FAULT_SHORT_RED_AMBER, 0U, "GRR");
}

static void test_green_one_tick_short_is_a_fault(void) {
    prepare(CROSS_RED_AMBER_DS);
    good("GRR", CROSS_MIN_GREEN_DS - 1U);
    bad(ELMOPP_FAULT_SHORT_GREEN, 0U, "ARR");
}

static void test_a_short_green_without_amber_is_a_fault_too(void) {
    junction.group[0].amber_ds = 0U;
    prepare(CROSS_RED_AMBER_DS);
    good("GRR", CROSS_MIN_GREEN_DS - 1U);
    bad(ELMOPP_FAULT_SHORT_GREEN, 0U, "RRR");
}

/* --- order and colours --- */

static void test_aspects_out_of_order_are_a_fault(void) {
    good("RRR", CROSS_INTERGREEN_DS);
    bad(ELMOPP_FAULT_SEQUENCE, 0U, "ARR");
    setUp();
    bring_up_green();
    bad(ELMOPP_FAULT_SEQUENCE, 0U, "BRR");
    setUp();
    bring_up_green();
    good("ARR", CROSS_AMBER_DS);
    bad(ELMOPP_FAULT_SEQUENCE, 0U, "GRR");
    setUp();
    bring_up_green();
    good("ARR", CROSS_AMBER_DS);
    bad(ELMOPP_FAULT_SEQUENCE, 0U, "BRR");
    setUp();
    prepare(CROSS_RED_AMBER_DS);
    bad(ELMOPP_FAULT_SEQUENCE, 0U, "RRR");
    setUp();
    prepare(CROSS_RED_AMBER_DS);
    bad(ELMOPP_FAULT_SEQUENCE, 0U, "ARR");
}

static void test_red_amber_in_a_site_without_is_out_of_order(void) {
    junction.group[0].red_amber_ds = 0U;
    good("RRR", CROSS_INTERGREEN_DS);
    bad(ELMOPP_FAULT_SEQUENCE, 0U, "BRR");
}

static void test_flashing_ends_in_red_only(void) {
    bad(ELMOPP_FAULT_SEQUENCE, 0U, "BRR");
    setUp();
    bad(ELMOPP_FAULT_SHORT_INTERGREEN, 0U, "GRR");
}

static void test_two_colours_darkness_and_flashing_are_faults_in_steady_modes(void) {
    static const elmopp_mode_t steady[] = {ELMOPP_MODE_START_RED,  ELMOPP_MODE_FIRST_STAGE, ELMOPP_MODE_AUTOMATIC,
                                           ELMOPP_MODE_FIXED_TIME, ELMOPP_MODE_MANUAL,      ELMOPP_MODE_ALL_RED};
    for (uint32_t i = 0U; i < 6U; i++) {
        setUp();
        input.mode = steady[i];
        good("RRR", 1U);
        bad(ELMOPP_FAULT_TWO_COLOURS, 1U, "RXR");
        setUp();
        input.mode = steady[i];
        good("RRR", 1U);
        bad(ELMOPP_FAULT_TWO_COLOURS, 2U, "RR2");
        setUp();
        input.mode = steady[i];
        good("RRR", 1U);
        bad(ELMOPP_FAULT_DARK, 1U, "R.R");
        setUp();
        input.mode = steady[i];
        good("RRR", 1U);
        bad(ELMOPP_FAULT_FLASHING, 2U, "RRa");
    }
}

static void test_a_lamp_of_no_group_is_a_fault_in_every_colour(void) {
    elmopp_lamps_t strange[4] = {lamps_of("RRR"), lamps_of("RRR"), lamps_of("RRR"), lamps_of("RRR")};
    strange[0].red |= 0x0008U;
    strange[1].amber |= 0x8000U;
    strange[2].green |= 0x0008U;
    strange[3].flash |= 0x0008U;
    for (uint32_t i = 0U; i < 4U; i++) {
        setUp();
        good("RRR", 1U);
        input.command = strange[i];
        input.measured = monitor.last;
        TEST_ASSERT_EQUAL_INT(ELMOPP_FAULT_UNKNOWN_GROUP, elmopp_monitor_check(&monitor, &input));
        TEST_ASSERT_EQUAL_UINT8(ELMOPP_FAULT_NO_GROUP, monitor.first_group);
    }
}

/* --- modes --- */

static void test_flashing_modes_want_what_the_site_says(void) {
    static const elmopp_mode_t flashing[] = {ELMOPP_MODE_STARTING,  ELMOPP_MODE_START_FLASH, ELMOPP_MODE_FLASHING,
                                             ELMOPP_MODE_FAIL_SAFE, ELMOPP_MODE_COUNT,       (elmopp_mode_t)200};
    for (uint32_t i = 0U; i < 6U; i++) {
        setUp();
        junction.group[1].flash = ELMOPP_FLASH_RED;
        junction.group[2].flash = ELMOPP_FLASH_DARK;
        elmopp_monitor_init(&monitor, &junction);
        input.mode = flashing[i];
        good("ar.", 100U);
        bad(ELMOPP_FAULT_FLASHING, 0U, "Rr.");
        setUp();
        input.mode = flashing[i];
        bad(ELMOPP_FAULT_FLASHING, 2U, "aaG");
    }
}

static void test_flashing_begins_from_red_darkness_or_flashing(void) {
    bring_up_green();
    input.mode = ELMOPP_MODE_FLASHING;
    bad(ELMOPP_FAULT_SEQUENCE, 0U, "aaa");
    setUp();
    good("RRR", 1U);
    input.mode = ELMOPP_MODE_FLASHING;
    good("aaa", 1U);
    input.mode = ELMOPP_MODE_DARK;
    good("...", 1U);
    input.mode = ELMOPP_MODE_STARTING;
    good("aaa", 1U);
}

static void test_in_mode_dark_nothing_burns(void) {
    good("RRR", 1U);
    input.mode = ELMOPP_MODE_DARK;
    good("...", 10U);
    bad(ELMOPP_FAULT_FLASHING, 1U, ".R.");
}

static void test_after_darkness_comes_red_with_running_intergreens(void) {
    good("RRR", CROSS_INTERGREEN_DS);
    input.mode = ELMOPP_MODE_DARK;
    good("...", 10U);
    input.mode = ELMOPP_MODE_AUTOMATIC;
    good("RRR", CROSS_INTERGREEN_DS - CROSS_RED_AMBER_DS - 1U);
    good("BRR", CROSS_RED_AMBER_DS);
    bad(ELMOPP_FAULT_SHORT_INTERGREEN, 0U, "GRR");
}

/* --- feedback --- */

static void test_feedback_may_differ_for_300_ms_and_no_longer(void) {
    good("RRR", 10U);
    measures_itself = false;
    input.measured = lamps_of("RGR");
    good("RRR", ELMOPP_MONITOR_FEEDBACK_DS);
    bad(ELMOPP_FAULT_FEEDBACK_DIFFERS, 1U, "RRR");
}

static void test_every_wrong_colour_and_a_dark_lamp_differ(void) {
    static const char *const wrong[] = {".RR", "ARR", "GRR", "XRR", "BRR"};
    for (uint32_t i = 0U; i < 5U; i++) {
        setUp();
        good("RRR", 10U);
        measures_itself = false;
        input.measured = lamps_of(wrong[i]);
        good("RRR", ELMOPP_MONITOR_FEEDBACK_DS);
        bad(ELMOPP_FAULT_FEEDBACK_DIFFERS, 0U, "RRR");
    }
}

static void test_the_time_counts_anew_from_a_change_of_the_group(void) {
    good("RRR", CROSS_INTERGREEN_DS);
    measures_itself = false;
    input.measured = lamps_of("ARR"); /* neither red nor red with amber */
    good("RRR", 2U);
    good("BRR", 1U);
    good("BRR", ELMOPP_MONITOR_FEEDBACK_DS);
    bad(ELMOPP_FAULT_FEEDBACK_DIFFERS, 0U, "BRR");
}

static void test_a_change_of_another_group_does_not_help(void) {
    good("RRR", CROSS_INTERGREEN_DS);
    measures_itself = false;
    input.measured = lamps_of("R.R");
    good("RRR", 2U);
    input.measured = lamps_of("R.R");
    good("BRR", 1U);
    bad(ELMOPP_FAULT_FEEDBACK_DIFFERS, 1U, "BRR");
}

static void test_an_agreement_in_between_starts_the_time_anew(void) {
    good("RRR", 10U);
    for (uint32_t i = 0U; i < 20U; i++) {
        measures_itself = false;
        input.measured = lamps_of("GRR");
        good("RRR", ELMOPP_MONITOR_FEEDBACK_DS);
        measures_itself = true;
        good("RRR", 1U);
    }
}

static void test_flashing_lamps_may_be_on_or_off_but_show_nothing_else(void) {
    input.mode = ELMOPP_MODE_FLASHING;
    measures_itself = false;
    for (uint32_t i = 0U; i < 50U; i++) {
        input.measured = lamps_of(((i % 10U) < 5U) ? "AAA" : "...");
        good("aaa", 1U);
    }
    input.measured = lamps_of("ARA");
    good("aaa", ELMOPP_MONITOR_FEEDBACK_DS);
    bad(ELMOPP_FAULT_FEEDBACK_DIFFERS, 1U, "aaa");
}

static void test_lost_feedback_is_a_fault_at_once_and_names_the_group(void) {
    good("RRR", 10U);
    input.fresh = ALL & ~0x0002U;
    bad(ELMOPP_FAULT_FEEDBACK_LOST, 1U, "RRR");
}

static void test_only_starting_does_without_feedback(void) {
    input.mode = ELMOPP_MODE_STARTING;
    input.fresh = 0U;
    measures_itself = false;
    input.measured = lamps_of("GGG");
    good("aaa", 1000U);
    input.mode = ELMOPP_MODE_START_FLASH;
    bad(ELMOPP_FAULT_FEEDBACK_LOST, 0U, "aaa");
}

/* --- the latch --- */

static void test_the_first_fault_latches_and_keeps_its_group(void) {
    good("RRR", CROSS_INTERGREEN_DS);
    bad(ELMOPP_FAULT_CONFLICT, 0U, "GGR");
    bad(ELMOPP_FAULT_CONFLICT, 0U, "RRR");
    bad(ELMOPP_FAULT_CONFLICT, 0U, "...");
    elmopp_monitor_init(&monitor, &junction);
    good("RRR", 10U);
}

static void test_of_two_faults_in_one_tick_the_lowest_group_is_named(void) {
    good("RRR", CROSS_INTERGREEN_DS);
    bad(ELMOPP_FAULT_DARK, 1U, "R.X");
}

/* --- edges --- */

static void test_a_new_monitor_has_seen_every_group_flash_as_its_site_says(void) {
    junction.group[1].flash = ELMOPP_FLASH_RED;
    junction.group[2].flash = ELMOPP_FLASH_DARK;
    elmopp_monitor_init(&monitor, &junction);
    TEST_ASSERT_EQUAL_HEX16(0x0002U, monitor.last.red);
    TEST_ASSERT_EQUAL_HEX16(0x0001U, monitor.last.amber);
    TEST_ASSERT_EQUAL_HEX16(0x0000U, monitor.last.green);
    TEST_ASSERT_EQUAL_HEX16(0x0003U, monitor.last.flash);
}

static void test_amber_and_red_amber_of_one_tick_must_be_shown(void) {
    junction.group[0].red_amber_ds = 1U;
    good("RRR", CROSS_INTERGREEN_DS);
    bad(ELMOPP_FAULT_SHORT_RED_AMBER, 0U, "GRR");
    setUp();
    bring_up_green();
    junction.group[0].amber_ds = 1U;
    bad(ELMOPP_FAULT_SHORT_AMBER, 0U, "RRR");
}

/* What a damaged site says of groups beyond its count is not looked at, and nothing is remembered of them. */
static void test_groups_that_do_not_exist_neither_conflict_nor_grow_old(void) {
    junction.conflict[0] |= (uint16_t)(1U << GROUPS);
    junction.intergreen_ds[GROUPS][0] = UINT16_MAX;
    bring_up_green();
    TEST_ASSERT_EQUAL_UINT16(0U, monitor.age_ds[GROUPS]);
    TEST_ASSERT_EQUAL_UINT16(0U, monitor.since_green_ds[GROUPS]);
}

static void test_times_saturate(void) {
    good("RRR", 2U);
    monitor.age_ds[0] = UINT16_MAX;
    monitor.since_green_ds[0] = UINT16_MAX;
    monitor.differs_ds[0] = UINT8_MAX;
    measures_itself = false;
    input.measured = lamps_of("GRR");
    bad(ELMOPP_FAULT_FEEDBACK_DIFFERS, 0U, "RRR");
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, monitor.age_ds[0]);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, monitor.since_green_ds[0]);
    TEST_ASSERT_EQUAL_UINT8(UINT8_MAX, monitor.differs_ds[0]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_whole_cycle_passes);
    RUN_TEST(test_without_amber_and_red_amber_red_and_green_follow_each_other);
    RUN_TEST(test_compatible_groups_may_be_green_together);
    RUN_TEST(test_no_two_conflicting_groups_are_off_red);
    RUN_TEST(test_a_green_one_tick_before_its_intergreen_is_a_fault);
    RUN_TEST(test_intergreens_are_read_from_the_ending_to_the_starting_group);
    RUN_TEST(test_the_first_green_counts_its_intergreen_from_the_flashing_before);
    RUN_TEST(test_amber_one_tick_short_is_a_fault);
    RUN_TEST(test_no_amber_at_all_is_a_fault);
    RUN_TEST(test_red_amber_one_tick_short_is_a_fault);
    RUN_TEST(test_no_red_amber_at_all_is_a_fault);
    RUN_TEST(test_green_one_tick_short_is_a_fault);
    RUN_TEST(test_a_short_green_without_amber_is_a_fault_too);
    RUN_TEST(test_aspects_out_of_order_are_a_fault);
    RUN_TEST(test_red_amber_in_a_site_without_is_out_of_order);
    RUN_TEST(test_flashing_ends_in_red_only);
    RUN_TEST(test_two_colours_darkness_and_flashing_are_faults_in_steady_modes);
    RUN_TEST(test_a_lamp_of_no_group_is_a_fault_in_every_colour);
    RUN_TEST(test_flashing_modes_want_what_the_site_says);
    RUN_TEST(test_flashing_begins_from_red_darkness_or_flashing);
    RUN_TEST(test_in_mode_dark_nothing_burns);
    RUN_TEST(test_after_darkness_comes_red_with_running_intergreens);
    RUN_TEST(test_feedback_may_differ_for_300_ms_and_no_longer);
    RUN_TEST(test_every_wrong_colour_and_a_dark_lamp_differ);
    RUN_TEST(test_the_time_counts_anew_from_a_change_of_the_group);
    RUN_TEST(test_a_change_of_another_group_does_not_help);
    RUN_TEST(test_an_agreement_in_between_starts_the_time_anew);
    RUN_TEST(test_flashing_lamps_may_be_on_or_off_but_show_nothing_else);
    RUN_TEST(test_lost_feedback_is_a_fault_at_once_and_names_the_group);
    RUN_TEST(test_only_starting_does_without_feedback);
    RUN_TEST(test_the_first_fault_latches_and_keeps_its_group);
    RUN_TEST(test_of_two_faults_in_one_tick_the_lowest_group_is_named);
    RUN_TEST(test_a_new_monitor_has_seen_every_group_flash_as_its_site_says);
    RUN_TEST(test_amber_and_red_amber_of_one_tick_must_be_shown);
    RUN_TEST(test_groups_that_do_not_exist_neither_conflict_nor_grow_old);
    RUN_TEST(test_times_saturate);
    return UNITY_END();
}
