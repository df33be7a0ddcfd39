/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// All of elmopp-stm32f4 but its start-up file on this machine: main, port, drivers and core, with registers that are a
/// model, and at the other end of the bus a lamp node. Here the crystal swings and the CAN controller answers, which no
/// emulator has.

#include "flash_model.h"

/* The sectors in which images are kept: their linker's symbol is the model's memory. */
#define elmopp_store_area flash_model_memory

/* The port itself: its table of interrupts is reached in no other way. */
#include "stm32f4_port.c"

#include "assert_catcher.h"
#include "bxcan_model.h"
#include "elmopp/frames.h"
#include "elmopp/lamp_node.h"
#include "elmopp_weights.h"
#include "image_writer.h"
#include "seal.h"
#include "segments.h"
#include "unity.h"

#include <setjmp.h>
#include <string.h>

#define SLICES 5U /* of a millisecond */
#define INTERRUPTS_IN_A_ROW 8U
#define SAID_MAX 8192U
#define LONGEST_WATCHDOG_MS 255U /* at the fastest clock that it may have */

typedef enum { ENDED = 1, RESET = 2 } end_t;

extern const elmopp_junction_t elmopp_site_four_way;
static elmopp_junction_t board_site;
const elmopp_junction_t *const elmopp_board_site = &board_site;
const uint8_t elmopp_site_slot[4] = {0xFFU, 0xFFU, 0xFFU, 0xFFU};
const uint8_t elmopp_site_slot_end[1];
const uint8_t elmopp_weights_slot[4] = {0xFFU, 0xFFU, 0xFFU, 0xFFU};
const uint8_t elmopp_weights_slot_end[1];

/* The street. */
static elmopp_lamp_node_t node;
static uint32_t frames_heard;
static struct elmopp_can_controller_status_t status; /* the last on the bus */
static uint8_t command_counter;
static uint8_t camera_counter[ELMOPP_APPROACH_MAX];
static bool cameras_play;
static uint32_t may_send; /* segments of a transfer */

/* The board. */
static jmp_buf end;
static uint32_t ms;
static uint32_t end_ms;
static void (*event)(uint32_t now_ms); /* of the test, every millisecond; null: none */
static bool crystal;
static bool key_is_closed;
static uint32_t option_bytes;
static uint32_t reset_flags;
static bool noted;
static uint32_t kicked_ms;
static uint32_t longest_kick_ms;
static uint32_t enabled_interrupt;
static uint32_t written[4]; /* RCC_CR, RCC_CFGR, FLASH_ACR, the rest */
static char said[SAID_MAX];
static uint32_t said_length;

void setUp(void) {
    bxcan_model_reset();
    bxcan_model_break(BXCAN_FAULT_NONE, 0U, UINT32_MAX);
    flash_model_reset();
    board_site = elmopp_site_four_way;
    elmopp_lamp_node_init(&node, elmopp_board_site, 0U);
    frames_heard = 0U;
    memset(&status, 0, sizeof status);
    command_counter = 0U;
    memset(camera_counter, 0, sizeof camera_counter);
    cameras_play = false;
    ms = 0U;
    event = NULL;
    crystal = true;
    key_is_closed = false;
    option_bytes = 0U;
    reset_flags = ELMOPP_RCC_CSR_PORRSTF;
    noted = false;
    kicked_ms = 0U;
    longest_kick_ms = 0U;
    enabled_interrupt = 0U;
    said_length = 0U;
    said[0] = '\0';
    told_dropped = 0U;
    memset(written, 0, sizeof written);
}

void tearDown(void) {}

/* The power goes and comes: the flash stays, and so does the time of this test. */
static void power_again(void) {
    const uint32_t now = ms;
    bxcan_model_reset();
    flash_model_restart();
    ms = now;
    kicked_ms = now;
    longest_kick_ms = 0U;
    reset_flags = ELMOPP_RCC_CSR_PORRSTF;
    memset(&status, 0, sizeof status);
    memset(written, 0, sizeof written);
    told_dropped = 0U;
    elmopp_lamp_node_init(&node, elmopp_board_site, 0U);
}

/* --- registers: CAN and flash are models, the rest answers as it should --- */

static uint32_t flash_offset(const elmopp_register_t *place) {
    return (uint32_t)((uintptr_t)place - (uintptr_t)ELMOPP_FLASH);
}

