/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/lamp_node.h"

#include "elmopp/frames.h"

#include "elmopp_can.h"

#include "assert_catcher.h"
#include "sites.h"

#include "unity.h"

static elmopp_junction_t site;
static elmopp_lamp_node_t node;
static uint8_t counter;

void setUp(void) {
    site = test_cross(4U);
    site.group[1].flash = (uint8_t)ELMOPP_FLASH_RED;
    site.group[2].flash = (uint8_t)ELMOPP_FLASH_DARK;
    site.group[3].node = 1U;
    counter = 0U;
    elmopp_lamp_node_init(&node, &site, 0U);
}

void tearDown(void) {}

static elmopp_frame_t command(elmopp_lamps_t lamps) {
    elmopp_frame_t frame = elmopp_frames_lamp_command(&lamps, false, false);
    elmopp_link_seal(&frame, &counter);
    return frame;
}

static bool tell(elmopp_lamps_t lamps) {
    const elmopp_frame_t frame = command(lamps);
    return elmopp_lamp_node_take(&node, &frame);
}

static const elmopp_lamps_t all_red = {.red = 0xFU, .amber = 0U, .green = 0U, .flash = 0U};
static const elmopp_lamps_t one_green = {.red = 0xEU, .amber = 0U, .green = 0x1U, .flash = 0U};
static const elmopp_lamps_t one_amber = {.red = 0xEU, .amber = 0x1U, .green = 0U, .flash = 0U};
static const elmopp_lamps_t one_red_amber = {.red = 0xFU, .amber = 0x1U, .green = 0U, .flash = 0U};
static const elmopp_lamps_t all_flash_amber = {.red = 0U, .amber = 0xFU, .green = 0U, .flash = 0xFU};

/* Good commands, one every 100 ms. */
static void tell_for(elmopp_lamps_t lamps, uint32_t ms) {
    for (uint32_t t = 0U; t < ms; t += 100U) {
        TEST_ASSERT_TRUE(tell(lamps));
        elmopp_lamp_node_pass(&node, 100U);
    }
}

static void expect_lamps(uint32_t red, uint32_t amber, uint32_t green, uint32_t flash) {
    TEST_ASSERT_EQUAL_HEX32(red, node.lamps.red);
    TEST_ASSERT_EQUAL_HEX32(amber, node.lamps.amber);
    TEST_ASSERT_EQUAL_HEX32(green, node.lamps.green);
    TEST_ASSERT_EQUAL_HEX32(flash, node.lamps.flash);
}

static void expect_own_flashing(void) {
    TEST_ASSERT_TRUE(node.fail_safe);
    expect_lamps(0x2U, 0x1U, 0U, 0x3U); /* amber, red, dark, somebody else's */
}

static void come_back(void) {
    tell_for(all_red, 1000U);
    TEST_ASSERT_TRUE(tell(all_red));
    TEST_ASSERT_FALSE(node.fail_safe);
}

static void test_it_starts_flashing_as_the_site_says_its_own_groups_only(void) {
    expect_own_flashing();
    TEST_ASSERT_EQUAL_HEX16(0x7U, node.groups);
}

static void test_it_comes_back_after_a_second_of_calm_commands_and_not_before(void) {
    for (uint32_t t = 0U; t < 1000U; t += 100U) {
        TEST_ASSERT_TRUE(tell(all_red));
        expect_own_flashing();
        elmopp_lamp_node_pass(&node, 100U);
    }
    TEST_ASSERT_TRUE(tell(all_red));
    TEST_ASSERT_FALSE(node.fail_safe);
    expect_lamps(0x7U, 0U, 0U, 0U);
}

static void test_commands_to_flash_are_calm(void) {
    tell_for(all_flash_amber, 1000U);
    TEST_ASSERT_TRUE(tell(all_flash_amber));
    TEST_ASSERT_FALSE(node.fail_safe);
    expect_lamps(0U, 0x7U, 0U, 0x7U);
}

static void test_green_amber_and_red_amber_begin_the_second_again(void) {
    const elmopp_lamps_t moving[] = {one_green, one_amber, one_red_amber};
    for (uint32_t i = 0U; i < 3U; i++) {
        setUp();
        tell_for(all_red, 900U);
        TEST_ASSERT_TRUE(tell(moving[i]));
        elmopp_lamp_node_pass(&node, 100U);
        tell_for(all_red, 900U);
        TEST_ASSERT_TRUE(tell(all_red));
        expect_own_flashing();
        elmopp_lamp_node_pass(&node, 100U);
        TEST_ASSERT_TRUE(tell(all_red));
        TEST_ASSERT_FALSE(node.fail_safe);
    }
}

static void test_it_holds_what_is_commanded_for_300_ms_and_flashes_then(void) {
    come_back();
    TEST_ASSERT_TRUE(tell(one_green));
    elmopp_lamp_node_pass(&node, 299U);
    expect_lamps(0x6U, 0U, 0x1U, 0U);
    elmopp_lamp_node_pass(&node, 1U);
    expect_own_flashing();
}

static void test_two_lost_commands_are_no_silence(void) {
    come_back();
    TEST_ASSERT_TRUE(tell(one_green));
    elmopp_lamp_node_pass(&node, 280U);
    (void)command(one_green);
    (void)command(one_green);
    TEST_ASSERT_TRUE(tell(one_green));
    elmopp_lamp_node_pass(&node, 280U);
    TEST_ASSERT_FALSE(node.fail_safe);
}

