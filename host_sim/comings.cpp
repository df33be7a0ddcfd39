// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "comings.hpp"

#include "csv.hpp"
#include "error.hpp"

#include <algorithm>
#include <cmath>

namespace elmopp {
namespace {

constexpr std::size_t alternating_s = 500;
constexpr double light = 0.5;
constexpr double heavy = 1.5;
constexpr std::size_t platoon_cycle_s = 90;
constexpr std::size_t platoon_s = 30;
constexpr std::uint64_t stream_of_offsets = 0x6F66667365747300ULL; ///< so that offsets and vehicles differ

std::int64_t start_ds(std::size_t point) {
    return ds_per_second * (static_cast<std::int64_t>(point) - static_cast<std::int64_t>(training_points));
}

std::vector<double> alternating(double mean_veh_per_s) {
    std::vector<double> rate(trajectory_points);
    for (std::size_t t = 0; t < rate.size(); ++t) {
        rate[t] = mean_veh_per_s * ((t / alternating_s) % 2 == 0 ? light : heavy);
    }
    return rate;
}

std::vector<double> platoons(double mean_veh_per_s, std::size_t offset_s) {
    constexpr double factor = static_cast<double>(platoon_cycle_s) / static_cast<double>(platoon_s);
    std::vector<double> rate(trajectory_points);
    for (std::size_t t = 0; t < rate.size(); ++t) {
        rate[t] = (t + offset_s) % platoon_cycle_s < platoon_s ? factor * mean_veh_per_s : 0.0;
    }
    return rate;
}

/// One approach: unit exponential gaps on the integral of the rate.
std::vector<Coming> draw_one(const std::vector<double> &rate_veh_per_s, SplitMix64 random) {
    std::vector<Coming> comings;
    double passed = 0.0;
    double next = -std::log1p(-random.uniform());
    for (std::size_t t = 0; t < rate_veh_per_s.size(); ++t) {
        const double end = passed + rate_veh_per_s[t];
        while (next < end) {
            const double part = (next - passed) / rate_veh_per_s[t];
            const auto tick = static_cast<std::int64_t>(part * static_cast<double>(ds_per_second));
            comings.push_back({start_ds(t) + std::clamp<std::int64_t>(tick, 0, ds_per_second - 1), random.next()});
            next += -std::log1p(-random.uniform());
        }
        passed = end;
    }
    return comings;
}

} // namespace

const std::vector<std::string> &demand_patterns() {
    static const std::vector<std::string> names{"poisson", "alternating", "platoons", "hyperchaos"};
    return names;
}

Series rates(const std::string &pattern, const Series &unit, std::size_t approaches, double mean_veh_per_s,
             std::uint64_t seed, std::uint64_t trial) {
    SplitMix64 random((seed << 32U) + trial + stream_of_offsets);
    Series series;
    series.reserve(approaches);
    for (std::size_t i = 0; i < approaches; ++i) {
        if (pattern == "poisson") {
            series.emplace_back(trajectory_points, mean_veh_per_s);
        } else if (pattern == "alternating") {
            series.push_back(alternating(mean_veh_per_s));
        } else if (pattern == "platoons") {
            series.push_back(
                platoons(mean_veh_per_s, static_cast<std::size_t>(random.uniform() * double{platoon_cycle_s})));
        } else if (pattern == "hyperchaos") {
            series.push_back(unit.at(i));
            for (double &value : series.back()) {
                value *= mean_veh_per_s * static_cast<double>(simulated_points);
            }
        } else {
            throw BadRequest("unknown demand \"" + pattern + "\"; right would be one of " +
                             join(demand_patterns(), ", "));
        }
    }
    return series;
}

Comings draw_comings(const Series &rate_veh_per_s, std::uint64_t seed, std::uint64_t trial) {
    SplitMix64 streams((seed << 32U) + trial);
    Comings comings;
    comings.reserve(rate_veh_per_s.size());
    for (const auto &rate : rate_veh_per_s) {
        comings.push_back(draw_one(rate, SplitMix64(streams.next())));
    }
    return comings;
}

Series counted(const Comings &comings) {
    Series series;
    series.reserve(comings.size());
    for (const auto &approach : comings) {
        std::vector<double> counts(trajectory_points);
        for (const auto &coming : approach) {
            counts[static_cast<std::size_t>((coming.edge_ds - start_ds(0)) / ds_per_second)] += 1.0;
        }
        series.push_back(std::move(counts));
    }
    return series;
}

} // namespace elmopp
