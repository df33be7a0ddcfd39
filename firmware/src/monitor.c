/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/monitor.h"

/* A group's lamps as one number. */
#define LAMP_RED 1U
#define LAMP_AMBER 2U
#define LAMP_GREEN 4U
#define LAMP_FLASH 8U

#define SHOWS_DARK 0U
#define SHOWS_RED LAMP_RED
#define SHOWS_RED_AMBER (LAMP_RED | LAMP_AMBER)
#define SHOWS_GREEN LAMP_GREEN
#define SHOWS_AMBER LAMP_AMBER
#define SHOWS_FLASHING_AMBER (LAMP_FLASH | LAMP_AMBER)
#define SHOWS_FLASHING_RED (LAMP_FLASH | LAMP_RED)

/* How a mode's lamps are judged. */
typedef enum { RULES_STEADY, RULES_FLASHING, RULES_DARK } rules_t;

static bool is_in(uint32_t mask, uint32_t g) {
    return ((mask >> g) & 1U) != 0U;
}

static uint32_t lamp(uint16_t mask, uint32_t g, uint32_t value) {
    return is_in(mask, g) ? value : 0U;
}

static uint32_t shown_by(const elmopp_lamps_t *lamps, uint32_t g) {
    return lamp(lamps->red, g, LAMP_RED) | lamp(lamps->amber, g, LAMP_AMBER) | lamp(lamps->green, g, LAMP_GREEN) |
           lamp(lamps->flash, g, LAMP_FLASH);
}

/* A mode that does not exist is judged as flashing: it has no green. */
static rules_t rules_of(elmopp_mode_t mode) {
    rules_t rules = RULES_FLASHING;
    switch (mode) {
    case ELMOPP_MODE_START_RED:
    case ELMOPP_MODE_FIRST_STAGE:
    case ELMOPP_MODE_AUTOMATIC:
    case ELMOPP_MODE_FIXED_TIME:
    case ELMOPP_MODE_MANUAL:
    case ELMOPP_MODE_ALL_RED:
        rules = RULES_STEADY;
        break;
    case ELMOPP_MODE_DARK:
        rules = RULES_DARK;
        break;
    case ELMOPP_MODE_STARTING:
    case ELMOPP_MODE_START_FLASH:
    case ELMOPP_MODE_FLASHING:
    case ELMOPP_MODE_FAIL_SAFE:
    case ELMOPP_MODE_COUNT:
    default:
        rules = RULES_FLASHING;
        break;
    }
    return rules;
}

static uint32_t flashing_of(const elmopp_junction_t *junction, uint32_t g) {
    uint32_t shows = SHOWS_FLASHING_AMBER;
    if (junction->group[g].flash == (uint8_t)ELMOPP_FLASH_RED) {
        shows = SHOWS_FLASHING_RED;
    } else if (junction->group[g].flash == (uint8_t)ELMOPP_FLASH_DARK) {
        shows = SHOWS_DARK;
    } else {
        /* amber */
    }
    return shows;
}

static uint16_t lit_for(uint32_t mask, uint32_t g, uint32_t on) {
    return (uint16_t)(mask | ((on != 0U) ? ((uint32_t)1U << g) : 0U));
}

void elmopp_monitor_init(elmopp_monitor_t *self, const elmopp_junction_t *junction) {
    *self = (elmopp_monitor_t){.junction = junction, .first = ELMOPP_FAULT_NONE};
    for (uint32_t g = 0U; g < junction->group_count; g++) {
        const uint32_t shows = flashing_of(junction, g);
        self->last.red = lit_for(self->last.red, g, shows & LAMP_RED);
        self->last.amber = lit_for(self->last.amber, g, shows & LAMP_AMBER);
        self->last.flash = lit_for(self->last.flash, g, shows & LAMP_FLASH);
    }
}

/* --- one group by itself --- */

/* Steady colours that are an aspect. */
static elmopp_fault_t judge_colours(uint32_t now) {
    elmopp_fault_t fault = ELMOPP_FAULT_TWO_COLOURS;
    if ((now & LAMP_FLASH) != 0U) {
        fault = ELMOPP_FAULT_FLASHING;
    } else if (now == SHOWS_DARK) {
        fault = ELMOPP_FAULT_DARK;
    } else if ((now == SHOWS_RED) || (now == SHOWS_RED_AMBER) || (now == SHOWS_GREEN) || (now == SHOWS_AMBER)) {
        fault = ELMOPP_FAULT_NONE;
    } else {
        /* two colours */
    }
    return fault;
}

static elmopp_fault_t at_least(uint16_t age_ds, uint16_t least_ds, elmopp_fault_t otherwise) {
    return (age_ds >= least_ds) ? ELMOPP_FAULT_NONE : otherwise;
}

