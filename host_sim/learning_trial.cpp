// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "learning_trial.hpp"

#include "choosers.hpp"
#include "error.hpp"
#include "foresight.hpp"
#include "jobs.hpp"
#include "learning.hpp"
#include "networks.hpp"
#include "other_demand.hpp"
#include "scenario.hpp"
#include "stats.hpp"
#include "trial.hpp"
#include "whole_file.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <vector>

namespace elmopp {
namespace {

constexpr std::size_t approaches = 4;
constexpr std::array<std::size_t, 3> horizons_s{10, 30, 60};
constexpr std::size_t known_s = training_points;

/// Who is compared. `none` has a delay only.
const std::vector<std::string> &players() {
    static const std::vector<std::string> names{"none", "mean", "frozen", "learn", "literal", "oracle"};
    return names;
}

std::string forecast_of_player(const std::string &player) {
    static const std::map<std::string, std::string> forecasts{
        {"frozen", "lstm"}, {"learn", "lstm-learn"}, {"literal", "lstm-literal"}, {"oracle", "lstm"}};
    const auto found = forecasts.find(player);
    return found == forecasts.end() ? player : found->second;
}

using Errors = std::array<double, horizons_s.size()>;

/// Of one player in one trial.
struct Outcome {
    Errors rmse{};
    double delay_s = 0.0;
    double in_use_s = 0.0;
    double given_up = 0.0;
};

/// [player]
using TrialOutcome = std::vector<Outcome>;

/// The oracle's weights before and after the middle of the simulated seconds.
struct Oracle {
    elmopp_weights_t first;
    elmopp_weights_t second;
};

/// What one forecast says over a trial, second by second.
class Spoken {
  public:
    Spoken(const std::string &forecast, const elmopp_weights_t *weights, const Scenario &scenario, const Demand &demand)
        : learning_(make_learning(forecast, weights, approaches)), demand_(demand), arrivals_(scenario, demand) {
        const elmopp_forecast_config_t config{forecast_kind(forecast), nullptr, demand.mean_veh_per_s.data(), weights,
                                              learner_of(learning_),   false};
        elmopp_forecast_init(&forecast_, &scenario.junction, &config);
        for (std::size_t point = demand.origin - known_s; point < demand.origin; ++point) {
            elmopp_forecast_observe(&forecast_, arrivals_.at(point));
            elmopp_forecast_learn(&forecast_);
        }
    }

    /// Adds the squared errors of what is said in second t, if it is judged; then learns from it.
    void second(std::size_t t, bool is_judged, Errors &squared) {
        elmopp_forecast_observe(&forecast_, arrivals_.at(demand_.origin + t));
        in_use_s_ += elmopp_forecast_is_learnt(&forecast_) ? 1.0 : 0.0;
        if (is_judged) {
            judge(t, squared);
        }
        elmopp_forecast_learn(&forecast_);
    }

    [[nodiscard]] double in_use_s() const {
        return in_use_s_;
    }
    [[nodiscard]] double given_up() const {
        return learning_ ? static_cast<double>(learning_->learner()->given_up) : 0.0;
    }

  private:
    void judge(std::size_t t, Errors &squared) {
        std::array<const float *, ELMOPP_APPROACH_MAX> rows{};
        (void)elmopp_forecast_look(&forecast_, horizons_s.back(), rows.data());
        for (std::size_t i = 0; i < approaches; ++i) {
            const auto scale = static_cast<double>(demand_.mean_veh_per_s[i]);
            for (std::size_t h = 0; h < horizons_s.size(); ++h) {
                const double came = demand_.veh_per_s[i][demand_.origin + t + horizons_s[h]];
                const double error = (static_cast<double>(rows[i][horizons_s[h] - 1]) - came) / scale;
                squared[h] += error * error;
            }
        }
    }

