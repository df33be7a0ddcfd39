// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Networks: the adjacency tensor, roads that fill up to the junction before, and what neighbours tell each other.

#include "error.hpp"
#include "expect.hpp"
#include "networks.hpp"
#include "road_network.hpp"
#include "road_network_trial.hpp"
#include "streets.hpp"
#include "trial.hpp"

#include <cmath>
#include <numeric>

using namespace elmopp;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

namespace {

enum Movement : std::uint8_t { NL, NM, NR, EL, EM, ER, SL, SM, SR, WL, WM, WR };
enum Side : std::uint8_t { N, E, S, W };
constexpr std::uint32_t all_open = 0xFFFFFFFFU;

const Way &way_of(const Network &network, std::size_t junction, Movement movement) {
    for (const auto &arm : network.plan[junction].arms) {
        for (const auto &way : arm.ways) {
            if (way.movement == movement) {
                return way;
            }
        }
    }
    TEST_FAIL_MESSAGE("no such way");
    return network.plan[0].arms[0].ways[0];
}

void expect_leads_to(const Way &way, std::size_t junction, Side approach) {
    TEST_ASSERT_TRUE(way.to.has_value());
    TEST_ASSERT_EQUAL_size_t(junction, way.to->junction);
    TEST_ASSERT_EQUAL_size_t(approach, way.to->approach);
}

/// The paper's a b / d c as in networks/g_alpha.toml.
NetworkText g_alpha() {
    NetworkText text;
    text.name = "g_alpha";
    text.nodes = {{"a", "four_way", {"", "b", "d", ""}, {}},
                  {"b", "four_way", {"", "", "c", "a"}, {}},
                  {"c", "four_way", {"b", "", "", "d"}, {}},
                  {"d", "four_way", {"a", "c", "", ""}, {}}};
    const Entry none{0, 0, 0};
    const Entry all{1, 1, 1};
    text.adjacency = {
        {none, {0, 1, 1}, none, all}, {{0, 0, 1}, none, all, none}, {none, all, none, all}, {all, none, all, none}};
    return text;
}

// From a to b 250 m at 36 km/h; the reach of 100 m takes 10 s, the road before it 15 s.
void test_a_road_has_the_length_and_the_limit_that_are_told_of_it() {
    NetworkText text = g_alpha();
    text.nodes[1].roads[W] = {250.0, 36.0};
    text.nodes[0].roads[N] = {std::nullopt, 72.0};
    const Network network = make_network(text, "discrete");
    const auto &b = network.scenarios[1].junction;
    TEST_ASSERT_EQUAL_INT64(150, road_ds(b, network.plan[1].arms[W]));
    TEST_ASSERT_EQUAL_INT64(100, reach_ds(b, network.plan[1].arms[W]));
    TEST_ASSERT_EQUAL_INT64(72, reach_ds(b, network.plan[1].arms[N]));
    TEST_ASSERT_EQUAL_INT64(50, reach_ds(b, network.plan[0].arms[N]));
    TEST_ASSERT_EQUAL_INT64(100, road_ds(b, network.plan[0].arms[N])); // 200 m
    TEST_ASSERT_EQUAL_UINT(10, network.scenarios[1].setting().travel_s[WM]);
    TEST_ASSERT_EQUAL_UINT(7, network.scenarios[1].setting().travel_s[EM]);
    TEST_ASSERT_EQUAL_UINT(5, network.scenarios[0].setting().travel_s[NM]);
}

void test_a_road_that_cannot_be_is_named() {
    const auto refused = [](const RoadText &road, Side side, const char *site) {
        NetworkText text = grid(1, 1);
        text.nodes[0].site = site;
        text.nodes[0].roads[side] = road;
        return message_of<BadRequest>([&] { (void)make_network(text, "discrete"); });
    };
    expect_words(refused({100.0, std::nullopt}, N, "four_way"),
                 {"grid:1x1", "junction 0.0", "road N", "length is 100", "115 to"});
    expect_words(refused({std::nullopt, 4.0}, S, "four_way"), {"road S", "speed is 4", "5 to 200"});
    expect_words(refused({300.0, std::nullopt}, N, "three_way"), {"road N", "three_way", "no approach"});
}

void test_turns_lead_to_the_neighbour_on_their_side() {
    const Network network = make_network(grid(2, 2), "discrete"); // 0 1 over 2 3
    expect_leads_to(way_of(network, 0, EL), 2, N);
    expect_leads_to(way_of(network, 0, NM), 2, N);
    expect_leads_to(way_of(network, 0, WM), 1, W);
    expect_leads_to(way_of(network, 0, NL), 1, W);
    expect_leads_to(way_of(network, 0, SR), 1, W);
    expect_leads_to(way_of(network, 3, WL), 1, S);
    TEST_ASSERT_FALSE(way_of(network, 0, NR).to.has_value());
    TEST_ASSERT_FALSE(way_of(network, 0, SM).to.has_value());
    TEST_ASSERT_TRUE(network.plan[0].arms[N].from_outside && network.plan[0].arms[W].from_outside);
    TEST_ASSERT_FALSE(network.plan[0].arms[E].from_outside || network.plan[0].arms[S].from_outside);
}

void test_a_turn_without_lanes_in_the_tensor_is_a_dead_edge() {
    const Network network = make_network(g_alpha(), "discrete");
    // From a to b: no left. From b to a: right alone.
    TEST_ASSERT_EQUAL_DOUBLE(0.0, way_of(network, 1, WL).share);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.75, way_of(network, 1, WM).share);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.25, way_of(network, 1, WR).share);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, way_of(network, 0, EM).share);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0, way_of(network, 0, ER).share);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, network.scenarios[1].junction.movement[WL].capacity_veh);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, elmopp_junction_load(&network.scenarios[1].junction, WL, 3.0F));
    TEST_ASSERT_TRUE(network.scenarios[0].junction.movement[NL].capacity_veh > 0.0F);
}

