/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// elmopp_weights_load(): what was written comes back, nothing that was changed on the way is taken, and everything
/// that is refused is refused by its name and leaves the old weights as they were.

#include "elmopp/weights.h"
#include "elmopp_weights.h"
#include "image_writer.h"
#include "unity.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define BODY_SIZE 34484U
#define IMAGE_SIZE (16U + BODY_SIZE)
#define CANARY 0xA5

static uint8_t image[IMAGE_SIZE + 1U];
static elmopp_weights_t out;
static elmopp_weights_t canary;

void tearDown(void) {}

static void seal(void) {
    image_seal(image, "ELMW", 2U, BODY_SIZE);
}

static void write_image(const elmopp_weights_t *weights) {
    (void)memcpy(&image[16], weights, BODY_SIZE);
    seal();
}

void setUp(void) {
    write_image(&elmopp_weights_lstm);
    (void)memset(&out, CANARY, sizeof out);
    (void)memset(&canary, CANARY, sizeof canary);
}

static void expect_refused_of_length(elmopp_weights_fault_t fault, uint32_t length) {
    TEST_ASSERT_EQUAL_INT(fault, elmopp_weights_load(image, length, &out));
    TEST_ASSERT_EQUAL_MEMORY(&canary, &out, sizeof out);
}

static void expect_refused(elmopp_weights_fault_t fault) {
    expect_refused_of_length(fault, IMAGE_SIZE);
}

/* Writes `value` where the member lies, with a checksum that fits. */
static void expect_value_refused(elmopp_weights_fault_t fault, size_t offset, float value) {
    write_image(&elmopp_weights_nlstm);
    (void)memcpy(&image[16U + offset], &value, sizeof value);
    seal();
    expect_refused(fault);
}

static void test_the_shipped_weights_pass_and_come_back_byte_for_byte(void) {
    static const elmopp_weights_t *const shipped[2] = {&elmopp_weights_lstm, &elmopp_weights_nlstm};
    for (uint32_t i = 0U; i < 2U; i++) {
        TEST_ASSERT_EQUAL_INT(ELMOPP_WEIGHTS_OK, elmopp_weights_check(shipped[i]));
        write_image(shipped[i]);
        TEST_ASSERT_EQUAL_INT(ELMOPP_WEIGHTS_OK, elmopp_weights_load(image, IMAGE_SIZE, &out));
        TEST_ASSERT_EQUAL_MEMORY(shipped[i], &out, sizeof out);
    }
    TEST_ASSERT_EQUAL_UINT32(1U, elmopp_weights_lstm.lstm.levels);
    TEST_ASSERT_EQUAL_UINT32(3U, elmopp_weights_nlstm.lstm.levels);
}

/* Each byte of the envelope, and every 61st of the body: a checksum does not care which. */
static void test_a_changed_byte_is_refused_and_the_old_weights_stay(void) {
    static const elmopp_weights_fault_t by_word[4] = {ELMOPP_WEIGHTS_MAGIC, ELMOPP_WEIGHTS_VERSION,
                                                      ELMOPP_WEIGHTS_LENGTH, ELMOPP_WEIGHTS_CRC};
    for (uint32_t at = 0U; at < IMAGE_SIZE; at += (at < 16U) ? 1U : 61U) {
        for (uint32_t bit = 0U; bit < 8U; bit++) {
            image[at] ^= (uint8_t)(1U << bit);
            expect_refused(by_word[(at < 16U) ? (at / 4U) : 3U]);
            image[at] ^= (uint8_t)(1U << bit);
        }
    }
}

static void test_a_cut_or_longer_image_is_refused(void) {
    for (uint32_t length = 0U; length < IMAGE_SIZE; length += (length < 40U) ? 1U : 97U) {
        expect_refused_of_length((length < 16U) ? ELMOPP_WEIGHTS_MAGIC : ELMOPP_WEIGHTS_LENGTH, length);
    }
    expect_refused_of_length(ELMOPP_WEIGHTS_LENGTH, IMAGE_SIZE - 1U);
    expect_refused_of_length(ELMOPP_WEIGHTS_LENGTH, IMAGE_SIZE + 1U);
}

/* Version 1 had no networks that see windows. */
static void test_another_version_is_refused(void) {
    image_put_word(&image[4], 1U);
    expect_refused(ELMOPP_WEIGHTS_VERSION);
    image_put_word(&image[4], ELMOPP_WEIGHTS_VERSION_NOW + 1U);
    expect_refused(ELMOPP_WEIGHTS_VERSION);
    image_put_word(&image[4], 0U);
    expect_refused(ELMOPP_WEIGHTS_VERSION);
}

