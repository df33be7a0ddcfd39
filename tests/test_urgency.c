/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/urgency.h"
#include "sites.h"
#include "unity.h"
#include "view.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define GOLDEN 1.0e-6
#define MIN_S 10U
#define MAX_S 60U
#define STAGES 4U

/* Four stages of one movement each; capacity 10, so a queue of 1 is a load of 0.1. */
static elmopp_junction_t junction;
static elmopp_urgency_t urgency;
static elmopp_urgency_options_t options;
static elmopp_chooser_t chooser;
static test_view_t seen;

void setUp(void) {
    junction = test_cross(STAGES);
    (void)memset(&urgency, 0xA5, sizeof urgency);
    options = (elmopp_urgency_options_t){.min_s = MIN_S, .max_s = MAX_S, .hysteresis = 1.0F};
    chooser = elmopp_urgency_init(&urgency, &options);
    test_view_init(&seen, &junction);
}
void tearDown(void) {}

static void restart(void) {
    chooser = elmopp_urgency_init(&urgency, &options);
}

static void within(double right, float value) {
    TEST_ASSERT_DOUBLE_WITHIN(GOLDEN * fabs(right), right, (double)value);
}

static void set_queues(float first, float second, float third, float fourth) {
    const float queue_veh[STAGES] = {first, second, third, fourth};
    (void)memcpy(seen.queue_veh, queue_veh, sizeof queue_veh);
}

static elmopp_stage_t ask(void) {
    return test_view_ask(&seen, &chooser);
}

static elmopp_stage_t ask_in(elmopp_stage_t stage, uint32_t elapsed_ds) {
    test_view_show(&seen, stage, elapsed_ds);
    return ask();
}

/* --- the equations --- */

static void test_naive_golden_values(void) {
    within(0.0735758882, elmopp_urgency_naive(&urgency, 0.2F, 0U));
    within(0.2, elmopp_urgency_naive(&urgency, 0.2F, 600U));
    within(0.5436563657, elmopp_urgency_naive(&urgency, 0.2F, 1200U));
    within(0.3032653299, elmopp_urgency_naive(&urgency, 0.5F, 300U));
}

static void test_naive_with_the_printed_sign_falls_with_time(void) {
    options.printed_sign = true;
    restart();
    within(0.2 * exp(1.0), elmopp_urgency_naive(&urgency, 0.2F, 0U));
    within(0.2, elmopp_urgency_naive(&urgency, 0.2F, 600U));
    within(0.2 * exp(-1.0), elmopp_urgency_naive(&urgency, 0.2F, 1200U));
}

static void test_naive_counts_tenths_of_seconds(void) {
    within(0.2 * exp((0.1 / 60.0) - 1.0), elmopp_urgency_naive(&urgency, 0.2F, 1U));
}

/* A float near 64 has steps of 4e-6, which become the relative error of its power. */
static void within_rounding_of_a_large_exponent(double right, float value) {
    TEST_ASSERT_DOUBLE_WITHIN(1.0e-5 * right, right, (double)value);
}

/* A lane whose load is 1 whatever comes. */
static elmopp_urgency_lane_t full_lane(bool going) {
    return (elmopp_urgency_lane_t){.queue_veh = 1.0F, .capacity_veh = 1.0F, .going = going};
}

static void test_kernel_of_t_max_4_sums_to_one_and_a_quarter(void) {
    options.min_s = 1U;
    options.max_s = 4U;
    restart();
    const elmopp_urgency_lane_t green = full_lane(true);
    within(1.25 * exp(-1.0), elmopp_urgency_cumulative(&urgency, &green));
}

static void test_kernel_of_every_t_max_sums_to_one_and_its_reciprocal(void) {
    for (uint16_t max_s = 1U; max_s <= ELMOPP_HORIZON_MAX; max_s++) {
        options.min_s = 1U;
        options.max_s = max_s;
        restart();
        const elmopp_urgency_lane_t green = full_lane(true);
        const double right = (1.0 + (1.0 / (double)max_s)) * exp(-1.0);
        TEST_ASSERT_DOUBLE_WITHIN(5.0e-6 * right, right, (double)elmopp_urgency_cumulative(&urgency, &green));
    }
}

