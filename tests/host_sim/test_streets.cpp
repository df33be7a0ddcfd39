// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Single vehicles: saturation flow, start-up loss, finite lanes and spill-back, what is counted, turns, gaps, delay,
/// and that no vehicle is lost.

#include "comings.hpp"
#include "error.hpp"
#include "expect.hpp"
#include "signals.hpp"
#include "sites.hpp"
#include "streets.hpp"
#include "trial.hpp"
#include "turns.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

using namespace elmopp;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

namespace {

constexpr std::uint32_t all_open = 0xFFFFFFFFU;
constexpr double speed_m_per_s = 10.0; ///< the reach of 100 m takes 100 ds, the road before it 200 ds
constexpr std::int64_t reach = 100;
enum Lane12 : std::uint8_t { NL, NM, NR, EL, EM, ER, SL, SM, SR };

/// One junction of single vehicles under lamps that the test holds.
class World {
  public:
    explicit World(const elmopp_junction_t &site, const std::vector<double> &split = {})
        : scenario_(make_scenario("discrete@length=300", &site, split)) {
        for (Road &road : scenario_.street->roads) {
            road.speed_m_per_s = speed_m_per_s;
        }
        plan_ = plan_of(scenario_);
        comings_.resize(site.approach_count);
    }

    /// `count` vehicles come to an approach, `apart_ds` apart, from `first_ds` on.
    void come(std::size_t approach, unsigned count, std::int64_t first_ds, std::int64_t apart_ds,
              std::uint64_t seed = 1) {
        for (unsigned i = 0; i < count; ++i) {
            comings_[approach].push_back({first_ds + i * apart_ds, seed + i});
        }
    }

    /// Ticks with these movements open; the crossings' times of all movements go into `crossed_ds`.
    void run(std::int64_t ticks, std::uint32_t open) {
        if (!streets) {
            streets.emplace(plan_, std::vector<Comings>{comings_});
        }
        for (std::int64_t i = 0; i < ticks; ++i) {
            streets->begin_second();
            streets->tick({open});
            streets->end_second();
            streets->check_conservation();
            const auto &left = streets->counts(0).left_veh();
            crossed_veh.resize(left.size());
            for (std::size_t j = 0; j < left.size(); ++j) {
                crossed_veh[j] += left[j];
                crossed_ds.insert(crossed_ds.end(), static_cast<std::size_t>(left[j]), now_ds);
            }
            ++now_ds;
        }
    }

    [[nodiscard]] double queue(std::size_t movement) const {
        return streets->counts(0).queue_veh()[movement];
    }

    std::optional<Streets> streets;
    std::vector<std::int64_t> crossed_ds;
    std::vector<double> crossed_veh; ///< [movement]
    std::int64_t now_ds = 0;

  private:
    Scenario scenario_;
    StreetPlan plan_;
    Comings comings_;
};

// one_way: 2 lanes a movement, 0.5 vehicle/s a lane, 2 s of start-up loss.
void test_a_full_queue_leaves_at_the_saturation_headway_after_the_startup_loss() {
    World world(elmopp_site_one_way);
    world.come(0, 20, 0, 10);
    world.run(600, 0);
    TEST_ASSERT_EQUAL_DOUBLE(20.0, world.queue(0));
    TEST_ASSERT_TRUE(world.crossed_ds.empty());
    world.run(300, 1);
    TEST_ASSERT_EQUAL_size_t(20, world.crossed_ds.size());
    for (std::size_t i = 0; i < 20; ++i) {
        // Both lanes at once: 600 + 20 of loss + 20 a vehicle.
        TEST_ASSERT_EQUAL_INT64(620 + 20 * static_cast<std::int64_t>(i / 2 + 1), world.crossed_ds[i]);
    }
}

void test_headways_of_fractions_of_a_tick_do_not_add_up() {
    World world(elmopp_site_four_way, {0, 0, 1});
    world.come(0, 13, 0, 10);
    world.run(600, 0);
    world.run(400, all_open);
    TEST_ASSERT_EQUAL_size_t(13, world.crossed_ds.size()); // N.R: 0.45 vehicle/s, 22.2 ds
    TEST_ASSERT_INT64_WITHIN(1, 620 + 289, world.crossed_ds.back());
}

void test_who_comes_to_an_open_stop_line_loses_nothing() {
    World world(elmopp_site_one_way);
    world.come(0, 5, 50, 40);
    world.run(600, 1);
    TEST_ASSERT_EQUAL_size_t(5, world.crossed_ds.size());
    TEST_ASSERT_EQUAL_INT64(50 + reach, world.crossed_ds.front());
    TEST_ASSERT_EQUAL_DOUBLE(0.0, world.streets->delay_veh_s());
}

void test_delay_is_against_driving_at_the_limit() {
    World world(elmopp_site_one_way);
    world.come(0, 1, 50, 10);
    world.run(250, 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 10.0, world.streets->delay_veh_s()); // due at 150
    TEST_ASSERT_EQUAL_DOUBLE(10.0, world.streets->longest_wait_s());
    world.run(100, 1);
    TEST_ASSERT_EQUAL_INT64(250 + 20 + 20, world.crossed_ds.front());
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 14.0, world.streets->delay_veh_s());
    TEST_ASSERT_EQUAL_DOUBLE(14.0, world.streets->longest_wait_s()); // he has left, and is remembered
}

