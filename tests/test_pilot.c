/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The pilot with a scripted chooser. A second is one step and then ten lamp ticks.

#include "elmopp/pilot.h"
#include "elmopp/urgency.h"
#include "elmopp_weights.h"
#include "sites.h"
#include "unity.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define MOVEMENTS 3U
#define APPROACHES 2U
#define SATURATION_S 6600U ///< seconds after which a T of tenths is saturated

/* What the chooser saw in its last call, and what it shall answer. */
typedef struct {
    elmopp_stage_t answer;
    uint32_t calls;
    elmopp_view_t view;
    uint16_t red_ds[ELMOPP_MOVEMENT_MAX];
    float share[ELMOPP_MOVEMENT_MAX];
    float first_veh[ELMOPP_APPROACH_MAX]; ///< first step of each row
    float last_veh[ELMOPP_APPROACH_MAX];  ///< last step of each row
} script_t;

/* Three groups in conflict. Movement 0 and 2 come from approach 0, movement 1 from approach 1. */
static elmopp_junction_t junction;
static elmopp_pilot_t pilot;
static elmopp_lamps_t lamps;
static script_t script;
static float present_veh[ELMOPP_MOVEMENT_MAX];
static float arrived_veh[ELMOPP_MOVEMENT_MAX];
static const elmopp_counts_t counts = {present_veh, arrived_veh, 0U, NULL};

static elmopp_stage_t choose(void *state, const elmopp_view_t *view, float score[ELMOPP_STAGE_MAX]) {
    script_t *self = state;
    self->calls++;
    self->view = *view;
    for (uint32_t j = 0U; j < view->junction->movement_count; j++) {
        self->red_ds[j] = view->red_ds[j];
        self->share[j] = view->share[j];
    }
    for (uint32_t i = 0U; (i < ELMOPP_APPROACH_MAX) && (view->foreseen_steps > 0U); i++) {
        const float *row_veh = view->foreseen_veh[i];
        self->first_veh[i] = (row_veh != NULL) ? row_veh[0] : -1.0F;
        self->last_veh[i] = (row_veh != NULL) ? row_veh[view->foreseen_steps - 1U] : -1.0F;
    }
    for (uint32_t s = 0U; s < ELMOPP_STAGE_MAX; s++) {
        score[s] = (float)(100U + s);
    }
    return self->answer;
}

/* The intergreens of the start are over before the first second. */
static void wait_out_the_start(void) {
    for (uint32_t i = 0U; i < CROSS_INTERGREEN_DS; i++) {
        lamps = elmopp_pilot_lamp_tick(&pilot, ELMOPP_STAGE_NONE, false);
    }
}

static void start(uint16_t horizon_s, const elmopp_forecast_config_t *forecast) {
    const elmopp_chooser_t chooser = {.choose = choose, .state = &script, .horizon_s = horizon_s};
    (void)memset(&pilot, 0xA5, sizeof pilot);
    elmopp_pilot_init(&pilot, &junction, &chooser, forecast);
    wait_out_the_start();
}

static void start_with(uint8_t kind, uint16_t horizon_s) {
    const elmopp_forecast_config_t config = {.kind = kind};
    start(horizon_s, &config);
}

void setUp(void) {
    junction = test_cross(MOVEMENTS);
    junction.approach_count = APPROACHES;
    junction.movement[2].approach = 0U;
    junction.cameras = 0x03U;
    junction.simulation_only = 1U; /* a street would rest where nobody waits */
    script = (script_t){.answer = 0U};
    (void)memset(present_veh, 0, sizeof present_veh);
    (void)memset(arrived_veh, 0, sizeof arrived_veh);
    start_with(ELMOPP_FORECAST_NONE, 0U);
}
void tearDown(void) {}

static void lamp_ticks(uint32_t ticks) {
    for (uint32_t i = 0U; i < ticks; i++) {
        lamps = elmopp_pilot_lamp_tick(&pilot, pilot.wanted, false);
    }
}

static void step(void) {
    TEST_ASSERT_TRUE(elmopp_pilot_step(&pilot, &counts, NULL));
}

static void seconds(uint32_t count, elmopp_stage_t wanted) {
    for (uint32_t i = 0U; i < count; i++) {
        script.answer = wanted;
        step();
        lamp_ticks(ELMOPP_LAMP_TICKS_PER_S);
    }
}

/* --- the wish --- */

static void test_the_wish_goes_to_the_plan_and_the_lamps_come_back(void) {
    seconds(1U, 1U);
    TEST_ASSERT_EQUAL_HEX16(0x0007U, lamps.red);
    TEST_ASSERT_EQUAL_HEX16(0x0002U, lamps.amber);
    lamp_ticks(1U);
    TEST_ASSERT_EQUAL_HEX16(0x0002U, lamps.green);
    TEST_ASSERT_EQUAL_HEX16(0x0005U, lamps.red);
}

static void test_without_a_decision_all_lamps_are_red(void) {
    lamp_ticks(100U);
    TEST_ASSERT_EQUAL_HEX16(0x0007U, lamps.red);
    TEST_ASSERT_EQUAL_HEX16(0U, lamps.amber);
    TEST_ASSERT_EQUAL_HEX16(0U, lamps.green);
    TEST_ASSERT_EQUAL_UINT32(0U, script.calls);
}

static void test_the_chooser_is_asked_every_second_also_in_the_intergreen(void) {
    seconds(10U, 0U);
    seconds(3U, 1U);
    TEST_ASSERT_EQUAL_UINT32(13U, script.calls);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_STAGE_NONE, script.view.stage);
    TEST_ASSERT_EQUAL_UINT8(1U, script.view.target);
}

/* chooser.h: "also in the intergreen; what it returns there is not used". */
static void test_an_answer_in_the_intergreen_is_not_used(void) {
    seconds(10U, 0U);
    seconds(1U, 1U);
    seconds(5U, 2U);
    TEST_ASSERT_EQUAL_UINT8_MESSAGE(1U, pilot.plan.target, "stage 1 is up for 5 ticks and nobody was asked since");
    seconds(1U, 1U);
    TEST_ASSERT_EQUAL_UINT8(1U, pilot.plan.stage);
    TEST_ASSERT_EQUAL_HEX16(0x0002U, lamps.green);
}

