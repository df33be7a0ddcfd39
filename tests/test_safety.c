/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The plan under a hostile chooser, with the monitor and a second opinion looking on: every pair of stages, a change
/// of mind at every lamp tick, random junctions, decisions at random, late, out of range. And the monitor alone against
/// lamps that nobody planned.
///
///     test_safety          a short run
///     test_safety --all    every other stage at every tick of every change, and a million decisions

#include "elmopp/monitor.h"
#include "elmopp/site.h"
#include "plan_oracle.h"
#include "random.h"
#include "sites.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

#ifndef DECISIONS /* fewer on the emulated board */
#define DECISIONS 20000U
#define RANDOM_JUNCTIONS 60U
#endif
#ifndef OCCUPIED_DECISIONS
#define OCCUPIED_DECISIONS 2000U
#endif
#define DECISIONS_OF_ALL 1000000U
#define SETTLE_LIMIT 3000U
#define NOBODY 2U          ///< a mood of hostile_demand()
#define OCCUPIED_TICKS 40U ///< until the junction fills or empties, on average

static elmopp_junction_t junction;
static elmopp_plan_t plan;
static elmopp_monitor_t monitor;
static plan_oracle_t oracle;
static uint64_t seed;
static uint64_t box_seed; ///< of its own: who stands in the junction changes nothing else that is drawn
static bool occupied;
static bool everything;
static uint64_t ticks_judged;

void setUp(void) {}
void tearDown(void) {}

/* The lamps report what they were told a tick ago. */
static void tick(elmopp_stage_t wanted, uint32_t demand) {
    occupied = (random_below(&box_seed, OCCUPIED_TICKS) == 0U) ? !occupied : occupied;
    const elmopp_lamps_t lamps = elmopp_plan_step(&plan, wanted, demand, occupied);
    const elmopp_monitor_input_t input = {
        .command = lamps, .measured = monitor.last, .fresh = UINT16_MAX, .mode = ELMOPP_MODE_AUTOMATIC};
    if (elmopp_monitor_check(&monitor, &input) != ELMOPP_FAULT_NONE) {
        char message[120];
        (void)snprintf(message, sizeof message, "%s: the monitor says %s of group %u", junction.name,
                       elmopp_fault_name(monitor.first), (unsigned)monitor.first_group);
        TEST_FAIL_MESSAGE(message);
    }
    if (!plan_oracle_judge(&oracle, wanted, demand, occupied, lamps, &plan)) {
        TEST_FAIL_MESSAGE(oracle.complaint);
    }
    ticks_judged++;
}

/* As the mode table does: all red is shown before anything else. */
static void show_red_first(void) {
    tick(ELMOPP_STAGE_RED, 0U);
}

static void restart(void) {
    elmopp_plan_init(&plan, &junction);
    elmopp_monitor_init(&monitor, &junction);
    plan_oracle_init(&oracle, &junction);
    show_red_first();
}

static void start(const elmopp_junction_t *site) {
    junction = *site;
    restart();
}

static uint32_t served_by(uint32_t stage) {
    return elmopp_junction_served(&junction, junction.stage_groups[stage]);
}

/* Ticks until the stage is shown by somebody's wish for it. */
static uint32_t bring_up(uint32_t stage) {
    uint32_t ticks = 0U;
    while ((plan.stage != stage) && (ticks < SETTLE_LIMIT)) {
        tick((elmopp_stage_t)stage, served_by(stage));
        ticks++;
    }
    return ticks;
}

/* --- every pair, a change of mind at every tick --- */

static void change_mind(uint32_t from, uint32_t to, uint32_t other, uint32_t after) {
    TEST_ASSERT_LESS_THAN_UINT32(SETTLE_LIMIT, bring_up(from));
    for (uint32_t i = 0U; i < after; i++) {
        tick((elmopp_stage_t)to, served_by(to));
    }
    /* Two changes at most: the one that had begun, and its own. */
    const uint32_t bound = 2U * plan_oracle_bound(&junction);
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(bound, bring_up(other));
}

static void change_mind_at_every_tick(uint32_t from, uint32_t to) {
    const uint32_t length = plan_oracle_bound(&junction) + 2U;
    for (uint32_t after = 0U; after <= length; after++) {
        for (uint32_t other = 0U; other < junction.stage_count; other++) {
            const bool tried = everything || (random_below(&seed, 96U * junction.stage_count) == 0U);
            if (tried) {
                change_mind(from, to, other, after);
            }
        }
    }
}