// The first waits 14 s, as above; the second comes to an open stop line.
void test_the_longest_wait_is_the_greatest_and_not_the_last() {
    World world(elmopp_site_one_way);
    world.come(0, 2, 50, 500);
    world.run(250, 0);
    world.run(600, 1);
    TEST_ASSERT_EQUAL_size_t(2, world.crossed_ds.size());
    TEST_ASSERT_EQUAL_DOUBLE(14.0, world.streets->longest_wait_s());
}

void test_only_who_is_within_the_reach_is_counted() {
    World world(elmopp_site_one_way);
    world.come(0, 1, 50, 10);
    world.run(50, 0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, world.queue(0));
    TEST_ASSERT_EQUAL_size_t(1, world.streets->inside_veh());
    world.run(1, 0);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, world.queue(0));
    TEST_ASSERT_EQUAL_DOUBLE(1.0, world.streets->counts(0).arrived_veh()[0]);
    world.run(1, 0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, world.streets->counts(0).arrived_veh()[0]);
    TEST_ASSERT_EQUAL_size_t(0, world.streets->late_veh(0, 0));
    world.run(100, 0);
    TEST_ASSERT_EQUAL_size_t(1, world.streets->late_veh(0, 0));
}

// 13 a lane within the reach, 26 on the road before it.
void test_a_full_arm_keeps_vehicles_outside_and_their_waiting_counts() {
    World world(elmopp_site_one_way);
    world.come(0, 100, 0, 10);
    world.run(3000, 0);
    TEST_ASSERT_EQUAL_DOUBLE(26.0, world.queue(0));
    TEST_ASSERT_EQUAL_size_t(78, world.streets->inside_veh());
    TEST_ASSERT_EQUAL_size_t(22, world.streets->outside_veh());
    TEST_ASSERT_EQUAL_DOUBLE(22.0, world.streets->counts(0).outside_veh()[0]);
    TEST_ASSERT_EQUAL_DOUBLE(300.0 - 10.0, world.streets->longest_wait_s()); // the first has come in second 0
    const double before_s = world.streets->delay_veh_s();
    world.run(10, 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, before_s + 100.0, world.streets->delay_veh_s());
    world.run(3000, 1);
    TEST_ASSERT_EQUAL_size_t(100, world.streets->total_out_veh());
    TEST_ASSERT_EQUAL_size_t(0, world.streets->inside_veh() + world.streets->outside_veh());
}

void test_room_comes_to_the_tail_one_start_after_another() {
    World world(elmopp_site_one_way);
    world.come(0, 100, 0, 10);
    world.run(3000, 0);
    world.run(41 + 129, 1); // the first leaves in tick 3040 and each of 13 starts 10 later
    TEST_ASSERT_EQUAL_DOUBLE(0.0, world.streets->counts(0).arrived_veh()[0]);
    world.run(1, 1);
    TEST_ASSERT_EQUAL_DOUBLE(2.0, world.streets->counts(0).arrived_veh()[0]);
}

// four_way: a bay for 8 that turn left, beside the lanes straight on.
void test_a_full_bay_holds_up_those_behind_it() {
    World world(elmopp_site_four_way, {1, 0, 0});
    world.come(0, 12, 0, 20);
    world.run(900, 0);
    TEST_ASSERT_EQUAL_DOUBLE(8.0, world.queue(NL));
    World mixed(elmopp_site_four_way, {0.98, 0.02, 0});
    mixed.come(0, 40, 0, 20);
    mixed.run(2000, 1U << NM); // nobody gets by: but for the second lane straight on
    TEST_ASSERT_EQUAL_DOUBLE(8.0, mixed.queue(NL));
    TEST_ASSERT_TRUE(mixed.crossed_ds.size() <= 2);
}

