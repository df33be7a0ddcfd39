// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Statistics against scipy 1.x, and the few cases that it refuses.
///
///     from scipy.stats import ttest_ind, ttest_rel
///     r = ttest_ind(a, b, equal_var=False, alternative="greater"); r.statistic, r.df, r.pvalue
///     ttest_rel(a, c).confidence_interval(0.95)

#include "expect.hpp"
#include "stats.hpp"

using namespace elmopp;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

namespace {

constexpr double tolerance = 1e-11;
const std::vector<double> a{2.0, 3.5, 1.25, 4.75, 3.0};
const std::vector<double> b{1.0, 2.5, 2.25, 0.5, 1.75, 0.25, 1.5};
const std::vector<double> c{1.5, 3.0, 2.0, 4.0, 2.5};

void test_summary() {
    const Summary summary = summarize(a);
    expect_relative(2.9, summary.mean, tolerance);
    expect_relative(1.3532368602724358, summary.sd, tolerance);
    TEST_ASSERT_EQUAL_UINT(5, summary.n);
    expect_relative(0.8521681032463467, summarize(b).sd, tolerance);
}

void test_summary_of_one_and_of_none() {
    TEST_ASSERT_EQUAL_DOUBLE(4.0, summarize({4.0}).mean);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, summarize({4.0}).sd);
    TEST_ASSERT_EQUAL_UINT(1, summarize({4.0}).n);
    TEST_ASSERT_EQUAL_UINT(0, summarize({}).n);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, summarize({}).mean);
}

void test_paired_interval() {
    const Interval interval = paired_interval(a, c);
    expect_relative(-0.44110804126665365, interval.low, tolerance);
    expect_relative(1.0411080412666536, interval.high, tolerance);
    const Interval wide = paired_interval({5.0, 1.0}, {2.0, 1.5});
    expect_relative(-20.985858288305714, wide.low, tolerance);
    expect_relative(23.485858288305714, wide.high, tolerance);
}

void test_paired_interval_without_spread_is_a_point() {
    const Interval same = paired_interval({3.0, 4.0, 5.0}, {1.0, 2.0, 3.0});
    TEST_ASSERT_EQUAL_DOUBLE(2.0, same.low);
    TEST_ASSERT_EQUAL_DOUBLE(2.0, same.high);
    const Interval one = paired_interval({3.0}, {1.5});
    TEST_ASSERT_EQUAL_DOUBLE(1.5, one.low);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, one.high);
}

void test_welch() {
    const Welch test = welch(a, b);
    expect_relative(2.1984136877501053, test.t, tolerance);
    expect_relative(6.252519058535288, test.df, tolerance);
    expect_relative(0.034223965305686305, test.p_one_sided, tolerance);
    const Welch turned = welch(b, a);
    expect_relative(-2.1984136877501053, turned.t, tolerance);
    expect_relative(6.252519058535288, turned.df, tolerance);
    expect_relative(0.9657760346943137, turned.p_one_sided, tolerance);
}

// a = sin(t) + 1, b = 2 cos(2 t), t = 0..29
void test_welch_of_larger_samples() {
    std::vector<double> sines, cosines;
    for (unsigned t = 0; t < 30; ++t) {
        sines.push_back(std::sin(t) + 1.0);
        cosines.push_back(2.0 * std::cos(2.0 * t));
    }
    const Welch test = welch(sines, cosines);
    expect_relative(3.365596918040043, test.t, 1e-10);
    expect_relative(42.28508648625186, test.df, 1e-10);
    expect_relative(0.0008172312976936702, test.p_one_sided, 1e-9);
}

void test_welch_without_any_spread() {
    const Welch equal = welch({2.0, 2.0}, {2.0, 2.0, 2.0});
    TEST_ASSERT_EQUAL_DOUBLE(0.0, equal.t);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, equal.p_one_sided);
    const Welch above = welch({3.0, 3.0}, {2.0, 2.0});
    TEST_ASSERT_TRUE(above.t > 1e100 && std::isfinite(above.t));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, above.p_one_sided);
    const Welch below = welch({1.0, 1.0}, {2.0, 2.0});
    TEST_ASSERT_TRUE(below.t < -1e100 && std::isfinite(below.t));
    TEST_ASSERT_EQUAL_DOUBLE(1.0, below.p_one_sided);
}

void test_welch_with_spread_on_one_side_only() {
    // scipy: ttest_ind([1, 2, 3], [1, 1, 1], equal_var=False, alternative="greater")
    const Welch test = welch({1.0, 2.0, 3.0}, {1.0, 1.0, 1.0});
    expect_relative(std::sqrt(3.0), test.t, tolerance);
    expect_relative(2.0, test.df, tolerance);
    expect_relative(0.11270166537925835, test.p_one_sided, tolerance);
}

void test_welch_of_a_single_value_tells_nothing() {
    TEST_ASSERT_EQUAL_DOUBLE(1.0, welch({5.0}, {1.0, 2.0}).p_one_sided);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, welch({5.0, 6.0}, {1.0}).p_one_sided);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, welch({}, {}).p_one_sided);
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_summary);
    RUN_TEST(test_summary_of_one_and_of_none);
    RUN_TEST(test_paired_interval);
    RUN_TEST(test_paired_interval_without_spread_is_a_point);
    RUN_TEST(test_welch);
    RUN_TEST(test_welch_of_larger_samples);
    RUN_TEST(test_welch_without_any_spread);
    RUN_TEST(test_welch_with_spread_on_one_side_only);
    RUN_TEST(test_welch_of_a_single_value_tells_nothing);
    return UNITY_END();
}
