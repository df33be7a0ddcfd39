/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The plan's two pure functions over all that matters, and every change between two stages of every site.

#include "elmopp/plan.h"
#include "plan_tick.h"
#include "sites.h"
#include "unity.h"

#include <stdio.h>

#define SETTLE_LIMIT 2000U

void setUp(void) {}
void tearDown(void) {}

static void expect_group(elmopp_plan_group_t right, elmopp_plan_group_t group, const char *where) {
    TEST_ASSERT_EQUAL_INT_MESSAGE(right.aspect, group.aspect, where);
    TEST_ASSERT_EQUAL_UINT16_MESSAGE(right.age_ds, group.age_ds, where);
    TEST_ASSERT_EQUAL_UINT16_MESSAGE(right.since_green_ds, group.since_green_ds, where);
    TEST_ASSERT_EQUAL_UINT16_MESSAGE(right.contested_ds, group.contested_ds, where);
}

static elmopp_plan_group_t turned(elmopp_plan_group_t group, elmopp_aspect_t aspect) {
    group.aspect = aspect;
    group.age_ds = 0U;
    return group;
}

/* The table of plan.h, a row an aspect. */
static elmopp_plan_group_t end_of(const elmopp_group_t *site, elmopp_plan_group_t before, bool keep) {
    switch (before.aspect) {
    case ELMOPP_ASPECT_GREEN:
        if (keep || (before.age_ds < site->min_green_ds)) {
            return before;
        }
        return turned(before, (site->amber_ds == 0U) ? ELMOPP_ASPECT_RED : ELMOPP_ASPECT_AMBER);
    case ELMOPP_ASPECT_AMBER:
        return (before.age_ds < site->amber_ds) ? before : turned(before, ELMOPP_ASPECT_RED);
    case ELMOPP_ASPECT_RED_AMBER:
    case ELMOPP_ASPECT_RED:
    case ELMOPP_ASPECT_DARK:
    case ELMOPP_ASPECT_FLASH_AMBER:
    case ELMOPP_ASPECT_FLASH_RED:
    case ELMOPP_ASPECT_COUNT:
    default:
        return before;
    }
}

static void check_end(const elmopp_group_t *site, elmopp_aspect_t aspect, uint16_t age_ds) {
    const elmopp_plan_group_t before = {aspect, age_ds, 77U, 88U};
    for (uint32_t keep = 0U; keep < 2U; keep++) {
        char where[80];
        (void)snprintf(where, sizeof where, "aspect %d, age %u, keep %u", (int)aspect, (unsigned)age_ds,
                       (unsigned)keep);
        expect_group(end_of(site, before, keep == 1U), elmopp_plan_end(site, before, keep == 1U), where);
    }
}

static uint32_t longest_time(const elmopp_group_t *site) {
    uint32_t longest = site->amber_ds;
    longest = (site->red_amber_ds > longest) ? site->red_amber_ds : longest;
    longest = (site->min_green_ds > longest) ? site->min_green_ds : longest;
    return (site->max_green_ds > longest) ? site->max_green_ds : longest;
}

static void test_a_group_ends_as_told_at_every_age_in_every_aspect(void) {
    static const elmopp_group_t odd[] = {
        {.amber_ds = 0U, .min_green_ds = 0U},
        {.amber_ds = 1U, .min_green_ds = 1U, .red_amber_ds = 1U},
        {.amber_ds = 60U, .min_green_ds = 20U, .max_green_ds = 30U},
    };
    const elmopp_group_t *const sites[] = {&elmopp_site_paper.group[0], &elmopp_site_four_way.group[0], &odd[0],
                                           &odd[1], &odd[2]};
    for (uint32_t i = 0U; i < 5U; i++) {
        for (elmopp_aspect_t aspect = ELMOPP_ASPECT_RED; aspect <= ELMOPP_ASPECT_AMBER; aspect++) {
            for (uint32_t age_ds = 0U; age_ds <= longest_time(sites[i]) + 2U; age_ds++) {
                check_end(sites[i], aspect, (uint16_t)age_ds);
            }
            check_end(sites[i], aspect, UINT16_MAX);
        }
    }
}

