/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The controller on a bench: modes, faults, commands, clock. Everything it shows is also judged by the bench's own
/// eyes.

#include "assert_catcher.h"
#include "bench.h"
#include "elmopp_can.h"
#include "sites.h"
#include "unity.h"

#include <string.h>

#define GROUPS 4U
#define START_LIMIT 400U

static bench_t bench;

void setUp(void) {
    const elmopp_junction_t junction = bench_cross(GROUPS);
    bench_start(&bench, &junction);
}
void tearDown(void) {
    bench_expect_good_street(&bench);
}

static void expect_mode(elmopp_mode_t mode, uint32_t limit) {
    TEST_ASSERT_TRUE_MESSAGE(bench_until(&bench, mode, limit), "the mode does not come");
}

static void start(void) {
    bench_fill(&bench);
    expect_mode(ELMOPP_MODE_AUTOMATIC, START_LIMIT);
}

static void expect_fault(elmopp_fault_t fault, uint32_t group) {
    TEST_ASSERT_EQUAL_STRING(elmopp_fault_name(fault), elmopp_fault_name(bench.controller.fault));
    TEST_ASSERT_EQUAL_UINT8(group, bench.controller.fault_group);
    TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_FAIL_SAFE, bench.controller.mode);
    TEST_ASSERT_EQUAL_HEX16(0x000FU, bench.shown.amber);
    TEST_ASSERT_EQUAL_HEX16(0x000FU, bench.shown.flash);
    TEST_ASSERT_EQUAL_HEX16(0U, bench.shown.green | bench.shown.red);
    TEST_ASSERT_EQUAL_INT(fault, bench.status.fault);
    TEST_ASSERT_EQUAL_UINT8(group, bench.status.fault_group);
}

/* --- the start --- */

static void test_a_start_flashes_then_shows_red_then_its_first_stage(void) {
    bench.junction.first_stage = 2U;
    bench_start(&bench, &bench.junction);
    bench_fill(&bench);
    expect_mode(ELMOPP_MODE_START_FLASH, 12U);
    TEST_ASSERT_EQUAL_HEX16(0x000FU, bench.shown.flash);
    bench_ticks(&bench, 19U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_START_FLASH, bench.controller.mode);
    bench_ticks(&bench, 1U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_START_RED, bench.controller.mode);
    TEST_ASSERT_EQUAL_HEX16(0x000FU, bench.shown.red);
    bench_ticks(&bench, 10U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_FIRST_STAGE, bench.controller.mode);
    expect_mode(ELMOPP_MODE_AUTOMATIC, 60U);
    TEST_ASSERT_EQUAL_HEX16(0x0004U, bench.shown.green);
    TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_AUTOMATIC, bench.status.mode);
}

static void test_without_lamps_that_read_back_there_is_no_start(void) {
    bench.nodes_silent = 0x01U;
    bench_ticks(&bench, ELMOPP_CONTROLLER_SELF_TEST_DS - 2U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_STARTING, bench.controller.mode);
    bench_ticks(&bench, 3U);
    expect_fault(ELMOPP_FAULT_SELF_TEST, 0U);
}

static void test_a_lamp_that_burns_by_itself_fails_the_self_test(void) {
    bench.stuck_on.green = 0x0002U;
    bench_ticks(&bench, ELMOPP_CONTROLLER_SELF_TEST_DS + 2U);
    expect_fault(ELMOPP_FAULT_SELF_TEST, 0U);
}

static void test_a_node_that_is_late_to_wake_up_is_waited_for(void) {
    bench.nodes_silent = 0x01U;
    bench_ticks(&bench, 200U);
    bench.nodes_silent = 0U;
    start();
}

static void test_what_the_port_finds_at_the_start_is_a_fault(void) {
    elmopp_controller_report(&bench.controller, ELMOPP_FAULT_MEMORY);
    bench_ticks(&bench, 1U);
    expect_fault(ELMOPP_FAULT_MEMORY, 0U);
}

static void test_a_site_that_is_none_is_refused_before_any_lamp_burns(void) {
    static bench_t broken;
    broken = bench;
    broken.junction.intergreen_ds[0][1] = 10U;
    const elmopp_controller_config_t config = {.junction = &broken.junction, .chooser = bench.chooser};
    TEST_EXPECT_ASSERT(elmopp_controller_init(&broken.controller, &config));
}

static void test_a_power_cut_in_any_mode_begins_at_starting(void) {
    for (uint32_t cut = 1U; cut < 600U; cut += 7U) {
        setUp();
        bench_fill(&bench);
        bench_ticks(&bench, cut);
        bench_power_cut(&bench);
        TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_STARTING, bench.controller.mode);
        bench_ticks(&bench, 1U);
        TEST_ASSERT_EQUAL_HEX16(0U, bench.shown.green);
        expect_mode(ELMOPP_MODE_AUTOMATIC, START_LIMIT);
        bench_expect_good_street(&bench);
    }
}

/* --- cameras --- */

static void test_a_blind_camera_puts_its_movement_on_recall_and_back(void) {
    start();
    bench.present_veh[1] = 0U;
    bench.cameras_blind = 0x02U;
    bench_ticks(&bench, 30U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_AUTOMATIC, bench.controller.mode);
    TEST_ASSERT_EQUAL_HEX32(0x0DU, bench.controller.detector.trusted);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, bench.controller.present_veh[1]);
    bench.cameras_blind = 0U;
    bench_ticks(&bench, 60U);
    TEST_ASSERT_EQUAL_HEX32(0x0FU, bench.controller.detector.trusted);
}

