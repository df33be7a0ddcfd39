/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/forecast.h"
#include "random.h"
#include "sites.h"
#include "unity.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define APPROACHES 2U
#define MOVEMENTS 3U
#define MEAN_WINDOW 900U
#define EWMA_WINDOW 120U

/* Movements 0 and 2 belong to approach 0, movement 1 to approach 1: an approach's movements need not be neighbours. */
static elmopp_junction_t junction;
static elmopp_forecast_t forecast;
static const float *rows[ELMOPP_APPROACH_MAX];

void setUp(void) {
    junction = test_cross(MOVEMENTS);
    junction.approach_count = APPROACHES;
    junction.movement[2].approach = 0U;
    (void)memset(&forecast, 0xA5, sizeof forecast);
}
void tearDown(void) {}

static void start(uint8_t kind, const elmopp_ar8_t *ar8, const float *mean_veh_per_s) {
    const elmopp_forecast_config_t config = {.kind = kind, .ar8 = ar8, .mean_veh_per_s = mean_veh_per_s};
    elmopp_forecast_init(&forecast, &junction, &config);
}

static void observe(float first_veh, float second_veh, float third_veh) {
    const float arrivals_veh[MOVEMENTS] = {first_veh, second_veh, third_veh};
    elmopp_forecast_observe(&forecast, arrivals_veh);
}

static void look(uint16_t steps) {
    TEST_ASSERT_EQUAL_UINT16(steps, elmopp_forecast_look(&forecast, steps, rows));
    for (uint32_t i = APPROACHES; i < ELMOPP_APPROACH_MAX; i++) {
        TEST_ASSERT_NULL(rows[i]);
    }
}

static void expect_flat(uint32_t approach, float value_veh, uint32_t steps) {
    for (uint32_t t = 0U; t < steps; t++) {
        TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, value_veh, rows[approach][t]);
    }
}

static void expect_everywhere(float first_veh, float second_veh) {
    look(ELMOPP_HORIZON_MAX);
    expect_flat(0U, first_veh, ELMOPP_HORIZON_MAX);
    expect_flat(1U, second_veh, ELMOPP_HORIZON_MAX);
}

/* Of a minute, the neighbour of the second approach knows 14 s. */
static uint16_t hear_the_second(uint16_t steps) {
    elmopp_outflow_t outflow[ELMOPP_APPROACH_MAX];
    (void)memset(outflow, 0, sizeof outflow);
    outflow[1] = (elmopp_outflow_t){.next10_veh = 1.0F, .next30_veh = 3.0F, .next60_veh = 3.0F, .ahead_s = 14U};
    return elmopp_forecast_hear(&forecast, outflow, 60U, steps, rows);
}

static void test_without_a_forecast_an_approach_whose_neighbour_is_silent_has_no_row(void) {
    start(ELMOPP_FORECAST_NONE, NULL, NULL);
    observe(1.0F, 1.0F, 1.0F);
    TEST_ASSERT_EQUAL_UINT16(60U, hear_the_second(elmopp_forecast_look(&forecast, 60U, rows)));
    TEST_ASSERT_NULL(rows[0]);
    expect_flat(1U, 0.1F, 10U);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, rows[1][14]);
}

static void test_with_a_forecast_an_approach_whose_neighbour_is_silent_keeps_its_row(void) {
    start(ELMOPP_FORECAST_PERSISTENCE, NULL, NULL);
    observe(1.0F, 2.0F, 0.5F);
    TEST_ASSERT_EQUAL_UINT16(30U, hear_the_second(elmopp_forecast_look(&forecast, 30U, rows)));
    expect_flat(0U, 1.5F, 30U);
    expect_flat(1U, 0.1F, 10U);
    TEST_ASSERT_EQUAL_FLOAT(2.0F, rows[1][14]);
}

static void test_none_gives_no_row(void) {
    start(ELMOPP_FORECAST_NONE, NULL, NULL);
    observe(1.0F, 1.0F, 1.0F);
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        rows[i] = forecast.row_veh[0];
    }
    TEST_ASSERT_EQUAL_UINT16(0U, elmopp_forecast_look(&forecast, 60U, rows));
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        TEST_ASSERT_NULL(rows[i]);
    }
}

static void test_no_step_may_be_asked_for(void) {
    start(ELMOPP_FORECAST_MEAN, NULL, NULL);
    TEST_ASSERT_EQUAL_UINT16(0U, elmopp_forecast_look(&forecast, 0U, rows));
}

