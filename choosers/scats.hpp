// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Scats: a cycle whose length and split follow, round by round, how saturated its greens have been.
///
/// Degree of saturation of a movement in a green: vehicles that left over those that could have, which is what (g - (T
/// - n t)) / g says with n vehicles, empty time T and t seconds a vehicle at full flow. Once a round the largest one
/// sets the cycle by the smoothed steps below, and each plan of a library of splits is asked what the largest would
/// have been with it; the best plan gets a vote, the plan with most votes of the last five rounds is used. The order is
/// fixed, no green ends on a gap and none is skipped; there is no neighbour to have an offset to. A stage that the plan
/// has forced and that is not in the cycle is left after its minimum and judges nothing.
///
/// Sources: P. Lowrie, SCATS: the Sydney co-ordinated adaptive traffic system, 1982 and 1990; Austroads Guide to
/// Traffic Management 9, commentary 8 (degree of saturation); the smoothing and steps of the cycle as in SimMobility's
/// Signal_SCATS. Reconstructed: the library, since a real one is an engineer's (here every split whose weights are
/// small whole numbers), and the congestion flag is left out. Uncalibrated, so a lower bound for SCATS and no judgement
/// on it.

#pragma once

#include "approaching.hpp"
#include "cycle.hpp"

#include <deque>
#include <vector>

namespace elmopp {

struct Scats {
    unsigned shortest_cycle_s;
    unsigned medium_cycle_s;
    unsigned longest_cycle_s;
    Cycle cycle{};
    Departures departures{};
    double cycle_s = 0.0;
    double wanted_s[2] = {0.0, 0.0};                 ///< RL1 of the last two rounds, the later first
    bool has_stepped = false;                        ///< the last change was a whole step
    std::vector<std::vector<double>> library{};      ///< weights of each plan; the first is the equal split
    std::deque<std::size_t> votes{};                 ///< of the last rounds
    std::size_t plan = 0;                            ///< in use
    std::vector<unsigned> greens_s{};                ///< [position]
    std::vector<std::vector<double>> departed_veh{}; ///< [position][movement] in this round
    std::vector<unsigned> shown_s{};                 ///< [position] green in this round

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);

  private:
    void prepare(const elmopp_view_t &view);
    void count_green(const elmopp_view_t &view, std::size_t position);
    [[nodiscard]] std::vector<double> saturations(const elmopp_view_t &view) const;
    void step_cycle(double saturation);
    void vote(const std::vector<double> &saturation);
    void begin_round(const elmopp_view_t &view);
};

} // namespace elmopp