/* The load steps from 0 to 1 with the one vehicle of step i, so what is left is k_i + k_(i+1) + ... */
static void test_kernel_of_t_max_4_is_half_three_eighths_quarter_eighth_zero(void) {
    static const double tail[5] = {0.75, 0.375, 0.125, 0.0, 0.0};
    options.min_s = 1U;
    options.max_s = 4U;
    restart();
    for (uint32_t i = 0U; i < 5U; i++) {
        float foreseen_veh[5] = {0.0F};
        foreseen_veh[i] = 1.0F;
        const elmopp_urgency_lane_t lane = {
            .capacity_veh = 1.0F, .foreseen_veh = foreseen_veh, .steps = 5U, .share = 1.0F, .going = true};
        TEST_ASSERT_DOUBLE_WITHIN(1.0e-6, tail[i] * exp(-1.0), (double)elmopp_urgency_cumulative(&urgency, &lane));
    }
}

static elmopp_urgency_lane_t golden_lane(void) {
    return (elmopp_urgency_lane_t){.queue_veh = 2.0F, .capacity_veh = 10.0F, .red_ds = 100U};
}

static void test_cumulative_golden_values(void) {
    const elmopp_urgency_lane_t lane = golden_lane();
    within(0.12630332, elmopp_urgency_cumulative(&urgency, &lane));
    options.constant_age = true;
    restart();
    within(0.08836830, elmopp_urgency_cumulative(&urgency, &lane));
    options.printed_sign = true;
    restart();
    within(0.46786510, elmopp_urgency_cumulative(&urgency, &lane));
}

static void test_a_green_lane_does_not_age(void) {
    elmopp_urgency_lane_t lane = golden_lane();
    lane.going = true;
    within(0.08836830, elmopp_urgency_cumulative(&urgency, &lane));
}

/* The sum of the header in double. */
static double cumulative(const elmopp_urgency_lane_t *lane) {
    const double max_s = (double)options.max_s;
    const double sign = options.printed_sign ? -1.0 : 1.0;
    double inflow = 0.0;
    double sum = 0.0;
    for (uint32_t t = 0U; t <= options.max_s; t++) {
        if ((t >= 1U) && (t <= lane->steps)) {
            inflow += (double)lane->share * (double)lane->foreseen_veh[t - 1U];
        }
        const double kernel = 2.0 * ((1.0 / max_s) - ((double)t / (max_s * max_s)));
        const double load =
            fmin((double)lane->queue_veh + inflow, (double)lane->capacity_veh) / (double)lane->capacity_veh;
        const double grown = (lane->going || options.constant_age) ? 0.0 : (double)t;
        const double age_s = ((double)lane->red_ds / 10.0) + grown;
        sum += kernel * load * exp(sign * ((age_s / max_s) - 1.0));
    }
    return sum;
}

static void check_cumulative(void) {
    float foreseen_veh[ELMOPP_HORIZON_MAX];
    for (uint32_t t = 0U; t < ELMOPP_HORIZON_MAX; t++) {
        foreseen_veh[t] = 0.05F * (float)((t * 7U) % 11U);
    }
    restart();
    for (uint16_t steps = 0U; steps <= ELMOPP_HORIZON_MAX; steps = (uint16_t)(steps + 29U)) {
        for (uint16_t red_ds = 0U; red_ds <= 2000U; red_ds = (uint16_t)(red_ds + 333U)) {
            const elmopp_urgency_lane_t lane = {.queue_veh = 1.5F,
                                                .capacity_veh = 12.0F,
                                                .foreseen_veh = (steps > 0U) ? foreseen_veh : NULL,
                                                .steps = steps,
                                                .share = 0.7F,
                                                .red_ds = red_ds,
                                                .going = (red_ds % 2U) == 0U};
            const double right = cumulative(&lane);
            TEST_ASSERT_DOUBLE_WITHIN(5.0e-6 * right, right, (double)elmopp_urgency_cumulative(&urgency, &lane));
        }
    }
}

static void test_cumulative_is_the_sum_of_the_header(void) {
    for (uint32_t variant = 0U; variant < 4U; variant++) {
        options.constant_age = (variant & 1U) != 0U;
        options.printed_sign = (variant & 2U) != 0U;
        options.max_s = 60U;
        check_cumulative();
        options.max_s = ELMOPP_HORIZON_MAX;
        check_cumulative();
    }
}