/* ACR is the clocks' and the option bytes are this test's. */
static bool is_flash_models(const elmopp_register_t *place) {
    return (flash_offset(place) < sizeof *ELMOPP_FLASH) && (place != &ELMOPP_FLASH->acr) &&
           (place != &ELMOPP_FLASH->optcr);
}

void flash_model_power_lost(void) {
    longjmp(end, RESET);
}

static uint32_t can_offset(const elmopp_register_t *place) {
    return (uint32_t)((uintptr_t)place - (uintptr_t)ELMOPP_CAN1);
}

static uint32_t *kept(const elmopp_register_t *place) {
    const elmopp_register_t *const places[] = {&ELMOPP_RCC->cr, &ELMOPP_RCC->cfgr, &ELMOPP_FLASH->acr};
    uint32_t index = 0U;
    while ((index < 3U) && (places[index] != place)) {
        index++;
    }
    return &written[index];
}

uint32_t elmopp_register_read(const elmopp_register_t *place) {
    if (can_offset(place) < sizeof *ELMOPP_CAN1) {
        return bxcan_model_read(can_offset(place));
    }
    if (is_flash_models(place)) {
        return flash_model_read(flash_offset(place));
    }
    if (place == &ELMOPP_RCC->cr) {
        return *kept(place) | (crystal ? (ELMOPP_RCC_CR_HSERDY | ELMOPP_RCC_CR_PLLRDY) : 0U);
    }
    if (place == &ELMOPP_RCC->cfgr) {
        return *kept(place) | ((*kept(place) & ELMOPP_RCC_CFGR_SW) << ELMOPP_RCC_CFGR_SWS_AT);
    }
    if (place == &ELMOPP_RCC->csr) {
        return reset_flags;
    }
    if (place == &ELMOPP_FLASH->acr) {
        return *kept(place);
    }
    if (place == &ELMOPP_FLASH->optcr) {
        return option_bytes;
    }
    if (place == &ELMOPP_GPIOC->idr) {
        return key_is_closed ? 0U : UINT32_MAX;
    }
    return (place == &ELMOPP_USART1->sr) ? ELMOPP_USART_SR_TXE : 0U;
}

void elmopp_register_write(elmopp_register_t *place, uint32_t value) {
    if (can_offset(place) < sizeof *ELMOPP_CAN1) {
        bxcan_model_write(can_offset(place), value);
    } else if (is_flash_models(place)) {
        flash_model_write(flash_offset(place), value);
    } else if (((uintptr_t)place - (uintptr_t)flash_model_memory) < sizeof flash_model_memory) {
        flash_model_program((uint32_t)((uintptr_t)place - (uintptr_t)flash_model_memory), value);
    } else if ((place == &ELMOPP_USART1->dr) && (said_length < (SAID_MAX - 1U))) {
        said[said_length] = (char)value;
        said_length++;
        said[said_length] = '\0';
    } else if ((place == &ELMOPP_IWDG->kr) && (value == ELMOPP_IWDG_KR_RELOAD)) {
        longest_kick_ms = ((ms - kicked_ms) > longest_kick_ms) ? (ms - kicked_ms) : longest_kick_ms;
        kicked_ms = ms;
    } else {
        *kept(place) = value;
    }
}

/* --- the processor, and what start-up and seal would be --- */

static void interrupts(void) {
    for (uint32_t k = 0U; (k < INTERRUPTS_IN_A_ROW) && bxcan_model_interrupt(); k++) {
        device_vectors[enabled_interrupt]();
    }
}

static void street_listens(void) {
    elmopp_frame_t frame;
    while (bxcan_model_take_sent(&frame)) {
        frames_heard++;
        (void)elmopp_lamp_node_take(&node, &frame);
        if ((frame.id == SEGMENTS_ACK) && (frame.data[0] == 0x30U)) {
            may_send = frame.data[1];
        }
        if (frame.id == ELMOPP_CAN_CONTROLLER_STATUS_FRAME_ID) {
            TEST_ASSERT_EQUAL_INT(0, elmopp_can_controller_status_unpack(&status, frame.data, sizeof frame.data));
        }
    }
    elmopp_lamp_node_pass(&node, 1U);
    if ((ms % ELMOPP_LAMP_NODE_FEEDBACK_MS) == 37U) {
        frame = elmopp_lamp_node_feedback(&node, &node.lamps, false);
        bxcan_model_hear(&frame);
    }
}

