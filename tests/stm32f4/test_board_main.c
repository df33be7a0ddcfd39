/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The one main of all boards on a port that is pretended: what keeps the watchdog quiet, and where the port's findings
/// go.

#include "assert_catcher.h"
#include "board.h"
#include "elmopp/frames.h"
#include "elmopp_can.h"
#include "note.h"
#include "port.h"
#include "seal.h"
#include "unity.h"

#include <setjmp.h>
#include <string.h>

#define SECOND_MS 1000U
#define LOOKS_WITHOUT_TIME 5000U

extern const elmopp_junction_t elmopp_site_four_way;
const elmopp_junction_t *const elmopp_board_site = &elmopp_site_four_way;

static jmp_buf end;
static elmopp_ms_t now_ms;
static elmopp_ms_t end_ms;
static bool time_stands;
static uint32_t looks;
static uint32_t kicks;
static uint32_t lamp_commands;
static uint32_t statuses;
static struct elmopp_can_controller_status_t status; /* the last one sent */
static elmopp_fault_t fault;
static elmopp_ms_t fault_from_ms;
static bool whole;
static bool noted;
static char said[2048];

void setUp(void) {
    now_ms = 0U;
    end_ms = SECOND_MS;
    time_stands = false;
    looks = 0U;
    kicks = 0U;
    lamp_commands = 0U;
    statuses = 0U;
    fault = ELMOPP_FAULT_NONE;
    fault_from_ms = 0U;
    whole = true;
    noted = false;
    said[0] = '\0';
}

void tearDown(void) {}

/* --- the port that is pretended --- */

void elmopp_port_init(void) {}

elmopp_ms_t elmopp_port_now_ms(void) {
    return now_ms;
}

bool elmopp_port_receive(elmopp_frame_t *frame) {
    (void)frame;
    return false;
}

uint32_t elmopp_port_dropped(void) {
    return 0U;
}

bool elmopp_port_send(const elmopp_frame_t *frame) {
    lamp_commands += (frame->id == ELMOPP_CAN_LAMP_COMMAND_FRAME_ID) ? 1U : 0U;
    if (frame->id == ELMOPP_CAN_CONTROLLER_STATUS_FRAME_ID) {
        statuses++;
        TEST_ASSERT_EQUAL_INT(0, elmopp_can_controller_status_unpack(&status, frame->data, sizeof frame->data));
    }
    return true;
}

void elmopp_port_sleep_until(elmopp_ms_t until_ms) {
    (void)until_ms;
    looks++;
    now_ms += time_stands ? 0U : 1U;
    if ((now_ms >= end_ms) || (looks >= LOOKS_WITHOUT_TIME)) {
        longjmp(end, 1);
    }
}

void elmopp_port_kick_watchdog(void) {
    kicks++;
}

bool elmopp_port_reset_is_held(void) {
    return false;
}

elmopp_fault_t elmopp_port_fault(void) {
    return (now_ms >= fault_from_ms) ? fault : ELMOPP_FAULT_NONE;
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
    (void)strncat(said, text, sizeof said - strlen(said) - 2U);
    (void)strcat(said, "\n");
}

bool elmopp_seal_is_whole(void) {
    return whole;
}

bool elmopp_note_take(void) {
    return noted;
}

static void run(void) {
    if (setjmp(end) == 0) {
        elmopp_board_run(true);
    }
}

/* --- what is shown --- */

static void test_the_watchdog_is_kicked_once_a_complete_lamp_tick(void) {
    run();
    TEST_ASSERT_EQUAL_UINT32(10U, kicks);
    TEST_ASSERT_EQUAL_UINT32(10U, lamp_commands);
}

static void test_without_lamp_ticks_the_watchdog_is_not_kicked(void) {
    time_stands = true;
    run();
    TEST_ASSERT_EQUAL_UINT32(LOOKS_WITHOUT_TIME, looks);
    TEST_ASSERT_EQUAL_UINT32(1U, kicks); /* of the tick at the start */
}

static void expect_told(elmopp_fault_t wanted, const char *line) {
    TEST_ASSERT_TRUE(statuses > 0U);
    TEST_ASSERT_EQUAL_UINT8(wanted, status.first_fault);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_MODE_FAIL_SAFE, status.mode);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, line), said);
}

static void test_what_the_port_finds_reaches_controller_status_and_people(void) {
    const elmopp_fault_t found[] = {ELMOPP_FAULT_OSCILLATOR, ELMOPP_FAULT_CAN_CONTROLLER, ELMOPP_FAULT_BROWN_OUT};
    for (uint32_t i = 0U; i < (sizeof found / sizeof found[0]); i++) {
        setUp();
        fault = found[i];
        fault_from_ms = 500U; /* whenever it comes */
        run();
        expect_told(fault, elmopp_fault_name(fault));
    }
}

static void test_a_program_that_is_not_whole_and_a_noted_fault_are_told(void) {
    whole = false;
    run();
    expect_told(ELMOPP_FAULT_MEMORY, "fail-safe, the lamps flash; fault:\nmemory test\n");
    setUp();
    noted = true;
    run();
    expect_told(ELMOPP_FAULT_PROCESSOR, "fail-safe, the lamps flash; fault:\nprocessor\n");
}

static void test_without_a_finding_there_is_no_fault(void) {
    run();
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_FAULT_NONE, status.first_fault);
    TEST_ASSERT_EQUAL_STRING("", said);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_watchdog_is_kicked_once_a_complete_lamp_tick);
    RUN_TEST(test_without_lamp_ticks_the_watchdog_is_not_kicked);
    RUN_TEST(test_what_the_port_finds_reaches_controller_status_and_people);
    RUN_TEST(test_a_program_that_is_not_whole_and_a_noted_fault_are_told);
    RUN_TEST(test_without_a_finding_there_is_no_fault);
    return UNITY_END();
}
