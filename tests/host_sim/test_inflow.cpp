// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Golden values of the inflow: integrators, generator, mapping, exponents, and what a trace may hold.

#include "autoregression.hpp"
#include "error.hpp"
#include "expect.hpp"
#include "inflow.hpp"
#include "lyapunov.hpp"

#include <algorithm>
#include <array>
#include <numeric>

using namespace elmopp;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

namespace {

constexpr double tolerance = 1e-11;
constexpr State middle{0.5, 0.5, 0.5, 0.5};
constexpr std::size_t exponent_steps = 100000; ///< of the exponents: a thousand units of time, good to 0.01

void expect_state(const State &expected, const State &actual, double relative) {
    for (std::size_t i = 0; i < expected.size(); ++i) {
        expect_relative(expected[i], actual[i], relative, "component " + std::to_string(i));
    }
}

State advanced(Integrator integrator, unsigned steps) {
    State state = middle;
    for (unsigned i = 0; i < steps; ++i) {
        state = advance(integrator, state);
    }
    return state;
}

void test_euler_golden() {
    expect_state({0.397, 0.4975, 0.6925, 0.5}, advanced(Integrator::euler, 1), tolerance);
    expect_state({0.299025, 0.495274225, 0.883599925, 0.4999975}, advanced(Integrator::euler, 2), tolerance);
    expect_state({0.20583797625, 0.492963667426, 1.073282932, 0.499992776725}, advanced(Integrator::euler, 3),
                 tolerance);
}

void test_rk4_golden() {
    expect_state({0.399474343969, 0.497673865425, 0.691798337064, 0.499998813459}, advanced(Integrator::rk4, 1),
                 tolerance);
    expect_state({0.212568219908, 0.493018381771, 1.07114087054, 0.499989663749}, advanced(Integrator::rk4, 3),
                 tolerance);
}

void test_generator_gives_the_published_sequence() {
    SplitMix64 random(1234567);
    for (const std::uint64_t expected : {6457827717110365317ULL, 3203168211198807973ULL, 9817491932198370423ULL,
                                         4593380528125082431ULL, 16408922859458223821ULL}) {
        TEST_ASSERT_EQUAL_UINT64(expected, random.next());
    }
    TEST_ASSERT_TRUE(SplitMix64(1234567).uniform() == std::ldexp(6457827717110365317ULL >> 11U, -53));
}

void expect_same(const State &expected, const State &actual) {
    for (std::size_t i = 0; i < expected.size(); ++i) {
        TEST_ASSERT_TRUE_MESSAGE(expected[i] == actual[i], ("component " + std::to_string(i)).c_str());
    }
}

// From the independent reference (tests/reference), to the bit: a rounding error grows by 1e13 over a trajectory.
void test_trajectory_equals_the_reference_to_the_bit() {
    const Trajectory trajectory = draw_trajectory(Integrator::rk4, 1, 0, 4);
    TEST_ASSERT_EQUAL_UINT(1, trajectory.parts.size());
    const auto &points = trajectory.parts[0];
    TEST_ASSERT_EQUAL_UINT(trajectory_points, points.size());
    expect_same({0.766301757339086, 0.21748923448407254, 0.6849302968778451, 0.4476295210660469}, points[0]);
    expect_same({3.965122899926208, 2.006596598403191, 5.266181544257498, -0.9843630677516342}, points[8000]);
    expect_same({-8.80738699196762, -1.0494103809585622, -9.007954654958876, 0.22687713282115143}, points[10149]);
}

void test_seed_and_trial_make_the_state_of_the_generator() {
    const State third = draw_trajectory(Integrator::rk4, 7, 3, 4).parts[0][0];
    SplitMix64 random((7ULL << 32U) + 3ULL);
    for (const double component : third) {
        TEST_ASSERT_TRUE(component == random.uniform());
    }
}

void test_integrators_start_alike_and_part() {
    const Trajectory rk4 = draw_trajectory(Integrator::rk4, 1, 0, 4);
    const Trajectory euler = draw_trajectory(Integrator::euler, 1, 0, 4);
    expect_same(rk4.parts[0][0], euler.parts[0][0]);
    TEST_ASSERT_TRUE(rk4.parts[0][1] != euler.parts[0][1]);
}

void test_fifth_approach_draws_a_second_trajectory_from_the_same_stream() {
    const Trajectory four = draw_trajectory(Integrator::rk4, 1, 0, 4);
    const Trajectory five = draw_trajectory(Integrator::rk4, 1, 0, 5);
    TEST_ASSERT_EQUAL_UINT(2, five.parts.size());
    TEST_ASSERT_TRUE(four.parts[0] == five.parts[0]);
    SplitMix64 random(1ULL << 32U);
    for (unsigned i = 0; i < 4; ++i) {
        (void)random.uniform();
    }
    for (const double component : five.parts[1][0]) {
        TEST_ASSERT_TRUE(component == random.uniform());
    }
    const Series unit = unit_inflow(five, Mapping::abs, 5);
    TEST_ASSERT_EQUAL_UINT(5, unit.size());
    double sum = 0.0;
    for (std::size_t t = training_points; t < training_points + simulated_points; ++t) {
        sum += std::abs(five.parts[1][t][0]);
    }
    expect_relative(std::abs(five.parts[1][9000][0]) / sum, unit[4][9000], 1e-12);
}

void test_random_number_of_vehicles_is_the_draw_that_follows() {
    SplitMix64 random(1ULL << 32U);
    for (unsigned i = 0; i < 4; ++i) {
        (void)random.uniform();
    }
    const auto expected = 200U + static_cast<unsigned>(random.uniform() * 801.0);
    TEST_ASSERT_EQUAL_UINT(expected, draw_trajectory(Integrator::rk4, 1, 0, 4).random_vehicles);
    unsigned lowest = 1000, highest = 200;
    for (std::uint64_t trial = 0; trial < 60; ++trial) {
        const unsigned vehicles = draw_trajectory(Integrator::euler, 1, trial, 4).random_vehicles;
        lowest = std::min(lowest, vehicles);
        highest = std::max(highest, vehicles);
    }
    TEST_ASSERT_TRUE(lowest >= 200 && highest <= 1000);
    TEST_ASSERT_TRUE(lowest < 300 && highest > 900);
}

void test_unit_inflow_sums_to_one_over_the_simulated_points() {
    const Trajectory trajectory = draw_trajectory(Integrator::rk4, 2, 5, 4);
    for (const Mapping mapping : {Mapping::abs, Mapping::shift}) {
        const Series unit = unit_inflow(trajectory, mapping, 4);
        TEST_ASSERT_EQUAL_UINT(4, unit.size());
        for (const auto &series : unit) {
            TEST_ASSERT_EQUAL_UINT(trajectory_points, series.size());
            const auto begin = series.begin() + static_cast<std::ptrdiff_t>(training_points);
            const auto end = begin + static_cast<std::ptrdiff_t>(simulated_points);
            expect_relative(1.0, std::accumulate(begin, end, 0.0), 1e-12);
            TEST_ASSERT_TRUE(*std::min_element(series.begin(), series.end()) >= 0.0);
        }
    }
}

void test_shift_is_measured_from_the_lowest_point_and_abs_from_zero() {
    const Trajectory trajectory = draw_trajectory(Integrator::rk4, 2, 5, 4);
    const Series by_abs = unit_inflow(trajectory, Mapping::abs, 4);
    const Series by_shift = unit_inflow(trajectory, Mapping::shift, 4);
    for (std::size_t i = 0; i < 4; ++i) {
        const auto &points = trajectory.parts[0];
        const auto value = [&](std::size_t t) { return points[t][i]; };
        double lowest = value(0);
        for (std::size_t t = 0; t < trajectory_points; ++t) {
            lowest = std::min(lowest, value(t));
        }
        TEST_ASSERT_TRUE(*std::min_element(by_shift[i].begin(), by_shift[i].end()) == 0.0);
        expect_relative((value(8100) - lowest) / (value(9100) - lowest), by_shift[i][8100] / by_shift[i][9100], 1e-9);
        expect_relative(std::abs(value(8100) / value(9100)), by_abs[i][8100] / by_abs[i][9100], 1e-9);
    }
}

void test_scope() {
    TEST_ASSERT_EQUAL_DOUBLE(800.0, vehicles_per_approach(Scope::per_inroad, 800.0, 4));
    TEST_ASSERT_EQUAL_DOUBLE(200.0, vehicles_per_approach(Scope::total, 800.0, 4));
    TEST_ASSERT_EQUAL_DOUBLE(160.0, vehicles_per_approach(Scope::total, 800.0, 5));
}

void test_rk4_is_hyperchaotic() {
    const auto exponents = lyapunov_exponents(Integrator::rk4, exponent_steps);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.263, exponents[0]);
    TEST_ASSERT_TRUE(exponents[0] > 0.1 && exponents[1] > 0.1);
    TEST_ASSERT_TRUE(exponents[0] >= exponents[1] && exponents[1] >= exponents[2] && exponents[2] >= exponents[3]);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.0, exponents[2]);
    // The divergence of the flow is constant: -a - h - c - d.
    TEST_ASSERT_DOUBLE_WITHIN(0.02, -7.1, std::accumulate(exponents.begin(), exponents.end(), 0.0));
}

