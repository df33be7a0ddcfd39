// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Rounds and jobs: rules that give a stage its whole green when they choose it, by how long its vehicles need.
///
/// The full texts of the ITLC and OAF papers were not at hand: the rules are reconstructed from the abstracts and from
/// docs/algorithm.md, and say what those authors' programs would do no better than that.

#pragma once

#include "approaching.hpp"

#include <cstdint>
#include <deque>
#include <vector>

namespace elmopp {

constexpr double ready_unlimited = 1e9;

/// ITLC (Younes and Boukerche 2014): at the end of each green the stage with most vehicles in its ready areas, green
/// until the last of them has crossed, 5 to 60 s.
struct Itlc {
    double ready_veh; ///< ready area, vehicles a lane
    unsigned left_s = 0;

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);
};

/// ITLC in rounds (Younes and Boukerche, LCN workshops 2014; IEEE Trans. Veh. Technol. 2016; reconstructed from the
/// abstracts): a movement is served once a round. At the end of each green the stage whose movements that are not
/// served yet are densest, green until the farthest of its vehicles has crossed, 5 to 60 s; when there is none with a
/// vehicle, a new round begins; when nobody is there at all, the green rests. Density is vehicles of the ready areas
/// over capacity.
struct ItlcRounds {
    double ready_veh; ///< ready area, vehicles a lane
    Approaching approaching{};
    std::uint32_t served = 0; ///< mask of the movements of this round
    elmopp_stage_t given = ELMOPP_STAGE_NONE;
    unsigned left_s = 0;

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);

  private:
    [[nodiscard]] double ready_of(const elmopp_view_t &view, std::size_t movement) const;
    elmopp_stage_t densest(const elmopp_view_t &view, float *score) const;
    void give(const elmopp_view_t &view, elmopp_stage_t stage);
};

/// OAF (Pandit, Ghosal, Zhang and Chuah, IEEE Trans. Veh. Technol. 62(4), 2013): the lane whose head vehicle came first
/// picks among its stages the one with the oldest heads, green for one platoon, 1 to 60 s.
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
    std::vector<Lane> lanes{}; ///< [movement]

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);
};

} // namespace elmopp
