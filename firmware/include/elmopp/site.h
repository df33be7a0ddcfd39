/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Site: says whether data make a junction, and loads them from a checked image.
///
/// The one predicate that every other room relies on, cut into parts that name what they found, so that a person can be
/// told and a proof can assume them one by one. It decides nothing about traffic. tools/site judges the same rules a
/// second time, in the words of the site file, and asks for more, which only a person can get wrong: unique names, an
/// approach and a group for everything, a street's complete list of stages (here: each is maximal and different). Tests
/// hold the two against each other.
///
/// Street rules, which a simulation_only site need not fulfil: amber 3 to 6 s (RiLSA 2015, 2.4; MUTCD 4F.17), a minimum
/// green of at least 5 s (1 s in simulation), a maximum green, a bound on red, a fixed-time programme and maximal
/// stages: a simulation may be given the stages that somebody else's signal has.
///
/// In every site the intergreen of a conflicting pair is at least the amber of the group that ends plus the red-amber
/// of the one that starts; no time is above ELMOPP_SITE_TIME_MAX_DS, so that 16-bit ages that saturate cannot hide that
/// it is over; a bound on red is no shorter than it takes to serve everybody (elmopp_site_red_bound_min_ds()); and a
/// programme shows every movement a green that is long enough.

#ifndef ELMOPP_SITE_H
#define ELMOPP_SITE_H

#include "elmopp/image.h"
#include "elmopp/junction.h"

/// What is wrong. `first` and `second` of the verdict index what is named in brackets.
typedef enum {
    ELMOPP_SITE_OK = 0,
    ELMOPP_SITE_COUNTS,     ///< a count, a code or a length is out of bounds, a street's discharge is no saturation, or
                            ///< a forecast is to learn that cannot, or that nobody looks at
    ELMOPP_SITE_NAME,       ///< a name has no terminating zero
    ELMOPP_SITE_HOLD,       ///< not 1 <= hold_min_s <= hold_max_s <= ELMOPP_HORIZON_MAX
    ELMOPP_SITE_START,      ///< no such first stage, a camera without an approach, or a start-up time too long
    ELMOPP_SITE_WAIT,       ///< the wait for an occupied junction is beyond ELMOPP_SITE_JUNCTION_WAIT_MAX_DS
    ELMOPP_SITE_APPROACH,   ///< more movements than ELMOPP_APPROACH_MOVEMENT_MAX [approach]
    ELMOPP_SITE_MOVEMENT,   ///< capacity, saturation flow, lanes, limit, approach or groups make none [movement]
    ELMOPP_SITE_RESCUE,     ///< the rescue stage does not exist or does not serve the movement [movement]
    ELMOPP_SITE_GIVES_WAY,  ///< to none that exists, to itself, to one that never goes with it, or with a share out of
                            ///< place [movement, the other one]
    ELMOPP_SITE_GROUP,      ///< a time is outside of its rule, or there is no such lamp node or way to flash [group]
    ELMOPP_SITE_CONFLICT,   ///< a group conflicts with itself, with none that exists, or one-sidedly [group, group]
    ELMOPP_SITE_INTERGREEN, ///< out of bounds for a conflicting pair, or set for a compatible one [ending, starting]
    ELMOPP_SITE_STAGE, ///< a stage is empty, repeated, or names no group, or a group is in no stage [stage or group]
    ELMOPP_SITE_STAGE_CONFLICT,    ///< two groups of a stage conflict [group, group]
    ELMOPP_SITE_STAGE_NOT_MAXIMAL, ///< a further group fits into a street's stage [stage, group]
    ELMOPP_SITE_RED_BOUND,         ///< missing in a street, too long, or too short to serve everybody
    ELMOPP_SITE_PROGRAM,       ///< a step is no stage, too short or too long [programme, step]; or a movement has no
                               ///< step, and 0 stands for all where there is no programme or no list of steps
                               ///< [programme, ELMOPP_STEP_MAX + movement]
    ELMOPP_SITE_SCHEDULE,      ///< a minute, a weekday or a programme that does not exist [line]
    ELMOPP_SITE_SPECIAL_DAY,   ///< a weekday that does not exist [special day]
    ELMOPP_SITE_IMAGE_MAGIC,   ///< does not begin with "ELMS"
    ELMOPP_SITE_IMAGE_VERSION, ///< another layout
    ELMOPP_SITE_IMAGE_LENGTH,  ///< cut or too long
    ELMOPP_SITE_IMAGE_CRC,     ///< changed on the way
    ELMOPP_SITE_FAULT_COUNT
} elmopp_site_fault_t;