static void check_every_pair(void) {
    const uint16_t bound_ds = junction.red_bound_ds;
    junction.red_bound_ds = 0U; /* here the wishes decide; the bound has its own test */
    for (uint32_t g = 0U; g < junction.group_count; g++) {
        junction.group[g].max_green_ds = 0U;
    }
    restart();
    for (uint32_t from = 0U; from < junction.stage_count; from++) {
        for (uint32_t to = 0U; to < junction.stage_count; to++) {
            change_mind_at_every_tick(from, to);
        }
    }
    junction.red_bound_ds = bound_ds;
}

static void test_every_pair_of_every_site_with_a_change_of_mind_at_every_tick(void) {
    seed = 1U;
    for (uint32_t i = 0U; i < TEST_SITE_COUNT; i++) {
        start(test_sites[i]);
        check_every_pair();
    }
}

/* --- junctions that nobody drew --- */

static bool is_stage(uint32_t groups) {
    for (uint32_t g = 0U; g < junction.group_count; g++) {
        const bool clashes = (junction.conflict[g] & groups) != 0U;
        if (elmopp_mask_has(groups, g) == clashes) { /* in it with a conflict, or out of it without */
            return false;
        }
    }
    return groups != 0U;
}

/* False if there are too many stages for a site. */
static bool draw_stages(void) {
    junction.stage_count = 0U;
    for (uint32_t groups = 1U; groups < (1U << junction.group_count); groups++) {
        if (is_stage(groups)) {
            if (junction.stage_count == ELMOPP_STAGE_MAX) {
                return false;
            }
            junction.stage_groups[junction.stage_count] = (uint16_t)groups;
            junction.stage_count++;
        }
    }
    return true;
}

static void draw_conflicts(void) {
    const uint32_t density = 1U + random_below(&seed, 9U);
    (void)memset(junction.conflict, 0, sizeof junction.conflict);
    (void)memset(junction.intergreen_ds, 0, sizeof junction.intergreen_ds);
    for (uint32_t g = 0U; g < junction.group_count; g++) {
        junction.group[g].amber_ds = random_between(&seed, 30U, 60U);
        junction.group[g].red_amber_ds = random_between(&seed, 0U, 20U);
        junction.group[g].min_green_ds = random_between(&seed, 50U, 80U);
        junction.group[g].max_green_ds = random_between(&seed, 80U, 300U);
    }
    for (uint32_t g = 0U; g < junction.group_count; g++) {
        for (uint32_t h = 0U; h < g; h++) {
            if (random_below(&seed, 10U) < density) {
                const uint32_t there_ds = (uint32_t)junction.group[g].amber_ds + junction.group[h].red_amber_ds;
                const uint32_t back_ds = (uint32_t)junction.group[h].amber_ds + junction.group[g].red_amber_ds;
                junction.conflict[g] |= (uint16_t)(1U << h);
                junction.conflict[h] |= (uint16_t)(1U << g);
                junction.intergreen_ds[g][h] = random_between(&seed, there_ds, there_ds + 40U);
                junction.intergreen_ds[h][g] = random_between(&seed, back_ds, back_ds + 40U);
            }
        }
    }
}

/* Every movement by the first stage that serves it. */
static void draw_rescue(void) {
    for (uint32_t j = 0U; j < junction.movement_count; j++) {
        uint32_t s = 0U;
        while (!elmopp_junction_goes(&junction, j, junction.stage_groups[s])) {
            s++;
        }
        junction.rescue_stage[j] = (uint8_t)s;
    }
    test_rescue_program(&junction, 100U);
    junction.red_bound_ds = (uint16_t)(elmopp_site_red_bound_min_ds(&junction) + random_below(&seed, 200U));
}

static void draw_junction(void) {
    bool drawn = false;
    while (!drawn) {
        junction = test_cross(2U + random_below(&seed, 11U));
        draw_conflicts();
        drawn = draw_stages();
    }
    junction.junction_wait_ds = (uint16_t)random_below(&box_seed, ELMOPP_SITE_JUNCTION_WAIT_MAX_DS + 1U);
    draw_rescue();
    const elmopp_site_verdict_t verdict = elmopp_site_check(&junction);
    TEST_ASSERT_EQUAL_INT(ELMOPP_SITE_OK, verdict.fault);
}

