// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Places follow the street: who stands where, that nobody drives through anybody, and that what is drawn at a crossing
/// is at the stop line.

#include "comings.hpp"
#include "expect.hpp"
#include "places.hpp"
#include "sites.hpp"
#include "trial.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

using namespace elmopp;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

namespace {

constexpr std::uint32_t all_open = 0xFFFFFFFFU;
constexpr double counted_m = 94.0;

/// A street under lamps that the test holds, and its places.
class Filmed {
  public:
    explicit Filmed(const elmopp_junction_t &site)
        : scenario_(make_scenario("discrete", &site)), plan_(plan_of(scenario_)), places_(plan_, 0),
          comings_(site.approach_count) {}

    void come(std::size_t approach, unsigned count, std::int64_t first_ds, std::int64_t apart_ds) {
        for (unsigned i = 0; i < count; ++i) {
            comings_[approach].push_back({first_ds + i * apart_ds, 17 * i + approach + 1});
        }
    }

    void tick(std::uint32_t open) {
        if (!streets_) {
            streets_.emplace(plan_, std::vector<Comings>{comings_});
            places_.follow(*streets_);
        }
        streets_->begin_second();
        streets_->tick({open});
        streets_->end_second();
        places_.follow(*streets_);
    }

    [[nodiscard]] const Streets &streets() const {
        return *streets_;
    }
    [[nodiscard]] std::vector<Place> all() const {
        return places_.all();
    }
    /// Of those that have a lane of the street within the reach, by number.
    [[nodiscard]] std::set<std::uint64_t> within() const {
        std::set<std::uint64_t> ids;
        for (const auto &lanes : streets_->lanes_in_reach(0)) {
            for (const auto &lane : lanes) {
                for (const Vehicle &vehicle : lane.vehicles()) {
                    ids.insert(vehicle.seed);
                }
            }
        }
        return ids;
    }

