/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "plan_oracle.h"

#include <stdio.h>

static bool has(uint32_t mask, uint32_t g) {
    return ((mask >> g) & 1U) != 0U;
}

static bool complain(plan_oracle_t *self, const char *what, uint32_t first, uint32_t second) {
    (void)snprintf(self->complaint, sizeof self->complaint, "%s: %s [%u, %u] at tick %lld", self->junction->name, what,
                   (unsigned)first, (unsigned)second, self->now);
    return false;
}

void plan_oracle_init(plan_oracle_t *self, const elmopp_junction_t *junction) {
    *self = (plan_oracle_t){.junction = junction, .now = -1, .shown = ELMOPP_STAGE_NONE, .target = ELMOPP_STAGE_NONE};
    for (uint32_t g = 0U; g < ELMOPP_GROUP_MAX; g++) {
        self->group[g] = (plan_oracle_group_t){'R', PLAN_ORACLE_NEVER, PLAN_ORACLE_NEVER, PLAN_ORACLE_NEVER};
    }
}

/* --- what the next stage must be --- */

static bool is_over(const plan_oracle_t *self, uint32_t g) {
    const plan_oracle_group_t *group = &self->group[g];
    const long long max = self->junction->group[g].max_green_ds;
    return (group->aspect == 'G') && (max != 0) && (group->contested != PLAN_ORACLE_NEVER) &&
           ((self->now - group->contested) >= max);
}

/* Of the groups in `waiting`, the one whose green ended first. */
static uint32_t oldest_red(const plan_oracle_t *self, uint32_t waiting) {
    uint32_t oldest = ELMOPP_GROUP_MAX;
    long long ended = self->now + 1;
    for (uint32_t h = 0U; h < self->junction->group_count; h++) {
        if (has(waiting, h) && (self->group[h].ended < ended)) {
            oldest = h;
            ended = self->group[h].ended;
        }
    }
    return oldest;
}

static uint32_t stage_with(const elmopp_junction_t *junction, uint32_t g) {
    uint32_t s = 0U;
    while (!has(junction->stage_groups[s], g)) {
        s++;
    }
    return s;
}

static void expect_target(plan_oracle_t *self, elmopp_stage_t wanted, uint16_t demand) {
    if (self->shown != self->target) {
        return;
    }
    for (uint32_t g = 0U; g < self->junction->group_count; g++) {
        const uint32_t waiting = (uint32_t)self->junction->conflict[g] & demand;
        if (is_over(self, g) && (waiting != 0U)) {
            self->target = stage_with(self->junction, oldest_red(self, waiting));
            self->forced++;
            return;
        }
    }
    self->target = (wanted == ELMOPP_STAGE_NONE) ? self->target : wanted;
}

/* --- what the lamps may show --- */

static char aspect_of(elmopp_lamps_t lamps, uint32_t g) {
    const uint32_t code =
        (has(lamps.red, g) ? 4U : 0U) | (has(lamps.amber, g) ? 2U : 0U) | (has(lamps.green, g) ? 1U : 0U);
    return "?GY?RBB?"[code];
}

static bool is_unlit(elmopp_lamps_t lamps, uint32_t g) {
    return !has((uint32_t)lamps.red | lamps.amber | lamps.green, g);
}

/* Red, red with amber, green, amber, red; what lasts no time is left out. */
static bool may_follow(const elmopp_group_t *site, char before, char after) {
    switch (before) {
    case 'R':
        return (after == 'B') || ((after == 'G') && (site->red_amber_ds == 0U));
    case 'B':
        return after == 'G';
    case 'G':
        return (after == 'Y') || ((after == 'R') && (site->amber_ds == 0U));
    default:
        return after == 'R';
    }
}

static bool has_right_age(const elmopp_group_t *site, char aspect, long long age, bool at_its_end) {
    switch (aspect) {
    case 'B':
        return at_its_end ? (age == site->red_amber_ds) : (age < site->red_amber_ds);
    case 'Y':
        return at_its_end ? (age == site->amber_ds) : (age < site->amber_ds);
    case 'G':
        return (!at_its_end) || (age >= site->min_green_ds);
    default:
        return true;
    }
}

static bool judge_group(plan_oracle_t *self, uint32_t g, char aspect) {
    plan_oracle_group_t *group = &self->group[g];
    const elmopp_group_t *site = &self->junction->group[g];
    const bool changes = aspect != group->aspect;
    if (changes && (!may_follow(site, group->aspect, aspect))) {
        return complain(self, "wrong order of aspects", g, (uint32_t)aspect);
    }
    if (!has_right_age(site, group->aspect, self->now - group->since, changes)) {
        return complain(self, "aspect too short or too long", g, (uint32_t)group->aspect);
    }
    if (changes) {
        group->ended = (group->aspect == 'G') ? self->now : group->ended;
        group->contested = PLAN_ORACLE_NEVER;
        group->since = self->now;
        group->aspect = aspect;
    }
    return true;
}