void test_euler_as_printed_is_not() {
    const auto exponents = lyapunov_exponents(Integrator::euler, exponent_steps);
    TEST_ASSERT_TRUE(exponents[1] < 0.05);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, -7.1, std::accumulate(exponents.begin(), exponents.end(), 0.0));
}

// y(t+1) = 0.3 + 0.5 y(t) - 0.2 y(t-7) + a small periodic push that keeps the lags apart.
void test_ar8_finds_the_coefficients_of_a_regression() {
    std::vector<double> series(trajectory_points, 1.0);
    SplitMix64 random(1);
    for (std::size_t t = 8; t < series.size(); ++t) {
        series[t] = 0.3 + 0.5 * series[t - 1] - 0.2 * series[t - 8] + 0.001 * (random.uniform() - 0.5);
    }
    // What comes after the training points is the future: it must not be looked at.
    std::fill(series.begin() + static_cast<std::ptrdiff_t>(training_points), series.end(), 1e6);
    const double mean = training_mean(series);
    expect_relative(0.3 / 0.7, mean, 2e-3);
    const elmopp_ar8_t model = fit_ar8(series);
    TEST_ASSERT_FLOAT_WITHIN(0.05F, 0.7F, model.intercept); // 0.3 in units of the mean 0.3 / 0.7
    const std::array<float, 8> lags{0.5F, 0, 0, 0, 0, 0, 0, -0.2F};
    for (std::size_t i = 0; i < lags.size(); ++i) {
        TEST_ASSERT_FLOAT_WITHIN(0.05F, lags[i], model.lag[i]);
    }
}

