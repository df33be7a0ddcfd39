/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Whatever state the plan is in that it can reach, whatever is wished, changed and held in every tick: after one tick
/// any two conflicting groups are again not both off red, and a start has its intergreen. With prove_plan_starts_apart
/// this is unbounded time. Of elmopp_plan_start() only what prove_plan_starts_only_when_clear has claimed is used, and
/// of the other groups nothing: they can only keep these two from starting.

#include "invariant.h"

elmopp_plan_group_t nondet_group(void);

/* Any group that elmopp_plan_start() may return for `own` against a conflicting group. */
static elmopp_plan_group_t any_started(const elmopp_group_t *site, uint32_t intergreen_ds, elmopp_plan_group_t own,
                                       elmopp_plan_group_t other, bool keep) {
    const elmopp_plan_group_t started = nondet_group();
    ASSUME(may_follow(site, intergreen_ds, own, other, keep, started));
    return started;
}

void harness(void) {
    const elmopp_junction_t junction = any_junction();
    uint32_t g;
    uint32_t h;
    any_conflict(&junction, &g, &h);
    const elmopp_group_t site_g = junction.group[g];
    const elmopp_group_t site_h = junction.group[h];
    const uint32_t from_h_to_g_ds = junction.intergreen_ds[h][g];
    const uint32_t from_g_to_h_ds = junction.intergreen_ds[g][h];
    const elmopp_plan_group_t before_g = nondet_group();
    const elmopp_plan_group_t before_h = nondet_group();
    ASSUME(group_is_consistent(&site_g, &before_g) && group_is_consistent(&site_h, &before_h));
    ASSUME(is_apart(&site_g, from_h_to_g_ds, before_g, before_h));
    ASSUME(is_apart(&site_h, from_g_to_h_ds, before_h, before_g));
    /* A stage never holds two groups in conflict: elmopp_site_check_stage(); all red holds none. */
    const bool keep_g = nondet_bool();
    const bool keep_h = nondet_bool();
    ASSUME(!(keep_g && keep_h));

    const elmopp_plan_group_t ended_g = elmopp_plan_end(&site_g, before_g, keep_g);
    const elmopp_plan_group_t ended_h = elmopp_plan_end(&site_h, before_h, keep_h);
    const elmopp_plan_group_t started_g = any_started(&site_g, from_h_to_g_ds, ended_g, ended_h, keep_g);
    const elmopp_plan_group_t started_h = any_started(&site_h, from_g_to_h_ds, ended_h, ended_g, keep_h);
    const bool held = nondet_bool();
    const elmopp_plan_group_t after_g = elmopp_plan_older(elmopp_plan_hold(ended_g, started_g, held), nondet_bool());
    const elmopp_plan_group_t after_h = elmopp_plan_older(elmopp_plan_hold(ended_h, started_h, held), nondet_bool());

    CLAIM(group_is_consistent(&site_g, &after_g) && group_is_consistent(&site_h, &after_h), "groups stay consistent");
    CLAIM(is_apart(&site_g, from_h_to_g_ds, after_g, after_h), "a pair stays apart");
    CLAIM(is_apart(&site_h, from_g_to_h_ds, after_h, after_g), "a pair stays apart the other way round");
    REACHABLE();
}
