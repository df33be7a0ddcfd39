// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Scoot: a cycle that a model of the queues moves by few seconds at a time.
///
/// Arrivals at the edge of the reach make a profile of each movement in steps of 4 s over the round, smoothed from
/// round to round. A few seconds before each change of stage the model says how saturated this green and the next would
/// be if the change came 4 s earlier, as planned or 4 s later: the time that balances them best is taken now, a second
/// of it for good. Every five minutes (two and a half while it grows) the cycle is lengthened if a green is saturated
/// beyond the target, or shortened if none would be: by 4, 8 or 16 s. Stages keep their order and at least their
/// minimum. A junction by itself has no offset. A stage that the plan has forced and that is not in the cycle is left
/// after its minimum.
///
/// Sources: P. Hunt et al., SCOOT: a traffic responsive method of coordinating signals, TRRL Laboratory Report 1014,
/// 1981; Traffic Advisory Leaflet 4/95; scoot-utc.com, How SCOOT works. Reconstructed: step sizes and the target of 90
/// % are the commonly told ones, the detector upstream is the edge of the counted reach, and who gets the seconds by
/// which a cycle changes (the most saturated green gains, the least saturated loses). Congestion importance and gating
/// are left out.

#pragma once

#include "approaching.hpp"
#include "cycle.hpp"

#include <vector>

namespace elmopp {

struct Scoot {
    unsigned longest_cycle_s;
    double target; ///< degree of saturation
    Cycle cycle{};
    Departures departures{};
    MeanFlow flow{900};                                   ///< for the steps of a round that have not been seen yet
    std::vector<std::vector<double>> profile_veh_per_s{}; ///< [movement][step of the round]; below 0: not seen
    std::vector<double> step_veh{};                       ///< [movement] arrivals of this step so far
    unsigned round_s = 0;                                 ///< since the round began
    std::vector<unsigned> greens_s{};                     ///< [position] as planned
    std::vector<double> saturation{};                     ///< [position] when it was last modelled
    std::vector<double> departed_veh{};                   ///< [movement] in this green
    elmopp_stage_t shown = ELMOPP_STAGE_NONE;             ///< whose green it is
    unsigned end_s = 0;                                   ///< of this green
    int late_s = 0;                                       ///< by which this change comes later than planned
    bool decided = false;                                 ///< about the change that comes
    unsigned review_s = 0;                                ///< since the last look at the cycle
    bool grows = false;

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);

  private:
    void prepare(const elmopp_view_t &view);
    void observe(const elmopp_view_t &view);
    void begin_green(const elmopp_view_t &view, std::size_t position);
    void review_cycle(const elmopp_view_t &view);
    void resize(const elmopp_view_t &view, int seconds);
    [[nodiscard]] double cycle_s(const elmopp_view_t &view) const;
    [[nodiscard]] double coming_veh(std::size_t movement, double seconds, double round_length_s) const;
    [[nodiscard]] double modelled(const elmopp_view_t &view, std::size_t position, double until_s,
                                  double green_s) const;
    void decide_change(const elmopp_view_t &view, std::size_t position);
};

} // namespace elmopp