static elmopp_fault_t judge_end_of_red(const elmopp_group_t *site, uint32_t now) {
    elmopp_fault_t fault = ELMOPP_FAULT_SEQUENCE;
    if (now == SHOWS_GREEN) {
        fault = at_least(0U, site->red_amber_ds, ELMOPP_FAULT_SHORT_RED_AMBER);
    } else if ((now == SHOWS_RED_AMBER) && (site->red_amber_ds > 0U)) {
        fault = ELMOPP_FAULT_NONE;
    } else {
        /* amber without green */
    }
    return fault;
}

static elmopp_fault_t judge_end_of_green(const elmopp_group_t *site, uint32_t now, uint16_t age_ds) {
    elmopp_fault_t fault = ELMOPP_FAULT_SEQUENCE;
    if ((now == SHOWS_RED) && (site->amber_ds > 0U)) {
        fault = ELMOPP_FAULT_SHORT_AMBER;
    } else if ((now == SHOWS_RED) || (now == SHOWS_AMBER)) {
        fault = at_least(age_ds, site->min_green_ds, ELMOPP_FAULT_SHORT_GREEN);
    } else {
        /* back to red-amber */
    }
    return fault;
}

/* One steady aspect after another. */
static elmopp_fault_t judge_step(const elmopp_group_t *site, uint32_t before, uint32_t now, uint16_t age_ds) {
    elmopp_fault_t fault = ELMOPP_FAULT_SEQUENCE;
    const bool was_off = (before == SHOWS_DARK) || ((before & LAMP_FLASH) != 0U);
    if ((now == before) || (was_off && (now == SHOWS_RED))) {
        fault = ELMOPP_FAULT_NONE;
    } else if (before == SHOWS_RED) {
        fault = judge_end_of_red(site, now);
    } else if ((before == SHOWS_RED_AMBER) && (now == SHOWS_GREEN)) {
        fault = at_least(age_ds, site->red_amber_ds, ELMOPP_FAULT_SHORT_RED_AMBER);
    } else if (before == SHOWS_GREEN) {
        fault = judge_end_of_green(site, now, age_ds);
    } else if ((before == SHOWS_AMBER) && (now == SHOWS_RED)) {
        fault = at_least(age_ds, site->amber_ds, ELMOPP_FAULT_SHORT_AMBER);
    } else {
        /* out of order */
    }
    return fault;
}

/* Flashing or darkness, as it must be, begun from red or from the other of the two. */
static elmopp_fault_t judge_calm(uint32_t expected, uint32_t before, uint32_t now) {
    const bool begun_well = (before == SHOWS_RED) || (before == SHOWS_DARK) || ((before & LAMP_FLASH) != 0U);
    elmopp_fault_t fault = ELMOPP_FAULT_NONE;
    if (now != expected) {
        fault = ELMOPP_FAULT_FLASHING;
    } else if (!begun_well) {
        fault = ELMOPP_FAULT_SEQUENCE;
    } else {
        /* as it must be */
    }
    return fault;
}

/* --- one group among the others --- */

static bool is_not_red(const elmopp_lamps_t *lamps, uint32_t g) {
    return is_in(lamps->green, g) || is_in(lamps->amber, g);
}

static elmopp_fault_t judge_conflicts(const elmopp_monitor_t *self, const elmopp_lamps_t *command, uint32_t g) {
    const bool goes = is_not_red(command, g);
    const bool starts = is_in(command->green, g) && (!is_in(self->last.green, g));
    for (uint32_t h = 0U; h < self->junction->group_count; h++) {
        if (is_in(self->junction->conflict[g], h)) {
            if (goes && is_not_red(command, h)) {
                return ELMOPP_FAULT_CONFLICT;
            }
            if (starts && (self->since_green_ds[h] < self->junction->intergreen_ds[h][g])) {
                return ELMOPP_FAULT_SHORT_INTERGREEN;
            }
        }
    }
    return ELMOPP_FAULT_NONE;
}

/* --- feedback --- */

/* Flashing lamps may be on or off when they are looked at. */
static bool reads_back(uint32_t commanded, uint32_t measured) {
    const uint32_t colours = commanded & (LAMP_RED | LAMP_AMBER | LAMP_GREEN);
    const bool flashes = (commanded & LAMP_FLASH) != 0U;
    return flashes ? ((measured & ~colours) == 0U) : (measured == colours);
}

static uint32_t measured_at(const elmopp_monitor_input_t *input, uint32_t g) {
    return shown_by(&input->measured, g) & (LAMP_RED | LAMP_AMBER | LAMP_GREEN);
}

