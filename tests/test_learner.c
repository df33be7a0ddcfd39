/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The learner: that it learns, what its guard does, what a second costs at most, and how a forecast uses it.

#include "assert_catcher.h"
#include "elmopp/forecast.h"
#include "elmopp/learner.h"
#include "elmopp_weights.h"
#include "sites.h"
#include "unity.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define INPUTS ELMOPP_LSTM_INPUTS
#define WINDOW ELMOPP_TRAINER_WINDOW
#define CYCLE ELMOPP_LEARNER_CYCLE_S
#define LONG_S 700U ///< enough to be better than the shipped weights on waves

static elmopp_trainer_memory_t memory;
static elmopp_trainer_inner_memory_t inner;
static elmopp_learner_t learner;
static elmopp_lstm_f32_state_t shipped_memory[ELMOPP_LEARNER_GROUPS_MAX];
static uint32_t now_s;

static void begin(elmopp_learner_course_t course, uint32_t approaches) {
    now_s = 0U;
    (void)memset(shipped_memory, 0, sizeof shipped_memory);
    elmopp_learner_init(&learner, &memory, &inner, &elmopp_weights_lstm, course, approaches);
}

static float beside; /* what came is so much more than what the networks are fed */

void setUp(void) {
    beside = 0.0F;
    begin(ELMOPP_LEARNER_CAREFUL, 4U);
}
void tearDown(void) {}

/* Waves that the shipped network has never seen. */
static float wave(uint32_t approach) {
    const float turn = (float)now_s * 6.2831853F / (40.0F + (9.0F * (float)approach));
    return 1.0F + (0.8F * sinf(turn));
}

/* One second of waves for the learner alone. */
static void second_of_waves(void) {
    elmopp_learner_second_t second;
    (void)memset(&second, 0, sizeof second);
    for (uint32_t group = 0U; group < learner.groups; group++) {
        for (uint32_t k = 0U; k < learner.inputs[group]; k++) {
            second.input[group][k] = wave((group * INPUTS) + k);
            second.came[group][k] = second.input[group][k] + beside;
        }
        elmopp_lstm_f32_step(&elmopp_weights_lstm.lstm, &shipped_memory[group], second.input[group]);
    }
    elmopp_learner_see(&learner, &second);
    elmopp_learner_work(&learner, shipped_memory);
    now_s++;
}

static void seconds_of_waves(uint32_t seconds) {
    for (uint32_t t = 0U; t < seconds; t++) {
        second_of_waves();
    }
}

static void test_it_begins_as_the_shipped_network_and_unused(void) {
    elmopp_lstm_f32_weights_t copy;
    elmopp_learner_copy(&learner, &copy);
    TEST_ASSERT_EQUAL_MEMORY(&elmopp_weights_lstm.lstm, &copy, sizeof copy);
    TEST_ASSERT_FALSE(elmopp_learner_is_in_use(&learner));
    seconds_of_waves(WINDOW);
    TEST_ASSERT_EQUAL_MEMORY(&shipped_memory[0], &learner.memory[0], sizeof learner.memory[0]);
}

static void test_it_becomes_better_on_traffic_that_is_new_and_is_then_used(void) {
    seconds_of_waves(LONG_S);
    TEST_ASSERT_TRUE(learner.error.learnt < (0.9F * learner.error.shipped));
    TEST_ASSERT_TRUE(elmopp_learner_is_in_use(&learner));
    elmopp_lstm_f32_weights_t learnt;
    elmopp_lstm_f32_weights_t trained;
    elmopp_learner_copy(&learner, &learnt);
    elmopp_trainer_copy(&learner.trainer, &trained);
    TEST_ASSERT_EQUAL_MEMORY(&trained, &learnt, sizeof trained);
    TEST_ASSERT_TRUE(memcmp(&learnt, &elmopp_weights_lstm.lstm, sizeof learnt) != 0);
}