void test_turns_have_their_shares() {
    World world(elmopp_site_four_way, {0.2, 0.5, 0.3});
    world.come(0, 4000, 0, 60, 12345);
    world.run(241000, all_open);
    TEST_ASSERT_EQUAL_size_t(4000, world.streets->total_out_veh());
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.2, world.crossed_veh[NL] / 4000.0); // three standard deviations
    TEST_ASSERT_DOUBLE_WITHIN(0.024, 0.5, world.crossed_veh[NM] / 4000.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.022, 0.3, world.crossed_veh[NR] / 4000.0);
}

/// four_way whose left turns from north and south may be green with the traffic that they cross.
elmopp_junction_t permissive() {
    elmopp_junction_t site = elmopp_site_four_way;
    const auto allow = [&site](unsigned a, unsigned b) {
        site.conflict[a] = static_cast<std::uint16_t>(site.conflict[a] & ~(1U << b));
        site.conflict[b] = static_cast<std::uint16_t>(site.conflict[b] & ~(1U << a));
    };
    allow(NL, SM);
    allow(NL, SR);
    allow(SL, NM);
    allow(SL, NR);
    return site;
}

void test_who_gives_way_is_read_from_names_and_conflicts() {
    const elmopp_junction_t site = permissive();
    TEST_ASSERT_TRUE((gives_way_to(site, NL) == std::vector<std::size_t>{SM, SR}));
    TEST_ASSERT_TRUE(gives_way_to(site, NM).empty());
    TEST_ASSERT_TRUE(gives_way_to(site, EL).empty()); // protected
    TEST_ASSERT_TRUE(gives_way_to(elmopp_site_four_way, NL).empty());
}

/// Left turners from the north that cross in 100 s of green, against so many straight on from the south.
std::size_t left_turns(unsigned opposing, std::int64_t apart_ds) {
    World world(permissive(), {0.5, 0.5, 0});
    std::uint64_t left_seed = 0; // of a driver who turns left
    while (SplitMix64(left_seed).uniform() >= 0.5) {
        ++left_seed;
    }
    std::uint64_t straight_seed = 0;
    while (SplitMix64(straight_seed).uniform() < 0.5) {
        ++straight_seed;
    }
    for (unsigned i = 0; i < 8; ++i) {
        world.come(0, 1, 10 * i, 0, left_seed);
    }
    for (unsigned i = 0; i < opposing; ++i) {
        world.come(2, 1, i * apart_ds, 0, straight_seed);
    }
    world.run(200, 0);
    world.run(1000, (1U << NL) | (1U << SM));
    const double left = world.crossed_veh[NL];
    world.run(100, 0);
    TEST_ASSERT_FALSE(world.streets->is_occupied(0));
    return static_cast<std::size_t>(left);
}

/// What a chooser is told and what the street does come from two places: the sites' key and the names. Of a lane the
/// share that turns left gives way.
void test_who_gives_way_in_the_street_is_who_the_site_says() {
    for (const elmopp_junction_t *site : {&elmopp_site_five_way, &elmopp_site_four_way, &elmopp_site_left_lanes,
                                          &elmopp_site_one_way, &elmopp_site_shared_lanes, &elmopp_site_three_way}) {
        const auto share = usual_shares(*site);
        for (std::size_t j = 0; j < site->movement_count; ++j) {
            std::uint32_t foes = 0;
            double yielding = 0.0;
            for (const Way &way : ways_of(*site, site->movement[j].approach, share)) {
                for (const std::size_t foe : way.movement == j ? way.gives_way : std::vector<std::size_t>()) {
                    foes |= std::uint32_t{1} << foe;
                }
                yielding += way.movement == j && !way.gives_way.empty() ? way.share / share[j] : 0.0;
            }
            TEST_ASSERT_EQUAL_HEX32(foes, site->gives_way[j]);
            TEST_ASSERT_EQUAL_INT(std::lround(100.0 * yielding), site->movement[j].gives_way_percent);
        }
    }
}