static void test_without_any_camera_the_programme_runs_and_without_faults_automatic_comes_back(void) {
    start();
    bench.answer = 0U; /* the chooser would stay */
    bench.cameras_silent = 0x0FU;
    expect_mode(ELMOPP_MODE_FIXED_TIME, 50U);
    uint32_t shown = 0U;
    for (uint32_t i = 0U; i < 1200U; i++) {
        bench_tick(&bench);
        shown |= bench.shown.green;
    }
    TEST_ASSERT_EQUAL_HEX32(0x0FU, shown);
    TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_FIXED_TIME, bench.status.mode);
    bench.cameras_silent = 0U;
    expect_mode(ELMOPP_MODE_AUTOMATIC, 100U);
}

static void test_every_movement_is_served_within_the_bound_however_blind_or_stubborn(void) {
    for (uint32_t run = 0U; run < 3U; run++) {
        setUp();
        start();
        bench.answer = (run == 1U) ? 0U : 200U; /* stays, or names no stage */
        bench.cameras_silent = (run == 2U) ? 0x0FU : 0U;
        for (uint32_t i = 0U; i < 8000U; i++) {
            bench_tick(&bench);
            for (uint32_t j = 0U; j < GROUPS; j++) {
                TEST_ASSERT_LESS_OR_EQUAL_UINT16(bench.junction.red_bound_ds, bench.controller.pilot.plan.wait_ds[j]);
            }
        }
        bench_expect_good_street(&bench);
    }
}

static void test_a_camera_that_the_site_does_not_have_is_not_listened_to(void) {
    bench.junction.cameras = 0x07U;
    bench_start(&bench, &bench.junction);
    start();
    TEST_ASSERT_EQUAL_HEX32(0x07U, bench.controller.detector.trusted);
    elmopp_detector_report_t report[ELMOPP_APPROACH_MOVEMENT_MAX] = {{1U, 1U, true}, {0U, 0U, true}, {0U, 0U, true}};
    elmopp_frame_t frame = elmopp_frames_make_counts(3U, report, 0U);
    uint8_t counter = 0U;
    elmopp_link_seal(&frame, &counter);
    TEST_ASSERT_FALSE(elmopp_controller_take(&bench.controller, &frame));
    TEST_ASSERT_EQUAL_UINT8(0U, bench.controller.bus.refused);
}

/* --- the junction camera --- */

#define WAIT_DS 70U

/* In automatic mode, with nobody about but who goes. */
static void rest_in_the_first_stage(void) {
    bench.answer = 0U;
    start();
    for (uint32_t j = 1U; j < GROUPS; j++) {
        bench.present_veh[j] = 0U;
    }
    bench_ticks(&bench, 1500U);
    TEST_ASSERT_EQUAL_HEX16(0x1U, bench.shown.green);
}

/* A site whose changes wait, in automatic mode with stage 0 shown, and somebody in the junction or not. */
static void start_watched(bool occupied) {
    bench.junction.junction_wait_ds = WAIT_DS;
    bench.junction.red_bound_ds = 2000U;
    bench_start(&bench, &bench.junction);
    rest_in_the_first_stage();
    bench.junction_seen = true;
    bench.occupancy = (elmopp_occupancy_t){.occupied = occupied, .valid = true};
    bench_ticks(&bench, 20U);
}

/* Ticks of all red until the next green, group 1's. */
static uint32_t all_red_until_the_next_green(void) {
    uint32_t red = 0U;
    bench.answer = 1U;
    bench.present_veh[1] = 5U;
    for (uint32_t i = 0U; (i < 400U) && (bench.shown.green != 0x2U); i++) {
        bench_tick(&bench);
        red += ((bench.shown.green | bench.shown.amber) == 0U) ? 1U : 0U;
    }
    TEST_ASSERT_EQUAL_HEX16(0x2U, bench.shown.green);
    return red;
}

#define CLEARANCE_DS (CROSS_INTERGREEN_DS - CROSS_AMBER_DS - CROSS_RED_AMBER_DS)

static void expect_all_red(uint32_t ticks) {
    TEST_ASSERT_EQUAL_UINT32(ticks, all_red_until_the_next_green());
    TEST_ASSERT_EQUAL_INT(ELMOPP_FAULT_NONE, bench.controller.fault);
}

static void test_a_change_waits_for_the_junction_and_the_monitor_does_not_mind(void) {
    start_watched(true);
    expect_all_red(CLEARANCE_DS + WAIT_DS);
}

static void test_a_clear_junction_costs_nothing(void) {
    start_watched(false);
    expect_all_red(CLEARANCE_DS);
}

static void test_a_junction_camera_that_does_not_know_costs_nothing(void) {
    start_watched(true);
    bench.occupancy = (elmopp_occupancy_t){.occupied = true, .valid = false, .reason = 6U};
    bench_ticks(&bench, 2U);
    expect_all_red(CLEARANCE_DS);
}

static void test_without_a_junction_camera_nothing_waits(void) {
    start_watched(true);
    bench.junction_seen = false;
    bench_ticks(&bench, 10U);
    expect_all_red(CLEARANCE_DS);
    bench_start(&bench, &bench.junction); /* nor where there has never been one */
    rest_in_the_first_stage();
    expect_all_red(CLEARANCE_DS);
}