static void test_the_view_before_the_first_decision_names_no_stage(void) {
    step();
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_STAGE_NONE, script.view.stage);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_STAGE_NONE, script.view.target);
    TEST_ASSERT_EQUAL_UINT16(0U, script.view.elapsed_ds);
    TEST_ASSERT_EQUAL_HEX32(0U, script.view.going);
    for (uint32_t j = 0U; j < MOVEMENTS; j++) {
        TEST_ASSERT_EQUAL_UINT16(0U, script.red_ds[j]);
    }
}

static void test_the_view_holds_what_was_counted(void) {
    step();
    TEST_ASSERT_EQUAL_PTR(&junction, script.view.junction);
    TEST_ASSERT_EQUAL_PTR(present_veh, script.view.queue_veh);
    TEST_ASSERT_EQUAL_PTR(arrived_veh, script.view.arrivals_veh);
    TEST_ASSERT_EQUAL_FLOAT(0.5F, script.share[0]);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, script.share[1]);
}

/* Red-amber takes the first second, so after n seconds the stage has been up for n - 1. */
static void test_elapsed_grows_by_10_a_second(void) {
    seconds(1U, 0U);
    for (uint32_t n = 1U; n < 20U; n++) {
        seconds(1U, 0U);
        step();
        TEST_ASSERT_EQUAL_UINT16(10U * n, script.view.elapsed_ds);
        TEST_ASSERT_EQUAL_UINT8(0U, script.view.stage);
    }
}

static void test_scores_are_kept_for_the_log(void) {
    step();
    TEST_ASSERT_EQUAL_FLOAT(100.0F, pilot.score[0]);
    TEST_ASSERT_EQUAL_FLOAT(131.0F, pilot.score[31]);
}

/* --- T and going --- */

static void test_going_is_the_mask_of_the_movements_that_are_green(void) {
    junction.movement[2].groups = 0x0001U;
    seconds(10U, 0U);
    step();
    TEST_ASSERT_EQUAL_HEX32(0x0005U, script.view.going);
    seconds(3U, 1U);
    step();
    TEST_ASSERT_EQUAL_HEX32(0U, script.view.going);
    seconds(4U, 1U);
    step();
    TEST_ASSERT_EQUAL_HEX32(0x0002U, script.view.going);
}

static void test_t_grows_by_10_a_second_on_red_and_is_0_on_green(void) {
    seconds(2U, 0U);
    for (uint32_t n = 2U; n < 50U; n++) {
        step();
        TEST_ASSERT_EQUAL_UINT16(0U, script.red_ds[0]);
        TEST_ASSERT_EQUAL_UINT16(10U * n, script.red_ds[1]);
        lamp_ticks(ELMOPP_LAMP_TICKS_PER_S);
    }
}

/* Amber is not green: T counts from the end of green, and red-amber does not end it. */
static void test_t_starts_with_amber_and_ends_with_green(void) {
    seconds(10U, 0U);
    script.answer = 1U;
    step();
    lamp_ticks(1U);
    TEST_ASSERT_EQUAL_HEX16(0x0001U, lamps.amber);
    TEST_ASSERT_EQUAL_UINT16(1U, pilot.red_ds[0]);
    lamp_ticks(CROSS_INTERGREEN_DS - 1U);
    TEST_ASSERT_EQUAL_HEX16(0x0002U, lamps.amber);
    TEST_ASSERT_EQUAL_UINT16(CROSS_INTERGREEN_DS, pilot.red_ds[0]);
    TEST_ASSERT_EQUAL_UINT16(100U + CROSS_INTERGREEN_DS, pilot.red_ds[1]);
    lamp_ticks(1U);
    TEST_ASSERT_EQUAL_HEX16(0x0002U, lamps.green);
    TEST_ASSERT_EQUAL_UINT16(0U, pilot.red_ds[1]);
    TEST_ASSERT_EQUAL_UINT16(CROSS_INTERGREEN_DS + 1U, pilot.red_ds[0]);
}

static void test_t_of_a_movement_with_two_groups_needs_both_green(void) {
    junction.movement[2].groups = 0x0006U;
    seconds(10U, 1U);
    TEST_ASSERT_EQUAL_UINT16(0U, pilot.red_ds[1]);
    TEST_ASSERT_EQUAL_UINT16(100U, pilot.red_ds[2]);
}

static void test_t_saturates(void) {
    seconds(SATURATION_S, 0U);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, pilot.red_ds[1]);
    TEST_ASSERT_EQUAL_UINT16(0U, pilot.red_ds[0]);
}

/* chooser.h: T is 0 before the first decision. Here the first counts are refused, and the lamps go on. */
static void test_t_is_0_until_the_first_decision(void) {
    present_veh[0] = NAN;
    TEST_ASSERT_FALSE(elmopp_pilot_step(&pilot, &counts, NULL));
    lamp_ticks(ELMOPP_LAMP_TICKS_PER_S);
    present_veh[0] = 0.0F;
    step();
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_STAGE_NONE, script.view.target);
    TEST_ASSERT_EQUAL_UINT16(0U, script.red_ds[0]);
}

/* --- demand --- */

static void test_demand_needs_a_whole_vehicle_on_red(void) {
    present_veh[1] = 0.999F;
    step();
    TEST_ASSERT_EQUAL_HEX32(0U, pilot.waiting);
    present_veh[1] = ELMOPP_PILOT_DEMAND_VEH;
    step();
    TEST_ASSERT_EQUAL_HEX32(0x0002U, pilot.waiting);
    present_veh[0] = 3.0F;
    present_veh[1] = 0.0F;
    step();
    TEST_ASSERT_EQUAL_HEX32(0x0001U, pilot.waiting);
}

static void test_vehicles_on_green_demand_nothing(void) {
    present_veh[0] = 5.0F;
    present_veh[1] = 5.0F;
    seconds(5U, 0U);
    TEST_ASSERT_EQUAL_HEX32(0x0002U, pilot.waiting);
}

static void test_demand_names_the_movement_and_not_its_groups(void) {
    junction.movement[2].groups = 0x0006U;
    present_veh[2] = 1.0F;
    step();
    TEST_ASSERT_EQUAL_HEX32(0x0004U, pilot.waiting);
}