static void test_random_junctions_with_a_change_of_mind_at_every_tick(void) {
    seed = 2U;
    for (uint32_t i = 0U; i < RANDOM_JUNCTIONS; i++) {
        draw_junction();
        const elmopp_junction_t drawn = junction;
        start(&drawn);
        check_every_pair();
    }
}

/* --- the hostile chooser --- */

typedef struct {
    uint32_t decisions;
    uint32_t changes;
    uint32_t pair[ELMOPP_STAGE_MAX][ELMOPP_STAGE_MAX];
    elmopp_stage_t last;
} tally_t;

static tally_t tally;

static void count_change(void) {
    if ((plan.stage != ELMOPP_STAGE_NONE) && (plan.stage != tally.last)) {
        if (tally.last != ELMOPP_STAGE_NONE) {
            tally.changes++;
            tally.pair[tally.last][plan.stage]++;
        }
        tally.last = plan.stage;
    }
}

/* One lane always full and a vehicle elsewhere, everybody, nobody, or as it comes. */
static uint32_t hostile_demand(uint32_t mood) {
    const uint32_t all = (1U << junction.movement_count) - 1U;
    const uint32_t one = 1U << random_below(&seed, junction.movement_count);
    const uint32_t demands[4] = {1U | one, all, 0U, (uint32_t)(random_next(&seed) & random_next(&seed)) & all};
    return demands[mood];
}

/* At random, always the same, to and fro, none at all, or the pair that has come least. */
static elmopp_stage_t hostile_wish(uint32_t temper, uint32_t stubborn) {
    const uint32_t random_stage = random_below(&seed, junction.stage_count);
    uint32_t least = random_stage;
    for (uint32_t s = 0U; (plan.stage != ELMOPP_STAGE_NONE) && (s < junction.stage_count); s++) {
        const bool rarer = tally.pair[plan.stage][s] < tally.pair[plan.stage][least];
        least = ((s != plan.stage) && (rarer || (least == plan.stage))) ? s : least;
    }
    const uint32_t wishes[5] = {random_stage, stubborn, (tally.decisions % 2U) * stubborn, ELMOPP_STAGE_NONE, least};
    return (elmopp_stage_t)wishes[temper];
}

static void decide_hostilely(uint32_t decisions) {
    tally = (tally_t){.last = ELMOPP_STAGE_NONE};
    uint32_t temper = 0U;
    uint32_t mood = 0U;
    uint32_t stubborn = 0U;
    while (tally.decisions < decisions) {
        if (random_below(&seed, 200U) == 0U) {
            temper = (random_below(&seed, 3U) == 0U) ? random_below(&seed, 5U) : 4U;
            /* Rare pairs come only where nobody has to be rescued. */
            mood = ((temper == 4U) && (random_below(&seed, 3U) != 0U)) ? NOBODY : random_below(&seed, 4U);
            stubborn = random_below(&seed, junction.stage_count);
        }
        const elmopp_stage_t wanted = hostile_wish(temper, stubborn);
        const uint32_t late = random_below(&seed, 3U); /* the answer comes in the second, third or fourth tick */
        const uint32_t demand = hostile_demand(mood) | ((wanted < junction.stage_count) ? served_by(wanted) : 0U);
        for (uint32_t t = 0U; t < 10U; t++) {
            tick((t < late) ? (elmopp_stage_t)ELMOPP_STAGE_NONE : wanted, demand);
            count_change();
        }
        tally.decisions++;
    }
}

static void report_hostility(void) {
    uint32_t rarest = UINT32_MAX;
    for (uint32_t from = 0U; from < junction.stage_count; from++) {
        for (uint32_t to = 0U; to < junction.stage_count; to++) {
            const uint32_t times = tally.pair[from][to];
            rarest = ((from != to) && (times < rarest)) ? times : rarest;
        }
    }
    char message[160];
    (void)snprintf(message, sizeof message,
                   "%s: %u decisions, %u stage changes, rarest pair %u times, %u rescues, longest wait %lld of %u ds",
                   junction.name, (unsigned)tally.decisions, (unsigned)tally.changes, (unsigned)rarest,
                   (unsigned)oracle.rescued, oracle.longest_wait, (unsigned)junction.red_bound_ds);
    TEST_MESSAGE(message);
    TEST_ASSERT_TRUE_MESSAGE((!everything) || (rarest >= 100U), "a pair of stages came too rarely");
    TEST_ASSERT_TRUE_MESSAGE((!everything) || (tally.changes >= 100000U), "too few stage changes");
    TEST_ASSERT_TRUE_MESSAGE(tally.changes >= (tally.decisions / 20U), "hardly a change");
}

