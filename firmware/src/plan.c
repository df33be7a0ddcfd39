/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/plan.h"

#include "elmopp/assert.h"

#include <string.h>

static uint16_t bit(uint32_t g) {
    return (uint16_t)((uint32_t)1U << g);
}

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
    *self = (elmopp_plan_t){.junction = junction, .target = ELMOPP_STAGE_NONE, .stage = ELMOPP_STAGE_NONE};
    for (uint32_t g = 0U; g < ELMOPP_GROUP_MAX; g++) {
        self->group[g].aspect = ELMOPP_ASPECT_RED;
        self->group[g].age_ds = UINT16_MAX;
        self->group[g].since_green_ds = UINT16_MAX;
    }
}

elmopp_plan_group_t elmopp_plan_end(const elmopp_group_t *site, elmopp_plan_group_t before, bool keep) {
    elmopp_plan_group_t next = before;
    if ((next.aspect == ELMOPP_ASPECT_GREEN) && (!keep) && (next.age_ds >= site->min_green_ds)) {
        next = show(next, ELMOPP_ASPECT_AMBER);
    }
    /* Not an else: without amber a group turns from green to red in one tick. */
    if ((next.aspect == ELMOPP_ASPECT_AMBER) && (next.age_ds >= site->amber_ds)) {
        next = show(next, ELMOPP_ASPECT_RED);
    }
    if ((next.aspect == ELMOPP_ASPECT_RED_AMBER) && (!keep)) {
        next = show(next, ELMOPP_ASPECT_RED);
    }
    return next;
}

/* True if every conflicting group is red and `ahead_ds` from now its intergreen towards g will have run out. */
static bool is_clear(const elmopp_junction_t *junction, const elmopp_plan_group_t ended[ELMOPP_GROUP_MAX], uint32_t g,
                     uint16_t ahead_ds) {
    for (uint32_t h = 0U; h < junction->group_count; h++) {
        if (elmopp_mask_has(junction->conflict[g], h)) {
            const uint32_t free_ds = (uint32_t)ended[h].since_green_ds + ahead_ds;
            if ((ended[h].aspect != ELMOPP_ASPECT_RED) || (free_ds < junction->intergreen_ds[h][g])) {
                return false;
            }
        }
    }
    return true;
}

elmopp_plan_group_t elmopp_plan_start(const elmopp_junction_t *junction,
                                      const elmopp_plan_group_t ended[ELMOPP_GROUP_MAX], uint32_t g, bool keep) {
    const uint16_t red_amber_ds = junction->group[g].red_amber_ds;
    elmopp_plan_group_t next = ended[g];
    if (keep && (next.aspect == ELMOPP_ASPECT_RED) && is_clear(junction, ended, g, red_amber_ds)) {
        next = show(next, ELMOPP_ASPECT_RED_AMBER);
    }
    /* Not an else: without red-amber a group turns from red to green in one tick. */
    if ((next.aspect == ELMOPP_ASPECT_RED_AMBER) && (next.age_ds >= red_amber_ds) && is_clear(junction, ended, g, 0U)) {
        next = show(next, ELMOPP_ASPECT_GREEN);
        next.contested_ds = 0U;
    }
    return next;
}

static uint16_t target_groups(const elmopp_plan_t *self) {
    return (self->target == ELMOPP_STAGE_NONE) ? (uint16_t)0U : self->junction->stage_groups[self->target];
}

/* Of the waiting movements that conflict with group g the one that has been red longest, the lowest index among equals;
   ELMOPP_MOVEMENT_MAX if there is none. */