/* Silent from the middle of the wait on: its last word holds for 0.6 s. */
static void test_a_junction_camera_that_falls_silent_ends_the_wait(void) {
    start_watched(true);
    bench.answer = 1U;
    bench.present_veh[1] = 5U;
    uint32_t red = 0U;
    while (red < (CLEARANCE_DS + 20U)) {
        bench_tick(&bench);
        red += ((bench.shown.green | bench.shown.amber) == 0U) ? 1U : 0U;
    }
    const uint32_t last_word = bench.controller.bus.junction_camera.age_ds;
    bench.junction_seen = false;
    for (uint32_t age_ds = last_word + 1U; age_ds < 6U; age_ds++) {
        bench_tick(&bench);
        TEST_ASSERT_EQUAL_HEX16(0U, bench.shown.amber);
    }
    bench_tick(&bench);
    TEST_ASSERT_EQUAL_HEX16(0x2U, bench.shown.amber);
}

static void test_a_site_that_does_not_wait_does_not_listen_to_a_junction_camera(void) {
    start();
    const elmopp_occupancy_t occupancy = {.occupied = true, .valid = true};
    elmopp_frame_t frame = elmopp_frames_make_occupancy(&occupancy);
    uint8_t counter = 0U;
    elmopp_link_seal(&frame, &counter);
    TEST_ASSERT_FALSE(elmopp_controller_take(&bench.controller, &frame));
    TEST_ASSERT_EQUAL_UINT8(0U, bench.controller.bus.refused);
}

static void test_a_spoilt_or_repeated_word_of_the_junction_camera_is_refused(void) {
    start_watched(false);
    const elmopp_occupancy_t occupancy = {.occupied = true, .valid = true};
    elmopp_frame_t frame = elmopp_frames_make_occupancy(&occupancy);
    uint8_t counter = (uint8_t)((bench.occupancy_counter + 14U) % 15U); /* the last one's */
    elmopp_link_seal(&frame, &counter);
    const uint8_t before = bench.controller.bus.refused;
    TEST_ASSERT_FALSE(elmopp_controller_take(&bench.controller, &frame));
    elmopp_link_seal(&frame, &counter);
    frame.data[0] ^= 0x20U;
    TEST_ASSERT_FALSE(elmopp_controller_take(&bench.controller, &frame));
    TEST_ASSERT_FALSE(bench.controller.bus.occupied);
    TEST_ASSERT_EQUAL_UINT8(before + 2U, bench.controller.bus.refused);
    frame.data[0] ^= 0x20U;
    TEST_ASSERT_TRUE(elmopp_controller_take(&bench.controller, &frame));
    TEST_ASSERT_TRUE(bench.controller.bus.occupied);
}

/* --- neighbours --- */

/* 2 vehicles in 10 s, a third in the 4 s after it; nobody else for 14 s. */
static elmopp_frame_t word_of_a_neighbour(uint32_t approach, uint8_t *counter) {
    const elmopp_outflow_t outflow = {
        .next10_veh = 2.0F, .next30_veh = 3.0F, .next60_veh = 3.0F, .ahead_s = 14U, .age_s = 0U};
    elmopp_frame_t frame = elmopp_frames_make_outflow(approach, &outflow);
    elmopp_link_seal(&frame, counter);
    return frame;
}

static float foreseen_veh(uint32_t approach) {
    return bench.controller.pilot.foreseen_sum_veh[approach];
}

static void ticks_until_the_decision(void) {
    bench_tick(&bench);
    while (bench.controller.second_ds != 1U) {
        bench_tick(&bench);
    }
}

static void test_what_a_neighbour_announces_is_foreseen_and_gets_nearer_until_it_is_stale(void) {
    start();
    ticks_until_the_decision();
    TEST_ASSERT_EQUAL_FLOAT(0.0F, foreseen_veh(0U));
    uint8_t counter = 3U;
    const elmopp_frame_t frame = word_of_a_neighbour(0U, &counter);
    bench_ticks(&bench, 9U);
    TEST_ASSERT_TRUE(elmopp_controller_take(&bench.controller, &frame));
    ticks_until_the_decision();
    TEST_ASSERT_FLOAT_WITHIN(1.0e-5F, 3.0F, foreseen_veh(0U));
    TEST_ASSERT_EQUAL_FLOAT(0.0F, foreseen_veh(1U));
    ticks_until_the_decision();
    TEST_ASSERT_FLOAT_WITHIN(1.0e-5F, 2.8F, foreseen_veh(0U)); /* a second of the first ten is over */
    ticks_until_the_decision();
    TEST_ASSERT_FLOAT_WITHIN(1.0e-5F, 2.6F, foreseen_veh(0U));
    ticks_until_the_decision(); /* 3.1 s old */
    TEST_ASSERT_EQUAL_FLOAT(0.0F, foreseen_veh(0U));
    TEST_ASSERT_EQUAL_UINT8(0U, bench.controller.bus.refused);
}

static void test_a_spoilt_repeated_or_early_word_of_a_neighbour_is_refused(void) {
    start();
    uint8_t counter = 5U;
    const elmopp_frame_t first = word_of_a_neighbour(1U, &counter);
    TEST_ASSERT_TRUE(elmopp_controller_take(&bench.controller, &first));
    TEST_ASSERT_FALSE(elmopp_controller_take(&bench.controller, &first));
    elmopp_frame_t spoilt = word_of_a_neighbour(1U, &counter);
    spoilt.data[1] ^= 0x04U;
    TEST_ASSERT_FALSE(elmopp_controller_take(&bench.controller, &spoilt));
    uint8_t ahead = (uint8_t)(counter + ELMOPP_LINK_LOST_MAX);
    const elmopp_frame_t early = word_of_a_neighbour(1U, &ahead);
    TEST_ASSERT_FALSE(elmopp_controller_take(&bench.controller, &early));
    elmopp_frame_t moved = word_of_a_neighbour(1U, &counter);
    moved.id++; /* the checksum is over the id */
    TEST_ASSERT_FALSE(elmopp_controller_take(&bench.controller, &moved));
    TEST_ASSERT_EQUAL_UINT8(4U, bench.controller.bus.refused);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, foreseen_veh(2U));
}

