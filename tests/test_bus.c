/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "bench.h"
#include "elmopp/bus.h"
#include "elmopp/frames.h"
#include "unity.h"

#include "elmopp_can.h"

#define GROUPS 4U
#define IDS 0x800U

#define FENCE 0xA5A5U

static elmopp_junction_t junction;
static struct {
    elmopp_bus_t bus;
    uint16_t fence[4]; /* nobody writes beyond his own */
} kept;
static uint8_t counter;

void setUp(void) {
    junction = bench_cross(GROUPS);
    junction.junction_wait_ds = 1U;
    elmopp_bus_init(&kept.bus, &junction);
    counter = 0U;
    for (uint32_t i = 0U; i < 4U; i++) {
        kept.fence[i] = FENCE;
    }
}
void tearDown(void) {
    for (uint32_t i = 0U; i < 4U; i++) {
        TEST_ASSERT_EQUAL_HEX16(FENCE, kept.fence[i]);
    }
}

static elmopp_news_kind_t hear(elmopp_frame_t frame) {
    elmopp_link_seal(&frame, &counter);
    return elmopp_bus_hear(&kept.bus, &frame).kind;
}

static elmopp_frame_t occupancy(bool valid, bool occupied) {
    const elmopp_occupancy_t said = {.occupied = occupied, .valid = valid};
    return elmopp_frames_make_occupancy(&said);
}

static elmopp_frame_t feedback(uint32_t node, bool lamp_fault, bool own_fail_safe) {
    const elmopp_feedback_t said = {
        .lamps = {.red = 0xFFFFU}, .lamp_fault = lamp_fault, .own_fail_safe = own_fail_safe};
    return elmopp_frames_make_feedback(node, &said);
}

static void ticks(uint32_t count) {
    for (uint32_t i = 0U; i < count; i++) {
        elmopp_bus_tick(&kept.bus);
    }
}

/* --- who is heard --- */

static void expect_silence(const elmopp_link_t *link, uint32_t count) {
    for (uint32_t i = 0U; i < count; i++) {
        TEST_ASSERT_FALSE(link[i].started);
        TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, link[i].age_ds);
    }
}

static void test_nobody_has_been_heard_at_first(void) {
    expect_silence(kept.bus.camera, ELMOPP_APPROACH_MAX);
    expect_silence(kept.bus.neighbour, ELMOPP_APPROACH_MAX);
    expect_silence(kept.bus.node, ELMOPP_NODE_MAX);
    expect_silence(&kept.bus.junction_camera, 1U);
    expect_silence(&kept.bus.command, 1U);
}

static bool is_in(uint32_t id, uint32_t first, uint32_t mask) {
    return (id >= first) && ((id - first) < 8U) && elmopp_mask_has((uint16_t)mask, id - first);
}

/* Every id there is: a whole frame of it is believed if the site names its sender, and by nobody else. */
static void test_those_are_heard_whom_the_site_names_and_nobody_else(void) {
    for (uint32_t id = 0U; id < IDS; id++) {
        setUp();
        const bool neighbour = is_in(id, ELMOPP_CAN_NEIGHBOUR_OUTFLOW_FRAME_ID, (1U << junction.approach_count) - 1U);
        const bool node = is_in(id, ELMOPP_CAN_LAMP_FEEDBACK_FRAME_ID, elmopp_junction_nodes(&junction));
        elmopp_news_kind_t expected = ELMOPP_NEWS_NOT_OURS;
        if (is_in(id, ELMOPP_CAN_DETECTOR_COUNTS_FRAME_ID, junction.cameras)) {
            expected = ELMOPP_NEWS_COUNTS;
        } else if (neighbour || node || (id == ELMOPP_CAN_JUNCTION_OCCUPIED_FRAME_ID)) {
            expected = ELMOPP_NEWS_KEPT;
        } else if (id == ELMOPP_CAN_COMMAND_FRAME_ID) {
            expected = ELMOPP_NEWS_COMMAND;
        } else if ((id == ELMOPP_CAN_LAMP_COMMAND_FRAME_ID) || (id == ELMOPP_CAN_CONTROLLER_STATUS_FRAME_ID)) {
            expected = ELMOPP_NEWS_SECOND;
        } else {
            /* somebody else's */
        }
        const elmopp_frame_t frame = {.id = (uint16_t)id, .length = ELMOPP_LINK_BYTES};
        TEST_ASSERT_EQUAL_INT_MESSAGE(expected, hear(frame), "of an id");
        TEST_ASSERT_EQUAL_UINT8(0U, kept.bus.refused);
    }
}

static void test_counts_say_of_which_approach_they_are(void) {
    for (uint32_t approach = 0U; approach < junction.approach_count; approach++) {
        elmopp_frame_t frame = {.id = (uint16_t)(ELMOPP_CAN_DETECTOR_COUNTS_FRAME_ID + approach)};
        elmopp_link_seal(&frame, &counter);
        const elmopp_news_t news = elmopp_bus_hear(&kept.bus, &frame);
        TEST_ASSERT_EQUAL_INT(ELMOPP_NEWS_COUNTS, news.kind);
        TEST_ASSERT_EQUAL_UINT32(approach, news.approach);
    }
}

