/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/timetable.h"

#define SECONDS_PER_MINUTE 60U
#define MINUTES_PER_DAY 1440U
#define SECONDS_PER_DAY (SECONDS_PER_MINUTE * MINUTES_PER_DAY)
#define DAYS_PER_WEEK 7U
#define FIRST_WEEKDAY 5U /* 2000-01-01 was a Saturday */
#define NO_LINE 255U

static uint32_t weekday_of(const elmopp_junction_t *junction, uint32_t day) {
    uint32_t weekday = (day + FIRST_WEEKDAY) % DAYS_PER_WEEK;
    for (uint32_t i = 0U; i < junction->special_day_count; i++) {
        weekday = (junction->special_day[i].day == day) ? junction->special_day[i].weekday : weekday;
    }
    return weekday;
}

/* The last line of a weekday that has begun by this minute. */
static uint32_t line_at(const elmopp_junction_t *junction, uint32_t weekday, uint32_t minute) {
    uint32_t found = NO_LINE;
    for (uint32_t i = 0U; i < junction->schedule_count; i++) {
        const elmopp_schedule_t *line = &junction->schedule[i];
        const bool begun = elmopp_mask_has(line->weekdays, weekday) && (line->from_min <= minute);
        if (begun && ((found == NO_LINE) || (line->from_min >= junction->schedule[found].from_min))) {
            found = i;
        }
    }
    return found;
}

uint8_t elmopp_timetable_program(const elmopp_junction_t *junction, uint32_t wall_s) {
    const uint32_t today = wall_s / SECONDS_PER_DAY;
    uint32_t minute = (wall_s % SECONDS_PER_DAY) / SECONDS_PER_MINUTE;
    uint32_t found = NO_LINE;
    /* Back over the days until one has a line: a week later it must be today's own. */
    for (uint32_t back = 0U; (back <= DAYS_PER_WEEK) && (back <= today) && (found == NO_LINE); back++) {
        found = line_at(junction, weekday_of(junction, today - back), minute);
        minute = MINUTES_PER_DAY;
    }
    return (found == NO_LINE) ? (uint8_t)0U : junction->schedule[found].program;
}

elmopp_stage_t elmopp_timetable_wish(elmopp_timetable_t *self, const elmopp_junction_t *junction, uint8_t program,
                                     elmopp_stage_t stage, uint16_t elapsed_ds) {
    if (junction->program_count == 0U) {
        return ELMOPP_STAGE_NONE;
    }
    const uint8_t next = (program < junction->program_count) ? program : (uint8_t)0U;
    const elmopp_program_t *running = &junction->program[self->program];
    const elmopp_step_t *step = &running->step[self->step];
    if ((stage == step->stage) && (elapsed_ds >= step->green_ds)) {
        const bool goes_on = (next == self->program) && ((self->step + 1U) < running->step_count);
        self->step = goes_on ? (uint8_t)(self->step + 1U) : (uint8_t)0U;
        self->program = next;
    }
    return junction->program[self->program].step[self->step].stage;
}
