/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// A plan that has shown its last target shows the next one within elmopp_junction_change_ds(): a measure of what is
/// left, in lamp ticks, is below that at first (PART 2), falls with every tick, of any group against any that conflicts
/// with it (PART 0) and of a group among all others (PART 1), and none is left but of a group that shows what the
/// target asks for. A tick in which a start is held for an occupied junction takes one of the wait's instead. Meanwhile
/// the target stays: elmopp_plan_step() looks for another only when it is shown. Of
/// elmopp_plan_start() PART 0 uses what prove_plan_starts_only_when_clear has claimed.

#include "invariant.h"

elmopp_plan_group_t nondet_group(void);

static uint32_t left_ds(uint32_t whole_ds, uint32_t past_ds) {
    return (whole_ds > past_ds) ? (whole_ds - past_ds) : 0U;
}

/* Ticks until a group that the target does not hold is red. */
static uint32_t until_red_ds(const elmopp_group_t *site, elmopp_plan_group_t group) {
    const uint32_t green_ds = left_ds(site->min_green_ds, group.age_ds) + 1U + site->amber_ds;
    const uint32_t amber_ds = left_ds(site->amber_ds, group.age_ds) + 1U;
    const bool green = group.aspect == ELMOPP_ASPECT_GREEN;
    return green ? green_ds : ((group.aspect == ELMOPP_ASPECT_AMBER) ? amber_ds : 0U);
}

/* Ticks until a group that the target holds is green, if nobody stands in its way. */
static uint32_t until_green_ds(const elmopp_group_t *site, elmopp_plan_group_t group) {
    const bool red = group.aspect == ELMOPP_ASPECT_RED;
    const uint32_t red_amber_ds = left_ds(site->red_amber_ds, red ? 0U : group.age_ds) + 1U;
    return (group.aspect == ELMOPP_ASPECT_GREEN) ? 0U : red_amber_ds;
}

/* Ticks until a red group can be green beside one that conflicts with it and that the target does not hold. */
static uint32_t until_clear_ds(const elmopp_group_t *own, const elmopp_group_t *other, uint32_t intergreen_ds,
                               elmopp_plan_group_t group) {
    const uint32_t green_ds = left_ds(other->min_green_ds, group.age_ds) + 1U + intergreen_ds;
    const uint32_t amber_ds = (group.aspect == ELMOPP_ASPECT_AMBER) ? left_ds(other->amber_ds, group.age_ds) : 0U;
    const uint32_t since_ds = left_ds(intergreen_ds, (uint32_t)group.since_green_ds + own->red_amber_ds);
    const uint32_t red_ds = ((amber_ds > since_ds) ? amber_ds : since_ds) + 1U + own->red_amber_ds;
    return (group.aspect == ELMOPP_ASPECT_GREEN) ? green_ds : red_ds;
}

/* A group that the target does not hold goes to red; one that it holds, to green. No change begins otherwise. */
static bool is_on_its_way(elmopp_plan_group_t group, bool keep) {
    return group.aspect != (keep ? ELMOPP_ASPECT_AMBER : ELMOPP_ASPECT_RED_AMBER);
}

static bool is_clear_of(const elmopp_group_t *own, uint32_t intergreen_ds, elmopp_plan_group_t other) {
    const uint32_t free_ds = (uint32_t)other.since_green_ds + own->red_amber_ds;
    return (other.aspect == ELMOPP_ASPECT_RED) && (free_ds >= intergreen_ds);
}

/* Any group `h` in the way of any group `g`, one tick. */
static void pair_falls(const elmopp_junction_t *junction, uint32_t budget_ds) {
    uint32_t g;
    uint32_t h;
    any_conflict(junction, &g, &h);
    const elmopp_group_t site_g = junction->group[g];
    const elmopp_group_t site_h = junction->group[h];
    const uint32_t intergreen_ds = junction->intergreen_ds[h][g];
    const uint32_t own_ds = site_g.red_amber_ds + 1U;
    const elmopp_plan_group_t before = nondet_group();
    const elmopp_plan_group_t other = nondet_group();
    ASSUME(group_is_consistent(&site_h, &before) && is_on_its_way(before, false));
    ASSUME(until_red_ds(&site_h, before) <= budget_ds);
    ASSUME(until_clear_ds(&site_g, &site_h, intergreen_ds, before) <= budget_ds);

    const elmopp_plan_group_t ended = elmopp_plan_end(&site_h, before, false);
    const elmopp_plan_group_t started = nondet_group();
    ASSUME(may_follow(&site_h, junction->intergreen_ds[g][h], ended, other, false, started));
    const elmopp_plan_group_t after = elmopp_plan_older(elmopp_plan_hold(ended, started, nondet_bool()), nondet_bool());

    CLAIM(is_on_its_way(after, false), "a group that the target does not hold does not start");
    CLAIM(until_red_ds(&site_h, after) < budget_ds, "it comes nearer to red");
    CLAIM((until_red_ds(&site_h, after) > 0U) || (after.aspect == ELMOPP_ASPECT_RED), "nothing is left: it is red");
    const uint32_t left = until_clear_ds(&site_g, &site_h, intergreen_ds, after);
    const bool clear = is_clear_of(&site_g, intergreen_ds, ended);
    CLAIM(clear ? (left == own_ds) : (left < budget_ds), "it is in the way for less time");
    CLAIM(clear || (own_ds < budget_ds), "if it hinders, more is left than the hindered group's red-amber");
}

