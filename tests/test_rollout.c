/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "assert_catcher.h"
#include "elmopp/rollout.h"
#include "random.h"
#include "sites.h"
#include "unity.h"
#include "view.h"

#include <math.h>

#ifndef DECISIONS
#define DECISIONS 100000U
#endif

#define SHORT_S 10U

/* Stages of one movement each: saturation flow 0.5, start-up 2 s, intergreen 5.5 s, so 6 s of the model. */
static elmopp_junction_t junction;
static elmopp_rollout_options_t options;
static elmopp_rollout_t rollout;
static elmopp_chooser_t chooser;
static test_view_t seen;

static void start(void) {
    chooser = elmopp_rollout_init(&rollout, &options);
    test_view_init(&seen, &junction);
}

static void start_with_stages(uint32_t stages) {
    junction = test_cross(stages);
    start();
}

void setUp(void) {
    options = elmopp_rollout_defaults(0U);
    start_with_stages(2U);
}
void tearDown(void) {}

static void set_queues(float first, float second, float third) {
    seen.queue_veh[0] = first;
    seen.queue_veh[1] = second;
    seen.queue_veh[2] = third;
}

static elmopp_stage_t ask_in(elmopp_stage_t stage, uint32_t elapsed_ds) {
    test_view_show(&seen, stage, elapsed_ds);
    return test_view_ask(&seen, &chooser);
}

static void expect_no_scores(void) {
    for (uint32_t s = 0U; s < ELMOPP_STAGE_MAX; s++) {
        TEST_ASSERT_EQUAL_FLOAT(0.0F, seen.score[s]);
    }
}

/* Ten seconds that all weigh the same, and a first action that no rule follows: what can be worked out by hand. */
static void look_ten_seconds_ahead(void) {
    options.coming.horizon_s = SHORT_S;
    options.hold_count = 1U;
    options.hold_s[0] = SHORT_S;
    options.rule_count = 1U;
    start();
}

static void test_the_defaults_are_those_that_were_measured(void) {
    const elmopp_rollout_options_t measured = elmopp_rollout_defaults(8U);
    TEST_ASSERT_EQUAL_UINT16(8U, measured.sight.travel_s[0]);
    TEST_ASSERT_EQUAL_UINT16(5U, measured.future.min_s);
    TEST_ASSERT_EQUAL_UINT16(60U, measured.future.max_s);
    TEST_ASSERT_EQUAL_UINT16(180U, measured.red_s);
    TEST_ASSERT_EQUAL_UINT16(120U, measured.coming.horizon_s);
    const uint16_t hold_s[ELMOPP_ROLLOUT_HOLD_MAX] = {1U, 2U, 3U, 5U, 10U};
    TEST_ASSERT_EQUAL_UINT16_ARRAY(hold_s, measured.hold_s, measured.hold_count);
    const float ratio[ELMOPP_ROLLOUT_RULE_MAX] = {2.5F, 4.0F, 6.0F};
    TEST_ASSERT_EQUAL_FLOAT_ARRAY(ratio, measured.ratio, measured.rule_count);
    TEST_ASSERT_EQUAL_UINT8(4U, measured.others_max);
    TEST_ASSERT_EQUAL_FLOAT(0.5F, measured.caution);
    TEST_ASSERT_TRUE(measured.coming.weigh_skill);
    TEST_ASSERT_EQUAL_UINT16(30U, measured.coming.rows_s);
    TEST_ASSERT_EQUAL_FLOAT(0.5F, measured.coming.row_weight);
    TEST_ASSERT_EQUAL_UINT16(60U, measured.coming.fade_s);
    TEST_ASSERT_EQUAL_FLOAT(0.5F, measured.coming.mean_weight);
    TEST_ASSERT_EQUAL_UINT16(40U, measured.patience_s);
    TEST_ASSERT_EQUAL_FLOAT(60.0F, measured.patience_veh_s);
    TEST_ASSERT_EQUAL_FLOAT(0.5F, measured.future.yellow_used_s);
    TEST_ASSERT_EQUAL_FLOAT(1.5F, measured.future.stop_s);
    TEST_ASSERT_TRUE(measured.future.look);
}

static void test_it_asks_for_the_forecast_that_its_horizon_needs(void) {
    TEST_ASSERT_EQUAL_UINT16(30U, chooser.horizon_s);
    options = elmopp_rollout_defaults(8U);
    options.coming.rows_s = ELMOPP_HORIZON_MAX;
    TEST_ASSERT_EQUAL_UINT16(112U, elmopp_rollout_init(&rollout, &options).horizon_s);
    options.coming.horizon_s = 8U;
    TEST_ASSERT_EQUAL_UINT16(0U, elmopp_rollout_init(&rollout, &options).horizon_s);
}

static void test_the_first_stage_is_that_of_most_vehicles_times_flow(void) {
    set_queues(2.0F, 3.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, test_view_ask(&seen, &chooser));
    set_queues(3.0F, 3.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, test_view_ask(&seen, &chooser));
    expect_no_scores();
}

static void test_in_the_intergreen_it_sees_arrivals_and_keeps_the_target(void) {
    set_queues(9.0F, 0.0F, 0.0F);
    seen.arrivals_veh[0] = 2.0F;
    test_view_clear_to(&seen, 1U);
    TEST_ASSERT_EQUAL_UINT8(1U, test_view_ask(&seen, &chooser));
    TEST_ASSERT_EQUAL_FLOAT(2.0F, rollout.sight.mean_veh_per_s[0]);
    expect_no_scores();
}

static void test_a_stage_is_never_left_before_min(void) {
    set_queues(0.0F, 9.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 49U));
    expect_no_scores();
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 50U));
}

static void test_green_rests_where_nobody_waits_on_red(void) {
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(1U, 300U));
    set_queues(0.0F, 5.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(1U, 60000U));
    expect_no_scores();
}

static void test_a_dead_green_is_left(void) {
    set_queues(0.0F, 1.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 100U));
}

static void test_a_queue_that_empties_soon_is_served_first(void) {
    set_queues(2.0F, 3.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 100U));
    set_queues(1.0F, 3.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 120U));
    set_queues(0.0F, 3.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 140U));
}

