/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// elmopp_site_load(): what was written comes back, and nothing that was changed on the way is taken.

#include "elmopp/site.h"
#include "image_writer.h"
#include "sites.h"
#include "unity.h"

#include <string.h>

#define BODY_SIZE 2312U
#define IMAGE_SIZE (16U + BODY_SIZE)
#define BODY_SIZE_1 1740U
#define VERSION 5U
#define CANARY 0xA5

static uint8_t image[IMAGE_SIZE + 1U];
static elmopp_junction_t out;

void tearDown(void) {}

static void write_image(const elmopp_junction_t *junction) {
    (void)memcpy(&image[16], junction, BODY_SIZE);
    image_seal(image, "ELMS", VERSION, BODY_SIZE);
}

void setUp(void) {
    TEST_ASSERT_EQUAL_HEX32(0xCBF43926U, image_checksum((const uint8_t *)"123456789", 9U));
    write_image(&elmopp_site_four_way);
    (void)memset(&out, CANARY, sizeof out);
}

static void expect_out_unchanged(void) {
    elmopp_junction_t canary;
    (void)memset(&canary, CANARY, sizeof canary);
    TEST_ASSERT_EQUAL_MEMORY(&canary, &out, sizeof out);
}

static void expect_refused(elmopp_site_fault_t fault) {
    TEST_ASSERT_EQUAL_INT(fault, elmopp_site_load(image, IMAGE_SIZE, &out).fault);
    expect_out_unchanged();
}

static void test_a_good_image_of_every_site_is_loaded_byte_for_byte(void) {
    for (uint32_t i = 0U; i < TEST_SITE_COUNT; i++) {
        write_image(test_sites[i]);
        const elmopp_site_verdict_t verdict = elmopp_site_load(image, IMAGE_SIZE, &out);
        TEST_ASSERT_EQUAL_INT(ELMOPP_SITE_OK, verdict.fault);
        TEST_ASSERT_EQUAL_MEMORY(test_sites[i], &out, sizeof out);
    }
}

static elmopp_site_fault_t fault_of_byte(uint32_t index) {
    static const elmopp_site_fault_t by_word[4] = {ELMOPP_SITE_IMAGE_MAGIC, ELMOPP_SITE_IMAGE_VERSION,
                                                   ELMOPP_SITE_IMAGE_LENGTH, ELMOPP_SITE_IMAGE_CRC};
    return by_word[(index < 16U) ? (index / 4U) : 3U];
}

/* Each bit alone, and all eight of a byte. */
static void test_no_bit_and_no_byte_can_change(void) {
    static const uint8_t change[] = {0x01U, 0x02U, 0x04U, 0x08U, 0x10U, 0x20U, 0x40U, 0x80U, 0xFFU};
    for (uint32_t index = 0U; index < IMAGE_SIZE; index++) {
        const uint8_t right = image[index];
        for (uint32_t i = 0U; i < sizeof change; i++) {
            image[index] = (uint8_t)(right ^ change[i]);
            const elmopp_site_verdict_t verdict = elmopp_site_load(image, IMAGE_SIZE, &out);
            TEST_ASSERT_EQUAL_INT(fault_of_byte(index), verdict.fault);
            TEST_ASSERT_EQUAL_UINT8(0U, verdict.first);
            TEST_ASSERT_EQUAL_UINT8(0U, verdict.second);
        }
        image[index] = right;
    }
    expect_out_unchanged();
}

static void test_every_cut_is_refused(void) {
    for (uint32_t length = 0U; length < IMAGE_SIZE; length++) {
        const elmopp_site_verdict_t verdict = elmopp_site_load(image, length, &out);
        const elmopp_site_fault_t right = (length < 16U) ? ELMOPP_SITE_IMAGE_MAGIC : ELMOPP_SITE_IMAGE_LENGTH;
        TEST_ASSERT_EQUAL_INT(right, verdict.fault);
    }
    expect_out_unchanged();
}

static void test_one_byte_more_is_refused(void) {
    TEST_ASSERT_EQUAL_INT(ELMOPP_SITE_IMAGE_LENGTH, elmopp_site_load(image, IMAGE_SIZE + 1U, &out).fault);
    expect_out_unchanged();
}

static void test_a_length_word_that_agrees_with_a_wrong_length_is_refused(void) {
    image_put_word(&image[8], BODY_SIZE - 4U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_SITE_IMAGE_LENGTH, elmopp_site_load(image, IMAGE_SIZE - 4U, &out).fault);
    image_put_word(&image[8], 0xFFFFFFFFU);
    expect_refused(ELMOPP_SITE_IMAGE_LENGTH);
    image_put_word(&image[8], 0xFFFFFFF0U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_SITE_IMAGE_LENGTH, elmopp_site_load(image, 16U, &out).fault);
    expect_out_unchanged();
}

