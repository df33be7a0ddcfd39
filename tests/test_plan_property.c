/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The plan against a second opinion under random wishes and demands: every site as shipped, and with random times.

#include "elmopp/plan.h"
#include "elmopp/site.h"
#include "plan_oracle.h"
#include "plan_tick.h"
#include "random.h"
#include "sites.h"
#include "unity.h"

#ifndef TICKS /* both fewer on the emulated board */
#define TICKS 200000U
#define SEEDS_OF_RANDOM_TIMES 4U
#endif
#define TICKS_OF_RANDOM_TIMES 50000U
#define LONGEST_MIN_GREEN_DS 120U

static elmopp_junction_t junction;
static elmopp_plan_t plan;
static plan_oracle_t oracle;
static uint64_t seed;
static bool occupied;           ///< the junction
static uint32_t occupied_every; ///< ticks, until that changes

void setUp(void) {}
void tearDown(void) {}

static void restart(void) {
    occupied = false;
    occupied_every = 50U;
    elmopp_plan_init(&plan, &junction);
    plan_oracle_init(&oracle, &junction);
}

static void begin(const elmopp_junction_t *site, uint64_t new_seed) {
    junction = *site;
    seed = new_seed;
    restart();
}

static void tick(elmopp_stage_t wanted, uint32_t demand) {
    occupied = (random_below(&seed, occupied_every) == 0U) ? !occupied : occupied;
    const elmopp_lamps_t lamps = elmopp_plan_step(&plan, wanted, demand, occupied);
    if (!plan_oracle_judge(&oracle, wanted, demand, occupied, lamps, &plan)) {
        TEST_FAIL_MESSAGE(oracle.complaint);
    }
}

static uint16_t plan_green(void) {
    uint32_t green = 0U;
    for (uint32_t g = 0U; g < junction.group_count; g++) {
        green |= (plan.group[g].aspect == ELMOPP_ASPECT_GREEN) ? (1U << g) : 0U;
    }
    return (uint16_t)green;
}

/* One in eight is no wish. */
static elmopp_stage_t random_wish(void) {
    const uint32_t none = random_below(&seed, 8U);
    return (none == 0U) ? (elmopp_stage_t)ELMOPP_STAGE_NONE : (elmopp_stage_t)random_below(&seed, junction.stage_count);
}

static uint32_t random_demand(void) {
    const uint64_t few = random_next(&seed) & random_next(&seed) & random_next(&seed);
    return (uint32_t)(few & ((1U << junction.movement_count) - 1U));
}

static uint32_t movements_of_stage(uint32_t stage) {
    return elmopp_junction_served(&junction, junction.stage_groups[stage]);
}

/* After red everywhere nobody waits. A wish with nobody but its own people waiting is shown when the change under way
   and its own have had their time. */
static void hold_until_shown(void) {
    const elmopp_stage_t wanted = (elmopp_stage_t)random_below(&seed, junction.stage_count);
    const uint32_t bound = 2U * plan_oracle_bound(&junction);
    for (uint32_t i = 0U; i <= bound; i++) {
        tick(ELMOPP_STAGE_RED, 0U);
    }
    TEST_ASSERT_EQUAL_HEX16_MESSAGE(0U, plan_green(), "not red everywhere");
    for (uint32_t i = 0U; (i <= bound) && (plan.stage != wanted); i++) {
        tick(wanted, movements_of_stage(wanted));
    }
    TEST_ASSERT_EQUAL_UINT8_MESSAGE(wanted, plan.stage, "not shown within its bound");
}

/* A movement that alone waits gets its green however stubborn the wish, if every group has a maximum. */
static void hold_against_demand(void) {
    const uint32_t j = random_below(&seed, junction.movement_count);
    const elmopp_stage_t wanted = (elmopp_stage_t)random_below(&seed, junction.stage_count);
    uint32_t max_ds = 0U;
    for (uint32_t h = 0U; h < junction.group_count; h++) {
        const uint32_t own_ds = junction.group[h].max_green_ds;
        if (own_ds == 0U) {
            return;
        }
        max_ds = (own_ds > max_ds) ? own_ds : max_ds;
    }
    const uint32_t bound = (2U * max_ds) + (30U * plan_oracle_bound(&junction));
    for (uint32_t i = 0U; (i <= bound) && ((i == 0U) || (plan.wait_ds[j] > 0U)); i++) {
        tick(wanted, (uint32_t)1U << j);
    }
    TEST_ASSERT_EQUAL_UINT16_MESSAGE(0U, plan.wait_ds[j], "waits longer than its bound");
}