/* 5 s of a slow queue against a fast one: worth a change that costs nothing, not one that costs 8 s. */
static void test_the_price_of_a_change_decides(void) {
    junction.movement[0].saturation_veh_per_s = 0.3F;
    start();
    set_queues(1.5F, 4.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 100U));
    for (uint32_t g = 0U; g < 2U; g++) {
        junction.group[g].amber_ds = 0U;
        junction.group[g].red_amber_ds = 0U;
        junction.intergreen_ds[g][1U - g] = 0U;
        junction.movement[g].startup_ds = 0U;
    }
    start();
    set_queues(1.5F, 4.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 100U));
}

/* Kept: the first queue is 2.5, 2, 1.5, 1, 0.5, 0 ..., the second 2 for 10 s. Left: a quarter of a vehicle more
   leaves in half a second of amber, then 6 s of intergreen and 2 s of start-up, then 1.5 and 1. What is left, x, costs
   x^2 / (2 * 0.5). */
static void test_a_score_is_minus_the_sum_of_all_queues(void) {
    look_ten_seconds_ahead();
    set_queues(3.0F, 2.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 50U));
    TEST_ASSERT_EQUAL_FLOAT(-(7.5F + 20.0F + 4.0F), seen.score[0]);
    TEST_ASSERT_EQUAL_FLOAT(-(27.5F + 16.0F + 2.5F + 7.5625F + 1.0F), seen.score[1]);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, seen.score[2]);
}

/* The same with a reach: two of the second queue stand when they get green, and have braked. */
static void test_who_starts_from_a_queue_has_lost_a_stop(void) {
    options = elmopp_rollout_defaults(8U);
    look_ten_seconds_ahead();
    set_queues(3.0F, 2.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 50U));
    TEST_ASSERT_EQUAL_FLOAT(-(7.5F + 20.0F + 4.0F), seen.score[0]);
    TEST_ASSERT_EQUAL_FLOAT(-(27.5F + 16.0F + 2.5F + 7.5625F + 1.0F + (1.5F * 2.0F)), seen.score[1]);
}

static void test_a_stage_that_nobody_asks_for_is_not_tried(void) {
    start_with_stages(3U);
    set_queues(3.0F, 2.0F, 0.0F);
    (void)ask_in(0U, 50U);
    TEST_ASSERT_TRUE((seen.score[0] < 0.0F) && (seen.score[1] < 0.0F));
    TEST_ASSERT_EQUAL_FLOAT(0.0F, seen.score[2]);
}

static void test_the_heaviest_others_are_tried_first(void) {
    options.others_max = 1U;
    start_with_stages(3U);
    set_queues(3.0F, 2.0F, 2.5F);
    (void)ask_in(0U, 50U);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, seen.score[1]);
    TEST_ASSERT_TRUE(seen.score[2] < 0.0F);
    options.others_max = 2U;
    chooser = elmopp_rollout_init(&rollout, &options);
    (void)ask_in(0U, 50U);
    TEST_ASSERT_TRUE((seen.score[1] < 0.0F) && (seen.score[2] < 0.0F));
}

static elmopp_stage_t ask_with_caution(float caution, uint32_t own_quarters, float scores[2]) {
    options.caution = caution;
    start_with_stages(3U);
    seen.arrivals_veh[0] = 0.3F;
    seen.arrivals_veh[1] = 0.2F;
    set_queues(0.25F * (float)own_quarters, 9.0F, 6.0F);
    const elmopp_stage_t wanted = ask_in(0U, 100U);
    scores[0] = seen.score[0];
    scores[1] = seen.score[1];
    return wanted;
}

/* What is kept has no doubt; a change that is worth less under one rule than in the mean has, the more of it the
   greater the caution. Never does caution change where the mean would not. */
static void test_a_change_must_pay_whatever_is_done_after_it(void) {
    uint32_t doubted = 0U;
    for (uint32_t own_quarters = 0U; own_quarters < 80U; own_quarters++) {
        float bold[2];
        float between[2];
        float cautious[2];
        const elmopp_stage_t by_the_mean = ask_with_caution(0.0F, own_quarters, bold);
        (void)ask_with_caution(0.5F, own_quarters, between);
        const elmopp_stage_t by_the_worst = ask_with_caution(1.0F, own_quarters, cautious);
        TEST_ASSERT_EQUAL_FLOAT(bold[0], cautious[0]);
        TEST_ASSERT_TRUE(cautious[1] <= bold[1]);
        TEST_ASSERT_FLOAT_WITHIN(0.01F, 0.5F * (bold[1] + cautious[1]), between[1]);
        TEST_ASSERT_TRUE((by_the_worst == 0U) || (by_the_mean != 0U));
        doubted += (cautious[1] < (bold[1] - 1.0F)) ? 1U : 0U;
    }
    TEST_ASSERT_TRUE(doubted > 0U);
}

/* Rows of both approaches that say the same of each second. */
static void foresee(float veh, uint16_t seconds) {
    static float row_veh[ELMOPP_HORIZON_MAX];
    for (uint32_t t = 0U; t < seconds; t++) {
        row_veh[t] = veh;
    }
    seen.view.foreseen_steps = seconds;
    seen.view.foreseen_veh[0] = row_veh;
    seen.view.foreseen_veh[1] = row_veh;
}

/* Two wait on red, and 0.4 a second are foreseen to join them for ten seconds. */
static void ask_with_rows(void) {
    foresee(0.4F, SHORT_S);
    seen.share[0] = 0.0F;
    set_queues(0.0F, 2.0F, 0.0F);
    (void)ask_in(0U, 50U);
}

/* 0.4 vehicles a second at half weight: the second queue is 2.2, 2.4, ... 4. */
static void test_rows_are_taken_at_a_fixed_weight(void) {
    options.coming.weigh_skill = false;
    look_ten_seconds_ahead();
    ask_with_rows();
    TEST_ASSERT_FLOAT_WITHIN(1.0e-4F, -(20.0F + (0.2F * 55.0F) + 16.0F), seen.score[0]);
    options.coming.row_weight = 1.0F;
    chooser = elmopp_rollout_init(&rollout, &options);
    (void)ask_in(0U, 50U);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-4F, -(20.0F + (0.4F * 55.0F) + 36.0F), seen.score[0]);
}