static void test_a_site_that_does_not_wait_has_no_junction_camera(void) {
    junction.junction_wait_ds = 0U;
    TEST_ASSERT_EQUAL_INT(ELMOPP_NEWS_NOT_OURS, hear(occupancy(true, true)));
    TEST_ASSERT_FALSE(elmopp_bus_is_occupied(&kept.bus));
    TEST_ASSERT_EQUAL_UINT8(0U, kept.bus.refused);
}

/* The watch finds the change some ticks later. */
static void test_a_site_that_changed_in_memory_leads_to_no_receiver_that_does_not_exist(void) {
    (void)hear(feedback(0U, false, false));
    (void)hear(occupancy(true, true)); /* whose receiver lies behind the nodes' */
    junction.group[3].node = ELMOPP_NODE_MAX;
    TEST_ASSERT_EQUAL_HEX16(0x7U, elmopp_bus_fresh_groups(&kept.bus));
    junction.approach_count = ELMOPP_APPROACH_MAX + 1U;
    const elmopp_frame_t frame = {.id = (uint16_t)(ELMOPP_CAN_NEIGHBOUR_OUTFLOW_FRAME_ID + ELMOPP_APPROACH_MAX)};
    TEST_ASSERT_EQUAL_INT(ELMOPP_NEWS_NOT_OURS, hear(frame));
}

/* Refused modulo 256, whoever refuses. */
static void test_what_is_not_believed_is_counted_and_changes_nothing_else(void) {
    elmopp_frame_t frame = occupancy(true, true);
    elmopp_link_seal(&frame, &counter);
    frame.data[0] ^= 0x20U;
    TEST_ASSERT_EQUAL_INT(ELMOPP_NEWS_REFUSED, elmopp_bus_hear(&kept.bus, &frame).kind);
    TEST_ASSERT_FALSE(elmopp_bus_is_occupied(&kept.bus));
    frame.data[0] ^= 0x20U;
    TEST_ASSERT_EQUAL_INT(ELMOPP_NEWS_KEPT, elmopp_bus_hear(&kept.bus, &frame).kind);
    TEST_ASSERT_TRUE(elmopp_bus_is_occupied(&kept.bus));
    TEST_ASSERT_EQUAL_INT(ELMOPP_NEWS_REFUSED, elmopp_bus_hear(&kept.bus, &frame).kind);
    TEST_ASSERT_EQUAL_UINT8(2U, kept.bus.refused);
    elmopp_bus_refuse(&kept.bus, 255U);
    TEST_ASSERT_EQUAL_UINT8(1U, kept.bus.refused);
}

static void test_a_controllers_words_count_only_when_they_are_whole(void) {
    elmopp_frame_t frame = {.id = ELMOPP_CAN_CONTROLLER_STATUS_FRAME_ID};
    elmopp_link_seal(&frame, &counter);
    frame.data[3] ^= 1U;
    TEST_ASSERT_EQUAL_INT(ELMOPP_NEWS_NOT_OURS, elmopp_bus_hear(&kept.bus, &frame).kind);
    TEST_ASSERT_EQUAL_UINT8(0U, kept.bus.refused);
}

/* --- for how long it counts --- */

/* A counter again is a repetition, and after a silence of the time-out a beginning. */
static void expect_timeout(uint32_t id, uint32_t timeout_ds) {
    setUp();
    const elmopp_frame_t frame = {.id = (uint16_t)id};
    TEST_ASSERT_NOT_EQUAL_INT(ELMOPP_NEWS_REFUSED, hear(frame));
    ticks(timeout_ds - 1U);
    counter = 0U;
    TEST_ASSERT_EQUAL_INT(ELMOPP_NEWS_REFUSED, hear(frame));
    ticks(1U);
    counter = 0U;
    TEST_ASSERT_NOT_EQUAL_INT(ELMOPP_NEWS_REFUSED, hear(frame));
}

static void test_after_a_silence_any_counter_is_good(void) {
    expect_timeout(ELMOPP_CAN_DETECTOR_COUNTS_FRAME_ID, 30U);
    expect_timeout(ELMOPP_CAN_NEIGHBOUR_OUTFLOW_FRAME_ID, 30U);
    expect_timeout(ELMOPP_CAN_LAMP_FEEDBACK_FRAME_ID, 5U);
    expect_timeout(ELMOPP_CAN_JUNCTION_OCCUPIED_FRAME_ID, 6U);
    expect_timeout(ELMOPP_CAN_COMMAND_FRAME_ID, 100U);
}