    std::unique_ptr<Learning> learning_;
    const Demand &demand_;
    Arrivals arrivals_;
    elmopp_forecast_t forecast_{};
    double in_use_s_ = 0.0;
};

constexpr std::size_t middle_s = simulated_points / 2;

/// Errors over all simulated seconds; an oracle's are those of two networks, each in its half.
Outcome judge(const std::string &player, const Oracle &oracle, const Scenario &scenario, const Demand &demand) {
    const bool is_oracle = player == "oracle";
    const std::string forecast = forecast_of_player(player);
    const elmopp_weights_t *shipped = shipped_weights(forecast);
    Spoken first(forecast, is_oracle ? &oracle.first : shipped, scenario, demand);
    Spoken second(is_oracle ? forecast : "mean", is_oracle ? &oracle.second : shipped, scenario, demand);
    Outcome outcome;
    for (std::size_t t = 0; t < simulated_points; ++t) {
        const bool is_second = is_oracle && t >= middle_s;
        first.second(t, !is_second, outcome.rmse);
        second.second(t, is_second, outcome.rmse);
    }
    for (double &value : outcome.rmse) {
        value = std::sqrt(value / static_cast<double>(simulated_points * approaches));
    }
    outcome.in_use_s = first.in_use_s();
    outcome.given_up = first.given_up();
    return outcome;
}

/// The rows that the chooser is shown.
Foresight shown(const std::string &player, const Oracle &oracle, const Series &unit, std::uint16_t steps) {
    const auto look = [&](const elmopp_weights_t &weights) {
        return foresee({forecast_of_player(player), weights, unit, steps, simulated_points, known_s});
    };
    if (player != "oracle") {
        return look(*shipped_weights(forecast_of_player(player)));
    }
    Foresight rows = look(oracle.first);
    const Foresight later = look(oracle.second);
    const auto from = static_cast<std::ptrdiff_t>(middle_s * approaches * steps);
    std::copy(later.unit_veh.begin() + from, later.unit_veh.end(), rows.unit_veh.begin() + from);
    return rows;
}

class LearningTrials {
  public:
    explicit LearningTrials(const LearningRequest &request)
        : request_(request), scenario_(make_scenario(find_profile("saturation"), nullptr)),
          chooser_(parse_chooser(request.chooser + ":none")) {
        const auto made = make_chooser(chooser_, scenario_.setting());
        steps_ = std::max(made->chooser.horizon_s, std::uint16_t{ELMOPP_PILOT_TRACE_S});
    }

    /// [demand][trial]
    std::vector<std::vector<TrialOutcome>> run() {
        school();
        const auto &patterns = other_demands();
        std::vector<std::vector<TrialOutcome>> outcomes(patterns.size(), std::vector<TrialOutcome>(request_.trials));
        run_jobs(patterns.size() * request_.trials, request_.jobs,
                 [&](std::size_t job) {
                     const std::size_t demand = job % patterns.size();
                     const std::size_t trial = job / patterns.size();
                     outcomes[demand][trial] = run_one(demand, trial);
                 },
                 {});
        return outcomes;
    }

  private:
    /// The oracles: shipped weights where the demand is what those were trained on.
    void school() {
        const std::array<Pattern, 2> others{Pattern::scale, Pattern::dynamics};
        std::array<elmopp_weights_t, 2> trained{};
        run_jobs(others.size(), request_.jobs,
                 [&](std::size_t k) { trained.at(k) = oracle_weights(others.at(k), request_.updates); }, {});
        const elmopp_weights_t &shipped = *shipped_weights("lstm");
        oracles_ = {{shipped, shipped}, {trained[0], trained[0]}, {trained[1], trained[1]}, {shipped, trained[1]}};
    }

    [[nodiscard]] TrialOutcome run_one(std::size_t pattern, std::size_t trial) const {
        const Source source = make_source(Integrator::rk4, Mapping::abs, request_.seed, trial, approaches);
        const Series unit = other_demand(other_demands()[pattern].pattern, source.unit, request_.seed, trial);
        const Demand demand = make_demand(unit, request_.vehicles, training_points, source.ar8, true, simulated_points);
        const Oracle &oracle = oracles_[pattern];
        TrialOutcome outcomes;
        for (const auto &player : players()) {
            const std::string forecast = forecast_of_player(player);
            const bool network = shipped_weights(forecast) != nullptr;
            Outcome outcome = player == "none" ? Outcome{} : judge(player, oracle, scenario_, demand);
            ChooserSpec spec = chooser_;
            spec.forecast = forecast;
            const Foresight rows = network ? shown(player, oracle, unit, steps_) : Foresight{};
            Demand shown_demand = demand;
            shown_demand.foresight = network ? &rows : nullptr;
            outcome.delay_s = run_trial(scenario_, spec, shown_demand, simulated_points, {}).mean_delay_s;
            outcomes.push_back(outcome);
        }
        return outcomes;
    }