/* 0.24 a second came, half of it is expected; rows of 0.4 with a skill of 3/4, of which row k has 1 - k / 60:
   0.12 + 0.75 * 0.28 = 0.33 in the first second, 0.3265, 0.323, ... The second queue is 2.33, 2.6565,
   ... 5.1425, 37.5725 in all. */
static void test_rows_correct_the_mean_by_their_skill(void) {
    look_ten_seconds_ahead();
    rollout.coming.near.error = (elmopp_account_error_t){.compared_s = 60U, .forecast = 0.25F, .mean = 1.0F};
    seen.arrivals_veh[1] = 0.24F;
    ask_with_rows();
    TEST_ASSERT_FLOAT_WITHIN(1.0e-3F, -(37.5725F + (5.1425F * 5.1425F)), seen.score[0]);
}

/* Half the mean is 0.5, rows say 2.0 for a minute, which is believed near by half, less what row 19 has faded of 60,
   and far by nothing. The tables of the model tell who is expected. */
static void test_each_row_has_the_skill_of_the_nearer_account(void) {
    start();
    rollout.coming.near.error = (elmopp_account_error_t){.compared_s = 60U, .forecast = 0.5F, .mean = 1.0F};
    rollout.coming.far.error = (elmopp_account_error_t){.compared_s = 60U, .forecast = 1.0F, .mean = 1.0F};
    foresee(2.0F, 60U);
    seen.arrivals_veh[1] = 1.0F;
    set_queues(0.0F, 1.0F, 0.0F);
    (void)ask_in(0U, 50U);
    const float near_veh = rollout.coming.arrived_veh[1][20] - rollout.coming.arrived_veh[1][19];
    const float far_veh = rollout.coming.arrived_veh[1][21] - rollout.coming.arrived_veh[1][20];
    TEST_ASSERT_FLOAT_WITHIN(1.0e-4F, 0.5F + (0.5F * (41.0F / 60.0F) * 1.5F), near_veh);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-4F, 0.5F, far_veh);
}

/* Vehicles of two approaches come in every other second; rows of a minute say `said_veh` of those
   seconds and 1 - `said_veh` of the others. Returns the weight of the rows after `seconds`. */
static float weight_after(uint32_t seconds, float said_veh) {
    static float row_veh[60];
    start();
    seen.view.foreseen_steps = 60U;
    seen.view.foreseen_veh[0] = row_veh;
    seen.view.foreseen_veh[1] = row_veh;
    for (uint32_t t = 0U; t < seconds; t++) {
        const bool comes = (t % 2U) == 0U;
        for (uint32_t k = 0U; k < 60U; k++) {
            row_veh[k] = (((t + k) % 2U) == 1U) ? said_veh : (1.0F - said_veh);
        }
        seen.arrivals_veh[0] = comes ? 1.0F : 0.0F;
        seen.arrivals_veh[1] = seen.arrivals_veh[0];
        (void)ask_in(0U, 50U);
    }
    return rollout.coming.far_weight;
}

static void test_rows_that_come_true_count_in_full(void) {
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 1.0F, weight_after(200U, 1.0F));
}

/* Wrong by 0.1 where the mean is wrong by 0.5: a skill of 1 - 0.01 / 0.25. */
static void test_rows_count_by_what_they_have_been_better_than_the_mean(void) {
    TEST_ASSERT_FLOAT_WITHIN(0.004F, 0.96F, weight_after(600U, 0.9F));
    TEST_ASSERT_FLOAT_WITHIN(0.004F, 0.96F, rollout.coming.near_weight);
}

static void test_rows_that_are_no_better_than_the_mean_count_for_nothing(void) {
    TEST_ASSERT_FLOAT_WITHIN(0.01F, 0.0F, weight_after(600U, 0.5F));
    TEST_ASSERT_EQUAL_FLOAT(0.0F, weight_after(600U, 0.0F));
}

static void test_skill_is_known_after_a_minute_of_comparing(void) {
    TEST_ASSERT_EQUAL_FLOAT(0.0F, weight_after(ELMOPP_ACCOUNT_PROBE_S + 59U, 1.0F));
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 1.0F, weight_after(ELMOPP_ACCOUNT_PROBE_S + 60U, 1.0F));
    (void)weight_after(ELMOPP_COMING_NEAR_S + 59U, 1.0F);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, rollout.coming.near_weight);
    (void)weight_after(ELMOPP_COMING_NEAR_S + 60U, 1.0F);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 1.0F, rollout.coming.near_weight);
}

/* 0.4 a second in the rows for 3 s at half weight, then the mean, which is nobody: in the queue for 10, 9 and 8 s. */
static void test_rows_are_read_as_far_as_asked(void) {
    options.coming.rows_s = 3U;
    options.coming.weigh_skill = false;
    look_ten_seconds_ahead();
    TEST_ASSERT_EQUAL_UINT16(3U, chooser.horizon_s);
    ask_with_rows();
    TEST_ASSERT_FLOAT_WITHIN(1.0e-4F, -(20.0F + (0.2F * 27.0F) + (2.6F * 2.6F)), seen.score[0]);
}

/* Half the mean is 0.5, and rows of 2.0 that have come true are not believed from 60 s on. */
static void test_rows_have_faded_after_a_minute(void) {
    options.coming.rows_s = 100U;
    start();
    rollout.coming.near.error = (elmopp_account_error_t){.compared_s = 60U, .forecast = 0.0F, .mean = 1.0F};
    rollout.coming.far.error = rollout.coming.near.error;
    foresee(2.0F, 100U);
    seen.arrivals_veh[1] = 1.0F;
    set_queues(0.0F, 1.0F, 0.0F);
    (void)ask_in(0U, 50U);
    const float *arrived_veh = rollout.coming.arrived_veh[1];
    TEST_ASSERT_FLOAT_WITHIN(1.0e-4F, 0.5F + (1.5F * 30.0F / 60.0F), arrived_veh[31] - arrived_veh[30]);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-4F, 0.5F, arrived_veh[61] - arrived_veh[60]);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-4F, 0.5F, arrived_veh[91] - arrived_veh[90]);
}

static void test_a_fixed_weight_is_not_earned(void) {
    options.coming.weigh_skill = false;
    TEST_ASSERT_EQUAL_FLOAT(0.5F, weight_after(200U, 1.0F));
}

