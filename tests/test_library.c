/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/* libelmopp.so as a program in C sees it: through elmopp.h and nothing else. Beside it runs the pilot of the core,
 * whose lamps the library's must be, tick for tick. */

#include "elmopp.h"

#include "elmopp/image.h"
#include "elmopp/lamps.h"
#include "elmopp/pilot.h"
#include "elmopp/site.h"
#include "elmopp/urgency.h"
#include "image_writer.h"
#include "random.h"
#include "sites.h"

#include "unity.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define SECONDS 900U
#define TICKS 10U

static uint8_t image[ELMOPP_IMAGE_HEADER + sizeof(elmopp_junction_t)];
static char message[ELMOPP_MESSAGE_BYTES];
static char aspects[ELMOPP_ASPECT_BYTES];
static float present_veh[ELMOPP_MOVEMENT_MAX];
static float arrived_veh[ELMOPP_MOVEMENT_MAX];
static float downstream_veh[ELMOPP_MOVEMENT_MAX];
static elmopp_options_t options;
static elmopp_second_t second;
static elmopp_t *junction;

void setUp(void) {
    memset(present_veh, 0, sizeof present_veh);
    memset(arrived_veh, 0, sizeof arrived_veh);
    memset(downstream_veh, 0, sizeof downstream_veh);
    memset(message, 0, sizeof message);
    second = (elmopp_second_t){.size = sizeof second, .present_veh = present_veh, .arrived_veh = arrived_veh};
    junction = NULL;
}

void tearDown(void) {
    elmopp_close(junction);
}

static void name_site(const elmopp_junction_t *site) {
    memcpy(&image[ELMOPP_IMAGE_HEADER], site, sizeof *site);
    image_seal(image, "ELMS", ELMOPP_SITE_IMAGE_VERSION_NOW, sizeof *site);
    options = (elmopp_options_t){.size = sizeof options, .site = image, .site_bytes = sizeof image};
}

static void open_site(const elmopp_junction_t *site, const char *chooser) {
    name_site(site);
    options.chooser = chooser;
    elmopp_close(junction);
    junction = elmopp_open(&options, message, sizeof message);
    TEST_ASSERT_NOT_NULL_MESSAGE(junction, message);
    /* Nothing that was handed in is kept. */
    memset(image, 0, sizeof image);
}

static void expect_refused(const char *part) {
    TEST_ASSERT_NULL(elmopp_open(&options, message, sizeof message));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(message, part), message);
    TEST_ASSERT_NULL_MESSAGE(strchr(message, '\n'), message);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(message, "right would be"), message);
}

static void count_at_random(uint64_t *seed, uint32_t movements) {
    for (uint32_t j = 0U; j < movements; j++) {
        arrived_veh[j] = (float)(random_next(seed) % 2U);
        present_veh[j] = (float)(random_next(seed) % 9U);
    }
}

static void test_it_says_its_version(void) {
    TEST_ASSERT_EQUAL_UINT32(ELMOPP_ABI_VERSION, elmopp_abi_version());
    TEST_ASSERT_EQUAL_UINT32(1U, elmopp_abi_version());
}

static void test_the_shape_is_the_sites(void) {
    for (uint32_t i = 0U; i < TEST_SITE_COUNT; i++) {
        open_site(test_sites[i], NULL);
        elmopp_shape_t shape = {.size = sizeof shape};
        TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_shape(junction, &shape));
        TEST_ASSERT_EQUAL_UINT32(test_sites[i]->approach_count, shape.approaches);
        TEST_ASSERT_EQUAL_UINT32(test_sites[i]->movement_count, shape.movements);
        TEST_ASSERT_EQUAL_UINT32(test_sites[i]->group_count, shape.groups);
        TEST_ASSERT_EQUAL_UINT32(test_sites[i]->stage_count, shape.stages);
        for (uint32_t s = 0U; s < shape.stages; s++) {
            const uint32_t groups = elmopp_stage_groups(junction, s);
            TEST_ASSERT_EQUAL_UINT32(test_sites[i]->stage_groups[s], groups);
            TEST_ASSERT_EQUAL_UINT32(elmopp_junction_served(test_sites[i], (uint16_t)groups),
                                     elmopp_served(junction, groups));
        }
        TEST_ASSERT_EQUAL_UINT32(0U, elmopp_stage_groups(junction, shape.stages));
        TEST_ASSERT_EQUAL_UINT32(0U, elmopp_served(junction, 0U));
    }
}