/* Wish and demand change at random: every tick, now and then, or hardly ever, so that maximum greens come about. */
static void wander(uint32_t ticks) {
    static const uint32_t calm[3] = {1U, 60U, 900U};
    const uint32_t wish_every = calm[random_below(&seed, 3U)];
    const uint32_t demand_every = calm[random_below(&seed, 3U)];
    occupied_every = calm[random_below(&seed, 3U)];
    elmopp_stage_t wanted = random_wish();
    uint32_t demand = random_demand();
    for (uint32_t i = 0U; i < ticks; i++) {
        wanted = (random_below(&seed, wish_every) == 0U) ? random_wish() : wanted;
        demand = (random_below(&seed, demand_every) == 0U) ? random_demand() : demand;
        tick(wanted, demand);
    }
}

static void wander_and_hold(uint32_t ticks) {
    while (oracle.now < (long long)ticks) {
        wander(random_below(&seed, 3000U));
        hold_until_shown();
        wander(random_below(&seed, 100U));
        hold_against_demand();
    }
}

static void test_every_site_as_shipped_keeps_all_rules(void) {
    for (uint32_t i = 0U; i < TEST_SITE_COUNT; i++) {
        begin(test_sites[i], 1000U + i);
        wander_and_hold(TICKS);
        const bool has_maximum = junction.group[0].max_green_ds != 0U;
        TEST_ASSERT_EQUAL_INT_MESSAGE(has_maximum, oracle.forced > 10U, "the test never met a maximum green");
    }
}

static void draw_times(void) {
    for (uint32_t g = 0U; g < junction.group_count; g++) {
        elmopp_group_t *group = &junction.group[g];
        group->amber_ds = random_between(&seed, 30U, 60U);
        group->red_amber_ds = (random_below(&seed, 2U) == 0U) ? (uint16_t)0U : random_between(&seed, 1U, 20U);
        group->min_green_ds = random_between(&seed, 50U, LONGEST_MIN_GREEN_DS);
        group->max_green_ds = (uint16_t)(group->min_green_ds + random_between(&seed, 0U, 150U));
    }
    for (uint32_t g = 0U; g < junction.group_count; g++) {
        for (uint32_t h = 0U; h < junction.group_count; h++) {
            const uint32_t least_ds = (uint32_t)junction.group[g].amber_ds + junction.group[h].red_amber_ds;
            const bool conflict = (((uint32_t)junction.conflict[g] >> h) & 1U) != 0U;
            junction.intergreen_ds[g][h] = conflict ? random_between(&seed, least_ds, least_ds + 40U) : (uint16_t)0U;
        }
    }
    junction.junction_wait_ds = (uint16_t)random_below(&seed, ELMOPP_SITE_JUNCTION_WAIT_MAX_DS + 1U);
    junction.red_bound_ds =
        (uint16_t)(elmopp_site_red_bound_min_ds(&junction) + random_below(&seed, 3U) * random_below(&seed, 600U));
    for (uint32_t p = 0U; p < junction.program_count; p++) {
        for (uint32_t i = 0U; i < junction.program[p].step_count; i++) {
            junction.program[p].step[i].green_ds = LONGEST_MIN_GREEN_DS;
        }
    }
    if (junction.program_count == 0U) {
        test_rescue_program(&junction, LONGEST_MIN_GREEN_DS); /* the paper's site has none */
    }
    junction.simulation_only = 0U;
    junction.discharge = ELMOPP_DISCHARGE_SATURATION;
    TEST_ASSERT_EQUAL_INT(ELMOPP_SITE_OK, elmopp_site_check(&junction).fault);
    restart();
}

static void test_every_site_with_random_times_keeps_all_rules(void) {
    uint32_t rescued = 0U;
    uint32_t waits = 0U;
    for (uint32_t i = 0U; i < TEST_SITE_COUNT * SEEDS_OF_RANDOM_TIMES; i++) {
        begin(test_sites[i % TEST_SITE_COUNT], 2000U + i);
        draw_times();
        wander_and_hold(TICKS_OF_RANDOM_TIMES);
        TEST_ASSERT_TRUE_MESSAGE((oracle.forced + oracle.rescued) > 10U, "the test never met a limit");
        waits += oracle.waits;
        rescued += oracle.rescued;
    }
    TEST_ASSERT_TRUE_MESSAGE(rescued > (25U * SEEDS_OF_RANDOM_TIMES), "the test never met the bound on red");
    TEST_ASSERT_TRUE_MESSAGE(waits > (250U * SEEDS_OF_RANDOM_TIMES), "the test hardly met an occupied junction");
}

/* The largest junction there can be, all groups in conflict. */
static void test_sixteen_groups_in_conflict_keep_all_rules(void) {
    const elmopp_junction_t largest = test_cross(ELMOPP_GROUP_MAX);
    begin(&largest, 3000U);
    draw_times();
    wander_and_hold(TICKS_OF_RANDOM_TIMES);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_every_site_as_shipped_keeps_all_rules);
    RUN_TEST(test_every_site_with_random_times_keeps_all_rules);
    RUN_TEST(test_sixteen_groups_in_conflict_keep_all_rules);
    return UNITY_END();
}
