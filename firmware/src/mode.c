/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/mode.h"

/* Where the junction ought to end up; one of the modes that last. */
static elmopp_mode_t goal_of(const elmopp_mode_input_t *input) {
    const elmopp_mode_t by_sight = input->sighted ? ELMOPP_MODE_AUTOMATIC : ELMOPP_MODE_FIXED_TIME;
    elmopp_mode_t goal = ELMOPP_MODE_FLASHING;
    switch (input->wish) {
    case ELMOPP_WISH_RUN:
        goal = input->night ? ELMOPP_MODE_FLASHING : by_sight;
        break;
    case ELMOPP_WISH_FIXED_TIME:
        goal = ELMOPP_MODE_FIXED_TIME;
        break;
    case ELMOPP_WISH_MANUAL:
        goal = ELMOPP_MODE_MANUAL;
        break;
    case ELMOPP_WISH_ALL_RED:
        goal = ELMOPP_MODE_ALL_RED;
        break;
    case ELMOPP_WISH_DARK:
        goal = ELMOPP_MODE_DARK;
        break;
    case ELMOPP_WISH_FLASHING:
    default:
        goal = ELMOPP_MODE_FLASHING;
        break;
    }
    return goal;
}

static bool serves(elmopp_mode_t mode) {
    return (mode == ELMOPP_MODE_AUTOMATIC) || (mode == ELMOPP_MODE_FIXED_TIME) || (mode == ELMOPP_MODE_MANUAL);
}

/* From red everywhere that has lasted: what may come next. */
static elmopp_mode_t after_red(elmopp_mode_t goal) {
    return serves(goal) ? ELMOPP_MODE_FIRST_STAGE : goal;
}

static elmopp_mode_t after_all_red(elmopp_mode_t before, elmopp_mode_t goal, bool long_enough) {
    const elmopp_mode_t off = long_enough ? goal : before;
    return serves(goal) ? ELMOPP_MODE_FIRST_STAGE : off;
}

static elmopp_mode_t after_first_stage(elmopp_mode_t before, elmopp_mode_t goal, bool shown) {
    const elmopp_mode_t on = shown ? goal : before;
    return serves(goal) ? on : ELMOPP_MODE_ALL_RED;
}

static elmopp_mode_t after_start_flash(elmopp_mode_t goal) {
    const bool stays_off = (goal == ELMOPP_MODE_FLASHING) || (goal == ELMOPP_MODE_DARK);
    return stays_off ? goal : ELMOPP_MODE_START_RED;
}

static elmopp_mode_t after_dark(elmopp_mode_t goal) {
    return (goal == ELMOPP_MODE_DARK) ? ELMOPP_MODE_DARK : ELMOPP_MODE_STARTING;
}

static elmopp_mode_t without_fault(elmopp_mode_t before, const elmopp_mode_input_t *input) {
    const elmopp_mode_t goal = goal_of(input);
    const bool red_long_enough = input->all_red && (input->age_ds >= input->red_ds);
    elmopp_mode_t next = before;
    switch (before) {
    case ELMOPP_MODE_STARTING:
        next = input->tested ? ELMOPP_MODE_START_FLASH : before;
        break;
    case ELMOPP_MODE_START_FLASH:
        next = (input->age_ds >= input->flash_ds) ? after_start_flash(goal) : before;
        break;
    case ELMOPP_MODE_START_RED:
        next = red_long_enough ? after_red(goal) : before;
        break;
    case ELMOPP_MODE_ALL_RED:
        next = after_all_red(before, goal, red_long_enough);
        break;
    case ELMOPP_MODE_FIRST_STAGE:
        next = after_first_stage(before, goal, input->settled);
        break;
    case ELMOPP_MODE_AUTOMATIC:
    case ELMOPP_MODE_FIXED_TIME:
    case ELMOPP_MODE_MANUAL:
        next = serves(goal) ? goal : ELMOPP_MODE_ALL_RED;
        break;
    case ELMOPP_MODE_FLASHING:
        next = after_start_flash(goal);
        break;
    case ELMOPP_MODE_DARK:
        next = after_dark(goal);
        break;
    case ELMOPP_MODE_FAIL_SAFE:
        next = input->cleared ? ELMOPP_MODE_STARTING : before;
        break;
    case ELMOPP_MODE_COUNT:
    default:
        next = ELMOPP_MODE_FAIL_SAFE;
        break;
    }
    return next;
}

elmopp_mode_t elmopp_mode_next(elmopp_mode_t before, const elmopp_mode_input_t *input) {
    return input->fault ? ELMOPP_MODE_FAIL_SAFE : without_fault(before, input);
}

bool elmopp_mode_is_steady(elmopp_mode_t mode) {
    return serves(mode) || (mode == ELMOPP_MODE_START_RED) || (mode == ELMOPP_MODE_FIRST_STAGE) ||
           (mode == ELMOPP_MODE_ALL_RED);
}
