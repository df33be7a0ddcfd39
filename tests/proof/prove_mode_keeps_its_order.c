/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// From any mode, one that does not exist included, under any input: a fault is fail-safe at once; green comes only
/// after all red; flashing and darkness come only from red everywhere or from each other; fail-safe ends only when
/// cleared. And a measure of the way to the goal falls with every change of mode, so that no mode is passed twice.

#include "claims.h"

#include "elmopp/mode.h"

elmopp_mode_input_t nondet_input(void);

static bool serves(uint32_t mode) {
    return (mode == ELMOPP_MODE_AUTOMATIC) || (mode == ELMOPP_MODE_FIXED_TIME) || (mode == ELMOPP_MODE_MANUAL);
}

static bool is_off(uint32_t mode) {
    return (mode == ELMOPP_MODE_FLASHING) || (mode == ELMOPP_MODE_DARK);
}

static uint32_t goal_of(const elmopp_mode_input_t *input) {
    if (input->wish == ELMOPP_WISH_RUN) {
        const uint32_t by_sight = input->sighted ? ELMOPP_MODE_AUTOMATIC : ELMOPP_MODE_FIXED_TIME;
        return input->night ? ELMOPP_MODE_FLASHING : by_sight;
    }
    return (input->wish == ELMOPP_WISH_FIXED_TIME) ? ELMOPP_MODE_FIXED_TIME
           : (input->wish == ELMOPP_WISH_MANUAL)   ? ELMOPP_MODE_MANUAL
           : (input->wish == ELMOPP_WISH_ALL_RED)  ? ELMOPP_MODE_ALL_RED
           : (input->wish == ELMOPP_WISH_DARK)     ? ELMOPP_MODE_DARK
                                                   : ELMOPP_MODE_FLASHING;
}

/* Changes of mode that are left at most. [goal: serving, all red, flashing, dark][mode] */
static const uint8_t left[4][ELMOPP_MODE_COUNT] = {
    {6U, 5U, 4U, 2U, 1U, 1U, 1U, 3U, 5U, 7U, 8U},
    {4U, 3U, 2U, 1U, 1U, 1U, 1U, 0U, 3U, 5U, 6U},
    {3U, 2U, 1U, 3U, 3U, 3U, 3U, 2U, 0U, 4U, 5U},
    {3U, 2U, 1U, 3U, 3U, 3U, 3U, 2U, 1U, 0U, 5U},
};

static uint32_t left_from(uint32_t mode, uint32_t goal) {
    const uint32_t row = serves(goal)                     ? 0U
                         : (goal == ELMOPP_MODE_ALL_RED)  ? 1U
                         : (goal == ELMOPP_MODE_FLASHING) ? 2U
                                                          : 3U;
    return (mode == goal) ? 0U : left[row][mode];
}

void harness(void) {
    const uint32_t before = nondet_u32();
    const elmopp_mode_input_t input = nondet_input();
    const uint32_t next = (uint32_t)elmopp_mode_next((elmopp_mode_t)before, &input);
    const bool changes = next != before;
    CLAIM(next < ELMOPP_MODE_COUNT, "the next mode exists");
    if (input.fault || (before >= ELMOPP_MODE_COUNT)) {
        CLAIM(next == ELMOPP_MODE_FAIL_SAFE, "a fault is fail-safe at once");
    } else {
        const bool red = (before == ELMOPP_MODE_START_RED) || (before == ELMOPP_MODE_ALL_RED);
        CLAIM((next != ELMOPP_MODE_FIRST_STAGE) || red || (before == ELMOPP_MODE_FIRST_STAGE), "green after red");
        CLAIM((!serves(next)) || serves(before) || (before == ELMOPP_MODE_FIRST_STAGE),
              "service after the first stage");
        CLAIM((!is_off(next)) || is_off(before) || (before == ELMOPP_MODE_START_FLASH) ||
                  (red && input.all_red && (input.age_ds >= input.red_ds)),
              "off after red that has lasted");
        CLAIM((!changes) || (before != ELMOPP_MODE_FAIL_SAFE) || (input.cleared && (next == ELMOPP_MODE_STARTING)),
              "fail-safe ends when cleared");
        CLAIM((!changes) || (left_from(next, goal_of(&input)) < left_from(before, goal_of(&input))), "the way falls");
    }
    REACHABLE();
}
