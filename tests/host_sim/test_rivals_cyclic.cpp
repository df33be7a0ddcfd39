// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The rivals with a cycle (webster, scats, scoot), and what they share: the cycle and the arrivals by age. Asked with
/// a view made by hand; the paper's site, 0.5 vehicle/s a lane, so that a round of its four stages loses 6 s.

#include "approaching.hpp"
#include "cyclic.hpp"
#include "scats.hpp"
#include "scoot.hpp"
#include "street.hpp"
#include "view.hpp"

#include <numeric>

using namespace elmopp;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

namespace {

/// Stages and for how long each is shown.
using Shown = std::vector<std::pair<elmopp_stage_t, unsigned>>;

/// Vehicles that come every second on the lanes of each stage of the cycle {0, 1, 2, 3}, and leave on green.
struct Flow {
    double veh_per_s[4];

    void second(Street &street) const {
        static const std::vector<LaneName> lanes[4] = {{NL, SL}, {NM, NR, SM, SR}, {EL, WL}, {EM, ER, WM, WR}};
        for (std::size_t i = 0; i < 4; ++i) {
            for (const LaneName lane : lanes[i]) {
                street.queue[lane] -= street.is_going(lane) ? std::min(0.5F, street.queue[lane]) : 0.0F;
                street.come(lane, static_cast<float>(veh_per_s[i]));
            }
        }
    }
};

Shown shown_in(Street &street, const Flow &flow, unsigned seconds) {
    Shown shown;
    for (unsigned t = 0; t < seconds; ++t) {
        flow.second(street);
        const elmopp_stage_t stage = street.second();
        if (shown.empty() || shown.back().first != stage) {
            shown.emplace_back(stage, 0U);
        }
        ++shown.back().second;
    }
    return shown;
}

void expect_greens(const Shown &shown, std::size_t from, std::initializer_list<unsigned> greens_s) {
    std::size_t i = from;
    for (const unsigned green_s : greens_s) {
        TEST_ASSERT_EQUAL_UINT_MESSAGE(i % 4, shown.at(i).first, std::to_string(i).c_str());
        TEST_ASSERT_EQUAL_UINT_MESSAGE(green_s, shown.at(i).second, std::to_string(i).c_str());
        ++i;
    }
}

// --- what they share ---

void test_a_change_costs_the_longest_intergreen_and_startup_of_what_is_new() {
    TEST_ASSERT_EQUAL_DOUBLE(1.5, switch_s(elmopp_site_paper, 0, 1));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, switch_s(elmopp_site_paper, 0, 0));
    TEST_ASSERT_EQUAL_DOUBLE(1.5, switch_s(elmopp_site_paper, ELMOPP_STAGE_NONE, 1));
    TEST_ASSERT_EQUAL_DOUBLE(5.0, change_s(elmopp_site_one_way, 0, 1));
    TEST_ASSERT_EQUAL_DOUBLE(7.0, switch_s(elmopp_site_one_way, 0, 1));
    TEST_ASSERT_EQUAL_UINT(5, min_green_s(elmopp_site_one_way, 0));
    TEST_ASSERT_EQUAL_UINT(1, min_green_s(elmopp_site_paper, 0));
}

void test_a_round_loses_every_change() {
    Cycle cycle;
    cycle.prepare(elmopp_site_paper);
    TEST_ASSERT_EQUAL_UINT(4, cycle.size());
    TEST_ASSERT_EQUAL_DOUBLE(6.0, cycle.lost_s(elmopp_site_paper));
    TEST_ASSERT_EQUAL_UINT(0, cycle.stage(4));
}

void test_the_cycle_is_a_smallest_one() {
    const std::pair<const elmopp_junction_t *, std::size_t> sizes[] = {
        {&elmopp_site_four_way, 4}, {&elmopp_site_three_way, 3},  {&elmopp_site_five_way, 5},
        {&elmopp_site_one_way, 2},  {&elmopp_site_left_lanes, 3}, {&elmopp_site_shared_lanes, 2}};
    for (const auto &[site, size] : sizes) {
        Cycle cycle;
        cycle.prepare(*site);
        TEST_ASSERT_EQUAL_UINT_MESSAGE(size, cycle.size(), site->name);
        std::uint32_t served = 0;
        for (std::size_t i = 0; i < cycle.size(); ++i) {
            served |= served_by(*site, cycle.stage(i));
        }
        TEST_ASSERT_EQUAL_UINT32_MESSAGE((1U << site->movement_count) - 1U, served, site->name);
    }
}