static void test_every_kind_starts_cold_with_nothing(void) {
    static const elmopp_ar8_t model[APPROACHES] = {{.intercept = 1.0F, .high = 9.0F},
                                                   {.intercept = 1.0F, .high = 9.0F}};
    for (uint8_t kind = ELMOPP_FORECAST_MEAN; kind < ELMOPP_FORECAST_COUNT; kind++) {
        start(kind, model, NULL);
        expect_everywhere(0.0F, 0.0F);
    }
}

static void test_mean_is_the_exact_average_until_the_window_is_full(void) {
    start(ELMOPP_FORECAST_MEAN, NULL, NULL);
    observe(1.0F, 4.0F, 2.0F);
    expect_everywhere(3.0F, 4.0F);
    observe(0.0F, 1.0F, 0.0F);
    expect_everywhere(1.5F, 2.5F);
    observe(0.0F, 1.0F, 0.0F);
    observe(0.0F, 2.0F, 1.0F);
    expect_everywhere(1.0F, 2.0F);
}

static void test_a_given_mean_wins_over_the_running_one(void) {
    static const float mean_veh_per_s[APPROACHES] = {0.25F, 0.75F};
    start(ELMOPP_FORECAST_MEAN, NULL, mean_veh_per_s);
    expect_everywhere(0.25F, 0.75F);
    observe(1.0F, 1.0F, 1.0F);
    expect_everywhere(0.25F, 0.75F);
}

static void test_persistence_is_the_last_second(void) {
    static const float mean_veh_per_s[APPROACHES] = {9.0F, 9.0F};
    start(ELMOPP_FORECAST_PERSISTENCE, NULL, mean_veh_per_s);
    observe(1.0F, 2.0F, 3.0F);
    expect_everywhere(4.0F, 2.0F);
    observe(0.5F, 0.0F, 0.25F);
    expect_everywhere(0.75F, 0.0F);
}

/* The running mean of `window`, in double, as the header words it: the n-th observation weighs 1 / min(n, window). */
static double running_mean(double mean, double value, uint32_t n, uint32_t window) {
    return mean + ((value - mean) / (double)((n < window) ? n : window));
}

/* The first window - 1 observations are 0, then all are 1: from the window on, mean and average go different ways. */
static void check_window(uint8_t kind, uint32_t window) {
    start(kind, NULL, NULL);
    double mean = 0.0;
    for (uint32_t n = 1U; n <= window + 50U; n++) {
        const float value_veh = (n < window) ? 0.0F : 1.0F;
        observe(value_veh, 0.0F, 0.0F);
        mean = running_mean(mean, (double)value_veh, n, window);
        look(1U);
        TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, (float)mean, rows[0][0]);
    }
    /* 51 ones after window - 1 zeros: the window + 1st weighs 1 / window, not 1 / (window + 1). */
    const double right = 1.0 - pow(1.0 - (1.0 / (double)window), 51.0);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-5F, (float)right, rows[0][0]);
}

static void test_running_mean_has_a_window_of_900_seconds(void) {
    check_window(ELMOPP_FORECAST_MEAN, MEAN_WINDOW);
}

static void test_ewma_has_a_time_constant_of_120_seconds(void) {
    check_window(ELMOPP_FORECAST_EWMA, EWMA_WINDOW);
}

static void test_ewma_is_flat_and_ignores_a_given_mean(void) {
    static const float mean_veh_per_s[APPROACHES] = {9.0F, 9.0F};
    start(ELMOPP_FORECAST_EWMA, NULL, mean_veh_per_s);
    observe(1.0F, 4.0F, 2.0F);
    observe(0.0F, 1.0F, 0.0F);
    expect_everywhere(1.5F, 2.5F);
}

/* Coefficients without symmetry, so that a wrong order of lags shows. */
static const elmopp_ar8_t model_of_two[APPROACHES] = {
    {.intercept = 0.1F, .lag = {0.5F, -0.3F, 0.2F, 0.1F, -0.05F, 0.15F, 0.07F, 0.11F}, .low = 0.0F, .high = 1000.0F},
    {.intercept = 0.3F, .lag = {0.2F, 0.1F, 0.05F, -0.2F, 0.3F, 0.02F, -0.1F, 0.25F}, .low = 0.0F, .high = 1000.0F},
};