static void test_no_second_has_more_than_one_sample_or_one_update_or_one_comparison(void) {
    seconds_of_waves(WINDOW + 1U);
    uint32_t compared = 0U;
    for (uint32_t t = 0U; t < (5U * CYCLE); t++) {
        const uint32_t samples = learner.trainer.samples;
        const uint32_t updates = learner.trainer.updates;
        const uint32_t group = learner.compared_group;
        second_of_waves();
        const bool looked = learner.probe[((learner.due + ELMOPP_LEARNER_AHEAD_S) - 1U) % ELMOPP_LEARNER_AHEAD_S].said;
        const uint32_t done = ((learner.trainer.samples == (samples + 1U)) ? 1U : 0U) +
                              ((learner.trainer.updates == (updates + 1U)) ? 1U : 0U) + (looked ? 1U : 0U);
        TEST_ASSERT_EQUAL_UINT32(1U, done);
        TEST_ASSERT_EQUAL_UINT32(group, learner.compared_group); /* there is one group */
        compared += looked ? 1U : 0U;
    }
    TEST_ASSERT_EQUAL_UINT32(5U, compared);
    TEST_ASSERT_EQUAL_UINT32(5U, learner.trainer.updates);
}

/* What is compared is what the two networks say, against the second that it was said of. */
static void test_the_comparison_is_of_the_second_that_was_spoken_of(void) {
    while (learner.error.judged == 0U) {
        const elmopp_learner_probe_t due = learner.probe[learner.due];
        float squares = 0.0F;
        for (uint32_t k = 0U; k < INPUTS; k++) {
            const float error = due.shipped[k] - wave(k);
            squares += error * error;
        }
        second_of_waves();
        if (due.said) {
            TEST_ASSERT_EQUAL_UINT32(1U, learner.error.judged);
            TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, squares / 4.0F, learner.error.shipped);
        }
        TEST_ASSERT_TRUE(now_s < 200U);
    }
}

/* Within a thousand seconds the guard has it begin anew, with the shipped weights. */
static void expect_to_give_up(void) {
    const uint32_t from = now_s;
    while ((learner.given_up == 0U) && (now_s < (from + 1000U))) {
        second_of_waves();
    }
    TEST_ASSERT_EQUAL_UINT32(1U, learner.given_up);
    TEST_ASSERT_FALSE(elmopp_learner_is_in_use(&learner));
    elmopp_lstm_f32_weights_t trained;
    elmopp_trainer_copy(&learner.trainer, &trained);
    TEST_ASSERT_EQUAL_MEMORY(&elmopp_weights_lstm.lstm, &trained, sizeof trained);
}

/* Learnt weights that say nonsense are seen through, and learning begins anew. */
static void test_the_guard_returns_to_the_shipped_weights(void) {
    seconds_of_waves(LONG_S);
    TEST_ASSERT_TRUE(elmopp_learner_is_in_use(&learner));
    for (uint32_t k = 0U; k < INPUTS; k++) {
        memory.weight.head_bias[k] = 3.5F;
    }
    expect_to_give_up();
    TEST_ASSERT_EQUAL_MEMORY(&shipped_memory[0], &learner.memory[0], sizeof learner.memory[0]);
    TEST_ASSERT_EQUAL_UINT32(0U, learner.error.judged);
}

static void test_learnt_weights_are_left_as_soon_as_their_error_is_the_greater(void) {
    seconds_of_waves(LONG_S);
    learner.error.learnt = 1.01F * learner.error.shipped;
    learner.error.judged = 1000U;
    learner.probe[learner.due].said = true;
    learner.probe[learner.due].group = 0U;
    for (uint32_t k = 0U; k < INPUTS; k++) {
        learner.probe[learner.due].shipped[k] = wave(k) + 1.0F;
        learner.probe[learner.due].learnt[k] = wave(k) + 1.0F;
    }
    second_of_waves();
    TEST_ASSERT_FALSE(elmopp_learner_is_in_use(&learner));
    TEST_ASSERT_EQUAL_UINT32(0U, learner.given_up);
}

static void test_slopes_that_are_no_numbers_begin_anew(void) {
    seconds_of_waves(200U);
    memory.weight.outer.row[2][7] = NAN;
    seconds_of_waves(CYCLE);
    TEST_ASSERT_EQUAL_UINT32(1U, learner.given_up);
    seconds_of_waves(CYCLE);
    TEST_ASSERT_EQUAL_UINT32(1U, learner.given_up);
    TEST_ASSERT_TRUE(isfinite(memory.weight.outer.row[2][7]));
}

static void test_the_literal_course_steps_every_second_and_is_always_used(void) {
    begin(ELMOPP_LEARNER_LITERAL, 4U);
    TEST_ASSERT_TRUE(elmopp_learner_is_in_use(&learner));
    seconds_of_waves(2U);
    const uint32_t updates = learner.trainer.updates;
    seconds_of_waves(100U);
    TEST_ASSERT_EQUAL_UINT32(updates + 100U, learner.trainer.updates);
    TEST_ASSERT_TRUE(elmopp_learner_is_in_use(&learner));
}