static void test_a_row_that_is_no_number_is_nobody(void) {
    static float row_veh[SHORT_S];
    options.coming.weigh_skill = false;
    look_ten_seconds_ahead();
    for (uint32_t t = 0U; t < SHORT_S; t++) {
        row_veh[t] = ((t % 2U) == 0U) ? NAN : -1.0F;
    }
    seen.view.foreseen_steps = SHORT_S;
    seen.view.foreseen_veh[0] = row_veh;
    seen.view.foreseen_veh[1] = row_veh;
    set_queues(0.0F, 2.0F, 0.0F);
    (void)ask_in(0U, 50U);
    TEST_ASSERT_EQUAL_FLOAT(-(20.0F + 4.0F), seen.score[0]);
}

static void test_without_rows_the_mean_of_the_arrivals_counts_half(void) {
    look_ten_seconds_ahead();
    set_queues(0.0F, 2.0F, 0.0F);
    seen.arrivals_veh[1] = 0.4F;
    (void)ask_in(0U, 50U);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-4F, -(20.0F + (0.2F * 55.0F) + 16.0F), seen.score[0]);
}

/* A neighbour speaks for the first approach alone: nobody knows of the second, whose mean counts as without rows. */
static void test_an_approach_without_a_row_is_expected_by_its_mean(void) {
    look_ten_seconds_ahead();
    foresee(9.0F, SHORT_S);
    seen.view.foreseen_veh[1] = NULL;
    seen.share[0] = 0.0F;
    rollout.coming.near.error = (elmopp_account_error_t){.compared_s = 60U, .forecast = 0.0F, .mean = 1.0F};
    set_queues(0.0F, 2.0F, 0.0F);
    seen.arrivals_veh[1] = 0.4F;
    (void)ask_in(0U, 50U);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-4F, -(20.0F + (0.2F * 55.0F) + 16.0F), seen.score[0]);
}

/* Nobody comes on the first, as its row says; on the second every other second. */
static void test_an_approach_without_a_row_has_its_mean_on_the_account(void) {
    start();
    foresee(0.0F, 60U);
    seen.view.foreseen_veh[1] = NULL;
    for (uint32_t t = 0U; t < 200U; t++) {
        seen.arrivals_veh[1] = ((t % 2U) == 0U) ? 1.0F : 0.0F;
        (void)ask_in(0U, 50U);
    }
    const elmopp_account_error_t *error = &rollout.coming.near.error;
    TEST_ASSERT_TRUE(error->mean > 0.0F);
    TEST_ASSERT_EQUAL_FLOAT(error->mean, error->forecast);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, rollout.coming.near_weight);
}

/* --- who drives up to a green --- */

/* One waits on red; on green `veh` a second are foreseen for half a minute, as fast as they can go. Score of keeping
   the green for a second and then as the rule says. */
static float score_of_keeping(bool looks, uint16_t travel_s, float veh) {
    options = elmopp_rollout_defaults(travel_s);
    options.coming.weigh_skill = false;
    options.coming.row_weight = 1.0F;
    options.future.look = looks;
    options.hold_count = 1U;
    options.rule_count = 1U;
    start();
    foresee(veh, ELMOPP_ACCOUNT_PROBE_S);
    seen.share[1] = 0.0F;
    set_queues(0.0F, 1.0F, 0.0F);
    (void)ask_in(0U, 50U);
    return seen.score[0];
}

/* 15 vehicles flow through the green. A rule that sees queues alone leaves it for the one, and they wait for it to come
   back; he who waits for them waits for 44 s. */
static void test_the_rule_does_not_cut_a_platoon_that_flows_through_its_green(void) {
    const float kept = score_of_keeping(true, 8U, 0.5F);
    TEST_ASSERT_FLOAT_WITHIN(6.0F, -44.0F, kept);
    TEST_ASSERT_TRUE(score_of_keeping(false, 8U, 0.5F) < (kept - 40.0F));
}

static void test_where_nobody_is_seen_to_drive_the_rule_sees_queues_alone(void) {
    const float blind = score_of_keeping(false, 0U, 0.5F);
    const float score = score_of_keeping(true, 0U, 0.5F);
    TEST_ASSERT_EQUAL_MEMORY(&blind, &score, sizeof score);
}

/* Who comes in the mean comes in any case, and keeps no green. */
static void test_the_mean_keeps_no_green(void) {
    float score[2];
    for (uint32_t look = 0U; look < 2U; look++) {
        options = elmopp_rollout_defaults(8U);
        options.future.look = look != 0U;
        start();
        for (uint32_t t = 0U; t < 30U; t++) {
            seen.arrivals_veh[0] = (t < 20U) ? 0.4F : 0.0F;
            set_queues(0.0F, 1.0F, 0.0F);
            (void)ask_in(0U, 50U);
        }
        score[look] = seen.score[0];
    }
    TEST_ASSERT_TRUE(rollout.coming.expected_veh_per_s[0] > 0.1F);
    TEST_ASSERT_EQUAL_MEMORY(&score[0], &score[1], sizeof score[0]);
}

/* Two drive 3 s: not queued in seconds 1 and 2, then for the other 8. */
static void test_who_drives_is_queued_when_he_arrives(void) {
    options.sight = elmopp_sight_defaults(3U);
    options.coming.mean_weight = 0.0F;
    look_ten_seconds_ahead();
    set_queues(0.0F, 2.0F, 0.0F);
    seen.arrivals_veh[1] = 2.0F;
    (void)ask_in(0U, 50U);
    TEST_ASSERT_EQUAL_FLOAT(-(16.0F + 4.0F), seen.score[0]);
}

/* 0.5 come and 0.5 can go in each of ten seconds on green. Who is seen to drive passes; without a reach half a vehicle
   is left in each second for the next, as the simulator's traffic without one does it. */
static void test_without_a_reach_who_comes_goes_a_second_later(void) {
    options.coming.weigh_skill = false;
    options.coming.row_weight = 1.0F;
    look_ten_seconds_ahead();
    foresee(0.5F, SHORT_S);
    seen.share[1] = 0.0F;
    set_queues(0.0F, 2.0F, 0.0F);
    (void)ask_in(0U, 50U);
    TEST_ASSERT_EQUAL_FLOAT(-(20.0F + 4.0F + 5.0F + 0.25F), seen.score[0]);
    options.sight = elmopp_sight_defaults(1U);
    chooser = elmopp_rollout_init(&rollout, &options);
    (void)ask_in(0U, 50U);
    TEST_ASSERT_EQUAL_FLOAT(-(20.0F + 4.0F), seen.score[0]);
}