/* The regression in double, from its equation. `last` holds y(t), y(t - 1), ..., in vehicles. */
static void regress(const elmopp_ar8_t *model, const double last[8], double scale, double out[ELMOPP_HORIZON_MAX]) {
    double series[8U + ELMOPP_HORIZON_MAX];
    for (uint32_t k = 0U; k < 8U; k++) {
        series[7U - k] = last[k] / scale;
    }
    for (uint32_t t = 0U; t < ELMOPP_HORIZON_MAX; t++) {
        double y = (double)model->intercept;
        for (uint32_t i = 1U; i <= 8U; i++) {
            y += (double)model->lag[i - 1U] * series[8U + t - i];
        }
        y = fmin(fmax(y, (double)model->low), (double)model->high);
        series[8U + t] = y;
        out[t] = y * scale;
    }
}

static void check_regression(const elmopp_ar8_t *model, const float *mean_veh_per_s, uint32_t seconds) {
    start(ELMOPP_FORECAST_AR8, model, mean_veh_per_s);
    uint64_t random = 7U;
    double last[APPROACHES][8] = {{0.0}};
    double sum[APPROACHES] = {0.0};
    for (uint32_t n = 0U; n < seconds; n++) {
        const float veh[MOVEMENTS] = {0.1F * (float)random_below(&random, 10U),
                                      0.1F * (float)random_below(&random, 30U),
                                      0.1F * (float)random_below(&random, 5U)};
        elmopp_forecast_observe(&forecast, veh);
        const double came[APPROACHES] = {(double)veh[0] + (double)veh[2], (double)veh[1]};
        for (uint32_t i = 0U; i < APPROACHES; i++) {
            (void)memmove(&last[i][1], &last[i][0], 7U * sizeof(double));
            last[i][0] = came[i];
            sum[i] += came[i];
        }
    }
    look(ELMOPP_HORIZON_MAX);
    for (uint32_t i = 0U; i < APPROACHES; i++) {
        double right[ELMOPP_HORIZON_MAX];
        const double scale = (mean_veh_per_s != NULL) ? (double)mean_veh_per_s[i] : (sum[i] / (double)seconds);
        regress(&model[i], last[i], scale, right);
        for (uint32_t t = 0U; t < ELMOPP_HORIZON_MAX; t++) {
            TEST_ASSERT_DOUBLE_WITHIN(1.0e-5 * fmax(1.0, fabs(right[t])), right[t], (double)rows[i][t]);
        }
    }
}

static void test_ar8_iterates_its_own_output(void) {
    check_regression(model_of_two, NULL, 8U);
    check_regression(model_of_two, NULL, 9U);
    check_regression(model_of_two, NULL, 200U);
}

static void test_ar8_divides_by_the_given_mean_and_multiplies_it_back(void) {
    static const float mean_veh_per_s[APPROACHES] = {0.4F, 2.5F};
    check_regression(model_of_two, mean_veh_per_s, 8U);
    check_regression(model_of_two, mean_veh_per_s, 50U);
}

static void test_ar8_feeds_clamped_values_back(void) {
    elmopp_ar8_t model[APPROACHES] = {model_of_two[0], model_of_two[1]};
    model[0].low = 0.9F;
    model[0].high = 1.1F;
    model[1].low = 0.5F;
    model[1].high = 0.8F;
    check_regression(model, NULL, 20U);
}

static void test_ar8_gives_the_mean_until_eight_seconds_have_been_seen(void) {
    static const elmopp_ar8_t model[APPROACHES] = {{.intercept = 5.0F, .high = 9.0F},
                                                   {.intercept = 7.0F, .high = 9.0F}};
    start(ELMOPP_FORECAST_AR8, model, NULL);
    for (uint32_t n = 1U; n <= 7U; n++) {
        observe(0.5F, 1.0F, 0.5F);
        expect_everywhere(1.0F, 1.0F);
    }
    observe(0.5F, 1.0F, 0.5F);
    expect_everywhere(5.0F, 7.0F);
}

static void test_ar8_is_held_between_low_and_high(void) {
    static const elmopp_ar8_t model[APPROACHES] = {
        {.intercept = -3.0F, .low = 0.25F, .high = 2.0F},
        {.intercept = 50.0F, .low = 0.25F, .high = 2.0F},
    };
    static const float mean_veh_per_s[APPROACHES] = {2.0F, 3.0F};
    start(ELMOPP_FORECAST_AR8, model, mean_veh_per_s);
    for (uint32_t n = 0U; n < 8U; n++) {
        observe(1.0F, 1.0F, 1.0F);
    }
    expect_everywhere(0.5F, 6.0F);
}