/* Stage 0 is up after 1 s; a vehicle waits from the third second on; the maximum is 20 s. */
static void test_demand_is_that_of_all_movements_that_exist(void) {
    present_veh[0] = 1.0F;
    present_veh[1] = 2.0F;
    present_veh[2] = 3.0F;
    step();
    TEST_ASSERT_EQUAL_HEX32(0x0007U, pilot.waiting);
    junction.movement_count = 2U;
    step();
    TEST_ASSERT_EQUAL_HEX32(0x0003U, pilot.waiting);
}

static void test_t_of_movements_that_do_not_exist_is_not_counted(void) {
    junction.movement_count = 2U;
    seconds(1U, 0U);
    TEST_ASSERT_EQUAL_UINT16(10U, pilot.red_ds[1]);
    TEST_ASSERT_EQUAL_UINT16(0U, pilot.red_ds[2]);
}

static void test_demand_reaches_the_maximum_green_of_the_plan(void) {
    seconds(2U, 0U);
    present_veh[1] = 1.0F;
    seconds(CROSS_MAX_GREEN_DS / 10U, 0U);
    TEST_ASSERT_EQUAL_HEX16(0x0001U, lamps.green);
    seconds(1U, 0U);
    TEST_ASSERT_EQUAL_HEX16(0x0001U, lamps.amber);
    TEST_ASSERT_EQUAL_UINT8(1U, pilot.plan.target);
}

/* A counter that is broken for good must not hold one stage for good. */
static void test_bad_counts_let_the_maximum_greens_turn_the_stages(void) {
    seconds(2U, 0U);
    present_veh[1] = NAN;
    bool shown[3] = {false, false, false};
    for (uint32_t t = 0U; t < 200U; t++) {
        TEST_ASSERT_FALSE(elmopp_pilot_step(&pilot, &counts, NULL));
        lamp_ticks(10U);
        if (pilot.plan.stage < 3U) {
            shown[pilot.plan.stage] = true;
        }
    }
    TEST_ASSERT_TRUE(shown[0] && shown[1] && shown[2]);
}

/* The chooser is next asked after the plan has changed by force: until then its old wish must not count. */
static void test_when_blind_every_movement_on_red_waits(void) {
    seconds(10U, 1U);
    TEST_ASSERT_TRUE(pilot.going != 0U);
    present_veh[0] = NAN;
    TEST_ASSERT_FALSE(elmopp_pilot_step(&pilot, &counts, NULL));
    TEST_ASSERT_EQUAL_HEX32(0x00FFFFFFU & ~pilot.going, pilot.waiting);
}

static void test_a_forced_stage_outlives_the_wish_from_before(void) {
    for (uint32_t g = 0U; g < 3U; g++) {
        junction.group[g].amber_ds = 0U;
        junction.group[g].red_amber_ds = 0U;
        junction.group[g].min_green_ds = 1U;
        for (uint32_t h = 0U; h < 3U; h++) {
            junction.intergreen_ds[g][h] = 0U;
        }
    }
    present_veh[1] = 1.0F;
    seconds(CROSS_MAX_GREEN_DS / 10U, 0U);
    step();
    lamp_ticks(9U);
    TEST_ASSERT_EQUAL_UINT8(1U, pilot.plan.stage);
}

/* --- counts --- */

static void expect_refused(float *count, float value) {
    elmopp_pilot_t before = pilot;
    const uint32_t calls = script.calls;
    const float right = *count;
    *count = value;
    TEST_ASSERT_FALSE(elmopp_pilot_step(&pilot, &counts, NULL));
    *count = right;
    before.waiting = pilot.waiting; /* blind: everybody on red */
    TEST_ASSERT_EQUAL_HEX32(0U, pilot.waiting & pilot.going);
    TEST_ASSERT_EQUAL_HEX32(0x0007U & ~pilot.going, pilot.waiting & 0x0007U);
    TEST_ASSERT_EQUAL_MEMORY(&before, &pilot, sizeof pilot);
    TEST_ASSERT_EQUAL_UINT32(calls, script.calls);
}

static void test_bad_counts_are_refused_and_change_nothing(void) {
    static const float bad[] = {-1.0F, -1.0e-30F, NAN, INFINITY, -INFINITY, 1000000.0625F};
    start_with(ELMOPP_FORECAST_EWMA, 60U);
    seconds(3U, 1U);
    for (uint32_t j = 0U; j < MOVEMENTS; j++) {
        for (uint32_t i = 0U; i < sizeof bad / sizeof bad[0]; i++) {
            expect_refused(&present_veh[j], bad[i]);
            expect_refused(&arrived_veh[j], bad[i]);
        }
    }
    lamp_ticks(1U);
    TEST_ASSERT_EQUAL_HEX16(0x0002U, lamps.green);
}

static void test_a_blind_second_is_a_refused_one(void) {
    start_with(ELMOPP_FORECAST_EWMA, 60U);
    seconds(3U, 1U);
    elmopp_pilot_t refused = pilot;
    present_veh[0] = -1.0F;
    TEST_ASSERT_FALSE(elmopp_pilot_step(&refused, &counts, NULL));
    elmopp_pilot_step_blind(&pilot);
    TEST_ASSERT_EQUAL_MEMORY(&refused, &pilot, sizeof pilot);
}

static void test_after_a_refusal_the_wish_stays_as_it_is(void) {
    seconds(10U, 0U);
    script.answer = 1U;
    step();
    present_veh[2] = -1.0F;
    TEST_ASSERT_FALSE(elmopp_pilot_step(&pilot, &counts, NULL));
    lamp_ticks(1U);
    TEST_ASSERT_EQUAL_UINT8(1U, pilot.plan.target);
}

static void test_counts_of_zero_and_a_million_are_taken(void) {
    present_veh[0] = -0.0F;
    present_veh[1] = 1.0e6F;
    arrived_veh[2] = 1.0e6F;
    step();
}

static void test_counts_beyond_the_movements_are_not_read(void) {
    present_veh[MOVEMENTS] = NAN;
    arrived_veh[MOVEMENTS] = -1.0F;
    step();
}

/* --- forecast --- */

static void test_the_forecast_sees_the_second_before_the_chooser(void) {
    start_with(ELMOPP_FORECAST_PERSISTENCE, 0U);
    arrived_veh[0] = 0.5F;
    arrived_veh[1] = 2.0F;
    arrived_veh[2] = 0.25F;
    step();
    TEST_ASSERT_EQUAL_FLOAT(0.75F, script.first_veh[0]);
    TEST_ASSERT_EQUAL_FLOAT(2.0F, script.first_veh[1]);
    TEST_ASSERT_EQUAL_FLOAT(-1.0F, script.first_veh[2]);
}