void test_a_left_turn_that_gives_way_waits_for_a_gap() {
    TEST_ASSERT_EQUAL_size_t(8, left_turns(0, 1));
    TEST_ASSERT_EQUAL_size_t(0, left_turns(200, 10)); // an endless stream
    const std::size_t some = left_turns(20, 60);      // gaps of 6 s let one through
    TEST_ASSERT_TRUE(some >= 4);
}

void test_who_waits_in_the_junction_clears_at_the_end() {
    World world(permissive(), {1, 0, 0});
    world.come(0, 3, 0, 10);
    world.come(2, 60, 0, 10);
    // The opposing vehicles all turn left too, so nobody comes straight on: all cross.
    world.run(200, 0);
    world.run(200, (1U << NL) | (1U << SM));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, world.queue(NL));
}

enum Shared : std::uint8_t { NLM, NT, ELM, ET, SLM, ST };
enum Left : std::uint8_t { side_NL, side_NT, main_EL, main_ET, side_SL, side_ST };

/// A driver who takes a way of an approach, by the site's usual shares.
std::uint64_t driver(const elmopp_junction_t &site, std::size_t approach, std::size_t way) {
    const auto ways = ways_of(site, approach, usual_shares(site));
    double before = 0.0;
    for (std::size_t w = 0; w < way; ++w) {
        before += ways[w].share;
    }
    std::uint64_t seed = 0;
    double drawn = SplitMix64(seed).uniform();
    while (drawn < before || drawn >= before + ways[way].share) {
        drawn = SplitMix64(++seed).uniform();
    }
    return seed;
}

/// shared_lanes; the ways of an approach in site order.
enum SharedWay : std::uint8_t { inner_left, inner_straight, outer_straight, outer_right };

void come_by(World &world, std::size_t approach, SharedWay way, std::int64_t first_ds) {
    world.come(approach, 1, first_ds, 0, driver(elmopp_site_shared_lanes, approach, way));
}

// N.LM and S.LM give way to S.LM and S.T, and to N.LM and N.T; all have green together.
void test_a_left_turn_holds_up_its_shared_lane_and_no_other() {
    World world(elmopp_site_shared_lanes);
    come_by(world, 0, inner_left, 0);
    for (std::int64_t i = 1; i <= 5; ++i) {
        come_by(world, 0, inner_straight, 10 * i);
        come_by(world, 0, outer_straight, 10 * i);
    }
    for (std::int64_t i = 0; i < 100; ++i) {
        come_by(world, 2, outer_straight, 20 * i); // no gap
    }
    world.run(200, 0);
    world.run(400, (1U << NLM) | (1U << NT) | (1U << ST));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, world.crossed_veh[NLM]);
    TEST_ASSERT_EQUAL_DOUBLE(5.0, world.crossed_veh[NT]);
    TEST_ASSERT_TRUE(world.crossed_veh[ST] >= 18.0);
    TEST_ASSERT_TRUE(world.streets->is_occupied(0));
    world.run(50, 0); // the one in the junction clears at the end, nobody else
    TEST_ASSERT_EQUAL_DOUBLE(1.0, world.crossed_veh[NLM]);
    world.run(300, 1U << NLM);
    TEST_ASSERT_EQUAL_DOUBLE(6.0, world.crossed_veh[NLM]);
}

void test_a_shared_lane_flows_through_the_gaps_of_the_other_side() {
    const auto crossed = [](std::int64_t apart_ds) {
        World world(elmopp_site_shared_lanes);
        for (std::int64_t i = 0; i < 4; ++i) {
            come_by(world, 0, inner_left, 10 * i);
        }
        for (std::int64_t i = 0; i < 60; ++i) {
            come_by(world, 2, outer_straight, apart_ds * i);
        }
        world.run(200, 0);
        world.run(400, (1U << NLM) | (1U << ST));
        return world.crossed_veh[NLM];
    };
    TEST_ASSERT_EQUAL_DOUBLE(0.0, crossed(20));
    TEST_ASSERT_EQUAL_DOUBLE(4.0, crossed(80)); // one every 8 s: a gap each
}

