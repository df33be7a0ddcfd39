// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The fluid: laws of discharge, arrivals that do not fit, and that no vehicle is lost. With the profiles that set
/// them.

#include "error.hpp"
#include "expect.hpp"
#include "sites.hpp"
#include "traffic.hpp"

#include <limits>
#include <numeric>

using namespace elmopp;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

namespace {

constexpr double tolerance = 1e-11;
constexpr double capacity = 1000.0 / 3.0;
constexpr std::size_t lanes = 12;

double greenshields(double queue) {
    return discharge_veh_per_s(ELMOPP_DISCHARGE_GREENSHIELDS, queue, capacity, 10.0, 0.5);
}

double nolock(double queue) {
    return discharge_veh_per_s(ELMOPP_DISCHARGE_NOLOCK, queue, capacity, 10.0, 0.5);
}

double saturation(double queue) {
    return discharge_veh_per_s(ELMOPP_DISCHARGE_SATURATION, queue, capacity, 10.0, 0.5);
}

double sum(const std::vector<double> &values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

void test_greenshields_golden() {
    expect_relative(1.6, greenshields(200.0 / 3.0), tolerance);
    expect_relative(1.875, greenshields(250.0), tolerance);
    expect_relative(2.5, greenshields(capacity / 2.0), tolerance);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, greenshields(capacity));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, greenshields(0.0));
}

void test_nolock_golden() {
    expect_relative(1.6, nolock(200.0 / 3.0), tolerance);
    expect_relative(2.5, nolock(250.0), tolerance);
    expect_relative(2.5, nolock(capacity), tolerance);
}

void test_saturation_is_constant() {
    TEST_ASSERT_EQUAL_DOUBLE(0.5, saturation(0.5));
    TEST_ASSERT_EQUAL_DOUBLE(0.5, saturation(capacity));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, saturation(0.0));
}

void test_flow_is_never_more_than_the_queue_nor_negative() {
    TEST_ASSERT_EQUAL_DOUBLE(0.25, saturation(0.25));
    // 10 k (1 - k) with a capacity of 2 would be 2.5.
    TEST_ASSERT_EQUAL_DOUBLE(1.0, discharge_veh_per_s(ELMOPP_DISCHARGE_GREENSHIELDS, 1.0, 2.0, 10.0, 0.5));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, greenshields(capacity + 1.0));
    // No storage: no load, so nothing moves under Greenshields.
    TEST_ASSERT_EQUAL_DOUBLE(0.0, discharge_veh_per_s(ELMOPP_DISCHARGE_GREENSHIELDS, 3.0, 0.0, 10.0, 0.5));
    TEST_ASSERT_EQUAL_DOUBLE(0.5, discharge_veh_per_s(ELMOPP_DISCHARGE_SATURATION, 3.0, 0.0, 10.0, 0.5));
}

Scenario saturated() {
    return make_scenario(find_profile("saturation"), nullptr);
}

std::vector<double> flowing(double part) {
    return std::vector<double>(lanes, part);
}

void test_paper_starts_a_fifth_full_and_saturation_empty() {
    const Scenario paper = make_scenario(find_profile("paper"), nullptr);
    const Traffic traffic(paper);
    for (const double queue : traffic.queue_veh()) {
        expect_relative(200.0 / 3.0, queue, tolerance);
    }
    expect_relative(800.0, traffic.total_in_veh(), tolerance);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, traffic.total_out_veh());
    const Scenario empty = saturated();
    TEST_ASSERT_EQUAL_DOUBLE(0.0, Traffic(empty).total_in_veh());
}

