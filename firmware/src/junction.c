/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/junction.h"

#include "elmopp/assert.h"

/* Load at which the Greenshields parabola k (1 - k) is highest. */
#define GREENSHIELDS_TOP 0.5F

bool elmopp_junction_looks_ahead(const elmopp_junction_t *junction) {
    return (junction->chooser == (uint8_t)ELMOPP_CHOOSER_CUMULATIVE) ||
           (junction->chooser == (uint8_t)ELMOPP_CHOOSER_ROLLOUT);
}

float elmopp_junction_load(const elmopp_junction_t *junction, uint32_t movement, float queue_veh) {
    ELMOPP_ASSERT(movement < junction->movement_count);
    const float capacity_veh = junction->movement[movement].capacity_veh;
    float load = 0.0F;
    if (capacity_veh > 0.0F) {
        load = queue_veh / capacity_veh;
    }
    return load;
}

float elmopp_junction_discharge(const elmopp_junction_t *junction, uint32_t movement, float queue_veh) {
    ELMOPP_ASSERT(movement < junction->movement_count);
    float flow_veh = junction->movement[movement].saturation_veh_per_s;
    if (junction->discharge != (uint8_t)ELMOPP_DISCHARGE_SATURATION) {
        float load = elmopp_junction_load(junction, movement, queue_veh);
        if ((junction->discharge == (uint8_t)ELMOPP_DISCHARGE_NOLOCK) && (load > GREENSHIELDS_TOP)) {
            load = GREENSHIELDS_TOP;
        }
        flow_veh = load * junction->free_flow_m_per_s * (1.0F - load);
    }
    /* An overfull lane (k > 1) stands; the parabola below zero would let vehicles come back. */
    flow_veh = (flow_veh > 0.0F) ? flow_veh : 0.0F;
    return (flow_veh < queue_veh) ? flow_veh : queue_veh;
}

uint32_t elmopp_junction_limit_km_per_h(const elmopp_junction_t *junction, uint32_t movement) {
    const uint32_t limit_km_per_h = junction->movement[movement].limit_km_per_h;
    return (limit_km_per_h == 0U) ? ELMOPP_JUNCTION_LIMIT_KM_PER_H : limit_km_per_h;
}

bool elmopp_mask_has(uint32_t mask, uint32_t index) {
    return ((mask >> index) & 1U) != 0U;
}

uint8_t elmopp_junction_nodes(const elmopp_junction_t *junction) {
    uint32_t nodes = 0U;
    for (uint32_t g = 0U; g < junction->group_count; g++) {
        nodes |= (uint32_t)1U << junction->group[g].node;
    }
    return (uint8_t)nodes;
}

uint16_t elmopp_junction_groups_of_node(const elmopp_junction_t *junction, uint32_t node) {
    uint32_t groups = 0U;
    for (uint32_t g = 0U; g < junction->group_count; g++) {
        groups |= (junction->group[g].node == node) ? ((uint32_t)1U << g) : 0U;
    }
    return (uint16_t)groups;
}

bool elmopp_junction_goes(const elmopp_junction_t *junction, uint32_t movement, uint16_t groups) {
    ELMOPP_ASSERT(movement < junction->movement_count);
    const uint16_t needed = junction->movement[movement].groups;
    return (needed & groups) == needed;
}

uint16_t elmopp_junction_groups(const elmopp_junction_t *junction) {
    return (uint16_t)(((uint32_t)1U << junction->group_count) - 1U);
}

uint32_t elmopp_junction_served(const elmopp_junction_t *junction, uint16_t groups) {
    uint32_t served = 0U;
    for (uint32_t j = 0U; j < junction->movement_count; j++) {
        if (elmopp_junction_goes(junction, j, groups)) {
            served |= (uint32_t)1U << j;
        }
    }
    return served;
}

/* The tick in which a change is asked for, and the one in which it is seen to be over. */
#define CHANGE_TICKS 2U

static uint32_t longer(uint32_t one, uint32_t other) {
    return (one > other) ? one : other;
}

/* How long it may take until a group is off and others may start after it. Its own red-amber counts: a group that
   conflicts with nobody has no intergreen that holds it. */
static uint32_t clearance_ds(const elmopp_junction_t *junction, uint32_t group) {
    const elmopp_group_t *times = &junction->group[group];
    uint32_t longest_ds = (uint32_t)times->amber_ds + times->red_amber_ds;
    for (uint32_t h = 0U; h < junction->group_count; h++) {
        longest_ds = longer(longest_ds, junction->intergreen_ds[group][h]);
    }
    return longest_ds;
}

uint32_t elmopp_junction_change_ds(const elmopp_junction_t *junction) {
    uint32_t green_ds = 0U;
    uint32_t clear_ds = 0U;
    for (uint32_t g = 0U; g < junction->group_count; g++) {
        green_ds = longer(green_ds, junction->group[g].min_green_ds);
        clear_ds = longer(clear_ds, clearance_ds(junction, g));
    }
    return green_ds + clear_ds + junction->junction_wait_ds + CHANGE_TICKS;
}

/* What one group that ends asks for: its amber, and its intergreens to all that start. */
static uint32_t ending_ds(const elmopp_junction_t *junction, uint32_t group, uint32_t starting) {
    uint32_t longest_ds = junction->group[group].amber_ds;
    for (uint32_t h = 0U; h < junction->group_count; h++) {
        if (elmopp_mask_has(starting, h)) {
            longest_ds = longer(longest_ds, junction->intergreen_ds[group][h]);
        }
    }
    return longest_ds;
}

uint32_t elmopp_junction_clearing_ds(const elmopp_junction_t *junction, uint16_t before, uint16_t after) {
    const uint32_t ending = (uint32_t)before & ~(uint32_t)after;
    const uint32_t starting = (uint32_t)after & ~(uint32_t)before;
    uint32_t longest_ds = 0U;
    for (uint32_t g = 0U; g < junction->group_count; g++) {
        if (elmopp_mask_has(ending, g)) {
            longest_ds = longer(longest_ds, ending_ds(junction, g, starting));
        }
        if (elmopp_mask_has(starting, g)) {
            longest_ds = longer(longest_ds, junction->group[g].red_amber_ds);
        }
    }
    return longest_ds;
}

uint32_t elmopp_junction_starting_ds(const elmopp_junction_t *junction, uint16_t before, uint16_t after) {
    const uint32_t starting = elmopp_junction_served(junction, after) & ~elmopp_junction_served(junction, before);
    uint32_t longest_ds = 0U;
    for (uint32_t j = 0U; j < junction->movement_count; j++) {
        if (elmopp_mask_has(starting, j)) {
            longest_ds = longer(longest_ds, junction->movement[j].startup_ds);
        }
    }
    return longest_ds;
}
