// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "other_demand.hpp"

#include "autoregression.hpp"
#include "jobs.hpp"
#include "networks.hpp"
#include "stats.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace elmopp {
namespace {

constexpr double pi = 3.141592653589793;
constexpr double half_swing = 0.5;

/// An oracle's schooling.
constexpr std::uint64_t schooling_seed = 4000000002; ///< nobody is judged on it
constexpr std::size_t schooling_trials = 48;
constexpr std::size_t settled_s = 96; ///< a network has seen so much before a sample begins
constexpr unsigned batch = 16;
constexpr double first_rate = 1e-3;
constexpr double last_rate_share = 0.01;

std::vector<double> waves(SplitMix64 &random, std::size_t points) {
    const std::array<double, 2> period_s{30.0 + 60.0 * random.uniform(), 60.0 + 120.0 * random.uniform()};
    const std::array<double, 2> phase{2.0 * pi * random.uniform(), 2.0 * pi * random.uniform()};
    std::vector<double> series(points);
    for (std::size_t t = 0; t < points; ++t) {
        const double at = 2.0 * pi * static_cast<double>(t);
        const double value =
            1.0 + 0.5 * std::sin(at / period_s[0] + phase[0]) + 0.4 * std::sin(at / period_s[1] + phase[1]);
        series[t] = std::max(0.0, value);
    }
    return series;
}

/// In units of the mean of the training points.
std::vector<double> pattern_of(Pattern pattern, const std::vector<double> &own, SplitMix64 &random) {
    const double mean = training_mean(own);
    const std::vector<double> other = waves(random, own.size());
    std::vector<double> series(own.size());
    for (std::size_t t = 0; t < own.size(); ++t) {
        const double trained = own[t] / mean;
        const bool is_other = pattern == Pattern::dynamics || (pattern == Pattern::shift && t >= shift_point);
        const double scaled = pattern == Pattern::scale ? 1.0 + half_swing * (trained - 1.0) : trained;
        series[t] = is_other ? other[t] : scaled;
    }
    return series;
}

using Seconds = std::vector<std::array<float, ELMOPP_LSTM_INPUTS>>;

/// As the core's forecast feeds them: in units of the demand scale and in the clamp.
Seconds fed_of(const Series &unit, const elmopp_weights_t &weights) {
    Seconds fed(unit.front().size());
    for (std::size_t k = 0; k < ELMOPP_LSTM_INPUTS; ++k) {
        const double mean = training_mean(unit[k]);
        for (std::size_t t = 0; t < fed.size(); ++t) {
            fed[t][k] = std::clamp(static_cast<float>(unit[k][t] / mean), weights.low[k], weights.high[k]);
        }
    }
    return fed;
}

std::vector<Seconds> schooling(Pattern pattern, const elmopp_weights_t &weights) {
    std::vector<Seconds> all;
    for (std::size_t trial = 0; trial < schooling_trials; ++trial) {
        const Trajectory trajectory = draw_trajectory(Integrator::rk4, schooling_seed, trial, ELMOPP_LSTM_INPUTS);
        const Series unit = unit_inflow(trajectory, Mapping::abs, ELMOPP_LSTM_INPUTS);
        all.push_back(fed_of(other_demand(pattern, unit, schooling_seed, trial), weights));
    }
    return all;
}

/// One sample from anywhere, by a network that has settled.
void take_any(elmopp_trainer_t &trainer, const elmopp_weights_t &weights, const std::vector<Seconds> &all,
              SplitMix64 &random) {
    const auto &seconds = all[random.next() % all.size()];
    const std::size_t first = random.next() % (seconds.size() - settled_s - ELMOPP_TRAINER_WINDOW - 1);
    const elmopp_lstm_f32_net_t net = elmopp_trainer_net(&trainer);
    elmopp_lstm_f32_state_t state{};
    for (std::size_t t = 0; t < settled_s; ++t) {
        elmopp_lstm_f32_net_step(&net, &state, seconds[first + t].data());
    }
    std::array<float[ELMOPP_LSTM_INPUTS], ELMOPP_TRAINER_WINDOW + 1U> seen{};
    for (std::size_t t = 0; t < seen.size(); ++t) {
        std::copy_n(seconds[first + settled_s + t].begin(), ELMOPP_LSTM_INPUTS, &seen[t][0]);
    }
    const elmopp_trainer_sample_t sample{&state, seen.data(),        ELMOPP_TRAINER_WINDOW,
                                         1U, // settled: all of the window is its own
                                         0U,     ELMOPP_LSTM_INPUTS, &weights.low[0],       &weights.high[0]};
    (void)elmopp_trainer_take(&trainer, &sample);
}

} // namespace

const std::vector<OtherDemand> &other_demands() {
    static const std::vector<OtherDemand> all{
        {Pattern::trained, "trained", "the paper's system, as the networks know it"},
        {Pattern::scale, "scale", "the same at half its swing about the mean"},
        {Pattern::dynamics, "dynamics", "two waves an approach, 30 to 90 and 60 to 180 s long"},
        {Pattern::shift, "shift", "trained, and dynamics for the second half"}};
    return all;
}

Series other_demand(Pattern pattern, const Series &unit, std::uint64_t seed, std::uint64_t trial) {
    SplitMix64 random(~((seed << 32U) + trial));
    Series series;
    for (const auto &own : unit) {
        series.push_back(pattern_of(pattern, own, random));
        auto &made = series.back();
        const auto first = made.begin() + static_cast<std::ptrdiff_t>(training_points);
        const double total = sum(std::vector<double>(first, first + static_cast<std::ptrdiff_t>(simulated_points)));
        for (double &value : made) {
            value /= total;
        }
    }
    return series;
}

elmopp_weights_t oracle_weights(Pattern pattern, unsigned updates) {
    elmopp_weights_t weights = *shipped_weights("lstm");
    const auto all = schooling(pattern, weights);
    const auto memory = std::make_unique<elmopp_trainer_memory_t>();
    elmopp_trainer_t trainer{};
    elmopp_trainer_init(&trainer, memory.get(), nullptr, &weights.lstm);
    SplitMix64 random(schooling_seed);
    for (unsigned n = 0; n < updates; ++n) {
        check_interrupt();
        for (unsigned k = 0; k < batch; ++k) {
            take_any(trainer, weights, all, random);
        }
        const double done = static_cast<double>(n) / updates;
        const double rate =
            first_rate * (last_rate_share + (1.0 - last_rate_share) * 0.5 * (1.0 + std::cos(pi * done)));
        (void)elmopp_trainer_update(&trainer, static_cast<float>(rate));
    }
    elmopp_trainer_copy(&trainer, &weights.lstm);
    return weights;
}

} // namespace elmopp