static void test_the_load_in_the_sum_ends_at_a_full_lane(void) {
    static const float flood_veh[MAX_S] = {100.0F, 100.0F};
    elmopp_urgency_lane_t lane = {.capacity_veh = 10.0F, .queue_veh = 10.0F, .red_ds = 100U};
    const float full = elmopp_urgency_cumulative(&urgency, &lane);
    lane.queue_veh = 25.0F;
    TEST_ASSERT_EQUAL_FLOAT(full, elmopp_urgency_cumulative(&urgency, &lane));
    lane.queue_veh = 10.0F;
    lane.foreseen_veh = flood_veh;
    lane.steps = MAX_S;
    lane.share = 1.0F;
    TEST_ASSERT_EQUAL_FLOAT(full, elmopp_urgency_cumulative(&urgency, &lane));
}

static void test_no_capacity_is_no_urgency(void) {
    const elmopp_urgency_lane_t lane = {.queue_veh = 5.0F, .capacity_veh = 0.0F, .red_ds = 100U};
    TEST_ASSERT_EQUAL_FLOAT(0.0F, elmopp_urgency_cumulative(&urgency, &lane));
}

static void test_nothing_overflows_after_hours_of_red(void) {
    for (uint16_t max_s = 1U; max_s <= ELMOPP_HORIZON_MAX; max_s++) {
        for (uint32_t sign = 0U; sign < 2U; sign++) {
            options.min_s = 1U;
            options.max_s = max_s;
            options.printed_sign = sign == 1U;
            restart();
            elmopp_urgency_lane_t lane = full_lane(false);
            lane.red_ds = UINT16_MAX;
            const float now = elmopp_urgency_naive(&urgency, 1.0F, UINT16_MAX);
            const float sum = elmopp_urgency_cumulative(&urgency, &lane);
            TEST_ASSERT_TRUE(isfinite((float)ELMOPP_MOVEMENT_MAX * now) && (now > 0.0F));
            TEST_ASSERT_TRUE(isfinite((float)ELMOPP_MOVEMENT_MAX * sum) && (sum > 0.0F));
        }
    }
}

static void test_the_exponent_ends_at_64_and_not_before(void) {
    options.min_s = 1U;
    options.max_s = 1U;
    restart();
    const double top = exp(64.0);
    within_rounding_of_a_large_exponent(top * exp(-0.1), elmopp_urgency_naive(&urgency, 1.0F, 649U));
    within_rounding_of_a_large_exponent(top, elmopp_urgency_naive(&urgency, 1.0F, 650U));
    within_rounding_of_a_large_exponent(top, elmopp_urgency_naive(&urgency, 1.0F, 651U));
    within_rounding_of_a_large_exponent(top, elmopp_urgency_naive(&urgency, 1.0F, UINT16_MAX));
}

static void test_horizon_is_the_part_of_the_window_that_the_kernel_weighs(void) {
    TEST_ASSERT_EQUAL_UINT16(0U, chooser.horizon_s);
    options.cumulative = true;
    restart();
    TEST_ASSERT_EQUAL_UINT16(MAX_S - 1U, chooser.horizon_s);
    options.min_s = 1U;
    options.max_s = 1U;
    restart();
    TEST_ASSERT_EQUAL_UINT16(0U, chooser.horizon_s);
}

/* --- scores --- */

static void test_a_stage_scores_the_sum_over_its_movements(void) {
    test_view_init(&seen, &elmopp_site_paper);
    double right[8] = {0.0};
    for (uint32_t j = 0U; j < 12U; j++) {
        seen.queue_veh[j] = 10.0F * (float)(j + 1U);
        seen.red_ds[j] = (uint16_t)(50U * j);
        const double u = (10.0 * (j + 1.0) / (1000.0 / 3.0)) * exp((5.0 * j / 60.0) - 1.0);
        for (uint32_t s = 0U; s < 8U; s++) {
            right[s] += (((uint32_t)elmopp_site_paper.stage_groups[s] >> j) & 1U) * u;
        }
    }
    (void)ask();
    for (uint32_t s = 0U; s < 8U; s++) {
        within(right[s], seen.score[s]);
    }
}