/* Somebody waits everywhere, and some more come. */
static void cameras_see(void) {
    const uint8_t arrivals = (uint8_t)((ms / 3000U) % ELMOPP_DETECTOR_MODULO);
    const elmopp_detector_report_t lane = {
        .present_veh = (uint16_t)(1U + (arrivals % 5U)), .arrivals = arrivals, .valid = true};
    const elmopp_detector_report_t report[ELMOPP_APPROACH_MOVEMENT_MAX] = {lane, lane, lane};
    for (uint32_t i = 0U; i < elmopp_board_site->approach_count; i++) {
        elmopp_frame_t frame = elmopp_frames_make_counts(i, report, 0U);
        elmopp_link_seal(&frame, &camera_counter[i]);
        bxcan_model_hear(&frame);
    }
}

/* One millisecond. */
void pretended_wait(void) {
    for (uint32_t k = 0U; k < SLICES; k++) {
        bxcan_model_pass_bits(BXCAN_MODEL_BITS_OF_MS / SLICES);
        interrupts();
    }
    ms++;
    street_listens();
    if (cameras_play && ((ms % 1000U) == 500U)) {
        cameras_see();
    }
    if (event != NULL) {
        event(ms);
    }
    if (ms >= end_ms) {
        longjmp(end, ENDED);
    }
}

void pretended_interrupts(int on) {
    (void)on;
}

void pretended_enable(uint32_t number) {
    enabled_interrupt = number;
}

void pretended_reset(void) {
    longjmp(end, RESET);
}

void elmopp_systick_start(uint32_t processor_hz) {
    TEST_ASSERT_EQUAL_UINT32(crystal ? 168000000U : 16000000U, processor_hz);
}

uint32_t elmopp_systick_ms(void) {
    return ms;
}

void elmopp_stack_guard_start(void) {}

void elmopp_unexpected_handler(void) {
    TEST_FAIL_MESSAGE("an interrupt that nobody has asked for");
}

void elmopp_note_fault(void) {
    noted = true;
}

bool elmopp_note_take(void) {
    const bool was_noted = noted;
    noted = false;
    return was_noted;
}

bool elmopp_seal_is_whole(void) {
    return true;
}

/* The board runs for so long from its start. */
static void run_ms(uint32_t duration_ms) {
    end_ms = ms + duration_ms;
    const int how = setjmp(end);
    if (how == 0) {
        elmopp_board_run(true);
    }
    TEST_ASSERT_EQUAL_INT(ENDED, how);
    TEST_ASSERT_TRUE((ms - kicked_ms) < LONGEST_WATCHDOG_MS);
    TEST_ASSERT_TRUE(longest_kick_ms < LONGEST_WATCHDOG_MS);
}

static void expect_said(const char *line) {
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, line), said);
}

static void expect_fail_safe(elmopp_fault_t fault) {
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_MODE_FAIL_SAFE, status.mode);
    TEST_ASSERT_EQUAL_UINT8(fault, status.first_fault);
}

/* --- what is shown --- */

static void test_with_crystal_and_can_it_brings_a_junction_up(void) {
    run_ms(60000U);
    expect_said("last reset:\r\npower\r\n");
    expect_said("CAN: on the bus\r\n");
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_MODE_FIXED_TIME, status.mode); /* nobody plays cameras */
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_FAULT_NONE, status.first_fault);
    TEST_ASSERT_FALSE(node.fail_safe);
    TEST_ASSERT_EQUAL_UINT32(0U, status.refused);
    TEST_ASSERT_EQUAL_UINT32(ELMOPP_CAN1_RX0_INTERRUPT, enabled_interrupt);
    TEST_ASSERT_EQUAL_UINT32(0U, bxcan_model_violations());
    TEST_ASSERT_TRUE(can.mailboxes.unsent <= ELMOPP_FRAMES_PER_TICK); /* those of the first tick: not yet on the bus */
}

static void test_with_cameras_it_runs_by_what_they_count(void) {
    cameras_play = true;
    run_ms(90000U);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_MODE_AUTOMATIC, status.mode);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_FAULT_NONE, status.first_fault);
    TEST_ASSERT_EQUAL_UINT32(0U, status.refused);
}