void test_flow_ratios_are_those_of_the_critical_movement() {
    Cycle cycle;
    cycle.prepare(elmopp_site_paper);
    elmopp_junction_t junction = elmopp_site_paper;
    junction.discharge = ELMOPP_DISCHARGE_SATURATION;
    std::vector<double> flows(12, 0.05);
    flows[SL] = 0.2;
    const auto ratios = flow_ratios(cycle, junction, flows);
    TEST_ASSERT_EQUAL_DOUBLE(0.4, ratios[0]);
    TEST_ASSERT_EQUAL_DOUBLE(0.1, ratios[1]);
}

// A movement of several stages needs green in all of them together, beyond what the others need anyway.
void test_flow_ratios_give_a_movement_of_several_stages_what_it_needs() {
    for (const auto *site : {&elmopp_site_three_way, &elmopp_site_four_way, &elmopp_site_five_way}) {
        Cycle cycle;
        cycle.prepare(*site);
        std::vector<double> flows(site->movement_count);
        for (std::size_t j = 0; j < flows.size(); ++j) {
            flows[j] = 0.02 * static_cast<double>(j % 4 + 1);
        }
        const auto ratios = flow_ratios(cycle, *site, flows);
        for (std::uint32_t j = 0; j < site->movement_count; ++j) {
            double served = 0.0;
            for (std::size_t i = 0; i < cycle.size(); ++i) {
                served += elmopp_mask_has(served_by(*site, cycle.stage(i)), j) ? ratios[i] : 0.0;
            }
            TEST_ASSERT_TRUE(served >= flows[j] / saturation_veh_per_s(*site, j) - 1e-9);
        }
    }
}

/// Observes what somebody sees who is asked with these counts.
struct Observer {
    Approaching approaching{everywhere(3)};

    elmopp_stage_t choose(const elmopp_view_t &view, float * /*score*/) {
        approaching.observe(view);
        return 0;
    }
};

void expect_queued(Street &street, Observer &observer, double queued, double soon, double later) {
    (void)street.second();
    TEST_ASSERT_EQUAL_DOUBLE(queued, observer.approaching.queued_veh(EL));
    TEST_ASSERT_EQUAL_DOUBLE(soon, observer.approaching.due_within_veh(EL, 1));
    TEST_ASSERT_EQUAL_DOUBLE(later, observer.approaching.due_within_veh(EL, 99));
}

void test_vehicles_are_on_their_way_for_the_travel_time() {
    Observer observer;
    Street street(plug(observer));
    street.queue[EL] = 2.0F; // there from the start: queued
    street.come(EL, 1.0F);
    expect_queued(street, observer, 2.0, 0.0, 1.0);
    street.come(EL, 4.0F);
    expect_queued(street, observer, 2.0, 0.0, 5.0);
    expect_queued(street, observer, 2.0, 1.0, 5.0);
    expect_queued(street, observer, 3.0, 4.0, 4.0);
    expect_queued(street, observer, 7.0, 0.0, 0.0);
}

void test_who_has_left_early_was_the_oldest() {
    Observer observer;
    Street street(plug(observer));
    expect_queued(street, observer, 0.0, 0.0, 0.0);
    street.come(EL, 2.0F);
    expect_queued(street, observer, 0.0, 0.0, 2.0);
    street.come(EL, 3.0F);
    street.queue[EL] = 4.0F; // one has gone, and there is no queue it could be from
    expect_queued(street, observer, 0.0, 0.0, 4.0);
    expect_queued(street, observer, 0.0, 1.0, 4.0);
    expect_queued(street, observer, 1.0, 3.0, 3.0);
}

// --- webster ---

constexpr Flow uneven{{0.1, 0.05, 0.05, 0.1}};

void test_webster_begins_with_equal_greens_and_then_has_the_formulas() {
    Webster rule{20, 30, 120};
    Street street(plug(rule));
    const auto shown = shown_in(street, uneven, 400);
    expect_greens(shown, 0, {20, 20, 20, 20, 20, 20, 20, 20});
    // Y = 0.6, C = (1.5 * 6 + 5) / 0.4 = 35; 29 s in proportion to 2 1 1 2, and 1.5 s of start-up each.
    expect_greens(shown, 8, {11, 6, 6, 11, 11, 6, 6, 11});
}

