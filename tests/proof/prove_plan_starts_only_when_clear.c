/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Whatever the groups show, be it what the plan can reach or not: elmopp_plan_start() keeps may_follow() against every
/// conflicting group. prove_plan_keeps_its_invariant builds on it.

#include "invariant.h"

void harness(void) {
    const elmopp_junction_t junction = any_junction();
    elmopp_plan_group_t ended[ELMOPP_GROUP_MAX];
    const uint32_t g = nondet_u8();
    const uint32_t h = nondet_u8();
    ASSUME((g < junction.group_count) && (h < junction.group_count) && has(junction.conflict[g], h));

    const bool keep = nondet_bool();
    const elmopp_plan_group_t started = elmopp_plan_start(&junction, ended, g, keep);
    CLAIM(may_follow(&junction.group[g], junction.intergreen_ds[h][g], ended[g], ended[h], keep, started),
          "a group starts only when a conflicting one is clear");
    REACHABLE();
}