  private:
    Scenario scenario_;
    StreetPlan plan_;
    Places places_;
    Comings comings_;
    std::optional<Streets> streets_;
};

/// Fronts in one lane of an approach from where cameras count on, nearest to the stop line first: before that, who
/// waits to be let into a full reach stands beside another who will take the same lane.
std::vector<double> fronts(const std::vector<Place> &places, std::size_t approach, double across) {
    std::vector<double> at_m;
    for (const Place &place : places) {
        if (place.approach == approach && std::abs(place.across - across) < 0.01 && place.front_m < counted_m) {
            at_m.push_back(place.front_m);
        }
    }
    std::sort(at_m.begin(), at_m.end());
    return at_m;
}

void test_a_queue_stands_a_vehicles_room_apart_from_the_stop_line_on() {
    Filmed filmed(elmopp_site_one_way);
    filmed.come(0, 12, 0, 30);
    for (int i = 0; i < 900; ++i) {
        filmed.tick(0);
    }
    std::size_t there = 0;
    for (const double lane : {0.0, 1.0}) {
        const auto at_m = fronts(filmed.all(), 0, lane);
        there += at_m.size();
        for (std::size_t k = 0; k < at_m.size(); ++k) {
            TEST_ASSERT_DOUBLE_WITHIN(0.2, 7.5 * static_cast<double>(k), at_m[k]);
        }
    }
    TEST_ASSERT_EQUAL_UINT(12, there);
}

void test_who_meets_nobody_drives_at_the_limit() {
    Filmed filmed(elmopp_site_one_way);
    filmed.come(0, 1, 100, 10);
    double before_m = 0.0;
    for (int i = 0; i < 150; ++i) {
        filmed.tick(all_open);
        const auto places = filmed.all();
        if (i > 20 && !places.empty() && places[0].front_m > 1.0) {
            if (before_m > 0.0) {
                TEST_ASSERT_DOUBLE_WITHIN(0.01, 50.0 / 36.0, before_m - places[0].front_m);
            }
            before_m = places[0].front_m;
        }
    }
    TEST_ASSERT_TRUE(before_m > 0.0);
}

/// Everybody for whom the street has a place is drawn, and nobody else before the line; at the crossing where it is.
void test_the_picture_is_the_streets_in_every_tick() {
    Filmed filmed(elmopp_site_four_way);
    for (std::size_t i = 0; i < 4; ++i) {
        filmed.come(i, 120, 3 * static_cast<std::int64_t>(i), 27);
    }
    std::set<std::uint64_t> before;
    double worst_m = 0.0;
    unsigned crossed = 0;
    for (int i = 0; i < 3600; ++i) {
        const bool north_south = (i / 250) % 2 == 0;
        filmed.tick(i % 250 > 200 ? 0U : (north_south ? 0x1C7U : 0xE38U)); // four fifths of the time, then all red
        std::map<std::uint64_t, double> drawn;
        for (const Place &place : filmed.all()) {
            drawn[place.id] = place.front_m;
        }
        const auto now = filmed.within();
        for (const std::uint64_t id : now) {
            TEST_ASSERT_EQUAL_UINT(1, drawn.count(id));
            TEST_ASSERT_TRUE(drawn[id] > -5.1);
        }
        for (const std::uint64_t id : before) {
            if (now.count(id) == 0) { // the street let it across in this tick
                worst_m = std::max(worst_m, std::abs(drawn.at(id)));
                ++crossed;
            }
        }
        before = now;
    }
    TEST_ASSERT_GREATER_THAN_UINT(150, crossed);
    TEST_ASSERT_TRUE_MESSAGE(worst_m < 20.0, std::to_string(worst_m).c_str());
}

void test_nobody_drives_through_the_one_before_it() {
    Filmed filmed(elmopp_site_one_way);
    filmed.come(0, 60, 0, 14);
    std::map<std::uint64_t, double> before_m;
    for (int i = 0; i < 1500; ++i) {
        filmed.tick(i % 400 < 200 ? all_open : 0U);
        for (const double lane : {0.0, 1.0}) {
            const auto at_m = fronts(filmed.all(), 0, lane);
            for (std::size_t k = 1; k < at_m.size(); ++k) {
                TEST_ASSERT_TRUE_MESSAGE(at_m[k] - at_m[k - 1] > 6.8, std::to_string(at_m[k] - at_m[k - 1]).c_str());
            }
        }
        for (const Place &place : filmed.all()) { // nor backwards
            const auto found = before_m.find(place.id);
            TEST_ASSERT_TRUE(found == before_m.end() || place.front_m <= found->second);
            before_m[place.id] = place.front_m;
        }
    }
}

void test_a_queue_starts_one_after_another() {
    Filmed filmed(elmopp_site_one_way);
    filmed.come(0, 12, 0, 30);
    for (int i = 0; i < 900; ++i) {
        filmed.tick(0);
    }
    const auto standing = fronts(filmed.all(), 0, 0.0);
    std::map<std::uint64_t, double> from_m;
    std::map<std::uint64_t, int> started;
    for (const Place &place : filmed.all()) {
        from_m[place.id] = place.front_m;
    }
    for (int i = 0; i < 200; ++i) {
        filmed.tick(all_open);
        for (const Place &place : filmed.all()) {
            if (from_m.at(place.id) - place.front_m > 0.3) {
                started.emplace(place.id, i);
            }
        }
    }
    std::map<double, int> by_place; // of the left lane, from the stop line back
    for (const auto &[id, tick] : started) {
        if (std::find(standing.begin(), standing.end(), from_m.at(id)) != standing.end()) {
            by_place[from_m.at(id)] = tick;
        }
    }
    TEST_ASSERT_GREATER_THAN_UINT(3, by_place.size());
    int last = -1;
    for (const auto &[at_m, tick] : by_place) {
        if (last >= 0) {
            TEST_ASSERT_INT_WITHIN(4, 10, tick - last); // a wave of a second a vehicle
        }
        last = tick;
    }
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_a_queue_stands_a_vehicles_room_apart_from_the_stop_line_on);
    RUN_TEST(test_who_meets_nobody_drives_at_the_limit);
    RUN_TEST(test_the_picture_is_the_streets_in_every_tick);
    RUN_TEST(test_nobody_drives_through_the_one_before_it);
    RUN_TEST(test_a_queue_starts_one_after_another);
    return UNITY_END();
}
