// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "accuracy.hpp"

#include "csv.hpp"
#include "foresight.hpp"
#include "jobs.hpp"
#include "learning.hpp"
#include "networks.hpp"
#include "scenario.hpp"
#include "trial.hpp"
#include "whole_file.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

namespace elmopp {
namespace {

constexpr std::size_t approaches = 4;
constexpr double judged_vehicles = 800.0; ///< any number gives the same: errors are in units of the demand scale
constexpr std::array<std::size_t, 4> horizons_s{1, 10, 30, 60};
constexpr int digits = 6;

const std::vector<std::string> &judged() {
    static const std::vector<std::string> names{"mean",       "persistence",  "ewma",  "ar8",       "lstm", "lstm-q15",
                                                "lstm-learn", "lstm-literal", "nlstm", "nlstm-q15", "ann",  "gcn"};
    return names;
}

/// The weights of each network: the shipped ones, unless others were given.
using Weights = std::map<std::string, elmopp_weights_t>;

Weights weights_of(const AccuracyRequest &request) {
    Weights weights;
    for (const auto &name : judged()) {
        if (const elmopp_weights_t *shipped = shipped_weights(name)) {
            weights[name] = *shipped;
        }
    }
    for (const auto &file : request.weights) {
        const elmopp_weights_t own = read_weights(file);
        for (auto &[name, used] : weights) {
            used = can_forecast(own, name) ? own : used;
        }
    }
    return weights;
}

const elmopp_weights_t *find(const Weights &weights, const std::string &name) {
    const auto found = weights.find(name);
    return found == weights.end() ? nullptr : &found->second;
}

/// Sums over the seconds and approaches of one trial.
struct Sums {
    std::vector<std::array<double, horizons_s.size()>> squared; ///< [judged][horizon]
    double signal = 0.0;
    double signal_squared = 0.0;
    std::vector<double> distrusted_s; ///< [judged]
};

void judge_second(const std::array<const float *, ELMOPP_APPROACH_MAX> &rows, const Demand &demand, std::size_t t,
                  std::array<double, horizons_s.size()> &squared) {
    for (std::size_t i = 0; i < approaches; ++i) {
        const auto scale = static_cast<double>(demand.mean_veh_per_s[i]);
        for (std::size_t h = 0; h < horizons_s.size(); ++h) {
            const double came = demand.veh_per_s[i][demand.origin + t + horizons_s[h]];
            const double error = (static_cast<double>(rows[i][horizons_s[h] - 1]) - came) / scale;
            squared[h] += error * error;
        }
    }
}

void judge_forecast(const std::string &name, const elmopp_weights_t *weights, const Scenario &scenario,
                    const Demand &demand, std::array<double, horizons_s.size()> &squared) {
    const auto learning = make_learning(name, weights, scenario.junction.approach_count);
    const elmopp_forecast_config_t config{
        forecast_kind(name), demand.ar8.data(), demand.mean_veh_per_s.data(), weights, learner_of(learning), false};
    elmopp_forecast_t forecast;
    elmopp_forecast_init(&forecast, &scenario.junction, &config);
    Arrivals arrivals(scenario, demand);
    for (std::size_t point = demand.origin - ELMOPP_FORECAST_MEAN_WINDOW_S; point < demand.origin; ++point) {
        elmopp_forecast_observe(&forecast, arrivals.at(point));
        elmopp_forecast_learn(&forecast);
    }
    for (std::size_t t = 0; t < simulated_points; ++t) {
        check_interrupt();
        elmopp_forecast_observe(&forecast, arrivals.at(demand.origin + t));
        std::array<const float *, ELMOPP_APPROACH_MAX> rows{};
        (void)elmopp_forecast_look(&forecast, horizons_s.back(), rows.data());
        judge_second(rows, demand, t, squared);
        elmopp_forecast_learn(&forecast);
    }
}

void measure_signal(const Demand &demand, Sums &sums) {
    for (std::size_t i = 0; i < approaches; ++i) {
        for (std::size_t t = 0; t < simulated_points; ++t) {
            const double value = demand.veh_per_s[i][demand.origin + t] / static_cast<double>(demand.mean_veh_per_s[i]);
            sums.signal += value;
            sums.signal_squared += value * value;
        }
    }
}

Sums judge_trial(const AccuracyRequest &request, const Weights &weights, std::size_t trial) {
    const Scenario scenario = make_scenario(find_profile("paper"), nullptr);
    const Source source = make_source(Integrator::rk4, Mapping::abs, request.seed, trial, approaches);
    const Demand demand =
        make_demand(source.unit, judged_vehicles, training_points, source.ar8, true, simulated_points);
    Sums sums;
    sums.squared.resize(judged().size());
    for (std::size_t k = 0; k < judged().size(); ++k) {
        const std::string &name = judged()[k];
        const elmopp_weights_t *network = find(weights, name);
        judge_forecast(name, network, scenario, demand, sums.squared[k]);
        const std::size_t distrusted =
            network == nullptr
                ? 0
                : foresee({name, *network, source.unit, ELMOPP_PILOT_TRACE_S, simulated_points}).distrusted_s;
        sums.distrusted_s.push_back(static_cast<double>(distrusted));
    }
    measure_signal(demand, sums);
    return sums;
}

nlohmann::ordered_json summary_of(const AccuracyRequest &request, const std::vector<Sums> &trials) {
    const double values = static_cast<double>(trials.size() * simulated_points * approaches);
    double signal = 0.0;
    double signal_squared = 0.0;
    for (const auto &sums : trials) {
        signal += sums.signal;
        signal_squared += sums.signal_squared;
    }
    const double mean = signal / values;
    nlohmann::ordered_json json{{"trials", request.trials},
                                {"seed", request.seed},
                                {"signal_sd", std::sqrt(signal_squared / values - mean * mean)}};
    for (std::size_t k = 0; k < judged().size(); ++k) {
        double distrusted_s = 0.0;
        std::array<double, horizons_s.size()> squared{};
        for (const auto &sums : trials) {
            distrusted_s += sums.distrusted_s[k];
            for (std::size_t h = 0; h < horizons_s.size(); ++h) {
                squared[h] += sums.squared[k][h];
            }
        }
        for (std::size_t h = 0; h < horizons_s.size(); ++h) {
            json["rmse"][judged()[k]][std::to_string(horizons_s[h])] = std::sqrt(squared[h] / values);
        }
        if (shipped_weights(judged()[k]) != nullptr) {
            json["distrusted_share"][judged()[k]] =
                distrusted_s / static_cast<double>(trials.size() * simulated_points);
        }
    }
    return json;
}

void print(const nlohmann::ordered_json &summary) {
    std::printf("root mean squared error, units of the demand scale (signal sd %s)\n",
                format_number(summary["signal_sd"].get<double>(), digits).c_str());
    std::printf("%-12s %9s %9s %9s %9s\n", "forecast", "1 s", "10 s", "30 s", "60 s");
    for (const auto &[name, by_horizon] : summary["rmse"].items()) {
        std::printf("%-12s", name.c_str());
        for (const auto &value : by_horizon) {
            std::printf(" %9.4f", value.get<double>());
        }
        std::printf("\n");
    }
    for (const auto &[name, share] : summary["distrusted_share"].items()) {
        std::printf("the controller falls back from %s in %.2f %% of the seconds\n", name.c_str(),
                    100.0 * share.get<double>());
    }
}

} // namespace

void run_accuracy(const AccuracyRequest &request) {
    std::optional<WholeFile> file;
    if (request.json) {
        file.emplace("--json", *request.json);
    }
    const Weights weights = weights_of(request);
    std::vector<Sums> trials(request.trials);
    run_jobs(trials.size(), request.jobs,
             [&](std::size_t trial) { trials[trial] = judge_trial(request, weights, trial); }, {});
    const auto summary = summary_of(request, trials);
    print(summary);
    if (file) {
        file->out() << summary.dump(1) << "\n";
        file->commit();
    }
}

} // namespace elmopp
