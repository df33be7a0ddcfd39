/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The CAN driver at a model of its hardware, when all is well and when the bus is not.

#include "assert_catcher.h"
#include "bit_timing.h"
#include "bxcan_bench.h"
#include "unity.h"

#define LAMP_COMMAND 0x080U
#define FEEDBACK 0x090U
#define STATUS 0x180U
#define FORECAST 0x190U
#define FOREIGN 0x123U /* an id that is not let through */

void setUp(void) {
    bench_start(true);
}

void tearDown(void) {
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(0U, bxcan_model_violations(), "what a program must not do to the hardware");
}

static void expect_sent(uint32_t index, uint32_t id, uint8_t number) {
    const elmopp_frame_t frame = bxcan_model_sent_frame(index);
    const elmopp_frame_t wanted = bench_frame(id, number);
    TEST_ASSERT_EQUAL_HEX16(wanted.id, frame.id);
    TEST_ASSERT_EQUAL_UINT8(wanted.length, frame.length);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(wanted.data, frame.data, sizeof frame.data);
}

/* --- bit timing --- */

static void test_a_bit_is_two_microseconds_sampled_near_seven_eighths(void) {
    const uint32_t word = ELMOPP_CAN_BTR;
    const uint32_t prescaler = (word & 0x3FFU) + 1U;
    const uint32_t before = 1U + ((word >> 16U) & 15U) + 1U;
    const uint32_t after = ((word >> 20U) & 7U) + 1U;
    TEST_ASSERT_EQUAL_UINT32(42000000U, ELMOPP_PCLK1_HZ);
    TEST_ASSERT_EQUAL_UINT32(ELMOPP_PCLK1_HZ, 500000U * prescaler * (before + after));
    TEST_ASSERT_EQUAL_UINT32(857U, (1000U * before) / (before + after));
    TEST_ASSERT_EQUAL_HEX32(0U, word & 0xFC80FC00U); /* neither a test mode nor a reserved bit */
}

static void test_the_clock_may_be_off_by_half_a_percent(void) {
    TEST_ASSERT_EQUAL_UINT32(7142U, ELMOPP_CAN_TOLERANCE_OF_JUMP_PPM);
    TEST_ASSERT_EQUAL_UINT32(5555U, ELMOPP_CAN_TOLERANCE_OF_ERROR_PPM);
    TEST_ASSERT_EQUAL_UINT32(5555U, ELMOPP_CAN_TOLERANCE_PPM);
}

/* --- the start --- */

static void test_it_joins_an_idle_bus_within_a_few_milliseconds(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_BXCAN_WELL, bench_can.trouble);
    TEST_ASSERT_EQUAL_HEX32(ELMOPP_CAN_BTR, elmopp_register_read(&bench_registers()->btr));
}

static void test_it_joins_a_bus_that_is_full(void) {
    bxcan_model_break(BXCAN_FAULT_FLOOD, 0U, UINT32_MAX);
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
}

static void test_before_the_start_it_sends_nothing(void) {
    TEST_ASSERT_FALSE(bench_send(LAMP_COMMAND, 1U));
    TEST_ASSERT_EQUAL_UINT32(1U, bench_can.mailboxes.unsent);
    bench_pass_ms(300U);
    TEST_ASSERT_EQUAL_UINT32(0U, bxcan_model_sent());
}

static void test_whoever_may_not_join_tries_the_hardware_and_stays_silent(void) {
    bench_start(false);
    bench_reach(ELMOPP_BXCAN_HELD, 5U);
    TEST_ASSERT_FALSE(bench_send(LAMP_COMMAND, 1U));
    bench_pass_ms(3000U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_BXCAN_HELD, bench_can.state);
    TEST_ASSERT_EQUAL_UINT32(0U, bxcan_model_sent());
    TEST_ASSERT_EQUAL_HEX32(1U, elmopp_register_read(&bench_registers()->msr) & 3U); /* recessive */
}

/* --- sending --- */