static void test_the_forecast_has_the_steps_asked_for_but_at_least_half_a_minute(void) {
    static const uint16_t asked_s[] = {0U, 29U, 30U, 31U, ELMOPP_HORIZON_MAX};
    static const uint16_t steps[] = {30U, 30U, 30U, 31U, ELMOPP_HORIZON_MAX};
    for (uint32_t i = 0U; i < 5U; i++) {
        start_with(ELMOPP_FORECAST_MEAN, asked_s[i]);
        step();
        TEST_ASSERT_EQUAL_UINT16(steps[i], script.view.foreseen_steps);
    }
}

static void test_without_a_forecast_nothing_is_foreseen(void) {
    start_with(ELMOPP_FORECAST_NONE, 60U);
    arrived_veh[0] = 1.0F;
    step();
    TEST_ASSERT_EQUAL_UINT16(0U, script.view.foreseen_steps);
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        TEST_ASSERT_NULL(script.view.foreseen_veh[i]);
    }
    TEST_ASSERT_EQUAL_FLOAT(0.0F, pilot.foreseen_sum_veh[0]);
}

static void test_foreseen_sum_is_that_of_60_seconds(void) {
    start_with(ELMOPP_FORECAST_PERSISTENCE, ELMOPP_HORIZON_MAX);
    arrived_veh[0] = 0.5F;
    arrived_veh[1] = 0.25F;
    step();
    TEST_ASSERT_EQUAL_FLOAT(30.0F, pilot.foreseen_sum_veh[0]);
    TEST_ASSERT_EQUAL_FLOAT(15.0F, pilot.foreseen_sum_veh[1]);
    arrived_veh[0] = 1.0F;
    step();
    TEST_ASSERT_EQUAL_FLOAT(60.0F, pilot.foreseen_sum_veh[0]);
}

static void test_rows_of_an_oracle_replace_the_forecast(void) {
    static float row_veh[APPROACHES][ELMOPP_HORIZON_MAX];
    for (uint32_t t = 0U; t < ELMOPP_HORIZON_MAX; t++) {
        row_veh[0][t] = (float)(t + 1U);
        row_veh[1][t] = 1000.0F;
    }
    elmopp_foreseen_t oracle = {.row_veh = {row_veh[0], row_veh[1]}, .steps = ELMOPP_HORIZON_MAX};
    start_with(ELMOPP_FORECAST_MEAN, 59U);
    arrived_veh[0] = 7.0F;
    TEST_ASSERT_TRUE(elmopp_pilot_step(&pilot, &counts, &oracle));
    TEST_ASSERT_EQUAL_UINT16(ELMOPP_HORIZON_MAX, script.view.foreseen_steps);
    TEST_ASSERT_EQUAL_PTR(row_veh[0], script.view.foreseen_veh[0]);
    TEST_ASSERT_EQUAL_PTR(row_veh[1], script.view.foreseen_veh[1]);
    TEST_ASSERT_EQUAL_FLOAT(1830.0F, pilot.foreseen_sum_veh[0]);
    TEST_ASSERT_EQUAL_FLOAT(60000.0F, pilot.foreseen_sum_veh[1]);
    oracle.steps = 3U;
    TEST_ASSERT_TRUE(elmopp_pilot_step(&pilot, &counts, &oracle));
    TEST_ASSERT_EQUAL_UINT16(3U, script.view.foreseen_steps);
    TEST_ASSERT_EQUAL_FLOAT(6.0F, pilot.foreseen_sum_veh[0]);
}

static elmopp_outflow_t outflow[ELMOPP_APPROACH_MAX];

/* A second in which only the neighbour of approach 1 speaks: 1 vehicle in 10 s and 2 in the 4 s after. */
static void step_with_a_neighbour(const elmopp_foreseen_t *foreseen) {
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        outflow[i] = (elmopp_outflow_t){.next10_veh = 0.0F};
    }
    outflow[1] = (elmopp_outflow_t){.next10_veh = 1.0F, .next30_veh = 3.0F, .next60_veh = 3.0F, .ahead_s = 14U};
    const elmopp_counts_t heard = {present_veh, arrived_veh, 0U, outflow};
    TEST_ASSERT_TRUE(elmopp_pilot_step(&pilot, &heard, foreseen));
}

static void test_what_a_neighbour_announces_is_the_beginning_of_the_row(void) {
    start_with(ELMOPP_FORECAST_PERSISTENCE, 60U);
    arrived_veh[0] = 0.5F;
    arrived_veh[1] = 0.25F;
    step_with_a_neighbour(NULL);
    TEST_ASSERT_EQUAL_UINT16(60U, script.view.foreseen_steps);
    TEST_ASSERT_EQUAL_FLOAT(0.1F, script.first_veh[1]);
    TEST_ASSERT_EQUAL_FLOAT(0.25F, script.last_veh[1]);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-4F, 3.0F + (46.0F * 0.25F), pilot.foreseen_sum_veh[1]);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-4F, 1.0F, pilot.soon_veh[0][1]);
    TEST_ASSERT_EQUAL_FLOAT(30.0F, pilot.foreseen_sum_veh[0]);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORESIGHT_OWN, pilot.foresight);
}

static void test_without_a_forecast_a_neighbour_is_foreseen_and_nobody_else(void) {
    start_with(ELMOPP_FORECAST_NONE, 90U);
    arrived_veh[0] = 1.0F;
    step_with_a_neighbour(NULL);
    TEST_ASSERT_EQUAL_UINT16(90U, script.view.foreseen_steps);
    TEST_ASSERT_NULL_MESSAGE(script.view.foreseen_veh[0], "nobody is not what is unknown");
    TEST_ASSERT_NOT_NULL(script.view.foreseen_veh[1]);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, pilot.foreseen_sum_veh[0]);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-5F, 3.0F, pilot.foreseen_sum_veh[1]);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, script.last_veh[1]);
}

