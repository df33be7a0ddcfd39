/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// From any state that the plan can reach, with a monitor that has seen it and lamps that do as they are told, one tick
/// of the plan is passed by the monitor, and the monitor has seen it again. Of elmopp_plan_start() of the groups that
/// conflict with the one that is judged it uses what prove_plan_starts_only_when_clear has claimed.

#include "invariant.h"

elmopp_monitor_t nondet_monitor(void);
elmopp_plan_group_t nondet_group(void);

static void assume_state(const elmopp_junction_t *junction, const elmopp_monitor_t *monitor,
                         const elmopp_plan_group_t before[ELMOPP_GROUP_MAX], uint32_t g) {
    ASSUME(group_is_consistent(&junction->group[g], &before[g]));
    ASSUME(monitor_agrees(monitor, &before[g], g));
}

void harness(void) {
    const elmopp_junction_t junction = any_junction();
    const uint32_t g = any_group_among_others(&junction);
    elmopp_monitor_t monitor = nondet_monitor();
    monitor.junction = &junction;
    elmopp_plan_group_t before[ELMOPP_GROUP_MAX];
    elmopp_plan_group_t ended[ELMOPP_GROUP_MAX];
    elmopp_plan_group_t after[ELMOPP_GROUP_MAX];
    const uint32_t kept = nondet_u16();
    ASSUME((!has(kept, g)) || ((kept & junction.conflict[g]) == 0U)); /* elmopp_site_check_stage() */

    assume_state(&junction, &monitor, before, g);
    for (uint32_t h = 0U; h < junction.group_count; h++) {
        if (has(junction.conflict[g], h)) {
            assume_state(&junction, &monitor, before, h);
            ASSUME(pair_holds(&junction, before, g, h));
        }
        ended[h] = elmopp_plan_end(&junction.group[h], before[h], has(kept, h));
    }
    const bool held = nondet_bool();
    for (uint32_t h = 0U; h < junction.group_count; h++) {
        const elmopp_plan_group_t started =
            (h == g) ? elmopp_plan_start(&junction, ended, g, has(kept, g)) : nondet_group();
        ASSUME((!has(junction.conflict[g], h)) ||
               may_follow(&junction.group[h], junction.intergreen_ds[g][h], ended[h], ended[g], has(kept, h), started));
        after[h] = elmopp_plan_older(elmopp_plan_hold(ended[h], started, held), nondet_bool());
        /* prove_plan_keeps_its_invariant */
        ASSUME((!has(junction.conflict[g], h)) || pair_holds(&junction, after, g, h));
    }

    elmopp_monitor_input_t input = {.command = lamps_shown(after, junction.group_count), .measured = monitor.last};
    input.fresh = UINT16_MAX;
    input.mode = ELMOPP_MODE_AUTOMATIC;
    CLAIM(elmopp_monitor_judge_group(&monitor, &input, g) == ELMOPP_FAULT_NONE, "the monitor passes the plan");
    elmopp_monitor_remember_group(&monitor, &input, g);
    monitor.last = input.command;
    CLAIM(monitor_agrees(&monitor, &after[g], g), "the monitor has seen the tick");
    REACHABLE();
}