static void test_a_word_of_the_junction_camera_holds_for_six_ticks(void) {
    (void)hear(occupancy(true, true));
    ticks(5U);
    TEST_ASSERT_TRUE(elmopp_bus_is_occupied(&kept.bus));
    ticks(1U);
    TEST_ASSERT_FALSE(elmopp_bus_is_occupied(&kept.bus));
}

static void test_a_junction_that_is_not_validly_occupied_is_not(void) {
    (void)hear(occupancy(true, true));
    (void)hear(occupancy(false, true));
    TEST_ASSERT_FALSE(elmopp_bus_is_occupied(&kept.bus));
    (void)hear(occupancy(true, false));
    TEST_ASSERT_FALSE(elmopp_bus_is_occupied(&kept.bus));
}

static void test_a_nodes_feedback_counts_for_five_ticks_for_its_groups_alone(void) {
    junction.group[1].node = 1U;
    elmopp_bus_init(&kept.bus, &junction);
    TEST_ASSERT_EQUAL_HEX16(0U, elmopp_bus_fresh_groups(&kept.bus));
    (void)hear(feedback(1U, false, false));
    TEST_ASSERT_EQUAL_HEX16(0x2U, elmopp_bus_fresh_groups(&kept.bus));
    TEST_ASSERT_EQUAL_HEX16(0x2U, kept.bus.measured.red);
    (void)hear(feedback(0U, false, false));
    TEST_ASSERT_EQUAL_HEX16(0xFU, elmopp_bus_fresh_groups(&kept.bus));
    TEST_ASSERT_EQUAL_HEX16(0xFU, kept.bus.measured.red);
    ticks(3U);
    (void)hear(feedback(0U, false, false));
    ticks(1U);
    TEST_ASSERT_EQUAL_HEX16(0xFU, elmopp_bus_fresh_groups(&kept.bus));
    ticks(1U);
    TEST_ASSERT_EQUAL_HEX16(0xDU, elmopp_bus_fresh_groups(&kept.bus));
}

static void test_a_node_is_unwell_by_a_lamp_or_by_itself_until_it_says_otherwise(void) {
    junction.group[1].node = 1U;
    elmopp_bus_init(&kept.bus, &junction);
    (void)hear(feedback(1U, true, false));
    TEST_ASSERT_EQUAL_HEX8(0x2U, kept.bus.unwell_nodes);
    (void)hear(feedback(0U, false, true));
    TEST_ASSERT_EQUAL_HEX8(0x3U, kept.bus.unwell_nodes);
    (void)hear(feedback(1U, false, false));
    TEST_ASSERT_EQUAL_HEX8(0x1U, kept.bus.unwell_nodes);
}

static void test_what_a_neighbour_says_gets_older_and_ends_with_its_silence(void) {
    const elmopp_outflow_t said = {.next10_veh = 2.0F, .next30_veh = 3.0F, .next60_veh = 3.0F, .ahead_s = 14U};
    (void)hear(elmopp_frames_make_outflow(1U, &said));
    for (uint16_t second = 1U; second < 3U; second++) {
        ticks(10U);
        elmopp_bus_second(&kept.bus);
        TEST_ASSERT_EQUAL_UINT16(second, kept.bus.outflow[1].age_s);
        TEST_ASSERT_TRUE(elmopp_outflow_is_known(&kept.bus.outflow[1]));
        TEST_ASSERT_FALSE(elmopp_outflow_is_known(&kept.bus.outflow[0]));
    }
    ticks(10U);
    kept.bus.outflow[junction.approach_count].ahead_s = 1U; /* of an approach that is none */
    elmopp_bus_second(&kept.bus);
    TEST_ASSERT_FALSE(elmopp_outflow_is_known(&kept.bus.outflow[1]));
    TEST_ASSERT_EQUAL_UINT16(1U, kept.bus.outflow[junction.approach_count].ahead_s);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_nobody_has_been_heard_at_first);
    RUN_TEST(test_those_are_heard_whom_the_site_names_and_nobody_else);
    RUN_TEST(test_counts_say_of_which_approach_they_are);
    RUN_TEST(test_a_site_that_does_not_wait_has_no_junction_camera);
    RUN_TEST(test_a_site_that_changed_in_memory_leads_to_no_receiver_that_does_not_exist);
    RUN_TEST(test_what_is_not_believed_is_counted_and_changes_nothing_else);
    RUN_TEST(test_a_controllers_words_count_only_when_they_are_whole);
    RUN_TEST(test_after_a_silence_any_counter_is_good);
    RUN_TEST(test_a_word_of_the_junction_camera_holds_for_six_ticks);
    RUN_TEST(test_a_junction_that_is_not_validly_occupied_is_not);
    RUN_TEST(test_a_nodes_feedback_counts_for_five_ticks_for_its_groups_alone);
    RUN_TEST(test_a_node_is_unwell_by_a_lamp_or_by_itself_until_it_says_otherwise);
    RUN_TEST(test_what_a_neighbour_says_gets_older_and_ends_with_its_silence);
    return UNITY_END();
}