/* A body of another shape, whose length is told truthfully and whose checksum fits. */
static void test_another_shape_is_refused(void) {
    image_put_word(&image[8], BODY_SIZE - 256U);
    image_put_word(&image[12], image_checksum(&image[16], BODY_SIZE - 256U));
    expect_refused_of_length(ELMOPP_WEIGHTS_LENGTH, IMAGE_SIZE - 256U);
}

static void test_levels_must_be_one_to_three(void) {
    static const uint32_t wrong[4] = {0U, 4U, 256U, 0xFFFFFFFFU};
    for (uint32_t i = 0U; i < 4U; i++) {
        write_image(&elmopp_weights_nlstm);
        image_put_word(&image[16U + offsetof(elmopp_weights_t, lstm.levels)], wrong[i]);
        seal();
        expect_refused(ELMOPP_WEIGHTS_LEVELS);
    }
    image_put_word(&image[16U + offsetof(elmopp_weights_t, lstm.levels)], 2U);
    seal();
    TEST_ASSERT_EQUAL_INT(ELMOPP_WEIGHTS_OK, elmopp_weights_load(image, IMAGE_SIZE, &out));
}

/* The first and the last value of every member. */
static void test_a_value_that_is_no_number_or_too_large_is_refused_wherever_it_is(void) {
    static const size_t places[] = {offsetof(elmopp_weights_t, ar8.intercept),
                                    offsetof(elmopp_weights_t, ar8.lag),
                                    offsetof(elmopp_weights_t, ar8.low) - 4U,
                                    offsetof(elmopp_weights_t, lstm.head_bias),
                                    offsetof(elmopp_weights_t, lstm.head_row),
                                    offsetof(elmopp_weights_t, lstm.outer) - 4U,
                                    offsetof(elmopp_weights_t, lstm.outer.bias),
                                    offsetof(elmopp_weights_t, lstm.outer.row),
                                    offsetof(elmopp_weights_t, lstm.inner) - 4U,
                                    offsetof(elmopp_weights_t, lstm.inner),
                                    offsetof(elmopp_weights_t, ann) - 4U,
                                    offsetof(elmopp_weights_t, ann.first_bias),
                                    offsetof(elmopp_weights_t, ann.first_row),
                                    offsetof(elmopp_weights_t, ann.second_bias) - 4U,
                                    offsetof(elmopp_weights_t, ann.second_bias),
                                    offsetof(elmopp_weights_t, ann.second_row),
                                    offsetof(elmopp_weights_t, ann.head_bias) - 4U,
                                    offsetof(elmopp_weights_t, ann.head_bias),
                                    offsetof(elmopp_weights_t, ann.head_row),
                                    offsetof(elmopp_weights_t, gcn) - 4U,
                                    offsetof(elmopp_weights_t, gcn.first_bias),
                                    offsetof(elmopp_weights_t, gcn.first_own),
                                    offsetof(elmopp_weights_t, gcn.first_passed),
                                    offsetof(elmopp_weights_t, gcn.second_bias),
                                    offsetof(elmopp_weights_t, gcn.second_own),
                                    offsetof(elmopp_weights_t, gcn.second_passed),
                                    offsetof(elmopp_weights_t, gcn.head_bias),
                                    offsetof(elmopp_weights_t, gcn.head),
                                    BODY_SIZE - 4U};
    for (uint32_t i = 0U; i < (sizeof places / sizeof places[0]); i++) {
        expect_value_refused(ELMOPP_WEIGHTS_VALUE, places[i], NAN);
        expect_value_refused(ELMOPP_WEIGHTS_VALUE, places[i], INFINITY);
        expect_value_refused(ELMOPP_WEIGHTS_VALUE, places[i], -INFINITY);
        expect_value_refused(ELMOPP_WEIGHTS_VALUE, places[i], nextafterf(ELMOPP_WEIGHTS_VALUE_MAX, INFINITY));
        expect_value_refused(ELMOPP_WEIGHTS_VALUE, places[i], -nextafterf(ELMOPP_WEIGHTS_VALUE_MAX, INFINITY));
        const float largest = ELMOPP_WEIGHTS_VALUE_MAX;
        (void)memcpy(&image[16U + places[i]], &largest, sizeof largest);
        seal();
        elmopp_weights_t good;
        TEST_ASSERT_EQUAL_INT(ELMOPP_WEIGHTS_OK, elmopp_weights_load(image, IMAGE_SIZE, &good));
    }
}