/* Group 1 before group 0, with which alone it conflicts. */
static elmopp_plan_group_t start_of(const elmopp_junction_t *junction, const elmopp_plan_group_t ended[2], bool keep) {
    const elmopp_plan_group_t before = ended[1];
    const uint32_t since_ds = ended[0].since_green_ds;
    const uint32_t intergreen_ds = junction->intergreen_ds[0][1];
    const uint32_t red_amber_ds = junction->group[1].red_amber_ds;
    const bool red = ended[0].aspect == ELMOPP_ASPECT_RED;
    const bool may_prepare = red && ((since_ds + red_amber_ds) >= intergreen_ds);
    const elmopp_plan_group_t green = turned(before, ELMOPP_ASPECT_GREEN);
    if ((before.aspect == ELMOPP_ASPECT_RED) && (before.age_ds > 0U) && keep && may_prepare) {
        return (red_amber_ds == 0U) ? green : turned(before, ELMOPP_ASPECT_RED_AMBER);
    }
    if ((before.aspect == ELMOPP_ASPECT_RED_AMBER) && (before.age_ds >= red_amber_ds)) {
        return green;
    }
    return before;
}

static void check_start(const elmopp_junction_t *junction, elmopp_plan_group_t other, elmopp_plan_group_t own) {
    const elmopp_plan_group_t ended[ELMOPP_GROUP_MAX] = {other, own};
    for (uint32_t keep = 0U; keep < 2U; keep++) {
        char where[120];
        (void)snprintf(where, sizeof where, "aspect %d, age %u, other %d since %u, keep %u", (int)own.aspect,
                       (unsigned)own.age_ds, (int)other.aspect, (unsigned)other.since_green_ds, (unsigned)keep);
        expect_group(start_of(junction, ended, keep == 1U), elmopp_plan_start(junction, ended, 1U, keep == 1U), where);
    }
}

static void check_all_starts(const elmopp_junction_t *junction, elmopp_aspect_t other, elmopp_aspect_t own) {
    const uint32_t last_ds = junction->intergreen_ds[0][1] + 2U;
    for (uint32_t since_ds = 0U; since_ds <= last_ds; since_ds++) {
        for (uint32_t age_ds = 0U; age_ds <= junction->group[1].red_amber_ds + 2U; age_ds++) {
            check_start(junction, (elmopp_plan_group_t){other, 5U, (uint16_t)since_ds, 6U},
                        (elmopp_plan_group_t){own, (uint16_t)age_ds, 77U, 88U});
        }
    }
    check_start(junction, (elmopp_plan_group_t){other, 5U, UINT16_MAX, 6U},
                (elmopp_plan_group_t){own, UINT16_MAX, 77U, 88U});
}

static void test_a_group_starts_as_told_at_every_age_in_every_aspect(void) {
    elmopp_junction_t junction = test_cross(2U);
    for (uint16_t red_amber_ds = 0U; red_amber_ds <= 10U; red_amber_ds = (uint16_t)(red_amber_ds + 5U)) {
        junction.group[1].red_amber_ds = red_amber_ds;
        for (elmopp_aspect_t other = ELMOPP_ASPECT_RED; other <= ELMOPP_ASPECT_AMBER; other++) {
            for (elmopp_aspect_t own = ELMOPP_ASPECT_RED; own <= ELMOPP_ASPECT_AMBER; own++) {
                check_all_starts(&junction, other, own);
            }
        }
    }
}

static void test_each_conflicting_group_alone_blocks_a_start(void) {
    const elmopp_junction_t junction = test_cross(ELMOPP_GROUP_MAX);
    const elmopp_plan_group_t free = {ELMOPP_ASPECT_RED, 500U, 500U, 0U};
    for (uint32_t g = 0U; g < ELMOPP_GROUP_MAX; g++) {
        for (uint32_t h = 0U; h < ELMOPP_GROUP_MAX; h++) {
            elmopp_plan_group_t ended[ELMOPP_GROUP_MAX];
            for (uint32_t i = 0U; i < ELMOPP_GROUP_MAX; i++) {
                ended[i] = free;
            }
            ended[h].since_green_ds = CROSS_INTERGREEN_DS - CROSS_RED_AMBER_DS - 1U;
            const elmopp_aspect_t right = (g == h) ? ELMOPP_ASPECT_RED_AMBER : ELMOPP_ASPECT_RED;
            TEST_ASSERT_EQUAL_INT(right, elmopp_plan_start(&junction, ended, g, true).aspect);
        }
    }
}

