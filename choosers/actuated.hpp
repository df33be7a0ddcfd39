// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Actuated: phases in the order of the covering cycle, each for as long as vehicles follow one another.
///
/// After min_s a green ends at the first gap: nobody is queued on what it serves alone, and nobody reaches the stop line
/// within gap_s. It also ends max_s after the first conflicting call. Phases without a call are skipped; a green rests
/// where nobody else calls. It weighs nothing: one vehicle is a call like ten.
///
/// Source: fully actuated control as in the Traffic Signal Timing Manual (FHWA-HOP-08-024, chapter 5; 2008). Detectors
/// are reconstructed from counts: a vehicle calls when it is counted, and "within gap_s" comes from when it was first
/// counted. Movements that the next phase serves too do not hold the present one, as an overlap would not.

#pragma once

#include "approaching.hpp"
#include "cycle.hpp"

namespace elmopp {

struct Actuated {
    unsigned min_s;
    unsigned max_s;
    unsigned gap_s;
    Approaching approaching{};
    Cycle cycle{};
    elmopp_stage_t shown = ELMOPP_STAGE_NONE; ///< whose contested_s it is
    unsigned contested_s = 0;                 ///< since the first conflicting call of this green

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);

  private:
    [[nodiscard]] elmopp_stage_t next_called(const elmopp_view_t &view);
    [[nodiscard]] bool is_gap(const elmopp_view_t &view, elmopp_stage_t next) const;
    void count_contest(const elmopp_view_t &view);
};

} // namespace elmopp