static void test_a_word_for_an_approach_that_does_not_exist_is_for_somebody_else(void) {
    start();
    uint8_t counter = 0U;
    const elmopp_frame_t frame = word_of_a_neighbour(bench.junction.approach_count, &counter);
    TEST_ASSERT_FALSE(elmopp_controller_take(&bench.controller, &frame));
    TEST_ASSERT_EQUAL_UINT8(0U, bench.controller.bus.refused);
}

/* The chooser of the bench reads nothing: what neighbours say must not reach the lamps in any other way. */
static void test_what_neighbours_say_moves_no_lamp_by_itself(void) {
    static elmopp_lamps_t without[1500];
    start();
    for (uint32_t i = 0U; i < 1500U; i++) {
        bench_tick(&bench);
        without[i] = bench.shown;
    }
    setUp();
    start();
    bench.neighbours = 0x7U;
    for (uint32_t i = 0U; i < 1500U; i++) {
        for (uint32_t a = 0U; a < GROUPS; a++) {
            bench.outflow[a] = (elmopp_outflow_t){.next10_veh = 409.5F, .ahead_s = (uint16_t)(i % 400U)};
        }
        bench_tick(&bench);
        TEST_ASSERT_EQUAL_MEMORY(&without[i], &bench.shown, sizeof bench.shown);
    }
    TEST_ASSERT_EQUAL_INT(ELMOPP_FAULT_NONE, bench.controller.fault);
}

static void test_an_outflow_frame_says_what_it_was_made_of(void) {
    const elmopp_outflow_t said = {.next10_veh = 1.5F, .next30_veh = 409.5F, .next60_veh = 500.0F, .ahead_s = 14U};
    elmopp_frame_t frame = elmopp_frames_make_outflow(7U, &said);
    TEST_ASSERT_EQUAL_HEX16(0x1A7U, frame.id);
    const elmopp_outflow_t heard = elmopp_frames_outflow(&frame);
    TEST_ASSERT_EQUAL_FLOAT(1.5F, heard.next10_veh);
    TEST_ASSERT_EQUAL_FLOAT(409.5F, heard.next30_veh);
    TEST_ASSERT_EQUAL_FLOAT(409.5F, heard.next60_veh); /* the field is full */
    TEST_ASSERT_EQUAL_UINT16(14U, heard.ahead_s);
    TEST_ASSERT_EQUAL_UINT16(0U, heard.age_s);
}

/* --- faults --- */

static void test_lost_feedback_flashes(void) {
    start();
    bench.nodes_silent = 0x01U;
    bench_ticks(&bench, 3U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_AUTOMATIC, bench.controller.mode);
    bench_ticks(&bench, 1U);
    expect_fault(ELMOPP_FAULT_FEEDBACK_LOST, 0U);
}

static void test_a_green_that_sticks_is_named(void) {
    start();
    bench.stuck_on.green = 0x0004U;
    bench_ticks(&bench, 6U);
    expect_fault(ELMOPP_FAULT_FEEDBACK_DIFFERS, 2U);
}

static void test_a_red_that_is_broken_is_named(void) {
    start();
    bench.broken.red = 0x0008U;
    bench_ticks(&bench, 6U);
    expect_fault(ELMOPP_FAULT_FEEDBACK_DIFFERS, 3U);
}

static void test_what_a_lamp_node_says_of_itself_is_a_fault(void) {
    bench.junction.group[2].node = 3U;
    bench_start(&bench, &bench.junction);
    start();
    bench.lamp_fault = true;
    bench_ticks(&bench, 2U);
    expect_fault(ELMOPP_FAULT_LAMP_NODE, 0U);
    setUp();
    start();
    bench.own_fail_safe = true;
    bench_ticks(&bench, 2U);
    expect_fault(ELMOPP_FAULT_LAMP_NODE, 0U);
}

static void test_site_data_that_change_are_found_within_a_round(void) {
    for (uint32_t byte = 0U; byte < sizeof bench.junction; byte += 61U) {
        setUp();
        expect_mode(ELMOPP_MODE_START_FLASH, 20U);
        ((uint8_t *)&bench.junction)[byte] ^= 0x04U;
        uint32_t rounds = 0U;
        while ((bench.controller.fault == ELMOPP_FAULT_NONE) && (rounds < 80U)) {
            bench_tick(&bench);
            rounds++;
        }
        ((uint8_t *)&bench.junction)[byte] ^= 0x04U;
        TEST_ASSERT_TRUE(bench.controller.fault != ELMOPP_FAULT_NONE);
        bench.complaint[0] = '\0'; /* the street was not the same while it lasted */
    }
}