static void test_it_begins_with_all_red_and_no_stage(void) {
    open_site(test_sites[0], NULL);
    TEST_ASSERT_EQUAL_INT32(ELMOPP_NO_STAGE, elmopp_stage(junction));
    TEST_ASSERT_EQUAL_INT32(ELMOPP_NO_STAGE, elmopp_target(junction));
    TEST_ASSERT_EQUAL_INT32(ELMOPP_NO_STAGE, elmopp_wish(junction));
    TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_tick(junction, ELMOPP_NO_STAGE, aspects));
    TEST_ASSERT_EQUAL_UINT32(ELMOPP_ASPECT_BYTES - 1U, strlen(aspects));
    for (uint32_t g = 0U; g < ELMOPP_GROUP_MAX; g++) {
        TEST_ASSERT_EQUAL_CHAR((g < test_sites[0]->group_count) ? '1' : '0', aspects[g]);
    }
}

static void test_its_lamps_are_the_pilots(void) {
    for (uint32_t i = 0U; i < TEST_SITE_COUNT; i++) {
        open_site(test_sites[i], "naive");
        elmopp_urgency_t urgency;
        const elmopp_urgency_options_t window = {
            .min_s = test_sites[i]->hold_min_s, .max_s = test_sites[i]->hold_max_s, .hysteresis = 1.0F};
        const elmopp_chooser_t chooser = elmopp_urgency_init(&urgency, &window);
        const elmopp_forecast_config_t none = {.kind = ELMOPP_FORECAST_NONE};
        elmopp_pilot_t pilot;
        elmopp_pilot_init(&pilot, test_sites[i], &chooser, &none);
        uint64_t seed = 1U;
        for (uint32_t t = 0U; t < SECONDS; t++) {
            count_at_random(&seed, test_sites[i]->movement_count);
            const elmopp_counts_t counts = {.present_veh = present_veh, .arrived_veh = arrived_veh};
            TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
            TEST_ASSERT_TRUE(elmopp_pilot_step(&pilot, &counts, NULL));
            for (uint32_t k = 0U; k < TICKS; k++) {
                TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_tick(junction, ELMOPP_NO_STAGE, aspects));
                const elmopp_lamps_t lamps = elmopp_pilot_lamp_tick(&pilot, pilot.wanted, false);
                for (uint32_t g = 0U; g < ELMOPP_GROUP_MAX; g++) {
                    TEST_ASSERT_EQUAL_INT((int)elmopp_lamps_aspect(&lamps, g), aspects[g] - '0');
                }
            }
            const int32_t stage = (pilot.plan.stage < ELMOPP_STAGE_MAX) ? (int32_t)pilot.plan.stage : ELMOPP_NO_STAGE;
            TEST_ASSERT_EQUAL_INT32(stage, elmopp_stage(junction));
            TEST_ASSERT_EQUAL_FLOAT(pilot.score[0], elmopp_score(junction, 0U));
        }
        TEST_ASSERT_NULL(elmopp_fault(junction));
    }
}

static void test_a_wish_overrules_the_chooser_and_nothing_else(void) {
    open_site(test_sites[0], "naive");
    const int32_t last = (int32_t)test_sites[0]->stage_count - 1;
    for (uint32_t t = 0U; t < 60U; t++) {
        present_veh[0] = 5.0F;
        TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
        for (uint32_t k = 0U; k < TICKS; k++) {
            TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_tick(junction, (t < 30U) ? last : 0, aspects));
        }
        if (t == 29U) {
            TEST_ASSERT_EQUAL_INT32(last, elmopp_stage(junction));
        }
    }
    TEST_ASSERT_EQUAL_INT32(0, elmopp_stage(junction));
    TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_tick(junction, last + 1, aspects));
    TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_tick(junction, -2, aspects));
    TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_tick(junction, 0, NULL));
}

