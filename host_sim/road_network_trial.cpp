// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "road_network_trial.hpp"

#include "control.hpp"
#include "jobs.hpp"
#include "networks.hpp"
#include "output_folder.hpp"
#include "results.hpp"
#include "street_trial.hpp"

#include <algorithm>
#include <iostream>
#include <memory>

namespace elmopp {
namespace {

constexpr unsigned trial_bits = 20; ///< a junction draws as if it were a trial far away
constexpr float tenths_per_veh = 10.0F;
constexpr std::size_t seconds_of_trial = simulated_points;

/// Vehicles from outside come to the arms that begin there. Nobody knows the past or the mean: the forecasts start cold
/// and with the shipped regression, as on a street. The oracle knows who comes from outside, not who from a neighbour.
Demand demand_of(const Network &network, std::size_t v, const NetworkCell &cell, std::uint64_t seed,
                 std::size_t seconds) {
    const Scenario &scenario = network.scenarios[v];
    const std::size_t approaches = scenario.junction.approach_count;
    const double mean_veh_per_s = static_cast<double>(cell.vehicles) / static_cast<double>(simulated_points);
    const std::uint64_t stream = cell.trial + (static_cast<std::uint64_t>(v) << trial_bits);
    const Surroundings &street = scenario.surroundings();
    Series unit;
    if (street.demand == "hyperchaos") {
        unit = unit_inflow(draw_trajectory(Integrator::rk4, seed, stream, approaches), Mapping::abs, approaches);
    }
    Series rate = rates(street.demand, unit, approaches, mean_veh_per_s, seed, stream);
    for (std::size_t i = 0; i < approaches; ++i) {
        if (!network.plan[v].arms[i].from_outside) {
            rate[i].assign(rate[i].size(), 0.0);
        }
    }
    Demand demand{Series(approaches), 0, std::vector<elmopp_ar8_t>(approaches, shipped_weights("lstm")->ar8), {}, {}};
    demand.comings = draw_comings(rate, seed, stream);
    const Series counts = counted(demand.comings);
    for (const auto &series : counts) {
        demand.future_veh.push_back(rows_from(series, training_points, seconds));
    }
    return demand;
}

/// What the junctions of one trial know of each other.
class Neighbourhood {
  public:
    explicit Neighbourhood(const Network &network)
        : network_(network), downstream_veh_(network.plan.size()), announced_(network.plan.size()) {
        for (std::size_t v = 0; v < network.plan.size(); ++v) {
            downstream_veh_[v].resize(network.scenarios[v].junction.movement_count);
            for (std::size_t i = 0; i < network.plan[v].arms.size(); ++i) {
                const ArmPlan &arm = network.plan[v].arms[i];
                const std::int64_t ahead_ds = arm.from_outside ? 0 : road_ds(network.scenarios[v].junction, arm);
                announced_[v].at(i).ahead_s = static_cast<std::uint16_t>(ahead_ds / ds_per_second);
            }
        }
    }

    void tell(const Streets &streets) {
        for (std::size_t v = 0; v < announced_.size(); ++v) {
            const auto behind_veh = streets.downstream_veh(v);
            std::copy(behind_veh.begin(), behind_veh.end(), downstream_veh_[v].begin()); // choosers keep the address
            for (std::size_t i = 0; i < network_.plan[v].arms.size(); ++i) {
                const Outflow outflow = streets.outflow_to({v, i});
                announced_[v].at(i).next10_veh = static_cast<float>(outflow.next10) / tenths_per_veh;
                announced_[v].at(i).next30_veh = static_cast<float>(outflow.next30) / tenths_per_veh;
                announced_[v].at(i).next60_veh = static_cast<float>(outflow.next60) / tenths_per_veh;
            }
        }
    }

    [[nodiscard]] const float *downstream_veh(std::size_t v) const {
        return downstream_veh_[v].data();
    }
    [[nodiscard]] const Announced *announced(std::size_t v) const {
        return &announced_[v];
    }