/// First fault found, in the order above.
typedef struct {
    elmopp_site_fault_t fault;
    uint8_t first;
    uint8_t second;
} elmopp_site_verdict_t;

/// What a fault is called, for a status line, without what `first` and `second` stand for. Never null, whatever the
/// number.
const char *elmopp_site_fault_name(elmopp_site_fault_t fault);

/// The layout of elmopp_junction_t that this firmware reads; the envelope is image.h's.
#define ELMOPP_SITE_IMAGE_VERSION_NOW 5U

/// Ten minutes: no time of a site is longer.
#define ELMOPP_SITE_TIME_MAX_DS 6000U

/// Ten seconds: whoever stands in the junction for longer is held up by something that red does not clear, and every
/// change of a bound on red must have room for the whole wait.
#define ELMOPP_SITE_JUNCTION_WAIT_MAX_DS 100U

/// A speed limit that a site says, kilometres per hour.
#define ELMOPP_SITE_LIMIT_MIN_KM_PER_H 5U
#define ELMOPP_SITE_LIMIT_MAX_KM_PER_H 200U

/// True if every rule holds; otherwise the first fault.
elmopp_site_verdict_t elmopp_site_check(const elmopp_junction_t *junction);

/// The parts of elmopp_site_check(), in its order: each may rely on the ones before.
elmopp_site_verdict_t elmopp_site_check_counts(const elmopp_junction_t *junction);
elmopp_site_verdict_t elmopp_site_check_approach(const elmopp_junction_t *junction, uint32_t approach);
elmopp_site_verdict_t elmopp_site_check_movement(const elmopp_junction_t *junction, uint32_t movement);
elmopp_site_verdict_t elmopp_site_check_rescue(const elmopp_junction_t *junction, uint32_t movement);
elmopp_site_verdict_t elmopp_site_check_gives_way(const elmopp_junction_t *junction, uint32_t movement);
elmopp_site_verdict_t elmopp_site_check_group(const elmopp_junction_t *junction, uint32_t group);
elmopp_site_verdict_t elmopp_site_check_pair(const elmopp_junction_t *junction, uint32_t ending, uint32_t starting);
elmopp_site_verdict_t elmopp_site_check_stage(const elmopp_junction_t *junction, uint32_t stage);
elmopp_site_verdict_t elmopp_site_check_red_bound(const elmopp_junction_t *junction);
elmopp_site_verdict_t elmopp_site_check_program(const elmopp_junction_t *junction, uint32_t program);
elmopp_site_verdict_t elmopp_site_check_schedule(const elmopp_junction_t *junction, uint32_t line);
elmopp_site_verdict_t elmopp_site_check_special_day(const elmopp_junction_t *junction, uint32_t special_day);

/// The shortest bound on red that can be kept: the change under way when a bound comes near, and one for each different
/// stage that movements are rescued by (plan.h). Tenths of a second. Needs counts within bounds, nothing else.
uint32_t elmopp_site_red_bound_min_ds(const elmopp_junction_t *junction);

/// What an image of a site is.
const elmopp_image_kind_t *elmopp_site_kind(void);

/// Copies a checked image into `out`. On any fault `out` is unchanged. Needs a little-endian target (all of ours are).
elmopp_site_verdict_t elmopp_site_load(const uint8_t *image, uint32_t length, elmopp_junction_t *out);

#endif