static void test_frames_go_out_as_they_are_in_order_of_their_queue(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    TEST_ASSERT_TRUE(bench_send(STATUS, 7U));
    for (uint8_t k = 0U; k < 8U; k++) {
        TEST_ASSERT_TRUE(bench_send((uint32_t)FORECAST + k, k));
    }
    bench_pass_ms(10U);
    TEST_ASSERT_EQUAL_UINT32(9U, bxcan_model_sent());
    TEST_ASSERT_EQUAL_UINT32(9U, bench_can.mailboxes.sent);
    expect_sent(0U, STATUS, 7U);
    for (uint8_t k = 0U; k < 8U; k++) {
        expect_sent(k + 1U, (uint32_t)FORECAST + k, k);
    }
}

static void test_a_lamp_command_goes_before_what_is_less_urgent(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    (void)bench_send(FORECAST, 1U);
    (void)bench_send(FORECAST + 1U, 2U);
    (void)bench_send(LAMP_COMMAND, 3U);
    bench_pass_ms(5U);
    expect_sent(0U, LAMP_COMMAND, 3U);
    TEST_ASSERT_EQUAL_UINT32(3U, bxcan_model_sent());
}

static void test_a_flood_of_less_urgent_frames_does_not_hold_a_lamp_command_up(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    const elmopp_frame_t other = bench_frame(0x110U, 0U);
    for (uint32_t k = 0U; k < 400U; k++) {
        bxcan_model_hear(&other); /* more important than a forecast, less than a lamp command; 90 ms of them */
    }
    (void)bench_send(FORECAST, 1U);
    (void)bench_send(FORECAST + 1U, 2U);
    bench_pass_ms(5U);
    (void)bench_send(LAMP_COMMAND, 3U);
    bench_pass_ms(2U);
    TEST_ASSERT_EQUAL_UINT32(1U, bxcan_model_sent());
    expect_sent(0U, LAMP_COMMAND, 3U);
}

static void test_two_frames_of_one_id_never_change_places(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    for (uint8_t k = 0U; k < 6U; k++) {
        (void)bench_send(STATUS, k);
    }
    const elmopp_frame_t other = bench_frame(0x101U, 0U);
    for (uint32_t k = 0U; k < 60U; k++) { /* a main loop that is quick, and others that come between two of ours */
        if ((k % 4U) == 1U) {
            bxcan_model_hear(&other);
        }
        elmopp_bxcan_step(&bench_can, bench_now_ms);
        bxcan_model_pass_bits(60U);
    }
    for (uint8_t k = 0U; k < 6U; k++) {
        expect_sent(k, STATUS, k);
    }
}

static void test_only_the_newest_lamp_command_counts(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    bxcan_model_break(BXCAN_FAULT_FLOOD, 0U, UINT32_MAX);
    (void)bench_send(0x0A0U, 1U); /* loses against the flood */
    bench_pass_ms(20U);
    (void)bench_send(0x0A0U, 2U);
    bench_pass_ms(3U);
    (void)bench_send(0x0A0U, 3U);
    bench_pass_ms(3U);
    bxcan_model_break(BXCAN_FAULT_NONE, 0U, UINT32_MAX);
    bench_pass_ms(5U);
    TEST_ASSERT_EQUAL_UINT32(1U, bxcan_model_sent());
    expect_sent(0U, 0x0A0U, 3U);
    TEST_ASSERT_EQUAL_UINT32(2U, bench_can.mailboxes.unsent);
}

static void test_what_does_not_go_out_in_time_is_taken_back_and_counted(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    bxcan_model_break(BXCAN_FAULT_ALONE, 0U, UINT32_MAX);
    (void)bench_send(LAMP_COMMAND, 1U);
    for (uint8_t k = 0U; k < 5U; k++) {
        (void)bench_send((uint32_t)FORECAST + k, k);
    }
    bench_pass_ms(ELMOPP_BXCAN_SEND_MS + 2U);
    TEST_ASSERT_EQUAL_UINT32(6U, bench_can.mailboxes.unsent);
    TEST_ASSERT_EQUAL_UINT32(0U, bench_can.mailboxes.sent);
    bxcan_model_break(BXCAN_FAULT_NONE, 0U, UINT32_MAX);
    bench_pass_ms(50U);
    TEST_ASSERT_EQUAL_UINT32(0U, bxcan_model_sent()); /* nothing stale comes later */
    (void)bench_send(LAMP_COMMAND, 9U);
    bench_pass_ms(2U);
    expect_sent(0U, LAMP_COMMAND, 9U);
}