void test_webster_keeps_the_cycle_within_its_bounds() {
    Webster longest{20, 30, 120};
    Street busy(plug(longest));
    // Y is far above 1: 120 s, of which 114 are shared.
    expect_greens(shown_in(busy, {{0.3, 0.3, 0.3, 0.3}}, 400), 8, {30, 30, 30, 30});
    Webster shortest{20, 30, 120};
    Street calm(plug(shortest));
    expect_greens(shown_in(calm, {{0.01, 0.01, 0.01, 0.01}}, 400), 8, {8, 8, 8, 8}); // 24 / 4 + 1.5, rounded
}

void test_webster_is_fixed_after_15_minutes() {
    Webster rule{20, 30, 120};
    Street street(plug(rule));
    (void)shown_in(street, uneven, 1000);
    TEST_ASSERT_TRUE(rule.settled);
    const auto later = shown_in(street, {{0.02, 0.3, 0.02, 0.02}}, 400);
    TEST_ASSERT_EQUAL_UINT(later.at(4).second, later.at(8).second);
    TEST_ASSERT_TRUE((rule.greens_s == std::vector<unsigned>{11, 6, 6, 11}));
}

template <typename Rule> void expect_goes_on_after_a_forced_stage(Rule rule, const char *name) {
    Street street(plug(rule));
    TEST_ASSERT_EQUAL_UINT_MESSAGE(0, street.second(), name);
    while (street.second() != 1) { // to the second stage of the cycle
    }
    (void)street.second();
    street.force(5); // not in the cycle
    unsigned seconds = 0;
    elmopp_stage_t next = 5;
    while (next == 5 && seconds < 100) {
        next = street.second();
        ++seconds;
    }
    TEST_ASSERT_EQUAL_UINT_MESSAGE(2, next, name);
    TEST_ASSERT_EQUAL_UINT_MESSAGE(1, seconds, name); // its minimum green
    street.force(0);
    while ((next = street.second()) == 0) {
    }
    TEST_ASSERT_EQUAL_UINT_MESSAGE(1, next, name);
    for (unsigned second = 0; second < 200; ++second) {
        TEST_ASSERT_EQUAL_UINT_MESSAGE(1, street.hidden_second(), name);
    }
}

void test_cycles_go_on_after_a_forced_stage() {
    expect_goes_on_after_a_forced_stage(Webster{20, 30, 120}, "webster");
    expect_goes_on_after_a_forced_stage(Scats{40, 70, 120}, "scats");
    expect_goes_on_after_a_forced_stage(Scoot{120, 0.9}, "scoot");
}

// --- scats ---

void test_scats_shortens_an_empty_cycle_by_its_smoothed_steps() {
    Scats rule{40, 70, 120};
    Street street(plug(rule));
    // 64 s shared by four and 1.5 s each: 17.5, rounded to 18; a round is 72 s, and 40 s are wanted.
    expect_greens(shown_in(street, {{0.0, 0.0, 0.0, 0.0}}, 72), 0, {18, 18, 18, 18});
    (void)street.second();
    // |40 - 70| = 30 becomes 11.5: 58.5; smoothed 0.45 * 58.5 + 0.55 * 70.
    TEST_ASSERT_EQUAL_DOUBLE(64.825, rule.cycle_s);
    (void)shown_in(street, {{0.0, 0.0, 0.0, 0.0}}, 72);
    TEST_ASSERT_DOUBLE_WITHIN(0.001, 59.283, rule.cycle_s);
    (void)shown_in(street, {{0.0, 0.0, 0.0, 0.0}}, 2000);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 40.0, rule.cycle_s);
}

void test_scats_lengthens_a_saturated_cycle_and_shares_it_by_saturation() {
    Scats rule{40, 70, 120};
    Street street(plug(rule));
    (void)shown_in(street, {{0.2, 0.05, 0.05, 0.05}}, 3000);
    TEST_ASSERT_TRUE(rule.cycle_s > 80.0);
    TEST_ASSERT_TRUE(rule.greens_s[0] > rule.greens_s[1] + 10);
    TEST_ASSERT_EQUAL_UINT(rule.greens_s[1], rule.greens_s[2]);
}

