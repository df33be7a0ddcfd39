/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The boards' main on a port that is made up: a bus on which there is always one more frame, each of which costs time;
/// memory that is broken.

#include "board.h"
#include "note.h"
#include "port.h"
#include "seal.h"
#include "sites.h"

#include "elmopp_can.h"
#include "unity.h"

#include <setjmp.h>
#include <stddef.h>

#define COMMANDS 100U
#define US_PER_FRAME 200U
#define US_PER_MS 1000U

static jmp_buf enough;
static uint32_t now_us;
static uint32_t commands;
static uint32_t command_ms[COMMANDS];
static uint32_t frames;
static bool flooded;
static uint32_t told_fault;

const elmopp_junction_t *const elmopp_board_site = &elmopp_site_four_way;

void setUp(void) {
    now_us = 0U;
    commands = 0U;
    frames = 0U;
    told_fault = 0U;
}
void tearDown(void) {}

/* --- the port --- */

elmopp_fault_t elmopp_port_fault(void); /* of boards that can look at themselves */

void elmopp_port_init(void) {}

elmopp_ms_t elmopp_port_now_ms(void) {
    return now_us / US_PER_MS;
}

bool elmopp_port_receive(elmopp_frame_t *frame) {
    *frame = (elmopp_frame_t){.id = 0x7FFU, .length = 8U, .data = {0U}};
    now_us += flooded ? US_PER_FRAME : 0U;
    frames += flooded ? 1U : 0U;
    if (frames > 1000000U) {
        longjmp(enough, 1);
    }
    return flooded;
}

uint32_t elmopp_port_dropped(void) {
    return 0U;
}

bool elmopp_port_send(const elmopp_frame_t *frame) {
    if (frame->id == (uint16_t)ELMOPP_CAN_LAMP_COMMAND_FRAME_ID) {
        command_ms[commands] = elmopp_port_now_ms();
        commands++;
    }
    if (frame->id == (uint16_t)ELMOPP_CAN_CONTROLLER_STATUS_FRAME_ID) {
        struct elmopp_can_controller_status_t status;
        TEST_ASSERT_EQUAL_INT(0, elmopp_can_controller_status_unpack(&status, frame->data, frame->length));
        told_fault = status.first_fault;
    }
    if (commands == COMMANDS) {
        longjmp(enough, 1);
    }
    return true;
}

void elmopp_port_sleep_until(elmopp_ms_t until_ms) {
    now_us = flooded ? now_us : (until_ms * US_PER_MS);
}

void elmopp_port_kick_watchdog(void) {}

bool elmopp_port_reset_is_held(void) {
    return false;
}

elmopp_fault_t elmopp_port_fault(void) {
    return ELMOPP_FAULT_NONE;
}

elmopp_port_slot_t elmopp_port_site_slot(void) {
    return (elmopp_port_slot_t){NULL, 0U};
}

elmopp_port_slot_t elmopp_port_weights_slot(void) {
    return (elmopp_port_slot_t){NULL, 0U};
}

elmopp_store_medium_t elmopp_port_medium(elmopp_transfer_kind_t kind) {
    (void)kind;
    return (elmopp_store_medium_t){.bytes = NULL};
}

elmopp_store_answer_t elmopp_port_store(elmopp_transfer_kind_t kind, const elmopp_store_order_t *order) {
    (void)kind;
    (void)order;
    return ELMOPP_STORE_FAILED;
}

uint32_t elmopp_port_save_min_s(void) {
    return 0U;
}

elmopp_learning_t *elmopp_port_learning(void) {
    return NULL;
}

void elmopp_port_say(const char *text) {
    (void)text;
}

bool elmopp_seal_is_whole(void) {
    return true;
}

bool elmopp_note_take(void) {
    return false;
}

/* --- the tests --- */

/* Until there have been enough LampCommands. */
static void run(bool in_a_flood, bool memory_is_good) {
    flooded = in_a_flood;
    if (setjmp(enough) == 0) {
        elmopp_board_run(memory_is_good);
    }
    TEST_ASSERT_EQUAL_UINT32(COMMANDS, commands);
}

static void test_without_frames_ticks_are_on_the_grid(void) {
    run(false, true);
    TEST_ASSERT_EQUAL_UINT32(ELMOPP_FAULT_NONE, told_fault);
    for (uint32_t k = 0U; k < COMMANDS; k++) {
        TEST_ASSERT_EQUAL_UINT32(k * 100U, command_ms[k]);
    }
}

static void test_in_a_flood_ticks_are_as_late_as_its_share_and_none_is_missed(void) {
    const uint32_t share_ms = ((ELMOPP_BOARD_FRAMES_MAX * US_PER_FRAME) / US_PER_MS) + 1U;
    run(true, true);
    for (uint32_t k = 1U; k < COMMANDS; k++) { /* the grid begins somewhat before the first */
        TEST_ASSERT_TRUE(command_ms[k] >= (k * 100U));
        TEST_ASSERT_TRUE(command_ms[k] <= ((k * 100U) + share_ms));
    }
    TEST_ASSERT_TRUE(frames > (COMMANDS * ELMOPP_BOARD_FRAMES_MAX)); /* all of the time that is left is the flood's */
}

static void test_memory_that_is_broken_is_told(void) {
    run(false, false);
    TEST_ASSERT_EQUAL_UINT32(ELMOPP_FAULT_MEMORY, told_fault);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_memory_that_is_broken_is_told);
    RUN_TEST(test_without_frames_ticks_are_on_the_grid);
    RUN_TEST(test_in_a_flood_ticks_are_as_late_as_its_share_and_none_is_missed);
    return UNITY_END();
}