static uint32_t let_through;

/* Every id of eleven bits, one after the other. */
static void all_ids(uint32_t now_ms) {
    static uint32_t before;
    if (now_ms == 1000U) {
        before = atomic_load(&can.fifo.put);
    }
    if ((now_ms >= 1000U) && (now_ms < 3048U)) {
        const elmopp_frame_t frame = {.id = (uint16_t)(now_ms - 1000U), .length = 0U};
        bxcan_model_hear(&frame);
    }
    let_through = atomic_load(&can.fifo.put) - before;
}

static void test_what_controllers_listen_to_is_let_through_and_simulated_time_is_not(void) {
    event = all_ids;
    run_ms(3060U);
    const uint32_t feedback = 20U + 1U; /* of the lamp node, meanwhile */
    TEST_ASSERT_EQUAL_UINT32(5U + ELMOPP_NODE_MAX + (2U * ELMOPP_APPROACH_MAX) + feedback,
                             let_through); /* cameras, neighbours */
}

static void one_bus_off(uint32_t now_ms) {
    if (now_ms == 50000U) {
        bxcan_model_set_transmit_errors(256U);
    }
}

static void test_one_bus_off_stops_no_junction(void) {
    event = one_bus_off;
    run_ms(60000U);
    TEST_ASSERT_EQUAL_UINT32(1U, can.count[ELMOPP_BXCAN_BUS_OFF]);
    TEST_ASSERT_EQUAL_UINT32(1U, can.returned);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_MODE_FIXED_TIME, status.mode);
    TEST_ASSERT_FALSE(node.fail_safe);
    expect_said("CAN: another try follows:\r\nbus-off\r\n");
}

static void command(elmopp_request_t request, elmopp_fault_t fault) {
    const struct elmopp_can_command_t signals = {.request = (uint8_t)request, .argument = (uint32_t)fault};
    elmopp_frame_t frame = {.id = ELMOPP_CAN_COMMAND_FRAME_ID, .length = 8U, .data = {0U}};
    TEST_ASSERT_EQUAL_INT(8, elmopp_can_command_pack(frame.data, &signals, sizeof frame.data));
    elmopp_link_seal(&frame, &command_counter);
    bxcan_model_hear(&frame);
}

static bool was_safe_when_broken;

/* The bus is destroyed for ten seconds; then somebody turns the key, and clears the fault. */
static void broken_for_a_while(uint32_t now_ms) {
    if (now_ms == 50000U) {
        bxcan_model_break(BXCAN_FAULT_DESTROYED, 0U, UINT32_MAX);
    } else if (now_ms == 59000U) {
        was_safe_when_broken = node.fail_safe && (can.state == ELMOPP_BXCAN_FAILED);
        bxcan_model_break(BXCAN_FAULT_NONE, 0U, UINT32_MAX);
    } else if (now_ms == 60000U) {
        key_is_closed = true;
    } else if (now_ms == 62000U) {
        command(ELMOPP_REQUEST_CLEAR_FAULT_PREPARE, (elmopp_fault_t)status.first_fault);
    } else if (now_ms == 63000U) {
        command(ELMOPP_REQUEST_CLEAR_FAULT_CONFIRM, (elmopp_fault_t)status.first_fault);
    } else {
        /* nothing happens */
    }
}

static void test_a_bus_that_destroys_everything_makes_lamps_flash_until_the_key_is_turned_and_the_fault_cleared(void) {
    was_safe_when_broken = false;
    event = broken_for_a_while;
    run_ms(61500U);
    TEST_ASSERT_TRUE(was_safe_when_broken);
    expect_said("CAN: given up; turning the key begins anew:\r\nbus-off\r\n");
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_MODE_FAIL_SAFE, status.mode);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_FAULT_FEEDBACK_LOST, status.first_fault);
    setUp();
    event = broken_for_a_while;
    run_ms(66000U);
    expect_said("the fault has been cleared\r\n");
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_FAULT_NONE, status.first_fault);
    TEST_ASSERT_TRUE(status.mode != ELMOPP_MODE_FAIL_SAFE);
    TEST_ASSERT_TRUE(longest_kick_ms < LONGEST_WATCHDOG_MS);
}