/* Greens of a second in the paper's site; streets as they are, but with bounds that are as tight as they may be. */
static void test_no_chooser_whatever_it_answers_breaks_a_rule_or_the_bound_on_red(void) {
    seed = 3U;
    for (uint32_t i = 0U; i < TEST_SITE_COUNT; i++) {
        start(test_sites[i]);
        if (junction.simulation_only == 0U) {
            junction.red_bound_ds = (uint16_t)elmopp_site_red_bound_min_ds(&junction);
        }
        restart();
        decide_hostilely(everything ? (2U * DECISIONS_OF_ALL) : DECISIONS);
        report_hostility();
    }
}

/* The longest wait there may be, in streets whose bounds have just room for it. */
static void test_no_chooser_breaks_the_bound_on_red_of_a_junction_that_is_often_occupied(void) {
    seed = 5U;
    for (uint32_t i = 0U; i < TEST_SITE_COUNT; i++) {
        start(test_sites[i]);
        if (junction.simulation_only == 0U) {
            junction.junction_wait_ds = ELMOPP_SITE_JUNCTION_WAIT_MAX_DS;
            junction.red_bound_ds = (uint16_t)elmopp_site_red_bound_min_ds(&junction);
            TEST_ASSERT_EQUAL_INT(ELMOPP_SITE_OK, elmopp_site_check(&junction).fault);
            restart();
            decide_hostilely(everything ? DECISIONS_OF_ALL : OCCUPIED_DECISIONS);
            report_hostility();
            TEST_ASSERT_TRUE_MESSAGE(oracle.waits > 100U, "the test hardly met an occupied junction");
        }
    }
}

static void test_random_junctions_keep_their_bound_on_red_under_a_hostile_chooser(void) {
    seed = 4U;
    for (uint32_t i = 0U; i < RANDOM_JUNCTIONS; i++) {
        draw_junction();
        const elmopp_junction_t drawn = junction;
        start(&drawn);
        decide_hostilely(DECISIONS / RANDOM_JUNCTIONS);
    }
}

/* --- the monitor alone --- */

/* Lamps that nobody planned: what passes has no conflict and no short time by the books kept here. */
typedef struct {
    uint32_t shows[ELMOPP_GROUP_MAX];
    long long since[ELMOPP_GROUP_MAX];
    long long freed[ELMOPP_GROUP_MAX]; ///< tick in which it was last free to go
} books_t;

static elmopp_lamps_t random_lamps(const elmopp_lamps_t *before) {
    elmopp_lamps_t lamps = *before;
    const uint32_t g = random_below(&seed, junction.group_count);
    const uint32_t dice = random_below(&seed, 40U);
    const elmopp_aspect_t now = elmopp_lamps_aspect(before, g);
    static const elmopp_aspect_t next[ELMOPP_ASPECT_COUNT] = {
        [ELMOPP_ASPECT_DARK] = ELMOPP_ASPECT_RED,        [ELMOPP_ASPECT_RED] = ELMOPP_ASPECT_RED_AMBER,
        [ELMOPP_ASPECT_RED_AMBER] = ELMOPP_ASPECT_GREEN, [ELMOPP_ASPECT_GREEN] = ELMOPP_ASPECT_AMBER,
        [ELMOPP_ASPECT_AMBER] = ELMOPP_ASPECT_RED,       [ELMOPP_ASPECT_FLASH_AMBER] = ELMOPP_ASPECT_RED,
        [ELMOPP_ASPECT_FLASH_RED] = ELMOPP_ASPECT_RED};
    if (dice == 0U) {
        elmopp_lamps_show(&lamps, g, (elmopp_aspect_t)random_below(&seed, (uint32_t)ELMOPP_ASPECT_COUNT));
    } else if ((dice < 4U) && (now < ELMOPP_ASPECT_COUNT)) {
        elmopp_lamps_show(&lamps, g, next[now]);
    } else {
        /* as before */
    }
    return lamps;
}

static bool is_off_red(uint32_t aspect) {
    return (aspect >= (uint32_t)ELMOPP_ASPECT_RED_AMBER) && (aspect <= (uint32_t)ELMOPP_ASPECT_AMBER);
}

