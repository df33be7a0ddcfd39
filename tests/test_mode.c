/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The mode automaton: every step against a table of what may follow what, and every way there is.

#include "elmopp/mode.h"
#include "unity.h"

#include <stdio.h>

#define FLASH_DS 20U
#define RED_DS 10U
#define WISHES 6U
#define PATIENCE 500U

void setUp(void) {}
void tearDown(void) {}

/* What a tick without a fault may lead to, a mask of modes; what stays out can never follow. */
static const uint32_t may_follow[ELMOPP_MODE_COUNT] = {
    [ELMOPP_MODE_STARTING] = (1U << ELMOPP_MODE_STARTING) | (1U << ELMOPP_MODE_START_FLASH),
    [ELMOPP_MODE_START_FLASH] = (1U << ELMOPP_MODE_START_FLASH) | (1U << ELMOPP_MODE_START_RED) |
                                (1U << ELMOPP_MODE_FLASHING) | (1U << ELMOPP_MODE_DARK),
    [ELMOPP_MODE_START_RED] = (1U << ELMOPP_MODE_START_RED) | (1U << ELMOPP_MODE_FIRST_STAGE) |
                              (1U << ELMOPP_MODE_ALL_RED) | (1U << ELMOPP_MODE_FLASHING) | (1U << ELMOPP_MODE_DARK),
    [ELMOPP_MODE_FIRST_STAGE] = (1U << ELMOPP_MODE_FIRST_STAGE) | (1U << ELMOPP_MODE_AUTOMATIC) |
                                (1U << ELMOPP_MODE_FIXED_TIME) | (1U << ELMOPP_MODE_MANUAL) |
                                (1U << ELMOPP_MODE_ALL_RED),
    [ELMOPP_MODE_AUTOMATIC] = (1U << ELMOPP_MODE_AUTOMATIC) | (1U << ELMOPP_MODE_FIXED_TIME) |
                              (1U << ELMOPP_MODE_MANUAL) | (1U << ELMOPP_MODE_ALL_RED),
    [ELMOPP_MODE_FIXED_TIME] = (1U << ELMOPP_MODE_AUTOMATIC) | (1U << ELMOPP_MODE_FIXED_TIME) |
                               (1U << ELMOPP_MODE_MANUAL) | (1U << ELMOPP_MODE_ALL_RED),
    [ELMOPP_MODE_MANUAL] = (1U << ELMOPP_MODE_AUTOMATIC) | (1U << ELMOPP_MODE_FIXED_TIME) | (1U << ELMOPP_MODE_MANUAL) |
                           (1U << ELMOPP_MODE_ALL_RED),
    [ELMOPP_MODE_ALL_RED] = (1U << ELMOPP_MODE_ALL_RED) | (1U << ELMOPP_MODE_FIRST_STAGE) |
                            (1U << ELMOPP_MODE_FLASHING) | (1U << ELMOPP_MODE_DARK),
    [ELMOPP_MODE_FLASHING] = (1U << ELMOPP_MODE_FLASHING) | (1U << ELMOPP_MODE_START_RED) | (1U << ELMOPP_MODE_DARK),
    [ELMOPP_MODE_DARK] = (1U << ELMOPP_MODE_DARK) | (1U << ELMOPP_MODE_STARTING),
    [ELMOPP_MODE_FAIL_SAFE] = (1U << ELMOPP_MODE_FAIL_SAFE) | (1U << ELMOPP_MODE_STARTING),
};

static bool bit(uint32_t bits, uint32_t i) {
    return ((bits >> i) & 1U) != 0U;
}

static elmopp_mode_input_t input_of(uint32_t bits, uint32_t wish, uint16_t age_ds) {
    return (elmopp_mode_input_t){.wish = (elmopp_wish_t)wish,
                                 .fault = bit(bits, 0U),
                                 .cleared = bit(bits, 1U),
                                 .tested = bit(bits, 2U),
                                 .sighted = bit(bits, 3U),
                                 .night = bit(bits, 4U),
                                 .all_red = bit(bits, 5U),
                                 .settled = bit(bits, 6U),
                                 .age_ds = age_ds,
                                 .flash_ds = FLASH_DS,
                                 .red_ds = RED_DS};
}

