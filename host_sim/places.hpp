// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Places: where on the road the vehicles of one junction of Streets are, lamp tick by lamp tick, for whoever draws
/// them.
///
/// Streets knows in which lane and order vehicles are, when they would reach the stop line and when they cross it, and
/// that is all that delay is counted from. Places follows it and never leads: a vehicle is never nearer to the stop
/// line than at the limit from when it came; it keeps behind the one before it by Newell's rule with the constants of
/// the street (vehicle_m of road, wave_ds of time), which makes queues stand, fill and start as the street's do; and it
/// is beyond the line when the street says so. A queue leaves at the speed at which that rule gives the site's
/// saturation headway. It changes nothing of the street and draws nothing at random.
///
/// At its crossing a vehicle that queued is drawn a few metres beyond the line (its tail is across), one that brakes or
/// starts up to a second off; see docs/design.md.
///
/// Owner: whoever films. Not thread-safe.

#pragma once

#include "streets.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace elmopp {

/// One vehicle.
struct Place {
    std::uint64_t id; ///< its own, random; the same for as long as it is on the arm
    std::size_t approach;
    std::size_t movement;
    std::size_t way; ///< index into its arm's ways
    double front_m;  ///< of its front to the stop line, along the road; negative beyond it
    double across;   ///< of its middle: 0 in the middle of the arm's leftmost lane, 1 in that of the next
    double speed_m_per_s;
    bool braking;
};

/// Lanes of an arm side by side: those of its movements in site order, left to right.
std::vector<std::pair<std::size_t, std::size_t>> lanes_across(const elmopp_junction_t &site, std::size_t approach);

class Places {
  public:
    /// The junction of the plan that is followed. The plan must outlive it.
    Places(const StreetPlan &plan, std::size_t junction);

    /// After each lamp tick, and once before the first.
    void follow(const Streets &streets);

    /// All that are on the roads, in the lanes, or have crossed and not yet left the picture.
    [[nodiscard]] std::vector<Place> all() const;

  private:
    /// What a vehicle keeps behind: a place, and how fast it moves on.
    struct Bound {
        double front_m;
        double speed_m_per_s;
    };
    struct Track {
        Place place;
        std::size_t lane;                         ///< pavement lane of its movement
        std::array<double, wave_ds + 1> before_m; ///< a ring: the front in the ticks before
        std::uint64_t leader;                     ///< 0: nobody
        Bound street;                             ///< as the street has it
        Bound line;                               ///< the stop line, or the edge of a full reach
        double limit_m_per_s;
        double leaving_m_per_s; ///< of a queue
        bool queued;
        bool crossed;
        std::int64_t seen_ds;
    };

    Track &see(const Vehicle &vehicle, std::size_t approach, std::size_t movement);
    void see_reach(const Streets &streets, std::size_t movement);
    void see_road(const Streets &streets, std::size_t approach);
    void change_lane(Track &track, std::size_t lane) const;
    void see_crossed();
    void move(Track &track);

    const JunctionPlan &plan_;
    std::size_t junction_;
    std::vector<std::vector<double>> across_;      ///< [movement][pavement lane]
    std::vector<std::vector<std::uint64_t>> gone_; ///< the same: who has left it last; 0: nobody
    std::map<std::uint64_t, Track> tracks_;
    std::vector<std::uint64_t> order_; ///< of this tick, those in front before those behind them
    std::int64_t now_ds_ = 0;
};

} // namespace elmopp
