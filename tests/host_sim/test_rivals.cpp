// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// ITLC, OAF and fixed times, each asked second by second with a view made by hand: the paper's site with 0.5 vehicle/s
/// a lane, so that n vehicles take 2 n seconds and a change of stage costs 1.5.

#include "cyclic.hpp"
#include "expect.hpp"
#include "rounds.hpp"
#include "street.hpp"

using namespace elmopp;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

namespace {

/// ITLC's green for this many vehicles on E.L as the first stage; then all are gone and N.L has some, so it leaves.
unsigned first_itlc_green(float vehicles, double ready, int discharge = ELMOPP_DISCHARGE_SATURATION) {
    Itlc itlc{ready};
    Street street(plug(itlc), discharge);
    street.queue[EL] = vehicles;
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    street.queue.fill(0.0F);
    street.queue[NL] = 5.0F;
    return street.seconds_until_change();
}

void test_itlc_green_is_startup_and_the_crossing_of_the_last_ready_vehicle() {
    TEST_ASSERT_EQUAL_UINT(22, first_itlc_green(10.0F, 30.0)); // 1.5 + 10 / 0.5 = 21.5
    TEST_ASSERT_EQUAL_UINT(12, first_itlc_green(10.0F, 5.0));  // 1.5 + 5 / 0.5 = 11.5
    TEST_ASSERT_EQUAL_UINT(60, first_itlc_green(29.25F, 30.0));
    TEST_ASSERT_EQUAL_UINT(59, first_itlc_green(28.75F, 30.0));
    // Greenshields: 66.67 vehicles leave at 1.6 a second; 30 / 1.6 + 1.5 = 20.25.
    TEST_ASSERT_EQUAL_UINT(21, first_itlc_green(200.0F / 3.0F, 30.0, ELMOPP_DISCHARGE_GREENSHIELDS));
}

void test_itlc_green_is_clamped_to_5_and_60() {
    TEST_ASSERT_EQUAL_UINT(5, first_itlc_green(1.0F, 30.0)); // 3.5
    TEST_ASSERT_EQUAL_UINT(6, first_itlc_green(2.0F, 30.0)); // 5.5
    TEST_ASSERT_EQUAL_UINT(60, first_itlc_green(200.0F, ready_unlimited));
    // A full lane stands under Greenshields: its last vehicle never crosses.
    TEST_ASSERT_EQUAL_UINT(60, first_itlc_green(1000.0F / 3.0F, 30.0, ELMOPP_DISCHARGE_GREENSHIELDS));
}

void test_itlc_takes_the_slowest_lane_of_the_stage() {
    Itlc itlc{30.0};
    Street street(plug(itlc));
    street.queue[NL] = 3.0F;
    street.queue[SL] = 9.0F;
    TEST_ASSERT_EQUAL_UINT(0, street.second());
    street.queue.fill(0.0F);
    street.queue[WM] = 3.0F;
    TEST_ASSERT_EQUAL_UINT(20, street.seconds_until_change()); // 1.5 + 9 / 0.5 = 19.5
}

void test_itlc_may_follow_itself_without_startup() {
    Itlc itlc{30.0};
    Street street(plug(itlc));
    street.queue[EL] = 10.0F;
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    for (unsigned second = 0; second < 22; ++second) { // the 22nd second decides anew, for the same stage
        TEST_ASSERT_EQUAL_UINT(2, street.second());
    }
    street.queue[EL] = 0.0F;
    street.queue[NL] = 4.0F;
    TEST_ASSERT_EQUAL_UINT(20, street.seconds_until_change()); // 10 / 0.5, nothing lost
}

void test_itlc_counts_the_ready_area_only() {
    Itlc itlc{30.0};
    Street street(plug(itlc));
    street.queue[NL] = 100.0F; // 30 are ready
    street.queue[EL] = 16.0F;
    street.queue[WL] = 15.0F; // 31
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    TEST_ASSERT_EQUAL_FLOAT(30.0F, street.score[0]);
    TEST_ASSERT_EQUAL_FLOAT(31.0F, street.score[2]);
    TEST_ASSERT_EQUAL_FLOAT(30.0F, street.score[4]);
    TEST_ASSERT_EQUAL_FLOAT(16.0F, street.score[5]);
    Itlc far{ready_unlimited};
    Street other(plug(far));
    other.queue = street.queue;
    TEST_ASSERT_EQUAL_UINT(0, other.second());
    TEST_ASSERT_EQUAL_FLOAT(100.0F, other.score[0]);
}

void test_itlc_tie_goes_to_the_lowest_stage() {
    Itlc itlc{30.0};
    Street street(plug(itlc));
    street.queue[ER] = 4.0F;
    street.queue[SR] = 4.0F; // stages 1, 3, 5 and 6
    TEST_ASSERT_EQUAL_UINT(1, street.second());
}

void test_itlc_green_does_not_run_in_the_intergreen() {
    Itlc itlc{30.0};
    Street street(plug(itlc));
    street.queue[EL] = 4.0F; // 9.5: 10 s
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    street.queue.fill(0.0F);
    street.queue[NL] = 4.0F;
    for (unsigned second = 0; second < 30; ++second) {
        TEST_ASSERT_EQUAL_UINT(2, street.hidden_second());
    }
    TEST_ASSERT_EQUAL_UINT(10, street.seconds_until_change());
}

/// Second 0: a vehicle on N.L gets stage 0 for 1.5 + 2 s, that is until second 4, and is gone in second 1.
void begin_with_north_left(Street &street) {
    street.come(NL, 1.0F);
    TEST_ASSERT_EQUAL_UINT(0, street.second());
    street.clear(NL);
}

void wait_for(Street &street, unsigned seconds, elmopp_stage_t shown) {
    for (unsigned i = 0; i < seconds; ++i) {
        TEST_ASSERT_EQUAL_UINT(shown, street.second());
    }
}

/// OAF's green for this many vehicles on E.L after a change of stage.
unsigned oaf_green(float vehicles, double platoon, int discharge = ELMOPP_DISCHARGE_SATURATION) {
    Oaf oaf{platoon, 0, 0.0, {}};
    Street street(plug(oaf), discharge);
    if (discharge == ELMOPP_DISCHARGE_SATURATION) {
        begin_with_north_left(street);
        street.come(EL, vehicles);
        wait_for(street, 3, 0);
    } else {
        TEST_ASSERT_EQUAL_UINT(0, street.second()); // nobody yet: 1.5 s, rounded up
        street.come(EL, vehicles);
        wait_for(street, 1, 0);
    }
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    street.clear(EL);
    street.come(NL, 5.0F);
    return street.seconds_until_change();
}

void test_oaf_green_is_startup_and_one_platoon() {
    TEST_ASSERT_EQUAL_UINT(22, oaf_green(25.0F, 10.0)); // 1.5 + 10 / 0.5
    TEST_ASSERT_EQUAL_UINT(8, oaf_green(3.0F, 10.0));   // 1.5 + 3 / 0.5
    TEST_ASSERT_EQUAL_UINT(6, oaf_green(25.0F, 2.0));
    TEST_ASSERT_EQUAL_UINT(60, oaf_green(100.0F, 40.0));
    // 66.67 vehicles leave at 1.6 a second: 1.5 + 10 / 1.6 = 7.75.
    TEST_ASSERT_EQUAL_UINT(8, oaf_green(200.0F / 3.0F, 10.0, ELMOPP_DISCHARGE_GREENSHIELDS));
}

void test_oaf_same_stage_pays_no_startup() {
    Oaf oaf{10.0, 0, 0.0, {}};
    Street street(plug(oaf));
    begin_with_north_left(street);
    street.come(EL, 50.0F);
    wait_for(street, 3, 0);
    wait_for(street, 22, 2);
    TEST_ASSERT_EQUAL_UINT(2, street.second()); // decides anew, for the same stage
    street.clear(EL);
    street.come(NL, 5.0F);
    TEST_ASSERT_EQUAL_UINT(20, street.seconds_until_change());
}

void test_oaf_serves_the_oldest_head() {
    Oaf oaf{10.0, 0, 0.0, {}};
    Street street(plug(oaf));
    begin_with_north_left(street);
    street.come(WM, 2.0F); // second 1
    wait_for(street, 1, 0);
    street.come(EL, 90.0F); // second 2: more, but later
    wait_for(street, 2, 0);
    TEST_ASSERT_EQUAL_UINT(3, street.second());
}

void test_oaf_oldest_head_picks_among_its_stages_the_oldest_heads() {
    for (const bool opposite : {true, false}) {
        Oaf oaf{10.0, 0, 0.0, {}};
        Street street(plug(oaf));
        begin_with_north_left(street);
        street.come(EL, 5.0F); // second 1: age 3 in second 4, when the decision falls
        wait_for(street, 1, 0);
        street.come(opposite ? WL : EM, 5.0F); // second 2: age 2
        wait_for(street, 1, 0);
        street.come(opposite ? ER : WL, 50.0F); // second 3: age 1
        wait_for(street, 1, 0);
        TEST_ASSERT_EQUAL_UINT(opposite ? 2 : 5, street.second());
        TEST_ASSERT_EQUAL_FLOAT(opposite ? 5.0F : 4.0F, street.score[2]);
        TEST_ASSERT_EQUAL_FLOAT(opposite ? 4.0F : 5.0F, street.score[5]);
        TEST_ASSERT_EQUAL_FLOAT(0.0F, street.score[3]); // serves others, but not the oldest
        TEST_ASSERT_EQUAL_FLOAT(0.0F, street.score[7]);
    }
}

void test_oaf_equal_heads_go_to_the_lowest_lane_and_stage() {
    Oaf oaf{10.0, 0, 0.0, {}};
    Street street(plug(oaf));
    begin_with_north_left(street);
    street.come(SR, 9.0F);
    street.come(EM, 3.0F); // lane 4 before lane 8, stage 3 before 5
    wait_for(street, 3, 0);
    TEST_ASSERT_EQUAL_UINT(3, street.second());
}

void test_oaf_head_ages_by_first_come_first_served() {
    Oaf oaf{10.0, 0, 0.0, {}};
    Street street(plug(oaf));
    begin_with_north_left(street);
    street.come(EL, 5.0F); // second 1
    wait_for(street, 1, 0);
    street.come(EL, 5.0F); // second 2
    wait_for(street, 1, 0);
    TEST_ASSERT_EQUAL_UINT(0, street.second());
    TEST_ASSERT_EQUAL_FLOAT(2.0F, street.score[2]); // second 3: the head came in second 1
    street.queue[EL] = 5.0F;                        // five have left: the first five
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    TEST_ASSERT_EQUAL_FLOAT(2.0F, street.score[2]); // second 4: the head came in second 2
    street.queue[EL] = 4.5F;
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    TEST_ASSERT_EQUAL_FLOAT(3.0F, street.score[2]);
}

// A second in which nobody came puts nobody at the head of the lane.
void test_oaf_empty_seconds_do_not_age() {
    Oaf oaf{10.0, 0, 0.0, {}};
    Street street(plug(oaf));
    begin_with_north_left(street);
    wait_for(street, 2, 0);
    street.come(EL, 5.0F);
    wait_for(street, 1, 0);
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    TEST_ASSERT_EQUAL_FLOAT(1.0F, street.score[2]); // came in second 3, this is second 4
}

void test_oaf_less_than_a_vehicle_is_no_head() {
    Oaf oaf{10.0, 0, 0.0, {}};
    Street street(plug(oaf));
    begin_with_north_left(street);
    street.come(EL, 0.75F);
    wait_for(street, 1, 0);
    street.come(SM, 1.0F);
    wait_for(street, 2, 0);
    TEST_ASSERT_EQUAL_UINT(1, street.second());
}

void test_oaf_stays_when_nobody_is_there() {
    Oaf oaf{10.0, 0, 0.0, {}};
    Street street(plug(oaf));
    TEST_ASSERT_EQUAL_UINT(0, street.second()); // the first stage, if none is shown
    street.come(WM, 1.0F);
    wait_for(street, 1, 0);
    TEST_ASSERT_EQUAL_UINT(3, street.second());
    street.clear(WM);
    wait_for(street, 20, 3);
    street.come(NL, 1.0F);
    TEST_ASSERT_EQUAL_UINT(0, street.second()); // it looks every second
}

// A vehicle that came in this very second has age 0, and counts as the oldest if there is no other.
void test_oaf_serves_vehicles_that_have_just_come() {
    Oaf first{10.0, 0, 0.0, {}};
    Street street(plug(first));
    street.come(WM, 2.0F);
    TEST_ASSERT_EQUAL_UINT(3, street.second());
    Oaf later{10.0, 0, 0.0, {}};
    Street other(plug(later));
    begin_with_north_left(other);
    wait_for(other, 3, 0);
    other.come(ER, 2.0F);
    TEST_ASSERT_EQUAL_UINT(3, other.second());
}

void test_oaf_green_does_not_run_in_the_intergreen() {
    Oaf oaf{10.0, 0, 0.0, {}};
    Street street(plug(oaf));
    begin_with_north_left(street);
    street.come(EL, 3.0F);
    wait_for(street, 3, 0);
    TEST_ASSERT_EQUAL_UINT(2, street.second()); // 8 s
    street.clear(EL);
    street.come(NL, 5.0F);
    for (unsigned second = 0; second < 30; ++second) {
        TEST_ASSERT_EQUAL_UINT(2, street.hidden_second());
    }
    TEST_ASSERT_EQUAL_UINT(8, street.seconds_until_change());
}

void test_fixed_cycle_of_the_paper_is_its_first_four_stages() {
    TEST_ASSERT_TRUE((covering_cycle(elmopp_site_paper) == std::vector<elmopp_stage_t>{0, 1, 2, 3}));
    Fixed fixed{20, {}};
    Street street(plug(fixed));
    street.queue[WR] = 99.0F; // it does not look
    std::vector<elmopp_stage_t> shown;
    for (unsigned second = 0; second < 200; ++second) {
        shown.push_back(street.second());
    }
    for (std::size_t second = 0; second < shown.size(); ++second) {
        TEST_ASSERT_EQUAL_UINT_MESSAGE(second / 20 % 4, shown[second], std::to_string(second).c_str());
    }
}

void test_fixed_waits_out_the_intergreen() {
    Fixed fixed{20, {}};
    Street street(plug(fixed));
    TEST_ASSERT_EQUAL_UINT(0, street.second());
    for (unsigned second = 0; second < 50; ++second) {
        TEST_ASSERT_EQUAL_UINT(0, street.hidden_second());
    }
}

void test_covering_cycle_serves_every_movement_and_no_stage_in_vain() {
    for (const auto *site :
         {&elmopp_site_five_way, &elmopp_site_four_way, &elmopp_site_left_lanes, &elmopp_site_one_way,
          &elmopp_site_paper, &elmopp_site_shared_lanes, &elmopp_site_three_way}) {
        std::uint32_t covered = 0;
        for (const elmopp_stage_t stage : covering_cycle(*site)) {
            const std::uint32_t served = elmopp_junction_served(site, site->stage_groups[stage]);
            TEST_ASSERT_TRUE_MESSAGE((served & ~covered) != 0, site->name);
            covered |= served;
        }
        TEST_ASSERT_EQUAL_UINT32_MESSAGE((1U << site->movement_count) - 1U, covered, site->name);
    }
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_itlc_green_is_startup_and_the_crossing_of_the_last_ready_vehicle);
    RUN_TEST(test_itlc_green_is_clamped_to_5_and_60);
    RUN_TEST(test_itlc_takes_the_slowest_lane_of_the_stage);
    RUN_TEST(test_itlc_may_follow_itself_without_startup);
    RUN_TEST(test_itlc_counts_the_ready_area_only);
    RUN_TEST(test_itlc_tie_goes_to_the_lowest_stage);
    RUN_TEST(test_itlc_green_does_not_run_in_the_intergreen);
    RUN_TEST(test_oaf_green_is_startup_and_one_platoon);
    RUN_TEST(test_oaf_same_stage_pays_no_startup);
    RUN_TEST(test_oaf_serves_the_oldest_head);
    RUN_TEST(test_oaf_oldest_head_picks_among_its_stages_the_oldest_heads);
    RUN_TEST(test_oaf_equal_heads_go_to_the_lowest_lane_and_stage);
    RUN_TEST(test_oaf_head_ages_by_first_come_first_served);
    RUN_TEST(test_oaf_empty_seconds_do_not_age);
    RUN_TEST(test_oaf_less_than_a_vehicle_is_no_head);
    RUN_TEST(test_oaf_stays_when_nobody_is_there);
    RUN_TEST(test_oaf_serves_vehicles_that_have_just_come);
    RUN_TEST(test_oaf_green_does_not_run_in_the_intergreen);
    RUN_TEST(test_fixed_cycle_of_the_paper_is_its_first_four_stages);
    RUN_TEST(test_fixed_waits_out_the_intergreen);
    RUN_TEST(test_covering_cycle_serves_every_movement_and_no_stage_in_vain);
    return UNITY_END();
}
