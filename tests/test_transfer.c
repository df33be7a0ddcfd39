/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Segments that come as they were sent are put together; whatever else comes ends the transfer or changes nothing, and
/// a bit that is changed on the way is found by the image's checksum.

#include "elmopp/transfer.h"

#include "assert_catcher.h"
#include "elmopp/image.h"
#include "image_writer.h"
#include "segments.h"
#include "unity.h"

#include <string.h>

#define LONGEST 34500U
#define BODY_BYTES 2212U
#define IMAGE_BYTES (16U + BODY_BYTES)

#ifndef BIT_STRIDE
#define BIT_STRIDE 1U
#endif
#ifndef DOUBLE_ERRORS
#define DOUBLE_ERRORS 20000U
#endif

static elmopp_transfer_t transfer;
static uint8_t sent[LONGEST + 100U];
static uint8_t got[LONGEST + 100U];

void setUp(void) {
    for (uint32_t i = 0U; i < sizeof sent; i++) {
        sent[i] = (uint8_t)((i * 37U) + (i >> 8U));
    }
    (void)memset(got, 0xA5, sizeof got);
    elmopp_transfer_init(&transfer);
}

void tearDown(void) {}

static elmopp_transfer_verdict_t offer(uint32_t length, uint32_t index) {
    const elmopp_frame_t frame = segments_frame(sent, length, index);
    return elmopp_transfer_take(&transfer, &frame);
}

static bool lets_go_on(void) {
    elmopp_frame_t frame = {0U, 0U, {0U}};
    if (!elmopp_transfer_flow(&transfer, &frame)) {
        return false;
    }
    TEST_ASSERT_EQUAL_HEX16(SEGMENTS_ACK, frame.id);
    TEST_ASSERT_EQUAL_UINT8(8U, frame.length);
    TEST_ASSERT_EQUAL_HEX8(0x30U, frame.data[0]);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_TRANSFER_BLOCK, frame.data[1]);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_TRANSFER_GAP_MS, frame.data[2]);
    return true;
}

static void begin(uint32_t length) {
    const elmopp_frame_t first = segments_frame(sent, length, 0U);
    TEST_ASSERT_EQUAL_UINT32(length, elmopp_transfer_announced(&first));
    elmopp_transfer_begin(&transfer, &first, got);
    TEST_ASSERT_TRUE(lets_go_on());
}

/* Sends frames from `from` until before `to`, as a sender does that heeds flow control. */
static void go_on(uint32_t length, uint32_t from, uint32_t to) {
    for (uint32_t index = from; index < to; index++) {
        const bool last = index == (segments_count(length) - 1U);
        TEST_ASSERT_EQUAL_INT(last ? ELMOPP_TRANSFER_WHOLE : ELMOPP_TRANSFER_TAKEN, offer(length, index));
        TEST_ASSERT_EQUAL(((index % ELMOPP_TRANSFER_BLOCK) == 0U) && (!last), lets_go_on());
    }
}

static void test_any_length_comes_over_byte_for_byte_and_nothing_beyond_it_is_touched(void) {
    static const uint32_t lengths[] = {8U,   9U,    12U,   13U,   14U,   19U,   20U,    21U,     111U,
                                       112U, 2228U, 4094U, 4095U, 4096U, 4097U, 34499U, LONGEST, LONGEST + 50U};
    for (uint32_t i = 0U; i < (sizeof lengths / sizeof lengths[0]); i++) {
        setUp();
        begin(lengths[i]);
        go_on(lengths[i], 1U, segments_count(lengths[i]));
        TEST_ASSERT_FALSE(transfer.receiving);
        TEST_ASSERT_EQUAL_MEMORY(sent, got, lengths[i]);
        TEST_ASSERT_EQUAL_HEX8(0xA5U, got[lengths[i]]);
    }
}

static uint32_t announced(const uint8_t data[8], uint16_t id, uint8_t length) {
    elmopp_frame_t frame = {.id = id, .length = length, .data = {0U}};
    (void)memcpy(frame.data, data, 8U);
    return elmopp_transfer_announced(&frame);
}