/* Odd movements come from an approach of which `second_veh` is foreseen; null: nothing. */
static void expect_cumulative_scores(const float *first_veh, const float *second_veh) {
    seen.view.foreseen_veh[1] = second_veh;
    (void)ask();
    for (uint32_t j = 0U; j < STAGES; j++) {
        const bool even = (j % 2U) == 0U;
        const elmopp_urgency_lane_t lane = {.queue_veh = seen.queue_veh[j],
                                            .capacity_veh = 10.0F,
                                            .foreseen_veh = even ? first_veh : second_veh,
                                            .steps = (even || (second_veh != NULL)) ? (MAX_S - 1U) : 0U,
                                            .share = seen.share[j],
                                            .red_ds = seen.red_ds[j],
                                            .going = j == 1U};
        const double right = cumulative(&lane);
        TEST_ASSERT_DOUBLE_WITHIN(5.0e-6 * right, right, (double)seen.score[j]);
    }
}

static void test_cumulative_scores_use_share_forecast_and_the_going_mask(void) {
    float first_veh[ELMOPP_HORIZON_MAX];
    float second_veh[ELMOPP_HORIZON_MAX];
    for (uint32_t t = 0U; t < ELMOPP_HORIZON_MAX; t++) {
        first_veh[t] = 0.1F;
        second_veh[t] = 0.2F;
    }
    options.cumulative = true;
    restart();
    junction.approach_count = 2U;
    junction.movement[2].approach = 0U;
    junction.movement[3].approach = 1U;
    set_queues(1.0F, 2.0F, 3.0F, 4.0F);
    seen.view.foreseen_veh[0] = first_veh;
    seen.view.foreseen_steps = MAX_S - 1U;
    test_view_show(&seen, 1U, 20U);
    for (uint32_t j = 0U; j < STAGES; j++) {
        seen.red_ds[j] = (uint16_t)(100U * (j + 1U));
        seen.share[j] = 0.25F * (float)j;
    }
    expect_cumulative_scores(first_veh, second_veh);
    expect_cumulative_scores(first_veh, NULL);
}

static void test_stages_that_do_not_exist_score_zero(void) {
    set_queues(1.0F, 2.0F, 3.0F, 4.0F);
    for (uint32_t variant = 0U; variant < 4U; variant++) {
        options.cumulative = (variant & 1U) != 0U;
        options.stage_age = (variant & 2U) != 0U;
        junction.stage_groups[9] = 0x000FU;
        for (uint32_t count = 1U; count <= STAGES; count++) {
            junction.stage_count = (uint8_t)count;
            restart();
            TEST_ASSERT_EQUAL_UINT8(count - 1U, ask());
            for (uint32_t s = 0U; s < ELMOPP_STAGE_MAX; s++) {
                TEST_ASSERT_TRUE((s < count) ? (seen.score[s] > 0.0F) : (seen.score[s] == 0.0F));
            }
        }
    }
}

/* --- the decision --- */

static void test_the_first_decision_is_the_most_urgent_stage_at_once(void) {
    set_queues(1.0F, 3.0F, 2.0F, 3.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask());
}

static void test_the_first_decision_of_an_empty_junction_is_stage_0(void) {
    TEST_ASSERT_EQUAL_UINT8(0U, ask());
}

static void test_in_the_intergreen_the_target_stays(void) {
    set_queues(1.0F, 9.0F, 2.0F, 3.0F);
    test_view_clear_to(&seen, 3U);
    TEST_ASSERT_EQUAL_UINT8(3U, ask());
    TEST_ASSERT_TRUE(seen.score[1] > seen.score[3]);
    options.windowless = true;
    restart();
    TEST_ASSERT_EQUAL_UINT8(3U, ask());
}

static void test_a_stage_is_never_left_before_min(void) {
    set_queues(0.0F, 10.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 1U));
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, (10U * MIN_S) - 1U));
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 10U * MIN_S));
}

static void test_a_stage_is_always_left_at_max_for_the_best_other(void) {
    set_queues(10.0F, 0.0F, 2.0F, 1.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, (10U * MAX_S) - 1U));
    TEST_ASSERT_EQUAL_UINT8(2U, ask_in(0U, 10U * MAX_S));
    TEST_ASSERT_EQUAL_UINT8(2U, ask_in(0U, UINT16_MAX));
    set_queues(10.0F, 0.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 10U * MAX_S));
    set_queues(0.0F, 10.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(1U, 10U * MAX_S));
}

static void test_min_equal_to_max_leaves_just_then(void) {
    options.min_s = MAX_S;
    restart();
    set_queues(10.0F, 0.0F, 2.0F, 1.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, (10U * MAX_S) - 1U));
    TEST_ASSERT_EQUAL_UINT8(2U, ask_in(0U, 10U * MAX_S));
}