static void test_counts_that_are_none_are_refused(void) {
    open_site(test_sites[0], NULL);
    const float bad[] = {-1.0F, (float)NAN, (float)INFINITY, 1.1e6F};
    float *const places[] = {&present_veh[1], &arrived_veh[0], &downstream_veh[0],
                             &downstream_veh[test_sites[0]->movement_count - 1U]};
    second.downstream_veh = downstream_veh;
    for (uint32_t i = 0U; i < sizeof bad / sizeof bad[0]; i++) {
        for (uint32_t k = 0U; k < sizeof places / sizeof places[0]; k++) {
            *places[k] = bad[i];
            TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_count(junction, &second));
            *places[k] = 0.0F;
        }
    }
    downstream_veh[ELMOPP_MOVEMENT_MAX - 1U] = (float)NAN; /* beyond the movements: not read */
    TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
    second.present_veh = NULL;
    TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_count(junction, &second));
    TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_count(junction, NULL));
}

/* One good second after another, with a refused one before each: what was refused must not show in any wish. */
static void test_a_refused_second_leaves_no_trace(void) {
    for (uint32_t refused = 0U; refused < 2U; refused++) {
        open_site(test_sites[0], "max-pressure");
        elmopp_t *spared = junction;
        junction = NULL;
        open_site(test_sites[0], "max-pressure");
        uint64_t seed = 1U;
        for (uint32_t t = 0U; t < SECONDS; t++) {
            second.downstream_veh = downstream_veh;
            count_at_random(&seed, test_sites[0]->movement_count);
            for (uint32_t j = 0U; j < test_sites[0]->movement_count; j++) {
                downstream_veh[j] = 50.0F * (float)(random_next(&seed) % 2U);
            }
            float *const spoilt = (refused == 0U) ? &present_veh[0] : &downstream_veh[0];
            const float right = *spoilt;
            *spoilt = -1.0F;
            TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_count(junction, &second));
            *spoilt = right;
            second.downstream_veh = NULL;
            TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
            TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(spared, &second));
            TEST_ASSERT_EQUAL_INT32(elmopp_wish(spared), elmopp_wish(junction));
            for (uint32_t k = 0U; k < TICKS; k++) {
                char beside[ELMOPP_ASPECT_BYTES];
                TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_tick(junction, ELMOPP_NO_STAGE, aspects));
                TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_tick(spared, ELMOPP_NO_STAGE, beside));
                TEST_ASSERT_EQUAL_STRING(beside, aspects);
            }
        }
        elmopp_close(spared);
    }
}

/* The stages that are shown while the caller wants the first for ever. */
static uint32_t shown_against_a_wish(int count_answers) {
    uint32_t shown = 0U;
    for (uint32_t t = 0U; t < SECONDS; t++) {
        TEST_ASSERT_EQUAL_INT(count_answers, elmopp_count(junction, &second));
        for (uint32_t k = 0U; k < TICKS; k++) {
            TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_tick(junction, 0, aspects));
        }
        const int32_t stage = elmopp_stage(junction);
        shown |= (stage == ELMOPP_NO_STAGE) ? 0U : (uint32_t)1U << (uint32_t)stage;
    }
    return shown;
}

/* Where nobody is, a green may last; where nobody can say who is there, maximum greens and the bound on red hold. */
static void test_refused_seconds_keep_the_stages_turning(void) {
    second.downstream_veh = downstream_veh;
    open_site(&elmopp_site_four_way, "naive");
    TEST_ASSERT_EQUAL_HEX32(0x1U, shown_against_a_wish(ELMOPP_DONE));
    downstream_veh[0] = (float)NAN;
    open_site(&elmopp_site_four_way, "naive");
    const uint32_t others = shown_against_a_wish(ELMOPP_REFUSED) & ~(uint32_t)1U;
    TEST_ASSERT_TRUE(others != 0U);
}

/* Ticks until the second stage is green, with somebody in the junction for so many seconds. */
static uint32_t change_with_the_junction_occupied_for(uint32_t seconds) {
    elmopp_junction_t site = elmopp_site_four_way;
    site.junction_wait_ds = 50U;
    site.red_bound_ds = 3000U;
    open_site(&site, "naive");
    for (uint32_t t = 0U; t < 40U; t++) {
        TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
        for (uint32_t k = 0U; k < TICKS; k++) {
            TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_tick(junction, 0, aspects));
        }
    }
    TEST_ASSERT_EQUAL_INT32(0, elmopp_stage(junction));
    for (uint32_t j = 0U; j < site.movement_count; j++) {
        present_veh[j] = 3.0F;
    }
    uint32_t ticks = 0U;
    for (uint32_t t = 0U; (t < 60U) && (elmopp_stage(junction) != 3); t++) {
        second.occupied = (t < seconds) ? 1U : 0U;
        TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
        for (uint32_t k = 0U; (k < TICKS) && (elmopp_stage(junction) != 3); k++) {
            TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_tick(junction, 3, aspects));
            ticks++;
        }
    }
    TEST_ASSERT_EQUAL_INT32(3, elmopp_stage(junction));
    TEST_ASSERT_NULL(elmopp_fault(junction));
    return ticks;
}