void test_a_tensor_that_does_not_fit_the_neighbours_is_named() {
    const auto refused = [](const NetworkText &text) {
        return message_of<BadRequest>([&] { (void)make_network(text, "discrete"); });
    };
    NetworkText road = g_alpha();
    road.adjacency[0][2] = {1, 0, 0};
    expect_words(refused(road), {"from a to c", "adjacency and neighbours differ"});
    NetworkText missing = g_alpha();
    missing.adjacency[2][3] = {0, 0, 0};
    expect_words(refused(missing), {"from c to d", "differ"});
    NetworkText nobody = g_alpha();
    nobody.nodes[0].neighbours[E] = "x";
    expect_words(refused(nobody), {"\"x\"", "of a", "no such junction"});
    NetworkText site = g_alpha();
    site.nodes[1].site = "five_way";
    expect_words(refused(site), {"junction b", "SE", "N, E, S or W"});
}

/// Two junctions beside each other; so many vehicles come to the west of the first, all straight on.
class Row {
  public:
    explicit Row(std::int64_t vehicles) : network_(make_network(grid(1, 2), "discrete")) {
        for (auto &junction : network_.plan) {
            for (auto &way : junction.arms[W].ways) {
                way.share = way.movement == WM ? 1.0 : 0.0;
            }
        }
        std::vector<Comings> comings(2, Comings(4));
        for (std::int64_t i = 0; i < vehicles; ++i) {
            comings[0][W].push_back({20 * i, static_cast<std::uint64_t>(i)});
        }
        streets.emplace(network_.plan, comings);
    }

    void run(unsigned seconds, std::uint32_t first, std::uint32_t second) {
        for (unsigned t = 0; t < seconds; ++t) {
            streets->begin_second();
            for (unsigned tick = 0; tick < 10; ++tick) {
                streets->tick({first, second});
            }
            streets->end_second();
            streets->check_conservation();
            crossed_first_veh += streets->counts(0).left_veh()[WM];
        }
    }

    std::optional<Streets> streets;
    double crossed_first_veh = 0.0;

  private:
    Network network_;
};

