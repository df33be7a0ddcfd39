/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// One tick of the plan moves every group by its four pure functions, each called once, on the state before the tick
/// and on one snapshot of all ends, with the target's and the waiting groups' own bits and one word on the wait for
/// all; and its lamps are those of the groups. The loops add nothing. The four functions are replaced by others that
/// look at what they are given and answer anything.

#include "plan.c"

#include "invariant.h"

elmopp_plan_t nondet_plan(void);
elmopp_plan_group_t nondet_group(void);

elmopp_plan_group_t watched_end(const elmopp_group_t *site, elmopp_plan_group_t before, bool keep);
elmopp_plan_group_t watched_start(const elmopp_junction_t *junction, const elmopp_plan_group_t ended[ELMOPP_GROUP_MAX],
                                  uint32_t g, bool keep);
elmopp_plan_group_t watched_hold(elmopp_plan_group_t ended, elmopp_plan_group_t started, bool held);
elmopp_plan_group_t watched_older(elmopp_plan_group_t started, bool contested);

static elmopp_junction_t site;
static elmopp_plan_group_t before_g;
static uint32_t kept;
static uint16_t waiting;
static uint32_t own; ///< one group, any
static bool held_now;
static uint32_t calls[4];           ///< of the four functions
static elmopp_plan_group_t made[4]; ///< by them, of the one group

static elmopp_plan_group_t anything(void) {
    const elmopp_plan_group_t group = nondet_group();
    ASSUME(is_shown((uint32_t)group.aspect));
    return group;
}

elmopp_plan_group_t watched_end(const elmopp_group_t *group, elmopp_plan_group_t before, bool keep) {
    const uint32_t call = calls[0]++;
    CLAIM((call < site.group_count) && (group == &site.group[call]), "ends are worked out once a group, in order");
    CLAIM((call != own) || (is_same(before, before_g) && (keep == has(kept, own))), "an end is given its own group");
    return (call == own) ? made[0] : anything();
}

elmopp_plan_group_t watched_start(const elmopp_junction_t *junction, const elmopp_plan_group_t ended[ELMOPP_GROUP_MAX],
                                  uint32_t g, bool keep) {
    const uint32_t call = calls[1]++;
    CLAIM((junction == &site) && (g == call) && (calls[0] == site.group_count), "starts come after all ends, in order");
    CLAIM(is_same(ended[own], made[0]), "a start is given all ends");
    CLAIM((g != own) || (keep == has(kept, own)), "a start is given its own bit");
    return (g == own) ? made[1] : anything();
}

elmopp_plan_group_t watched_hold(elmopp_plan_group_t ended, elmopp_plan_group_t started, bool held) {
    const uint32_t call = calls[2]++;
    CLAIM((calls[1] == calls[2]) && (held == held_now), "each start is held or not as all are");
    CLAIM((call != own) || (is_same(ended, made[0]) && is_same(started, made[1])), "a wait is given its own group");
    return (call == own) ? made[2] : anything();
}

elmopp_plan_group_t watched_older(elmopp_plan_group_t started, bool contested) {
    const uint32_t call = calls[3]++;
    CLAIM(calls[2] == calls[3], "a group grows older as it has started");
    CLAIM((call != own) || (is_same(started, made[2]) && (contested == ((site.conflict[own] & waiting) != 0U))),
          "a group's contest is its own");
    return (call == own) ? made[3] : anything();
}

void harness(void) {
    site = any_junction();
    elmopp_plan_t plan = nondet_plan();
    plan.junction = &site;
    ASSUME((plan.target == ELMOPP_STAGE_NONE) || (plan.target < site.stage_count));
    own = nondet_u8();
    ASSUME(own < site.group_count);
    before_g = plan.group[own];
    kept = (plan.target == ELMOPP_STAGE_NONE) ? 0U : site.stage_groups[plan.target];
    waiting = nondet_u16();
    const bool occupied = nondet_bool();
    held_now = occupied && (plan.waited_ds < site.junction_wait_ds);
    for (uint32_t i = 0U; i < 4U; i++) {
        calls[i] = 0U;
        made[i] = anything();
    }

    move_groups(&plan, waiting, occupied);
    CLAIM(calls[3] == site.group_count, "every group is moved");
    CLAIM(is_same(plan.group[own], made[3]), "a group is what its functions made of it");

    const elmopp_lamps_t lamps = lamps_of(&plan);
    const elmopp_lamps_t shown = lamps_shown(plan.group, site.group_count);
    CLAIM((has(lamps.red, own) == has(shown.red, own)) && (has(lamps.amber, own) == has(shown.amber, own)) &&
              (has(lamps.green, own) == has(shown.green, own)) && (!has(lamps.flash, own)),
          "the lamps are those of the groups");
    REACHABLE();
}
