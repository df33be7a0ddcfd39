// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Comings: single vehicles that come to approaches, drawn from a seed.
///
/// A rate says how many come on average in each second, by a pattern; vehicles come at random at that rate (a Poisson
/// process). It knows no road, no lamp and no controller: the same vehicles come whatever is done with them.

#pragma once

#include "inflow.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace elmopp {

constexpr int ds_per_second = 10; ///< whole; ds_per_s of view.hpp is a real number

/// One vehicle.
struct Coming {
    std::int64_t edge_ds; ///< when it would cross the edge of the counted reach if nobody were in its way
    std::uint64_t seed;   ///< what it will decide: its turns
};

/// [approach], in order of time.
using Comings = std::vector<std::vector<Coming>>;

/// The patterns of demand: poisson, alternating, platoons, hyperchaos.
const std::vector<std::string> &demand_patterns();

/// Vehicles per second, [approach][point], with this mean over the simulated points; point 8,000 is second 0.
///   poisson      the same rate all the time
///   alternating  half of it and half as much again by turns, 500 s each
///   platoons     all in a third of every 90 s, as from a signal upstream; each approach has its own offset
///   hyperchaos   the paper's inflow: `unit` as of unit_inflow(), used by no other
Series rates(const std::string &pattern, const Series &unit, std::size_t approaches, double mean_veh_per_s,
             std::uint64_t seed, std::uint64_t trial);

/// Draws the vehicles. An approach's are the same whatever the rates of the others.
Comings draw_comings(const Series &rate_veh_per_s, std::uint64_t seed, std::uint64_t trial);

/// How many in each second, [approach][point].
Series counted(const Comings &comings);

} // namespace elmopp