void test_arrivals_are_split_over_the_movements_of_their_approach() {
    const Scenario scenario = make_scenario(find_profile("saturation"), nullptr, {1.0, 3.0, 1.0});
    Traffic traffic(scenario);
    traffic.arrive({5.0, 10.0, 0.0, 2.5});
    const std::vector<double> expected{1, 3, 1, 2, 6, 2, 0, 0, 0, 0.5, 1.5, 0.5};
    for (std::size_t j = 0; j < lanes; ++j) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, expected[j], traffic.arrived_veh()[j]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, expected[j], traffic.queue_veh()[j]);
    }
    traffic.arrive({0.0, 0.0, 0.0, 0.0});
    TEST_ASSERT_EQUAL_DOUBLE(0.0, sum(traffic.arrived_veh()));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 17.5, traffic.total_in_veh());
    traffic.check_conservation();
}

void test_a_part_of_a_second_moves_a_part_of_the_flow() {
    const Scenario scenario = saturated();
    Traffic traffic(scenario);
    traffic.arrive({30.0, 30.0, 30.0, 30.0});
    std::vector<double> parts = flowing(0.0);
    parts[1] = 0.5;
    parts[2] = 1.0;
    traffic.leave(parts);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, traffic.left_veh()[0]);
    TEST_ASSERT_EQUAL_DOUBLE(0.25, traffic.left_veh()[1]);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, traffic.left_veh()[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 9.75, traffic.queue_veh()[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.75, traffic.total_out_veh());
    traffic.leave(flowing(0.0));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, sum(traffic.left_veh()));
}

// What does not fit waits outside, enters as room appears, and is counted all the time.
void test_overflow_waits_outside_and_nothing_is_lost() {
    const Scenario scenario = saturated();
    Traffic traffic(scenario);
    traffic.arrive({1300.0, 0.0, 0.0, 0.0});
    for (std::size_t j = 0; j < 3; ++j) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, capacity, traffic.queue_veh()[j]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100.0, traffic.outside_veh()[j]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1300.0 / 3.0, traffic.arrived_veh()[j]);
    }
    traffic.check_conservation();
    traffic.leave(flowing(1.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, capacity - 0.5, traffic.queue_veh()[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100.0, traffic.outside_veh()[0]);
    traffic.arrive({0.0, 0.0, 0.0, 0.0});
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, capacity, traffic.queue_veh()[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 99.5, traffic.outside_veh()[0]);
    for (unsigned second = 0; second < 3000; ++second) {
        traffic.leave(flowing(1.0));
        traffic.arrive({0.0, 0.0, 0.0, 0.0});
        traffic.check_conservation();
        TEST_ASSERT_TRUE(traffic.queue_veh()[0] <= capacity + 1e-9);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1300.0, traffic.total_in_veh());
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1300.0, traffic.total_out_veh());
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, sum(traffic.outside_veh()) + sum(traffic.queue_veh()));
}

void test_conservation_is_checked() {
    const Scenario scenario = saturated();
    Traffic nobody(scenario);
    nobody.arrive({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0, 0.0});
    expect_words(message_of<Failure>([&] { nobody.check_conservation(); }), {"conservation", "nan", "1e-6"});
    // Thousandths of a vehicle beside 1e9 others: rounding makes two millionths too many, and that shows.
    Traffic everybody(scenario);
    everybody.arrive({1e9, 0.0, 0.0, 0.0});
    everybody.check_conservation();
    for (unsigned second = 0; second < 10; ++second) {
        everybody.arrive({0.001, 0.001, 0.001, 0.001});
    }
    expect_words(message_of<Failure>([&] { everybody.check_conservation(); }), {"conservation", "vehicles lost"});
}

void test_unknown_profile_is_named_with_those_there_are() {
    expect_words(message_of<BadRequest>([] { (void)find_profile("papers"); }),
                 {"\"papers\"", "paper, saturation, figure, literal"});
}

