/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// One step of the plan is its three pure functions applied to every group of the state before, and its lamps are those
/// of the groups: the loops add nothing. The target is a stage of the site or none.

#include "invariant.h"

elmopp_plan_t nondet_plan(void);

/* Level 0 asks these of a movement; here nobody waits, so that the wish decides. */
void harness(void) {
    elmopp_junction_t junction = any_junction();
    junction.movement_count = 0U;
    elmopp_plan_t plan = nondet_plan();
    plan.junction = &junction;
    ASSUME((plan.target == ELMOPP_STAGE_NONE) || (plan.target < junction.stage_count));
    const elmopp_stage_t wanted = nondet_u8();
    ASSUME((wanted == ELMOPP_STAGE_NONE) || (wanted == ELMOPP_STAGE_RED) || (wanted < junction.stage_count));
    const uint32_t g = nondet_u8();
    ASSUME(g < junction.group_count);

    const elmopp_plan_t before = plan;
    const elmopp_lamps_t lamps = elmopp_plan_step(&plan, wanted, nondet_u32());
    CLAIM((plan.target == ELMOPP_STAGE_NONE) || (plan.target < junction.stage_count), "the target exists");
    const uint32_t kept = (plan.target == ELMOPP_STAGE_NONE) ? 0U : junction.stage_groups[plan.target];

    elmopp_plan_group_t ended[ELMOPP_GROUP_MAX];
    for (uint32_t h = 0U; h < ELMOPP_GROUP_MAX; h++) {
        ended[h] = before.group[h];
        if (h < junction.group_count) {
            ended[h] = elmopp_plan_end(&junction.group[h], before.group[h], has(kept, h));
        }
    }
    const elmopp_plan_group_t right = elmopp_plan_older(elmopp_plan_start(&junction, ended, g, has(kept, g)), false);
    CLAIM((plan.group[g].aspect == right.aspect) && (plan.group[g].age_ds == right.age_ds) &&
              (plan.group[g].since_green_ds == right.since_green_ds) &&
              (plan.group[g].contested_ds == right.contested_ds),
          "a group moves by its three functions");

    const elmopp_lamps_t shown = lamps_shown(plan.group, junction.group_count);
    CLAIM((has(lamps.red, g) == has(shown.red, g)) && (has(lamps.amber, g) == has(shown.amber, g)) &&
              (has(lamps.green, g) == has(shown.green, g)) && (!has(lamps.flash, g)),
          "the lamps are those of the groups");
    REACHABLE();
}
