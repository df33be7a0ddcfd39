/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Whatever state the plan is in that it can reach, whatever is wished and changed in every tick: after one tick any
/// two conflicting groups are again not both off red, and a start has its intergreen. With prove_plan_starts_apart this
/// is unbounded time.

#include "invariant.h"

void harness(void) {
    const elmopp_junction_t junction = any_junction();
    const uint32_t g = any_group_among_others(&junction);
    elmopp_plan_group_t before[ELMOPP_GROUP_MAX];
    elmopp_plan_group_t ended[ELMOPP_GROUP_MAX];
    /* A stage never holds two groups in conflict: elmopp_site_check_stage(); all red holds none. */
    const uint32_t kept = nondet_u16();
    ASSUME((!has(kept, g)) || ((kept & junction.conflict[g]) == 0U));

    ASSUME(group_is_consistent(&junction.group[g], &before[g]));
    for (uint32_t h = 0U; h < junction.group_count; h++) {
        if (has(junction.conflict[g], h)) {
            ASSUME(group_is_consistent(&junction.group[h], &before[h]));
            ASSUME(pair_holds(&junction, before, g, h));
        }
        ended[h] = elmopp_plan_end(&junction.group[h], before[h], has(kept, h));
    }
    elmopp_plan_group_t after[ELMOPP_GROUP_MAX];
    after[g] = elmopp_plan_older(elmopp_plan_start(&junction, ended, g, has(kept, g)), nondet_bool());
    CLAIM(group_is_consistent(&junction.group[g], &after[g]), "a group stays consistent");

    const uint32_t h = nondet_u8();
    ASSUME((h < junction.group_count) && has(junction.conflict[g], h));
    after[h] = elmopp_plan_older(elmopp_plan_start(&junction, ended, h, has(kept, h)), nondet_bool());
    CLAIM(pair_holds(&junction, after, g, h), "a pair stays apart");
    REACHABLE();
}
