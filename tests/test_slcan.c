/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The adaptor's side of SLCAN, held against the text of the CAN232 manual, not against the room's other half.

#include "slcan.h"

#include "random.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

static elmopp_slcan_t adaptor;
static elmopp_slcan_event_t event;
static uint32_t frames;

void setUp(void) {
    elmopp_slcan_init(&adaptor);
    frames = 0U;
}
void tearDown(void) {}

/* All answers to this text, one after the other. */
static const char *answer_to(const char *text) {
    static char answers[256];
    uint32_t length = 0U;
    for (uint32_t k = 0U; text[k] != '\0'; k++) {
        elmopp_slcan_take(&adaptor, text[k], &event);
        TEST_ASSERT_TRUE((length + event.answer_length) < sizeof answers);
        (void)memcpy(&answers[length], event.answer, event.answer_length);
        length += event.answer_length;
        frames += event.has_frame ? 1U : 0U;
    }
    answers[length] = '\0';
    return answers;
}

static void expect(const char *text, const char *answer) {
    TEST_ASSERT_EQUAL_STRING(answer, answer_to(text));
}

static void test_a_channel_opens_and_closes_once(void) {
    expect("C\r", "\a");
    expect("S6\r", "\r");
    expect("O\r", "\r");
    expect("O\r", "\a");
    expect("L\r", "\a");
    expect("C\r", "\r");
    expect("C\r", "\a");
    TEST_ASSERT_EQUAL_UINT32(0U, adaptor.dropped); /* all of them commands, if at the wrong time */
}

static void test_only_the_bit_rate_of_the_bus_is_taken(void) {
    for (char rate = '0'; rate <= '9'; rate++) {
        const char command[] = {'S', rate, '\r', '\0'};
        expect(command, (rate == '6') ? "\r" : "\a");
        expect("O\r", (rate == '6') ? "\r" : "\a");
        expect("C\r", (rate == '6') ? "\r" : "\a");
    }
    expect("s031C\r", "\a");
    expect("O\r", "\a");
    expect("s001C\r", "\r");
    expect("O\r", "\r");
    expect("S6\r", "\a"); /* not while it is open */
}

static void test_a_frame_is_acknowledged_and_told(void) {
    static const uint8_t data[3] = {0x01U, 0xABU, 0xFFU};
    expect("O\r", "\r");
    expect("t7E0301abFF\r", "z\r");
    TEST_ASSERT_EQUAL_UINT32(1U, frames);
    TEST_ASSERT_EQUAL_HEX16(0x7E0U, event.frame.id);
    TEST_ASSERT_EQUAL_UINT8(3U, event.frame.length);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(data, event.frame.data, 3U);
    expect("t0000\r", "z\r");
    expect("t7FF81122334455667788\r", "z\r");
    expect("t12301234\r", "z\r"); /* with a time stamp */
    TEST_ASSERT_EQUAL_UINT32(4U, frames);
}

static void test_long_and_remote_frames_go_to_a_bus_where_nobody_listens(void) {
    expect("O\r", "\r");
    expect("T1FFFFFFF81122334455667788\r", "Z\r");
    expect("r1238\r", "z\r");
    expect("R000001238\r", "Z\r");
    TEST_ASSERT_EQUAL_UINT32(0U, frames);
    TEST_ASSERT_EQUAL_UINT32(0U, adaptor.dropped);
}

static void test_a_garbled_line_is_refused_and_counted_and_the_next_one_is_good(void) {
    static const char *const garbled[] = {
        "t12\r",           "t123\r",        "t1239\r",    "t800111\r",  "t12g111\r", "t1232112\r",
        "t123111223344\r", "T2000000000\r", "t123 11\r",  "tt123111\r", "Q\r",       "S\r",
        "S66\r",           "s12\r",         "O1\r",       "Z2\r",       "X0\r",      "x\r",
        "M123\r",          "t1\n230\r",     "\x80\xFF\r", "t12311\a1\r"};
    const uint32_t count = (uint32_t)(sizeof garbled / sizeof garbled[0]);
    expect("O\r", "\r");
    for (uint32_t k = 0U; k < count; k++) {
        TEST_ASSERT_EQUAL_STRING_MESSAGE("\a", answer_to(garbled[k]), garbled[k]);
        expect("t123111\r", "z\r");
    }
    TEST_ASSERT_EQUAL_UINT32(count, adaptor.dropped);
    TEST_ASSERT_EQUAL_UINT32(count, frames);
}

static void test_a_line_of_any_length_is_refused_once(void) {
    char line[200];
    expect("O\r", "\r");
    for (uint32_t length = ELMOPP_SLCAN_LINE_MAX + 1U; length < (sizeof line - 2U); length++) {
        (void)memset(line, '1', length);
        line[0] = 't';
        line[length] = '\r';
        line[length + 1U] = '\0';
        expect(line, "\a");
        expect("t123111\r", "z\r");
    }
}

static void test_a_frame_that_is_cut_spoils_itself_and_the_one_that_it_runs_into(void) {
    expect("O\r", "\r");
    expect("t12381122t123111\r", "\a");
    expect("t123111\r", "z\r");
    TEST_ASSERT_EQUAL_UINT32(1U, frames);
}

static void test_no_frame_passes_a_closed_channel_or_one_that_listens(void) {
    expect("t123111\r", "\a");
    expect("L\r", "\r");
    expect("t123111\r", "\a");
    TEST_ASSERT_EQUAL_UINT32(0U, frames);
    TEST_ASSERT_EQUAL_UINT32(0U, adaptor.dropped);
}