static void test_ar8_of_an_unstable_model_stays_within_its_limits(void) {
    static const elmopp_ar8_t model[APPROACHES] = {{.lag = {3.0F}, .high = 4.0F}, {.lag = {-3.0F}, .high = 4.0F}};
    start(ELMOPP_FORECAST_AR8, model, NULL);
    for (uint32_t n = 0U; n < 8U; n++) {
        observe(1.0F, 1.0F, 0.0F);
    }
    look(ELMOPP_HORIZON_MAX);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 3.0F, rows[0][0]);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 4.0F, rows[0][1]);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 4.0F, rows[0][149]);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, rows[1][0]);
}

static void test_ar8_without_any_traffic_foresees_none(void) {
    static const elmopp_ar8_t model[APPROACHES] = {{.intercept = 5.0F, .high = 9.0F},
                                                   {.intercept = 7.0F, .high = 9.0F}};
    static const float zero[APPROACHES] = {0.0F, 0.0F};
    for (uint32_t given = 0U; given < 2U; given++) {
        start(ELMOPP_FORECAST_AR8, model, (given == 1U) ? zero : NULL);
        for (uint32_t n = 0U; n < 20U; n++) {
            observe(0.0F, 0.0F, 0.0F);
        }
        expect_everywhere(0.0F, 0.0F);
    }
}

static void test_rows_are_filled_as_far_as_asked_and_no_further(void) {
    start(ELMOPP_FORECAST_PERSISTENCE, NULL, NULL);
    observe(1.0F, 2.0F, 0.0F);
    expect_everywhere(1.0F, 2.0F);
    observe(3.0F, 4.0F, 0.0F);
    look(10U);
    TEST_ASSERT_EQUAL_FLOAT(3.0F, rows[0][9]);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, forecast.row_veh[0][10]);
}

static void expect_shares(float first, float second, float third) {
    const float *share = elmopp_forecast_share(&forecast);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-5F, first, share[0]);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-5F, second, share[1]);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-5F, third, share[2]);
}

static void test_shares_are_equal_until_60_seconds_and_then_those_of_the_arrivals(void) {
    start(ELMOPP_FORECAST_NONE, NULL, NULL);
    expect_shares(0.5F, 1.0F, 0.5F);
    for (uint32_t n = 1U; n <= 59U; n++) {
        observe(0.3F, 1.0F, 0.1F);
        expect_shares(0.5F, 1.0F, 0.5F);
    }
    observe(0.3F, 1.0F, 0.1F);
    expect_shares(0.75F, 1.0F, 0.25F);
}

static void test_shares_of_an_approach_without_traffic_are_equal(void) {
    start(ELMOPP_FORECAST_MEAN, NULL, NULL);
    for (uint32_t n = 0U; n < 100U; n++) {
        observe(0.0F, 0.0F, 0.0F);
    }
    expect_shares(0.5F, 1.0F, 0.5F);
    observe(0.0F, 0.0F, 1.0F);
    expect_shares(0.0F, 1.0F, 1.0F);
}

static void test_shares_forget_with_the_window_of_the_mean(void) {
    start(ELMOPP_FORECAST_NONE, NULL, NULL);
    double first = 0.0;
    double third = 0.0;
    for (uint32_t n = 1U; n <= 1500U; n++) {
        const bool early = n <= MEAN_WINDOW;
        observe(early ? 1.0F : 0.0F, 0.0F, early ? 0.0F : 1.0F);
        first = running_mean(first, early ? 1.0 : 0.0, n, MEAN_WINDOW);
        third = running_mean(third, early ? 0.0 : 1.0, n, MEAN_WINDOW);
    }
    expect_shares((float)(first / (first + third)), 1.0F, (float)(third / (first + third)));
}

static void test_shares_sum_to_one_over_every_approach_of_every_site(void) {
    for (uint32_t i = 0U; i < TEST_SITE_COUNT; i++) {
        junction = *test_sites[i];
        start(ELMOPP_FORECAST_MEAN, NULL, NULL);
        uint64_t random = i;
        for (uint32_t n = 0U; n < 300U; n++) {
            float arrivals_veh[ELMOPP_MOVEMENT_MAX];
            for (uint32_t j = 0U; j < junction.movement_count; j++) {
                arrivals_veh[j] = 0.25F * (float)random_below(&random, 1U + j);
            }
            elmopp_forecast_observe(&forecast, arrivals_veh);
            float sum[ELMOPP_APPROACH_MAX] = {0.0F};
            for (uint32_t j = 0U; j < junction.movement_count; j++) {
                sum[junction.movement[j].approach] += elmopp_forecast_share(&forecast)[j];
            }
            for (uint32_t a = 0U; a < junction.approach_count; a++) {
                TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 1.0F, sum[a]);
            }
        }
    }
}