static void test_a_change_waits_for_an_occupied_junction_as_the_site_says(void) {
    const uint32_t empty = change_with_the_junction_occupied_for(0U);
    TEST_ASSERT_EQUAL_UINT32(empty, change_with_the_junction_occupied_for(3U));
    const uint32_t full = change_with_the_junction_occupied_for(60U);
    TEST_ASSERT_TRUE((full > empty) && (full <= (empty + 50U)));
    second.size = offsetof(elmopp_second_t, occupied); /* a caller who does not know of it */
    TEST_ASSERT_EQUAL_UINT32(empty, change_with_the_junction_occupied_for(60U));
}

static void test_what_a_neighbour_announces_is_foreseen_in_its_second_and_not_kept(void) {
    elmopp_announced_t announced[ELMOPP_APPROACH_MAX] = {{0.0F, 0.0F, 0.0F, 0.0F}};
    announced[2] = (elmopp_announced_t){2.0F, 3.0F, 3.0F, 14.9F};
    open_site(&elmopp_site_four_way, "cumulative:none");
    TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
    TEST_ASSERT_EQUAL_FLOAT(0.0F, elmopp_foreseen_veh(junction, 2U));
    second.announced = announced;
    TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
    TEST_ASSERT_FLOAT_WITHIN(1.0e-5F, 3.0F, elmopp_foreseen_veh(junction, 2U));
    TEST_ASSERT_EQUAL_FLOAT(0.0F, elmopp_foreseen_veh(junction, 1U));
    second.announced = NULL;
    TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
    TEST_ASSERT_EQUAL_FLOAT(0.0F, elmopp_foreseen_veh(junction, 2U));
    second.announced = announced;
    second.size = offsetof(elmopp_second_t, announced); /* a caller who does not know of it */
    TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
    TEST_ASSERT_EQUAL_FLOAT(0.0F, elmopp_foreseen_veh(junction, 2U));
}

static void test_announcements_that_are_no_numbers_are_refused(void) {
    const float bad[] = {-1.0F, (float)NAN, (float)INFINITY};
    elmopp_announced_t announced[ELMOPP_APPROACH_MAX] = {{0.0F, 0.0F, 0.0F, 0.0F}};
    float *const places[] = {&announced[0].next10_veh, &announced[1].next30_veh, &announced[2].next60_veh,
                             &announced[3].ahead_s};
    open_site(&elmopp_site_four_way, NULL);
    second.announced = announced;
    for (uint32_t i = 0U; i < sizeof bad / sizeof bad[0]; i++) {
        for (uint32_t k = 0U; k < sizeof places / sizeof places[0]; k++) {
            *places[k] = bad[i];
            TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_count(junction, &second));
            *places[k] = 0.0F;
        }
    }
    announced[4].next10_veh = (float)NAN; /* beyond the approaches: not read */
    TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
}

static float foreseen_veh[ELMOPP_APPROACH_MAX * ELMOPP_FORESEEN_MAX_S];

static void foresee_at_random(uint64_t *seed, uint32_t approaches, uint32_t seconds) {
    for (uint32_t k = 0U; k < (approaches * seconds); k++) {
        foreseen_veh[k] = (float)(random_next(seed) % 3U);
    }
    second.foreseen_veh = foreseen_veh;
    second.foreseen_s = seconds;
}

/* One second of both; rows of the same numbers. */
static void expect_the_same_second(elmopp_pilot_t *pilot, const elmopp_junction_t *site) {
    const uint32_t seconds = second.foreseen_s;
    const elmopp_counts_t counts = {.present_veh = present_veh, .arrived_veh = arrived_veh};
    elmopp_foreseen_t rows = {.steps = (uint16_t)seconds};
    for (uint32_t i = 0U; i < site->approach_count; i++) {
        rows.row_veh[i] = &foreseen_veh[i * seconds];
    }
    TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
    TEST_ASSERT_TRUE(elmopp_pilot_step(pilot, &counts, &rows));
    for (uint32_t s = 0U; s < site->stage_count; s++) {
        TEST_ASSERT_EQUAL_FLOAT(pilot->score[s], elmopp_score(junction, s));
    }
    for (uint32_t i = 0U; i < site->approach_count; i++) {
        float sum_veh = 0.0F;
        for (uint32_t k = 0U; (k < seconds) && (k < 60U); k++) {
            sum_veh += foreseen_veh[(i * seconds) + k];
        }
        TEST_ASSERT_EQUAL_FLOAT(sum_veh, elmopp_foreseen_veh(junction, i));
    }
    for (uint32_t k = 0U; k < TICKS; k++) {
        TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_tick(junction, ELMOPP_NO_STAGE, aspects));
        (void)elmopp_pilot_lamp_tick(pilot, pilot->wanted, false);
    }
}

