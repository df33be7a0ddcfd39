/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/plan.h"

#include "elmopp/assert.h"

#include <string.h>

static uint16_t older(uint16_t age_ds) {
    return (age_ds < UINT16_MAX) ? (uint16_t)(age_ds + 1U) : age_ds;
}

static elmopp_plan_group_t show(elmopp_plan_group_t group, elmopp_aspect_t aspect) {
    elmopp_plan_group_t next = group;
    next.aspect = aspect;
    next.age_ds = 0U;
    return next;
}

void elmopp_plan_init(elmopp_plan_t *self, const elmopp_junction_t *junction) {
    *self = (elmopp_plan_t){.junction = junction,
                            .change_ds = elmopp_junction_change_ds(junction),
                            .target = ELMOPP_STAGE_NONE,
                            .stage = ELMOPP_STAGE_NONE,
                            .settled = true};
    for (uint32_t g = 0U; g < ELMOPP_GROUP_MAX; g++) {
        self->group[g].aspect = ELMOPP_ASPECT_RED;
        self->group[g].age_ds = 1U;
    }
}

/* --- one group --- */

elmopp_plan_group_t elmopp_plan_end(const elmopp_group_t *site, elmopp_plan_group_t before, bool keep) {
    elmopp_plan_group_t next = before;
    if ((next.aspect == ELMOPP_ASPECT_GREEN) && (!keep) && (next.age_ds >= site->min_green_ds)) {
        next = show(next, ELMOPP_ASPECT_AMBER);
    }
    /* Not an else: without amber a group turns from green to red in one tick. */
    if ((next.aspect == ELMOPP_ASPECT_AMBER) && (next.age_ds >= site->amber_ds)) {
        next = show(next, ELMOPP_ASPECT_RED);
    }
    return next;
}

/* True if every conflicting group is red and its intergreen will have run out when the red-amber is over. */
static bool is_clear(const elmopp_junction_t *junction, const elmopp_plan_group_t ended[ELMOPP_GROUP_MAX], uint32_t g) {
    for (uint32_t h = 0U; h < junction->group_count; h++) {
        if (elmopp_mask_has(junction->conflict[g], h)) {
            const uint32_t free_ds = (uint32_t)ended[h].since_green_ds + junction->group[g].red_amber_ds;
            if ((ended[h].aspect != ELMOPP_ASPECT_RED) || (free_ds < junction->intergreen_ds[h][g])) {
                return false;
            }
        }
    }
    return true;
}

elmopp_plan_group_t elmopp_plan_start(const elmopp_junction_t *junction,
                                      const elmopp_plan_group_t ended[ELMOPP_GROUP_MAX], uint32_t g, bool keep) {
    elmopp_plan_group_t next = ended[g];
    /* Red is shown for a tick at least: an amber that has just ended is followed by no start. */
    if (keep && (next.aspect == ELMOPP_ASPECT_RED) && (next.age_ds > 0U) && is_clear(junction, ended, g)) {
        next = show(next, ELMOPP_ASPECT_RED_AMBER);
    }
    /* Not an else: without red-amber a group turns from red to green in one tick. A red-amber always ends in green:
       meanwhile it has kept every conflicting group red. */
    if ((next.aspect == ELMOPP_ASPECT_RED_AMBER) && (next.age_ds >= junction->group[g].red_amber_ds)) {
        next = show(next, ELMOPP_ASPECT_GREEN);
    }
    return next;
}

elmopp_plan_group_t elmopp_plan_hold(elmopp_plan_group_t ended, elmopp_plan_group_t started, bool held) {
    const bool stays = held && (ended.aspect == ELMOPP_ASPECT_RED);
    return stays ? ended : started;
}

elmopp_plan_group_t elmopp_plan_older(elmopp_plan_group_t started, bool contested) {
    const bool green = started.aspect == ELMOPP_ASPECT_GREEN;
    const bool goes_on = green && (contested || (started.contested_ds > 0U));
    elmopp_plan_group_t next = started;
    next.age_ds = older(next.age_ds);
    next.since_green_ds = green ? (uint16_t)0U : older(next.since_green_ds);
    next.contested_ds = goes_on ? older(next.contested_ds) : (uint16_t)0U;
    return next;
}

/* --- who waits --- */

