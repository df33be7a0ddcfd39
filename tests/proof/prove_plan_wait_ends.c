/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// From any state of the plan, whatever the junction camera says: a tick that holds a start takes one of the change's
/// junction_wait_ds ticks, nothing gives one back before the target is shown, and none is held when none is left or no
/// sign is there. So a change holds its starts in junction_wait_ds ticks at most, one after the other or not. What the
/// groups do is replaced by anything, as is who waits and what is wished; only the wait itself is the plan's own.

#include "plan.c"

#include "invariant.h"

elmopp_plan_t nondet_plan(void);
elmopp_plan_group_t nondet_group(void);
elmopp_stage_t nondet_stage(void);

elmopp_plan_group_t any_end(const elmopp_group_t *group, elmopp_plan_group_t before, bool keep);
elmopp_plan_group_t any_start(const elmopp_junction_t *junction, const elmopp_plan_group_t ended[ELMOPP_GROUP_MAX],
                              uint32_t g, bool keep);
elmopp_plan_group_t watched_older(elmopp_plan_group_t started, bool contested);
void any_demand(elmopp_plan_t *self, bool serving, uint32_t demand);
uint16_t any_groups(const elmopp_plan_t *self);
elmopp_stage_t any_stage(const elmopp_plan_t *self);
uint32_t any_movement(const elmopp_plan_t *self, uint16_t groups);

static elmopp_junction_t site;
static elmopp_plan_group_t free_now; ///< what the last group would have become
static bool held_any;                ///< a group was kept from it

static elmopp_plan_group_t anything(void) {
    const elmopp_plan_group_t group = nondet_group();
    ASSUME(is_shown((uint32_t)group.aspect));
    return group;
}

elmopp_plan_group_t any_end(const elmopp_group_t *group, elmopp_plan_group_t before, bool keep) {
    (void)group;
    (void)before;
    (void)keep;
    return anything();
}

elmopp_plan_group_t any_start(const elmopp_junction_t *junction, const elmopp_plan_group_t ended[ELMOPP_GROUP_MAX],
                              uint32_t g, bool keep) {
    (void)junction;
    (void)keep;
    free_now = nondet_bool() ? ended[g] : anything();
    ASSUME((ended[g].aspect == ELMOPP_ASPECT_RED) || (free_now.aspect != ELMOPP_ASPECT_RED));
    return free_now;
}

elmopp_plan_group_t watched_older(elmopp_plan_group_t started, bool contested) {
    (void)contested;
    held_any = held_any || (started.aspect != free_now.aspect);
    return started;
}

void any_demand(elmopp_plan_t *self, bool serving, uint32_t demand) {
    (void)self;
    (void)serving;
    (void)demand;
}

uint16_t any_groups(const elmopp_plan_t *self) {
    (void)self;
    return nondet_u16();
}

elmopp_stage_t any_stage(const elmopp_plan_t *self) {
    (void)self;
    const elmopp_stage_t stage = nondet_stage();
    ASSUME((stage == ELMOPP_STAGE_NONE) || (stage < site.stage_count));
    return stage;
}

uint32_t any_movement(const elmopp_plan_t *self, uint16_t groups) {
    (void)self;
    (void)groups;
    return nondet_u32();
}

void harness(void) {
    site = any_junction();
    elmopp_plan_t plan = nondet_plan();
    plan.junction = &site;
    ASSUME((plan.target == ELMOPP_STAGE_NONE) || (plan.target < site.stage_count));
    const uint32_t limit_ds = site.junction_wait_ds;
    const uint32_t used_ds = plan.settled ? 0U : plan.waited_ds; /* a new change has its whole wait */
    ASSUME(used_ds <= limit_ds);
    ASSUME(limit_ds <= ELMOPP_SITE_JUNCTION_WAIT_MAX_DS);
    const elmopp_stage_t wanted = any_stage(&plan);
    const bool occupied = nondet_bool();
    held_any = false;

    (void)elmopp_plan_step(&plan, wanted, nondet_u32(), occupied);
    CLAIM(plan.waited_ds == (used_ds + (held_any ? 1U : 0U)), "a tick that holds a start is counted, and no other");
    CLAIM(plan.waited_ds <= limit_ds, "a change holds its starts no longer than the site allows");
    CLAIM((!held_any) || (occupied && (used_ds < limit_ds)), "without a sign, or a tick that is left, nothing is held");
    REACHABLE();
}