void test_scats_library_has_no_plan_twice() {
    Scats rule{40, 70, 120};
    Street street(plug(rule));
    (void)street.second();
    TEST_ASSERT_EQUAL_UINT(81 - 2, rule.library.size()); // 2 2 2 2 and 3 3 3 3 are 1 1 1 1
}

// --- scoot ---

void test_scoot_shortens_an_empty_cycle_and_no_green_below_its_minimum() {
    Scoot rule{120, 0.9};
    Street street(plug(rule));
    (void)street.second();
    TEST_ASSERT_TRUE((rule.greens_s == std::vector<unsigned>{18, 18, 18, 18}));
    (void)shown_in(street, {{0.0, 0.0, 0.0, 0.0}}, 370); // the first round that ends after 300 s
    TEST_ASSERT_TRUE((rule.greens_s == std::vector<unsigned>{16, 16, 16, 16}));
    (void)shown_in(street, {{0.0, 0.0, 0.0, 0.0}}, 6000);
    TEST_ASSERT_TRUE((rule.greens_s == std::vector<unsigned>{5, 5, 5, 5}));
}

void test_scoot_moves_green_to_where_it_is_saturated() {
    Scoot rule{120, 0.9};
    Street street(plug(rule));
    const auto shown = shown_in(street, {{0.2, 0.03, 0.03, 0.03}}, 290);
    // The first change comes 4 s late, and a second of it stays.
    TEST_ASSERT_EQUAL_UINT(22, shown.at(0).second);
    // The second stage begins 3 s later than planned and itself ends 4 s early: 18 - 1 - 3 - 4.
    TEST_ASSERT_EQUAL_UINT(10, shown.at(1).second);
    (void)shown_in(street, {{0.2, 0.03, 0.03, 0.03}}, 3000);
    TEST_ASSERT_TRUE(rule.greens_s[0] > 2 * rule.greens_s[1]);
    const unsigned sum_s = std::accumulate(rule.greens_s.begin(), rule.greens_s.end(), 0U);
    TEST_ASSERT_TRUE(sum_s <= 120);
}

void test_scoot_lengthens_a_saturated_cycle_up_to_its_bound() {
    Scoot rule{120, 0.9};
    Street street(plug(rule));
    (void)shown_in(street, {{0.2, 0.2, 0.2, 0.2}}, 380);
    TEST_ASSERT_EQUAL_UINT(80, std::accumulate(rule.greens_s.begin(), rule.greens_s.end(), 0U));
    (void)shown_in(street, {{0.2, 0.2, 0.2, 0.2}}, 3000);
    TEST_ASSERT_EQUAL_UINT(120, std::accumulate(rule.greens_s.begin(), rule.greens_s.end(), 0U));
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_a_change_costs_the_longest_intergreen_and_startup_of_what_is_new);
    RUN_TEST(test_a_round_loses_every_change);
    RUN_TEST(test_the_cycle_is_a_smallest_one);
    RUN_TEST(test_flow_ratios_are_those_of_the_critical_movement);
    RUN_TEST(test_flow_ratios_give_a_movement_of_several_stages_what_it_needs);
    RUN_TEST(test_vehicles_are_on_their_way_for_the_travel_time);
    RUN_TEST(test_who_has_left_early_was_the_oldest);
    RUN_TEST(test_webster_begins_with_equal_greens_and_then_has_the_formulas);
    RUN_TEST(test_webster_keeps_the_cycle_within_its_bounds);
    RUN_TEST(test_webster_is_fixed_after_15_minutes);
    RUN_TEST(test_cycles_go_on_after_a_forced_stage);
    RUN_TEST(test_scats_shortens_an_empty_cycle_by_its_smoothed_steps);
    RUN_TEST(test_scats_lengthens_a_saturated_cycle_and_shares_it_by_saturation);
    RUN_TEST(test_scats_library_has_no_plan_twice);
    RUN_TEST(test_scoot_shortens_an_empty_cycle_and_no_green_below_its_minimum);
    RUN_TEST(test_scoot_moves_green_to_where_it_is_saturated);
    RUN_TEST(test_scoot_lengthens_a_saturated_cycle_up_to_its_bound);
    return UNITY_END();
}
