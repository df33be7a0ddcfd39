/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Plan: brings the lamps from stage to stage through amber, the site's intergreens and red-amber.
///
/// Decides every aspect of every signal group, once a lamp tick. It takes a wanted stage, not orders, and hears it when
/// the last one is shown. Whatever is wished, late, wildly or not at all:
///
///   - a green lasts its minimum, an amber and a red-amber their time, and a group starts only when every conflicting
///     group is red and its intergreen has run out;
///   - while somebody stands in the junction, nothing starts: a change waits for it, junction_wait_ds in all and no
///     longer;
///   - a green that outlasts its maximum, counted from the first conflicting demand, gives way to the conflicting
///     movement that has waited longest;
///   - the bound on red: a movement with demand waits for green no longer than red_bound_ds. When the time that is left
///     is just what it takes to serve everybody who has waited as long, wishes are not heard, greens are cut to their
///     minimum, and the movement that has waited longest comes first, by its rescue stage;
///   - in a street a green rests where nobody waits on red.
///
/// Only ELMOPP_STAGE_RED overrules the bound: the mode that asks for it ends all service. It never knows a queue, an
/// urgency or a forecast.
///
/// The wait only ever comes on top: a group that it holds stays red, everything else goes on as without it, and each
/// intergreen runs as the site says. It holds every start alike, of people on foot too: one sign for the whole junction
/// does not say where somebody stands. What is green in both stages stays green. Without a valid sign there is no wait.
///
/// Why the bound holds. Let c be elmopp_junction_change_ds(): from any moment some stage is shown within c, and from
/// there any other within c. Serving the longest waiting first, nobody who came later is served before movement j but
/// together with an older one. So j is served within c for the change under way and c for each rescue stage of those
/// who have waited as long as j, itself included: (1 + n) c. This never grows while j waits, and elmopp_site_check()
/// has held (1 + all rescue stages) c against the bound, so that there is time left when the wait begins.
///
/// Shaped for proof: each group moves by four pure functions that read a snapshot and nothing else; ages saturate,
/// there is no timestamp; what the site must fulfil is one shared predicate (site.h). Ends are worked out for all
/// groups before starts, so that a simulation_only site with zero clearance changes within one tick.
///
/// Not thread-safe; one owner, the pilot. No allocation; a tick is bounded by ELMOPP_GROUP_MAX squared and
/// ELMOPP_MOVEMENT_MAX squared.

#ifndef ELMOPP_PLAN_H
#define ELMOPP_PLAN_H

#include "elmopp/chooser.h"
#include "elmopp/lamps.h"

/// One group between two lamp ticks. Ages are lamp ticks (0.1 s) and saturate at UINT16_MAX.
typedef struct {
    elmopp_aspect_t aspect;  ///< red, red-amber, green or amber
    uint16_t age_ds;         ///< how long the aspect has been shown
    uint16_t since_green_ds; ///< how long ago its green ended; 0 while it is green
    uint16_t contested_ds;   ///< how long conflicting traffic has waited against its green
} elmopp_plan_group_t;

/// State. Set up by elmopp_plan_init(); nobody else writes it.
typedef struct {
    const elmopp_junction_t *junction;
    elmopp_plan_group_t group[ELMOPP_GROUP_MAX];
    uint16_t wait_ds[ELMOPP_MOVEMENT_MAX]; ///< since the first demand of this red; 0: nobody waits, or it goes
    uint32_t change_ds;                    ///< elmopp_junction_change_ds()
    uint16_t elapsed_ds;                   ///< how long the stage has been shown
    uint16_t waited_ds;                    ///< ticks of this change in which a start was held
    elmopp_stage_t target;                 ///< shown or being brought up; ELMOPP_STAGE_NONE: no group green
    elmopp_stage_t stage;                  ///< shown: its groups green, all others red; otherwise ELMOPP_STAGE_NONE
    bool settled;                          ///< the target is shown, be it a stage or all red
    bool forced;                           ///< the target was set by a maximum green or by the bound on red
} elmopp_plan_t;

/// All red, every intergreen running as if all groups had just been green: a start in living traffic. The junction must
/// have passed elmopp_site_check() and outlive the plan.
void elmopp_plan_init(elmopp_plan_t *self, const elmopp_junction_t *junction);

/// One lamp tick. `wanted` is a stage, ELMOPP_STAGE_RED or ELMOPP_STAGE_NONE (no wish). `demand`: mask of the movements
/// where somebody wants to go, or of which nobody knows; remembered until the movement goes. `occupied`: a valid sign
/// that somebody stands in the junction; false if nobody does or nobody knows. Returns the lamps until the next tick.
elmopp_lamps_t elmopp_plan_step(elmopp_plan_t *self, elmopp_stage_t wanted, uint32_t demand, bool occupied);

/// The group after green and amber may have ended: pure, reads its own state only. `keep`: the target holds this group.
elmopp_plan_group_t elmopp_plan_end(const elmopp_group_t *site, elmopp_plan_group_t before, bool keep);

/// Group `g` after red may have ended: pure, reads the snapshot `ended` of all groups. `keep`: the target holds this
/// group.
elmopp_plan_group_t elmopp_plan_start(const elmopp_junction_t *junction,
                                      const elmopp_plan_group_t ended[ELMOPP_GROUP_MAX], uint32_t g, bool keep);

/// The group with the wait for an occupied junction: pure. `held`: what is red stays as it was. What is on its way to
/// green goes on.
elmopp_plan_group_t elmopp_plan_hold(elmopp_plan_group_t ended, elmopp_plan_group_t started, bool held);

/// The group one lamp tick older: pure. `contested`: somebody who conflicts with it waits.
elmopp_plan_group_t elmopp_plan_older(elmopp_plan_group_t started, bool contested);

#endif