  private:
    const Network &network_;
    std::vector<std::vector<float>> downstream_veh_;
    std::vector<Announced> announced_;
};

/// By the pilot, or by the whole controller behind its frames.
std::unique_ptr<Control> control_of(const Scenario &scenario, const NetworkCell &cell, const Demand &demand) {
    return cell.framed ? make_framed(scenario, cell.chooser, demand, make_inproc(scenario, cell.chooser, demand))
                       : make_direct(scenario, cell.chooser, demand);
}

bool reads_forecast(const ChooserSpec &chooser) {
    const auto &kinds = chooser_kinds();
    return std::any_of(kinds.begin(), kinds.end(),
                       [&](const ChooserKind &kind) { return kind.name == chooser.name && kind.forecasts; });
}

} // namespace

Metrics run_network(const Network &network, const NetworkCell &cell, std::uint64_t seed, std::size_t seconds) {
    const std::size_t count = network.plan.size();
    Neighbourhood neighbourhood(network);
    std::vector<Scenario> scenarios = network.scenarios;
    std::vector<Demand> demands;
    std::vector<std::unique_ptr<Control>> controls;
    std::vector<Site> sites;
    demands.reserve(count);
    controls.reserve(count);
    sites.reserve(count);
    for (std::size_t v = 0; v < count; ++v) {
        scenarios[v].downstream_veh = neighbourhood.downstream_veh(v);
        demands.push_back(demand_of(network, v, cell, seed, seconds));
        demands[v].announced = cell.neighbours ? neighbourhood.announced(v) : nullptr;
        controls.push_back(control_of(scenarios[v], cell, demands[v]));
        sites.push_back({scenarios[v], *controls[v], demands[v]});
    }
    return run_streets(network.plan, sites, seconds, {},
                       [&neighbourhood](const Streets &streets) { neighbourhood.tell(streets); });
}

void run_network_experiment(const NetworkRequest &request) {
    std::string profile = request.profile;
    const NetworkText text = read_network(request.network, profile);
    const Network network = make_network(text, profile);
    std::vector<NetworkCell> cells;
    for (const auto &chooser : request.choosers) {
        (void)make_chooser(chooser, network.scenarios[0].setting()); // a wrong option ends here
        for (const bool neighbours : request.neighbours) {
            if (neighbours && request.neighbours.size() > 1 && !reads_forecast(chooser)) {
                continue; // it would not listen: the same trials again
            }
            for (const unsigned vehicles : request.vehicles) {
                for (std::uint64_t trial = 0; trial < request.trials; ++trial) {
                    cells.push_back({chooser, neighbours, vehicles, trial, request.framed});
                }
            }
        }
    }
    const OutputFolder folder(request.out, {"trials.csv", "waits.csv", "summary.json", "pairs.csv"});
    std::vector<Row> rows(cells.size());
    const auto work = [&](std::size_t i) {
        const NetworkCell &cell = cells[i];
        rows[i] = {profile + "@network=" + network.name + (cell.framed ? "@link=inproc" : ""),
                   cell.chooser.label(),
                   cell.chooser.forecast + (cell.neighbours ? "+neighbours" : ""),
                   cell.vehicles,
                   cell.trial,
                   request.seed,
                   run_network(network, cell, request.seed, seconds_of_trial)};
    };
    run_jobs(cells.size(), request.jobs, work, {});
    write_trials(folder.drafts() / "trials.csv", rows);
    write_waits(folder.drafts() / "waits.csv", rows);
    write_summary(folder.drafts() / "summary.json", rows);
    write_pairs(folder.drafts() / "pairs.csv", rows);
    std::string names;
    for (const auto &name : folder.commit()) {
        names += " " + name.string();
    }
    std::cout << "Written to " << request.out.string() << ":" << names << "\n";
}

} // namespace elmopp