static uint8_t differs_now(const elmopp_monitor_t *self, const elmopp_monitor_input_t *input, uint32_t g) {
    const bool same = reads_back(shown_by(&self->last, g), measured_at(input, g));
    const uint8_t before_ds = self->differs_ds[g];
    const uint8_t longer_ds = (before_ds < UINT8_MAX) ? (uint8_t)(before_ds + 1U) : before_ds;
    return same ? (uint8_t)0U : longer_ds;
}

static elmopp_fault_t judge_feedback(const elmopp_monitor_t *self, const elmopp_monitor_input_t *input, uint32_t g) {
    elmopp_fault_t fault = ELMOPP_FAULT_NONE;
    if (!is_in(input->fresh, g)) {
        fault = ELMOPP_FAULT_FEEDBACK_LOST;
    } else if (differs_now(self, input, g) > ELMOPP_MONITOR_FEEDBACK_DS) {
        fault = ELMOPP_FAULT_FEEDBACK_DIFFERS;
    } else {
        /* the lamps show what they should */
    }
    return (input->mode == ELMOPP_MODE_STARTING) ? ELMOPP_FAULT_NONE : fault;
}

/* --- the verdict --- */

static elmopp_fault_t judge_command(const elmopp_monitor_t *self, const elmopp_monitor_input_t *input, uint32_t g) {
    const uint32_t before = shown_by(&self->last, g);
    const uint32_t now = shown_by(&input->command, g);
    const rules_t rules = rules_of(input->mode);
    elmopp_fault_t fault = ELMOPP_FAULT_NONE;
    if (rules == RULES_FLASHING) {
        fault = judge_calm(flashing_of(self->junction, g), before, now);
    } else if (rules == RULES_DARK) {
        fault = judge_calm(SHOWS_DARK, before, now);
    } else {
        fault = judge_colours(now);
        if (fault == ELMOPP_FAULT_NONE) {
            fault = judge_conflicts(self, &input->command, g);
        }
        if (fault == ELMOPP_FAULT_NONE) {
            fault = judge_step(&self->junction->group[g], before, now, self->age_ds[g]);
        }
    }
    return fault;
}

elmopp_fault_t elmopp_monitor_judge_group(const elmopp_monitor_t *self, const elmopp_monitor_input_t *input,
                                          uint32_t g) {
    const elmopp_fault_t fault = judge_command(self, input, g);
    return (fault != ELMOPP_FAULT_NONE) ? fault : judge_feedback(self, input, g);
}

static uint16_t plus_tick(uint16_t age_ds) {
    return (age_ds < UINT16_MAX) ? (uint16_t)(age_ds + 1U) : age_ds;
}

void elmopp_monitor_remember_group(elmopp_monitor_t *self, const elmopp_monitor_input_t *input, uint32_t g) {
    const uint32_t before = shown_by(&self->last, g);
    const uint32_t now = shown_by(&input->command, g);
    const bool free = (now == SHOWS_DARK) || ((now & (LAMP_GREEN | LAMP_FLASH)) != 0U);
    const bool changes = now != before;
    self->differs_ds[g] = changes ? (uint8_t)0U : differs_now(self, input, g);
    self->age_ds[g] = changes ? (uint16_t)1U : plus_tick(self->age_ds[g]);
    self->since_green_ds[g] = free ? (uint16_t)0U : plus_tick(self->since_green_ds[g]);
}

/* Lamps of groups that the site does not have. */
static bool are_strangers_lit(const elmopp_monitor_t *self, const elmopp_lamps_t *command) {
    const uint32_t lit = (uint32_t)command->red | command->amber | command->green | command->flash;
    return (lit >> self->junction->group_count) != 0U;
}

static void latch(elmopp_monitor_t *self, elmopp_fault_t fault, uint32_t g) {
    if ((self->first == ELMOPP_FAULT_NONE) && (fault != ELMOPP_FAULT_NONE)) {
        self->first = fault;
        self->first_group = (uint8_t)g;
    }
}

elmopp_fault_t elmopp_monitor_check(elmopp_monitor_t *self, const elmopp_monitor_input_t *input) {
    if (are_strangers_lit(self, &input->command)) {
        latch(self, ELMOPP_FAULT_UNKNOWN_GROUP, ELMOPP_FAULT_NO_GROUP);
    }
    for (uint32_t g = 0U; g < self->junction->group_count; g++) {
        latch(self, elmopp_monitor_judge_group(self, input, g), g);
    }
    for (uint32_t g = 0U; g < self->junction->group_count; g++) {
        elmopp_monitor_remember_group(self, input, g);
    }
    self->last = input->command;
    return self->first;
}