static void test_without_its_crystal_it_never_says_a_word_on_the_bus_and_the_lamps_flash(void) {
    crystal = false;
    run_ms(20000U);
    TEST_ASSERT_EQUAL_UINT32(0U, frames_heard);
    TEST_ASSERT_EQUAL_INT(ELMOPP_BXCAN_HELD, can.state);
    TEST_ASSERT_TRUE(node.fail_safe);
    expect_said("CAN: it answers, and stays silent\r\n");
    expect_said("fail-safe, the lamps flash; fault:\r\noscillator\r\n");
}

static void test_without_a_can_controller_it_says_so_and_the_lamps_flash(void) {
    bxcan_model_break(BXCAN_FAULT_DEAD, 0U, UINT32_MAX);
    run_ms(20000U);
    TEST_ASSERT_EQUAL_UINT32(0U, frames_heard);
    TEST_ASSERT_TRUE(node.fail_safe);
    expect_said("CAN: given up; turning the key begins anew:\r\nit does not answer\r\n");
    expect_said("fail-safe, the lamps flash; fault:\r\nCAN controller\r\n");
    TEST_ASSERT_TRUE(longest_kick_ms < LONGEST_WATCHDOG_MS);
}

static void try_to_clear(uint32_t now_ms) {
    if (now_ms == 5000U) {
        key_is_closed = true;
    } else if (now_ms == 6000U) {
        command(ELMOPP_REQUEST_CLEAR_FAULT_PREPARE, ELMOPP_FAULT_BROWN_OUT);
    } else if (now_ms == 7000U) {
        command(ELMOPP_REQUEST_CLEAR_FAULT_CONFIRM, ELMOPP_FAULT_BROWN_OUT);
    } else {
        /* nothing happens */
    }
}

static void test_a_board_that_is_not_set_to_stop_at_low_supply_stays_in_fail_safe_whatever_is_commanded(void) {
    option_bytes = ELMOPP_FLASH_OPTCR_BOR_LEV; /* as the factory leaves it: off */
    event = try_to_clear;
    run_ms(12000U);
    expect_fail_safe(ELMOPP_FAULT_BROWN_OUT);
    expect_said("brown-out reset: not at level 3");
    TEST_ASSERT_TRUE(frames_heard > 100U); /* it says so on the bus, too */
}

static void test_after_a_reset_by_the_watchdog_it_starts_in_fail_safe(void) {
    reset_flags = ELMOPP_RCC_CSR_IWDGRSTF | ELMOPP_RCC_CSR_PINRSTF;
    run_ms(3000U);
    expect_said("last reset:\r\nwatchdog\r\n");
    expect_fail_safe(ELMOPP_FAULT_PROCESSOR);
}

static void flood_begins(uint32_t now_ms) {
    if (now_ms == 50000U) {
        bxcan_model_break(BXCAN_FAULT_FLOOD, 0U, UINT32_MAX);
    }
}

static void test_a_flood_that_lets_nobody_else_speak_ends_in_fail_safe_with_ticks_on_time(void) {
    event = flood_begins;
    run_ms(60000U);
    TEST_ASSERT_TRUE(node.fail_safe);
    expect_said("fail-safe, the lamps flash; fault:\r\n");
    TEST_ASSERT_TRUE(longest_kick_ms <= 110U);
}

static void break_a_promise(uint32_t now_ms) {
    if (now_ms == 50000U) {
        elmopp_port_fail("a broken promise");
    }
}

static void test_a_run_that_ends_by_a_fault_is_off_the_bus_at_once(void) {
    event = break_a_promise;
    end_ms = 60000U;
    const int how = setjmp(end);
    if (how == 0) {
        elmopp_board_run(true);
    }
    TEST_ASSERT_EQUAL_INT(RESET, how);
    expect_said("stopped, begins anew:\r\na broken promise\r\n");
    TEST_ASSERT_EQUAL_HEX32(0x10002U, bxcan_model_read(0U)); /* as after its reset */
    for (uint32_t k = 0U; k < 400U; k++) {
        bxcan_model_pass_bits(BXCAN_MODEL_BITS_OF_MS);
        ms++;
        street_listens();
    }
    TEST_ASSERT_TRUE(node.fail_safe);
}

/* --- new weights over the bus --- */

#define IMAGE_BYTES (16U + (uint32_t)sizeof(elmopp_weights_t))