    const LearningRequest &request_;
    Scenario scenario_;
    ChooserSpec chooser_;
    std::uint16_t steps_ = 0;
    std::vector<Oracle> oracles_; ///< [demand]
};

/// One measure of all trials, by player.
std::vector<double> measure(const std::vector<TrialOutcome> &trials, std::size_t player, std::size_t which) {
    std::vector<double> values;
    values.reserve(trials.size());
    for (const auto &trial : trials) {
        const Outcome &outcome = trial[player];
        values.push_back(which < horizons_s.size() ? outcome.rmse.at(which) : outcome.delay_s);
    }
    return values;
}

std::size_t place_of(const std::string &player) {
    const auto &names = players();
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), player) - names.begin());
}

std::string measure_name(std::size_t which) {
    return which < horizons_s.size() ? "rmse_" + std::to_string(horizons_s.at(which)) + "_s" : "delay_s";
}

nlohmann::ordered_json difference(const std::vector<double> &a, const std::vector<double> &b) {
    const Interval interval = paired_interval(a, b);
    return {{"mean", summarize(a).mean - summarize(b).mean}, {"low", interval.low}, {"high", interval.high}};
}

nlohmann::ordered_json summary_of_demand(const std::vector<TrialOutcome> &trials) {
    nlohmann::ordered_json json;
    for (std::size_t which = 0; which <= horizons_s.size(); ++which) {
        const std::string name = measure_name(which);
        const auto frozen = measure(trials, place_of("frozen"), which);
        for (const auto &player : players()) {
            if (player == "none" && which < horizons_s.size()) {
                continue;
            }
            const auto values = measure(trials, place_of(player), which);
            json[name][player] = summarize(values).mean;
            if (player != "frozen") {
                json["paired"][name][player] = difference(values, frozen);
            }
        }
    }
    double in_use_s = 0.0;
    double given_up = 0.0;
    for (const auto &trial : trials) {
        in_use_s += trial[place_of("learn")].in_use_s;
        given_up += trial[place_of("learn")].given_up;
    }
    json["in_use_share"] = in_use_s / static_cast<double>(trials.size() * simulated_points);
    json["given_up"] = given_up / static_cast<double>(trials.size());
    return json;
}

void print_measure(const nlohmann::ordered_json &demands, const std::string &name) {
    std::printf("\n%s\n%-10s", name.c_str(), "demand");
    for (const auto &player : players()) {
        std::printf(" %9s", player.c_str());
    }
    std::printf("   learn less frozen          oracle less frozen\n");
    for (const auto &[demand, json] : demands.items()) {
        std::printf("%-10s", demand.c_str());
        for (const auto &player : players()) {
            if (json[name].contains(player)) {
                std::printf(" %9.4f", json[name][player].get<double>());
            } else {
                std::printf(" %9s", "");
            }
        }
        for (const auto *const player : {"learn", "oracle"}) {
            const auto &pair = json["paired"][name][player];
            std::printf("   %+.3f (%+.3f to %+.3f)", pair["mean"].get<double>(), pair["low"].get<double>(),
                        pair["high"].get<double>());
        }
        std::printf("\n");
    }
}

} // namespace

void run_learning(const LearningRequest &request) {
    std::optional<WholeFile> file;
    if (request.json) {
        file.emplace("--json", *request.json);
    }
    const auto outcomes = LearningTrials(request).run();
    nlohmann::ordered_json json{{"trials", request.trials},
                                {"seed", request.seed},
                                {"vehicles", request.vehicles},
                                {"chooser", request.chooser},
                                {"updates", request.updates}};
    for (std::size_t k = 0; k < outcomes.size(); ++k) {
        json["demands"][other_demands()[k].name] = summary_of_demand(outcomes[k]);
    }
    for (std::size_t which = 0; which <= horizons_s.size(); ++which) {
        print_measure(json["demands"], measure_name(which));
    }
    std::printf("\n");
    for (const auto &[demand, summary] : json["demands"].items()) {
        std::printf("%-10s learnt weights in use in %.1f %% of the seconds, begun anew %.1f times a trial\n",
                    demand.c_str(), 100.0 * summary["in_use_share"].get<double>(), summary["given_up"].get<double>());
    }
    if (file) {
        file->out() << json.dump(1) << "\n";
        file->commit();
    }
}

} // namespace elmopp
