/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The plan's start fulfils the invariant of prove_plan_keeps_its_invariant, whatever the site.

#include "invariant.h"

void harness(void) {
    const elmopp_junction_t junction = any_junction();
    uint32_t g;
    uint32_t h;
    any_conflict(&junction, &g, &h);
    elmopp_plan_t plan;
    elmopp_plan_init(&plan, &junction);
    CLAIM(group_is_consistent(&junction.group[g], &plan.group[g]), "a group starts well");
    CLAIM(pair_holds(&junction, plan.group, g, h), "a pair starts apart");
    CLAIM((plan.target == ELMOPP_STAGE_NONE) && plan.settled, "nothing is aimed at");
    REACHABLE();
}