static uint16_t green_groups(const elmopp_plan_t *self) {
    uint16_t green = 0U;
    for (uint32_t g = 0U; g < self->junction->group_count; g++) {
        if (self->group[g].aspect == ELMOPP_ASPECT_GREEN) {
            green |= (uint16_t)((uint32_t)1U << g);
        }
    }
    return green;
}

/* Somebody who has asked once waits until his movement goes: the camera may have lost sight of him. */
static void note_demand(elmopp_plan_t *self, bool serving, uint32_t demand) {
    const uint16_t green = green_groups(self);
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const bool asks = elmopp_mask_has(demand, j) || (self->wait_ds[j] > 0U);
        const bool waits = serving && asks && (!elmopp_junction_goes(self->junction, j, green));
        self->wait_ds[j] = waits ? older(self->wait_ds[j]) : (uint16_t)0U;
    }
}

/* Groups that somebody waits for. */
static uint16_t wanted_groups(const elmopp_plan_t *self) {
    uint32_t groups = 0U;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        if (self->wait_ds[j] > 0U) {
            groups |= self->junction->movement[j].groups;
        }
    }
    return (uint16_t)groups;
}

/* Of the movements that need one of these groups the one that has waited longest, the lowest index among equals;
   ELMOPP_MOVEMENT_MAX if none waits. */
static uint32_t longest_waiting(const elmopp_plan_t *self, uint16_t groups) {
    uint32_t found = ELMOPP_MOVEMENT_MAX;
    uint16_t longest_ds = 0U;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const bool concerned = (self->junction->movement[j].groups & groups) != 0U;
        if (concerned && (self->wait_ds[j] > longest_ds)) {
            found = j;
            longest_ds = self->wait_ds[j];
        }
    }
    return found;
}

/* --- where to go --- */

/* How many rescue stages it takes to serve all who have waited at least so long. */
static uint32_t rescues(const elmopp_plan_t *self, uint16_t wait_ds) {
    uint32_t stages = 0U;
    uint32_t count = 0U;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const uint32_t stage = self->junction->rescue_stage[j];
        if ((self->wait_ds[j] >= wait_ds) && (!elmopp_mask_has(stages, stage))) {
            stages |= (uint32_t)1U << stage;
            count++;
        }
    }
    return count;
}

/* Somebody's bound is so near that all who have waited as long must be served now, one after the other. */
static bool is_pressing(const elmopp_plan_t *self) {
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const uint16_t wait_ds = self->wait_ds[j];
        if (wait_ds > 0U) {
            const uint32_t needed_ds = (1U + rescues(self, wait_ds)) * self->change_ds;
            if ((wait_ds + needed_ds) >= self->junction->red_bound_ds) {
                return true;
            }
        }
    }
    return false;
}

static elmopp_stage_t first_stage_for(const elmopp_junction_t *junction, uint32_t movement) {
    elmopp_stage_t found = ELMOPP_STAGE_NONE;
    for (uint32_t s = junction->stage_count; s > 0U; s--) {
        if (elmopp_junction_goes(junction, movement, junction->stage_groups[s - 1U])) {
            found = (elmopp_stage_t)(s - 1U);
        }
    }
    return found;
}

/* The stage that the bound on red asks for, ELMOPP_STAGE_NONE if it is far. */
static elmopp_stage_t rescue(const elmopp_plan_t *self) {
    const bool pressing = (self->junction->red_bound_ds != 0U) && is_pressing(self);
    const uint32_t oldest = pressing ? longest_waiting(self, UINT16_MAX) : ELMOPP_MOVEMENT_MAX;
    return (oldest < ELMOPP_MOVEMENT_MAX) ? self->junction->rescue_stage[oldest] : (elmopp_stage_t)ELMOPP_STAGE_NONE;
}

/* The stage that a green beyond its maximum gives way to, ELMOPP_STAGE_NONE if there is none; the first such group
   decides. */
static elmopp_stage_t relief(const elmopp_plan_t *self) {
    for (uint32_t g = 0U; g < self->junction->group_count; g++) {
        const uint16_t max_ds = self->junction->group[g].max_green_ds;
        if ((max_ds != 0U) && (self->group[g].contested_ds >= max_ds)) {
            const uint32_t movement = longest_waiting(self, self->junction->conflict[g]);
            if (movement < ELMOPP_MOVEMENT_MAX) {
                return first_stage_for(self->junction, movement);
            }
        }
    }
    return ELMOPP_STAGE_NONE;
}

