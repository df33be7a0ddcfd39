// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Other demand: traffic that the shipped networks were not trained on, made of a trial's own, and a network that was
/// trained on it.

#pragma once

#include "core.hpp"
#include "inflow.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace elmopp {

enum class Pattern {
    trained,  ///< the paper's system, as the networks know it
    scale,    ///< the same at half its swing about the mean
    dynamics, ///< two waves an approach, of 30 to 90 and 60 to 180 s
    shift     ///< `trained`, and `dynamics` from the middle of the simulated seconds on
};

struct OtherDemand {
    Pattern pattern;
    std::string name;
    std::string what;
};

const std::vector<OtherDemand> &other_demands();

/// The point from which `shift` is `dynamics`.
constexpr std::size_t shift_point = training_points + simulated_points / 2;

/// Vehicles per second and approach, one vehicle an approach in the simulated seconds: made of unit_inflow()'s.
Series other_demand(Pattern pattern, const Series &unit, std::uint64_t seed, std::uint64_t trial);

/// Trains the shipped weights on, on trajectories of their own of this demand (not `shift`), with the core's trainer:
/// what a network of this size can know of it. The same on every computer.
elmopp_weights_t oracle_weights(Pattern pattern, unsigned updates);

} // namespace elmopp