void test_left_turns_from_opposite_sides_pass_before_each_other() {
    World world(elmopp_site_shared_lanes);
    for (std::int64_t i = 0; i < 4; ++i) {
        come_by(world, 0, inner_left, 10 * i);
        come_by(world, 2, inner_left, 10 * i);
    }
    world.run(200, 0);
    world.run(20 + 20 + 4 * 25, (1U << NLM) | (1U << SLM));
    TEST_ASSERT_EQUAL_DOUBLE(4.0, world.crossed_veh[NLM]);
    TEST_ASSERT_EQUAL_DOUBLE(4.0, world.crossed_veh[SLM]);
}

// 12 on each of two lanes straight on and 12 on one: 20 ds of loss, then 20 ds a vehicle and lane.
void test_two_lanes_discharge_twice_what_one_does() {
    World world(elmopp_site_left_lanes, {0, 1});
    world.come(1, 24, 0, 10);
    world.come(0, 12, 0, 10);
    world.run(500, 0);
    world.run(20 + 20 * 6 + 1, (1U << main_ET) | (1U << side_NT));
    TEST_ASSERT_EQUAL_DOUBLE(12.0, world.crossed_veh[main_ET]);
    TEST_ASSERT_EQUAL_DOUBLE(6.0, world.crossed_veh[side_NT]);
}

void test_a_left_turn_from_a_lane_of_its_own_holds_up_nobody() {
    World world(elmopp_site_left_lanes);
    const std::uint64_t left = driver(elmopp_site_left_lanes, 0, 0);
    const std::uint64_t straight = driver(elmopp_site_left_lanes, 0, 1);
    world.come(0, 1, 0, 0, left);
    for (std::int64_t i = 1; i <= 5; ++i) {
        world.come(0, 1, 10 * i, 0, straight);
    }
    for (std::int64_t i = 0; i < 100; ++i) {
        world.come(2, 1, 20 * i, 0, straight);
    }
    world.run(200, 0);
    world.run(400, (1U << side_NL) | (1U << side_NT) | (1U << side_ST));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, world.crossed_veh[side_NL]);
    TEST_ASSERT_EQUAL_DOUBLE(5.0, world.crossed_veh[side_NT]);
    // On the main street left turns are protected: they give way to nobody.
    TEST_ASSERT_TRUE((gives_way_to(elmopp_site_left_lanes, side_NL) == std::vector<std::size_t>{side_ST}));
    TEST_ASSERT_TRUE(gives_way_to(elmopp_site_left_lanes, main_EL).empty());
    TEST_ASSERT_TRUE((gives_way_to(elmopp_site_shared_lanes, ELM) == std::vector<std::size_t>{6, 7}));
}

void test_amber_is_used_for_a_second() {
    Signals signals(elmopp_site_one_way);
    elmopp_lamps_t lamps{};
    lamps.green = 1;
    lamps.red = 2;
    signals.show(lamps);
    TEST_ASSERT_EQUAL_UINT32(1, signals.going());
    TEST_ASSERT_EQUAL_UINT32(1, signals.open());
    lamps.green = 0;
    lamps.amber = 1;
    for (unsigned tick = 0; tick < amber_used_ds; ++tick) {
        signals.show(lamps);
        TEST_ASSERT_EQUAL_UINT32(0, signals.going());
        TEST_ASSERT_EQUAL_UINT32(1, signals.open());
    }
    signals.show(lamps);
    TEST_ASSERT_EQUAL_UINT32(0, signals.open());
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.1, signals.red_s(0));
    // Red-amber before a green opens nothing.
    lamps.red = 1;
    signals.show(lamps);
    TEST_ASSERT_EQUAL_UINT32(0, signals.open());
}

void test_the_same_seed_brings_the_same_vehicles_and_an_approach_does_not_depend_on_others() {
    const auto draw = [](std::uint64_t seed, std::uint64_t trial, std::size_t approaches) {
        return draw_comings(rates("alternating", {}, approaches, 0.2, seed, trial), seed, trial);
    };
    const Comings one = draw(1, 0, 4);
    const Comings again = draw(1, 0, 2);
    const Comings other = draw(1, 1, 4);
    const auto same = [](const std::vector<Coming> &a, const std::vector<Coming> &b) {
        return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const Coming &x, const Coming &y) {
                   return x.edge_ds == y.edge_ds && x.seed == y.seed;
               });
    };
    TEST_ASSERT_TRUE(same(one[0], again[0]) && same(one[1], again[1]));
    TEST_ASSERT_FALSE(same(one[0], one[1]));
    TEST_ASSERT_FALSE(same(one[0], other[0]));
}