static void check_what_passed(const books_t *books, uint32_t g, long long now) {
    for (uint32_t h = 0U; h < junction.group_count; h++) {
        if (elmopp_mask_has(junction.conflict[g], h)) {
            TEST_ASSERT_FALSE_MESSAGE(is_off_red(books->shows[g]) && is_off_red(books->shows[h]), "a conflict passed");
            const bool starts = (books->shows[g] == (uint32_t)ELMOPP_ASPECT_GREEN) && (books->since[g] == now);
            TEST_ASSERT_FALSE_MESSAGE(starts && ((now - books->freed[h]) <= junction.intergreen_ds[h][g]),
                                      "a short intergreen passed");
        }
    }
}

static void keep_books(books_t *books, const elmopp_lamps_t *lamps, long long now) {
    for (uint32_t g = 0U; g < junction.group_count; g++) {
        const uint32_t aspect = (uint32_t)elmopp_lamps_aspect(lamps, g);
        const long long lasted = now - books->since[g];
        if (aspect != books->shows[g]) {
            const bool amber = books->shows[g] == (uint32_t)ELMOPP_ASPECT_AMBER;
            const bool green = books->shows[g] == (uint32_t)ELMOPP_ASPECT_GREEN;
            TEST_ASSERT_FALSE_MESSAGE(amber && (lasted < junction.group[g].amber_ds), "a short amber passed");
            TEST_ASSERT_FALSE_MESSAGE(green && (lasted < junction.group[g].min_green_ds), "a short green passed");
            TEST_ASSERT_FALSE_MESSAGE(green && (aspect != (uint32_t)ELMOPP_ASPECT_AMBER),
                                      "a green without amber passed");
            books->since[g] = now;
        }
        books->shows[g] = aspect;
        const bool steady = (aspect == (uint32_t)ELMOPP_ASPECT_RED) || (aspect == (uint32_t)ELMOPP_ASPECT_RED_AMBER) ||
                            (aspect == (uint32_t)ELMOPP_ASPECT_AMBER);
        books->freed[g] = steady ? books->freed[g] : now;
    }
    for (uint32_t g = 0U; g < junction.group_count; g++) {
        check_what_passed(books, g, now);
    }
}

static void test_lamps_that_nobody_planned_pass_only_where_they_are_safe(void) {
    uint32_t passed = 0U;
    uint32_t caught = 0U;
    seed = 5U;
    junction = test_cross(3U);
    for (uint32_t run = 0U; run < (everything ? 200000U : 20000U); run++) {
        books_t books = {.shows = {0U}};
        elmopp_lamps_t lamps = {0x0007U, 0U, 0U, 0U};
        elmopp_monitor_init(&monitor, &junction);
        for (uint32_t g = 0U; g < junction.group_count; g++) {
            books.shows[g] = (uint32_t)ELMOPP_ASPECT_FLASH_AMBER;
            books.freed[g] = -1;
        }
        for (long long now = 0; now < 400; now++) {
            lamps = (now < 60) ? lamps : random_lamps(&lamps);
            const elmopp_monitor_input_t input = {
                .command = lamps, .measured = monitor.last, .fresh = UINT16_MAX, .mode = ELMOPP_MODE_AUTOMATIC};
            if (elmopp_monitor_check(&monitor, &input) != ELMOPP_FAULT_NONE) {
                caught++;
                break;
            }
            keep_books(&books, &lamps, now);
            passed++;
        }
    }
    char message[100];
    (void)snprintf(message, sizeof message, "%u ticks passed, %u runs ended by the monitor", (unsigned)passed,
                   (unsigned)caught);
    TEST_MESSAGE(message);
    TEST_ASSERT_TRUE(caught > 1000U);
}

int main(int argc, char **argv) {
    everything = (argc == 2) && (strcmp(argv[1], "--all") == 0);
    UNITY_BEGIN();
    RUN_TEST(test_every_pair_of_every_site_with_a_change_of_mind_at_every_tick);
    RUN_TEST(test_random_junctions_with_a_change_of_mind_at_every_tick);
    RUN_TEST(test_no_chooser_whatever_it_answers_breaks_a_rule_or_the_bound_on_red);
    RUN_TEST(test_no_chooser_breaks_the_bound_on_red_of_a_junction_that_is_often_occupied);
    RUN_TEST(test_random_junctions_keep_their_bound_on_red_under_a_hostile_chooser);
    RUN_TEST(test_lamps_that_nobody_planned_pass_only_where_they_are_safe);
    (void)printf("%llu ticks judged\n", (unsigned long long)ticks_judged);
    return UNITY_END();
}