static void test_a_full_queue_refuses_and_counts(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    for (uint8_t k = 0U; k < ELMOPP_BXCAN_QUEUE; k++) {
        TEST_ASSERT_TRUE(bench_send(FORECAST, k));
    }
    TEST_ASSERT_FALSE(bench_send(FORECAST, 99U));
    TEST_ASSERT_EQUAL_UINT32(1U, bench_can.mailboxes.unsent);
    TEST_ASSERT_TRUE(bench_send(LAMP_COMMAND, 1U)); /* has a place of its own */
}

/* --- receiving --- */

static void test_frames_come_in_order_with_all_their_bytes(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    for (uint8_t k = 0U; k < 20U; k++) {
        const elmopp_frame_t frame = bench_frame((uint32_t)FEEDBACK + (k % 2U), k);
        bxcan_model_hear(&frame);
    }
    bench_pass_ms(10U);
    for (uint8_t k = 0U; k < 20U; k++) {
        elmopp_frame_t frame;
        const elmopp_frame_t wanted = bench_frame((uint32_t)FEEDBACK + (k % 2U), k);
        TEST_ASSERT_TRUE(elmopp_bxcan_receive(&bench_can, &frame));
        TEST_ASSERT_EQUAL_HEX16(wanted.id, frame.id);
        TEST_ASSERT_EQUAL_UINT8(8U, frame.length);
        TEST_ASSERT_EQUAL_HEX8_ARRAY(wanted.data, frame.data, sizeof frame.data);
    }
    TEST_ASSERT_EQUAL_UINT32(0U, bench_drain());
}

static void test_a_foreign_id_is_not_let_through(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    const elmopp_frame_t foreign = bench_frame(FOREIGN, 0U);
    bxcan_model_hear(&foreign);
    bench_pass_ms(5U);
    TEST_ASSERT_EQUAL_UINT32(0U, bench_drain());
}

static void test_a_bank_of_filters_that_is_not_full_lets_nothing_else_through(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U); /* six ids: two places of a bank are left */
    const uint16_t others[] = {0x000U, 0x081U, 0x082U, 0x0FFU, 0x201U, 0x7E0U, 0x7FFU};
    for (uint32_t k = 0U; k < (sizeof others / sizeof others[0]); k++) {
        const elmopp_frame_t frame = bench_frame(others[k], 0U);
        bxcan_model_hear(&frame);
    }
    bench_pass_ms(10U);
    TEST_ASSERT_EQUAL_UINT32(0U, bench_drain());
}

static void test_more_ids_than_there_are_places_for_is_a_bug(void) {
    static uint16_t many[ELMOPP_BXCAN_IDS_MAX + 1U];
    elmopp_bxcan_fifo_t *fifo = &bench_can.fifo;
    bench_start(false);
    bench_reach(ELMOPP_BXCAN_HELD, 5U);
    elmopp_bxcan_fifo_filter(fifo, many, ELMOPP_BXCAN_IDS_MAX);
    TEST_EXPECT_ASSERT(elmopp_bxcan_fifo_filter(fifo, many, ELMOPP_BXCAN_IDS_MAX + 1U));
    TEST_EXPECT_ASSERT(elmopp_bxcan_fifo_filter(fifo, many, 0U));
}

static void test_a_length_above_eight_is_eight(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    elmopp_frame_t frame = bench_frame(FEEDBACK, 0U);
    frame.length = 15U; /* ISO 11898-1: 9 to 15 mean 8 */
    bxcan_model_hear(&frame);
    bench_pass_ms(5U);
    TEST_ASSERT_TRUE(elmopp_bxcan_receive(&bench_can, &frame));
    TEST_ASSERT_EQUAL_UINT8(8U, frame.length);
}