static void test_an_intact_image_of_a_bad_site_is_refused_with_its_indices(void) {
    elmopp_junction_t bad = elmopp_site_four_way;
    bad.intergreen_ds[4][2] = 39U;
    write_image(&bad);
    const elmopp_site_verdict_t verdict = elmopp_site_load(image, IMAGE_SIZE, &out);
    TEST_ASSERT_EQUAL_INT(ELMOPP_SITE_INTERGREEN, verdict.fault);
    TEST_ASSERT_EQUAL_UINT8(4U, verdict.first);
    TEST_ASSERT_EQUAL_UINT8(2U, verdict.second);
    expect_out_unchanged();
}

static void test_an_intact_image_with_bad_hours_is_refused_with_its_indices(void) {
    elmopp_junction_t bad = elmopp_site_four_way;
    bad.schedule[3].program = bad.program_count;
    write_image(&bad);
    const elmopp_site_verdict_t verdict = elmopp_site_load(image, IMAGE_SIZE, &out);
    TEST_ASSERT_EQUAL_INT(ELMOPP_SITE_SCHEDULE, verdict.fault);
    TEST_ASSERT_EQUAL_UINT8(3U, verdict.first);
    expect_out_unchanged();
}

static void test_an_image_of_another_version_is_refused(void) {
    TEST_ASSERT_EQUAL_UINT32(VERSION, ELMOPP_SITE_IMAGE_VERSION_NOW);
    image_put_word(&image[4], VERSION + 1U);
    expect_refused(ELMOPP_SITE_IMAGE_VERSION);
    image_put_word(&image[4], VERSION - 1U);
    expect_refused(ELMOPP_SITE_IMAGE_VERSION);
}

/* Before there were programmes the body was shorter. */
static void test_an_image_of_version_1_is_refused_for_its_version(void) {
    image_seal(image, "ELMS", 1U, BODY_SIZE_1);
    TEST_ASSERT_EQUAL_INT(ELMOPP_SITE_IMAGE_VERSION, elmopp_site_load(image, 16U + BODY_SIZE_1, &out).fault);
    expect_out_unchanged();
}

static void test_an_image_may_lie_at_any_address(void) {
    static uint8_t moved[IMAGE_SIZE + 4U];
    for (uint32_t offset = 0U; offset < 4U; offset++) {
        (void)memcpy(&moved[offset], image, IMAGE_SIZE);
        TEST_ASSERT_EQUAL_INT(ELMOPP_SITE_OK, elmopp_site_load(&moved[offset], IMAGE_SIZE, &out).fault);
    }
}

static void test_every_fault_has_a_name_of_its_own(void) {
    for (uint32_t a = 0U; a < (uint32_t)ELMOPP_SITE_FAULT_COUNT; a++) {
        const char *name = elmopp_site_fault_name((elmopp_site_fault_t)a);
        TEST_ASSERT_TRUE(strlen(name) > 3U);
        for (uint32_t b = 0U; b < a; b++) {
            TEST_ASSERT_TRUE(strcmp(name, elmopp_site_fault_name((elmopp_site_fault_t)b)) != 0);
        }
    }
    TEST_ASSERT_EQUAL_STRING("an unknown fault", elmopp_site_fault_name(ELMOPP_SITE_FAULT_COUNT));
    TEST_ASSERT_EQUAL_STRING("an unknown fault", elmopp_site_fault_name((elmopp_site_fault_t)200));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_good_image_of_every_site_is_loaded_byte_for_byte);
    RUN_TEST(test_no_bit_and_no_byte_can_change);
    RUN_TEST(test_every_cut_is_refused);
    RUN_TEST(test_one_byte_more_is_refused);
    RUN_TEST(test_a_length_word_that_agrees_with_a_wrong_length_is_refused);
    RUN_TEST(test_an_intact_image_of_a_bad_site_is_refused_with_its_indices);
    RUN_TEST(test_an_intact_image_with_bad_hours_is_refused_with_its_indices);
    RUN_TEST(test_an_image_of_another_version_is_refused);
    RUN_TEST(test_an_image_of_version_1_is_refused_for_its_version);
    RUN_TEST(test_an_image_may_lie_at_any_address);
    RUN_TEST(test_every_fault_has_a_name_of_its_own);
    return UNITY_END();
}
