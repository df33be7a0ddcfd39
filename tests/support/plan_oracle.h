/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// A second opinion on the plan, for property tests: it sees wishes, demands and lamps and keeps its own books by
/// timestamps. It shares no code with the plan.

#ifndef ELMOPP_TEST_PLAN_ORACLE_H
#define ELMOPP_TEST_PLAN_ORACLE_H

#include "elmopp/plan.h"

#define PLAN_ORACLE_NEVER (-1000000000LL)

typedef struct {
    char aspect;         ///< R, B (red and amber), G, Y
    long long since;     ///< tick in which it began
    long long ended;     ///< tick in which its last green ended; PLAN_ORACLE_NEVER before
    long long contested; ///< tick of the first conflicting demand of this green; PLAN_ORACLE_NEVER before
} plan_oracle_group_t;

typedef struct {
    const elmopp_junction_t *junction;
    plan_oracle_group_t group[ELMOPP_GROUP_MAX];
    long long asked[ELMOPP_MOVEMENT_MAX]; ///< tick of the first demand of this red; PLAN_ORACLE_NEVER: nobody waits
    long long longest_wait;               ///< of anybody so far, in ticks
    long long now;
    uint32_t shown;   ///< stage that the lamps show, ELMOPP_STAGE_NONE if none
    uint32_t target;  ///< stage that must come next
    bool settled;     ///< the target is shown
    uint32_t waited;  ///< ticks of this change in which it waited for the junction
    uint32_t waits;   ///< ... and of all changes
    bool held;        ///< nothing may start in this tick
    uint32_t forced;  ///< targets that a maximum green asked for
    uint32_t rescued; ///< ... and that the bound on red asked for
    long long shown_since;
    char complaint[120]; ///< empty as long as all is well
} plan_oracle_t;

void plan_oracle_init(plan_oracle_t *self, const elmopp_junction_t *junction);

/// Judges one tick. False and a complaint if a rule of plan.h or of the site is broken.
/// `demand`: mask of movements. `occupied`: what the plan was told of the junction.
bool plan_oracle_judge(plan_oracle_t *self, elmopp_stage_t wanted, uint32_t demand, bool occupied, elmopp_lamps_t lamps,
                       const elmopp_plan_t *plan);

/// Ticks in which any stage must be up after a wish that is heard: the longest minimum green, the longest intergreen
/// or amber, the wait for the junction, the tick of the wish and the one that sees it fulfilled.
uint32_t plan_oracle_bound(const elmopp_junction_t *junction);

#endif
