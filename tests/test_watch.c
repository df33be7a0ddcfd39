/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/watch.h"
#include "unity.h"

#include <stddef.h>

#define LENGTH_MAX ((2U * ELMOPP_WATCH_PIECE_BYTES) + 1U)

static uint8_t bytes[LENGTH_MAX];

void setUp(void) {
    for (uint32_t i = 0U; i < LENGTH_MAX; i++) {
        bytes[i] = (uint8_t)(i * 7U);
    }
}
void tearDown(void) {}

static uint32_t pieces_of(uint32_t length) {
    return (length + ELMOPP_WATCH_PIECE_BYTES - 1U) / ELMOPP_WATCH_PIECE_BYTES;
}

/* Pieces until the watch complains; `limit` if it does not. */
static uint32_t pieces_until_seen(elmopp_watch_t *watch, uint32_t limit) {
    uint32_t piece = 0U;
    while ((piece < limit) && elmopp_watch_is_unchanged(watch)) {
        piece++;
    }
    return piece;
}

static void test_data_that_stay_are_never_found_changed(void) {
    for (uint32_t length = 1U; length <= LENGTH_MAX; length++) {
        elmopp_watch_t watch = elmopp_watch_over(bytes, length);
        TEST_ASSERT_EQUAL_UINT32(12U, pieces_until_seen(&watch, 12U));
    }
}

/* Wherever the change and whenever: at the latest in the round after the one that it falls into. */
static void test_each_bit_that_flips_is_found_in_two_rounds(void) {
    for (uint32_t bit = 0U; bit < (LENGTH_MAX * 8U); bit++) {
        for (uint32_t before = 0U; before < pieces_of(LENGTH_MAX); before++) {
            setUp();
            elmopp_watch_t watch = elmopp_watch_over(bytes, LENGTH_MAX);
            TEST_ASSERT_EQUAL_UINT32(before, pieces_until_seen(&watch, before));
            bytes[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
            TEST_ASSERT_LESS_THAN_UINT32(2U * pieces_of(LENGTH_MAX), pieces_until_seen(&watch, 100U));
        }
    }
}

static void test_a_change_is_said_once_a_round_and_no_longer_when_it_is_undone(void) {
    elmopp_watch_t watch = elmopp_watch_over(bytes, LENGTH_MAX);
    bytes[0] ^= 1U;
    TEST_ASSERT_EQUAL_UINT32(2U, pieces_until_seen(&watch, 10U));
    TEST_ASSERT_EQUAL_UINT32(2U, pieces_until_seen(&watch, 10U));
    bytes[0] ^= 1U;
    TEST_ASSERT_EQUAL_UINT32(10U, pieces_until_seen(&watch, 10U));
}

static void test_nothing_to_watch_is_never_changed(void) {
    elmopp_watch_t watch = elmopp_watch_over(NULL, LENGTH_MAX);
    TEST_ASSERT_EQUAL_UINT32(0U, watch.expected);
    TEST_ASSERT_EQUAL_UINT32(10U, pieces_until_seen(&watch, 10U));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_data_that_stay_are_never_found_changed);
    RUN_TEST(test_each_bit_that_flips_is_found_in_two_rounds);
    RUN_TEST(test_a_change_is_said_once_a_round_and_no_longer_when_it_is_undone);
    RUN_TEST(test_nothing_to_watch_is_never_changed);
    return UNITY_END();
}
