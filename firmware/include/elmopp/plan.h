/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Plan: brings the lamps from stage to stage through amber and the site's intergreens.
///
/// Decides every aspect of every signal group, once a lamp tick. It takes a wanted stage, not orders: a green is never
/// shorter than its minimum, a group starts only when every conflicting group's intergreen has run out, and a new wish
/// is heard only when the last one is fulfilled. When a green outlasts its maximum against waiting traffic, the plan
/// turns to the conflicting movement that has waited longest and hears no wish until its stage is up. It never knows a
/// queue, an urgency or a forecast.
///
/// Shaped for proof: each group moves by two pure functions, elmopp_plan_end() and elmopp_plan_start(), that read a
/// snapshot and nothing else; ages saturate, there is no timestamp; what the site must fulfil is one shared predicate
/// (site.h). Ends are worked out for all groups before starts, so that a simulation_only site with zero clearance
/// changes within one tick.
///
/// Not thread-safe; one owner, the controller. No allocation; a tick is bounded by ELMOPP_GROUP_MAX squared.

#ifndef ELMOPP_PLAN_H
#define ELMOPP_PLAN_H

#include "elmopp/chooser.h"

/// What a signal group shows.
typedef enum {
    ELMOPP_ASPECT_RED = 0,
    ELMOPP_ASPECT_RED_AMBER = 1,
    ELMOPP_ASPECT_GREEN = 2,
    ELMOPP_ASPECT_AMBER = 3
} elmopp_aspect_t;

/// One group between two lamp ticks. Ages are lamp ticks (0.1 s) and saturate at UINT16_MAX.
typedef struct {
    elmopp_aspect_t aspect;
    uint16_t age_ds;         ///< how long the aspect has been shown
    uint16_t since_green_ds; ///< how long ago its green ended; 0 while it is green
    uint16_t contested_ds;   ///< how long conflicting traffic has waited against its green
} elmopp_plan_group_t;

/// State. Set up by elmopp_plan_init(); nobody else writes it.
typedef struct {
    const elmopp_junction_t *junction;
    elmopp_plan_group_t group[ELMOPP_GROUP_MAX];
    elmopp_stage_t target; ///< shown or being brought up; ELMOPP_STAGE_NONE before the first wish
    elmopp_stage_t stage;  ///< shown: its groups green, all others red; otherwise ELMOPP_STAGE_NONE
    uint16_t elapsed_ds;   ///< how long the stage has been shown
    bool forced;           ///< the target was set by a maximum green
} elmopp_plan_t;

/// Masks of the lamps that burn. Red and amber of one group together are red-amber.
typedef struct {
    uint16_t red;
    uint16_t amber;
    uint16_t green;
} elmopp_lamps_t;

/// All red, every intergreen run out. The junction must have passed elmopp_site_check() and outlive the plan.
void elmopp_plan_init(elmopp_plan_t *self, const elmopp_junction_t *junction);

/// Whose traffic waits. Movements, not groups: a movement with two groups could see each of them green in turn and
/// never go.
typedef struct {
    uint32_t movements;     ///< mask of the movements that wait on red
    const uint16_t *red_ds; ///< [movement] T, as in elmopp_view_t
} elmopp_waiting_t;

/// One lamp tick. `wanted` is a stage or ELMOPP_STAGE_NONE (no wish). Returns the lamps until the next tick.
elmopp_lamps_t elmopp_plan_step(elmopp_plan_t *self, elmopp_stage_t wanted, const elmopp_waiting_t *waiting);

/// The group after green and amber may have ended: pure, reads its own state only. `keep`: the target holds this group.
elmopp_plan_group_t elmopp_plan_end(const elmopp_group_t *site, elmopp_plan_group_t before, bool keep);

/// Group `g` after red may have ended: pure, reads the snapshot `ended` of all groups. `keep`: the target holds this
/// group.
elmopp_plan_group_t elmopp_plan_start(const elmopp_junction_t *junction,
                                      const elmopp_plan_group_t ended[ELMOPP_GROUP_MAX], uint32_t g, bool keep);

#endif
