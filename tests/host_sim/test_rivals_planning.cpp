// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The rivals that plan a green or a round: itlc-rounds, actuated, surtrac and self-control. Asked with a view made by
/// hand; the paper's site with 0.5 vehicle/s a lane, so that n vehicles take 2 n seconds and a change of stage
/// costs 1.5.

#include "actuated.hpp"
#include "rounds.hpp"
#include "self_control.hpp"
#include "street.hpp"
#include "surtrac.hpp"

#include <random>

using namespace elmopp;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

namespace {

// --- itlc-rounds ---

void test_itlc_rounds_serves_every_movement_once_a_round_densest_first() {
    ItlcRounds rule{ready_unlimited};
    Street street(plug(rule));
    street.queue[EL] = 20.0F;
    street.queue[NL] = 10.0F;
    street.queue[WM] = 5.0F;
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    TEST_ASSERT_EQUAL_UINT(42, street.seconds_until_change()); // 1.5 + 20 / 0.5
    TEST_ASSERT_EQUAL_UINT(0, street.second());
    TEST_ASSERT_EQUAL_UINT(21, street.seconds_until_change()); // 1.5 + 10 / 0.5 = 21.5, one second of it is over
    TEST_ASSERT_EQUAL_UINT(3, street.second());
    TEST_ASSERT_EQUAL_UINT(11, street.seconds_until_change()); // 1.5 + 5 / 0.5 = 11.5
    TEST_ASSERT_EQUAL_UINT(2, street.second());                // the next round
}

void test_itlc_rounds_rests_where_nobody_is() {
    ItlcRounds rule{ready_unlimited};
    Street street(plug(rule));
    TEST_ASSERT_EQUAL_UINT(0, street.second());
    TEST_ASSERT_EQUAL_UINT(0, street.seconds_until_change());
    street.queue[WM] = 1.0F;
    TEST_ASSERT_EQUAL_UINT(3, street.second());
}

void test_itlc_rounds_takes_a_forced_stage_as_served() {
    ItlcRounds rule{ready_unlimited};
    Street street(plug(rule));
    street.queue[EL] = 20.0F;
    street.queue[NL] = 10.0F;
    street.queue[WM] = 15.0F;
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    street.force(3);
    TEST_ASSERT_EQUAL_UINT(30, street.seconds_until_change()); // 15 / 0.5, nothing lost
    TEST_ASSERT_EQUAL_UINT(0, street.second());                // N.L: E.L and W.M have had theirs
}

void test_itlc_rounds_waits_for_the_farthest() {
    ItlcRounds rule{ready_unlimited, Approaching(everywhere(12))};
    Street street(plug(rule));
    street.come(EL, 1.0F); // 1.5 + 2 s, but it takes 12 until it is there
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    street.queue[NL] = 5.0F;
    TEST_ASSERT_EQUAL_UINT(12, street.seconds_until_change());
}

// --- actuated ---

void test_actuated_ends_at_the_gap_and_skips_whom_nobody_calls() {
    Actuated rule{5, 60, 3};
    Street street(plug(rule));
    street.queue[EL] = 5.0F;
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    street.queue[NL] = 1.0F;
    for (unsigned second = 0; second < 20; ++second) {
        TEST_ASSERT_EQUAL_UINT(2, street.second());
    }
    street.queue[EL] = 0.5F; // no vehicle
    TEST_ASSERT_EQUAL_UINT(0, street.second());
}

void test_actuated_keeps_its_minimum() {
    Actuated rule{5, 60, 3};
    Street street(plug(rule));
    street.queue[EL] = 1.0F;
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    street.queue[EL] = 0.0F;
    street.queue[NL] = 1.0F;
    TEST_ASSERT_EQUAL_UINT(5, street.seconds_until_change());
}

void test_actuated_maximum_counts_from_the_first_conflicting_call() {
    Actuated rule{5, 60, 3};
    Street street(plug(rule));
    street.queue[EL] = 90.0F;
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    for (unsigned second = 0; second < 100; ++second) {
        TEST_ASSERT_EQUAL_UINT(2, street.second());
    }
    street.queue[NL] = 1.0F;
    TEST_ASSERT_EQUAL_UINT(60, street.seconds_until_change());
}

void test_actuated_rests_without_a_call() {
    Actuated rule{5, 60, 3};
    Street street(plug(rule));
    TEST_ASSERT_EQUAL_UINT(0, street.second());
    TEST_ASSERT_EQUAL_UINT(0, street.seconds_until_change());
    street.force(6);
    TEST_ASSERT_EQUAL_UINT(0, street.seconds_until_change());
}

void test_actuated_lets_a_lane_that_flows_go_on_beside_another() {
    Actuated rule{5, 60, 3};
    Street street(plug(rule));
    street.queue[NL] = 9.0F;
    street.queue[SL] = 9.0F;
    TEST_ASSERT_EQUAL_UINT(0, street.second());
    street.queue[NM] = 2.0F;
    street.queue[EL] = 20.0F;
    for (unsigned second = 0; second < 9; ++second) {
        TEST_ASSERT_EQUAL_UINT(0, street.second());
    }
    street.queue[SL] = 0.0F;
    TEST_ASSERT_EQUAL_UINT(4, street.second()); // N.L goes on, N.M goes too
}

// Greens in turn, not by weight: after stage 0 comes 1, however many wait elsewhere.
void test_actuated_goes_on_in_its_order_after_a_forced_stage() {
    Actuated rule{5, 60, 3};
    Street street(plug(rule));
    street.queue[NL] = 1.0F;
    TEST_ASSERT_EQUAL_UINT(0, street.second());
    street.queue.fill(0.0F);
    street.force(7);
    street.queue[NM] = 1.0F;
    street.queue[EL] = 90.0F;
    TEST_ASSERT_EQUAL_UINT(5, street.seconds_until_change());
    TEST_ASSERT_EQUAL_UINT(1, street.second());
}

void test_actuated_waits_for_whom_it_sees_within_the_gap() {
    Actuated rule{1, 60, 3, Approaching(everywhere(8))};
    Street street(plug(rule));
    street.queue[EL] = 1.0F;
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    street.come(EL, 1.0F); // 8 s away
    (void)street.second();
    street.queue[EL] = 1.0F; // the first has gone
    for (unsigned second = 0; second < 4; ++second) {
        (void)street.second(); // now 3 s away
    }
    street.queue[NL] = 1.0F;
    for (unsigned second = 0; second < 3; ++second) {
        TEST_ASSERT_EQUAL_UINT(2, street.second());
    }
    Actuated other{1, 60, 3, Approaching(everywhere(8))};
    Street later(plug(other));
    later.queue[EL] = 1.0F;
    TEST_ASSERT_EQUAL_UINT(2, later.second());
    later.come(EL, 1.0F);
    (void)later.second();
    later.queue[EL] = 1.0F;
    later.queue[NL] = 1.0F;
    TEST_ASSERT_EQUAL_UINT(0, later.second()); // too far
}

// --- surtrac ---

/// What a schedule of two phases begins with: stage 0, which is shown, and stage 2.
elmopp_stage_t scheduled(const std::vector<Cluster> &present, const std::vector<Cluster> &other, bool leave = false) {
    const Phases phases{{0, 0, present}, {2, 0, other}};
    return first_of_schedule(elmopp_site_paper, 0, phases, leave, 1000).stage;
}

void test_surtrac_first_clears_what_costs_the_others_less() {
    const Cluster ten{0.0, 20.0, 20.0, 0.0, 10.0};
    // Stay: 10 wait 2 + 1.5. Leave: 10 wait 1.5, one waits 1.5 + 20 + 1.5.
    TEST_ASSERT_EQUAL_UINT(0, scheduled({{0.0, 2.0, 2.0, 0.0, 1.0}}, {ten})); // 35 against 38
    TEST_ASSERT_EQUAL_UINT(2, scheduled({{0.0, 4.0, 4.0, 0.0, 1.0}}, {ten})); // 55 against 40
}

void test_surtrac_serves_somebody_before_a_cluster_that_is_still_coming() {
    const Cluster one{0.0, 2.0, 2.0, 0.0, 1.0};
    // Away and back: one waits 1.5, six wait 5 - 3. Stay: one waits 3 + 12 + 1.5.
    TEST_ASSERT_EQUAL_UINT(2, scheduled({{3.0, 15.0, 12.0, 0.0, 6.0}}, {one})); // 13.5 against 16.5
    TEST_ASSERT_EQUAL_UINT(0, scheduled({{1.0, 13.0, 12.0, 0.0, 6.0}}, {one})); // 25.5 against 14.5
}

void test_surtrac_leaves_at_its_maximum_if_somebody_is_there() {
    const Cluster one{0.0, 2.0, 2.0, 0.0, 1.0};
    TEST_ASSERT_EQUAL_UINT(2, scheduled({{0.0, 2.0, 2.0, 0.0, 9.0}}, {one}, true));
    TEST_ASSERT_EQUAL_UINT(0, scheduled({{0.0, 2.0, 2.0, 0.0, 9.0}}, {}, true));
    TEST_ASSERT_EQUAL_UINT(ELMOPP_STAGE_NONE, scheduled({}, {}));
}

/// Cost of the cheapest order, by trying all.
double cheapest_order(const Phases &phases, std::vector<std::size_t> done, elmopp_stage_t last, double now_s) {
    double best = -1.0;
    for (std::size_t p = 0; p < phases.size(); ++p) {
        if (done[p] == phases[p].clusters.size()) {
            continue;
        }
        const auto &cluster = phases[p].clusters[done[p]];
        const double start_s = std::max(cluster.arrival_s, now_s + (phases[p].stage == last ? 0.0 : 1.5));
        const double end_s = std::max(start_s + cluster.length_s, cluster.departure_s);
        auto after = done;
        ++after[p];
        const double cost =
            cluster.vehicles * (start_s - cluster.arrival_s) + cheapest_order(phases, after, phases[p].stage, end_s);
        best = best < 0.0 || cost < best ? cost : best;
    }
    return std::max(best, 0.0);
}

// One state is kept where two might be needed, so the programme may miss the best by a little, and never beats it.
void test_surtrac_is_as_good_as_trying_every_order() {
    std::mt19937_64 random(5);
    double found_sum = 0.0;
    double best_sum = 0.0;
    for (unsigned round = 0; round < 60; ++round) {
        Phases phases{{0, 0}, {1, 0}, {2, 0}};
        for (auto &phase : phases) {
            double at_s = 0.0;
            for (unsigned i = 0; i < 2; ++i) {
                at_s += static_cast<double>(random() % 20);
                const double length_s = 1.0 + static_cast<double>(random() % 10);
                phase.clusters.push_back(
                    {at_s, at_s + length_s, length_s, 0.0, 1.0 + static_cast<double>(random() % 9)});
                at_s += length_s + 3.0;
            }
        }
        const double found = first_of_schedule(elmopp_site_paper, 0, phases, false, 1000).cost_veh_s;
        const double best = cheapest_order(phases, {0, 0, 0}, 0, 0.0);
        TEST_ASSERT_TRUE(found >= best - 1e-9);
        found_sum += found;
        best_sum += best;
    }
    TEST_ASSERT_TRUE(found_sum < 1.02 * best_sum);
}

void test_surtrac_knows_every_smallest_cycle() {
    const auto ways = ways_to_serve_all(elmopp_site_paper);
    TEST_ASSERT_EQUAL_UINT(4, ways.size()); // north and south opposing or one by one, east and west likewise
    for (const auto *site : {&elmopp_site_three_way, &elmopp_site_four_way, &elmopp_site_five_way}) {
        for (const auto &phases : ways_to_serve_all(*site)) {
            std::uint32_t all = 0;
            for (const auto &phase : phases) {
                TEST_ASSERT_EQUAL_UINT32(0, all & phase.movements);
                all |= phase.movements;
            }
            TEST_ASSERT_EQUAL_UINT32((1U << site->movement_count) - 1U, all);
        }
    }
}

void test_surtrac_serves_whom_it_sees_and_stays_where_nobody_is() {
    Surtrac rule{5, 60, 3, 60};
    Street street(plug(rule));
    TEST_ASSERT_EQUAL_UINT(0, street.second());
    TEST_ASSERT_EQUAL_UINT(0, street.seconds_until_change());
    street.queue[WM] = 3.0F;
    street.queue[EM] = 3.0F;
    TEST_ASSERT_EQUAL_UINT(3, street.second());
    street.queue.fill(0.0F);
    street.queue[NL] = 4.0F;
    TEST_ASSERT_EQUAL_UINT(5, street.seconds_until_change());
    street.force(6);
    TEST_ASSERT_EQUAL_UINT(5, street.seconds_until_change());
}

void test_surtrac_takes_turns_at_its_maximum() {
    Surtrac rule{5, 60, 3, 60};
    Street street(plug(rule));
    street.queue[NL] = 99.0F;
    street.queue[SL] = 99.0F;
    TEST_ASSERT_EQUAL_UINT(0, street.second());
    street.queue[EL] = 1.0F;
    street.queue[NL] = 1.0F;
    street.queue[SL] = 1.0F;
    const unsigned seconds = street.seconds_until_change();
    TEST_ASSERT_TRUE(seconds >= 5 && seconds <= 60);
}

// --- self-control ---

void test_self_control_index_is_vehicles_for_each_second_of_change_and_green() {
    SelfControl rule{5, 60, 90};
    Street street(plug(rule));
    street.queue[EL] = 10.0F;
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    TEST_ASSERT_FLOAT_WITHIN(1e-5F, 10.0F / 21.5F, street.score[2]); // 1.5 + 20
    street.queue[NL] = 10.0F;
    (void)street.second();
    TEST_ASSERT_FLOAT_WITHIN(1e-5F, 10.0F / 20.0F, street.score[2]); // nothing to wait for
    TEST_ASSERT_FLOAT_WITHIN(1e-5F, 10.0F / 23.0F, street.score[0]); // and 1.5 to come back
}

void test_self_control_clears_its_queue_and_leaves() {
    SelfControl rule{5, 300, 600};
    Street street(plug(rule));
    street.queue[EL] = 10.0F;
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    street.queue[NL] = 1.0F;
    TEST_ASSERT_EQUAL_UINT(0, street.seconds_until_change()); // as long as it has some, and nobody is late
    street.queue[EL] = 0.0F;
    TEST_ASSERT_EQUAL_UINT(0, street.second());
    street.queue[NL] = 0.0F;
    TEST_ASSERT_EQUAL_UINT(0, street.seconds_until_change()); // nobody anywhere: it stays
    street.force(3);
    street.queue[NL] = 1.0F;
    TEST_ASSERT_EQUAL_UINT(5, street.seconds_until_change());
}

void test_self_control_serves_somebody_who_is_late_before_all_others() {
    SelfControl rule{5, 60, 90};
    Street street(plug(rule));
    for (const LaneName lane : {EM, ER, WM, WR}) {
        street.queue[lane] = 50.0F;
    }
    TEST_ASSERT_EQUAL_UINT(3, street.second());
    street.queue[NL] = 1.0F;
    // One vehicle in a period: it may be 60 s apart, less 1.5 of start-up and 2 of crossing.
    TEST_ASSERT_EQUAL_UINT(57, street.seconds_until_change());
    TEST_ASSERT_TRUE(rule.urgent.front().movement == NL);
    for (unsigned second = 0; second < 4; ++second) {
        TEST_ASSERT_EQUAL_UINT(0, street.second());
    }
    street.queue[NL] = 0.0F; // cleared
    TEST_ASSERT_EQUAL_UINT(3, street.second());
}

void test_self_control_gives_a_late_one_no_more_than_its_share() {
    SelfControl rule{5, 60, 90};
    Street street(plug(rule));
    street.queue[EM] = 50.0F;
    street.queue[WM] = 50.0F;
    street.queue[ER] = 50.0F;
    TEST_ASSERT_EQUAL_UINT(3, street.second());
    street.queue[NL] = 30.0F; // far more than come in a period: late at once
    TEST_ASSERT_EQUAL_UINT(5, street.seconds_until_change());
    TEST_ASSERT_TRUE(rule.urgent.front().movement == NL);
    const unsigned green_s = street.seconds_until_change(); // without flow a twelfth of 60 s
    TEST_ASSERT_TRUE(green_s >= 5 && green_s <= 7);
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_itlc_rounds_serves_every_movement_once_a_round_densest_first);
    RUN_TEST(test_itlc_rounds_rests_where_nobody_is);
    RUN_TEST(test_itlc_rounds_takes_a_forced_stage_as_served);
    RUN_TEST(test_itlc_rounds_waits_for_the_farthest);
    RUN_TEST(test_actuated_ends_at_the_gap_and_skips_whom_nobody_calls);
    RUN_TEST(test_actuated_keeps_its_minimum);
    RUN_TEST(test_actuated_maximum_counts_from_the_first_conflicting_call);
    RUN_TEST(test_actuated_rests_without_a_call);
    RUN_TEST(test_actuated_lets_a_lane_that_flows_go_on_beside_another);
    RUN_TEST(test_actuated_goes_on_in_its_order_after_a_forced_stage);
    RUN_TEST(test_actuated_waits_for_whom_it_sees_within_the_gap);
    RUN_TEST(test_surtrac_first_clears_what_costs_the_others_less);
    RUN_TEST(test_surtrac_serves_somebody_before_a_cluster_that_is_still_coming);
    RUN_TEST(test_surtrac_leaves_at_its_maximum_if_somebody_is_there);
    RUN_TEST(test_surtrac_is_as_good_as_trying_every_order);
    RUN_TEST(test_surtrac_knows_every_smallest_cycle);
    RUN_TEST(test_surtrac_serves_whom_it_sees_and_stays_where_nobody_is);
    RUN_TEST(test_surtrac_takes_turns_at_its_maximum);
    RUN_TEST(test_self_control_index_is_vehicles_for_each_second_of_change_and_green);
    RUN_TEST(test_self_control_clears_its_queue_and_leaves);
    RUN_TEST(test_self_control_serves_somebody_who_is_late_before_all_others);
    RUN_TEST(test_self_control_gives_a_late_one_no_more_than_its_share);
    return UNITY_END();
}