/* 2 vehicles on red at flow 1 are gone after two seconds of green: 2 queue-seconds. */
static void test_what_is_left_costs_what_it_takes_to_clear_it(void) {
    junction.movement[1].saturation_veh_per_s = 1.0F;
    look_ten_seconds_ahead();
    set_queues(0.0F, 2.0F, 0.0F);
    (void)ask_in(0U, 50U);
    TEST_ASSERT_EQUAL_FLOAT(-(20.0F + 2.0F), seen.score[0]);
    junction.movement[1].saturation_veh_per_s = 0.0F;
    start();
    set_queues(0.0F, 2.0F, 0.0F);
    (void)ask_in(0U, 50U);
    TEST_ASSERT_EQUAL_FLOAT(-20.0F, seen.score[0]);
}

/* A queue of 1.5 teaches no flow; blocked it shrinks by 0.25 a second: 1.25, 1, 0.75, 0.5, 0.25. */
static void test_a_blocked_queue_is_taken_to_leave_half_as_fast(void) {
    look_ten_seconds_ahead();
    set_queues(1.5F, 2.0F, 0.0F);
    for (uint32_t elapsed_ds = 10U; elapsed_ds < 110U; elapsed_ds += 10U) {
        (void)ask_in(0U, elapsed_ds);
    }
    TEST_ASSERT_EQUAL_FLOAT(-(1.5F + 20.0F + 4.0F), seen.score[0]); /* not yet */
    (void)ask_in(0U, 110U);
    TEST_ASSERT_EQUAL_FLOAT(-(3.75F + 20.0F + 4.0F), seen.score[0]);
}

/* k 10 (1 - k) with k = Q / 10 at most 1/2: 8 vehicles, 5.5, 3, then by the parabola. */
static void test_the_law_of_the_profile_empties_the_modelled_queue(void) {
    junction.discharge = (uint8_t)ELMOPP_DISCHARGE_NOLOCK;
    junction.free_flow_m_per_s = 10.0F;
    look_ten_seconds_ahead();
    set_queues(8.0F, 2.0F, 0.0F);
    (void)ask_in(0U, 50U);
    float queue_veh = 8.0F;
    float sum = 0.0F;
    for (uint32_t k = 0U; k < SHORT_S; k++) {
        const float load = (queue_veh > 5.0F) ? 0.5F : (queue_veh / 10.0F);
        queue_veh -= load * 10.0F * (1.0F - load);
        sum += queue_veh;
    }
    sum += ((queue_veh * queue_veh) + 4.0F) / (2.0F * 2.5F);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-4F, -(sum + 20.0F), seen.score[0]);
}

static void test_at_max_it_leaves_if_somebody_asks(void) {
    set_queues(90.0F, 0.5F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 599U));
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 600U));
    TEST_ASSERT_EQUAL_FLOAT(0.0F, seen.score[0]);
    set_queues(90.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 600U));
}

static void test_among_equals_the_lowest_index_wins(void) {
    start_with_stages(3U);
    set_queues(0.0F, 4.0F, 4.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 100U));
    TEST_ASSERT_EQUAL_FLOAT(seen.score[1], seen.score[2]);
    set_queues(4.0F, 4.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(2U, 100U));
}

/* One vehicle of the last movement has waited `waited_s`; then many want the second one's stage, as the costs say. */
static elmopp_stage_t ask_with_one_waiting(uint32_t waited_s) {
    start_with_stages(3U);
    set_queues(90.0F, 0.0F, 1.0F);
    for (uint32_t t = 1U; t < waited_s; t++) {
        (void)ask_in(0U, 10U);
    }
    set_queues(0.0F, 9.0F, 1.0F);
    const elmopp_stage_t wanted = ask_in(0U, 300U);
    TEST_ASSERT_TRUE(seen.score[1] > seen.score[2]);
    return wanted;
}

static void test_who_has_waited_too_long_gets_the_next_change(void) {
    options.red_s = 20U;
    TEST_ASSERT_EQUAL_UINT8(1U, ask_with_one_waiting(19U));
    TEST_ASSERT_EQUAL_UINT8(2U, ask_with_one_waiting(20U));
    options.red_s = 0U;
    TEST_ASSERT_EQUAL_UINT8(1U, ask_with_one_waiting(200U));
}

/* What the stage of the last movement is worth more because one vehicle of it has waited so long. */
static float urge_after(uint32_t waited_s) {
    float score[2];
    for (uint32_t urges = 0U; urges < 2U; urges++) {
        options = elmopp_rollout_defaults(0U);
        options.patience_veh_s = (urges > 0U) ? options.patience_veh_s : 0.0F;
        start_with_stages(3U);
        set_queues(9.0F, 0.0F, 1.0F);
        for (uint32_t t = 0U; t < waited_s; t++) {
            (void)ask_in(0U, 50U);
        }
        score[urges] = seen.score[2];
    }
    return score[1] - score[0];
}

/* o (1 + o / 60) of o = 0, 1, 15 and 30 s beyond 40, at most 60. */
static void test_who_has_waited_long_makes_his_stage_worth_more(void) {
    TEST_ASSERT_EQUAL_FLOAT(0.0F, urge_after(40U));
    TEST_ASSERT_FLOAT_WITHIN(1.0e-2F, 61.0F / 60.0F, urge_after(41U));
    TEST_ASSERT_FLOAT_WITHIN(1.0e-2F, 18.75F, urge_after(55U));
    TEST_ASSERT_FLOAT_WITHIN(1.0e-2F, 45.0F, urge_after(70U));
    TEST_ASSERT_FLOAT_WITHIN(1.0e-2F, 60.0F, urge_after(90U));
    TEST_ASSERT_FLOAT_WITHIN(1.0e-2F, 60.0F, urge_after(110U));
}

/* For so many of 119 seconds the green of a queue that does not end is kept, while one vehicle waits elsewhere. */
static uint32_t kept_s(float urge_veh_s) {
    options = elmopp_rollout_defaults(0U);
    options.patience_veh_s = urge_veh_s;
    start_with_stages(2U);
    set_queues(1.0F, 1.0F, 0.0F);
    uint32_t kept = 0U;
    for (uint32_t t = 0U; t < 119U; t++) {
        seen.arrivals_veh[0] = 0.1F;
        kept += (ask_in(0U, 50U) == 0U) ? 1U : 0U;
    }
    return kept;
}