static void test_three_frames_wait_in_the_hardware_and_a_fourth_is_counted_as_lost(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    for (uint8_t k = 0U; k < 3U; k++) {
        const elmopp_frame_t frame = bench_frame(FEEDBACK, k);
        bxcan_model_hear(&frame);
    }
    bench_sleep_ms(5U);
    bench_pass_ms(1U);
    TEST_ASSERT_EQUAL_UINT32(3U, bench_drain());
    TEST_ASSERT_EQUAL_UINT32(0U, elmopp_bxcan_overruns(&bench_can));
    for (uint8_t k = 0U; k < 4U; k++) {
        const elmopp_frame_t frame = bench_frame(FEEDBACK, k);
        bxcan_model_hear(&frame);
    }
    bench_sleep_ms(5U);
    bench_pass_ms(1U);
    TEST_ASSERT_EQUAL_UINT32(3U, bench_drain());
    TEST_ASSERT_EQUAL_UINT32(1U, elmopp_bxcan_overruns(&bench_can));
    TEST_ASSERT_EQUAL_INT(ELMOPP_BXCAN_RUNNING, bench_can.state);
}

static void test_a_flood_fills_the_ring_masks_the_interrupt_and_is_over_when_the_ring_is_empty(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    bxcan_model_break(BXCAN_FAULT_FLOOD, 0U, UINT32_MAX);
    bench_pass_ms(50U); /* 500 frames, and nobody takes one */
    TEST_ASSERT_FALSE(bxcan_model_interrupt());
    TEST_ASSERT_EQUAL_UINT32(ELMOPP_BXCAN_RING, bench_drain());
    bxcan_model_break(BXCAN_FAULT_NONE, 0U, UINT32_MAX);
    bench_pass_ms(5U);
    TEST_ASSERT_TRUE(bench_drain() > 0U); /* the last ones, from the hardware */
    TEST_ASSERT_TRUE(elmopp_bxcan_overruns(&bench_can) > 0U);
    const elmopp_frame_t frame = bench_frame(FEEDBACK, 1U);
    bxcan_model_hear(&frame);
    bench_pass_ms(2U);
    TEST_ASSERT_EQUAL_UINT32(1U, bench_drain());
}

/* --- errors on the wire --- */

static void test_alone_on_the_bus_it_is_error_passive_and_never_bus_off(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    bxcan_model_break(BXCAN_FAULT_ALONE, 0U, UINT32_MAX);
    for (uint32_t k = 0U; k < 30U; k++) {
        (void)bench_send(LAMP_COMMAND, (uint8_t)k);
        bench_pass_ms(100U);
    }
    TEST_ASSERT_EQUAL_INT(ELMOPP_BXCAN_RUNNING, bench_can.state);
    TEST_ASSERT_TRUE(bench_can.passive);
    TEST_ASSERT_EQUAL_UINT32(1U, bench_can.passives);
    bxcan_model_break(BXCAN_FAULT_NONE, 0U, UINT32_MAX);
    for (uint32_t k = 0U; k < 30U; k++) {
        (void)bench_send(LAMP_COMMAND, (uint8_t)k);
        bench_pass_ms(10U);
    }
    TEST_ASSERT_FALSE(bench_can.passive);
    TEST_ASSERT_TRUE(bxcan_model_sent() >= 29U);
}

static void test_frames_of_others_that_arrive_spoilt_make_it_error_passive_and_no_more(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    bxcan_model_break(BXCAN_FAULT_SPOILT | BXCAN_FAULT_FLOOD, 0U, UINT32_MAX);
    bench_pass_ms(100U);
    TEST_ASSERT_TRUE(bench_can.passive);
    TEST_ASSERT_EQUAL_INT(ELMOPP_BXCAN_RUNNING, bench_can.state);
    TEST_ASSERT_EQUAL_UINT32(0U, bench_drain());
}

