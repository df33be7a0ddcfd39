/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Where plan and monitor stand after any number of lamp ticks from the start.

#ifndef ELMOPP_PROOF_INVARIANT_H
#define ELMOPP_PROOF_INVARIANT_H

#include "arbitrary.h"

#include "elmopp/monitor.h"
#include "elmopp/plan.h"

/// An aspect of a plan. Unsigned: an enum may hold any number.
static inline bool is_shown(uint32_t aspect) {
    return (aspect >= (uint32_t)ELMOPP_ASPECT_RED) && (aspect <= (uint32_t)ELMOPP_ASPECT_AMBER);
}

/// One group by itself.
static inline bool group_is_consistent(const elmopp_group_t *site, const elmopp_plan_group_t *group) {
    const uint32_t aspect = (uint32_t)group->aspect;
    const bool red_amber = (aspect != (uint32_t)ELMOPP_ASPECT_RED_AMBER) || (group->age_ds <= site->red_amber_ds);
    const bool amber = (aspect != (uint32_t)ELMOPP_ASPECT_AMBER) || (group->age_ds <= site->amber_ds);
    const bool green = (aspect != (uint32_t)ELMOPP_ASPECT_GREEN) || (group->since_green_ds == 0U);
    return is_shown(aspect) && red_amber && amber && green && (group->age_ds >= 1U);
}

/// A group against one that it conflicts with: not both are off red, and if it is on its way to green it will be late
/// enough.
static inline bool is_apart(const elmopp_group_t *site, uint32_t intergreen_ds, elmopp_plan_group_t own,
                            elmopp_plan_group_t other) {
    const uint32_t to_green_ds = (uint32_t)site->red_amber_ds - own.age_ds;
    const bool late_enough = ((uint32_t)other.since_green_ds + to_green_ds) >= intergreen_ds;
    return (own.aspect == ELMOPP_ASPECT_RED) ||
           ((other.aspect == ELMOPP_ASPECT_RED) && ((own.aspect != ELMOPP_ASPECT_RED_AMBER) || late_enough));
}

static inline bool pair_holds(const elmopp_junction_t *junction, const elmopp_plan_group_t group[ELMOPP_GROUP_MAX],
                              uint32_t g, uint32_t h) {
    return is_apart(&junction->group[g], junction->intergreen_ds[h][g], group[g], group[h]) &&
           is_apart(&junction->group[h], junction->intergreen_ds[g][h], group[h], group[g]);
}

static inline bool is_same(elmopp_plan_group_t one, elmopp_plan_group_t other) {
    return (one.aspect == other.aspect) && (one.age_ds == other.age_ds) &&
           (one.since_green_ds == other.since_green_ds) && (one.contested_ds == other.contested_ds);
}

/// What elmopp_plan_start() may make of a group beside one that it conflicts with: of red-amber whose time is up green;
/// of red, if the target keeps the group, the other is red and its intergreen will have run out, red-amber, or green
/// where the site has no red-amber; of everything else nothing.
static inline bool may_follow(const elmopp_group_t *site, uint32_t intergreen_ds, elmopp_plan_group_t own,
                              elmopp_plan_group_t other, bool keep, elmopp_plan_group_t next) {
    const uint32_t free_ds = (uint32_t)other.since_green_ds + site->red_amber_ds;
    const bool clear = (other.aspect == ELMOPP_ASPECT_RED) && (free_ds >= intergreen_ds);
    const bool fresh =
        (next.age_ds == 0U) && (next.since_green_ds == own.since_green_ds) && (next.contested_ds == own.contested_ds);
    const bool green = fresh && (next.aspect == ELMOPP_ASPECT_GREEN);
    const bool red_amber = fresh && (next.aspect == ELMOPP_ASPECT_RED_AMBER);
    const bool in_time = (own.aspect == ELMOPP_ASPECT_RED_AMBER) && (own.age_ds >= site->red_amber_ds);
    const bool from_red = (own.aspect == ELMOPP_ASPECT_RED) && (own.age_ds > 0U) && keep && clear;
    return in_time ? green : (is_same(own, next) || (from_red && ((site->red_amber_ds > 0U) ? red_amber : green)));
}

/// A change that takes so long holds a group's minimum green and what must pass until others start after it, the wait
/// for an occupied junction, and the tick in which it begins.
static inline bool is_no_longer(const elmopp_group_t *site, uint32_t intergreen_ds, uint32_t wait_ds,
                                uint32_t change_ds) {
    const uint32_t lamps_ds = (uint32_t)site->amber_ds + site->red_amber_ds;
    const uint32_t clear_ds = (intergreen_ds > lamps_ds) ? intergreen_ds : lamps_ds;
    return (site->min_green_ds + clear_ds + wait_ds + 1U) < change_ds;
}

/// The monitor has seen what the plan has shown of this group.
static inline bool monitor_agrees(const elmopp_monitor_t *monitor, const elmopp_plan_group_t *group, uint32_t g) {
    const bool red = (group->aspect == ELMOPP_ASPECT_RED) || (group->aspect == ELMOPP_ASPECT_RED_AMBER);
    const bool amber = (group->aspect == ELMOPP_ASPECT_AMBER) || (group->aspect == ELMOPP_ASPECT_RED_AMBER);
    const bool green = group->aspect == ELMOPP_ASPECT_GREEN;
    return (has(monitor->last.red, g) == red) && (has(monitor->last.amber, g) == amber) &&
           (has(monitor->last.green, g) == green) && (!has(monitor->last.flash, g)) &&
           ((monitor->age_ds[g] == group->age_ds) || (group->aspect == ELMOPP_ASPECT_RED)) &&
           (monitor->since_green_ds[g] == group->since_green_ds);
}

/// The lamps of the plan's groups, as bits, written apart from lamps.c.
static inline elmopp_lamps_t lamps_shown(const elmopp_plan_group_t group[ELMOPP_GROUP_MAX], uint32_t count) {
    elmopp_lamps_t all = {0U, 0U, 0U, 0U};
    for (uint32_t g = 0U; g < count; g++) {
        const uint16_t own = (uint16_t)(1U << g);
        const elmopp_aspect_t aspect = group[g].aspect;
        const bool red = (aspect == ELMOPP_ASPECT_RED) || (aspect == ELMOPP_ASPECT_RED_AMBER);
        const bool amber = (aspect == ELMOPP_ASPECT_AMBER) || (aspect == ELMOPP_ASPECT_RED_AMBER);
        all.red = (uint16_t)(all.red | (red ? own : 0U));
        all.amber = (uint16_t)(all.amber | (amber ? own : 0U));
        all.green = (uint16_t)(all.green | ((aspect == ELMOPP_ASPECT_GREEN) ? own : 0U));
    }
    return all;
}

#endif
