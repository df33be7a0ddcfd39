/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Timetable: which fixed-time programme holds at this hour, and which stage it wants now.
///
/// Looks the local time up in the site's weekly schedule; a line holds until the next one, over midnight and weekends
/// too, and a special day follows another weekday's lines. A programme goes from step to step when a step's stage has
/// been shown for its green; another programme begins when the running step is over, so that a clock that is set, jumps
/// for daylight saving or is wrong can only choose among the site's programmes, at a step's end.
///
/// It reads no clock and moves no lamp. Owner: the controller. Bounded by the tables' sizes.

#ifndef ELMOPP_TIMETABLE_H
#define ELMOPP_TIMETABLE_H

#include "elmopp/chooser.h"

/// State. All zero: programme 0, step 0.
typedef struct {
    uint8_t program;
    uint8_t step;
} elmopp_timetable_t;

/// The programme of a local time, seconds since 2000-01-01 00:00, or ELMOPP_SCHEDULE_FLASH. 0 if the schedule is empty.
uint8_t elmopp_timetable_program(const elmopp_junction_t *junction, uint32_t wall_s);

/// The stage wanted, with the `stage` that is shown and for how long. ELMOPP_STAGE_NONE if the site has no programme.
/// `program`: of the hour; one that the site does not have is taken as 0.
elmopp_stage_t elmopp_timetable_wish(elmopp_timetable_t *self, const elmopp_junction_t *junction, uint8_t program,
                                     elmopp_stage_t stage, uint16_t elapsed_ds);

#endif