static void test_bus_off_is_left_before_lamp_nodes_flash_and_with_nothing_stale(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    bxcan_model_break(BXCAN_FAULT_DESTROYED, 0U, UINT32_MAX);
    (void)bench_send(LAMP_COMMAND, 1U);
    (void)bench_send(FORECAST, 2U);
    bench_reach(ELMOPP_BXCAN_PAUSING, 50U);
    const uint32_t off_ms = bench_now_ms;
    bxcan_model_break(BXCAN_FAULT_NONE, 0U, UINT32_MAX);
    bench_reach(ELMOPP_BXCAN_RUNNING, 90U); /* the next lamp tick finds it running */
    TEST_ASSERT_TRUE((bench_now_ms - off_ms) >= ELMOPP_BXCAN_PAUSE_MS);
    TEST_ASSERT_EQUAL_UINT32(1U, bench_can.count[ELMOPP_BXCAN_BUS_OFF]);
    TEST_ASSERT_EQUAL_UINT32(1U, bench_can.returned);
    bench_pass_ms(20U);
    TEST_ASSERT_EQUAL_UINT32(0U, bxcan_model_sent());
    (void)bench_send(LAMP_COMMAND, 3U);
    bench_pass_ms(2U);
    expect_sent(0U, LAMP_COMMAND, 3U);
    TEST_ASSERT_EQUAL_UINT32(0U, bxcan_model_transmit_errors());
}

static void test_the_way_back_from_bus_off_takes_128_times_11_recessive_bits(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    bxcan_model_set_transmit_errors(250U);
    bxcan_model_break(BXCAN_FAULT_DESTROYED, 0U, UINT32_MAX);
    (void)bench_send(LAMP_COMMAND, 1U);
    bench_reach(ELMOPP_BXCAN_PAUSING, 5U);
    bxcan_model_break(BXCAN_FAULT_NONE, 0U, UINT32_MAX);
    bench_reach(ELMOPP_BXCAN_RETURNING, 110U);
    bench_pass_ms(2U); /* 1,000 of 1,408 bits */
    TEST_ASSERT_EQUAL_INT(ELMOPP_BXCAN_RETURNING, bench_can.state);
    bench_pass_ms(2U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_BXCAN_RUNNING, bench_can.state);
}

static void test_it_returns_from_bus_off_on_a_bus_that_is_full(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    bxcan_model_set_transmit_errors(250U);
    bxcan_model_break(BXCAN_FAULT_DESTROYED, 0U, UINT32_MAX);
    (void)bench_send(LAMP_COMMAND, 1U);
    bench_reach(ELMOPP_BXCAN_PAUSING, 5U);
    bxcan_model_break(BXCAN_FAULT_FLOOD, 0U, UINT32_MAX);
    bench_reach(ELMOPP_BXCAN_RUNNING, 90U);
    TEST_ASSERT_EQUAL_UINT32(1U, bench_can.returned);
}

static void destroy_everything(void) {
    bxcan_model_break(BXCAN_FAULT_DESTROYED, 0U, UINT32_MAX);
    for (uint32_t k = 0U; (k < 100U) && (bench_can.state != ELMOPP_BXCAN_FAILED); k++) {
        (void)bench_send(LAMP_COMMAND, (uint8_t)k);
        bench_pass_ms(100U);
    }
}

static void test_after_ten_bus_offs_in_a_row_it_gives_up_and_is_silent(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    destroy_everything();
    TEST_ASSERT_EQUAL_INT(ELMOPP_BXCAN_FAILED, bench_can.state);
    TEST_ASSERT_EQUAL_UINT32(ELMOPP_BXCAN_TRIES, bench_can.count[ELMOPP_BXCAN_BUS_OFF]);
    TEST_ASSERT_EQUAL_UINT32(ELMOPP_BXCAN_TRIES - 1U, bench_can.returned);
    bxcan_model_break(BXCAN_FAULT_NONE, 0U, UINT32_MAX);
    bench_pass_ms(20000U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_BXCAN_FAILED, bench_can.state);
    TEST_ASSERT_FALSE(bench_send(LAMP_COMMAND, 1U));
    TEST_ASSERT_EQUAL_UINT32(0U, bxcan_model_sent());
}

