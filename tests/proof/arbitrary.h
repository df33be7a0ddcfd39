/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Arbitrary sites, as far as the loader's own predicates narrow them. A claim about one arbitrary group or pair of a
/// site of which only that part is known to be valid is a claim about every one of every valid site.

#ifndef ELMOPP_PROOF_ARBITRARY_H
#define ELMOPP_PROOF_ARBITRARY_H

#include "claims.h"

#include "elmopp/site.h"

elmopp_junction_t nondet_junction(void);

static inline bool has(uint32_t mask, uint32_t index) {
    return ((mask >> index) & 1U) != 0U;
}

static inline bool group_is_valid(const elmopp_junction_t *junction, uint32_t g) {
    return elmopp_site_check_group(junction, g).fault == ELMOPP_SITE_OK;
}

static inline bool pair_is_valid(const elmopp_junction_t *junction, uint32_t g, uint32_t h) {
    return (elmopp_site_check_pair(junction, g, h).fault == ELMOPP_SITE_OK) &&
           (elmopp_site_check_pair(junction, h, g).fault == ELMOPP_SITE_OK);
}

/// Any number of groups; nothing else is known.
static inline elmopp_junction_t any_junction(void) {
    const elmopp_junction_t junction = nondet_junction();
    ASSUME((junction.group_count >= 1U) && (junction.group_count <= ELMOPP_GROUP_MAX));
    ASSUME((junction.stage_count >= 1U) && (junction.stage_count <= ELMOPP_STAGE_MAX));
    return junction;
}

static inline uint32_t any_group(const elmopp_junction_t *junction) {
    const uint32_t g = nondet_u8();
    ASSUME(g < junction->group_count);
    ASSUME(group_is_valid(junction, g));
    return g;
}

/// Two valid groups in conflict.
static inline void any_conflict(const elmopp_junction_t *junction, uint32_t *g, uint32_t *h) {
    *g = any_group(junction);
    *h = any_group(junction);
    ASSUME(has(junction->conflict[*g], *h));
    ASSUME(pair_is_valid(junction, *g, *h));
}

/// A valid group, and valid pairs with all that conflict with it.
static inline uint32_t any_group_among_others(const elmopp_junction_t *junction) {
    const uint32_t g = any_group(junction);
    for (uint32_t h = 0U; h < junction->group_count; h++) {
        ASSUME(pair_is_valid(junction, g, h));
        ASSUME((!has(junction->conflict[g], h)) || group_is_valid(junction, h));
    }
    return g;
}

#endif