static void test_only_a_first_frame_of_the_standard_announces_a_length(void) {
    static const uint8_t whole[8] = {0x18U, 0xB4U, 1U, 2U, 3U, 4U, 5U, 6U};
    static const uint8_t none[][8] = {{0x07U, 1U, 2U, 3U, 4U, 5U, 6U, 7U},       /* single */
                                      {0x21U, 1U, 2U, 3U, 4U, 5U, 6U, 7U},       /* consecutive */
                                      {0x30U, 0U, 0U, 0U, 0U, 0U, 0U, 0U},       /* flow */
                                      {0x10U, 0x07U, 2U, 3U, 4U, 5U, 6U, 7U},    /* fits into a single one */
                                      {0x10U, 0U, 0U, 0U, 0x0FU, 0xFFU, 6U, 7U}, /* 4095 needs no 32 bits */
                                      {0x10U, 0U, 0U, 0U, 0U, 0U, 6U, 7U},
                                      {0x40U, 0x10U, 2U, 3U, 4U, 5U, 6U, 7U}};
    static const uint8_t huge[8] = {0x10U, 0U, 0xFFU, 0xFFU, 0xFFU, 0xFFU, 0U, 0U};
    TEST_ASSERT_EQUAL_UINT32(2228U, announced(whole, SEGMENTS_TRANSFER, 8U));
    TEST_ASSERT_EQUAL_UINT32(0U, announced(whole, SEGMENTS_ACK, 8U));
    TEST_ASSERT_EQUAL_UINT32(0U, announced(whole, SEGMENTS_TRANSFER, 7U));
    TEST_ASSERT_EQUAL_HEX32(0xFFFFFFFFU, announced(huge, SEGMENTS_TRANSFER, 8U));
    for (uint32_t i = 0U; i < (sizeof none / sizeof none[0]); i++) {
        TEST_ASSERT_EQUAL_UINT32(0U, announced(none[i], SEGMENTS_TRANSFER, 8U));
    }
}

static void test_a_segment_that_is_lost_repeated_or_late_ends_the_transfer_wherever_it_is(void) {
    const uint32_t count = segments_count(IMAGE_BYTES);
    for (uint32_t index = 1U; index < (count - 1U); index++) {
        for (int32_t off = -2; off <= 2; off++) {
            if ((off != 0) && (((int32_t)index + off) >= 1)) {
                setUp();
                begin(IMAGE_BYTES);
                go_on(IMAGE_BYTES, 1U, index);
                TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_BROKEN, offer(IMAGE_BYTES, (uint32_t)((int32_t)index + off)));
                TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_STRANGE, offer(IMAGE_BYTES, index));
                TEST_ASSERT_FALSE(lets_go_on());
            }
        }
    }
}

static void test_a_segment_that_is_too_short_ends_the_transfer_and_an_unpadded_last_one_does_not(void) {
    begin(IMAGE_BYTES);
    elmopp_frame_t frame = segments_frame(sent, IMAGE_BYTES, 1U);
    frame.length = 7U;
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_BROKEN, elmopp_transfer_take(&transfer, &frame));
    setUp();
    begin(9U);
    frame = segments_frame(sent, 9U, 1U);
    frame.length = 4U;
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_WHOLE, elmopp_transfer_take(&transfer, &frame));
}

static void test_who_does_not_wait_for_flow_control_is_not_listened_to(void) {
    begin(IMAGE_BYTES);
    for (uint32_t index = 1U; index <= ELMOPP_TRANSFER_BLOCK; index++) {
        TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_TAKEN, offer(IMAGE_BYTES, index));
    }
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_BROKEN, offer(IMAGE_BYTES, ELMOPP_TRANSFER_BLOCK + 1U));
}

static void test_after_a_second_of_silence_the_transfer_has_ended_and_a_segment_in_time_goes_on(void) {
    begin(IMAGE_BYTES);
    for (uint32_t k = 1U; k < 5U; k++) {
        for (uint32_t i = 0U; i < (ELMOPP_TRANSFER_TIMEOUT_DS - 1U); i++) {
            TEST_ASSERT_TRUE(elmopp_transfer_tick(&transfer));
        }
        TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_TAKEN, offer(IMAGE_BYTES, k));
    }
    for (uint32_t i = 0U; i < (ELMOPP_TRANSFER_TIMEOUT_DS - 1U); i++) {
        TEST_ASSERT_TRUE(elmopp_transfer_tick(&transfer));
    }
    TEST_ASSERT_FALSE(elmopp_transfer_tick(&transfer));
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_STRANGE, offer(IMAGE_BYTES, 5U));
    TEST_ASSERT_TRUE(elmopp_transfer_tick(&transfer)); /* it is told once */
}

