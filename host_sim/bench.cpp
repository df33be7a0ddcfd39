// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "bench.hpp"

#include "foresight.hpp"
#include "jobs.hpp"
#include "networks.hpp"
#include "trial.hpp"
#include "whole_file.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>

namespace elmopp {
namespace {

constexpr std::size_t rounds = 7;
constexpr double bench_vehicles = 800.0;
constexpr std::size_t speedup_trials = 24;
constexpr std::size_t network_rounds = 201;

double elapsed_s(const std::function<void()> &work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

Demand bench_demand() {
    const Source source = make_source(Integrator::rk4, Mapping::abs, 1, 0, 4);
    return make_demand(source.unit, bench_vehicles, training_points, source.ar8, true, simulated_points);
}

/// Two cores against one on the same trials, one after the other in each round so that both see the same machine.
double speedup_of_two(const Scenario &scenario, const Demand &demand) {
    const ChooserSpec chooser = parse_chooser("cumulative:ar8");
    const auto trials = [&](unsigned jobs) {
        run_jobs(speedup_trials, jobs,
                 [&](std::size_t) { (void)run_trial(scenario, chooser, demand, simulated_points, {}); }, {});
    };
    std::vector<double> ratios;
    for (std::size_t round = 0; round < rounds; ++round) {
        const double one = elapsed_s([&] { trials(1); });
        ratios.push_back(one / elapsed_s([&] { trials(2); }));
    }
    return median(ratios);
}

/// A network that is fed a fixed sequence; every value that it says goes into a digest.
class Fed {
  public:
    explicit Fed(const std::string &forecast) : weights_(*shipped_weights(forecast)) {
        SplitMix64 random(1);
        for (auto &input : inputs_) {
            for (float &value : input) {
                value = static_cast<float>(2.0 * random.uniform());
            }
        }
    }

    /// Time of one step.
    double step_ns() {
        return per_step_ns([this](std::size_t step) {
            elmopp_lstm_f32_step(&weights_.lstm, &state_, inputs_[step % inputs_.size()].data());
        });
    }

    /// Time of a free run over a minute: the head, the feedback and the step.
    double rollout60_us() {
        const double each_ns = per_step_ns([this](std::size_t step) {
            if (step % rollout_steps == 0) {
                running_ = state_;
            }
            std::array<float, ELMOPP_LSTM_INPUTS> said{};
            elmopp_lstm_f32_output(&weights_.lstm, &running_, said.data());
            elmopp_lstm_f32_step(&weights_.lstm, &running_, said.data());
        });
        return each_ns * rollout_steps / 1e3;
    }

    /// FNV-1a over the bits of what it says from an empty memory.
    std::uint64_t digest(std::uint64_t hash) {
        state_ = {};
        for (const auto &input : inputs_) {
            elmopp_lstm_f32_step(&weights_.lstm, &state_, input.data());
            std::array<float, ELMOPP_LSTM_INPUTS> said{};
            elmopp_lstm_f32_output(&weights_.lstm, &state_, said.data());
            for (const float value : said) {
                std::uint32_t bits = 0;
                std::memcpy(&bits, &value, sizeof bits);
                hash = (hash ^ bits) * fnv_prime;
            }
        }
        return hash;
    }

  private:
    static constexpr std::size_t rollout_steps = 60;
    /// A millisecond or two: what another program interrupts is one block of many.
    static constexpr std::size_t steps = 6000;
    static constexpr std::uint64_t fnv_prime = 0x100000001b3;

    template <typename Work> static double per_step_ns(const Work &work) {
        return elapsed_s([&] {
                   for (std::size_t step = 0; step < steps; ++step) {
                       work(step);
                   }
               }) /
               static_cast<double>(steps) * 1e9;
    }

    const elmopp_weights_t &weights_;
    std::array<std::array<float, ELMOPP_LSTM_INPUTS>, 256> inputs_{};
    elmopp_lstm_f32_state_t state_{};
    elmopp_lstm_f32_state_t running_{};
};

void bench_networks(nlohmann::ordered_json &result) {
    constexpr std::uint64_t fnv_start = 0xcbf29ce484222325;
    Fed lstm("lstm");
    Fed nlstm("nlstm");
    char digest[17];
    (void)std::snprintf(digest, sizeof digest, "%016llx",
                        static_cast<unsigned long long>(nlstm.digest(lstm.digest(fnv_start))));
    std::vector<double> lstm_ns;
    std::vector<double> nlstm_ns;
    std::vector<double> rollout_us;
    for (std::size_t round = 0; round < network_rounds; ++round) {
        lstm_ns.push_back(lstm.step_ns());
        nlstm_ns.push_back(nlstm.step_ns());
        rollout_us.push_back(lstm.rollout60_us());
    }
    result["lstm_step_ns"] = median(lstm_ns);
    result["nlstm_step_ns"] = median(nlstm_ns);
    result["rollout60_us"] = median(rollout_us);
    result["lstm_digest"] = digest;
    std::printf("%-24s %10.1f ns\n%-24s %10.1f ns\n%-24s %10.2f us\n%-24s %s\n", "lstm, a step", median(lstm_ns),
                "nlstm, a step", median(nlstm_ns), "lstm, 60 s ahead", median(rollout_us), "digest", digest);
}

void bench_choosers(nlohmann::ordered_json &result) {
    const Scenario scenario = make_scenario(find_profile("paper"), nullptr);
    const Demand demand = bench_demand();
    const auto choosers = paper_table();
    std::vector<std::vector<double>> rates(choosers.size());
    for (std::size_t round = 0; round < rounds; ++round) {
        for (std::size_t i = 0; i < choosers.size(); ++i) {
            rates[i].push_back(static_cast<double>(simulated_points) / elapsed_s([&] {
                                   (void)run_trial(scenario, choosers[i], demand, simulated_points, {});
                               }));
        }
    }
    for (std::size_t i = 0; i < choosers.size(); ++i) {
        const std::string name = full_name(choosers[i].label(), choosers[i].forecast);
        result["ticks_per_s." + name] = std::round(median(rates[i]));
        std::printf("%-24s %10.0f ticks/s\n", name.c_str(), median(rates[i]));
    }
    result["jobs2_speedup"] = speedup_of_two(scenario, demand);
    std::printf("%-24s %10.2f\n", "speed-up by two jobs", result["jobs2_speedup"].get<double>());
}

} // namespace

void run_bench(const std::optional<std::filesystem::path> &json, bool forecast_only) {
    std::optional<WholeFile> file;
    if (json) {
        file.emplace("--json", *json);
    }
    nlohmann::ordered_json result;
    bench_networks(result);
    if (!forecast_only) {
        bench_choosers(result);
    }
    if (file) {
        file->out() << result.dump(1) << "\n";
        file->commit();
    }
}

} // namespace elmopp
