/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// A stage that elmopp_site_check_stage() passes holds no two groups in conflict, and no group that the site has not.

#include "arbitrary.h"

void harness(void) {
    const elmopp_junction_t junction = any_junction();
    const uint32_t stage = nondet_u8();
    ASSUME(stage < junction.stage_count);
    const uint32_t g = nondet_u8();
    const uint32_t h = nondet_u8();
    ASSUME((g < junction.group_count) && (h < junction.group_count));

    const bool passed = elmopp_site_check_stage(&junction, stage).fault == ELMOPP_SITE_OK;
    const uint32_t groups = junction.stage_groups[stage];
    const bool clash = has(groups, g) && has(groups, h) && has(junction.conflict[g], h);
    CLAIM((!passed) || (!clash), "no stage holds a conflict");
    CLAIM((!passed) || ((groups >> junction.group_count) == 0U), "every group of a stage exists");
    REACHABLE();
}
