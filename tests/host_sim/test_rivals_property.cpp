// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Every chooser, whatever is counted: it names a stage that there is and does the same again; and no rival that looks
/// at its vehicles is as slow as chance.

#include "choosers.hpp"
#include "expect.hpp"
#include "scenario.hpp"
#include "sites.hpp"
#include "street.hpp"
#include "trial.hpp"

#include <map>
#include <random>

using namespace elmopp;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

namespace {

constexpr unsigned seconds = 2000;
constexpr unsigned travel_s = 8;
constexpr double reach_veh = 14.0;

/// Passes a chooser's answers on, and sees that each is a stage.
struct Watched {
    elmopp_chooser_t inner;
    std::string name;
};

elmopp_stage_t watch(void *state, const elmopp_view_t *view, float *score) {
    const auto &watched = *static_cast<const Watched *>(state);
    const elmopp_stage_t answer = watched.inner.choose(watched.inner.state, view, score);
    TEST_ASSERT_LESS_THAN_UINT_MESSAGE(view->junction->stage_count, answer, watched.name.c_str());
    for (std::size_t s = 0; s < ELMOPP_STAGE_MAX; ++s) {
        TEST_ASSERT_TRUE_MESSAGE(std::isfinite(score[s]), watched.name.c_str());
        TEST_ASSERT_TRUE_MESSAGE(s < view->junction->stage_count || score[s] == 0.0F, watched.name.c_str());
    }
    return answer;
}

/// Whole vehicles that come at random, in seconds of which some are empty and some full, and leave on green.
class Vehicles {
  public:
    explicit Vehicles(const elmopp_junction_t &junction) : junction_(junction), present(junction.movement_count) {
        arrived.resize(junction.movement_count);
    }

    void second(unsigned t_s, std::uint32_t going) {
        const bool empty = t_s >= 600 && t_s < 800;
        const bool full = t_s >= 1200 && t_s < 1400;
        for (std::uint32_t j = 0; j < junction_.movement_count; ++j) {
            const bool leaves = elmopp_mask_has(going, j) && random_() % 2 == 0;
            present[j] -= leaves && present[j] >= 1.0F ? 1.0F : 0.0F;
            arrived[j] = !empty && random_() % (5 + 3 * j) == 0 ? 1.0F : 0.0F;
            if (full) {
                arrived[j] = static_cast<float>(reach_veh) - present[j];
            }
            present[j] = std::min(static_cast<float>(reach_veh), present[j] + arrived[j]);
            if (t_s == 600) {
                present[j] = 0.0F; // all have gone at once: a camera may say so
            }
        }
    }

  private:
    const elmopp_junction_t &junction_;
    std::mt19937_64 random_{1};