/* Whether a mode may be left at all, and for good reasons only. */
static void check_step(uint32_t before, const elmopp_mode_input_t *input, elmopp_mode_t next) {
    char where[100];
    (void)snprintf(where, sizeof where, "mode %u to %u, wish %u, age %u", (unsigned)before, (unsigned)next,
                   (unsigned)input->wish, (unsigned)input->age_ds);
    const bool exists = before < (uint32_t)ELMOPP_MODE_COUNT;
    const bool changes = (uint32_t)next != before;
    if (input->fault || (!exists)) {
        TEST_ASSERT_EQUAL_INT_MESSAGE(ELMOPP_MODE_FAIL_SAFE, next, where);
        return;
    }
    TEST_ASSERT_TRUE_MESSAGE(bit(may_follow[before], (uint32_t)next), where);
    if (changes && (before == (uint32_t)ELMOPP_MODE_FAIL_SAFE)) {
        TEST_ASSERT_TRUE_MESSAGE(input->cleared, where);
    }
    if (changes && (before == (uint32_t)ELMOPP_MODE_STARTING)) {
        TEST_ASSERT_TRUE_MESSAGE(input->tested, where);
    }
    if (changes && (before == (uint32_t)ELMOPP_MODE_START_FLASH)) {
        TEST_ASSERT_TRUE_MESSAGE(input->age_ds >= FLASH_DS, where);
    }
    const bool from_red = (before == (uint32_t)ELMOPP_MODE_START_RED) || (before == (uint32_t)ELMOPP_MODE_ALL_RED);
    const bool goes_off = (next == ELMOPP_MODE_FLASHING) || (next == ELMOPP_MODE_DARK);
    if (from_red && (goes_off || (changes && (before == (uint32_t)ELMOPP_MODE_START_RED)))) {
        TEST_ASSERT_TRUE_MESSAGE(input->all_red && (input->age_ds >= RED_DS), where);
    }
    if (changes && (before == (uint32_t)ELMOPP_MODE_FIRST_STAGE) && (next != ELMOPP_MODE_ALL_RED)) {
        TEST_ASSERT_TRUE_MESSAGE(input->settled, where);
    }
}

static void test_no_input_leads_anywhere_but_where_it_may(void) {
    static const uint16_t ages[] = {0U, RED_DS - 1U, RED_DS, FLASH_DS - 1U, FLASH_DS, UINT16_MAX};
    uint32_t tried = 0U;
    for (uint32_t before = 0U; before < 256U; before++) {
        for (uint32_t wish = 0U; wish < (WISHES + 2U); wish++) {
            for (uint32_t bits = 0U; bits < 128U; bits++) {
                for (uint32_t a = 0U; a < (sizeof ages / sizeof ages[0]); a++) {
                    const elmopp_mode_input_t input = input_of(bits, wish, ages[a]);
                    check_step(before, &input, elmopp_mode_next((elmopp_mode_t)before, &input));
                    tried++;
                }
            }
        }
    }
    TEST_ASSERT_EQUAL_UINT32(256U * 8U * 128U * 6U, tried);
}

/* A street that does what it is told: the plan is red 30 ticks after it is asked to, and shows a stage after 40. */
typedef struct {
    elmopp_mode_t mode;
    uint16_t age_ds;
    uint32_t visited;
} street_t;

static void step(street_t *street, elmopp_wish_t wish, bool sighted, bool night) {
    const bool red_mode = (street->mode == ELMOPP_MODE_START_RED) || (street->mode == ELMOPP_MODE_ALL_RED);
    const elmopp_mode_input_t input = {.wish = wish,
                                       .cleared = street->mode == ELMOPP_MODE_FAIL_SAFE,
                                       .tested = street->age_ds >= 10U,
                                       .sighted = sighted,
                                       .night = night,
                                       .all_red = red_mode && (street->age_ds >= 30U),
                                       .settled = (!red_mode) && (street->age_ds >= 40U),
                                       .age_ds = street->age_ds,
                                       .flash_ds = FLASH_DS,
                                       .red_ds = RED_DS};
    const elmopp_mode_t next = elmopp_mode_next(street->mode, &input);
    street->age_ds = (next == street->mode) ? (uint16_t)(street->age_ds + 1U) : (uint16_t)0U;
    street->mode = next;
    street->visited |= 1U << (uint32_t)next;
}