/* The scores of the cumulative urgency hang on every row; rows are of another length in every second. */
static void test_what_an_oracle_foresees_is_what_the_pilot_gets(void) {
    const elmopp_junction_t *const site = &elmopp_site_three_way;
    open_site(site, "cumulative:oracle");
    elmopp_urgency_t urgency;
    const elmopp_urgency_options_t window = {
        .cumulative = true, .min_s = site->hold_min_s, .max_s = site->hold_max_s, .hysteresis = 1.0F};
    const elmopp_chooser_t chooser = elmopp_urgency_init(&urgency, &window);
    const elmopp_forecast_config_t none = {.kind = ELMOPP_FORECAST_NONE};
    elmopp_pilot_t pilot;
    elmopp_pilot_init(&pilot, site, &chooser, &none);
    uint64_t seed = 7U;
    for (uint32_t t = 0U; t < 200U; t++) {
        count_at_random(&seed, site->movement_count);
        const uint32_t seconds = 1U + (uint32_t)(random_next(&seed) % ELMOPP_FORESEEN_MAX_S);
        foresee_at_random(&seed, site->approach_count, seconds);
        expect_the_same_second(&pilot, site);
    }
}

static void test_an_oracle_has_rows_and_nobody_else_has(void) {
    uint64_t seed = 1U;
    open_site(&elmopp_site_four_way, "rollout:oracle");
    TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_count(junction, &second));
    foresee_at_random(&seed, 4U, ELMOPP_FORESEEN_MAX_S);
    TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
    const float bad[] = {-1.0F, (float)NAN, (float)INFINITY, 1.1e6F};
    for (uint32_t i = 0U; i < sizeof bad / sizeof bad[0]; i++) {
        foreseen_veh[(4U * ELMOPP_FORESEEN_MAX_S) - 1U] = bad[i];
        TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_count(junction, &second));
    }
    second.foreseen_s = ELMOPP_FORESEEN_MAX_S - 1U; /* the bad one lies beyond the rows now */
    TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
    second.foreseen_s = ELMOPP_FORESEEN_MAX_S + 1U;
    TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_count(junction, &second));
    second.foreseen_s = 0U;
    TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_count(junction, &second));
    second.foreseen_s = 1U;
    second.size = offsetof(elmopp_second_t, foreseen_veh); /* a caller who does not know of it */
    TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_count(junction, &second));
    open_site(&elmopp_site_four_way, "rollout:ewma");
    TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
    second.size = sizeof second;
    TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_count(junction, &second));
}

/* 100 m at 50 km/h take 8 s, at 30 km/h 12: who is counted is queued so much later, and is let go so much later. */
static void test_the_way_to_the_stop_line_may_be_the_sites(void) {
    elmopp_junction_t slow = elmopp_site_four_way;
    for (uint32_t j = 0U; j < slow.movement_count; j++) {
        slow.movement[j].limit_km_per_h = 30U;
    }
    const elmopp_junction_t *const sites[] = {&elmopp_site_four_way, &slow};
    const uint32_t travel_s[] = {8U, 12U};
    for (uint32_t i = 0U; i < 2U; i++) {
        float scores[2] = {0.0F, 0.0F};
        for (uint32_t k = 0U; k < 2U; k++) {
            name_site(sites[i]);
            options.chooser = "rollout";
            options.travel_s = (k == 0U) ? ELMOPP_TRAVEL_OF_SITE : travel_s[i];
            elmopp_close(junction);
            junction = elmopp_open(&options, message, sizeof message);
            TEST_ASSERT_NOT_NULL_MESSAGE(junction, message);
            uint64_t seed = 3U;
            for (uint32_t t = 0U; t < 20U; t++) {
                count_at_random(&seed, slow.movement_count);
                TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
                for (uint32_t n = 0U; n < TICKS; n++) {
                    TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_tick(junction, ELMOPP_NO_STAGE, aspects));
                }
                scores[k] += elmopp_score(junction, (uint32_t)elmopp_target(junction));
            }
        }
        TEST_ASSERT_TRUE(scores[0] < 0.0F);
        TEST_ASSERT_EQUAL_FLOAT(scores[1], scores[0]);
    }
}

