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
    *self = (plan_oracle_t){
        .junction = junction, .now = -1, .shown = ELMOPP_STAGE_NONE, .target = ELMOPP_STAGE_NONE, .settled = true};
    for (uint32_t g = 0U; g < ELMOPP_GROUP_MAX; g++) {
        /* As if every green had ended in the first tick. */
        self->group[g] = (plan_oracle_group_t){'R', PLAN_ORACLE_NEVER, 0, PLAN_ORACLE_NEVER};
    }
    for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
        self->asked[j] = PLAN_ORACLE_NEVER;
    }
}

/* --- what the next stage must be --- */

static bool is_over(const plan_oracle_t *self, uint32_t g) {
    const plan_oracle_group_t *group = &self->group[g];
    const long long max = self->junction->group[g].max_green_ds;
    return (group->aspect == 'G') && (max != 0) && (group->contested != PLAN_ORACLE_NEVER) &&
           ((self->now - group->contested) >= max);
}

static bool goes(const plan_oracle_t *self, uint32_t j) {
    for (uint32_t g = 0U; g < self->junction->group_count; g++) {
        if (has(self->junction->movement[j].groups, g) && (self->group[g].aspect != 'G')) {
            return false;
        }
    }
    return true;
}

static void hear(plan_oracle_t *self, elmopp_stage_t wanted, uint32_t demand) {
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        if (goes(self, j) || (wanted == ELMOPP_STAGE_RED)) {
            self->asked[j] = PLAN_ORACLE_NEVER;
        } else if (has(demand, j) && (self->asked[j] == PLAN_ORACLE_NEVER)) {
            self->asked[j] = self->now;
        } else {
            /* already waiting, or nobody */
        }
    }
}

static bool waits(const plan_oracle_t *self, uint32_t j) {
    return self->asked[j] != PLAN_ORACLE_NEVER;
}

/* Of those who need one of these groups, the one who asked first. */
static uint32_t first_to_ask(const plan_oracle_t *self, uint32_t groups) {
    uint32_t first = ELMOPP_MOVEMENT_MAX;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const bool earlier = (first == ELMOPP_MOVEMENT_MAX) || (self->asked[j] < self->asked[first]);
        if (waits(self, j) && earlier && ((self->junction->movement[j].groups & groups) != 0U)) {
            first = j;
        }
    }
    return first;
}

/* All stages that the site rescues by, up to and with this movement's turn, the oldest first. */
static uint32_t turns_until(const plan_oracle_t *self, uint32_t movement) {
    uint32_t turns = 0U;
    for (uint32_t s = 0U; s < self->junction->stage_count; s++) {
        bool needed = false;
        for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
            const bool older = waits(self, j) && (self->asked[j] <= self->asked[movement]);
            needed = needed || (older && (self->junction->rescue_stage[j] == s));
        }
        turns += needed ? 1U : 0U;
    }
    return turns;
}

static bool is_bound_near(const plan_oracle_t *self) {
    const long long change = plan_oracle_bound(self->junction);
    for (uint32_t j = 0U; (self->junction->red_bound_ds != 0U) && (j < self->junction->movement_count); j++) {
        const long long waited = (self->now - self->asked[j]) + 1;
        if (waits(self, j) && ((waited + ((1 + turns_until(self, j)) * change)) >= self->junction->red_bound_ds)) {
            return true;
        }
    }
    return false;
}

static uint32_t stage_with(const elmopp_junction_t *junction, uint32_t movement) {
    uint32_t s = 0U;
    while ((junction->stage_groups[s] & junction->movement[movement].groups) != junction->movement[movement].groups) {
        s++;
    }
    return s;
}

/* Whom a green beyond its maximum gives way to. */
static uint32_t relieved(const plan_oracle_t *self) {
    uint32_t movement = ELMOPP_MOVEMENT_MAX;
    for (uint32_t g = 0U; (g < self->junction->group_count) && (movement == ELMOPP_MOVEMENT_MAX); g++) {
        movement = is_over(self, g) ? first_to_ask(self, self->junction->conflict[g]) : movement;
    }
    return movement;
}