static uint8_t image[IMAGE_BYTES];
static uint32_t sent;      /* frames so far */
static uint32_t send_from; /* millisecond */

/* A segment a millisecond, as flow control lets him. */
static void send_weights(uint32_t now_ms) {
    if ((now_ms >= send_from) && (sent < segments_count(IMAGE_BYTES)) && (may_send > 0U)) {
        const elmopp_frame_t frame = segments_frame(image, IMAGE_BYTES, sent);
        bxcan_model_hear(&frame);
        sent++;
        may_send--;
    }
}

static void make_weights(void) {
    (void)memcpy(&image[16], &elmopp_weights_lstm, sizeof elmopp_weights_lstm);
    image[16U + sizeof elmopp_weights_lstm - 4U] ^= 1U;
    image_seal(image, "ELMW", ELMOPP_WEIGHTS_VERSION_NOW, (uint32_t)sizeof elmopp_weights_lstm);
    sent = 0U;
    may_send = 1U;
    send_from = 50000U;
}

static uint16_t weights_sent(void) {
    return (uint16_t)(~image_checksum(&image[16], (uint32_t)sizeof elmopp_weights_lstm) & 0xFFFU);
}

/* The flash that is erased at the first start, the words that are programmed while lamps run, and a start after it. */
static void test_weights_over_the_bus_run_are_kept_in_flash_and_are_there_after_a_reset_with_ticks_on_time(void) {
    board_site.chooser = (uint8_t)ELMOPP_CHOOSER_CUMULATIVE;
    board_site.forecast = (uint8_t)ELMOPP_FORECAST_LSTM;
    make_weights();
    event = send_weights;
    run_ms(80000U);
    TEST_ASSERT_EQUAL_UINT32(segments_count(IMAGE_BYTES), sent);
    TEST_ASSERT_EQUAL_UINT16(weights_sent(), status.weights_id); /* on trial */
    TEST_ASSERT_EQUAL_UINT32(4U, flash_model_erases());
    event = NULL;
    end_ms = ms;
    power_again();
    run_ms(30000U);
    TEST_ASSERT_TRUE(status.weights_id != weights_sent()); /* a reset in the trial: the old ones */
    make_weights();
    power_again();
    event = send_weights;
    send_from = 0U;
    run_ms(400000U);
    TEST_ASSERT_EQUAL_UINT16(weights_sent(), status.weights_id);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_FAULT_NONE, status.first_fault);
    TEST_ASSERT_TRUE(longest_kick_ms <= 110U);
    TEST_ASSERT_FALSE(node.fail_safe);
    event = NULL;
    power_again();
    run_ms(30000U);
    TEST_ASSERT_EQUAL_UINT16(weights_sent(), status.weights_id); /* they have outlived it */
    TEST_ASSERT_EQUAL_UINT32(4U, flash_model_erases());
    TEST_ASSERT_NULL_MESSAGE(flash_model_complaint(), flash_model_complaint());
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_with_crystal_and_can_it_brings_a_junction_up);
    RUN_TEST(test_with_cameras_it_runs_by_what_they_count);
    RUN_TEST(test_what_controllers_listen_to_is_let_through_and_simulated_time_is_not);
    RUN_TEST(test_one_bus_off_stops_no_junction);
    RUN_TEST(test_a_bus_that_destroys_everything_makes_lamps_flash_until_the_key_is_turned_and_the_fault_cleared);
    RUN_TEST(test_without_its_crystal_it_never_says_a_word_on_the_bus_and_the_lamps_flash);
    RUN_TEST(test_without_a_can_controller_it_says_so_and_the_lamps_flash);
    RUN_TEST(test_a_board_that_is_not_set_to_stop_at_low_supply_stays_in_fail_safe_whatever_is_commanded);
    RUN_TEST(test_after_a_reset_by_the_watchdog_it_starts_in_fail_safe);
    RUN_TEST(test_a_flood_that_lets_nobody_else_speak_ends_in_fail_safe_with_ticks_on_time);
    RUN_TEST(test_a_run_that_ends_by_a_fault_is_off_the_bus_at_once);
    RUN_TEST(test_weights_over_the_bus_run_are_kept_in_flash_and_are_there_after_a_reset_with_ticks_on_time);
    return UNITY_END();
}