static void test_who_has_waited_long_ends_a_green_that_serves_a_few(void) {
    TEST_ASSERT_EQUAL_UINT32(119U, kept_s(0.0F));
    TEST_ASSERT_UINT32_WITHIN(5U, 52U, kept_s(60.0F));
}

/* A vehicle that has stood long where it has green, blocked, calls for no other stage that shows it green. */
static void test_who_is_blocked_on_green_urges_nobody(void) {
    float score[2];
    for (uint32_t urges = 0U; urges < 2U; urges++) {
        start_with_stages(3U);
        junction.stage_groups[2] = (uint16_t)(junction.stage_groups[0] | junction.stage_groups[2]);
        options.patience_veh_s = (urges > 0U) ? 60.0F : 0.0F;
        start();
        set_queues(2.0F, 1.0F, 0.0F);
        for (uint32_t t = 0U; t < 80U; t++) {
            (void)ask_in(0U, 50U);
        }
        TEST_ASSERT_TRUE(rollout.sight.red_s[0] > 60U);
        score[urges] = seen.score[2];
    }
    TEST_ASSERT_TRUE(score[0] < 0.0F);
    TEST_ASSERT_EQUAL_FLOAT(score[0], score[1]);
}

/* The queue that goes is so long that it is worth its green up to the maximum. */
static void test_who_has_waited_too_long_cuts_no_green_before_its_maximum(void) {
    options.red_s = 20U;
    start_with_stages(3U);
    set_queues(90.0F, 0.0F, 1.0F);
    seen.arrivals_veh[0] = 0.5F;
    for (uint32_t t = 1U; t < 100U; t++) {
        TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 590U));
    }
    set_queues(90.0F, 9.0F, 1.0F);
    TEST_ASSERT_EQUAL_UINT8(2U, ask_in(0U, 600U));
}

static void test_of_two_who_are_overdue_the_one_who_waits_longer_is_first(void) {
    options.red_s = 20U;
    start_with_stages(3U);
    set_queues(90.0F, 0.0F, 1.0F);
    (void)ask_in(0U, 300U);
    set_queues(90.0F, 9.0F, 1.0F);
    for (uint32_t t = 0U; t < 40U; t++) {
        (void)ask_in(0U, 10U);
    }
    TEST_ASSERT_EQUAL_UINT8(2U, ask_in(0U, 600U));
}

/* Of the stages of the last movement, overdue, the second one is the second movement's, too, and the third one that of
   the long queue that is green now. */
static elmopp_stage_t relief_of(float second_before_veh) {
    options.red_s = 20U;
    start_with_stages(3U);
    junction.stage_groups[1] = (uint16_t)(junction.stage_groups[1] | junction.stage_groups[2]);
    junction.stage_groups[2] = (uint16_t)(junction.stage_groups[0] | junction.stage_groups[2]);
    start();
    set_queues(90.0F, second_before_veh, 1.0F);
    for (uint32_t t = 0U; t < 18U; t++) {
        (void)ask_in(0U, 10U);
    }
    set_queues(90.0F, 1.0F, 1.0F);
    (void)ask_in(0U, 10U);
    return ask_in(0U, 600U);
}

static void test_who_is_overdue_takes_along_who_will_be_next(void) {
    TEST_ASSERT_EQUAL_UINT8(1U, relief_of(1.0F));
    TEST_ASSERT_EQUAL_UINT8(2U, relief_of(0.0F)); /* who has just come is not late, and the other stage is heavier */
}

static void test_who_is_overdue_and_blocked_does_not_hold_his_green(void) {
    options.red_s = 20U;
    start();
    set_queues(3.0F, 9.0F, 0.0F);
    for (uint32_t t = 0U; t < 60U; t++) {
        (void)ask_in(1U, 10U);
    }
    TEST_ASSERT_TRUE(rollout.sight.red_s[1] > 40U); /* green all the time, and nobody has left */
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(1U, 600U));
}

static void test_a_junction_of_one_stage_keeps_it(void) {
    junction.stage_count = 1U;
    start();
    set_queues(3.0F, 3.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 100U));
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 700U));
}

static void see_anything(uint64_t *random) {
    test_view_show_any(&seen, random);
    for (uint32_t j = 0U; j < junction.movement_count; j++) {
        seen.queue_veh[j] = test_view_any_count(random);
        seen.arrivals_veh[j] = test_view_any_count(random);
    }
}

static void ask_wildly(uint64_t seed, uint32_t decisions) {
    uint64_t random = seed;
    for (uint32_t t = 0U; t < decisions; t++) {
        see_anything(&random);
        (void)test_view_ask(&seen, &chooser); /* fails if there is no such stage */
        for (uint32_t s = 0U; s < ELMOPP_STAGE_MAX; s++) {
            if (!isfinite(seen.score[s]) || (seen.score[s] > options.patience_veh_s)) {
                TEST_FAIL_MESSAGE("a score is not finite, or worth more than patience");
            }
        }
    }
}

static void test_whatever_is_counted_it_names_a_stage_and_finite_scores(void) {
    for (uint32_t i = 0U; i < TEST_SITE_COUNT; i++) {
        junction = *test_sites[i];
        options = elmopp_rollout_defaults(ELMOPP_SIGHT_TRAVEL_MAX_S);
        start();
        ask_wildly(i, DECISIONS / 1000U);
        options.coming.horizon_s = 4U;
        start();
        ask_wildly(i, DECISIONS / TEST_SITE_COUNT);
    }
}

static void test_the_same_counts_give_the_same_answers_and_bits(void) {
    static elmopp_rollout_t other;
    uint64_t random = 7U;
    junction = elmopp_site_four_way;
    options.sight = elmopp_sight_defaults(8U);
    start();
    const elmopp_chooser_t again = elmopp_rollout_init(&other, &options);
    for (uint32_t t = 0U; t < 100U; t++) {
        see_anything(&random);
        (void)test_view_ask_both(&seen, &chooser, &again);
    }
}