/* In the initialisation mode its output is recessive, and nothing interrupts. */
static void expect_given_up(elmopp_bxcan_trouble_t trouble) {
    bench_reach(ELMOPP_BXCAN_FAILED, 5000U);
    bxcan_model_break(BXCAN_FAULT_NONE, 0U, UINT32_MAX);
    bench_pass_ms(5U);
    TEST_ASSERT_EQUAL_INT(trouble, bench_can.trouble);
    TEST_ASSERT_EQUAL_HEX32(1U, elmopp_register_read(&bench_registers()->msr) & 3U);
    TEST_ASSERT_EQUAL_HEX32(0U, elmopp_register_read(&bench_registers()->ier));
}

static void test_pauses_double_up_to_half_a_second(void) {
    const uint32_t wanted_ms[] = {30U, 60U, 120U, 240U, 480U, 500U, 500U, 500U, 500U};
    bxcan_model_break(BXCAN_FAULT_DEAD, 0U, UINT32_MAX);
    for (uint32_t k = 0U; k < (sizeof wanted_ms / sizeof wanted_ms[0]); k++) {
        bench_reach(ELMOPP_BXCAN_PAUSING, 20U);
        const uint32_t begun_ms = bench_now_ms;
        bench_reach(ELMOPP_BXCAN_RESETTING, 600U);
        TEST_ASSERT_EQUAL_UINT32(wanted_ms[k], bench_now_ms - begun_ms);
    }
    bench_reach(ELMOPP_BXCAN_FAILED, 20U);
}

static void test_a_bus_that_is_stuck_from_the_start_is_given_up_and_named(void) {
    bxcan_model_break(BXCAN_FAULT_DOMINANT, 0U, UINT32_MAX);
    expect_given_up(ELMOPP_BXCAN_NO_JOIN);
    TEST_ASSERT_EQUAL_UINT32(ELMOPP_BXCAN_TRIES, bench_can.count[ELMOPP_BXCAN_NO_JOIN]);
}

static void test_a_bus_that_is_stuck_after_bus_off_is_given_up_and_named(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    bxcan_model_set_transmit_errors(256U);
    bxcan_model_break(BXCAN_FAULT_DOMINANT, 0U, UINT32_MAX);
    expect_given_up(ELMOPP_BXCAN_NO_RETURN);
    TEST_ASSERT_EQUAL_UINT32(1U, bench_can.count[ELMOPP_BXCAN_BUS_OFF]);
    TEST_ASSERT_EQUAL_UINT32(ELMOPP_BXCAN_TRIES - 1U, bench_can.count[ELMOPP_BXCAN_NO_RETURN]);
    TEST_ASSERT_EQUAL_UINT32(0U, bench_can.returned);
}

static void test_a_mailbox_that_is_not_given_back_is_given_up_and_named(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    bxcan_model_break(BXCAN_FAULT_MAILBOX, 0U, UINT32_MAX);
    (void)bench_send(LAMP_COMMAND, 1U);
    expect_given_up(ELMOPP_BXCAN_NO_MAILBOX);
}

static void test_whoever_has_given_up_can_be_started_anew(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    destroy_everything();
    bxcan_model_break(BXCAN_FAULT_NONE, 0U, UINT32_MAX);
    elmopp_bxcan_start(&bench_can, bench_now_ms);
    bench_reach(ELMOPP_BXCAN_RUNNING, 500U);
    (void)bench_send(LAMP_COMMAND, 5U);
    bench_pass_ms(2U);
    expect_sent(0U, LAMP_COMMAND, 5U);
}

static void test_ten_seconds_without_trouble_give_all_tries_back(void) {
    bench_reach(ELMOPP_BXCAN_RUNNING, 5U);
    for (uint32_t round = 0U; round < (2U * ELMOPP_BXCAN_TRIES); round++) {
        bxcan_model_set_transmit_errors(250U);
        bxcan_model_break(BXCAN_FAULT_DESTROYED, 0U, UINT32_MAX);
        (void)bench_send(LAMP_COMMAND, 1U);
        bench_reach(ELMOPP_BXCAN_PAUSING, 5U);
        bxcan_model_break(BXCAN_FAULT_NONE, 0U, UINT32_MAX);
        bench_reach(ELMOPP_BXCAN_RUNNING, 200U);
        bench_pass_ms(ELMOPP_BXCAN_STEADY_MS + 1U);
        TEST_ASSERT_EQUAL_UINT32(0U, bench_can.tries);
    }
}