/* Run it with sanitizers: a step beyond any array shows there. */
static void test_the_largest_junction_is_forecast_within_its_arrays(void) {
    static const elmopp_ar8_t model[ELMOPP_APPROACH_MAX] = {{.lag = {0.5F}, .high = 9.0F}};
    float arrivals_veh[ELMOPP_MOVEMENT_MAX];
    junction = test_cross(ELMOPP_GROUP_MAX);
    junction.movement_count = ELMOPP_MOVEMENT_MAX;
    for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
        junction.movement[j].approach = (uint8_t)(j % ELMOPP_APPROACH_MAX);
        arrivals_veh[j] = (float)(j % ELMOPP_APPROACH_MAX);
    }
    start(ELMOPP_FORECAST_AR8, model, NULL);
    for (uint32_t n = 0U; n < 60U; n++) {
        elmopp_forecast_observe(&forecast, arrivals_veh);
    }
    TEST_ASSERT_EQUAL_UINT16(ELMOPP_HORIZON_MAX, elmopp_forecast_look(&forecast, ELMOPP_HORIZON_MAX, rows));
    TEST_ASSERT_EQUAL_FLOAT(0.0F, rows[7][149]);
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 1.0F / 3.0F, elmopp_forecast_share(&forecast)[23]);
}

static void test_seconds_seen_saturate(void) {
    start(ELMOPP_FORECAST_MEAN, NULL, NULL);
    observe(1.0F, 1.0F, 1.0F);
    forecast.seen_s = UINT32_MAX - 1U;
    observe(2.0F, 1.0F, 1.0F);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, forecast.seen_s);
    observe(2.0F, 1.0F, 1.0F);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, forecast.seen_s);
    expect_everywhere((float)running_mean(running_mean(2.0, 3.0, 900U, 900U), 3.0, 900U, 900U), 1.0F);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_none_gives_no_row);
    RUN_TEST(test_without_a_forecast_an_approach_whose_neighbour_is_silent_has_no_row);
    RUN_TEST(test_with_a_forecast_an_approach_whose_neighbour_is_silent_keeps_its_row);
    RUN_TEST(test_no_step_may_be_asked_for);
    RUN_TEST(test_every_kind_starts_cold_with_nothing);
    RUN_TEST(test_mean_is_the_exact_average_until_the_window_is_full);
    RUN_TEST(test_a_given_mean_wins_over_the_running_one);
    RUN_TEST(test_persistence_is_the_last_second);
    RUN_TEST(test_running_mean_has_a_window_of_900_seconds);
    RUN_TEST(test_ewma_has_a_time_constant_of_120_seconds);
    RUN_TEST(test_ewma_is_flat_and_ignores_a_given_mean);
    RUN_TEST(test_ar8_iterates_its_own_output);
    RUN_TEST(test_ar8_divides_by_the_given_mean_and_multiplies_it_back);
    RUN_TEST(test_ar8_feeds_clamped_values_back);
    RUN_TEST(test_ar8_gives_the_mean_until_eight_seconds_have_been_seen);
    RUN_TEST(test_ar8_is_held_between_low_and_high);
    RUN_TEST(test_ar8_of_an_unstable_model_stays_within_its_limits);
    RUN_TEST(test_ar8_without_any_traffic_foresees_none);
    RUN_TEST(test_rows_are_filled_as_far_as_asked_and_no_further);
    RUN_TEST(test_shares_are_equal_until_60_seconds_and_then_those_of_the_arrivals);
    RUN_TEST(test_shares_of_an_approach_without_traffic_are_equal);
    RUN_TEST(test_shares_forget_with_the_window_of_the_mean);
    RUN_TEST(test_shares_sum_to_one_over_every_approach_of_every_site);
    RUN_TEST(test_the_largest_junction_is_forecast_within_its_arrays);
    RUN_TEST(test_seconds_seen_saturate);
    return UNITY_END();
}