static void test_frames_that_nobody_waits_for_change_nothing(void) {
    static const uint8_t types[] = {0x07U, 0x18U, 0x30U, 0x41U, 0xF1U};
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_STRANGE, offer(IMAGE_BYTES, 1U));
    begin(IMAGE_BYTES);
    go_on(IMAGE_BYTES, 1U, 20U);
    const elmopp_transfer_t before = transfer;
    for (uint32_t i = 0U; i < sizeof types; i++) {
        elmopp_frame_t frame = segments_frame(sent, IMAGE_BYTES, 20U);
        frame.data[0] = types[i];
        TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_STRANGE, elmopp_transfer_take(&transfer, &frame));
    }
    elmopp_frame_t frame = segments_frame(sent, IMAGE_BYTES, 20U);
    frame.length = 0U;
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_STRANGE, elmopp_transfer_take(&transfer, &frame));
    frame = segments_frame(sent, IMAGE_BYTES, 20U);
    frame.id = SEGMENTS_ACK;
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_STRANGE, elmopp_transfer_take(&transfer, &frame));
    TEST_ASSERT_EQUAL_MEMORY(&before, &transfer, sizeof transfer);
    go_on(IMAGE_BYTES, 20U, segments_count(IMAGE_BYTES));
    TEST_ASSERT_EQUAL_MEMORY(sent, got, IMAGE_BYTES);
}

static void test_to_begin_without_a_first_frame_is_a_bug(void) {
    const elmopp_frame_t frame = segments_frame(sent, IMAGE_BYTES, 1U);
    TEST_EXPECT_ASSERT(elmopp_transfer_begin(&transfer, &frame, got));
}

static void test_every_report_comes_back_as_it_was_made(void) {
    for (uint32_t kind = 0U; kind <= 2U; kind++) {
        for (uint32_t state = 0U; state <= 6U; state++) {
            for (uint32_t reason = 0U; reason <= 17U; reason++) {
                const elmopp_transfer_report_t report = {.kind = (elmopp_transfer_kind_t)kind,
                                                         .state = (elmopp_transfer_state_t)state,
                                                         .reason = (elmopp_transfer_reason_t)reason,
                                                         .first = (uint8_t)(reason + 7U),
                                                         .second = (uint8_t)(200U + state),
                                                         .left_s = (uint16_t)(0x0102U * (reason + 1U)),
                                                         .saved = (uint8_t)(kind + 3U)};
                elmopp_transfer_report_t back;
                const elmopp_frame_t frame = elmopp_transfer_make_report(&report);
                TEST_ASSERT_EQUAL_HEX8(0x07U, frame.data[0]); /* a single frame of seven bytes */
                TEST_ASSERT_TRUE(elmopp_transfer_read_report(&frame, &back));
                TEST_ASSERT_TRUE((back.kind == report.kind) && (back.state == report.state) &&
                                 (back.reason == report.reason) && (back.first == report.first) &&
                                 (back.second == report.second) && (back.left_s == report.left_s) &&
                                 (back.saved == report.saved));
            }
        }
    }
    elmopp_transfer_report_t none;
    static const uint8_t unknown[3][2] = {{0x13U, 0U}, {0x71U, 0U}, {0x11U, 18U}}; /* kind, state, reason */
    for (uint32_t i = 0U; i < 3U; i++) {
        const elmopp_frame_t frame = {SEGMENTS_ACK, 8U, {0x07U, unknown[i][0], unknown[i][1], 0U, 0U, 0U, 0U, 0U}};
        TEST_ASSERT_FALSE(elmopp_transfer_read_report(&frame, &none));
    }
    begin(IMAGE_BYTES);
    go_on(IMAGE_BYTES, 1U, ELMOPP_TRANSFER_BLOCK);
    TEST_ASSERT_EQUAL_INT(ELMOPP_TRANSFER_TAKEN, offer(IMAGE_BYTES, ELMOPP_TRANSFER_BLOCK));
    elmopp_frame_t flow = {0U, 0U, {0U}};
    TEST_ASSERT_TRUE(elmopp_transfer_flow(&transfer, &flow));
    TEST_ASSERT_FALSE(elmopp_transfer_read_report(&flow, &none));
}

