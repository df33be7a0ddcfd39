// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "bench.hpp"

#include "jobs.hpp"
#include "trial.hpp"
#include "whole_file.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace elmopp {
namespace {

constexpr std::size_t rounds = 7;
constexpr std::size_t seconds = simulated_points;
constexpr double vehicles = 800.0;
constexpr std::size_t speedup_trials = 24;

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
    return make_demand(source.unit, vehicles, training_points, source.ar8, true, seconds);
}

/// Two cores against one on the same trials, one after the other in each round so that both see the same machine.
double speedup_of_two(const Scenario &scenario, const Demand &demand) {
    const ChooserSpec chooser = parse_chooser("cumulative:ar8");
    const auto trials = [&](unsigned jobs) {
        run_jobs(speedup_trials, jobs, [&](std::size_t) { (void)run_trial(scenario, chooser, demand, seconds, {}); },
                 {});
    };
    std::vector<double> ratios;
    for (std::size_t round = 0; round < rounds; ++round) {
        const double one = elapsed_s([&] { trials(1); });
        ratios.push_back(one / elapsed_s([&] { trials(2); }));
    }
    return median(ratios);
}

} // namespace

void run_bench(const std::optional<std::filesystem::path> &json) {
    std::optional<WholeFile> file;
    if (json) {
        file.emplace("--json", *json);
    }
    const Scenario scenario = make_scenario(find_profile("paper"), nullptr);
    const Demand demand = bench_demand();
    const auto choosers = paper_table();
    std::vector<std::vector<double>> rates(choosers.size());
    for (std::size_t round = 0; round < rounds; ++round) {
        for (std::size_t i = 0; i < choosers.size(); ++i) {
            rates[i].push_back(static_cast<double>(seconds) /
                               elapsed_s([&] { (void)run_trial(scenario, choosers[i], demand, seconds, {}); }));
        }
    }
    nlohmann::ordered_json result;
    for (std::size_t i = 0; i < choosers.size(); ++i) {
        const std::string name = full_name(choosers[i].label(), choosers[i].forecast);
        result["ticks_per_s." + name] = std::round(median(rates[i]));
        std::printf("%-24s %10.0f ticks/s\n", name.c_str(), median(rates[i]));
    }
    result["jobs2_speedup"] = speedup_of_two(scenario, demand);
    std::printf("%-24s %10.2f\n", "speed-up by two jobs", result["jobs2_speedup"].get<double>());
    if (file) {
        file->out() << result.dump(1) << "\n";
        file->commit();
    }
}

} // namespace elmopp
