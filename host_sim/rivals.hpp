// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Rivals: other people's controllers, reduced to what the fluid model can carry. They know the chooser's view and
/// nothing else.
///
/// The full texts of the ITLC and OAF papers were not at hand: both rules follow the abstracts and docs/algorithm.md,
/// and say what those authors' programs would do no better than that.

#pragma once

#include "core.hpp"

#include <deque>
#include <vector>

namespace elmopp {

constexpr double ready_unlimited = 1e9;

/// ITLC (Younes and Boukerche 2014): at the end of each green the stage with most vehicles in its ready areas, green
/// until the last of them has crossed, 5 to 60 s.
struct Itlc {
    double ready_veh; ///< ready area, vehicles a lane
    unsigned left_s = 0;
};
elmopp_chooser_t plug(Itlc &state);

/// OAF (Pandit et al. 2013): the lane whose head vehicle came first picks among its stages the one with the oldest
/// heads, green for one platoon, 1 to 60 s.
struct Oaf {
    double platoon_veh;
    unsigned left_s = 0;
    double now_s = 0.0;
    struct Arrival {
        double at_s;
        double vehicles;
    };
    struct Lane {
        std::deque<Arrival> waiting; ///< oldest first
        double total_veh = 0.0;      ///< of all that wait
    };
    std::vector<Lane> lanes; ///< [movement]
};
elmopp_chooser_t plug(Oaf &state);

/// Fixed times: the stages in site order, leaving out those that would serve nothing new, each for green_s.
struct Fixed {
    unsigned green_s;
    std::vector<elmopp_stage_t> cycle; ///< filled at the first call
};
elmopp_chooser_t plug(Fixed &state);

/// The stages that `fixed` repeats.
std::vector<elmopp_stage_t> covering_cycle(const elmopp_junction_t &junction);

} // namespace elmopp