static void test_a_neighbour_is_heard_over_an_oracle_too_and_the_oracles_rows_stay(void) {
    static float row_veh[APPROACHES][ELMOPP_HORIZON_MAX];
    for (uint32_t t = 0U; t < ELMOPP_HORIZON_MAX; t++) {
        row_veh[0][t] = 1.0F;
        row_veh[1][t] = 2.0F;
    }
    const elmopp_foreseen_t oracle = {.row_veh = {row_veh[0], row_veh[1]}, .steps = 20U};
    start_with(ELMOPP_FORECAST_MEAN, 60U);
    step_with_a_neighbour(&oracle);
    TEST_ASSERT_EQUAL_UINT16(20U, script.view.foreseen_steps);
    TEST_ASSERT_EQUAL_FLOAT(20.0F, pilot.foreseen_sum_veh[0]);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-4F, 3.0F + 12.0F, pilot.foreseen_sum_veh[1]);
    TEST_ASSERT_EQUAL_FLOAT(2.0F, row_veh[1][0]);
}

static void test_neighbours_that_say_nothing_are_as_if_there_were_none(void) {
    static const elmopp_outflow_t silent[ELMOPP_APPROACH_MAX];
    const elmopp_counts_t heard = {present_veh, arrived_veh, 0U, silent};
    start_with(ELMOPP_FORECAST_NONE, 60U);
    TEST_ASSERT_TRUE(elmopp_pilot_step(&pilot, &heard, NULL));
    TEST_ASSERT_EQUAL_UINT16(0U, script.view.foreseen_steps);
    TEST_ASSERT_NULL(script.view.foreseen_veh[0]);
}

/* The account is of what the forecast said itself. */
static void test_what_neighbours_say_is_not_on_the_forecasts_account(void) {
    start_with(ELMOPP_FORECAST_PERSISTENCE, 60U);
    for (uint32_t t = 0U; t < 100U; t++) {
        arrived_veh[1] = 0.5F;
        step_with_a_neighbour(NULL);
    }
    const elmopp_account_error_t error = elmopp_forecast_error(&pilot.forecast);
    TEST_ASSERT_TRUE(error.compared_s > 0U);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, error.forecast);
}

/* While an oracle speaks, the forecast goes on to learn. */
static void test_the_forecast_observes_under_an_oracle_too(void) {
    static const elmopp_foreseen_t blind = {.steps = 0U};
    start_with(ELMOPP_FORECAST_MEAN, 0U);
    arrived_veh[1] = 3.0F;
    TEST_ASSERT_TRUE(elmopp_pilot_step(&pilot, &counts, &blind));
    TEST_ASSERT_EQUAL_UINT16(0U, script.view.foreseen_steps);
    arrived_veh[1] = 1.0F;
    step();
    TEST_ASSERT_EQUAL_FLOAT(2.0F, script.first_veh[1]);
}

static void test_absorb_shows_the_forecast_a_second_and_decides_nothing(void) {
    start_with(ELMOPP_FORECAST_MEAN, 0U);
    arrived_veh[0] = 4.0F;
    elmopp_pilot_absorb(&pilot, arrived_veh);
    TEST_ASSERT_EQUAL_UINT32(0U, script.calls);
    lamp_ticks(1U);
    TEST_ASSERT_EQUAL_HEX16(0x0007U, lamps.red);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_STAGE_NONE, pilot.plan.target);
    arrived_veh[0] = 2.0F;
    step();
    TEST_ASSERT_EQUAL_FLOAT(3.0F, script.first_veh[0]);
}

static void test_sixty_absorbed_seconds_make_the_shares_known(void) {
    arrived_veh[0] = 0.75F;
    arrived_veh[2] = 0.25F;
    for (uint32_t n = 0U; n < 59U; n++) {
        elmopp_pilot_absorb(&pilot, arrived_veh);
    }
    step();
    TEST_ASSERT_FLOAT_WITHIN(1.0e-5F, 0.75F, script.share[0]);
}

/* --- whom the pilot trusts --- */

/* A network that says far too much, and traffic that never changes: the mean and persistence are right. */
static void start_with_a_loud(uint8_t network) {
    static elmopp_weights_t loud;
    static const float mean_veh_per_s[APPROACHES] = {1.0F, 1.0F};
    loud = elmopp_weights_lstm;
    loud.lstm.head_bias[0] = 900.0F;
    loud.ann.head_bias[0] = 900.0F;
    loud.gcn.head_bias = 900.0F;
    const elmopp_forecast_config_t config = {.kind = network, .mean_veh_per_s = mean_veh_per_s, .weights = &loud};
    start(0U, &config);
    arrived_veh[0] = 1.0F;
    arrived_veh[1] = 1.0F;
}

static void start_with_a_loud_network(void) {
    start_with_a_loud(ELMOPP_FORECAST_LSTM);
}

static void test_a_network_is_told_from_its_own_rows_and_its_cold_start(void) {
    start_with_a_loud_network();
    for (uint32_t n = 1U; n < ELMOPP_FORECAST_COLD_S; n++) {
        step();
        TEST_ASSERT_EQUAL_INT(ELMOPP_FORESIGHT_COLD, pilot.foresight);
        TEST_ASSERT_EQUAL_FLOAT(1.0F, script.first_veh[0]);
    }
    step();
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORESIGHT_OWN, pilot.foresight);
    TEST_ASSERT_EQUAL_FLOAT(elmopp_weights_lstm.high[0], script.first_veh[0]);
}

/* Cold probes say the mean and are right, so the account is bad from the first warm one on. */
static void test_a_network_that_is_worse_than_the_mean_is_not_listened_to(void) {
    start_with_a_loud_network();
    const uint32_t first_wrong = ELMOPP_FORECAST_COLD_S + ELMOPP_ACCOUNT_PROBE_S;
    for (uint32_t n = 1U; n < first_wrong; n++) {
        step();
        TEST_ASSERT_FALSE(pilot.foresight == ELMOPP_FORESIGHT_DISTRUSTED);
    }
    step();
    TEST_ASSERT_EQUAL_UINT32(ELMOPP_PILOT_ACCOUNT_MIN_S, elmopp_forecast_error(&pilot.forecast).compared_s);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORESIGHT_DISTRUSTED, pilot.foresight);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, script.first_veh[0]);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, script.last_veh[0]);
    elmopp_pilot_look_on(&pilot);
    TEST_ASSERT_EQUAL_FLOAT(60.0F, pilot.foreseen_sum_veh[0]);
}