void test_ar8_clamp_is_the_training_range_widened_by_a_tenth_and_never_negative() {
    std::vector<double> series(trajectory_points);
    for (std::size_t t = 0; t < series.size(); ++t) {
        series[t] = 2.0 + std::sin(static_cast<double>(t)) + 0.3 * std::sin(0.37 * static_cast<double>(t * t % 997));
    }
    const auto end = series.begin() + static_cast<std::ptrdiff_t>(training_points);
    const double low = *std::min_element(series.begin(), end), high = *std::max_element(series.begin(), end);
    const double mean = std::accumulate(series.begin(), end, 0.0) / 8000.0;
    const elmopp_ar8_t model = fit_ar8(series);
    TEST_ASSERT_FLOAT_WITHIN(1e-5F, static_cast<float>((low - 0.1 * (high - low)) / mean), model.low);
    TEST_ASSERT_FLOAT_WITHIN(1e-5F, static_cast<float>((high + 0.1 * (high - low)) / mean), model.high);
    for (double &value : series) {
        value -= low;
    }
    TEST_ASSERT_EQUAL_FLOAT(0.0F, fit_ar8(series).low);
}

const std::vector<std::string> two{"A", "B"};

std::string refusal(const std::string &text) {
    const TextFile file(text);
    return message_of<BadRequest>([&] { (void)read_trace(file.path(), two); }, text);
}

void test_good_trace() {
    const TextFile file("t_s,A,B\n0,0.25,0\n1,1e-3,2\r\n2,0,0.5\n");
    const Series series = read_trace(file.path(), two);
    TEST_ASSERT_TRUE((series == Series{{0.25, 1e-3, 0.0}, {0.0, 2.0, 0.5}}));
}