static void test_only_a_strictly_more_urgent_stage_takes_over(void) {
    set_queues(0.0F, 4.0F, 4.0F, 4.0F);
    TEST_ASSERT_EQUAL_UINT8(2U, ask_in(2U, 300U));
    seen.queue_veh[1] = nextafterf(4.0F, 5.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(2U, 300U));
    seen.queue_veh[1] = 4.0F;
    seen.queue_veh[3] = nextafterf(4.0F, 5.0F);
    TEST_ASSERT_EQUAL_UINT8(3U, ask_in(2U, 300U));
}

static void test_among_equals_the_lowest_index_wins(void) {
    set_queues(5.0F, 5.0F, 1.0F, 5.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(2U, 300U));
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 10U * MAX_S));
}

static void test_a_junction_of_one_stage_keeps_it(void) {
    junction = test_cross(1U);
    test_view_init(&seen, &junction);
    TEST_ASSERT_EQUAL_UINT8(0U, ask());
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 10U * MAX_S));
    options.windowless = true;
    restart();
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 10U * MAX_S));
}

static void test_hysteresis_asks_for_that_many_times_more(void) {
    options.hysteresis = 2.0F;
    restart();
    set_queues(2.0F, 0.0F, 4.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 300U));
    seen.queue_veh[2] = 4.001F;
    TEST_ASSERT_EQUAL_UINT8(2U, ask_in(0U, 300U));
    seen.queue_veh[2] = 3.0F;
    TEST_ASSERT_EQUAL_UINT8(2U, ask_in(0U, 10U * MAX_S));
}

/* Chosen with an urgency of 0.3/e; the rival then has to exceed that, whatever became of the active stage. */
static void test_frozen_compares_with_the_urgency_of_the_second_that_chose(void) {
    options.frozen = true;
    (void)memset(&urgency, 0, sizeof urgency); /* whatever was there before the init */
    restart();
    set_queues(3.0F, 1.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask());
    set_queues(0.0F, 3.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 300U));
    set_queues(9.0F, 3.1F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 300U));
}

static void test_frozen_takes_a_new_urgency_with_each_change(void) {
    options.frozen = true;
    restart();
    set_queues(1.0F, 0.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask());
    set_queues(0.0F, 5.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 300U));
    test_view_clear_to(&seen, 1U);
    set_queues(0.0F, 9.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask());
    set_queues(0.0F, 0.0F, 5.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(1U, 300U));
    set_queues(0.0F, 0.0F, 5.1F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(2U, ask_in(1U, 300U));
}

/* Stage 0 was chosen with 0.1/e, then a maximum green brings stage 2 up: its own urgency counts, not that of stage 0.
 */
static void choose_0_then_force_2(void) {
    options.frozen = true;
    restart();
    set_queues(1.0F, 0.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask());
    set_queues(1.0F, 0.0F, 4.0F, 0.0F);
}

static void expect_2_frozen_at_4_vehicles(void) {
    set_queues(0.0F, 4.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(2U, ask_in(2U, 300U));
    set_queues(0.0F, 4.1F, 9.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(2U, 300U));
}

static void test_frozen_takes_the_urgency_of_a_forced_stage_in_its_intergreen(void) {
    choose_0_then_force_2();
    test_view_clear_to(&seen, 2U);
    TEST_ASSERT_EQUAL_UINT8(2U, ask());
    set_queues(1.0F, 0.0F, 7.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(2U, ask());
    TEST_ASSERT_EQUAL_UINT8(2U, ask_in(2U, 10U));
    expect_2_frozen_at_4_vehicles();
}

static void test_frozen_takes_the_urgency_of_a_forced_stage_that_needed_no_intergreen(void) {
    choose_0_then_force_2();
    TEST_ASSERT_EQUAL_UINT8(2U, ask_in(2U, 10U));
    expect_2_frozen_at_4_vehicles();
}

/* The wish for stage 1 is overruled: stage 0 is still shown, and what was chosen long ago is not known any more. */
static void test_frozen_takes_the_urgency_of_a_stage_that_outlived_a_wish(void) {
    options.frozen = true;
    restart();
    set_queues(1.0F, 0.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask());
    set_queues(0.0F, 8.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 100U));
    set_queues(5.0F, 4.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 110U));
    set_queues(0.0F, 4.9F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 120U));
    set_queues(0.0F, 5.1F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 130U));
}

