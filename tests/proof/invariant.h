/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Where plan and monitor stand after any number of lamp ticks from the start.

#ifndef ELMOPP_PROOF_INVARIANT_H
#define ELMOPP_PROOF_INVARIANT_H

#include "arbitrary.h"

#include "elmopp/monitor.h"
#include "elmopp/plan.h"

/// One group by itself. Unsigned: an enum may hold any number.
static inline bool group_is_consistent(const elmopp_group_t *site, const elmopp_plan_group_t *group) {
    const uint32_t aspect = (uint32_t)group->aspect;
    const bool shown = (aspect >= (uint32_t)ELMOPP_ASPECT_RED) && (aspect <= (uint32_t)ELMOPP_ASPECT_AMBER);
    const bool red_amber = (aspect != (uint32_t)ELMOPP_ASPECT_RED_AMBER) || (group->age_ds <= site->red_amber_ds);
    const bool amber = (aspect != (uint32_t)ELMOPP_ASPECT_AMBER) || (group->age_ds <= site->amber_ds);
    const bool green = (aspect != (uint32_t)ELMOPP_ASPECT_GREEN) || (group->since_green_ds == 0U);
    return shown && red_amber && amber && green && (group->age_ds >= 1U);
}

/// Two groups in conflict are not both off red, and one that is on its way to green will be late enough.
static inline bool is_apart(const elmopp_junction_t *junction, const elmopp_plan_group_t group[ELMOPP_GROUP_MAX],
                            uint32_t g, uint32_t h) {
    const uint32_t to_green_ds = (uint32_t)junction->group[g].red_amber_ds - group[g].age_ds;
    const bool late_enough = ((uint32_t)group[h].since_green_ds + to_green_ds) >= junction->intergreen_ds[h][g];
    return (group[g].aspect == ELMOPP_ASPECT_RED) ||
           ((group[h].aspect == ELMOPP_ASPECT_RED) && ((group[g].aspect != ELMOPP_ASPECT_RED_AMBER) || late_enough));
}

static inline bool pair_holds(const elmopp_junction_t *junction, const elmopp_plan_group_t group[ELMOPP_GROUP_MAX],
                              uint32_t g, uint32_t h) {
    return is_apart(junction, group, g, h) && is_apart(junction, group, h, g);
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
