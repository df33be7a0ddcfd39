/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The link: what is believed, for every counter and every error of one or two bits; and the lamps' and faults' words.

#include "elmopp/fault.h"
#include "elmopp/lamps.h"
#include "elmopp/link.h"
#include "random.h"
#include "unity.h"

#include <string.h>

#define TIMEOUT_DS 4U
#define FRAME_BITS 64U
#define COUNTERS 16U

static elmopp_link_t link;

void setUp(void) {
    elmopp_link_init(&link);
}
void tearDown(void) {}

/* Every id of the bus that has a checksum. */
static const uint16_t ids[] = {0x080U, 0x090U, 0x091U, 0x097U, 0x100U, 0x101U, 0x107U, 0x110U,
                               0x180U, 0x190U, 0x197U, 0x1A0U, 0x1A7U, 0x200U, 0x7E0U, 0x7E1U};
#define IDS (sizeof ids / sizeof ids[0])

/* Bit by bit, from the definition: SAE J1850 over the id's two bytes and seven of the frame. */
static uint8_t checksum(uint16_t id, const uint8_t data[8]) {
    uint8_t message[9] = {(uint8_t)(id & 0xFFU), (uint8_t)(id >> 8U)};
    (void)memcpy(&message[2], data, 7U);
    uint32_t rest = 0xFFU;
    for (uint32_t bit = 0U; bit < 72U; bit++) {
        const uint32_t in = ((uint32_t)message[bit / 8U] >> (7U - (bit % 8U))) & 1U;
        const uint32_t out = (rest >> 7U) & 1U;
        rest = (rest << 1U) & 0xFFU;
        rest ^= ((in ^ out) != 0U) ? 0x1DU : 0U;
    }
    return (uint8_t)(rest ^ 0xFFU);
}

static elmopp_frame_t frame_of(uint16_t id, uint64_t payload, uint8_t counter) {
    elmopp_frame_t frame = {.id = id, .length = 8U};
    for (uint32_t i = 0U; i < 8U; i++) {
        frame.data[i] = (uint8_t)(payload >> (8U * i));
    }
    frame.data[0] = (uint8_t)((frame.data[0] & 0xF0U) | counter);
    frame.data[7] = checksum(id, frame.data);
    return frame;
}

static elmopp_link_verdict_t take(const elmopp_frame_t *frame, uint16_t id) {
    return elmopp_link_take(&link, frame, id, TIMEOUT_DS);
}

/* --- the checksum --- */

static void test_the_checksum_of_the_standards_message(void) {
    TEST_ASSERT_EQUAL_HEX8(0x4BU, elmopp_link_crc8((const uint8_t *)"123456789", 9U));
}

static void test_a_sealed_frame_has_length_counter_and_checksum(void) {
    uint8_t counter = 0U;
    for (uint32_t i = 0U; i < 40U; i++) {
        elmopp_frame_t frame = {.id = 0x180U, .length = 3U, .data = {0xA5U, 1U, 2U, 3U, 4U, 5U, 6U, 0xEEU}};
        elmopp_link_seal(&frame, &counter);
        TEST_ASSERT_EQUAL_UINT8(8U, frame.length);
        TEST_ASSERT_EQUAL_HEX8(0xA0U | (i % 15U), frame.data[0]);
        TEST_ASSERT_EQUAL_HEX8(checksum(0x180U, frame.data), frame.data[7]);
        TEST_ASSERT_EQUAL_HEX8(frame.data[7], elmopp_link_crc(0x180U, frame.data));
        TEST_ASSERT_EQUAL_INT(ELMOPP_LINK_OK, take(&frame, 0x180U));
    }
}

