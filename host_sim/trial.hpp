// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Trial: one controller in one junction under one inflow, second by second, and what came of it.
///
/// Order of a second (paper, appendix; docs/algorithm.md): arrivals, counts, decision, ten lamp ticks, discharge,
/// metrics.

#pragma once

#include "choosers.hpp"
#include "comings.hpp"
#include "control.hpp"
#include "counted.hpp"
#include "foresight.hpp"
#include "inflow.hpp"
#include "scenario.hpp"
#include "streets.hpp"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace elmopp {

/// One generated trajectory, ready for every number of vehicles: mapped, normalised, its AR(8) fitted.
struct Source {
    Series unit;
    std::vector<elmopp_ar8_t> ar8; ///< [approach]
    unsigned random_vehicles = 0;
};

Source make_source(Integrator integrator, Mapping mapping, std::uint64_t seed, std::uint64_t trial,
                   std::size_t approaches);

/// What neighbours announce, by approach; all zero where there is none that speaks.
using Announced = std::array<elmopp_outflow_t, ELMOPP_APPROACH_MAX>;

/// The vehicles of one trajectory or trace, scaled to a demand, with everything that the forecasts need to know
/// beforehand.
struct Demand {
    Series veh_per_s;                  ///< [approach][point]
    std::size_t origin;                ///< point of second 0; what lies before is known to the forecasts
    std::vector<elmopp_ar8_t> ar8;     ///< [approach]
    std::vector<float> mean_veh_per_s; ///< [approach]; empty: the forecast averages for itself
    std::vector<std::vector<float>>
        future_veh; ///< [approach][second + 1...]: the oracle's rows, ELMOPP_HORIZON_MAX longer
    /// What a network was found to say; null: it runs inside the trial. The rows count `vehicles_per_approach` times.
    const Foresight *foresight = nullptr;
    double vehicles_per_approach = 1.0;
    const elmopp_weights_t *weights = nullptr; ///< instead of the shipped ones
    /// Profile discrete: the vehicles one by one; veh_per_s and future_veh then are their counts at the edge of the
    /// reach if nobody were in their way.
    Comings comings = {};
    /// Kept up to date by its owner. Null: nothing is announced.
    const Announced *announced = nullptr;
};

/// The arrivals as the core counts them.
class Arrivals {
  public:
    Arrivals(const Scenario &scenario, const Demand &demand);
    /// [movement] vehicles of the second at this point of the series; valid until the next call.
    const float *at(std::size_t point);
    /// Shows a pilot what is known before second -until_s, at most the last 15 minutes.
    void absorb_known(elmopp_pilot_t &pilot, std::size_t until_s);

  private:
    const Scenario &scenario_;
    const Demand &demand_;
    std::vector<float> arrived_veh_;
};

/// What an oracle foresees: the series from `first` on, for as long as a run of so many seconds can ask; zeros beyond.
std::vector<float> rows_from(const std::vector<double> &series, std::size_t first, std::size_t seconds);

/// Scales a unit series to so many vehicles an approach and prepares the oracle's rows for `seconds`.
Demand make_demand(const Series &unit, double vehicles_per_approach, std::size_t origin,
                   const std::vector<elmopp_ar8_t> &ar8, bool known_mean, std::size_t seconds);

/// The same for single vehicles at one junction: draws them. `unit` is the paper's inflow, of which demand hyperchaos
/// makes rates.
Demand make_discrete_demand(const Scenario &scenario, const Series &unit, double vehicles_per_approach,
                            std::uint64_t seed, std::uint64_t trial, std::size_t seconds);

/// The forecast that the core makes for itself; what comes from outside is none to it. Without a learner.
elmopp_forecast_config_t forecast_of(const ChooserSpec &spec, const Demand &demand);

/// Metrics of docs/algorithm.md, 1.5.
struct Metrics {
    double throughput_veh_per_s = 0.0;
    double served_share = 0.0;
    double mean_delay_s = 0.0;
    double longest_red_s = 0.0;
    double switches = 0.0;
    double figure_throughput_veh_per_s = 0.0;
    double vehicles_in = 0.0;
    double vehicles_out = 0.0;
    double vehicles_queued = 0.0;
    double vehicles_outside = 0.0;
    /// Single vehicles only: the most that one has lost on an arm against driving at the limit, outside included.
    std::optional<double> longest_wait_s;
};

/// What both kinds of traffic sum up over a run.
struct Totals {
    double in_veh;
    double out_veh;
    double out_squared; ///< of the outflow of each second
    double late_veh_s;  ///< of all vehicles
};

/// The metrics that follow from the sums; the others are 0.
Metrics metrics_of(const Totals &total, std::size_t seconds);

/// One second, as a log sees it after the discharge.
struct Second {
    std::size_t t_s;
    const Told &told;
    const elmopp_lamps_t &lamps;
    const Counted &world;
    const std::vector<double> &red_s; ///< [movement]
};

using Observer = std::function<void(const Second &)>;

/// Runs it. `observer` may be empty. Throws Failure if a vehicle is lost.
Metrics run_trial(const Scenario &scenario, const ChooserSpec &chooser, const Demand &demand, std::size_t seconds,
                  const Observer &observer);

/// The same with a controller that the caller has made; it is left as second `seconds` found it.
Metrics run_trial(const Scenario &scenario, Control &control, const Demand &demand, std::size_t seconds,
                  const Observer &observer);

} // namespace elmopp
