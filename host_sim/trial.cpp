// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "trial.hpp"

#include "autoregression.hpp"
#include "error.hpp"
#include "jobs.hpp"
#include "networks.hpp"
#include "signals.hpp"
#include "stats.hpp"
#include "street_trial.hpp"
#include "traffic.hpp"

#include <algorithm>

namespace elmopp {
namespace {

constexpr double metric_min_veh = 1.0; ///< a lane with less is nobody's red

/// Sums up what the metrics need.
class Meter {
  public:
    void second(const Traffic &traffic, const std::vector<double> &red_s, elmopp_stage_t stage) {
        const double out = sum(traffic.left_veh());
        out_squared_ += out * out;
        queued_veh_s_ += sum(traffic.queue_veh()) + sum(traffic.outside_veh());
        for (std::size_t j = 0; j < red_s.size(); ++j) {
            if (traffic.queue_veh()[j] >= metric_min_veh) {
                longest_red_s_ = std::max(longest_red_s_, red_s[j]);
            }
        }
        switches_.see(stage);
    }

    [[nodiscard]] Metrics result(const Traffic &traffic, std::size_t seconds) const {
        Metrics metrics =
            metrics_of({traffic.total_in_veh(), traffic.total_out_veh(), out_squared_, queued_veh_s_}, seconds);
        metrics.longest_red_s = longest_red_s_;
        metrics.switches = switches_.count();
        metrics.vehicles_queued = sum(traffic.queue_veh());
        metrics.vehicles_outside = sum(traffic.outside_veh());
        return metrics;
    }