static elmopp_mode_t goal_of(elmopp_wish_t wish, bool sighted, bool night) {
    static const elmopp_mode_t goals[WISHES] = {ELMOPP_MODE_AUTOMATIC, ELMOPP_MODE_FIXED_TIME, ELMOPP_MODE_MANUAL,
                                                ELMOPP_MODE_ALL_RED,   ELMOPP_MODE_FLASHING,   ELMOPP_MODE_DARK};
    if (wish != ELMOPP_WISH_RUN) {
        return goals[wish];
    }
    return night ? ELMOPP_MODE_FLASHING : (sighted ? ELMOPP_MODE_AUTOMATIC : ELMOPP_MODE_FIXED_TIME);
}

static void test_every_goal_is_reached_from_every_mode_and_kept(void) {
    for (uint32_t from = 0U; from < (uint32_t)ELMOPP_MODE_COUNT; from++) {
        for (uint32_t wish = 0U; wish < WISHES; wish++) {
            for (uint32_t sky = 0U; sky < 4U; sky++) {
                street_t street = {(elmopp_mode_t)from, 0U, 0U};
                for (uint32_t i = 0U; i < PATIENCE; i++) {
                    step(&street, (elmopp_wish_t)wish, bit(sky, 0U), bit(sky, 1U));
                }
                const elmopp_mode_t goal = goal_of((elmopp_wish_t)wish, bit(sky, 0U), bit(sky, 1U));
                TEST_ASSERT_EQUAL_INT(goal, street.mode);
                TEST_ASSERT_TRUE_MESSAGE(street.age_ds > 100U, "the goal is not kept");
            }
        }
    }
}

static void test_a_start_goes_through_flashing_and_red_in_this_order(void) {
    static const elmopp_mode_t order[] = {ELMOPP_MODE_STARTING, ELMOPP_MODE_START_FLASH, ELMOPP_MODE_START_RED,
                                          ELMOPP_MODE_FIRST_STAGE, ELMOPP_MODE_AUTOMATIC};
    street_t street = {ELMOPP_MODE_STARTING, 0U, 0U};
    uint32_t at = 0U;
    for (uint32_t i = 0U; i < PATIENCE; i++) {
        step(&street, ELMOPP_WISH_RUN, true, false);
        at += ((at < 4U) && (street.mode == order[at + 1U])) ? 1U : 0U;
        TEST_ASSERT_EQUAL_INT(order[at], street.mode);
    }
    TEST_ASSERT_EQUAL_UINT32(4U, at);
}

static void test_cameras_that_come_and_go_change_between_automatic_and_fixed_time_only(void) {
    street_t street = {ELMOPP_MODE_AUTOMATIC, 0U, 0U};
    for (uint32_t i = 0U; i < PATIENCE; i++) {
        step(&street, ELMOPP_WISH_RUN, (i % 7U) == 0U, false);
        TEST_ASSERT_EQUAL_INT(((i % 7U) == 0U) ? ELMOPP_MODE_AUTOMATIC : ELMOPP_MODE_FIXED_TIME, street.mode);
    }
}

static void test_steady_are_the_modes_whose_lamps_are_the_plans(void) {
    for (uint32_t mode = 0U; mode < 256U; mode++) {
        const bool steady = (mode >= (uint32_t)ELMOPP_MODE_START_RED) && (mode <= (uint32_t)ELMOPP_MODE_ALL_RED);
        TEST_ASSERT_EQUAL_INT(steady, elmopp_mode_is_steady((elmopp_mode_t)mode));
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_no_input_leads_anywhere_but_where_it_may);
    RUN_TEST(test_every_goal_is_reached_from_every_mode_and_kept);
    RUN_TEST(test_a_start_goes_through_flashing_and_red_in_this_order);
    RUN_TEST(test_cameras_that_come_and_go_change_between_automatic_and_fixed_time_only);
    RUN_TEST(test_steady_are_the_modes_whose_lamps_are_the_plans);
    return UNITY_END();
}
