/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Whatever the groups show and however long the junction is occupied: with the wait a group starts only in a tick in
/// which it would start without it, to the same aspect, and then keeps may_follow() against every conflicting group, so
/// that no intergreen is ever shorter than without the wait or than the site's. All that the wait can do to a group is
/// to leave it red: it ends no green, lengthens no amber or red-amber, and without a sign it does nothing.

#include "invariant.h"

void harness(void) {
    const elmopp_junction_t junction = any_junction();
    elmopp_plan_group_t ended[ELMOPP_GROUP_MAX];
    const uint32_t g = nondet_u8();
    const uint32_t h = nondet_u8();
    ASSUME((g < junction.group_count) && (h < junction.group_count) && has(junction.conflict[g], h));

    const bool keep = nondet_bool();
    const bool held = nondet_bool();
    const elmopp_plan_group_t free = elmopp_plan_start(&junction, ended, g, keep);
    const elmopp_plan_group_t waiting = elmopp_plan_hold(ended[g], free, held);
    const bool starts = waiting.aspect != ended[g].aspect;
    CLAIM((!starts) || is_same(waiting, free), "a group starts only as it would without the wait");
    CLAIM(is_same(waiting, free) || (held && is_same(waiting, ended[g]) && (ended[g].aspect == ELMOPP_ASPECT_RED)),
          "all that the wait does is to leave a group red");
    CLAIM((!held) || (ended[g].aspect != ELMOPP_ASPECT_RED) || is_same(waiting, ended[g]), "what is held stays red");
    CLAIM(may_follow(&junction.group[g], junction.intergreen_ds[h][g], ended[g], ended[h], keep, waiting),
          "a group that was held starts only when a conflicting one is clear");
    REACHABLE();
}