static void flip(elmopp_frame_t *frame, uint32_t bit) {
    frame->data[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
}

static void check_errors_of(elmopp_frame_t good) {
    for (uint32_t a = 0U; a < FRAME_BITS; a++) {
        for (uint32_t b = a; b < FRAME_BITS; b++) {
            elmopp_frame_t bad = good;
            flip(&bad, a);
            if (b != a) {
                flip(&bad, b);
            }
            TEST_ASSERT_EQUAL_INT(ELMOPP_LINK_CRC, take(&bad, good.id));
        }
    }
    TEST_ASSERT_FALSE(link.started);
}

static void test_every_error_of_one_or_two_bits_in_every_frame_is_found(void) {
    uint64_t seed = 11U;
    for (uint32_t i = 0U; i < IDS; i++) {
        check_errors_of(frame_of(ids[i], 0U, 0U));
        check_errors_of(frame_of(ids[i], UINT64_MAX, 14U));
        check_errors_of(frame_of(ids[i], random_next(&seed), 7U));
    }
}

static void test_a_frame_of_one_id_is_believed_at_no_other(void) {
    for (uint32_t i = 0U; i < IDS; i++) {
        for (uint32_t k = 0U; k < IDS; k++) {
            elmopp_frame_t frame = frame_of(ids[i], 0x123456789ABCU, 3U);
            TEST_ASSERT_EQUAL_INT((i == k) ? ELMOPP_LINK_OK : ELMOPP_LINK_FOREIGN, take(&frame, ids[k]));
            frame.id = ids[k]; /* ... nor if it claims to be one */
            setUp();
            TEST_ASSERT_EQUAL_INT((i == k) ? ELMOPP_LINK_OK : ELMOPP_LINK_CRC, take(&frame, ids[k]));
            setUp();
        }
    }
}

static void test_only_eight_bytes_are_a_frame(void) {
    for (uint32_t length = 0U; length < 256U; length++) {
        elmopp_frame_t frame = frame_of(0x100U, 0U, 0U);
        frame.length = (uint8_t)length;
        setUp();
        TEST_ASSERT_EQUAL_INT((length == 8U) ? ELMOPP_LINK_OK : ELMOPP_LINK_LENGTH, take(&frame, 0x100U));
    }
}

/* --- the counter --- */

/* Step by step: how many frames must have been lost for this counter to be next. */
static elmopp_link_verdict_t right_verdict(bool started, uint32_t age_ds, uint32_t last, uint32_t counter) {
    if (counter == 15U) {
        return ELMOPP_LINK_COUNTER;
    }
    if ((!started) || (age_ds >= TIMEOUT_DS)) {
        return ELMOPP_LINK_OK;
    }
    if (counter == last) {
        return ELMOPP_LINK_REPEATED;
    }
    uint32_t next = last;
    for (uint32_t lost = 0U; lost < ELMOPP_LINK_LOST_MAX; lost++) {
        next = (next == 14U) ? 0U : (next + 1U);
        if (next == counter) {
            return ELMOPP_LINK_OK;
        }
    }
    return ELMOPP_LINK_SEQUENCE;
}

static void check_counter(bool started, uint32_t age_ds, uint32_t last, uint32_t counter) {
    const elmopp_link_t before = {.age_ds = (uint16_t)age_ds, .counter = (uint8_t)last, .started = started};
    const elmopp_frame_t frame = frame_of(0x100U, 0x42U << 8U, (uint8_t)counter);
    link = before;
    const elmopp_link_verdict_t right = right_verdict(started, age_ds, last, counter);
    TEST_ASSERT_EQUAL_INT(right, take(&frame, 0x100U));
    const bool taken = right == ELMOPP_LINK_OK;
    TEST_ASSERT_EQUAL_UINT8(taken ? counter : last, link.counter);
    TEST_ASSERT_EQUAL_UINT16(taken ? 0U : age_ds, link.age_ds);
    TEST_ASSERT_EQUAL_INT(taken || started, link.started);
}

static void test_a_new_link_has_heard_nothing(void) {
    memset(&link, 0x5A, sizeof link);
    elmopp_link_init(&link);
    TEST_ASSERT_FALSE(link.started);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, link.age_ds);
    TEST_ASSERT_EQUAL_UINT8(0U, link.counter);
}