static void test_every_trouble_has_a_name(void) {
    for (uint32_t i = 0U; i < (uint32_t)ELMOPP_BXCAN_TROUBLES; i++) {
        TEST_ASSERT_NOT_NULL(elmopp_bxcan_trouble_name((elmopp_bxcan_trouble_t)i));
    }
    TEST_ASSERT_EQUAL_STRING("unknown", elmopp_bxcan_trouble_name(ELMOPP_BXCAN_TROUBLES));
    TEST_ASSERT_EQUAL_STRING("bus-off", elmopp_bxcan_trouble_name(ELMOPP_BXCAN_BUS_OFF));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_bit_is_two_microseconds_sampled_near_seven_eighths);
    RUN_TEST(test_the_clock_may_be_off_by_half_a_percent);
    RUN_TEST(test_it_joins_an_idle_bus_within_a_few_milliseconds);
    RUN_TEST(test_it_joins_a_bus_that_is_full);
    RUN_TEST(test_before_the_start_it_sends_nothing);
    RUN_TEST(test_whoever_may_not_join_tries_the_hardware_and_stays_silent);
    RUN_TEST(test_frames_go_out_as_they_are_in_order_of_their_queue);
    RUN_TEST(test_a_lamp_command_goes_before_what_is_less_urgent);
    RUN_TEST(test_a_flood_of_less_urgent_frames_does_not_hold_a_lamp_command_up);
    RUN_TEST(test_two_frames_of_one_id_never_change_places);
    RUN_TEST(test_only_the_newest_lamp_command_counts);
    RUN_TEST(test_what_does_not_go_out_in_time_is_taken_back_and_counted);
    RUN_TEST(test_a_full_queue_refuses_and_counts);
    RUN_TEST(test_frames_come_in_order_with_all_their_bytes);
    RUN_TEST(test_a_foreign_id_is_not_let_through);
    RUN_TEST(test_a_bank_of_filters_that_is_not_full_lets_nothing_else_through);
    RUN_TEST(test_more_ids_than_there_are_places_for_is_a_bug);
    RUN_TEST(test_a_length_above_eight_is_eight);
    RUN_TEST(test_three_frames_wait_in_the_hardware_and_a_fourth_is_counted_as_lost);
    RUN_TEST(test_a_flood_fills_the_ring_masks_the_interrupt_and_is_over_when_the_ring_is_empty);
    RUN_TEST(test_alone_on_the_bus_it_is_error_passive_and_never_bus_off);
    RUN_TEST(test_frames_of_others_that_arrive_spoilt_make_it_error_passive_and_no_more);
    RUN_TEST(test_bus_off_is_left_before_lamp_nodes_flash_and_with_nothing_stale);
    RUN_TEST(test_the_way_back_from_bus_off_takes_128_times_11_recessive_bits);
    RUN_TEST(test_it_returns_from_bus_off_on_a_bus_that_is_full);
    RUN_TEST(test_after_ten_bus_offs_in_a_row_it_gives_up_and_is_silent);
    RUN_TEST(test_pauses_double_up_to_half_a_second);
    RUN_TEST(test_a_bus_that_is_stuck_from_the_start_is_given_up_and_named);
    RUN_TEST(test_a_bus_that_is_stuck_after_bus_off_is_given_up_and_named);
    RUN_TEST(test_a_mailbox_that_is_not_given_back_is_given_up_and_named);
    RUN_TEST(test_whoever_has_given_up_can_be_started_anew);
    RUN_TEST(test_ten_seconds_without_trouble_give_all_tries_back);
    RUN_TEST(test_every_trouble_has_a_name);
    return UNITY_END();
}