static void test_a_clamp_must_be_a_range_of_vehicles(void) {
    for (uint32_t k = 0U; k < ELMOPP_LSTM_INPUTS; k++) {
        const size_t low = offsetof(elmopp_weights_t, low) + (4U * k);
        const size_t high = offsetof(elmopp_weights_t, high) + (4U * k);
        expect_value_refused(ELMOPP_WEIGHTS_CLAMP, low, -0.001F);
        expect_value_refused(ELMOPP_WEIGHTS_CLAMP, low, NAN);
        expect_value_refused(ELMOPP_WEIGHTS_CLAMP, low, elmopp_weights_nlstm.high[k]);
        expect_value_refused(ELMOPP_WEIGHTS_CLAMP, high, elmopp_weights_nlstm.low[k]);
        expect_value_refused(ELMOPP_WEIGHTS_CLAMP, high, NAN);
        expect_value_refused(ELMOPP_WEIGHTS_CLAMP, high, nextafterf(ELMOPP_WEIGHTS_CLAMP_MAX, INFINITY));
    }
    expect_value_refused(ELMOPP_WEIGHTS_CLAMP, offsetof(elmopp_weights_t, ar8.low), -1.0F);
    expect_value_refused(ELMOPP_WEIGHTS_CLAMP, offsetof(elmopp_weights_t, ar8.high), 0.0F);
}

static void test_every_fault_has_a_name_of_its_own(void) {
    for (uint32_t a = 0U; a < (uint32_t)ELMOPP_WEIGHTS_FAULT_COUNT; a++) {
        const char *name = elmopp_weights_fault_name((elmopp_weights_fault_t)a);
        TEST_ASSERT_TRUE(strlen(name) > 3U);
        for (uint32_t b = 0U; b < a; b++) {
            TEST_ASSERT_TRUE(strcmp(name, elmopp_weights_fault_name((elmopp_weights_fault_t)b)) != 0);
        }
    }
}

static void test_a_fault_that_does_not_exist_has_a_name_too(void) {
    const elmopp_weights_fault_t beyond[2] = {ELMOPP_WEIGHTS_FAULT_COUNT, (elmopp_weights_fault_t)200};
    for (uint32_t i = 0U; i < 2U; i++) {
        TEST_ASSERT_EQUAL_STRING("an unknown fault", elmopp_weights_fault_name(beyond[i]));
    }
}

/* Learning changes the recurrent network and nothing else. */
static void test_weights_may_be_learnt_from_those_that_differ_in_the_recurrent_network_alone(void) {
    static elmopp_weights_t learnt;
    learnt = elmopp_weights_lstm;
    TEST_ASSERT_TRUE(elmopp_weights_are_learnt_from(&learnt, &elmopp_weights_lstm));
    learnt.lstm.head_bias[0] += 1.0F;
    learnt.lstm.inner[ELMOPP_LSTM_LEVELS_MAX - 2U].bias[0] += 1.0F;
    TEST_ASSERT_TRUE(elmopp_weights_are_learnt_from(&learnt, &elmopp_weights_lstm));
    TEST_ASSERT_FALSE(elmopp_weights_are_learnt_from(&learnt, &elmopp_weights_nlstm));
    uint8_t *byte = (uint8_t *)&learnt;
    for (uint32_t at = 0U; at < sizeof learnt; at++) {
        const bool is_network = (at >= offsetof(elmopp_weights_t, lstm)) && (at < offsetof(elmopp_weights_t, ann));
        const bool is_levels = (at >= offsetof(elmopp_weights_t, lstm.levels)) &&
                               (at < (offsetof(elmopp_weights_t, lstm.levels) + sizeof learnt.lstm.levels));
        byte[at] ^= 0x10U;
        TEST_ASSERT_EQUAL(is_network && (!is_levels), elmopp_weights_are_learnt_from(&learnt, &elmopp_weights_lstm));
        byte[at] ^= 0x10U;
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_shipped_weights_pass_and_come_back_byte_for_byte);
    RUN_TEST(test_a_changed_byte_is_refused_and_the_old_weights_stay);
    RUN_TEST(test_a_cut_or_longer_image_is_refused);
    RUN_TEST(test_another_version_is_refused);
    RUN_TEST(test_another_shape_is_refused);
    RUN_TEST(test_levels_must_be_one_to_three);
    RUN_TEST(test_a_value_that_is_no_number_or_too_large_is_refused_wherever_it_is);
    RUN_TEST(test_a_clamp_must_be_a_range_of_vehicles);
    RUN_TEST(test_every_fault_has_a_name_of_its_own);
    RUN_TEST(test_a_fault_that_does_not_exist_has_a_name_too);
    RUN_TEST(test_weights_may_be_learnt_from_those_that_differ_in_the_recurrent_network_alone);
    return UNITY_END();
}