static void test_a_corrupted_plan_never_shows_its_conflict(void) {
    start();
    bench_ticks(&bench, 100U);
    bench.controller.pilot.plan.group[0].aspect = ELMOPP_ASPECT_GREEN;
    bench.controller.pilot.plan.group[1].aspect = ELMOPP_ASPECT_GREEN;
    bench_ticks(&bench, 1U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_FAIL_SAFE, bench.controller.mode);
    TEST_ASSERT_EQUAL_HEX16(0U, bench.shown.green);
    TEST_ASSERT_TRUE((bench.controller.fault == ELMOPP_FAULT_CONFLICT) ||
                     (bench.controller.fault == ELMOPP_FAULT_SEQUENCE));
}

static void test_a_mode_that_does_not_exist_ends_in_fail_safe(void) {
    start();
    bench.controller.mode = (elmopp_mode_t)77;
    bench_ticks(&bench, 1U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_FAIL_SAFE, bench.controller.mode);
    TEST_ASSERT_EQUAL_HEX16(0x000FU, bench.shown.flash);
}

/* --- clearing --- */

static void fail(void) {
    start();
    bench.stuck_on.green = 0x0004U;
    bench_ticks(&bench, 6U);
    bench.stuck_on.green = 0U;
}

static void test_a_fault_is_cleared_by_two_commands_and_the_key_and_leads_to_starting(void) {
    fail();
    elmopp_controller_hold_reset(&bench.controller, true);
    TEST_ASSERT_TRUE(bench_command(&bench, ELMOPP_REQUEST_CLEAR_FAULT_PREPARE, ELMOPP_FAULT_FEEDBACK_DIFFERS));
    bench_ticks(&bench, ELMOPP_CONTROLLER_CLEAR_DS - 1U);
    TEST_ASSERT_TRUE(bench_command(&bench, ELMOPP_REQUEST_CLEAR_FAULT_CONFIRM, ELMOPP_FAULT_FEEDBACK_DIFFERS));
    bench_ticks(&bench, 1U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_STARTING, bench.controller.mode);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FAULT_NONE, bench.controller.fault);
    expect_mode(ELMOPP_MODE_AUTOMATIC, START_LIMIT);
}

static void test_a_command_alone_clears_nothing(void) {
    fail();
    const uint8_t refused = bench.controller.bus.refused;
    TEST_ASSERT_FALSE(bench_command(&bench, ELMOPP_REQUEST_CLEAR_FAULT_PREPARE, ELMOPP_FAULT_FEEDBACK_DIFFERS));
    TEST_ASSERT_FALSE(bench_command(&bench, ELMOPP_REQUEST_CLEAR_FAULT_CONFIRM, ELMOPP_FAULT_FEEDBACK_DIFFERS));
    bench_ticks(&bench, 10U);
    expect_fault(ELMOPP_FAULT_FEEDBACK_DIFFERS, 2U);
    TEST_ASSERT_EQUAL_UINT8(refused + 2U, bench.status.refused);
}

static void test_half_a_clearing_clears_nothing(void) {
    fail();
    elmopp_controller_hold_reset(&bench.controller, true);
    bench_ticks(&bench, 100U); /* the key alone */
    TEST_ASSERT_FALSE(bench_command(&bench, ELMOPP_REQUEST_CLEAR_FAULT_CONFIRM, ELMOPP_FAULT_FEEDBACK_DIFFERS));
    TEST_ASSERT_FALSE(bench_command(&bench, ELMOPP_REQUEST_CLEAR_FAULT_PREPARE, ELMOPP_FAULT_CONFLICT));
    TEST_ASSERT_TRUE(bench_command(&bench, ELMOPP_REQUEST_CLEAR_FAULT_PREPARE, ELMOPP_FAULT_FEEDBACK_DIFFERS));
    TEST_ASSERT_FALSE(bench_command(&bench, ELMOPP_REQUEST_CLEAR_FAULT_CONFIRM, ELMOPP_FAULT_CONFLICT));
    bench_ticks(&bench, ELMOPP_CONTROLLER_CLEAR_DS);
    TEST_ASSERT_FALSE(bench_command(&bench, ELMOPP_REQUEST_CLEAR_FAULT_CONFIRM, ELMOPP_FAULT_FEEDBACK_DIFFERS));
    TEST_ASSERT_TRUE(bench_command(&bench, ELMOPP_REQUEST_CLEAR_FAULT_PREPARE, ELMOPP_FAULT_FEEDBACK_DIFFERS));
    elmopp_controller_hold_reset(&bench.controller, false); /* let go in between */
    elmopp_controller_hold_reset(&bench.controller, true);
    TEST_ASSERT_FALSE(bench_command(&bench, ELMOPP_REQUEST_CLEAR_FAULT_CONFIRM, ELMOPP_FAULT_FEEDBACK_DIFFERS));
    bench_ticks(&bench, 1U);
    expect_fault(ELMOPP_FAULT_FEEDBACK_DIFFERS, 2U);
}

static void test_a_cleared_fault_that_is_still_there_comes_back(void) {
    fail();
    bench.stuck_on.green = 0x0004U;
    elmopp_controller_hold_reset(&bench.controller, true);
    (void)bench_command(&bench, ELMOPP_REQUEST_CLEAR_FAULT_PREPARE, ELMOPP_FAULT_FEEDBACK_DIFFERS);
    TEST_ASSERT_TRUE(bench_command(&bench, ELMOPP_REQUEST_CLEAR_FAULT_CONFIRM, ELMOPP_FAULT_FEEDBACK_DIFFERS));
    bench_ticks(&bench, ELMOPP_CONTROLLER_SELF_TEST_DS + 2U);
    expect_fault(ELMOPP_FAULT_SELF_TEST, 0U);
}

/* --- commands --- */