static void test_a_silence_during_the_second_begins_it_again(void) {
    tell_for(all_red, 900U);
    elmopp_lamp_node_pass(&node, 300U);
    tell_for(all_red, 900U);
    TEST_ASSERT_TRUE(tell(all_red));
    expect_own_flashing();
}

static void test_bad_commands_are_counted_and_change_nothing(void) {
    come_back();
    elmopp_frame_t frame = command(one_green);
    frame.data[3] ^= 1U;
    TEST_ASSERT_FALSE(elmopp_lamp_node_take(&node, &frame));
    frame.data[3] ^= 1U;
    TEST_ASSERT_TRUE(elmopp_lamp_node_take(&node, &frame));
    TEST_ASSERT_FALSE(elmopp_lamp_node_take(&node, &frame)); /* repeated */
    elmopp_frame_t none = command(one_green);
    none.data[1] |= 7U; /* aspect 7 of group 0: there is none */
    none.data[7] = elmopp_link_crc(none.id, none.data);
    TEST_ASSERT_FALSE(elmopp_lamp_node_take(&node, &none));
    TEST_ASSERT_EQUAL_UINT32(3U, node.refused);
    expect_lamps(0x6U, 0U, 0x1U, 0U);
    elmopp_lamp_node_pass(&node, 300U);
    expect_own_flashing();
}

static void test_what_is_no_command_is_not_counted(void) {
    elmopp_frame_t frame = command(all_red);
    frame.id = (uint16_t)ELMOPP_CAN_CONTROLLER_STATUS_FRAME_ID;
    TEST_ASSERT_FALSE(elmopp_lamp_node_take(&node, &frame));
    TEST_ASSERT_EQUAL_UINT32(0U, node.refused);
}

static void test_counters_saturate(void) {
    node.refused = UINT32_MAX;
    elmopp_frame_t frame = command(all_red);
    frame.data[2] ^= 1U;
    TEST_ASSERT_FALSE(elmopp_lamp_node_take(&node, &frame));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, node.refused);
    come_back();
    tell_for(all_red, 5000U);
    TEST_ASSERT_EQUAL_UINT32(ELMOPP_LAMP_NODE_RETURN_MS, node.calm_ms);
    elmopp_lamp_node_pass(&node, UINT32_MAX);
    expect_own_flashing();
}

static void test_feedback_says_what_was_measured_of_the_own_groups(void) {
    const elmopp_frame_t first = elmopp_lamp_node_feedback(&node, &one_amber, true);
    TEST_ASSERT_EQUAL_HEX16(ELMOPP_CAN_LAMP_FEEDBACK_FRAME_ID, first.id);
    elmopp_feedback_t feedback = elmopp_frames_feedback(&first);
    TEST_ASSERT_EQUAL_HEX16(0x6U, feedback.lamps.red);
    TEST_ASSERT_EQUAL_HEX16(0x1U, feedback.lamps.amber);
    TEST_ASSERT_TRUE(feedback.lamp_fault);
    TEST_ASSERT_TRUE(feedback.own_fail_safe);
    come_back();
    const elmopp_frame_t second = elmopp_lamp_node_feedback(&node, &node.lamps, false);
    feedback = elmopp_frames_feedback(&second);
    TEST_ASSERT_FALSE(feedback.lamp_fault);
    TEST_ASSERT_FALSE(feedback.own_fail_safe);
    elmopp_link_t link;
    elmopp_link_init(&link);
    TEST_ASSERT_EQUAL_INT(ELMOPP_LINK_OK, elmopp_link_take(&link, &first, first.id, 3U));
    TEST_ASSERT_EQUAL_INT(ELMOPP_LINK_OK, elmopp_link_take(&link, &second, first.id, 3U));
}

static void test_a_node_that_cannot_be_is_a_bug(void) {
    TEST_EXPECT_ASSERT(elmopp_lamp_node_init(&node, &site, ELMOPP_NODE_MAX));
}

static void test_changed_flash_data_flash_amber(void) {
    site.group[0].flash = 3U;
    const elmopp_lamps_t lamps = elmopp_lamps_flashing(&site, 0x1U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_ASPECT_FLASH_AMBER, elmopp_lamps_aspect(&lamps, 0U));
    TEST_ASSERT_EQUAL_INT(ELMOPP_ASPECT_DARK, elmopp_lamps_aspect(&lamps, 1U));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_it_starts_flashing_as_the_site_says_its_own_groups_only);
    RUN_TEST(test_it_comes_back_after_a_second_of_calm_commands_and_not_before);
    RUN_TEST(test_commands_to_flash_are_calm);
    RUN_TEST(test_green_amber_and_red_amber_begin_the_second_again);
    RUN_TEST(test_it_holds_what_is_commanded_for_300_ms_and_flashes_then);
    RUN_TEST(test_two_lost_commands_are_no_silence);
    RUN_TEST(test_a_silence_during_the_second_begins_it_again);
    RUN_TEST(test_bad_commands_are_counted_and_change_nothing);
    RUN_TEST(test_what_is_no_command_is_not_counted);
    RUN_TEST(test_counters_saturate);
    RUN_TEST(test_feedback_says_what_was_measured_of_the_own_groups);
    RUN_TEST(test_a_node_that_cannot_be_is_a_bug);
    RUN_TEST(test_changed_flash_data_flash_amber);
    return UNITY_END();
}