static void test_not_frozen_compares_with_now(void) {
    set_queues(3.0F, 1.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask());
    set_queues(0.0F, 0.5F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 300U));
}

static void test_windowless_takes_the_best_stage_of_every_second(void) {
    options.windowless = true;
    restart();
    set_queues(0.0F, 1.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 1U));
    set_queues(9.0F, 1.0F, 0.0F, 0.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 10U * MAX_S));
}

static void test_windowless_keeps_the_active_stage_while_it_ties(void) {
    options.windowless = true;
    restart();
    set_queues(2.0F, 1.0F, 2.0F, 2.0F);
    TEST_ASSERT_EQUAL_UINT8(2U, ask_in(2U, 10U));
    TEST_ASSERT_EQUAL_UINT8(3U, ask_in(3U, 10U));
    seen.queue_veh[0] = nextafterf(2.0F, 3.0F);
    TEST_ASSERT_EQUAL_UINT8(0U, ask_in(3U, 10U));
}

/* --- T per stage --- */

static void test_stage_age_counts_the_seconds_since_a_stage_was_active(void) {
    options.stage_age = true;
    restart();
    set_queues(6.0F, 2.0F, 2.0F, 2.0F);
    for (uint32_t j = 0U; j < STAGES; j++) {
        seen.red_ds[j] = 5000U;
    }
    TEST_ASSERT_EQUAL_UINT8(0U, ask());
    within(0.6 * exp(-1.0), seen.score[0]);
    within(0.2 * exp(-1.0), seen.score[1]);
    for (uint32_t second = 1U; second <= 9U; second++) {
        TEST_ASSERT_EQUAL_UINT8(0U, ask_in(0U, 10U * second));
        within(0.6 * exp(-1.0), seen.score[0]);
        within(0.2 * exp((second / 60.0) - 1.0), seen.score[1]);
    }
    set_queues(0.0F, 9.0F, 2.0F, 2.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask_in(0U, 100U));
    test_view_clear_to(&seen, 1U);
    set_queues(5.0F, 5.0F, 5.0F, 5.0F);
    TEST_ASSERT_EQUAL_UINT8(1U, ask());
    within(0.5 * exp((1.0 / 60.0) - 1.0), seen.score[0]);
    within(0.5 * exp(-1.0), seen.score[1]);
    within(0.5 * exp((11.0 / 60.0) - 1.0), seen.score[2]);
}

static void test_stage_age_differs_from_the_movements_where_stages_share_one(void) {
    test_view_init(&seen, &elmopp_site_paper);
    options.stage_age = true;
    restart();
    seen.queue_veh[0] = 100.0F;
    TEST_ASSERT_EQUAL_UINT8(0U, ask());
    (void)ask_in(0U, 10U);
    within(0.3 * exp(-1.0), seen.score[0]);
    within(0.3 * exp((1.0 / 60.0) - 1.0), seen.score[4]);
}

/* In the cumulative sum only the shown stage does not age. */
static void test_stage_age_of_the_shown_stage_stays_in_the_sum(void) {
    options.stage_age = true;
    options.cumulative = true;
    restart();
    set_queues(2.0F, 2.0F, 0.0F, 0.0F);
    (void)ask();
    (void)ask_in(0U, 10U);
    const elmopp_urgency_lane_t shown = {.queue_veh = 2.0F, .capacity_veh = 10.0F, .red_ds = 0U, .going = true};
    const elmopp_urgency_lane_t other = {.queue_veh = 2.0F, .capacity_veh = 10.0F, .red_ds = 10U};
    TEST_ASSERT_DOUBLE_WITHIN(1.0e-6, cumulative(&shown), (double)seen.score[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1.0e-6, cumulative(&other), (double)seen.score[1]);
}

static void test_stage_age_saturates(void) {
    options.stage_age = true;
    restart();
    set_queues(0.0F, 1.0F, 0.0F, 0.0F);
    urgency.stage_age_s[1] = 6553U;
    (void)ask_in(0U, 10U);
    within_rounding_of_a_large_exponent(0.1 * exp(64.0), seen.score[1]);
    urgency.stage_age_s[1] = UINT16_MAX - 1U;
    (void)ask_in(0U, 10U);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, urgency.stage_age_s[1]);
    (void)ask_in(0U, 10U);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, urgency.stage_age_s[1]);
    within_rounding_of_a_large_exponent(0.1 * exp(64.0), seen.score[1]);
}