double came(const std::string &pattern, std::size_t from_s, std::size_t until_s) {
    const Series unit = make_source(Integrator::rk4, Mapping::abs, 1, 0, 4).unit;
    const Series counts = counted(draw_comings(rates(pattern, unit, 4, 0.4, 1, 0), 1, 0));
    double total = 0.0;
    for (const auto &series : counts) {
        for (std::size_t t = from_s; t < until_s; ++t) {
            total += series[training_points + t];
        }
    }
    return total;
}

// 4 x 800 vehicles: five standard deviations are 9 %.
void test_every_pattern_brings_the_asked_number() {
    for (const auto &pattern : demand_patterns()) {
        expect_relative(3200.0, came(pattern, 0, simulated_points), 0.09, pattern);
    }
}

void test_alternating_demand_is_light_then_heavy() {
    expect_relative(400.0, came("alternating", 0, 500), 0.2);
    expect_relative(1200.0, came("alternating", 500, 1000), 0.15);
    expect_relative(400.0, came("alternating", 1000, 1500), 0.2);
}

void test_the_oracle_knows_who_reaches_the_reach_and_when() {
    const Scenario scenario = make_scenario("discrete", nullptr);
    const Demand demand = make_discrete_demand(scenario, {}, 300.0, 1, 0, 100);
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t t = 0; t < 100 + ELMOPP_HORIZON_MAX; ++t) {
            double came_veh = 0.0;
            for (const auto &coming : demand.comings[i]) {
                const auto from = static_cast<std::int64_t>(10 * t);
                came_veh += coming.edge_ds >= from && coming.edge_ds < from + 10 ? 1.0 : 0.0;
            }
            TEST_ASSERT_EQUAL_DOUBLE(came_veh, static_cast<double>(demand.future_veh[i][t]));
        }
    }
}

void test_no_vehicle_is_lost_whatever_the_lamps_do() {
    for (const auto *site :
         {&elmopp_site_five_way, &elmopp_site_four_way, &elmopp_site_left_lanes, &elmopp_site_one_way,
          &elmopp_site_paper, &elmopp_site_shared_lanes, &elmopp_site_three_way}) {
        const Scenario scenario = make_scenario("discrete", site);
        const Demand demand = make_discrete_demand(scenario, {}, 900.0, 7, 3, 2000);
        for (const auto *chooser : {"random", "fixed", "naive"}) {
            const Metrics metrics = run_trial(scenario, parse_chooser(chooser), demand, 2000, {});
            TEST_ASSERT_EQUAL_DOUBLE(metrics.vehicles_in,
                                     metrics.vehicles_out + metrics.vehicles_queued + metrics.vehicles_outside);
            TEST_ASSERT_TRUE(metrics.vehicles_out > 500.0);
        }
    }
}

// 100 m of reach: 7.2 s at 50 km/h, 12 s at 30, 5.1 s at 70.
void test_a_site_says_how_fast_its_approaches_are() {
    elmopp_junction_t site = elmopp_site_one_way;
    site.movement[1].limit_km_per_h = 30;
    const Scenario scenario = make_scenario("discrete", &site);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 50.0 / 3.6, scenario.surroundings().roads[0].speed_m_per_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 30.0 / 3.6, scenario.surroundings().roads[1].speed_m_per_s);
    TEST_ASSERT_EQUAL_UINT(7, scenario.setting().travel_s[0]);
    TEST_ASSERT_EQUAL_UINT(12, scenario.setting().travel_s[1]);
    const Scenario same = make_scenario("discrete@speed=70", &site);
    TEST_ASSERT_EQUAL_UINT(5, same.setting().travel_s[0]);
    TEST_ASSERT_EQUAL_UINT(5, same.setting().travel_s[1]);
}

