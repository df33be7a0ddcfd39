// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Setting: what a chooser is told once, when it is made, beside its options.

#pragma once

#include "core.hpp"

#include <array>
#include <cstdint>

namespace elmopp {

/// [movement] seconds from the edge of the counted reach to the stop line at free flow; 0: who is counted is queued.
using Travel = std::array<unsigned, ELMOPP_MOVEMENT_MAX>;

/// The same on every movement.
inline Travel everywhere(unsigned travel_s) {
    Travel travel{};
    travel.fill(travel_s);
    return travel;
}

struct Setting {
    const elmopp_junction_t &junction; ///< must outlive the chooser
    bool own_site;                     ///< a site file's junction, whose window holds for everybody; not the paper's
    bool literal = false;              ///< Algorithm 1 as printed, for the choosers of the paper
    Travel travel_s{};
    std::uint64_t seed = 1;
    /// [movement] vehicles on the road that the movement leads to; null: nothing is known. Kept up to date by its
    /// owner, must outlive the chooser.
    const float *downstream_veh = nullptr;
    bool stops_free = false; ///< vehicles of this simulator brake and gain speed without loss: a stop is its wait alone
};

} // namespace elmopp