static void test_every_wish_is_fulfilled_and_run_brings_automatic_back(void) {
    static const struct {
        elmopp_request_t request;
        uint32_t argument;
        elmopp_mode_t mode;
    } wishes[] = {{ELMOPP_REQUEST_FIXED_TIME, 0U, ELMOPP_MODE_FIXED_TIME},
                  {ELMOPP_REQUEST_MANUAL, 3U, ELMOPP_MODE_MANUAL},
                  {ELMOPP_REQUEST_ALL_RED, 0U, ELMOPP_MODE_ALL_RED},
                  {ELMOPP_REQUEST_FLASHING, 0U, ELMOPP_MODE_FLASHING},
                  {ELMOPP_REQUEST_DARK, 0U, ELMOPP_MODE_DARK}};
    start();
    for (uint32_t from = 0U; from < 5U; from++) {
        for (uint32_t to = 0U; to < 5U; to++) {
            TEST_ASSERT_TRUE(bench_command(&bench, wishes[from].request, wishes[from].argument));
            expect_mode(wishes[from].mode, 1000U);
            bench_ticks(&bench, 30U);
            TEST_ASSERT_TRUE(bench_command(&bench, wishes[to].request, wishes[to].argument));
            expect_mode(wishes[to].mode, 1000U);
            bench_ticks(&bench, 30U);
        }
        TEST_ASSERT_TRUE(bench_command(&bench, ELMOPP_REQUEST_RUN, 0U));
        expect_mode(ELMOPP_MODE_AUTOMATIC, 1000U);
    }
}

static void test_manual_shows_the_stage_asked_for(void) {
    start();
    TEST_ASSERT_TRUE(bench_command(&bench, ELMOPP_REQUEST_MANUAL, 3U));
    bench_ticks(&bench, 200U);
    TEST_ASSERT_EQUAL_HEX16(0x0008U, bench.shown.green);
    TEST_ASSERT_FALSE(bench_command(&bench, ELMOPP_REQUEST_MANUAL, 4U));
    TEST_ASSERT_EQUAL_UINT8(3U, bench.controller.manual_stage);
}

static void test_what_the_port_could_not_read_is_counted_with_what_is_refused(void) {
    const uint8_t before = bench.controller.bus.refused;
    elmopp_controller_refuse(&bench.controller, 3U);
    TEST_ASSERT_EQUAL_UINT8(before + 3U, bench.controller.bus.refused);
    elmopp_controller_refuse(&bench.controller, 0U);
    elmopp_controller_refuse(&bench.controller, 256U);
    TEST_ASSERT_EQUAL_UINT8(before + 3U, bench.controller.bus.refused);
}

static void test_requests_that_do_not_exist_are_refused(void) {
    start();
    TEST_ASSERT_FALSE(bench_command(&bench, ELMOPP_REQUEST_NONE, 0U));
    for (uint32_t request = 10U; request < 16U; request++) {
        TEST_ASSERT_FALSE(bench_command(&bench, (elmopp_request_t)request, 0U));
    }
    bench_ticks(&bench, 10U);
    TEST_ASSERT_EQUAL_UINT8(7U, bench.status.refused);
}

static void test_the_schedule_flashes_at_night_and_the_clock_runs(void) {
    bench.junction.schedule_count = 2U;
    bench.junction.schedule[0] =
        (elmopp_schedule_t){.from_min = 60U, .weekdays = 0x7FU, .program = ELMOPP_SCHEDULE_FLASH};
    bench.junction.schedule[1] = (elmopp_schedule_t){.from_min = 62U, .weekdays = 0x7FU, .program = 0U};
    bench_start(&bench, &bench.junction);
    start();
    TEST_ASSERT_TRUE(bench_command(&bench, ELMOPP_REQUEST_SET_WALL_TIME, (86400U * 100U) + 3590U));
    bench_ticks(&bench, 90U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_AUTOMATIC, bench.controller.mode);
    expect_mode(ELMOPP_MODE_FLASHING, 250U);
    expect_mode(ELMOPP_MODE_FIRST_STAGE, 1300U);
    TEST_ASSERT_UINT32_WITHIN(3U, (86400U * 100U) + 3722U, bench.controller.wall_s);
}

/* --- the clock --- */

static uint32_t tick_at(elmopp_ms_t now_ms) {
    elmopp_frame_t out[ELMOPP_FRAMES_PER_TICK];
    return elmopp_controller_tick(&bench.controller, now_ms, out);
}

static void test_ticks_keep_to_their_grid(void) {
    TEST_ASSERT_TRUE(tick_at(1000U) > 0U);
    TEST_ASSERT_EQUAL_UINT32(0U, tick_at(1000U));
    TEST_ASSERT_EQUAL_UINT32(0U, tick_at(1049U));
    TEST_ASSERT_TRUE(tick_at(1050U) > 0U); /* due at 1100 */
    TEST_ASSERT_EQUAL_UINT32(0U, tick_at(1149U));
    TEST_ASSERT_TRUE(tick_at(1240U) > 0U); /* due at 1200 */
    TEST_ASSERT_EQUAL_UINT32(0U, tick_at(1249U));
    TEST_ASSERT_TRUE(tick_at(1290U) > 0U); /* due at 1300 */
    TEST_ASSERT_EQUAL_INT(ELMOPP_FAULT_NONE, bench.controller.fault);
}