static void test_two_groups_have_a_stretch_and_a_memory_each(void) {
    begin(ELMOPP_LEARNER_CAREFUL, 5U);
    TEST_ASSERT_EQUAL_UINT32(2U, learner.groups);
    TEST_ASSERT_EQUAL_UINT32(4U, learner.inputs[0]);
    TEST_ASSERT_EQUAL_UINT32(1U, learner.inputs[1]);
    seconds_of_waves(WINDOW + 1U);
    TEST_ASSERT_EQUAL_UINT32(2U, learner.count);
    TEST_ASSERT_EQUAL_UINT32(4U, learner.kept[0].inputs);
    TEST_ASSERT_EQUAL_UINT32(1U, learner.kept[1].inputs);
    TEST_ASSERT_TRUE(memcmp(&learner.memory[0], &learner.memory[1], sizeof learner.memory[0]) != 0);
    const uint32_t group = learner.compared_group;
    seconds_of_waves(CYCLE);
    TEST_ASSERT_EQUAL_UINT32(1U - group, learner.compared_group);
    begin(ELMOPP_LEARNER_CAREFUL, 8U);
    TEST_ASSERT_EQUAL_UINT32(4U, learner.inputs[1]);
    TEST_EXPECT_ASSERT(begin(ELMOPP_LEARNER_CAREFUL, 0U));
    TEST_EXPECT_ASSERT(begin(ELMOPP_LEARNER_CAREFUL, 9U));
}

/* A stretch begins with the state before its first second: from there the network says what it said then. */
static void test_a_stretch_can_be_run_again(void) {
    seconds_of_waves(WINDOW + 1U);
    elmopp_lstm_f32_state_t state = learner.kept[learner.newest].before;
    const elmopp_lstm_f32_state_t nothing = {{0.0F}, {{0.0F}}};
    TEST_ASSERT_EQUAL_MEMORY(&nothing, &state, sizeof state);
    for (uint32_t t = 0U; t <= WINDOW; t++) {
        elmopp_lstm_f32_step(&elmopp_weights_lstm.lstm, &state, learner.kept[learner.newest].seen[t]);
        if (t == (WINDOW - 1U)) {
            TEST_ASSERT_EQUAL_MEMORY(&learner.growing[0].before, &state, sizeof state);
        }
    }
    TEST_ASSERT_EQUAL_MEMORY(&learner.memory[0], &state, sizeof state);
    TEST_ASSERT_EQUAL_FLOAT(learner.kept[learner.newest].seen[WINDOW][2], learner.growing[0].seen[0][2]);
}

static void test_it_takes_the_memory_that_was_promised(void) {
    TEST_ASSERT_TRUE(sizeof(elmopp_learning_t) <= 46000U);
}

/* --- when it works, and what outlives it --- */

static void test_errors_are_of_what_came_and_not_of_what_is_fed(void) {
    seconds_of_waves(LONG_S);
    const elmopp_learner_error_t before = learner.error;
    beside = 3.0F;
    seconds_of_waves(LONG_S);
    TEST_ASSERT_TRUE(learner.error.shipped > (before.shipped + 1.0F));
    TEST_ASSERT_TRUE(learner.error.learnt > (before.learnt + 1.0F));
}

static void test_a_second_that_is_only_seen_is_not_learnt_from(void) {
    seconds_of_waves(WINDOW + 1U);
    const elmopp_learner_t before = learner;
    static elmopp_trainer_memory_t memory_before;
    memory_before = memory;
    elmopp_learner_second_t second;
    (void)memset(&second, 0, sizeof second);
    elmopp_learner_see(&learner, &second);
    TEST_ASSERT_EQUAL_MEMORY(&memory_before, &memory, sizeof memory);
    TEST_ASSERT_EQUAL_UINT32(before.second, learner.second);
    TEST_ASSERT_EQUAL_UINT32(before.trainer.samples, learner.trainer.samples);
    TEST_ASSERT_EQUAL_UINT32(before.grown + 1U, learner.grown);
}

/* Learns until it is better, and leaves what it learnt. */
static void learn_waves(elmopp_lstm_f32_weights_t *learnt) {
    seconds_of_waves(LONG_S);
    TEST_ASSERT_TRUE(elmopp_learner_is_in_use(&learner));
    elmopp_learner_copy(&learner, learnt);
}