static void expect_target(plan_oracle_t *self, elmopp_stage_t wanted) {
    const uint32_t oldest = first_to_ask(self, 0xFFFFU);
    const bool street = self->junction->simulation_only == 0U;
    if (!self->settled) {
        return;
    }
    if (wanted == ELMOPP_STAGE_RED) {
        self->target = ELMOPP_STAGE_NONE;
    } else if (is_bound_near(self)) {
        self->target = self->junction->rescue_stage[oldest];
        self->rescued++;
    } else if (relieved(self) != ELMOPP_MOVEMENT_MAX) {
        self->target = stage_with(self->junction, relieved(self));
        self->forced++;
    } else if ((wanted == ELMOPP_STAGE_NONE) ||
               (street && (oldest == ELMOPP_MOVEMENT_MAX) && (self->target != ELMOPP_STAGE_NONE))) {
        /* nothing to do */
    } else {
        self->target = wanted;
    }
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

static uint32_t asked_groups(const plan_oracle_t *self) {
    uint32_t groups = 0U;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        groups |= waits(self, j) ? self->junction->movement[j].groups : 0U;
    }
    return groups;
}

static bool judge_groups(plan_oracle_t *self, elmopp_lamps_t lamps) {
    const uint32_t demand = asked_groups(self);
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
    self->settled = (self->target == ELMOPP_STAGE_NONE) ? ((lamps.green | lamps.amber) == 0U) : (shown == self->target);
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

/* Came off red in this tick. */
static bool has_begun(const plan_oracle_t *self, uint32_t g) {
    const plan_oracle_group_t *group = &self->group[g];
    const char first = (self->junction->group[g].red_amber_ds == 0U) ? 'G' : 'B';
    return (group->since == self->now) && (group->aspect == first);
}

/* Is red, as it was a tick ago, and could begin: everybody in its way is red, and when its red-amber is over, their
   intergreens will be, too. */
static bool could_begin(const plan_oracle_t *self, uint32_t g) {
    const bool wanted = (self->target != ELMOPP_STAGE_NONE) && has(self->junction->stage_groups[self->target], g);
    bool clear = wanted && (self->group[g].aspect == 'R') && (self->group[g].since < self->now);
    for (uint32_t h = 0U; h < self->junction->group_count; h++) {
        const long long free = (self->now - self->group[h].ended) + self->junction->group[g].red_amber_ds;
        const bool in_the_way = (self->group[h].aspect != 'R') || (free < self->junction->intergreen_ds[h][g]);
        clear = clear && (!(has(self->junction->conflict[g], h) && in_the_way));
    }
    return clear;
}

/* While the junction is occupied nothing begins, for so long as the site allows a change; otherwise nothing waits. */
static bool judge_wait(plan_oracle_t *self, bool occupied) {
    self->held = occupied && (self->waited < self->junction->junction_wait_ds);
    bool ready = false;
    for (uint32_t g = 0U; g < self->junction->group_count; g++) {
        ready = ready || could_begin(self, g);
        if (self->held && has_begun(self, g)) {
            return complain(self, "begins while the junction is occupied", g, self->waited);
        }
    }
    if (ready && (!self->held)) {
        return complain(self, "waits without a reason", self->waited, occupied ? 1U : 0U);
    }
    self->waited += ready ? 1U : 0U;
    self->waits += ready ? 1U : 0U;
    return true;
}

/* Green begins no later than it may: nothing of the target stays red while all it waits for has run out. */
static bool judge_haste(plan_oracle_t *self) {
    if (self->held) {
        return true;
    }
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

/* The bound on red, and nothing but the bound. */
static bool judge_waits(plan_oracle_t *self) {
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const long long waited = waits(self, j) ? ((self->now - self->asked[j]) + 1) : 0;
        self->longest_wait = (waited > self->longest_wait) ? waited : self->longest_wait;
        if ((self->junction->red_bound_ds != 0U) && (waited > self->junction->red_bound_ds)) {
            return complain(self, "waits beyond the bound on red", j, (uint32_t)waited);
        }
    }
    return true;
}

bool plan_oracle_judge(plan_oracle_t *self, elmopp_stage_t wanted, uint32_t demand, bool occupied, elmopp_lamps_t lamps,
                       const elmopp_plan_t *plan) {
    self->now++;
    self->waited = self->settled ? 0U : self->waited;
    hear(self, wanted, demand);
    expect_target(self, wanted);
    return judge_groups(self, lamps) && judge_wait(self, occupied) && judge_state(self, lamps, plan) &&
           judge_haste(self) && judge_waits(self);
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
    return green_ds + clearance_ds + junction->junction_wait_ds + 2U;
}