static void test_structs_of_another_size(void) {
    open_site(test_sites[0], NULL);
    second.size = offsetof(elmopp_second_t, downstream_veh); /* an older caller */
    TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
    second.size = sizeof second + 1U; /* a newer one */
    TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_count(junction, &second));
    second.size = 4U;
    TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_count(junction, &second));
    elmopp_shape_t shape = {.size = 8U, .movements = 99U};
    TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_shape(junction, &shape));
    TEST_ASSERT_EQUAL_UINT32(test_sites[0]->approach_count, shape.approaches);
    TEST_ASSERT_EQUAL_UINT32(99U, shape.movements);
    shape.size = 0U;
    TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_shape(junction, &shape));
    TEST_ASSERT_EQUAL_INT(ELMOPP_REFUSED, elmopp_shape(junction, NULL));
    name_site(test_sites[0]);
    options.size = sizeof options + 8U;
    expect_refused("options.size is");
    options.size = 0U;
    expect_refused("options.size is 0");
    TEST_ASSERT_NULL(elmopp_open(NULL, message, sizeof message));
    TEST_ASSERT_NOT_NULL(strstr(message, "missing"));
}

static void test_what_cannot_be_opened_says_why(void) {
    name_site(test_sites[0]);
    options.chooser = "nave";
    expect_refused("unknown chooser \"nave\"");
    options.chooser = NULL;
    options.site = NULL;
    expect_refused("options.site is missing");
    name_site(test_sites[0]);
    image[100] ^= 1U;
    expect_refused("image");
    name_site(test_sites[0]);
    options.weights = image;
    options.weights_bytes = 7U;
    expect_refused("weights");
    char one[1] = {'x'};
    TEST_ASSERT_NULL(elmopp_open(&options, one, sizeof one));
    TEST_ASSERT_EQUAL_CHAR('\0', one[0]);
    TEST_ASSERT_NULL(elmopp_open(&options, NULL, 0U));
}

static void test_handles_are_independent(void) {
    open_site(test_sites[0], "naive");
    elmopp_t *first = junction;
    junction = NULL;
    open_site(test_sites[1], "pressure");
    for (uint32_t k = 0U; k < 300U; k++) {
        TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_tick(first, 0, aspects));
    }
    TEST_ASSERT_EQUAL_INT32(0, elmopp_stage(first));
    TEST_ASSERT_EQUAL_INT32(ELMOPP_NO_STAGE, elmopp_stage(junction));
    elmopp_close(first);
    TEST_ASSERT_EQUAL_INT(ELMOPP_DONE, elmopp_count(junction, &second));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_it_says_its_version);
    RUN_TEST(test_the_shape_is_the_sites);
    RUN_TEST(test_it_begins_with_all_red_and_no_stage);
    RUN_TEST(test_its_lamps_are_the_pilots);
    RUN_TEST(test_a_wish_overrules_the_chooser_and_nothing_else);
    RUN_TEST(test_counts_that_are_none_are_refused);
    RUN_TEST(test_a_refused_second_leaves_no_trace);
    RUN_TEST(test_refused_seconds_keep_the_stages_turning);
    RUN_TEST(test_a_change_waits_for_an_occupied_junction_as_the_site_says);
    RUN_TEST(test_what_a_neighbour_announces_is_foreseen_in_its_second_and_not_kept);
    RUN_TEST(test_announcements_that_are_no_numbers_are_refused);
    RUN_TEST(test_what_an_oracle_foresees_is_what_the_pilot_gets);
    RUN_TEST(test_an_oracle_has_rows_and_nobody_else_has);
    RUN_TEST(test_the_way_to_the_stop_line_may_be_the_sites);
    RUN_TEST(test_structs_of_another_size);
    RUN_TEST(test_what_cannot_be_opened_says_why);
    RUN_TEST(test_handles_are_independent);
    return UNITY_END();
}