static void test_what_was_learnt_goes_on_where_it_was_and_is_used_from_the_beginning(void) {
    elmopp_lstm_f32_weights_t learnt;
    elmopp_lstm_f32_weights_t again;
    learn_waves(&learnt);
    begin(ELMOPP_LEARNER_CAREFUL, 4U);
    elmopp_learner_resume(&learner, &learnt);
    TEST_ASSERT_TRUE(elmopp_learner_is_in_use(&learner));
    elmopp_learner_copy(&learner, &again);
    TEST_ASSERT_EQUAL_MEMORY(&learnt, &again, sizeof learnt);
    seconds_of_waves(WINDOW + (20U * CYCLE)); /* its first comparisons are in its favour */
    TEST_ASSERT_TRUE(learner.error.judged >= ELMOPP_LEARNER_JUDGED_MIN);
    TEST_ASSERT_TRUE(elmopp_learner_is_in_use(&learner));
    TEST_ASSERT_EQUAL_UINT32(0U, learner.given_up);
}

static void test_what_was_learnt_and_is_no_good_falls_back_to_the_shipped_weights(void) {
    elmopp_lstm_f32_weights_t bad = elmopp_weights_lstm.lstm;
    for (uint32_t k = 0U; k < INPUTS; k++) {
        bad.head_bias[k] = 3.5F;
    }
    elmopp_learner_resume(&learner, &bad);
    expect_to_give_up();
}

static void test_it_is_worth_keeping_when_it_is_surely_better_and_in_use(void) {
    TEST_ASSERT_FALSE(elmopp_learner_is_worth_keeping(&learner));
    seconds_of_waves(LONG_S);
    TEST_ASSERT_TRUE(elmopp_learner_is_worth_keeping(&learner));
    const elmopp_learner_error_t error = learner.error;
    learner.error.judged = ELMOPP_LEARNER_JUDGED_WINDOW - 1U;
    TEST_ASSERT_FALSE(elmopp_learner_is_worth_keeping(&learner));
    learner.error = error;
    learner.error.learnt = (ELMOPP_LEARNER_WORTH + 0.001F) * error.shipped;
    TEST_ASSERT_FALSE(elmopp_learner_is_worth_keeping(&learner));
    learner.error.learnt = NAN;
    TEST_ASSERT_FALSE(elmopp_learner_is_worth_keeping(&learner));
    learner.error = error;
    learner.in_use = false;
    TEST_ASSERT_FALSE(elmopp_learner_is_worth_keeping(&learner));
}

/* --- as a forecast has it --- */

static elmopp_junction_t junction;
static elmopp_forecast_t with;
static elmopp_forecast_t without;

static void start_forecasts(void) {
    static const float mean_veh[ELMOPP_APPROACH_MAX] = {0.3F, 0.3F, 0.3F, 0.3F, 0.3F, 0.3F, 0.3F, 0.3F};
    junction = elmopp_site_paper;
    elmopp_forecast_config_t config = {
        .kind = ELMOPP_FORECAST_LSTM, .mean_veh_per_s = mean_veh, .weights = &elmopp_weights_lstm};
    elmopp_forecast_init(&without, &junction, &config);
    config.learner = &learner;
    elmopp_forecast_init(&with, &junction, &config);
}

static void observe_waves(uint32_t seconds) {
    for (uint32_t t = 0U; t < seconds; t++) {
        float arrived_veh[ELMOPP_MOVEMENT_MAX];
        for (uint32_t j = 0U; j < junction.movement_count; j++) {
            arrived_veh[j] = 0.1F * wave(junction.movement[j].approach);
        }
        elmopp_forecast_observe(&with, arrived_veh);
        elmopp_forecast_learn(&with);
        elmopp_forecast_observe(&without, arrived_veh);
        elmopp_forecast_learn(&without);
        now_s++;
    }
}