static uint32_t longest_waiting(const elmopp_junction_t *junction, const elmopp_waiting_t *waiting, uint32_t g) {
    uint32_t found = ELMOPP_MOVEMENT_MAX;
    for (uint32_t j = 0U; j < junction->movement_count; j++) {
        const bool conflicts = (junction->movement[j].groups & junction->conflict[g]) != 0U;
        if (conflicts && elmopp_mask_has(waiting->movements, j) &&
            ((found == ELMOPP_MOVEMENT_MAX) || (waiting->red_ds[j] > waiting->red_ds[found]))) {
            found = j;
        }
    }
    return found;
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

/* A green that has outlasted its maximum overrules the wish; the first such group decides. */
static bool force(elmopp_plan_t *self, const elmopp_waiting_t *waiting) {
    for (uint32_t g = 0U; g < self->junction->group_count; g++) {
        const uint16_t max_ds = self->junction->group[g].max_green_ds;
        const bool over =
            (self->group[g].aspect == ELMOPP_ASPECT_GREEN) && (max_ds != 0U) && (self->group[g].contested_ds >= max_ds);
        const uint32_t movement = over ? longest_waiting(self->junction, waiting, g) : ELMOPP_MOVEMENT_MAX;
        if (movement < ELMOPP_MOVEMENT_MAX) {
            self->target = first_stage_for(self->junction, movement);
            return true;
        }
    }
    return false;
}

/* A wish is heard when the last one is fulfilled. */
static void retarget(elmopp_plan_t *self, elmopp_stage_t wanted, const elmopp_waiting_t *waiting) {
    const bool settled = self->stage == self->target;
    if (settled) {
        self->forced = force(self, waiting);
        if ((!self->forced) && (wanted != ELMOPP_STAGE_NONE)) {
            self->target = wanted;
        }
    }
}

static uint16_t groups_of(const elmopp_junction_t *junction, uint32_t movements) {
    uint16_t groups = 0U;
    for (uint32_t j = 0U; j < junction->movement_count; j++) {
        if (elmopp_mask_has(movements, j)) {
            groups |= junction->movement[j].groups;
        }
    }
    return groups;
}

static void move_groups(elmopp_plan_t *self, uint16_t demand) {
    const elmopp_junction_t *junction = self->junction;
    const uint16_t kept = target_groups(self);
    elmopp_plan_group_t ended[ELMOPP_GROUP_MAX];
    (void)memcpy(ended, self->group, sizeof ended);
    for (uint32_t g = 0U; g < junction->group_count; g++) {
        ended[g] = elmopp_plan_end(&junction->group[g], self->group[g], elmopp_mask_has(kept, g));
    }
    for (uint32_t g = 0U; g < junction->group_count; g++) {
        elmopp_plan_group_t next = elmopp_plan_start(junction, ended, g, elmopp_mask_has(kept, g));
        const bool green = next.aspect == ELMOPP_ASPECT_GREEN;
        next.age_ds = older(next.age_ds);
        next.since_green_ds = green ? (uint16_t)0U : older(next.since_green_ds);
        const bool contested = green && ((junction->conflict[g] & demand) != 0U);
        next.contested_ds =
            (contested || (green && (next.contested_ds > 0U))) ? older(next.contested_ds) : (uint16_t)0U;
        self->group[g] = next;
    }
}

static elmopp_lamps_t lamps_of(const elmopp_plan_t *self) {
    elmopp_lamps_t lamps = {0U, 0U, 0U};
    for (uint32_t g = 0U; g < self->junction->group_count; g++) {
        const elmopp_aspect_t aspect = self->group[g].aspect;
        if ((aspect == ELMOPP_ASPECT_RED) || (aspect == ELMOPP_ASPECT_RED_AMBER)) {
            lamps.red |= bit(g);
        }
        if ((aspect == ELMOPP_ASPECT_AMBER) || (aspect == ELMOPP_ASPECT_RED_AMBER)) {
            lamps.amber |= bit(g);
        }
        if (aspect == ELMOPP_ASPECT_GREEN) {
            lamps.green |= bit(g);
        }
    }
    return lamps;
}

elmopp_lamps_t elmopp_plan_step(elmopp_plan_t *self, elmopp_stage_t wanted, const elmopp_waiting_t *waiting) {
    ELMOPP_ASSERT((wanted == ELMOPP_STAGE_NONE) || (wanted < self->junction->stage_count));
    retarget(self, wanted, waiting);
    move_groups(self, groups_of(self->junction, waiting->movements));
    const elmopp_lamps_t lamps = lamps_of(self);
    const bool shown =
        (self->target != ELMOPP_STAGE_NONE) && (lamps.green == target_groups(self)) && (lamps.amber == 0U);
    const elmopp_stage_t stage = shown ? self->target : (elmopp_stage_t)ELMOPP_STAGE_NONE;
    self->elapsed_ds = (stage != self->stage) ? 0U : self->elapsed_ds;
    self->stage = stage;
    self->elapsed_ds = shown ? older(self->elapsed_ds) : (uint16_t)0U;
    return lamps;
}