/* Vehicles of a street; wilder counts hardly let two holds be the same future. */
static void see_a_few(uint64_t *random) {
    test_view_show(&seen, (elmopp_stage_t)random_below(random, junction.stage_count), 50U + random_below(random, 300U));
    for (uint32_t j = 0U; j < junction.movement_count; j++) {
        seen.queue_veh[j] = 0.5F * (float)random_below(random, 20U);
        seen.arrivals_veh[j] = 0.1F * (float)random_below(random, 6U);
    }
}

/* Each hold that is not played costs what the one before it cost: the best of three is the best of each alone. */
static void test_a_hold_that_is_not_played_would_have_cost_the_same(void) {
    static elmopp_rollout_t alone[ELMOPP_ROLLOUT_HOLD_MAX];
    elmopp_chooser_t single[ELMOPP_ROLLOUT_HOLD_MAX];
    uint64_t random = 11U;
    uint32_t compared = 0U;
    junction = elmopp_site_four_way;
    options.rule_count = 1U;
    start();
    for (uint32_t h = 0U; h < ELMOPP_ROLLOUT_HOLD_MAX; h++) {
        elmopp_rollout_options_t one = options;
        one.hold_count = 1U;
        one.hold_s[0] = options.hold_s[h];
        single[h] = elmopp_rollout_init(&alone[h], &one);
    }
    for (uint32_t t = 0U; t < 200U; t++) {
        see_a_few(&random);
        const elmopp_stage_t shown = seen.view.stage;
        float best = -INFINITY;
        for (uint32_t h = 0U; h < ELMOPP_ROLLOUT_HOLD_MAX; h++) {
            (void)test_view_ask(&seen, &single[h]);
            best = fmaxf(best, seen.score[shown]);
        }
        (void)test_view_ask(&seen, &chooser);
        TEST_ASSERT_EQUAL_MEMORY(&best, &seen.score[shown], sizeof best);
        compared += (best < 0.0F) ? 1U : 0U;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(150U, compared);
}

static void test_options_that_make_no_sense_are_a_bug(void) {
    const elmopp_rollout_options_t good = elmopp_rollout_defaults(8U);
    elmopp_rollout_options_t bad[19];
    for (uint32_t i = 0U; i < 19U; i++) {
        bad[i] = good;
    }
    bad[0].future.min_s = 0U;
    bad[1].future.max_s = 4U;
    bad[2].coming.horizon_s = 0U;
    bad[3].coming.horizon_s = ELMOPP_HORIZON_MAX + 1U;
    bad[4].hold_count = 0U;
    bad[5].rule_count = ELMOPP_ROLLOUT_RULE_MAX + 1U;
    bad[6].hold_s[2] = 0U;
    bad[7].ratio[1] = 0.9F;
    bad[8].coming.mean_weight = -0.1F;
    bad[9].coming.row_weight = 1.1F;
    bad[10].future.yellow_used_s = -1.0F;
    bad[11].sight.travel_s[3] = ELMOPP_SIGHT_TRAVEL_MAX_S + 1U;
    bad[12].others_max = 0U;
    bad[13].caution = -0.1F;
    bad[14].caution = 1.1F;
    bad[15].future.blocked_share = 1.1F;
    bad[16].future.stop_s = -0.1F;
    bad[17].patience_veh_s = -0.1F;
    bad[18].coming.fade_s = 0U;
    for (uint32_t i = 0U; i < 19U; i++) {
        TEST_EXPECT_ASSERT((void)elmopp_rollout_init(&rollout, &bad[i]));
    }
}

/* --- who gives way --- */

/* Movements 0 and 1 go in stage 0 and 0 gives way to 1; movement 2 goes in stage 1. Nobody comes. */
static void start_giving_way(bool heeded) {
    junction = test_cross(3U);
    junction.stage_groups[0] = 0x3U;
    junction.stage_groups[1] = 0x4U;
    junction.stage_count = 2U;
    junction.gives_way[0] = 0x2U;
    junction.movement[0].gives_way_percent = 100U;
    options.sight.gives_way = heeded;
    look_ten_seconds_ahead();
}

static float cost_of_staying(float first, float second, float third) {
    set_queues(first, second, third);
    (void)ask_in(0U, 100U);
    return -seen.score[0];
}

/* Movement 1 needs ten seconds for its 5 vehicles. In the last one half a vehicle of them is left, and half of a second
   is open: 0.2 of the three on movement 0 go at the follow-up time's 0.4. They cost 29.8 until then, and 2.8^2 / 1
   after it; the five 22.5; the four on red 40 and 16. */
static void test_who_gives_way_waits_for_the_queue_of_those_who_go_first(void) {
    start_giving_way(true);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-3F, 29.8F + 7.84F + 22.5F + 40.0F + 16.0F, cost_of_staying(3.0F, 5.0F, 4.0F));
}

/* Without it both go at once: 3 vehicles are gone after six seconds. */
static void test_a_model_that_does_not_heed_it_lets_both_go(void) {
    start_giving_way(false);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-3F, 7.5F + 22.5F + 40.0F + 16.0F, cost_of_staying(3.0F, 5.0F, 4.0F));
}

/* 0.4 a second instead of 0.5: 3 - 0.4 k until nobody is left in the eighth second. */
static void test_where_nobody_comes_they_follow_one_another_through_the_gap(void) {
    start_giving_way(true);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-3F, 9.8F + 40.0F + 16.0F, cost_of_staying(3.0F, 0.0F, 4.0F));
}

static float cost_of_coming(uint8_t percent) {
    start_giving_way(true);
    junction.movement[0].gives_way_percent = percent;
    start();
    set_queues(3.0F, 5.0F, 0.0F);
    (void)ask_in(1U, 100U);
    return -seen.score[0];
}

/* Six seconds of intergreen and two of start-up leave two of green: the five become four and cost 40 + 8.5 + 16. The
   three stand behind the first one who gives way, 30 + 9, or, where one in four does, all in front of him,
   24 + 4.5 + 4. */
static void test_of_a_shared_lane_those_go_who_stand_before_the_first_who_gives_way(void) {
    TEST_ASSERT_FLOAT_WITHIN(1.0e-3F, 64.5F + 39.0F, cost_of_coming(100U));
    TEST_ASSERT_FLOAT_WITHIN(1.0e-3F, 64.5F + 32.5F, cost_of_coming(25U));
}