void test_profiles_set_inflow_and_discharge() {
    const Profile &paper = find_profile("paper");
    TEST_ASSERT_TRUE(paper.integrator == Integrator::rk4 && paper.scope == Scope::per_inroad && !paper.literal);
    TEST_ASSERT_EQUAL_INT(ELMOPP_DISCHARGE_GREENSHIELDS, paper.discharge);
    TEST_ASSERT_EQUAL_DOUBLE(0.2, paper.initial_load);
    const Profile &figure = find_profile("figure");
    TEST_ASSERT_TRUE(figure.integrator == Integrator::rk4 && figure.scope == Scope::total && !figure.literal);
    const Scenario window = make_scenario(figure, nullptr);
    TEST_ASSERT_EQUAL_UINT(5, window.junction.hold_min_s);
    TEST_ASSERT_EQUAL_UINT(20, window.junction.hold_max_s);
    const Profile &literal = find_profile("literal");
    TEST_ASSERT_TRUE(literal.integrator == Integrator::euler && literal.scope == Scope::per_inroad && literal.literal);
    const Profile &busy = find_profile("saturation");
    TEST_ASSERT_TRUE(busy.integrator == Integrator::rk4 && busy.scope == Scope::per_inroad && !busy.literal);
    TEST_ASSERT_EQUAL_INT(ELMOPP_DISCHARGE_SATURATION, busy.discharge);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, busy.initial_load);
}

void test_paper_capacity_is_the_exact_thousand_thirds() {
    const Scenario scenario = make_scenario(find_profile("paper"), nullptr);
    TEST_ASSERT_TRUE(scenario.capacity_veh == std::vector<double>(lanes, capacity));
    TEST_ASSERT_EQUAL_UINT(10, scenario.junction.hold_min_s);
    TEST_ASSERT_EQUAL_UINT(60, scenario.junction.hold_max_s);
    TEST_ASSERT_TRUE((scenario.approach_names() == std::vector<std::string>{"N", "E", "S", "W"}));
}

void test_shares_add_up_to_one_over_each_approach_of_every_site() {
    for (const auto *site :
         {&elmopp_site_five_way, &elmopp_site_four_way, &elmopp_site_left_lanes, &elmopp_site_one_way,
          &elmopp_site_paper, &elmopp_site_shared_lanes, &elmopp_site_three_way}) {
        const Scenario scenario = make_scenario(find_profile("saturation"), site);
        std::vector<double> total(site->approach_count);
        for (std::size_t j = 0; j < site->movement_count; ++j) {
            total[site->movement[j].approach] += scenario.share[j];
            TEST_ASSERT_TRUE(scenario.capacity_veh[j] == static_cast<double>(site->movement[j].capacity_veh));
        }
        for (const double share : total) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0, share);
        }
        TEST_ASSERT_EQUAL_INT(ELMOPP_DISCHARGE_SATURATION, scenario.junction.discharge);
        TEST_ASSERT_EQUAL_UINT(site->hold_min_s, scenario.junction.hold_min_s);
    }
}

void test_split_of_another_length_names_the_approach() {
    expect_words(message_of<BadRequest>([] { (void)make_scenario(find_profile("paper"), nullptr, {0.5, 0.5}); }),
                 {"--split", "2 shares", "approach N", "3 movements"});
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_greenshields_golden);
    RUN_TEST(test_nolock_golden);
    RUN_TEST(test_saturation_is_constant);
    RUN_TEST(test_flow_is_never_more_than_the_queue_nor_negative);
    RUN_TEST(test_paper_starts_a_fifth_full_and_saturation_empty);
    RUN_TEST(test_arrivals_are_split_over_the_movements_of_their_approach);
    RUN_TEST(test_a_part_of_a_second_moves_a_part_of_the_flow);
    RUN_TEST(test_overflow_waits_outside_and_nothing_is_lost);
    RUN_TEST(test_conservation_is_checked);
    RUN_TEST(test_unknown_profile_is_named_with_those_there_are);
    RUN_TEST(test_profiles_set_inflow_and_discharge);
    RUN_TEST(test_paper_capacity_is_the_exact_thousand_thirds);
    RUN_TEST(test_shares_add_up_to_one_over_each_approach_of_every_site);
    RUN_TEST(test_split_of_another_length_names_the_approach);
    return UNITY_END();
}