static void test_networks_that_see_windows_can_lose_trust_too(void) {
    static const uint8_t networks[2] = {ELMOPP_FORECAST_ANN, ELMOPP_FORECAST_GCN};
    for (uint32_t k = 0U; k < 2U; k++) {
        start_with_a_loud(networks[k]);
        for (uint32_t n = 1U; n < (ELMOPP_FORECAST_COLD_S + ELMOPP_ACCOUNT_PROBE_S); n++) {
            step();
            TEST_ASSERT_EQUAL_INT((n < ELMOPP_FORECAST_COLD_S) ? ELMOPP_FORESIGHT_COLD : ELMOPP_FORESIGHT_OWN,
                                  pilot.foresight);
        }
        step();
        TEST_ASSERT_EQUAL_INT(ELMOPP_FORESIGHT_DISTRUSTED, pilot.foresight);
        TEST_ASSERT_EQUAL_FLOAT(1.0F, script.first_veh[0]);
    }
}

static void test_an_account_that_is_too_short_is_no_reason(void) {
    start_with_a_loud_network();
    seconds(70U, 0U);
    pilot.forecast.account.error = (elmopp_account_error_t){9.0F, 1.0F, 1.0F, ELMOPP_PILOT_ACCOUNT_MIN_S - 2U};
    step();
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORESIGHT_OWN, pilot.foresight);
}

/* What a network gives way to is the mean, so persistence is no rival; as good as the mean is good enough; and trust
 * comes back. */
static void test_trust_follows_the_account_against_the_mean(void) {
    static const elmopp_account_error_t accounts[] = {
        {2.0F, 3.0F, 1.0F, 500U}, {2.0F, 1.0F, 3.0F, 500U}, {2.0F, 3.0F, 2.0F, 500U}, {2.01F, 0.0F, 2.0F, 500U}};
    static const elmopp_foresight_t right[] = {ELMOPP_FORESIGHT_DISTRUSTED, ELMOPP_FORESIGHT_OWN, ELMOPP_FORESIGHT_OWN,
                                               ELMOPP_FORESIGHT_DISTRUSTED};
    start_with_a_loud_network();
    for (uint32_t n = 0U; n < 70U; n++) {
        elmopp_pilot_absorb(&pilot, arrived_veh); /* nothing is said, so nothing is compared */
    }
    for (uint32_t i = 0U; i < 4U; i++) {
        pilot.forecast.account.error = accounts[i];
        step();
        TEST_ASSERT_EQUAL_INT(right[i], pilot.foresight);
    }
}

/* The comparison rows of the experiment stay what they are called. */
static void test_only_a_network_can_lose_trust(void) {
    start_with(ELMOPP_FORECAST_PERSISTENCE, 0U);
    pilot.forecast.account.error = (elmopp_account_error_t){9.0F, 1.0F, 1.0F, 500U};
    arrived_veh[0] = 2.0F;
    step();
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORESIGHT_OWN, pilot.foresight);
    TEST_ASSERT_EQUAL_FLOAT(2.0F, script.first_veh[0]);
}

/* --- when it learns --- */

static elmopp_learner_t learner;
static elmopp_trainer_memory_t trainer;

static uint32_t works(void) {
    return learner.second + (ELMOPP_LEARNER_CYCLE_S * learner.trainer.updates);
}

static void start_learning(void) {
    static const float mean_veh_per_s[APPROACHES] = {1.0F, 1.0F};
    elmopp_learner_init(&learner, &trainer, NULL, &elmopp_weights_lstm, ELMOPP_LEARNER_CAREFUL, APPROACHES);
    const elmopp_forecast_config_t config = {.kind = ELMOPP_FORECAST_LSTM,
                                             .mean_veh_per_s = mean_veh_per_s,
                                             .weights = &elmopp_weights_lstm,
                                             .learner = &learner};
    start(0U, &config);
    arrived_veh[0] = 1.0F;
    for (uint32_t n = 0U; n <= (ELMOPP_TRAINER_WINDOW + 1U); n++) {
        elmopp_pilot_absorb(&pilot, arrived_veh);
    }
}

static void test_it_learns_in_the_fifth_lamp_tick_after_a_step_and_in_no_other(void) {
    start_learning();
    for (uint32_t n = 0U; n < 5U; n++) {
        const uint32_t before = works();
        step();
        for (uint32_t tick = 1U; tick <= 12U; tick++) { /* also if the next step is late */
            TEST_ASSERT_EQUAL_UINT32((tick > ELMOPP_PILOT_LEARN_DS) ? (before + 1U) : before, works());
            lamp_ticks(1U);
        }
    }
}

static void test_a_second_is_learnt_from_once_and_a_blind_one_never(void) {
    start_learning();
    const uint32_t before = works();
    step();
    elmopp_pilot_learn(&pilot);
    TEST_ASSERT_EQUAL_UINT32(before + 1U, works());
    elmopp_pilot_learn(&pilot);
    lamp_ticks(10U);
    elmopp_pilot_step_blind(&pilot);
    lamp_ticks(10U);
    TEST_ASSERT_EQUAL_UINT32(before + 1U, works());
}

static void test_weights_that_cannot_be_used_are_told(void) {
    start_with(ELMOPP_FORECAST_NLSTM, 0U);
    arrived_veh[0] = 2.0F;
    step();
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORESIGHT_UNARMED, pilot.foresight);
    TEST_ASSERT_EQUAL_FLOAT(2.0F, script.first_veh[0]);
}

static void test_rows_from_outside_are_told(void) {
    static const elmopp_foreseen_t blind = {.steps = 0U};
    TEST_ASSERT_TRUE(elmopp_pilot_step(&pilot, &counts, &blind));
    TEST_ASSERT_EQUAL_INT(ELMOPP_FORESIGHT_GIVEN, pilot.foresight);
}

/* --- with a real chooser --- */

/* Stage 0 serves until the hold window ends it: chosen at second 0, up at 1 s, left at 1 + 10 s for the longer queue.
 */