// A lane straight on stores 13 within the reach and 26 before it.
void test_a_full_road_blocks_the_junction_before_it() {
    Row row(80);
    row.run(400, all_open, 0);
    TEST_ASSERT_EQUAL_DOUBLE(39.0, row.crossed_first_veh);
    TEST_ASSERT_EQUAL_size_t(0, row.streets->total_out_veh());
    TEST_ASSERT_EQUAL_FLOAT(39.0F, row.streets->downstream_veh(0)[WM]);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, row.streets->downstream_veh(1)[WM]);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, row.streets->downstream_veh(0)[EM]);
    row.run(400, all_open, all_open);
    TEST_ASSERT_EQUAL_size_t(80, row.streets->total_out_veh());
}

// 200 m of road at 50 km/h: 14.4 s.
void test_a_neighbour_announces_what_has_left_it_until_it_comes() {
    Row row(1);
    row.run(7, all_open, 0); // at the stop line after 7.2 s of reach
    TEST_ASSERT_EQUAL_UINT(0, row.streets->outflow_to({1, W}).next60);
    row.run(1, all_open, 0);
    const Outflow left = row.streets->outflow_to({1, W});
    TEST_ASSERT_EQUAL_UINT(0, left.next10);
    TEST_ASSERT_EQUAL_UINT(10, left.next30);
    TEST_ASSERT_EQUAL_UINT(10, left.next60);
    row.run(4, all_open, 0);
    TEST_ASSERT_EQUAL_UINT(10, row.streets->outflow_to({1, W}).next10);
    row.run(10, all_open, 0); // 22 s: 7.2 + 14.4 are over
    TEST_ASSERT_EQUAL_UINT(0, row.streets->outflow_to({1, W}).next60);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, row.streets->counts(1).queue_veh()[WM]);
    TEST_ASSERT_EQUAL_UINT(0, row.streets->outflow_to({0, W}).next60);
}

void test_what_is_announced_reaches_the_chooser_and_the_vehicles_stay_the_same() {
    const Network network = make_network(grid(2, 2), "discrete");
    const ChooserSpec chooser = parse_chooser("cumulative:mean");
    const Metrics without = run_network(network, {chooser, false, 200, 0}, 1, 600);
    const Metrics again = run_network(network, {chooser, false, 200, 0}, 1, 600);
    const Metrics with = run_network(network, {chooser, true, 200, 0}, 1, 600);
    TEST_ASSERT_EQUAL_DOUBLE(without.mean_delay_s, again.mean_delay_s);
    TEST_ASSERT_EQUAL_DOUBLE(without.vehicles_in, with.vehicles_in);
    TEST_ASSERT_TRUE(without.mean_delay_s != with.mean_delay_s);
    TEST_ASSERT_EQUAL_DOUBLE(with.vehicles_in, with.vehicles_out + with.vehicles_queued + with.vehicles_outside);
    // Who reads no forecast does not hear it.
    const ChooserSpec deaf = parse_chooser("naive");
    TEST_ASSERT_EQUAL_DOUBLE(run_network(network, {deaf, false, 200, 0}, 1, 300).mean_delay_s,
                             run_network(network, {deaf, true, 200, 0}, 1, 300).mean_delay_s);
}

/// Counts that the test makes up.
class MadeUp final : public Counted {
  public:
    explicit MadeUp(std::size_t movements) : Counted(movements) {}
    void set(std::size_t movement, double queue_veh, double arrived_veh) {
        queue_veh_[movement] = queue_veh;
        arrived_veh_[movement] = arrived_veh;
    }
};

