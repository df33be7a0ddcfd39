// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Actuated: phases in the order of the smallest cycle, each for as long as vehicles follow one another.
///
/// After min_s a movement holds the green until its first gap (nobody is queued and nobody reaches the stop line within
/// gap_s), and max_s after the first conflicting call at most. When only some of a stage's movements still hold it, it
/// gives way to a stage that keeps these and serves another one that calls, as the two rings of a controller do. When
/// none holds it, to the next stage of the cycle with a call; stages without one are skipped. A green rests where
/// nobody else calls. Apart from which of several such stages follows a movement that still flows, it weighs nothing:
/// one vehicle is a call like ten.
///
/// Source: fully actuated control as in the Traffic Signal Timing Manual (FHWA-HOP-08-024, chapter 5; 2008). Detectors
/// are reconstructed from counts: a vehicle calls when it is counted, and "within gap_s" comes from when it was first
/// counted. The rings are reconstructed from the site's stages.

#pragma once

#include "approaching.hpp"
#include "cycle.hpp"

#include <cstdint>
#include <vector>

namespace elmopp {

struct Actuated {
    unsigned min_s;
    unsigned max_s;
    unsigned gap_s;
    Approaching approaching{};
    Cycle cycle{};
    std::vector<unsigned> contested_s{}; ///< [movement] green since the first conflicting call

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);

  private:
    [[nodiscard]] elmopp_stage_t next_called(const elmopp_view_t &view);
    [[nodiscard]] std::uint32_t holding(const elmopp_view_t &view) const;
    void count_contest(const elmopp_view_t &view);
};

} // namespace elmopp