static void test_a_forecast_that_learns_says_what_the_shipped_one_says_until_it_is_better(void) {
    start_forecasts();
    const float *learning[ELMOPP_APPROACH_MAX];
    const float *frozen[ELMOPP_APPROACH_MAX];
    observe_waves(100U);
    (void)elmopp_forecast_look(&with, 60U, learning);
    (void)elmopp_forecast_look(&without, 60U, frozen);
    for (uint32_t i = 0U; i < junction.approach_count; i++) {
        TEST_ASSERT_EQUAL_MEMORY(frozen[i], learning[i], 60U * sizeof(float));
    }
    observe_waves(LONG_S);
    TEST_ASSERT_TRUE(elmopp_learner_is_in_use(&learner));
    (void)elmopp_forecast_look(&with, 60U, learning);
    elmopp_lstm_f32_state_t state = learner.memory[0];
    const elmopp_lstm_f32_net_t net = elmopp_trainer_net(&learner.trainer);
    float said[INPUTS];
    elmopp_lstm_f32_net_output(&net, &state, said);
    for (uint32_t k = 0U; k < INPUTS; k++) {
        TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 0.3F * fmaxf(said[k], elmopp_weights_lstm.low[k]), learning[k][0]);
    }
}

/* The same weights somewhere else change nothing; others are begun with anew. */
static void test_a_forecast_that_gets_other_weights_learns_on_from_them(void) {
    static elmopp_weights_t same;
    static elmopp_weights_t other;
    elmopp_lstm_f32_weights_t before;
    elmopp_lstm_f32_weights_t after;
    same = elmopp_weights_lstm;
    other = elmopp_weights_lstm;
    other.lstm.head_bias[0] += 0.25F;
    start_forecasts();
    observe_waves(LONG_S);
    elmopp_learner_copy(&learner, &before);
    elmopp_forecast_rearm(&with, &same, false);
    elmopp_learner_copy(&learner, &after);
    TEST_ASSERT_TRUE(elmopp_forecast_is_learnt(&with));
    TEST_ASSERT_EQUAL_MEMORY(&before, &after, sizeof before);
    TEST_ASSERT_EQUAL_PTR(&same, learner.shipped);
    elmopp_forecast_rearm(&with, &other, true);
    TEST_ASSERT_EQUAL_PTR(&other, learner.shipped);
    TEST_ASSERT_FALSE(elmopp_forecast_is_learnt(&with));
    TEST_ASSERT_EQUAL_UINT32(4U, learner.inputs[0]);
    elmopp_trainer_copy(&learner.trainer, &after);
    TEST_ASSERT_EQUAL_MEMORY(&other.lstm, &after, sizeof after);
    observe_waves(LONG_S);
    TEST_ASSERT_TRUE(elmopp_forecast_is_learnt(&with));
}

static void test_a_forecast_with_a_learner_of_other_weights_is_a_bug(void) {
    start_forecasts();
    elmopp_forecast_config_t config = with.config;
    config.weights = &elmopp_weights_nlstm;
    TEST_EXPECT_ASSERT(elmopp_forecast_init(&with, &junction, &config));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_it_begins_as_the_shipped_network_and_unused);
    RUN_TEST(test_it_becomes_better_on_traffic_that_is_new_and_is_then_used);
    RUN_TEST(test_no_second_has_more_than_one_sample_or_one_update_or_one_comparison);
    RUN_TEST(test_the_comparison_is_of_the_second_that_was_spoken_of);
    RUN_TEST(test_the_guard_returns_to_the_shipped_weights);
    RUN_TEST(test_learnt_weights_are_left_as_soon_as_their_error_is_the_greater);
    RUN_TEST(test_slopes_that_are_no_numbers_begin_anew);
    RUN_TEST(test_the_literal_course_steps_every_second_and_is_always_used);
    RUN_TEST(test_two_groups_have_a_stretch_and_a_memory_each);
    RUN_TEST(test_a_stretch_can_be_run_again);
    RUN_TEST(test_it_takes_the_memory_that_was_promised);
    RUN_TEST(test_errors_are_of_what_came_and_not_of_what_is_fed);
    RUN_TEST(test_a_second_that_is_only_seen_is_not_learnt_from);
    RUN_TEST(test_what_was_learnt_goes_on_where_it_was_and_is_used_from_the_beginning);
    RUN_TEST(test_what_was_learnt_and_is_no_good_falls_back_to_the_shipped_weights);
    RUN_TEST(test_it_is_worth_keeping_when_it_is_surely_better_and_in_use);
    RUN_TEST(test_a_forecast_that_learns_says_what_the_shipped_one_says_until_it_is_better);
    RUN_TEST(test_a_forecast_that_gets_other_weights_learns_on_from_them);
    RUN_TEST(test_a_forecast_with_a_learner_of_other_weights_is_a_bug);
    return UNITY_END();
}