static void test_so_many_ticks_never_take_less_than_so_many_tenths_but_one_half(void) {
    for (uint32_t poll_ms = 1U; poll_ms < 140U; poll_ms++) {
        setUp();
        uint32_t done = 0U;
        for (uint32_t now_ms = 0U; now_ms < 10000U; now_ms += poll_ms) {
            done += (tick_at(now_ms) > 0U) ? 1U : 0U;
            TEST_ASSERT_TRUE(((done * 100U) <= (now_ms + 150U)));
        }
        TEST_ASSERT_TRUE((poll_ms > 100U) || (done >= 99U));
    }
}

static void test_a_tick_that_was_missed_is_left_out(void) {
    (void)tick_at(0U);
    TEST_ASSERT_TRUE(tick_at(300U) > 0U);
    TEST_ASSERT_EQUAL_UINT32(0U, tick_at(340U));
    TEST_ASSERT_TRUE(tick_at(400U) > 0U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FAULT_NONE, bench.controller.fault);
}

static void test_a_late_tick_and_a_clock_that_jumps_back_or_far_ahead_are_faults(void) {
    static const uint32_t bad_ms[] = {5301U, 4999U, 0U, 1000000U, 0x80000000U};
    for (uint32_t i = 0U; i < 5U; i++) {
        setUp();
        (void)tick_at(5000U);
        TEST_ASSERT_TRUE(tick_at(bad_ms[i]) > 0U);
        TEST_ASSERT_EQUAL_INT(ELMOPP_FAULT_CLOCK, bench.controller.fault);
        TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_FAIL_SAFE, bench.controller.mode);
        TEST_ASSERT_TRUE(tick_at(bad_ms[i] + 100U) > 0U);
    }
}

static void test_a_clock_that_wraps_is_no_fault(void) {
    bench.now_ms = UINT32_MAX - 20000U;
    start();
    bench_ticks(&bench, 600U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_AUTOMATIC, bench.controller.mode);
    TEST_ASSERT_TRUE(bench.now_ms < 100000U);
}

/* --- frames out --- */

static void test_lamp_commands_come_every_tick_and_status_every_second_or_on_news(void) {
    start();
    bench.answer = 0U;
    bench.junction.movement_count = bench.controller.junction->movement_count;
    bench_ticks(&bench, 100U);
    const uint32_t lamps = bench.lamp_frames;
    const uint32_t forecasts = bench.forecast_frames;
    const uint32_t status = bench.status_frames;
    bench_ticks(&bench, 100U);
    TEST_ASSERT_EQUAL_UINT32(lamps + 100U, bench.lamp_frames);
    TEST_ASSERT_EQUAL_UINT32(forecasts + 40U, bench.forecast_frames);
    TEST_ASSERT_TRUE(bench.status_frames >= (status + 10U));
    TEST_ASSERT_TRUE(bench.status_frames <= (status + 16U));
}

/* A decision leaves the rest of the minute to the tick after it, which has the time. */
static void test_forecasts_come_in_the_tick_after_the_decision_and_know_the_whole_minute(void) {
    start();
    uint32_t told = 0U;
    for (uint32_t t = 0U; t < 100U; t++) {
        const bool is_after = bench.controller.second_ds == 1U;
        const uint32_t before = bench.forecast_frames;
        bench_ticks(&bench, 1U);
        const uint32_t frames = bench.forecast_frames - before;
        TEST_ASSERT_EQUAL_UINT32(is_after ? bench.controller.junction->approach_count : 0U, frames);
        TEST_ASSERT_FALSE((frames > 0U) && bench.controller.pilot.looks_on);
        told += frames;
    }
    TEST_ASSERT_EQUAL_UINT32(40U, told);
}

/* --- another controller, and the end --- */

static bool overhear(elmopp_frame_t frame, uint8_t counter) {
    uint8_t own = counter;
    elmopp_link_seal(&frame, &own);
    return elmopp_controller_take(&bench.controller, &frame);
}

static void test_a_second_controller_is_a_fault_whatever_it_says(void) {
    const elmopp_lamps_t dark = {0U, 0U, 0U, 0U};
    const elmopp_status_t status = {.mode = ELMOPP_MODE_STARTING};
    const elmopp_frame_t words[] = {elmopp_frames_lamp_command(&dark, false, true), elmopp_frames_status(&status)};
    for (uint32_t i = 0U; i < 2U; i++) {
        setUp();
        start();
        TEST_ASSERT_TRUE(overhear(words[i], (uint8_t)(3U * i)));
        bench_ticks(&bench, 1U);
        expect_fault(ELMOPP_FAULT_SECOND_CONTROLLER, ELMOPP_FAULT_NO_GROUP);
    }
}

static void test_a_spoilt_lamp_command_is_nobody(void) {
    const elmopp_lamps_t dark = {0U, 0U, 0U, 0U};
    elmopp_frame_t frame = elmopp_frames_lamp_command(&dark, false, true);
    uint8_t counter = 0U;
    elmopp_link_seal(&frame, &counter);
    frame.data[2] ^= 1U;
    TEST_ASSERT_TRUE(bench_until(&bench, ELMOPP_MODE_AUTOMATIC, 600U));
    TEST_ASSERT_FALSE(elmopp_controller_take(&bench.controller, &frame));
    bench_ticks(&bench, 1U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FAULT_NONE, bench.status.fault);
}

