// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The greedy rivals: whom they choose, when they leave, and that they do nothing where nobody is. Asked with a view
/// made by hand; the paper's site, 0.5 vehicle/s a lane.

#include "greedy.hpp"
#include "street.hpp"

#include <set>

using namespace elmopp;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

namespace {

// --- what all of them do ---

/// Each with a minimum or interval of 5 s.
template <typename Work> void for_each_rule(const Work &work) {
    LongestQueue longest{5};
    MaxWave wave{5};
    MaxWaveHold hold{5, 4.0, 1.0};
    ElmoppHold urgency{5, 60, 2.0};
    MaxPressure pressure{5, nullptr};
    work(plug(longest), "longest-queue");
    work(plug(wave), "max-wave");
    work(plug(hold), "max-wave-hold");
    work(plug(urgency), "elmopp-hold");
    work(plug(pressure), "max-pressure");
}

void test_the_only_one_with_vehicles_is_chosen_and_held_for_its_minimum() {
    for_each_rule([](const elmopp_chooser_t &chooser, const char *name) {
        Street street(chooser);
        street.queue[EL] = 5.0F;
        street.queue[WL] = 5.0F;
        TEST_ASSERT_EQUAL_UINT_MESSAGE(2, street.second(), name);
        street.queue.fill(0.0F);
        street.queue[NL] = 90.0F;
        TEST_ASSERT_EQUAL_UINT_MESSAGE(5, street.seconds_until_change(), name);
        TEST_ASSERT_EQUAL_UINT_MESSAGE(0, street.second(), name);
    });
}

void test_nobody_begins_with_the_first_stage_and_stays() {
    for_each_rule([](const elmopp_chooser_t &chooser, const char *name) {
        Street street(chooser);
        TEST_ASSERT_EQUAL_UINT_MESSAGE(0, street.second(), name);
        TEST_ASSERT_EQUAL_UINT_MESSAGE(0, street.seconds_until_change(), name);
        street.force(6);
        TEST_ASSERT_EQUAL_UINT_MESSAGE(0, street.seconds_until_change(), name);
        TEST_ASSERT_EQUAL_UINT_MESSAGE(6, street.second(), name);
    });
}

void test_equal_stages_do_not_take_turns() {
    for_each_rule([](const elmopp_chooser_t &chooser, const char *name) {
        Street street(chooser);
        street.queue[EL] = 5.0F;
        street.queue[ER] = 5.0F; // stage 5
        TEST_ASSERT_EQUAL_UINT_MESSAGE(5, street.second(), name);
        street.queue[NL] = 5.0F;
        street.queue[NM] = 5.0F; // stage 4
        for (unsigned second = 0; second < 30; ++second) {
            street.red_ds.fill(0); // no age beside the queues
            TEST_ASSERT_EQUAL_UINT_MESSAGE(5, street.second(), name);
        }
    });
}

void test_a_forced_stage_has_its_minimum_too() {
    for_each_rule([](const elmopp_chooser_t &chooser, const char *name) {
        Street street(chooser);
        street.queue[EL] = 20.0F;
        TEST_ASSERT_EQUAL_UINT_MESSAGE(2, street.second(), name);
        street.force(1);
        TEST_ASSERT_EQUAL_UINT_MESSAGE(5, street.seconds_until_change(), name);
    });
}

void test_in_the_intergreen_the_target_stays() {
    for_each_rule([](const elmopp_chooser_t &chooser, const char *name) {
        Street street(chooser);
        TEST_ASSERT_EQUAL_UINT_MESSAGE(0, street.second(), name);
        street.queue[EL] = 90.0F;
        for (unsigned second = 0; second < 20; ++second) {
            TEST_ASSERT_EQUAL_UINT_MESSAGE(0, street.hidden_second(), name);
        }
    });
}

// --- longest-queue ---

void test_longest_queue_is_that_of_one_lane_not_of_the_stage() {
    LongestQueue rule{5};
    Street street(plug(rule));
    street.queue[EM] = 5.0F;
    street.queue[ER] = 5.0F;
    street.queue[WM] = 5.0F;
    street.queue[WR] = 5.0F; // 20 in stage 3
    street.queue[NL] = 6.0F;
    street.queue[NM] = 2.0F; // so that of the stages with N.L, 4 has more than 0
    TEST_ASSERT_EQUAL_UINT(4, street.second());
    TEST_ASSERT_EQUAL_FLOAT(6.0F, street.score[0]);
    TEST_ASSERT_EQUAL_FLOAT(6.0F, street.score[4]);
    TEST_ASSERT_EQUAL_FLOAT(5.0F, street.score[3]);
}

void test_longest_queue_is_a_lanes() {
    LongestQueue rule{5};
    elmopp_junction_t wide = elmopp_site_paper;
    wide.movement[EL].lanes = 2;
    Street street(plug(rule), wide);
    street.queue[EL] = 9.0F; // 4.5 a lane
    street.queue[NL] = 5.0F;
    TEST_ASSERT_EQUAL_UINT(0, street.second());
    TEST_ASSERT_EQUAL_FLOAT(4.5F, street.score[2]);
}

void test_longest_queue_leaves_out_who_has_not_arrived() {
    LongestQueue rule{1, Approaching(everywhere(4))};
    Street street(plug(rule));
    street.queue[NL] = 3.0F;
    street.come(EL, 9.0F);
    TEST_ASSERT_EQUAL_UINT(0, street.second());
    TEST_ASSERT_EQUAL_UINT(4, street.seconds_until_change());
    TEST_ASSERT_EQUAL_FLOAT(9.0F, street.score[2]);
}

// --- max-wave, max-wave-hold ---

void test_max_wave_counts_who_is_on_his_way() {
    MaxWave rule{5};
    Street street(plug(rule));
    street.queue[NL] = 8.0F;
    street.come(EL, 5.0F);
    street.come(WL, 4.0F);
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    TEST_ASSERT_EQUAL_FLOAT(9.0F, street.score[2]);
}

elmopp_stage_t held_or_left(float own, float other, LaneName first, LaneName second) {
    MaxWaveHold rule{5, 4.0, 1.0};
    Street street(plug(rule));
    street.queue[EL] = 10.0F;
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    street.queue[EL] = own;
    street.queue[first] = other / 2.0F;
    street.queue[second] = other / 2.0F;
    for (unsigned second_of_min = 0; second_of_min < 4; ++second_of_min) {
        TEST_ASSERT_EQUAL_UINT(2, street.second());
    }
    return street.second();
}

void test_max_wave_hold_leaves_for_four_more_a_lane() {
    TEST_ASSERT_EQUAL_UINT(2, held_or_left(20.0F, 27.5F, NL, SL)); // two lanes: 28
    TEST_ASSERT_EQUAL_UINT(0, held_or_left(20.0F, 28.0F, NL, SL));
    TEST_ASSERT_EQUAL_UINT(2, held_or_left(20.0F, 35.5F, NM, SM)); // four lanes: 36
    TEST_ASSERT_EQUAL_UINT(1, held_or_left(20.0F, 36.0F, NM, SM));
}

void test_max_wave_hold_leaves_when_nearly_empty() {
    TEST_ASSERT_EQUAL_UINT(2, held_or_left(2.0F, 4.0F, NL, SL)); // a vehicle for each of its two lanes
    TEST_ASSERT_EQUAL_UINT(0, held_or_left(1.9F, 4.0F, NL, SL));
    TEST_ASSERT_EQUAL_UINT(2, held_or_left(1.9F, 1.0F, NL, SL)); // but not for less
}

// --- elmopp-hold ---

elmopp_stage_t urgency_choice(float own, float other, std::uint16_t red_ds) {
    ElmoppHold rule{1, 60, 2.0};
    Street street(plug(rule));
    street.queue[NL] = own;
    TEST_ASSERT_EQUAL_UINT(0, street.second());
    street.queue[EL] = other;
    street.red_ds[EL] = red_ds;
    return street.second();
}

void test_elmopp_hold_counts_what_is_green_twice() {
    // At T = t_max the exponential is 1.
    TEST_ASSERT_EQUAL_UINT(0, urgency_choice(10.0F, 19.5F, 600));
    TEST_ASSERT_EQUAL_UINT(2, urgency_choice(10.0F, 20.5F, 600));
    // At T = 0 it is 1/e: 2 e = 5.44 times as many.
    TEST_ASSERT_EQUAL_UINT(0, urgency_choice(10.0F, 54.0F, 0));
    TEST_ASSERT_EQUAL_UINT(2, urgency_choice(10.0F, 55.0F, 0));
}

void test_elmopp_hold_leaves_at_its_maximum_for_somebody_only() {
    ElmoppHold rule{1, 60, 2.0};
    Street street(plug(rule));
    street.queue[NL] = 90.0F;
    TEST_ASSERT_EQUAL_UINT(0, street.second());
    TEST_ASSERT_EQUAL_UINT(60, street.seconds_until_change()); // stage 4, which serves N.L too
    Street other(plug(rule));
    other.queue[NL] = 90.0F;
    TEST_ASSERT_EQUAL_UINT(0, other.second());
    other.queue[NL] = 0.0F;
    TEST_ASSERT_EQUAL_UINT(0, other.seconds_until_change());
}

// --- max-pressure ---

void test_max_pressure_takes_off_who_stands_behind() {
    std::array<float, lane_count> behind_veh{};
    MaxPressure rule{10, behind_veh.data()};
    Street street(plug(rule));
    street.queue[NL] = 10.0F;
    street.queue[EL] = 5.0F;
    behind_veh[NL] = 8.0F;
    TEST_ASSERT_EQUAL_UINT(2, street.second());
    TEST_ASSERT_EQUAL_FLOAT(0.5F * 2.0F, street.score[0]);
    TEST_ASSERT_EQUAL_FLOAT(0.5F * 5.0F, street.score[2]);
    behind_veh[NL] = 1.0F; // it looks again after its interval
    TEST_ASSERT_EQUAL_UINT(10, street.seconds_until_change());
    TEST_ASSERT_EQUAL_FLOAT(0.5F * 9.0F, street.score[0]);
}

void test_max_pressure_decides_at_its_interval_only() {
    MaxPressure rule{10, nullptr};
    Street street(plug(rule));
    street.queue[NL] = 10.0F;
    TEST_ASSERT_EQUAL_UINT(0, street.second());
    for (unsigned second = 0; second < 12; ++second) {
        TEST_ASSERT_EQUAL_UINT(0, street.second());
    }
    street.queue[EL] = 20.0F;
    TEST_ASSERT_EQUAL_UINT(8, street.seconds_until_change()); // 20 s after it was shown
}

// --- random ---

std::vector<elmopp_stage_t> drawn(std::uint64_t seed) {
    Random rule{10, std::mt19937_64(seed)};
    Street street(plug(rule));
    std::vector<elmopp_stage_t> stages;
    for (unsigned second = 0; second < 3000; ++second) {
        stages.push_back(street.second());
    }
    return stages;
}

void test_random_is_the_same_by_seed_and_reaches_every_stage() {
    const auto stages = drawn(7);
    TEST_ASSERT_TRUE(stages == drawn(7));
    TEST_ASSERT_FALSE(stages == drawn(8));
    TEST_ASSERT_EQUAL_UINT(8, std::set<elmopp_stage_t>(stages.begin(), stages.end()).size());
    unsigned shown_s = 0;
    for (std::size_t t = 1; t < stages.size(); ++t) {
        ++shown_s;
        if (stages[t] != stages[t - 1]) {
            TEST_ASSERT_EQUAL_UINT(0, shown_s % 10);
            shown_s = 0;
        }
    }
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_the_only_one_with_vehicles_is_chosen_and_held_for_its_minimum);
    RUN_TEST(test_nobody_begins_with_the_first_stage_and_stays);
    RUN_TEST(test_equal_stages_do_not_take_turns);
    RUN_TEST(test_a_forced_stage_has_its_minimum_too);
    RUN_TEST(test_in_the_intergreen_the_target_stays);
    RUN_TEST(test_longest_queue_is_that_of_one_lane_not_of_the_stage);
    RUN_TEST(test_longest_queue_is_a_lanes);
    RUN_TEST(test_longest_queue_leaves_out_who_has_not_arrived);
    RUN_TEST(test_max_wave_counts_who_is_on_his_way);
    RUN_TEST(test_max_wave_hold_leaves_for_four_more_a_lane);
    RUN_TEST(test_max_wave_hold_leaves_when_nearly_empty);
    RUN_TEST(test_elmopp_hold_counts_what_is_green_twice);
    RUN_TEST(test_elmopp_hold_leaves_at_its_maximum_for_somebody_only);
    RUN_TEST(test_max_pressure_takes_off_who_stands_behind);
    RUN_TEST(test_max_pressure_decides_at_its_interval_only);
    RUN_TEST(test_random_is_the_same_by_seed_and_reaches_every_stage);
    return UNITY_END();
}