// The same counts and the same words of neighbours, once in numbers and once in frames.
void test_a_controller_hears_in_frames_what_a_pilot_hears_in_numbers() {
    const Network network = make_network(grid(1, 2), "discrete");
    const Scenario &scenario = network.scenarios[1];
    for (const auto *chooser : {"cumulative:persistence", "rollout:none"}) {
        Announced announced{};
        announced[W].ahead_s = 14;
        Demand demand{Series(4), 0, std::vector<elmopp_ar8_t>(4, shipped_weights("lstm")->ar8), {}, {}};
        demand.announced = &announced;
        const ChooserSpec spec = parse_chooser(chooser);
        const auto direct = make_direct(scenario, spec, demand);
        const auto framed = make_framed(scenario, spec, demand, make_inproc(scenario, spec, demand));
        MadeUp world(scenario.junction.movement_count);
        SplitMix64 random(7);
        double heard_veh = 0.0;
        for (std::size_t t = 0; t < 300; ++t) {
            for (std::size_t j = 0; j < scenario.junction.movement_count; ++j) {
                world.set(j, std::floor(10.0 * random.uniform()), std::floor(2.0 * random.uniform()));
            }
            announced[W].next10_veh = static_cast<float>(std::floor(4.0 * random.uniform()));
            announced[W].next30_veh = announced[W].next10_veh + 1.0F;
            announced[W].next60_veh = announced[W].next30_veh;
            direct->count(world, t);
            framed->count(world, t);
            for (unsigned tick = 0; tick < ELMOPP_LAMP_TICKS_PER_S; ++tick) {
                (void)direct->lamp_tick();
                (void)framed->lamp_tick();
            }
            for (std::size_t i = 0; i < scenario.junction.approach_count; ++i) {
                TEST_ASSERT_EQUAL_FLOAT(direct->told().foreseen_veh[i], framed->told().foreseen_veh[i]);
            }
            heard_veh += static_cast<double>(framed->told().foreseen_veh[W]);
        }
        TEST_ASSERT_TRUE(heard_veh > 300.0);
    }
}

void test_controllers_of_a_network_hear_their_neighbours_in_frames() {
    const Network network = make_network(grid(1, 2), "discrete");
    const ChooserSpec chooser = parse_chooser("cumulative:mean");
    const Metrics without = run_network(network, {chooser, false, 200, 0, true}, 1, 600);
    const Metrics with = run_network(network, {chooser, true, 200, 0, true}, 1, 600);
    TEST_ASSERT_EQUAL_DOUBLE(without.vehicles_in, with.vehicles_in);
    TEST_ASSERT_TRUE(without.mean_delay_s != with.mean_delay_s);
    TEST_ASSERT_EQUAL_DOUBLE(with.vehicles_in, with.vehicles_out + with.vehicles_queued + with.vehicles_outside);
}

void test_max_pressure_sees_the_roads_behind() {
    const Network network = make_network(grid(2, 2), "discrete");
    const Network alone = make_network(grid(1, 1), "discrete");
    const ChooserSpec chooser = parse_chooser("max-pressure");
    TEST_ASSERT_TRUE(run_network(alone, {chooser, false, 200, 0}, 1, 300).vehicles_out > 0.0);
    TEST_ASSERT_TRUE(run_network(network, {chooser, false, 200, 0}, 1, 300).vehicles_out > 0.0);
}

void test_a_grid_of_one_is_the_single_junction() {
    const Network network = make_network(grid(1, 1), "discrete");
    const Metrics metrics = run_network(network, {parse_chooser("naive"), false, 300, 4}, 1, 2000);
    const Scenario scenario = make_scenario("discrete", nullptr);
    const Demand demand = make_discrete_demand(scenario, {}, 300.0, 1, 4, 2000);
    const Metrics single = run_trial(scenario, parse_chooser("naive"), demand, 2000, {});
    TEST_ASSERT_EQUAL_DOUBLE(single.mean_delay_s, metrics.mean_delay_s);
    TEST_ASSERT_EQUAL_DOUBLE(single.vehicles_out, metrics.vehicles_out);
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_a_road_has_the_length_and_the_limit_that_are_told_of_it);
    RUN_TEST(test_a_road_that_cannot_be_is_named);
    RUN_TEST(test_turns_lead_to_the_neighbour_on_their_side);
    RUN_TEST(test_a_turn_without_lanes_in_the_tensor_is_a_dead_edge);
    RUN_TEST(test_a_tensor_that_does_not_fit_the_neighbours_is_named);
    RUN_TEST(test_a_full_road_blocks_the_junction_before_it);
    RUN_TEST(test_a_neighbour_announces_what_has_left_it_until_it_comes);
    RUN_TEST(test_what_is_announced_reaches_the_chooser_and_the_vehicles_stay_the_same);
    RUN_TEST(test_a_controller_hears_in_frames_what_a_pilot_hears_in_numbers);
    RUN_TEST(test_controllers_of_a_network_hear_their_neighbours_in_frames);
    RUN_TEST(test_max_pressure_sees_the_roads_behind);
    RUN_TEST(test_a_grid_of_one_is_the_single_junction);
    return UNITY_END();
}