static void test_urgency_drives_the_lamps(void) {
    elmopp_urgency_t urgency;
    const elmopp_urgency_options_t options = {.min_s = 10U, .max_s = 60U, .hysteresis = 1.0F};
    const elmopp_chooser_t chooser = elmopp_urgency_init(&urgency, &options);
    const elmopp_forecast_config_t none = {.kind = ELMOPP_FORECAST_NONE};
    elmopp_pilot_init(&pilot, &junction, &chooser, &none);
    wait_out_the_start();
    present_veh[0] = 2.0F;
    step();
    lamp_ticks(10U);
    present_veh[0] = 0.0F;
    present_veh[2] = 2.0F;
    for (uint32_t second = 1U; second < 11U; second++) {
        step();
        lamp_ticks(10U);
        TEST_ASSERT_EQUAL_HEX16(0x0001U, lamps.green);
    }
    step();
    lamp_ticks(1U);
    TEST_ASSERT_EQUAL_UINT8(2U, pilot.plan.target);
    TEST_ASSERT_EQUAL_HEX16(0x0001U, lamps.amber);
}

/* --- what others may ask --- */

static void test_a_stage_that_does_not_exist_is_no_wish(void) {
    seconds(2U, 1U);
    for (uint32_t answer = MOVEMENTS; answer < 256U; answer++) {
        script.answer = (elmopp_stage_t)answer;
        step();
        TEST_ASSERT_EQUAL_UINT8(1U, pilot.wanted);
        lamp_ticks(1U);
        TEST_ASSERT_EQUAL_UINT8(1U, pilot.plan.target);
    }
}

static void test_a_movement_on_recall_waits_without_a_vehicle(void) {
    const elmopp_counts_t blind = {present_veh, arrived_veh, 0xFFFFFFFCU, NULL};
    seconds(2U, 1U);
    TEST_ASSERT_TRUE(elmopp_pilot_step(&pilot, &blind, NULL));
    TEST_ASSERT_EQUAL_HEX32(0x4U, pilot.waiting);
}

static void test_somebody_else_may_want_a_stage_or_red(void) {
    seconds(8U, 1U);
    lamps = elmopp_pilot_lamp_tick(&pilot, ELMOPP_STAGE_RED, false);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_STAGE_NONE, pilot.plan.target);
    TEST_ASSERT_EQUAL_HEX16(0x0002U, lamps.amber);
}

static void test_t_goes_on_in_all_red(void) {
    seconds(8U, 1U);
    for (uint32_t i = 0U; i < 200U; i++) {
        lamps = elmopp_pilot_lamp_tick(&pilot, ELMOPP_STAGE_RED, false);
    }
    TEST_ASSERT_EQUAL_UINT16(200U, pilot.red_ds[1]);
}

static void test_a_restart_is_red_with_running_intergreens_and_keeps_the_forecast(void) {
    start_with(ELMOPP_FORECAST_MEAN, 10U);
    arrived_veh[1] = 1.0F;
    seconds(20U, 1U);
    elmopp_pilot_restart(&pilot);
    TEST_ASSERT_EQUAL_UINT32(20U, pilot.forecast.seen_s);
    TEST_ASSERT_EQUAL_UINT8(ELMOPP_STAGE_NONE, pilot.wanted);
    lamps = elmopp_pilot_lamp_tick(&pilot, 1U, false);
    TEST_ASSERT_EQUAL_HEX16(0x0007U, lamps.red);
    TEST_ASSERT_EQUAL_HEX16(0x0000U, lamps.amber);
    for (uint32_t j = 0U; j < MOVEMENTS; j++) {
        TEST_ASSERT_EQUAL_UINT16(1U, pilot.red_ds[j]);
    }
}

static void test_what_comes_soon_is_summed_over_10_and_30_seconds(void) {
    start_with(ELMOPP_FORECAST_PERSISTENCE, 10U);
    arrived_veh[1] = 2.0F;
    step();
    TEST_ASSERT_EQUAL_FLOAT(20.0F, pilot.soon_veh[0][1]);
    TEST_ASSERT_EQUAL_FLOAT(60.0F, pilot.soon_veh[1][1]);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, pilot.soon_veh[0][0]);
}

static void test_the_rest_of_the_minute_is_foreseen_later_and_once(void) {
    start_with(ELMOPP_FORECAST_PERSISTENCE, 10U);
    arrived_veh[1] = 2.0F;
    step();
    TEST_ASSERT_EQUAL_FLOAT(60.0F, pilot.foreseen_sum_veh[1]);
    elmopp_pilot_look_on(&pilot);
    TEST_ASSERT_EQUAL_FLOAT(120.0F, pilot.foreseen_sum_veh[1]);
    elmopp_pilot_look_on(&pilot);
    TEST_ASSERT_EQUAL_FLOAT(120.0F, pilot.foreseen_sum_veh[1]);
    present_veh[0] = -1.0F; /* a second that is not believed foresees nothing anew */
    TEST_ASSERT_FALSE(elmopp_pilot_step(&pilot, &counts, NULL));
    elmopp_pilot_look_on(&pilot);
    TEST_ASSERT_EQUAL_FLOAT(120.0F, pilot.foreseen_sum_veh[1]);
}

static void test_an_oracles_rows_are_all_there_is_of_the_minute(void) {
    static const float row_veh[20] = {1.0F};
    const elmopp_foreseen_t oracle = {.row_veh = {row_veh, row_veh}, .steps = 20U};
    start_with(ELMOPP_FORECAST_PERSISTENCE, 10U);
    arrived_veh[0] = 7.0F;
    TEST_ASSERT_TRUE(elmopp_pilot_step(&pilot, &counts, &oracle));
    elmopp_pilot_look_on(&pilot);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, pilot.foreseen_sum_veh[0]);
}

/* Two pilots see the same: one foresees the minute at once, as its chooser looks so far, the other in two parts. What
   the neighbour announces reaches beyond the first part, and changes before the second. */