static void test_a_held_group_stays_red_and_nothing_else_is_held(void) {
    for (elmopp_aspect_t ended = ELMOPP_ASPECT_RED; ended <= ELMOPP_ASPECT_AMBER; ended++) {
        for (elmopp_aspect_t started = ELMOPP_ASPECT_RED; started <= ELMOPP_ASPECT_AMBER; started++) {
            const elmopp_plan_group_t one = {ended, 5U, 6U, 7U};
            const elmopp_plan_group_t other = {started, 0U, 8U, 9U};
            expect_group(other, elmopp_plan_hold(one, other, false), "not held");
            expect_group((ended == ELMOPP_ASPECT_RED) ? one : other, elmopp_plan_hold(one, other, true), "held");
        }
    }
}

/* --- every change --- */

static uint32_t later(uint32_t one, uint32_t other) {
    return (one > other) ? one : other;
}

static bool has(uint32_t mask, uint32_t g) {
    return ((mask >> g) & 1U) != 0U;
}

/* From the site alone: ticks from the end of the first green until only the groups of `to` are green and no amber
 * burns. */
static uint32_t change_time(const elmopp_junction_t *junction, uint32_t from, uint32_t to) {
    const uint32_t before = junction->stage_groups[from];
    const uint32_t after = junction->stage_groups[to];
    uint32_t ticks = 0U;
    for (uint32_t h = 0U; h < junction->group_count; h++) {
        if (has(before & ~after, h)) {
            ticks = later(ticks, junction->group[h].amber_ds);
            for (uint32_t g = 0U; g < junction->group_count; g++) {
                const bool counts = has(after & ~before, g) && has(junction->conflict[h], g);
                ticks = counts ? later(ticks, junction->intergreen_ds[h][g]) : ticks;
            }
        }
    }
    return ticks;
}

/* Ticks until the stage is shown, counted from the first tick with the wish: 0 if it is shown in that tick. */
static uint32_t bring_up(elmopp_plan_t *plan, uint32_t stage) {
    for (uint32_t tick = 0U; tick < SETTLE_LIMIT; tick++) {
        (void)plan_tick(plan, (elmopp_stage_t)stage, plan->junction->stage_groups[stage]);
        if (plan->stage == stage) {
            return tick;
        }
    }
    return SETTLE_LIMIT;
}

static void check_change(const elmopp_junction_t *junction, uint32_t from, uint32_t to) {
    char where[80];
    (void)snprintf(where, sizeof where, "%s: stage %u to %u", junction->name, (unsigned)from, (unsigned)to);
    elmopp_plan_t plan;
    elmopp_plan_init(&plan, junction);
    TEST_ASSERT_LESS_THAN_UINT32_MESSAGE(SETTLE_LIMIT, bring_up(&plan, from), where);
    for (uint32_t tick = 0U; tick < 100U; tick++) {
        (void)plan_tick(&plan, (elmopp_stage_t)from, 0U);
    }
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(change_time(junction, from, to), bring_up(&plan, to), where);
}

static void test_every_change_of_every_site_takes_just_as_long_as_its_intergreens(void) {
    for (uint32_t i = 0U; i < TEST_SITE_COUNT; i++) {
        for (uint32_t from = 0U; from < test_sites[i]->stage_count; from++) {
            for (uint32_t to = 0U; to < test_sites[i]->stage_count; to++) {
                check_change(test_sites[i], from, to);
            }
        }
    }
}

/* Without waiting: the change from `to` back begins in the tick after it is up. Bound: minimum green and intergreen. */
static void test_every_change_there_and_back_keeps_its_bound(void) {
    for (uint32_t i = 0U; i < TEST_SITE_COUNT; i++) {
        const elmopp_junction_t *const junction = test_sites[i];
        elmopp_plan_t plan;
        elmopp_plan_init(&plan, junction);
        for (uint32_t from = 0U; from < junction->stage_count; from++) {
            for (uint32_t to = 0U; to < junction->stage_count; to++) {
                const uint32_t bound = junction->group[0].min_green_ds + 100U;
                TEST_ASSERT_TRUE(bring_up(&plan, from) <= bound);
                TEST_ASSERT_TRUE(bring_up(&plan, to) <= bound);
            }
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_group_ends_as_told_at_every_age_in_every_aspect);
    RUN_TEST(test_a_group_starts_as_told_at_every_age_in_every_aspect);
    RUN_TEST(test_each_conflicting_group_alone_blocks_a_start);
    RUN_TEST(test_a_held_group_stays_red_and_nothing_else_is_held);
    RUN_TEST(test_every_change_of_every_site_takes_just_as_long_as_its_intergreens);
    RUN_TEST(test_every_change_there_and_back_keeps_its_bound);
    return UNITY_END();
}