/* A street's green rests where nobody waits. The first wish of all is heard: all red is no rest. */
static bool rests(const elmopp_plan_t *self) {
    return (self->junction->simulation_only == 0U) && (self->target != ELMOPP_STAGE_NONE) &&
           (longest_waiting(self, UINT16_MAX) == ELMOPP_MOVEMENT_MAX);
}

/* The next target of a plan that shows its last one. */
static void retarget(elmopp_plan_t *self, elmopp_stage_t wanted) {
    self->waited_ds = 0U; /* no change is under way */
    elmopp_stage_t overruling = rescue(self);
    if (overruling == ELMOPP_STAGE_NONE) {
        overruling = relief(self);
    }
    self->forced = (wanted != ELMOPP_STAGE_RED) && (overruling != ELMOPP_STAGE_NONE);
    if (wanted == ELMOPP_STAGE_RED) {
        self->target = ELMOPP_STAGE_NONE;
    } else if (self->forced) {
        self->target = overruling;
    } else if ((wanted != ELMOPP_STAGE_NONE) && (!rests(self))) {
        self->target = wanted;
    } else {
        /* nothing new */
    }
}

/* --- a tick --- */

static uint16_t target_groups(const elmopp_plan_t *self) {
    return (self->target == ELMOPP_STAGE_NONE) ? (uint16_t)0U : self->junction->stage_groups[self->target];
}

static void move_groups(elmopp_plan_t *self, uint16_t wanted, bool occupied) {
    const elmopp_junction_t *junction = self->junction;
    const uint16_t kept = target_groups(self);
    const bool held = occupied && (self->waited_ds < junction->junction_wait_ds);
    bool waits = false;
    elmopp_plan_group_t ended[ELMOPP_GROUP_MAX];
    (void)memcpy(ended, self->group, sizeof ended);
    for (uint32_t g = 0U; g < junction->group_count; g++) {
        ended[g] = elmopp_plan_end(&junction->group[g], self->group[g], elmopp_mask_has(kept, g));
    }
    for (uint32_t g = 0U; g < junction->group_count; g++) {
        const elmopp_plan_group_t free = elmopp_plan_start(junction, ended, g, elmopp_mask_has(kept, g));
        const elmopp_plan_group_t started = elmopp_plan_hold(ended[g], free, held);
        self->group[g] = elmopp_plan_older(started, (junction->conflict[g] & wanted) != 0U);
        waits = waits || (started.aspect != free.aspect);
    }
    /* Only a tick that cost somebody his start counts: the whole wait is left when the clearance has run out. */
    self->waited_ds = waits ? older(self->waited_ds) : self->waited_ds;
}

static elmopp_lamps_t lamps_of(const elmopp_plan_t *self) {
    elmopp_lamps_t lamps = {0U, 0U, 0U, 0U};
    for (uint32_t g = 0U; g < self->junction->group_count; g++) {
        elmopp_lamps_show(&lamps, g, self->group[g].aspect);
    }
    return lamps;
}

elmopp_lamps_t elmopp_plan_step(elmopp_plan_t *self, elmopp_stage_t wanted, uint32_t demand, bool occupied) {
    ELMOPP_ASSERT((wanted == ELMOPP_STAGE_NONE) || (wanted == ELMOPP_STAGE_RED) ||
                  (wanted < self->junction->stage_count));
    note_demand(self, wanted != ELMOPP_STAGE_RED, demand);
    if (self->settled) {
        retarget(self, wanted);
    }
    move_groups(self, wanted_groups(self), occupied);
    const elmopp_lamps_t lamps = lamps_of(self);
    self->settled = (lamps.green == target_groups(self)) && (lamps.amber == 0U);
    const elmopp_stage_t stage = self->settled ? self->target : (elmopp_stage_t)ELMOPP_STAGE_NONE;
    const bool shown = stage != ELMOPP_STAGE_NONE;
    const uint16_t before_ds = (stage == self->stage) ? self->elapsed_ds : (uint16_t)0U;
    self->elapsed_ds = shown ? older(before_ds) : (uint16_t)0U;
    self->stage = stage;
    return lamps;
}