static void test_every_counter_after_every_other_at_every_age(void) {
    static const uint32_t ages[] = {0U, 1U, TIMEOUT_DS - 1U, TIMEOUT_DS, TIMEOUT_DS + 1U, UINT16_MAX};
    for (uint32_t a = 0U; a < 6U; a++) {
        for (uint32_t last = 0U; last < ELMOPP_LINK_COUNTERS; last++) {
            for (uint32_t counter = 0U; counter < COUNTERS; counter++) {
                check_counter(true, ages[a], last, counter);
                check_counter(false, ages[a], last, counter);
            }
        }
    }
}

static void test_the_age_counts_ticks_and_saturates(void) {
    const elmopp_frame_t frame = frame_of(0x100U, 0U, 0U);
    TEST_ASSERT_FALSE(elmopp_link_fresh(&link, UINT16_MAX));
    (void)take(&frame, 0x100U);
    for (uint32_t i = 0U; i < TIMEOUT_DS; i++) {
        TEST_ASSERT_TRUE(elmopp_link_fresh(&link, TIMEOUT_DS));
        elmopp_link_tick(&link);
    }
    TEST_ASSERT_FALSE(elmopp_link_fresh(&link, TIMEOUT_DS));
    for (uint32_t i = 0U; i < 70000U; i++) {
        elmopp_link_tick(&link);
    }
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, link.age_ds);
    TEST_ASSERT_FALSE(elmopp_link_fresh(&link, UINT16_MAX));
}

/* --- a frame by itself --- */

static void test_whole_is_what_the_first_frame_of_a_link_is_believed_for(void) {
    for (uint32_t i = 0U; i < IDS; i++) {
        for (uint32_t counter = 0U; counter < COUNTERS; counter++) {
            elmopp_frame_t frame = frame_of(ids[i], 0x123456789ABCU, (uint8_t)counter);
            const bool right = counter < ELMOPP_LINK_COUNTERS;
            TEST_ASSERT_EQUAL(right, elmopp_link_is_whole(&frame));
            setUp();
            TEST_ASSERT_EQUAL(right, take(&frame, frame.id) == ELMOPP_LINK_OK);
            frame.id = ids[(i + 1U) % IDS];
            TEST_ASSERT_FALSE(elmopp_link_is_whole(&frame));
        }
    }
}

static void test_a_frame_that_was_shortened_or_changed_is_not_whole(void) {
    const elmopp_frame_t good = frame_of(0x080U, 0x123456789ABCU, 3U);
    for (uint32_t length = 0U; length < 256U; length++) {
        elmopp_frame_t frame = good;
        frame.length = (uint8_t)length;
        TEST_ASSERT_EQUAL(length == 8U, elmopp_link_is_whole(&frame));
    }
    for (uint32_t bit = 0U; bit < FRAME_BITS; bit++) {
        elmopp_frame_t frame = good;
        flip(&frame, bit);
        TEST_ASSERT_FALSE(elmopp_link_is_whole(&frame));
    }
}

/* --- words --- */

static void test_lamps_and_aspects_are_the_same_thing_for_every_group(void) {
    for (uint32_t g = 0U; g < ELMOPP_GROUP_MAX; g++) {
        for (uint32_t aspect = 0U; aspect < (uint32_t)ELMOPP_ASPECT_COUNT; aspect++) {
            elmopp_lamps_t lamps = {0xFFFFU, 0U, 0x5555U, 0xAAAAU};
            const elmopp_lamps_t before = lamps;
            const uint16_t others = (uint16_t)~(1U << g);
            elmopp_lamps_show(&lamps, g, (elmopp_aspect_t)aspect);
            TEST_ASSERT_EQUAL_INT(aspect, elmopp_lamps_aspect(&lamps, g));
            TEST_ASSERT_EQUAL_HEX16(before.red & others, lamps.red & others);
            TEST_ASSERT_EQUAL_HEX16(before.amber & others, lamps.amber & others);
            TEST_ASSERT_EQUAL_HEX16(before.green & others, lamps.green & others);
            TEST_ASSERT_EQUAL_HEX16(before.flash & others, lamps.flash & others);
        }
    }
}