static void test_stage_age_of_hours_is_not_cut_below_the_time_of_a_movement(void) {
    options.stage_age = true;
    options.max_s = ELMOPP_HORIZON_MAX;
    restart();
    set_queues(0.0F, 1.0F, 0.0F, 0.0F);
    urgency.stage_age_s[1] = 6553U;
    (void)ask_in(0U, 10U);
    within_rounding_of_a_large_exponent(0.1 * exp((6553.0 / 150.0) - 1.0), seen.score[1]);
    urgency.stage_age_s[1] = 6554U;
    (void)ask_in(0U, 10U);
    within_rounding_of_a_large_exponent(0.1 * exp((6553.5 / 150.0) - 1.0), seen.score[1]);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_naive_golden_values);
    RUN_TEST(test_naive_with_the_printed_sign_falls_with_time);
    RUN_TEST(test_naive_counts_tenths_of_seconds);
    RUN_TEST(test_kernel_of_t_max_4_sums_to_one_and_a_quarter);
    RUN_TEST(test_kernel_of_every_t_max_sums_to_one_and_its_reciprocal);
    RUN_TEST(test_kernel_of_t_max_4_is_half_three_eighths_quarter_eighth_zero);
    RUN_TEST(test_cumulative_golden_values);
    RUN_TEST(test_a_green_lane_does_not_age);
    RUN_TEST(test_cumulative_is_the_sum_of_the_header);
    RUN_TEST(test_the_load_in_the_sum_ends_at_a_full_lane);
    RUN_TEST(test_no_capacity_is_no_urgency);
    RUN_TEST(test_nothing_overflows_after_hours_of_red);
    RUN_TEST(test_the_exponent_ends_at_64_and_not_before);
    RUN_TEST(test_horizon_is_the_part_of_the_window_that_the_kernel_weighs);
    RUN_TEST(test_a_stage_scores_the_sum_over_its_movements);
    RUN_TEST(test_cumulative_scores_use_share_forecast_and_the_going_mask);
    RUN_TEST(test_stages_that_do_not_exist_score_zero);
    RUN_TEST(test_the_first_decision_is_the_most_urgent_stage_at_once);
    RUN_TEST(test_the_first_decision_of_an_empty_junction_is_stage_0);
    RUN_TEST(test_in_the_intergreen_the_target_stays);
    RUN_TEST(test_a_stage_is_never_left_before_min);
    RUN_TEST(test_a_stage_is_always_left_at_max_for_the_best_other);
    RUN_TEST(test_min_equal_to_max_leaves_just_then);
    RUN_TEST(test_only_a_strictly_more_urgent_stage_takes_over);
    RUN_TEST(test_among_equals_the_lowest_index_wins);
    RUN_TEST(test_a_junction_of_one_stage_keeps_it);
    RUN_TEST(test_hysteresis_asks_for_that_many_times_more);
    RUN_TEST(test_frozen_compares_with_the_urgency_of_the_second_that_chose);
    RUN_TEST(test_frozen_takes_a_new_urgency_with_each_change);
    RUN_TEST(test_frozen_takes_the_urgency_of_a_forced_stage_in_its_intergreen);
    RUN_TEST(test_frozen_takes_the_urgency_of_a_forced_stage_that_needed_no_intergreen);
    RUN_TEST(test_frozen_takes_the_urgency_of_a_stage_that_outlived_a_wish);
    RUN_TEST(test_not_frozen_compares_with_now);
    RUN_TEST(test_windowless_takes_the_best_stage_of_every_second);
    RUN_TEST(test_windowless_keeps_the_active_stage_while_it_ties);
    RUN_TEST(test_stage_age_counts_the_seconds_since_a_stage_was_active);
    RUN_TEST(test_stage_age_differs_from_the_movements_where_stages_share_one);
    RUN_TEST(test_stage_age_of_the_shown_stage_stays_in_the_sum);
    RUN_TEST(test_stage_age_saturates);
    RUN_TEST(test_stage_age_of_hours_is_not_cut_below_the_time_of_a_movement);
    return UNITY_END();
}