  private:
    double out_squared_ = 0.0;
    double queued_veh_s_ = 0.0;
    double longest_red_s_ = 0.0;
    Switches switches_;
};

} // namespace

Metrics metrics_of(const Totals &total, std::size_t seconds) {
    Metrics metrics;
    metrics.throughput_veh_per_s = total.out_veh / static_cast<double>(seconds);
    metrics.served_share = total.in_veh > 0.0 ? total.out_veh / total.in_veh : 0.0;
    metrics.mean_delay_s = total.in_veh > 0.0 ? total.late_veh_s / total.in_veh : 0.0;
    metrics.figure_throughput_veh_per_s = total.out_veh > 0.0 ? total.out_squared / total.out_veh : 0.0;
    metrics.vehicles_in = total.in_veh;
    metrics.vehicles_out = total.out_veh;
    return metrics;
}

elmopp_forecast_config_t forecast_of(const ChooserSpec &spec, const Demand &demand) {
    const elmopp_weights_t *weights = demand.weights != nullptr ? demand.weights : shipped_weights(spec.forecast);
    return {demand.foresight != nullptr ? forecast_kind("none") : forecast_kind(spec.forecast),
            demand.ar8.data(),
            demand.mean_veh_per_s.empty() ? nullptr : demand.mean_veh_per_s.data(),
            weights,
            nullptr,
            false};
}

Arrivals::Arrivals(const Scenario &scenario, const Demand &demand)
    : scenario_(scenario), demand_(demand), arrived_veh_(scenario.junction.movement_count) {}

const float *Arrivals::at(std::size_t point) {
    for (std::size_t j = 0; j < arrived_veh_.size(); ++j) {
        const double inflow = demand_.veh_per_s[scenario_.junction.movement[j].approach][point];
        arrived_veh_[j] = static_cast<float>(inflow * scenario_.share[j]);
    }
    return arrived_veh_.data();
}

void Arrivals::absorb_known(elmopp_pilot_t &pilot, std::size_t until_s) {
    const std::size_t end = demand_.origin - std::min(demand_.origin, until_s);
    const std::size_t known = std::min<std::size_t>(end, ELMOPP_FORECAST_MEAN_WINDOW_S);
    for (std::size_t point = end - known; point < end; ++point) {
        elmopp_pilot_absorb(&pilot, at(point));
    }
}

Source make_source(Integrator integrator, Mapping mapping, std::uint64_t seed, std::uint64_t trial,
                   std::size_t approaches) {
    const Trajectory trajectory = draw_trajectory(integrator, seed, trial, approaches);
    Source source{unit_inflow(trajectory, mapping, approaches), {}, trajectory.random_vehicles};
    for (const auto &series : source.unit) {
        source.ar8.push_back(fit_ar8(series));
    }
    return source;
}

std::vector<float> rows_from(const std::vector<double> &series, std::size_t first, std::size_t seconds) {
    std::vector<float> rows(seconds + ELMOPP_HORIZON_MAX, 0.0F);
    for (std::size_t t = 0; t < rows.size() && first + t < series.size(); ++t) {
        rows[t] = static_cast<float>(series[first + t]);
    }
    return rows;
}

Demand make_demand(const Series &unit, double vehicles_per_approach, std::size_t origin,
                   const std::vector<elmopp_ar8_t> &ar8, bool known_mean, std::size_t seconds) {
    Demand demand{unit, origin, ar8, {}, {}, nullptr, vehicles_per_approach};
    for (auto &series : demand.veh_per_s) {
        for (double &value : series) {
            value *= vehicles_per_approach;
        }
        if (known_mean) {
            demand.mean_veh_per_s.push_back(static_cast<float>(training_mean(series)));
        }
        demand.future_veh.push_back(rows_from(series, origin + 1, seconds));
    }
    return demand;
}

Demand make_discrete_demand(const Scenario &scenario, const Series &unit, double vehicles_per_approach,
                            std::uint64_t seed, std::uint64_t trial, std::size_t seconds) {
    const double mean_veh_per_s = vehicles_per_approach / static_cast<double>(simulated_points);
    const Series rate =
        rates(scenario.surroundings().demand, unit, scenario.junction.approach_count, mean_veh_per_s, seed, trial);
    const Comings comings = draw_comings(rate, seed, trial);
    const Series counts = counted(comings);
    std::vector<elmopp_ar8_t> ar8;
    ar8.reserve(counts.size());
    for (const auto &series : counts) {
        ar8.push_back(training_mean(series) > 0.0 ? fit_ar8(series) : shipped_weights("lstm")->ar8);
    }
    Demand demand = make_demand(counts, 1.0, training_points, ar8, true, seconds);
    // Counts of second t are known when the next one begins: row 0 is what comes in the second that begins.
    for (std::size_t i = 0; i < counts.size(); ++i) {
        demand.future_veh[i] = rows_from(counts[i], training_points, seconds);
    }
    demand.comings = comings;
    return demand;
}

Metrics run_trial(const Scenario &scenario, const ChooserSpec &chooser, const Demand &demand, std::size_t seconds,
                  const Observer &observer) {
    const auto control = make_direct(scenario, chooser, demand);
    return run_trial(scenario, *control, demand, seconds, observer);
}

Metrics run_trial(const Scenario &scenario, Control &control, const Demand &demand, std::size_t seconds,
                  const Observer &observer) {
    if (scenario.street) {
        return run_streets(plan_of(scenario), {{scenario, control, demand}}, seconds, observer);
    }
    Traffic traffic(scenario);
    Signals signals(scenario.junction);
    Meter meter;
    std::vector<double> inflow(scenario.junction.approach_count);
    std::vector<double> flowing(scenario.capacity_veh.size());
    std::vector<double> red_s(scenario.capacity_veh.size());
    for (std::size_t t = 0; t < seconds; ++t) {
        check_interrupt();
        for (std::size_t i = 0; i < inflow.size(); ++i) {
            inflow[i] = demand.veh_per_s[i][demand.origin + t];
        }
        traffic.arrive(inflow);
        control.count(traffic, t);
        signals.begin_second();
        elmopp_lamps_t lamps{};
        for (unsigned tick = 0; tick < ELMOPP_LAMP_TICKS_PER_S; ++tick) {
            lamps = control.lamp_tick();
            signals.show(lamps);
        }
        for (std::size_t j = 0; j < red_s.size(); ++j) {
            flowing[j] = signals.flowing(j);
            red_s[j] = signals.red_s(j);
        }
        traffic.leave(flowing);
        traffic.check_conservation();
        const Told told = control.told();
        meter.second(traffic, red_s, told.stage);
        if (observer) {
            observer({t, told, lamps, traffic, red_s});
        }
    }
    return meter.result(traffic, seconds);
}

} // namespace elmopp
