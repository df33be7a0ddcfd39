// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Street trial: single vehicles, one controller a junction, second by second, and what came of it.
///
/// Order of a second: counts of the last one, what neighbours say, decisions, ten lamp ticks in which vehicles move.

#pragma once

#include "trial.hpp"

#include <functional>
#include <vector>

namespace elmopp {

/// One junction of the plan: what it is, who controls it and who comes to it.
struct Site {
    const Scenario &scenario;
    Control &control;
    const Demand &demand;
};

/// Called once a second before the controllers count.
using Neighbours = std::function<void(const Streets &)>;

/// Sees the streets before the first second and after each lamp tick.
using Spectator = std::function<void(const Streets &)>;

/// Runs it. Metrics are of the whole plan: the longest red is the longest during which somebody waited at the stop
/// line, anywhere (a movement that nobody wants may be red for ever), switches are all, vehicles count once however
/// many junctions they pass, vehicles_queued are all on the arms, driving or not. `observer` sees the first junction
/// and may be empty, as may `neighbours` and `spectator`. Throws Failure if a vehicle is lost.
Metrics run_streets(const StreetPlan &plan, const std::vector<Site> &sites, std::size_t seconds,
                    const Observer &observer, const Neighbours &neighbours = {}, const Spectator &spectator = {});

} // namespace elmopp
