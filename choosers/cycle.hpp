// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Cycle: stages that are shown in a fixed order, for the rules that have one.

#pragma once

#include "core.hpp"

#include <cstddef>
#include <vector>

namespace elmopp {

/// The stages in site order, leaving out those that would serve nothing new. Together they serve every movement.
std::vector<elmopp_stage_t> covering_cycle(const elmopp_junction_t &junction);

/// The smallest sets of stages that serve every movement, each in site order, at most 8 of them.
std::vector<std::vector<elmopp_stage_t>> smallest_cycles(const elmopp_junction_t &junction);

class Cycle {
  public:
    /// Filled at the first call with the smallest cycle: of several the one whose stages serve most movements, then the
    /// one that loses least time.
    void prepare(const elmopp_junction_t &junction);

    [[nodiscard]] std::size_t size() const {
        return stages_.size();
    }
    [[nodiscard]] elmopp_stage_t stage(std::size_t position) const {
        return stages_[position % stages_.size()];
    }
    /// Position of the stage that is shown or brought up; while the plan shows one that is not in the cycle, the last
    /// position.
    std::size_t position(const elmopp_view_t &view);

    /// True while the plan shows a stage of the cycle.
    [[nodiscard]] bool shows(const elmopp_view_t &view) const;

    /// Seconds of a whole round in which a change of stage lets nobody go.
    [[nodiscard]] double lost_s(const elmopp_junction_t &junction) const;

    /// The stage's start-up in this order, which is part of its green.
    [[nodiscard]] double startup_of_s(const elmopp_junction_t &junction, std::size_t position) const;

    /// The shortest green of each position.
    [[nodiscard]] std::vector<unsigned> min_greens_s(const elmopp_junction_t &junction) const;

  private:
    std::vector<elmopp_stage_t> stages_;
    std::size_t position_ = 0;
};

/// Share of a cycle that each position needs so that its movements leave as fast as they come: flow over saturation of
/// the critical movement. What a movement needs beyond the stages that serve nobody else so much is split among its
/// stages.
std::vector<double> flow_ratios(const Cycle &cycle, const elmopp_junction_t &junction,
                                const std::vector<double> &flow_veh_per_s);

/// Whole seconds of green a position: `cycle_s` less what is lost, shared by these weights, then each start-up; never
/// below a minimum.
std::vector<unsigned> share_greens_s(const Cycle &cycle, const elmopp_junction_t &junction, double cycle_s,
                                     const std::vector<double> &weights);

} // namespace elmopp
