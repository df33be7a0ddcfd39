// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Self-control: serve the stage that lets most vehicles go for each second it takes, and nobody too late.
///
/// Optimising rule: each stage has the priority index expected vehicles / (change + clearing time), where the expected
/// ones are those that are there, those on their way and the mean flow of what is beyond, until the queue is cleared.
/// Another stage than the present also pays for the way back. Stabilising rule: a movement whose service would come
/// later than it should, for as many vehicles as it has, joins a queue of urgent movements; the first of these is
/// served until it is cleared or has had its share of a period, before anything else counts. The longer the last green
/// is ago, the fewer vehicles make it urgent: period_s apart as many as come in a period, at longest_s any.
///
/// Source: S. Laemmer and D. Helbing, Self-control of traffic lights and vehicle flows in urban road networks, J. Stat.
/// Mech. P04019, 2008; the same, Self-stabilizing decentralized signal control, Santa Fe Institute working paper, 2010.
/// Reconstructed: the papers speak of single flows; here an index is that of a stage, best over the clearing times of
/// its movements. A flow counts as one vehicle in a period at least, or one vehicle after a quiet hour would be urgent.

#pragma once

#include "approaching.hpp"

#include <deque>
#include <vector>

namespace elmopp {

struct SelfControl {
    /// A movement whose service would come too late.
    struct Late {
        std::size_t movement;
        unsigned green_s; ///< that it has had since
    };

    unsigned min_s;
    unsigned period_s;  ///< T: how often a movement should be served
    unsigned longest_s; ///< T_max: how often at least
    Approaching approaching{};
    MeanFlow flow{120};
    std::deque<Late> urgent{}; ///< in the order in which they became so

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);

  private:
    [[nodiscard]] double clearing_s(const elmopp_view_t &view, std::size_t movement, double before_s) const;
    [[nodiscard]] double expected_veh(std::size_t movement, double before_s, double green_s) const;
    [[nodiscard]] double index_of(const elmopp_view_t &view, elmopp_stage_t stage) const;
    [[nodiscard]] double share_s(const elmopp_view_t &view, std::size_t movement) const;
    [[nodiscard]] bool is_late(const elmopp_view_t &view, std::size_t movement) const;
    void keep_urgent(const elmopp_view_t &view);
};

} // namespace elmopp
