// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Fixed times: the stages of a cycle one after the other, whatever waits. Neither skips a stage nor ends one
/// early.

#pragma once

#include "approaching.hpp"
#include "cycle.hpp"

#include <vector>

namespace elmopp {

/// Each stage of the covering cycle for green_s.
struct Fixed {
    unsigned green_s;
    std::vector<elmopp_stage_t> cycle{}; ///< filled at the first call

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);
};

/// Webster (F. V. Webster, Traffic signal settings, Road Research Technical Paper 39, 1958): cycle (1.5 L + 5) / (1 -
/// Y) with L the lost time of a round and Y the sum of the critical flow ratios, effective greens in proportion to
/// these.
///
/// The flows are the mean of the first 15 minutes; until then they are the mean so far, taken anew at the start of each
/// round, and every stage has default_s for the first two minutes.
struct Webster {
    unsigned default_s;
    unsigned shortest_cycle_s;
    unsigned longest_cycle_s;
    Cycle cycle{};
    MeanFlow flow{0xFFFFU};
    bool settled = false; ///< the plan is the final one
    std::vector<unsigned> greens_s{};

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);

  private:
    void plan(const elmopp_view_t &view);
};

} // namespace elmopp