/* Any group `g` that the target holds, among all others, one tick. */
static void group_falls(const elmopp_junction_t *junction) {
    const uint32_t g = any_group(junction);
    const elmopp_group_t site = junction->group[g];
    elmopp_plan_group_t ended[ELMOPP_GROUP_MAX];
    const elmopp_plan_group_t before = nondet_group();
    ASSUME(group_is_consistent(&site, &before) && is_on_its_way(before, true));
    ended[g] = elmopp_plan_end(&site, before, true);
    const bool hindered = nondet_bool() && (before.aspect == ELMOPP_ASPECT_RED);
    for (uint32_t h = 0U; h < junction->group_count; h++) {
        ASSUME(hindered || !has(junction->conflict[g], h) ||
               is_clear_of(&junction->group[g], junction->intergreen_ds[h][g], ended[h]));
    }

    const elmopp_plan_group_t free = elmopp_plan_start(junction, ended, g, true);
    const elmopp_plan_group_t started = elmopp_plan_hold(ended[g], free, nondet_bool());
    const bool waits = started.aspect != free.aspect; /* at most junction_wait_ds times: prove_plan_wait_ends */
    const elmopp_plan_group_t after = elmopp_plan_older(started, nondet_bool());

    const uint32_t was_ds = until_green_ds(&site, before);
    const uint32_t is_ds = until_green_ds(&site, after);
    CLAIM(is_on_its_way(after, true), "a group that the target holds does not end");
    CLAIM(hindered || waits || (was_ds == 0U) || (is_ds < was_ds), "it comes nearer to green unless hindered or held");
    CLAIM(is_ds <= was_ds, "it never goes away from green");
    CLAIM((is_ds > 0U) || (after.aspect == ELMOPP_ASPECT_GREEN), "nothing is left: it is green");
}

/* A new target: of the last one everything is green or red. */
static void change_suffices(const elmopp_junction_t *junction) {
    const uint32_t g = any_group(junction);
    const uint32_t h = any_group(junction);
    ASSUME(pair_is_valid(junction, g, h));
    const uint32_t intergreen_ds = junction->intergreen_ds[h][g];
    const elmopp_group_t site_g = junction->group[g];
    const elmopp_group_t site_h = junction->group[h];
    const elmopp_plan_group_t group = nondet_group();
    ASSUME((group.aspect == ELMOPP_ASPECT_GREEN) || (group.aspect == ELMOPP_ASPECT_RED));
    /* elmopp_junction_change_ds() is a maximum over all groups and pairs: test_junction */
    const uint32_t change_ds = nondet_u32();
    const uint32_t wait_ds = junction->junction_wait_ds;
    ASSUME(is_no_longer(&site_g, 0U, wait_ds, change_ds) && is_no_longer(&site_h, intergreen_ds, wait_ds, change_ds));
    CLAIM(is_on_its_way(group, nondet_bool()), "no change is under way");
    CLAIM((until_red_ds(&site_h, group) + wait_ds) < change_ds, "a change is enough for red");
    CLAIM((until_green_ds(&site_g, group) + wait_ds) < change_ds, "a change is enough for green");
    CLAIM((!has(junction->conflict[g], h)) ||
              ((until_clear_ds(&site_g, &site_h, intergreen_ds, group) + wait_ds) < change_ds),
          "a change is enough to clear the junction");
}

void harness(void) {
    const elmopp_junction_t junction = any_junction();
    const uint32_t budget_ds = nondet_u16();
    ASSUME(budget_ds > 0U);
    switch (PART) {
    case 0:
        pair_falls(&junction, budget_ds);
        break;
    case 1:
        group_falls(&junction);
        break;
    default:
        change_suffices(&junction);
        break;
    }
    REACHABLE();
}