void test_each_arm_is_driven_at_its_own_limit() {
    elmopp_junction_t site = elmopp_site_one_way;
    site.movement[1].limit_km_per_h = 36;
    Scenario scenario = make_scenario("discrete@length=300", &site);
    scenario.pave(0, 72.0, 200.0, "");
    const StreetPlan plan = plan_of(scenario);
    TEST_ASSERT_EQUAL_INT64(50, road_ds(site, plan[0].arms[0])); // 100 m at 20 m/s
    TEST_ASSERT_EQUAL_INT64(50, reach_ds(site, plan[0].arms[0]));
    TEST_ASSERT_EQUAL_INT64(200, road_ds(site, plan[0].arms[1])); // 200 m at 10 m/s
    TEST_ASSERT_EQUAL_INT64(100, reach_ds(site, plan[0].arms[1]));
    Comings comings(2);
    comings[0].push_back({100, 1});
    comings[1].push_back({100, 1});
    Streets streets(plan, {comings});
    for (std::int64_t now_ds = 0; now_ds <= 200; ++now_ds) {
        streets.begin_second();
        streets.tick({all_open});
        TEST_ASSERT_EQUAL_DOUBLE(now_ds == 150 ? 1.0 : 0.0, streets.counts(0).left_veh()[0]);
        TEST_ASSERT_EQUAL_DOUBLE(now_ds == 200 ? 1.0 : 0.0, streets.counts(0).left_veh()[1]);
        streets.end_second();
    }
    TEST_ASSERT_EQUAL_DOUBLE(0.0, streets.delay_veh_s());
}

void test_wrong_options_of_the_profile_are_named() {
    const auto refused = [](const std::string &profile) {
        return message_of<BadRequest>([&] { (void)make_scenario(profile, nullptr); }, profile);
    };
    expect_words(refused("discrete@site=frob"), {"site", "\"frob\"", "four_way"});
    expect_words(refused("discrete@demand=frob"), {"\"frob\"", "poisson, alternating"});
    expect_words(refused("discrete@speed=0"), {"speed", "is 0", "5 to 200"});
    expect_words(refused("discrete@length=100"), {"length", "is 100", "115 to"});
    expect_words(refused("discrete@speed=fast"), {"speed", "\"fast\"", "a number"});
    expect_words(refused("discrete@frob=1"), {"\"frob\"", "site, demand, speed, length"});
    expect_words(refused("paper@speed=50"), {"paper@speed=50", "only discrete"});
    expect_words(message_of<BadRequest>([] { (void)make_scenario("discrete@site=four_way", &elmopp_site_one_way); }),
                 {"--site", "two sites"});
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_a_full_queue_leaves_at_the_saturation_headway_after_the_startup_loss);
    RUN_TEST(test_headways_of_fractions_of_a_tick_do_not_add_up);
    RUN_TEST(test_who_comes_to_an_open_stop_line_loses_nothing);
    RUN_TEST(test_delay_is_against_driving_at_the_limit);
    RUN_TEST(test_the_longest_wait_is_the_greatest_and_not_the_last);
    RUN_TEST(test_only_who_is_within_the_reach_is_counted);
    RUN_TEST(test_a_full_arm_keeps_vehicles_outside_and_their_waiting_counts);
    RUN_TEST(test_room_comes_to_the_tail_one_start_after_another);
    RUN_TEST(test_a_full_bay_holds_up_those_behind_it);
    RUN_TEST(test_turns_have_their_shares);
    RUN_TEST(test_who_gives_way_is_read_from_names_and_conflicts);
    RUN_TEST(test_who_gives_way_in_the_street_is_who_the_site_says);
    RUN_TEST(test_a_left_turn_that_gives_way_waits_for_a_gap);
    RUN_TEST(test_who_waits_in_the_junction_clears_at_the_end);
    RUN_TEST(test_a_left_turn_holds_up_its_shared_lane_and_no_other);
    RUN_TEST(test_a_shared_lane_flows_through_the_gaps_of_the_other_side);
    RUN_TEST(test_left_turns_from_opposite_sides_pass_before_each_other);
    RUN_TEST(test_two_lanes_discharge_twice_what_one_does);
    RUN_TEST(test_a_left_turn_from_a_lane_of_its_own_holds_up_nobody);
    RUN_TEST(test_amber_is_used_for_a_second);
    RUN_TEST(test_the_same_seed_brings_the_same_vehicles_and_an_approach_does_not_depend_on_others);
    RUN_TEST(test_every_pattern_brings_the_asked_number);
    RUN_TEST(test_alternating_demand_is_light_then_heavy);
    RUN_TEST(test_the_oracle_knows_who_reaches_the_reach_and_when);
    RUN_TEST(test_no_vehicle_is_lost_whatever_the_lamps_do);
    RUN_TEST(test_a_site_says_how_fast_its_approaches_are);
    RUN_TEST(test_each_arm_is_driven_at_its_own_limit);
    RUN_TEST(test_wrong_options_of_the_profile_are_named);
    return UNITY_END();
}