static void test_status_flags_are_told_once(void) {
    expect("F\r", "\a");
    expect("O\r", "\r");
    expect("F\r", "F00\r");
    elmopp_slcan_flag(&adaptor, ELMOPP_SLCAN_OVERRUN);
    elmopp_slcan_flag(&adaptor, ELMOPP_SLCAN_SEND_FULL);
    expect("F\r", "F0A\r");
    expect("F\r", "F00\r");
}

static void test_a_filter_is_taken_only_if_it_hides_nothing(void) {
    expect("M00000000\r", "\r");
    expect("mFFFFFFFF\r", "\r");
    expect("M00000001\r", "\a");
    expect("m00000000\r", "\a");
    expect("O\r", "\r");
    expect("M00000000\r", "\a");
}

static void test_version_number_and_empty_lines(void) {
    expect("V\r", "V1013\r");
    expect("N\r", "NE386\r");
    expect("\r\r\n\r", "");
    expect("\nV\r", "V1013\r");
    expect("X1\r", "\r");
}

static const char *said(const elmopp_frame_t *frame, uint32_t now_ms) {
    static char text[ELMOPP_SLCAN_TEXT_MAX + 1U];
    text[elmopp_slcan_say(&adaptor, frame, now_ms, text)] = '\0';
    return text;
}

static void test_what_the_bus_carries_is_said_while_the_channel_is_open(void) {
    const elmopp_frame_t frame = {.id = 0x80U, .length = 8U, .data = {0x01U, 0x2AU, 0U, 0U, 0U, 0U, 0U, 0xF0U}};
    TEST_ASSERT_EQUAL_STRING("", said(&frame, 0U));
    expect("Z1\r", "\r");
    expect("L\r", "\r");
    TEST_ASSERT_EQUAL_STRING("t0808012A0000000000F0EA5F\r", said(&frame, 119999U));
    expect("C\r", "\r");
    expect("Z0\r", "\r");
    expect("O\r", "\r");
    TEST_ASSERT_EQUAL_STRING("t0808012A0000000000F0\r", said(&frame, 119999U));
}

static void test_every_frame_comes_back_as_it_was(void) {
    uint64_t seed = 1U;
    for (uint32_t k = 0U; k < 2000U; k++) {
        elmopp_frame_t frame = {.id = (uint16_t)random_below(&seed, 0x800U),
                                .length = (uint8_t)random_below(&seed, 9U)};
        for (uint32_t i = 0U; i < frame.length; i++) {
            frame.data[i] = (uint8_t)random_below(&seed, 256U);
        }
        char text[ELMOPP_SLCAN_TEXT_MAX];
        elmopp_frame_t read = {.id = 0U, .length = 0U, .data = {0U}};
        TEST_ASSERT_TRUE(elmopp_slcan_read(text, elmopp_slcan_write(&frame, text), &read));
        TEST_ASSERT_EQUAL_HEX16(frame.id, read.id);
        TEST_ASSERT_EQUAL_UINT8(frame.length, read.length);
        TEST_ASSERT_EQUAL_HEX8_ARRAY(frame.data, read.data, ELMOPP_LINK_BYTES);
    }
    elmopp_frame_t untouched = {.id = 5U, .length = 0U, .data = {0U}};
    TEST_ASSERT_FALSE(elmopp_slcan_read("z", 1U, &untouched));
    TEST_ASSERT_FALSE(elmopp_slcan_read("", 0U, &untouched));
    TEST_ASSERT_FALSE(elmopp_slcan_read("T000001230", 10U, &untouched));
    TEST_ASSERT_EQUAL_HEX16(5U, untouched.id);
}

/* One answer to every line that is not empty, none to anything else; a frame only behind a line that began with t. */
static void test_rubbish_is_answered_line_by_line_and_makes_no_frame(void) {
    uint64_t seed = 2U;
    expect("O\r", "\r");
    uint32_t answers = 0U;
    uint32_t lines = 0U;
    char before = '\r';
    for (uint32_t k = 0U; k < 200000U; k++) {
        const char character = (char)random_below(&seed, 256U);
        elmopp_slcan_take(&adaptor, character, &event);
        answers += (event.answer_length > 0U) ? 1U : 0U;
        TEST_ASSERT_FALSE(event.has_frame);
        const bool begins = before == '\r';
        lines += ((character == '\r') && (!begins)) ? 1U : 0U;
        before = (begins && (character == '\n')) ? before : character;
    }
    TEST_ASSERT_EQUAL_UINT32(lines, answers);
    TEST_ASSERT_TRUE(adaptor.open || (adaptor.dropped > 0U));
    (void)printf("%u lines of rubbish, %u dropped\n", (unsigned)lines, (unsigned)adaptor.dropped);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_channel_opens_and_closes_once);
    RUN_TEST(test_only_the_bit_rate_of_the_bus_is_taken);
    RUN_TEST(test_a_frame_is_acknowledged_and_told);
    RUN_TEST(test_long_and_remote_frames_go_to_a_bus_where_nobody_listens);
    RUN_TEST(test_a_garbled_line_is_refused_and_counted_and_the_next_one_is_good);
    RUN_TEST(test_a_line_of_any_length_is_refused_once);
    RUN_TEST(test_a_frame_that_is_cut_spoils_itself_and_the_one_that_it_runs_into);
    RUN_TEST(test_no_frame_passes_a_closed_channel_or_one_that_listens);
    RUN_TEST(test_status_flags_are_told_once);
    RUN_TEST(test_a_filter_is_taken_only_if_it_hides_nothing);
    RUN_TEST(test_version_number_and_empty_lines);
    RUN_TEST(test_what_the_bus_carries_is_said_while_the_channel_is_open);
    RUN_TEST(test_every_frame_comes_back_as_it_was);
    RUN_TEST(test_rubbish_is_answered_line_by_line_and_makes_no_frame);
    return UNITY_END();
}