static void test_a_stop_is_all_red_first(void) {
    TEST_ASSERT_TRUE(bench_until(&bench, ELMOPP_MODE_AUTOMATIC, 600U));
    bench_ticks(&bench, 30U);
    TEST_ASSERT_NOT_EQUAL_HEX16(0U, bench.shown.green);
    TEST_ASSERT_FALSE(elmopp_controller_has_stopped(&bench.controller));
    elmopp_controller_stop(&bench.controller);
    uint32_t ticks = 0U;
    while ((!elmopp_controller_has_stopped(&bench.controller)) && (ticks < 600U)) {
        bench_tick(&bench);
        ticks++;
    }
    TEST_ASSERT_TRUE(elmopp_controller_has_stopped(&bench.controller));
    TEST_ASSERT_EQUAL_HEX16(0U, bench.shown.green | bench.shown.amber | bench.shown.flash);
    bench_ticks(&bench, 200U);
    TEST_ASSERT_TRUE(elmopp_controller_has_stopped(&bench.controller));
    bench_expect_good_street(&bench);
}

static void test_who_flashes_has_stopped(void) {
    bench_ticks(&bench, 3U);
    TEST_ASSERT_NOT_EQUAL_HEX16(0U, bench.shown.flash);
    TEST_ASSERT_TRUE(elmopp_controller_has_stopped(&bench.controller));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_start_flashes_then_shows_red_then_its_first_stage);
    RUN_TEST(test_without_lamps_that_read_back_there_is_no_start);
    RUN_TEST(test_a_lamp_that_burns_by_itself_fails_the_self_test);
    RUN_TEST(test_a_node_that_is_late_to_wake_up_is_waited_for);
    RUN_TEST(test_what_the_port_finds_at_the_start_is_a_fault);
    RUN_TEST(test_a_site_that_is_none_is_refused_before_any_lamp_burns);
    RUN_TEST(test_a_power_cut_in_any_mode_begins_at_starting);
    RUN_TEST(test_a_blind_camera_puts_its_movement_on_recall_and_back);
    RUN_TEST(test_without_any_camera_the_programme_runs_and_without_faults_automatic_comes_back);
    RUN_TEST(test_every_movement_is_served_within_the_bound_however_blind_or_stubborn);
    RUN_TEST(test_a_camera_that_the_site_does_not_have_is_not_listened_to);
    RUN_TEST(test_a_change_waits_for_the_junction_and_the_monitor_does_not_mind);
    RUN_TEST(test_a_clear_junction_costs_nothing);
    RUN_TEST(test_a_junction_camera_that_does_not_know_costs_nothing);
    RUN_TEST(test_without_a_junction_camera_nothing_waits);
    RUN_TEST(test_a_junction_camera_that_falls_silent_ends_the_wait);
    RUN_TEST(test_a_site_that_does_not_wait_does_not_listen_to_a_junction_camera);
    RUN_TEST(test_a_spoilt_or_repeated_word_of_the_junction_camera_is_refused);
    RUN_TEST(test_what_a_neighbour_announces_is_foreseen_and_gets_nearer_until_it_is_stale);
    RUN_TEST(test_a_spoilt_repeated_or_early_word_of_a_neighbour_is_refused);
    RUN_TEST(test_a_word_for_an_approach_that_does_not_exist_is_for_somebody_else);
    RUN_TEST(test_what_neighbours_say_moves_no_lamp_by_itself);
    RUN_TEST(test_an_outflow_frame_says_what_it_was_made_of);
    RUN_TEST(test_lost_feedback_flashes);
    RUN_TEST(test_a_green_that_sticks_is_named);
    RUN_TEST(test_a_red_that_is_broken_is_named);
    RUN_TEST(test_what_a_lamp_node_says_of_itself_is_a_fault);
    RUN_TEST(test_site_data_that_change_are_found_within_a_round);
    RUN_TEST(test_a_corrupted_plan_never_shows_its_conflict);
    RUN_TEST(test_a_mode_that_does_not_exist_ends_in_fail_safe);
    RUN_TEST(test_a_fault_is_cleared_by_two_commands_and_the_key_and_leads_to_starting);
    RUN_TEST(test_a_command_alone_clears_nothing);
    RUN_TEST(test_half_a_clearing_clears_nothing);
    RUN_TEST(test_a_cleared_fault_that_is_still_there_comes_back);
    RUN_TEST(test_every_wish_is_fulfilled_and_run_brings_automatic_back);
    RUN_TEST(test_manual_shows_the_stage_asked_for);
    RUN_TEST(test_what_the_port_could_not_read_is_counted_with_what_is_refused);
    RUN_TEST(test_requests_that_do_not_exist_are_refused);
    RUN_TEST(test_the_schedule_flashes_at_night_and_the_clock_runs);
    RUN_TEST(test_ticks_keep_to_their_grid);
    RUN_TEST(test_so_many_ticks_never_take_less_than_so_many_tenths_but_one_half);
    RUN_TEST(test_a_tick_that_was_missed_is_left_out);
    RUN_TEST(test_a_late_tick_and_a_clock_that_jumps_back_or_far_ahead_are_faults);
    RUN_TEST(test_a_clock_that_wraps_is_no_fault);
    RUN_TEST(test_forecasts_come_in_the_tick_after_the_decision_and_know_the_whole_minute);
    RUN_TEST(test_lamp_commands_come_every_tick_and_status_every_second_or_on_news);
    RUN_TEST(test_a_second_controller_is_a_fault_whatever_it_says);
    RUN_TEST(test_a_spoilt_lamp_command_is_nobody);
    RUN_TEST(test_a_stop_is_all_red_first);
    RUN_TEST(test_who_flashes_has_stopped);
    return UNITY_END();
}