void test_trace_of_a_spreadsheet() {
    const TextFile file("\xEF\xBB\xBFt_s,A,B\r\n0,0.25,0\r\n1,10000,2\r\n\r\n"); // byte order mark, blank last line
    TEST_ASSERT_TRUE((read_trace(file.path(), two) == Series{{0.25, 10000.0}, {0.0, 2.0}}));
}

void test_bad_traces_name_the_place_and_the_value() {
    expect_words(refusal("t_s,A,B\n0,0.5,0.5\n1,-0.25,0\n"), {":3", "column A", "\"-0.25\"", "from 0 to 10000"});
    expect_words(refusal("t_s,A,B\n0,0.5,\n"), {":2", "column B", "\"\"", "finite number"});
    expect_words(refusal("t_s,A,B\n0,0.5,x1\n"), {":2", "column B", "\"x1\"", "finite number"});
    expect_words(refusal("t_s,A,B\n0,0.5,1e999\n"), {":2", "column B", "\"1e999\""});
    expect_words(refusal("t_s,A,B\n0,0.5,10001\n"), {":2", "column B", "\"10001\"", "from 0 to 10000"});
    expect_words(refusal("t_s,A,B\n0,0,0\n\n1,0,0\n"), {":3", "1 values", "3 as in the header"});
    expect_words(refusal("t_s,A,B\n0,nan,1\n"), {":2", "column A", "\"nan\""});
    expect_words(refusal("t_s,A,B\n0,inf,1\n"), {":2", "column A", "\"inf\""});
    expect_words(refusal("t_s,A,B\n0,0.5 ,1\n"), {":2", "column A", "\"0.5 \""});
    expect_words(refusal("t_s,A,B\n0,0,0\n1,0.5\n"), {":3", "2 values", "3 as in the header"});
    expect_words(refusal("t_s,A,B\n0,0,0,0\n"), {":2", "4 values"});
    expect_words(refusal("t_s,A,B\n0,0,0\n2,0,0\n"), {":3", "column t_s", "\"2\"", "would be 1"});
    expect_words(refusal("t_s,A,B\n1,0,0\n"), {":2", "\"1\"", "would be 0"});
    expect_words(refusal("t_s,A\n0,0\n"), {"t_s,A do not fit", "t_s,A,B"});
    expect_words(refusal("t_s,B,A\n0,0,0\n"), {"t_s,B,A do not fit", "t_s,A,B"});
    expect_words(refusal("time,A,B\n0,0,0\n"), {"time,A,B do not fit"});
    expect_words(refusal("t,x,y,z,w\n0,1,2,3,4\n"), {"t,x,y,z,w", "raw", "--mapping abs"});
    expect_words(refusal("t_s,A,B\n"), {"no rows"});
    expect_words(refusal(""), {"empty"});
    expect_words(message_of<BadRequest>([] { (void)read_trace("/nowhere/trace.csv", two); }),
                 {"/nowhere/trace.csv", "cannot be read"});
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_euler_golden);
    RUN_TEST(test_rk4_golden);
    RUN_TEST(test_generator_gives_the_published_sequence);
    RUN_TEST(test_trajectory_equals_the_reference_to_the_bit);
    RUN_TEST(test_seed_and_trial_make_the_state_of_the_generator);
    RUN_TEST(test_integrators_start_alike_and_part);
    RUN_TEST(test_fifth_approach_draws_a_second_trajectory_from_the_same_stream);
    RUN_TEST(test_random_number_of_vehicles_is_the_draw_that_follows);
    RUN_TEST(test_unit_inflow_sums_to_one_over_the_simulated_points);
    RUN_TEST(test_shift_is_measured_from_the_lowest_point_and_abs_from_zero);
    RUN_TEST(test_scope);
    RUN_TEST(test_rk4_is_hyperchaotic);
    RUN_TEST(test_euler_as_printed_is_not);
    RUN_TEST(test_ar8_finds_the_coefficients_of_a_regression);
    RUN_TEST(test_ar8_clamp_is_the_training_range_widened_by_a_tenth_and_never_negative);
    RUN_TEST(test_good_trace);
    RUN_TEST(test_trace_of_a_spreadsheet);
    RUN_TEST(test_bad_traces_name_the_place_and_the_value);
    return UNITY_END();
}