/* Whole decisions, learning and all: a site that says nothing has the answers and the scores of one whose word is not
   heeded, to the bit. */
static void test_a_right_of_way_that_is_not_heeded_changes_no_bit(void) {
    static elmopp_rollout_t other;
    static elmopp_junction_t silent;
    test_view_t same;
    uint64_t random = 7U;
    options = elmopp_rollout_defaults(4U);
    start_giving_way(false);
    options = elmopp_rollout_defaults(4U);
    options.sight.gives_way = false;
    start();
    silent = junction;
    silent.gives_way[0] = 0U;
    silent.movement[0].gives_way_percent = 0U;
    const elmopp_rollout_options_t usual = elmopp_rollout_defaults(4U);
    const elmopp_chooser_t quiet = elmopp_rollout_init(&other, &usual);
    test_view_init(&same, &silent);
    for (uint32_t t = 0U; t < 400U; t++) {
        for (uint32_t j = 0U; j < 3U; j++) {
            seen.arrivals_veh[j] = (float)(random_below(&random, 2U));
            seen.queue_veh[j] = (float)(random_below(&random, 12U));
            same.arrivals_veh[j] = seen.arrivals_veh[j];
            same.queue_veh[j] = seen.queue_veh[j];
        }
        test_view_show(&seen, 0U, 10U * (t % 70U));
        test_view_show(&same, 0U, 10U * (t % 70U));
        TEST_ASSERT_EQUAL_UINT8(test_view_ask(&same, &quiet), test_view_ask(&seen, &chooser));
        TEST_ASSERT_EQUAL_MEMORY(same.score, seen.score, sizeof seen.score);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_defaults_are_those_that_were_measured);
    RUN_TEST(test_it_asks_for_the_forecast_that_its_horizon_needs);
    RUN_TEST(test_the_first_stage_is_that_of_most_vehicles_times_flow);
    RUN_TEST(test_in_the_intergreen_it_sees_arrivals_and_keeps_the_target);
    RUN_TEST(test_a_stage_is_never_left_before_min);
    RUN_TEST(test_green_rests_where_nobody_waits_on_red);
    RUN_TEST(test_a_dead_green_is_left);
    RUN_TEST(test_a_queue_that_empties_soon_is_served_first);
    RUN_TEST(test_the_price_of_a_change_decides);
    RUN_TEST(test_a_score_is_minus_the_sum_of_all_queues);
    RUN_TEST(test_who_starts_from_a_queue_has_lost_a_stop);
    RUN_TEST(test_a_stage_that_nobody_asks_for_is_not_tried);
    RUN_TEST(test_the_heaviest_others_are_tried_first);
    RUN_TEST(test_a_change_must_pay_whatever_is_done_after_it);
    RUN_TEST(test_rows_are_taken_at_a_fixed_weight);
    RUN_TEST(test_rows_correct_the_mean_by_their_skill);
    RUN_TEST(test_each_row_has_the_skill_of_the_nearer_account);
    RUN_TEST(test_rows_that_come_true_count_in_full);
    RUN_TEST(test_rows_count_by_what_they_have_been_better_than_the_mean);
    RUN_TEST(test_rows_that_are_no_better_than_the_mean_count_for_nothing);
    RUN_TEST(test_skill_is_known_after_a_minute_of_comparing);
    RUN_TEST(test_rows_are_read_as_far_as_asked);
    RUN_TEST(test_rows_have_faded_after_a_minute);
    RUN_TEST(test_a_fixed_weight_is_not_earned);
    RUN_TEST(test_a_row_that_is_no_number_is_nobody);
    RUN_TEST(test_without_rows_the_mean_of_the_arrivals_counts_half);
    RUN_TEST(test_an_approach_without_a_row_is_expected_by_its_mean);
    RUN_TEST(test_an_approach_without_a_row_has_its_mean_on_the_account);
    RUN_TEST(test_the_rule_does_not_cut_a_platoon_that_flows_through_its_green);
    RUN_TEST(test_where_nobody_is_seen_to_drive_the_rule_sees_queues_alone);
    RUN_TEST(test_the_mean_keeps_no_green);
    RUN_TEST(test_who_drives_is_queued_when_he_arrives);
    RUN_TEST(test_without_a_reach_who_comes_goes_a_second_later);
    RUN_TEST(test_what_is_left_costs_what_it_takes_to_clear_it);
    RUN_TEST(test_a_blocked_queue_is_taken_to_leave_half_as_fast);
    RUN_TEST(test_the_law_of_the_profile_empties_the_modelled_queue);
    RUN_TEST(test_at_max_it_leaves_if_somebody_asks);
    RUN_TEST(test_among_equals_the_lowest_index_wins);
    RUN_TEST(test_who_has_waited_too_long_gets_the_next_change);
    RUN_TEST(test_who_has_waited_long_makes_his_stage_worth_more);
    RUN_TEST(test_who_has_waited_long_ends_a_green_that_serves_a_few);
    RUN_TEST(test_who_is_blocked_on_green_urges_nobody);
    RUN_TEST(test_who_has_waited_too_long_cuts_no_green_before_its_maximum);
    RUN_TEST(test_of_two_who_are_overdue_the_one_who_waits_longer_is_first);
    RUN_TEST(test_who_is_overdue_takes_along_who_will_be_next);
    RUN_TEST(test_who_is_overdue_and_blocked_does_not_hold_his_green);
    RUN_TEST(test_a_junction_of_one_stage_keeps_it);
    RUN_TEST(test_whatever_is_counted_it_names_a_stage_and_finite_scores);
    RUN_TEST(test_a_hold_that_is_not_played_would_have_cost_the_same);
    RUN_TEST(test_the_same_counts_give_the_same_answers_and_bits);
    RUN_TEST(test_options_that_make_no_sense_are_a_bug);
    RUN_TEST(test_who_gives_way_waits_for_the_queue_of_those_who_go_first);
    RUN_TEST(test_a_model_that_does_not_heed_it_lets_both_go);
    RUN_TEST(test_where_nobody_comes_they_follow_one_another_through_the_gap);
    RUN_TEST(test_of_a_shared_lane_those_go_who_stand_before_the_first_who_gives_way);
    RUN_TEST(test_a_right_of_way_that_is_not_heeded_changes_no_bit);
    return UNITY_END();
}