  public:
    std::vector<float> present;
    std::vector<float> arrived;
};

/// The lamps of every second.
std::vector<std::uint32_t> lamps_of(const ChooserSpec &spec, const elmopp_junction_t &site) {
    const std::vector<float> behind_veh(site.movement_count, 3.0F);
    const Setting setting{site, site.simulation_only == 0, false, everywhere(travel_s), 7, behind_veh.data()};
    const auto plugged = make_chooser(spec, setting);
    Watched watched{plugged->chooser, spec.label() + " at " + site.name};
    const elmopp_chooser_t chooser{watch, &watched, plugged->chooser.horizon_s};
    const elmopp_forecast_config_t forecast{};
    elmopp_pilot_t pilot;
    elmopp_pilot_init(&pilot, &site, &chooser, &forecast);
    Vehicles vehicles(site);
    std::vector<std::uint32_t> lamps;
    lamps.reserve(seconds);
    for (unsigned t = 0; t < seconds; ++t) {
        vehicles.second(t, pilot.going);
        const elmopp_counts_t counts{vehicles.present.data(), vehicles.arrived.data(), 0U, nullptr};
        TEST_ASSERT_TRUE(elmopp_pilot_step(&pilot, &counts, nullptr));
        elmopp_lamps_t shown{};
        for (unsigned tick = 0; tick < ELMOPP_LAMP_TICKS_PER_S; ++tick) {
            shown = elmopp_pilot_lamp_tick(&pilot, pilot.wanted, false);
        }
        lamps.push_back((std::uint32_t{shown.green} << 16U) | shown.amber);
    }
    return lamps;
}

void test_every_chooser_names_a_stage_and_does_the_same_again() {
    for (const auto *site :
         {&elmopp_site_five_way, &elmopp_site_four_way, &elmopp_site_left_lanes, &elmopp_site_one_way,
          &elmopp_site_paper, &elmopp_site_shared_lanes, &elmopp_site_three_way}) {
        for (const auto &kind : chooser_kinds()) {
            const ChooserSpec spec = parse_chooser(kind.name);
            const auto lamps = lamps_of(spec, *site);
            const std::string what = kind.name + " at " + site->name;
            TEST_ASSERT_TRUE_MESSAGE(lamps == lamps_of(spec, *site), what.c_str());
            std::uint32_t green = 0;
            for (const std::uint32_t shown : lamps) {
                green |= shown >> 16U;
            }
            // In a street the bound on red gives everybody his green.
            const std::uint32_t all = (1U << site->group_count) - 1U;
            TEST_ASSERT_TRUE_MESSAGE(site->simulation_only != 0 || green == all, what.c_str());
        }
    }
}

/// Any counts, any stage shown, an intergreen now and then: more than a pilot would do.
void ask_wildly(const ChooserSpec &spec, const elmopp_junction_t &junction) {
    const Setting setting{junction, false, false, everywhere(3), 1, nullptr};
    const auto plugged = make_chooser(spec, setting);
    Watched watched{plugged->chooser, spec.label()};
    const elmopp_chooser_t chooser{watch, &watched, 0};
    Street street(chooser, junction);
    std::mt19937_64 random(3);
    for (unsigned t = 0; t < seconds; ++t) {
        for (std::size_t j = 0; j < junction.movement_count; ++j) {
            street.queue[j] = static_cast<float>(random() % 3 == 0 ? random() % 15 : 0);
            street.arrivals[j] = static_cast<float>(random() % 4 == 0 ? random() % 15 : 0);
        }
        (void)street.second();
        if (random() % 40 == 0) {
            street.force(static_cast<elmopp_stage_t>(random() % junction.stage_count));
        }
        for (unsigned hidden = 0; random() % 10 == 0 && hidden < 6; ++hidden) {
            (void)street.hidden_second();
        }
    }
}

void test_every_chooser_lives_with_one_stage_and_with_a_lane_that_holds_nobody() {
    elmopp_junction_t odd = elmopp_site_paper;
    odd.discharge = ELMOPP_DISCHARGE_SATURATION;
    odd.movement[EL].capacity_veh = 0.0F;
    odd.movement[EM].saturation_veh_per_s = 0.0F;
    odd.movement[WR].lanes = 0;
    elmopp_junction_t single = odd;
    single.stage_count = 1;
    single.stage_groups[0] = static_cast<std::uint16_t>((1U << single.group_count) - 1U);
    for (const auto &kind : chooser_kinds()) {
        for (const auto &junction : {odd, single, elmopp_site_paper}) {
            ask_wildly(parse_chooser(kind.name), junction);
        }
    }
}

double delay_s(const std::string &chooser, std::uint64_t trial) {
    const Scenario scenario = make_scenario(find_profile("saturation"), nullptr);
    const Source source = make_source(Integrator::rk4, Mapping::abs, 1, trial, scenario.junction.approach_count);
    const Demand demand = make_demand(source.unit, 400.0, training_points, source.ar8, true, seconds);
    return run_trial(scenario, parse_chooser(chooser), demand, seconds, {}).mean_delay_s;
}

void test_every_rival_is_faster_than_chance() {
    for (const std::uint64_t trial : {0U, 1U}) {
        const double chance_s = delay_s("random", trial);
        for (const auto &kind : chooser_kinds()) {
            if (kind.name != "random" && kind.name != "fixed") {
                const double mean_s = delay_s(kind.name, trial);
                const std::string what =
                    kind.name + ": " + std::to_string(mean_s) + " s, chance " + std::to_string(chance_s) + " s";
                TEST_ASSERT_TRUE_MESSAGE(mean_s < chance_s, what.c_str());
            }
        }
    }
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_every_chooser_names_a_stage_and_does_the_same_again);
    RUN_TEST(test_every_chooser_lives_with_one_stage_and_with_a_lane_that_holds_nobody);
    RUN_TEST(test_every_rival_is_faster_than_chance);
    return UNITY_END();
}