/* --- changed on the way --- */

static const elmopp_image_kind_t kind = {{0x54U, 0x45U, 0x53U, 0x54U}, 1U, BODY_BYTES};

/* True if what comes over with these bits changed would be taken for good. A bit counts from the first frame's first.
 */
static bool passes(uint32_t bit, uint32_t other) {
    elmopp_transfer_verdict_t verdict = ELMOPP_TRANSFER_TAKEN;
    elmopp_transfer_init(&transfer);
    for (uint32_t index = 0U; (index < segments_count(IMAGE_BYTES)) && (verdict == ELMOPP_TRANSFER_TAKEN); index++) {
        elmopp_frame_t frame = segments_frame(sent, IMAGE_BYTES, index);
        frame.data[(bit / 8U) % 8U] ^= (uint8_t)(((bit / 64U) == index) ? (1U << (bit % 8U)) : 0U);
        frame.data[(other / 8U) % 8U] ^= (uint8_t)(((other / 64U) == index) ? (1U << (other % 8U)) : 0U);
        elmopp_frame_t flow;
        if (index > 0U) {
            verdict = elmopp_transfer_take(&transfer, &frame);
        } else if (elmopp_transfer_announced(&frame) == IMAGE_BYTES) {
            elmopp_transfer_begin(&transfer, &frame, got);
        } else {
            return false;
        }
        (void)elmopp_transfer_flow(&transfer, &flow);
    }
    return (verdict == ELMOPP_TRANSFER_WHOLE) && (elmopp_image_check(&kind, got, IMAGE_BYTES) == ELMOPP_IMAGE_OK);
}

static void test_every_bit_that_is_changed_on_the_way_is_found_and_every_two_that_were_tried(void) {
    const uint32_t frames = segments_count(IMAGE_BYTES);
    const uint32_t spare = 8U * (((frames - 1U) * 7U) + 6U - IMAGE_BYTES); /* behind the last byte: padding */
    const uint32_t bits = (64U * frames) - spare;
    image_seal(sent, "TEST", 1U, BODY_BYTES);
    TEST_ASSERT_TRUE(passes(UINT32_MAX, UINT32_MAX));
    for (uint32_t bit = 0U; bit < bits; bit += BIT_STRIDE) {
        TEST_ASSERT_FALSE_MESSAGE(passes(bit, UINT32_MAX), "a changed bit");
    }
    uint32_t seed = 12345U;
    for (uint32_t i = 0U; i < DOUBLE_ERRORS; i++) {
        seed = (seed * 1664525U) + 1013904223U;
        const uint32_t one = (seed >> 8U) % bits;
        seed = (seed * 1664525U) + 1013904223U;
        const uint32_t two = (seed >> 8U) % bits;
        if (one != two) {
            TEST_ASSERT_FALSE_MESSAGE(passes(one, two), "two changed bits");
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_any_length_comes_over_byte_for_byte_and_nothing_beyond_it_is_touched);
    RUN_TEST(test_only_a_first_frame_of_the_standard_announces_a_length);
    RUN_TEST(test_a_segment_that_is_lost_repeated_or_late_ends_the_transfer_wherever_it_is);
    RUN_TEST(test_a_segment_that_is_too_short_ends_the_transfer_and_an_unpadded_last_one_does_not);
    RUN_TEST(test_who_does_not_wait_for_flow_control_is_not_listened_to);
    RUN_TEST(test_after_a_second_of_silence_the_transfer_has_ended_and_a_segment_in_time_goes_on);
    RUN_TEST(test_frames_that_nobody_waits_for_change_nothing);
    RUN_TEST(test_to_begin_without_a_first_frame_is_a_bug);
    RUN_TEST(test_every_report_comes_back_as_it_was_made);
    RUN_TEST(test_every_bit_that_is_changed_on_the_way_is_found_and_every_two_that_were_tried);
    return UNITY_END();
}