static void expect_the_same_minute(uint8_t kind) {
    static elmopp_pilot_t at_once;
    static elmopp_outflow_t said[ELMOPP_APPROACH_MAX];
    const elmopp_weights_t *weights = elmopp_forecast_is_nested(kind) ? &elmopp_weights_nlstm : &elmopp_weights_lstm;
    const elmopp_forecast_config_t config = {.kind = kind, .weights = weights};
    start(10U, &config);
    const elmopp_chooser_t looks_far = {choose, &script, ELMOPP_PILOT_TRACE_S};
    elmopp_pilot_init(&at_once, &junction, &looks_far, &config);
    const elmopp_counts_t heard = {present_veh, arrived_veh, 0U, said};
    for (uint32_t t = 0U; t < 100U; t++) {
        for (uint32_t j = 0U; j < MOVEMENTS; j++) {
            arrived_veh[j] = 0.1F * (float)((t * (j + 3U)) % 17U);
        }
        said[1] = (elmopp_outflow_t){
            .next10_veh = 1.0F, .next30_veh = 4.0F, .next60_veh = 9.0F, .ahead_s = ((t % 3U) == 0U) ? 55U : 0U};
        TEST_ASSERT_TRUE(elmopp_pilot_step(&at_once, &heard, NULL));
        TEST_ASSERT_TRUE(elmopp_pilot_step(&pilot, &heard, NULL));
        said[1].next60_veh = 90.0F;
        elmopp_pilot_look_on(&pilot);
        TEST_ASSERT_EQUAL_MEMORY(at_once.soon_veh, pilot.soon_veh, sizeof pilot.soon_veh);
        TEST_ASSERT_EQUAL_MEMORY(at_once.foreseen_sum_veh, pilot.foreseen_sum_veh, sizeof pilot.foreseen_sum_veh);
    }
}

static void test_a_minute_in_two_parts_is_the_minute_to_the_bit(void) {
    for (uint8_t kind = 0U; kind < ELMOPP_FORECAST_COUNT; kind++) {
        if (kind != ELMOPP_FORECAST_AR8) { /* which needs coefficients */
            expect_the_same_minute(kind);
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_wish_goes_to_the_plan_and_the_lamps_come_back);
    RUN_TEST(test_without_a_decision_all_lamps_are_red);
    RUN_TEST(test_the_chooser_is_asked_every_second_also_in_the_intergreen);
    RUN_TEST(test_an_answer_in_the_intergreen_is_not_used);
    RUN_TEST(test_the_view_before_the_first_decision_names_no_stage);
    RUN_TEST(test_the_view_holds_what_was_counted);
    RUN_TEST(test_elapsed_grows_by_10_a_second);
    RUN_TEST(test_scores_are_kept_for_the_log);
    RUN_TEST(test_going_is_the_mask_of_the_movements_that_are_green);
    RUN_TEST(test_t_grows_by_10_a_second_on_red_and_is_0_on_green);
    RUN_TEST(test_t_starts_with_amber_and_ends_with_green);
    RUN_TEST(test_t_of_a_movement_with_two_groups_needs_both_green);
    RUN_TEST(test_t_saturates);
    RUN_TEST(test_t_is_0_until_the_first_decision);
    RUN_TEST(test_demand_needs_a_whole_vehicle_on_red);
    RUN_TEST(test_vehicles_on_green_demand_nothing);
    RUN_TEST(test_demand_names_the_movement_and_not_its_groups);
    RUN_TEST(test_demand_is_that_of_all_movements_that_exist);
    RUN_TEST(test_t_of_movements_that_do_not_exist_is_not_counted);
    RUN_TEST(test_demand_reaches_the_maximum_green_of_the_plan);
    RUN_TEST(test_bad_counts_let_the_maximum_greens_turn_the_stages);
    RUN_TEST(test_when_blind_every_movement_on_red_waits);
    RUN_TEST(test_a_forced_stage_outlives_the_wish_from_before);
    RUN_TEST(test_bad_counts_are_refused_and_change_nothing);
    RUN_TEST(test_a_blind_second_is_a_refused_one);
    RUN_TEST(test_after_a_refusal_the_wish_stays_as_it_is);
    RUN_TEST(test_counts_of_zero_and_a_million_are_taken);
    RUN_TEST(test_counts_beyond_the_movements_are_not_read);
    RUN_TEST(test_the_forecast_sees_the_second_before_the_chooser);
    RUN_TEST(test_the_forecast_has_the_steps_asked_for_but_at_least_half_a_minute);
    RUN_TEST(test_without_a_forecast_nothing_is_foreseen);
    RUN_TEST(test_foreseen_sum_is_that_of_60_seconds);
    RUN_TEST(test_rows_of_an_oracle_replace_the_forecast);
    RUN_TEST(test_what_a_neighbour_announces_is_the_beginning_of_the_row);
    RUN_TEST(test_without_a_forecast_a_neighbour_is_foreseen_and_nobody_else);
    RUN_TEST(test_a_neighbour_is_heard_over_an_oracle_too_and_the_oracles_rows_stay);
    RUN_TEST(test_neighbours_that_say_nothing_are_as_if_there_were_none);
    RUN_TEST(test_what_neighbours_say_is_not_on_the_forecasts_account);
    RUN_TEST(test_the_forecast_observes_under_an_oracle_too);
    RUN_TEST(test_absorb_shows_the_forecast_a_second_and_decides_nothing);
    RUN_TEST(test_sixty_absorbed_seconds_make_the_shares_known);
    RUN_TEST(test_a_network_is_told_from_its_own_rows_and_its_cold_start);
    RUN_TEST(test_a_network_that_is_worse_than_the_mean_is_not_listened_to);
    RUN_TEST(test_networks_that_see_windows_can_lose_trust_too);
    RUN_TEST(test_an_account_that_is_too_short_is_no_reason);
    RUN_TEST(test_trust_follows_the_account_against_the_mean);
    RUN_TEST(test_only_a_network_can_lose_trust);
    RUN_TEST(test_it_learns_in_the_fifth_lamp_tick_after_a_step_and_in_no_other);
    RUN_TEST(test_a_second_is_learnt_from_once_and_a_blind_one_never);
    RUN_TEST(test_weights_that_cannot_be_used_are_told);
    RUN_TEST(test_rows_from_outside_are_told);
    RUN_TEST(test_urgency_drives_the_lamps);
    RUN_TEST(test_a_stage_that_does_not_exist_is_no_wish);
    RUN_TEST(test_a_movement_on_recall_waits_without_a_vehicle);
    RUN_TEST(test_somebody_else_may_want_a_stage_or_red);
    RUN_TEST(test_t_goes_on_in_all_red);
    RUN_TEST(test_a_restart_is_red_with_running_intergreens_and_keeps_the_forecast);
    RUN_TEST(test_what_comes_soon_is_summed_over_10_and_30_seconds);
    RUN_TEST(test_the_rest_of_the_minute_is_foreseen_later_and_once);
    RUN_TEST(test_an_oracles_rows_are_all_there_is_of_the_minute);
    RUN_TEST(test_a_minute_in_two_parts_is_the_minute_to_the_bit);
    return UNITY_END();
}