static void test_seven_of_sixteen_combinations_of_lamps_are_aspects(void) {
    static const elmopp_aspect_t right[16] = {
        [0] = ELMOPP_ASPECT_DARK,      [1] = ELMOPP_ASPECT_RED,          [2] = ELMOPP_ASPECT_AMBER,
        [3] = ELMOPP_ASPECT_RED_AMBER, [4] = ELMOPP_ASPECT_GREEN,        [5] = ELMOPP_ASPECT_COUNT,
        [6] = ELMOPP_ASPECT_COUNT,     [7] = ELMOPP_ASPECT_COUNT,        [8] = ELMOPP_ASPECT_COUNT,
        [9] = ELMOPP_ASPECT_FLASH_RED, [10] = ELMOPP_ASPECT_FLASH_AMBER, [11] = ELMOPP_ASPECT_COUNT,
        [12] = ELMOPP_ASPECT_COUNT,    [13] = ELMOPP_ASPECT_COUNT,       [14] = ELMOPP_ASPECT_COUNT,
        [15] = ELMOPP_ASPECT_COUNT};
    for (uint32_t bits = 0U; bits < 16U; bits++) {
        const elmopp_lamps_t lamps = {(uint16_t)(bits & 1U), (uint16_t)((bits >> 1U) & 1U),
                                      (uint16_t)((bits >> 2U) & 1U), (uint16_t)(bits >> 3U)};
        TEST_ASSERT_EQUAL_INT(right[bits], elmopp_lamps_aspect(&lamps, 0U));
    }
    elmopp_lamps_t lamps = {1U, 1U, 1U, 1U};
    elmopp_lamps_show(&lamps, 0U, (elmopp_aspect_t)7);
    TEST_ASSERT_EQUAL_INT(ELMOPP_ASPECT_DARK, elmopp_lamps_aspect(&lamps, 0U));
}

static void test_every_fault_has_a_name_of_its_own(void) {
    for (uint32_t a = 0U; a < 256U; a++) {
        const char *name = elmopp_fault_name((elmopp_fault_t)a);
        TEST_ASSERT_NOT_NULL(name);
        for (uint32_t b = 0U; b < a; b++) {
            const char *other = elmopp_fault_name((elmopp_fault_t)b);
            TEST_ASSERT_TRUE((strcmp(name, other) != 0) || (strcmp(name, "unknown fault") == 0));
        }
    }
    TEST_ASSERT_EQUAL_STRING("none", elmopp_fault_name(ELMOPP_FAULT_NONE));
    TEST_ASSERT_EQUAL_STRING("processor", elmopp_fault_name(ELMOPP_FAULT_PROCESSOR));
    TEST_ASSERT_EQUAL_STRING("unknown fault", elmopp_fault_name(ELMOPP_FAULT_COUNT));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_checksum_of_the_standards_message);
    RUN_TEST(test_a_sealed_frame_has_length_counter_and_checksum);
    RUN_TEST(test_every_error_of_one_or_two_bits_in_every_frame_is_found);
    RUN_TEST(test_a_frame_of_one_id_is_believed_at_no_other);
    RUN_TEST(test_only_eight_bytes_are_a_frame);
    RUN_TEST(test_a_new_link_has_heard_nothing);
    RUN_TEST(test_every_counter_after_every_other_at_every_age);
    RUN_TEST(test_the_age_counts_ticks_and_saturates);
    RUN_TEST(test_whole_is_what_the_first_frame_of_a_link_is_believed_for);
    RUN_TEST(test_a_frame_that_was_shortened_or_changed_is_not_whole);
    RUN_TEST(test_lamps_and_aspects_are_the_same_thing_for_every_group);
    RUN_TEST(test_seven_of_sixteen_combinations_of_lamps_are_aspects);
    RUN_TEST(test_every_fault_has_a_name_of_its_own);
    return UNITY_END();
}