static bool judge_pair(plan_oracle_t *self, uint32_t g, uint32_t h) {
    if (!has(self->junction->conflict[g], h)) {
        return true;
    }
    const plan_oracle_group_t *one = &self->group[g];
    const plan_oracle_group_t *other = &self->group[h];
    if ((one->aspect != 'R') && (other->aspect != 'R')) {
        return complain(self, "two conflicting groups are not red", g, h);
    }
    const bool starts = (one->aspect == 'G') && (one->since == self->now);
    if (starts && ((self->now - other->ended) < self->junction->intergreen_ds[h][g])) {
        return complain(self, "intergreen too short", h, g);
    }
    return true;
}

static bool judge_groups(plan_oracle_t *self, uint16_t demand, elmopp_lamps_t lamps) {
    for (uint32_t g = 0U; g < ELMOPP_GROUP_MAX; g++) {
        const bool exists = g < self->junction->group_count;
        const bool good = exists ? judge_group(self, g, aspect_of(lamps, g)) : is_unlit(lamps, g);
        if (!good) {
            return (self->complaint[0] == '\0') ? complain(self, "lamp without a group", g, 0U) : false;
        }
    }
    for (uint32_t g = 0U; g < self->junction->group_count; g++) {
        for (uint32_t h = 0U; h < self->junction->group_count; h++) {
            if (!judge_pair(self, g, h)) {
                return false;
            }
        }
        plan_oracle_group_t *group = &self->group[g];
        const bool contested = (group->aspect == 'G') && ((self->junction->conflict[g] & demand) != 0U);
        if (contested && (group->contested == PLAN_ORACLE_NEVER)) {
            group->contested = self->now;
        }
    }
    return true;
}

static uint32_t shown_stage(const plan_oracle_t *self, elmopp_lamps_t lamps) {
    for (uint32_t s = 0U; (s < self->junction->stage_count) && (lamps.amber == 0U); s++) {
        if ((s == self->target) && (self->junction->stage_groups[s] == lamps.green)) {
            return s;
        }
    }
    return ELMOPP_STAGE_NONE;
}

static bool judge_state(plan_oracle_t *self, elmopp_lamps_t lamps, const elmopp_plan_t *plan) {
    const uint32_t shown = shown_stage(self, lamps);
    if (shown != self->shown) {
        self->shown = shown;
        self->shown_since = self->now;
    }
    if (plan->target != self->target) {
        return complain(self, "wrong target", plan->target, self->target);
    }
    if (plan->stage != shown) {
        return complain(self, "wrong stage", plan->stage, shown);
    }
    const long long shown_for = (shown == ELMOPP_STAGE_NONE) ? 0 : ((self->now - self->shown_since) + 1);
    const long long elapsed = (shown_for < UINT16_MAX) ? shown_for : UINT16_MAX;
    return (plan->elapsed_ds == elapsed) || complain(self, "wrong elapsed time", plan->elapsed_ds, (uint32_t)elapsed);
}

/* Green begins no later than it may: nothing of the target stays red while all it waits for has run out. */
static bool judge_haste(plan_oracle_t *self) {
    for (uint32_t g = 0U; (self->target != ELMOPP_STAGE_NONE) && (g < self->junction->group_count); g++) {
        bool clear = has(self->junction->stage_groups[self->target], g) && (self->group[g].aspect != 'G') &&
                     (self->group[g].aspect != 'Y');
        for (uint32_t h = 0U; h < self->junction->group_count; h++) {
            const bool matters = has(self->junction->conflict[g], h);
            const bool ran_out = (self->group[h].aspect == 'R') &&
                                 ((self->now - self->group[h].ended) >= self->junction->intergreen_ds[h][g]);
            clear = clear && ((!matters) || ran_out);
        }
        const bool preparing = (self->group[g].aspect == 'B') &&
                               ((self->now - self->group[g].since) < self->junction->group[g].red_amber_ds);
        if (clear && (!preparing)) {
            return complain(self, "could be green", g, 0U);
        }
    }
    return true;
}

bool plan_oracle_judge(plan_oracle_t *self, elmopp_stage_t wanted, uint16_t demand, elmopp_lamps_t lamps,
                       const elmopp_plan_t *plan) {
    self->now++;
    expect_target(self, wanted, demand);
    return judge_groups(self, demand, lamps) && judge_state(self, lamps, plan) && judge_haste(self);
}

uint32_t plan_oracle_bound(const elmopp_junction_t *junction) {
    uint32_t green_ds = 0U;
    uint32_t clearance_ds = 0U;
    for (uint32_t g = 0U; g < junction->group_count; g++) {
        const elmopp_group_t *site = &junction->group[g];
        green_ds = (site->min_green_ds > green_ds) ? site->min_green_ds : green_ds;
        clearance_ds = (site->amber_ds > clearance_ds) ? site->amber_ds : clearance_ds;
        for (uint32_t h = 0U; h < junction->group_count; h++) {
            clearance_ds =
                (junction->intergreen_ds[g][h] > clearance_ds) ? junction->intergreen_ds[g][h] : clearance_ds;
        }
    }
    return green_ds + clearance_ds;
}
