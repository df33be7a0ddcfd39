// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Streets: single vehicles on the arms of one or several junctions, lamp tick by lamp tick.
///
/// An arm is a road and, within the counted reach, the lanes of its movements. A vehicle drives at the limit, joins the
/// shortest lane that leads its way, waits where there is no room ahead (on the road, where it holds up those behind
/// it, at another junction's stop line, or outside) and crosses the stop line when its movement is open: the first of
/// a queue after the start-up loss, the next ones a saturation headway apart, a left turn that gives way in a gap. None
/// is ever dropped: conservation is checked every second. It decides no lamp and knows no controller; what a controller
/// may know are the counts within the reach.
///
/// Time counts in tenths of a second from second 0; the roads fill before it.

#pragma once

#include "comings.hpp"
#include "counted.hpp"
#include "lane.hpp"
#include "street_plan.hpp"

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

namespace elmopp {

/// What a neighbour says of its outflow to an arm: arrivals at the edge of the reach from now on, in tenths of a
/// vehicle, as NeighbourOutflow carries them.
struct Outflow {
    unsigned next10 = 0;
    unsigned next30 = 0;
    unsigned next60 = 0;
};

/// One junction's counts.
class JunctionCounts final : public Counted {
  public:
    explicit JunctionCounts(std::size_t movements) : Counted(movements) {}
    friend class Streets;
};

class Streets {
  public:
    /// `comings`: [junction][approach], empty for arms that come from another junction. The plan must outlive it.
    Streets(const StreetPlan &plan, std::vector<Comings> comings);
    Streets(const Streets &) = delete;
    Streets &operator=(const Streets &) = delete;
    Streets(Streets &&) = delete;
    Streets &operator=(Streets &&) = delete;
    ~Streets() = default;

    /// Before a second's ticks: what arrived and left counts from here.
    void begin_second();
    /// One lamp tick; `open`: [junction] mask of the movements whose vehicles may cross.
    void tick(const std::vector<std::uint32_t> &open);
    /// After a second's ticks: counts what is where.
    void end_second();

    [[nodiscard]] const JunctionCounts &counts(std::size_t junction) const {
        return counts_[junction];
    }
    /// Vehicles of a movement that would have crossed by now if nobody had been in their way.
    [[nodiscard]] std::size_t late_veh(std::size_t junction, std::size_t movement) const;
    /// [movement] vehicles on the arm to which the movement leads, 0 outside; its mean over the ways if there are more.
    [[nodiscard]] std::vector<float> downstream_veh(std::size_t junction) const;
    /// What has left the neighbour and, at the limit, has not reached the reach of this arm yet.
    [[nodiscard]] Outflow outflow_to(ArmId arm) const;
    /// True if a vehicle waits inside the junction, beyond its stop line.
    [[nodiscard]] bool is_occupied(std::size_t junction) const;

    /// Who is where, for whoever derives places from it (places.hpp): [movement][pavement lane] within the reach, and
    /// [road lane] before it. Valid until the next tick.
    [[nodiscard]] const std::vector<std::vector<LaneQueue>> &lanes_in_reach(std::size_t junction) const {
        return junctions_[junction].lanes;
    }
    [[nodiscard]] const std::vector<LaneQueue> &lanes_on_road(ArmId arm) const {
        return junctions_[arm.junction].arms[arm.approach].road;
    }
    [[nodiscard]] std::int64_t now_ds() const {
        return now_ds_;
    }
    [[nodiscard]] std::uint32_t open_movements(std::size_t junction) const {
        return junctions_[junction].open;
    }

    [[nodiscard]] std::size_t total_in_veh() const {
        return total_in_veh_;
    }
    /// Out of the plan.
    [[nodiscard]] std::size_t total_out_veh() const {
        return total_out_veh_;
    }
    /// On arms, driving or queued.
    [[nodiscard]] std::size_t inside_veh() const;
    [[nodiscard]] std::size_t outside_veh() const;
    /// Delay of all vehicles so far against driving at the limit, over all arms, outside included.
    [[nodiscard]] double delay_veh_s() const;
    /// The largest delay of one vehicle on one arm so far, outside included.
    [[nodiscard]] double longest_wait_s() const;

    /// Throws Failure if a vehicle has been lost or made.
    void check_conservation() const;

  private:
    struct Arm {
        const ArmPlan *plan = nullptr;
        std::int64_t road_ds = 0;
        std::int64_t reach_ds = 0;
        std::vector<LaneQueue> road;
        std::vector<std::deque<Vehicle>> outside;     ///< [road lane]
        std::vector<std::vector<std::size_t>> choice; ///< [movement] road lanes that lead to it
        std::deque<std::int64_t> announced_ds;        ///< when they would come to the reach
        const std::vector<Coming> *comings = nullptr;
        std::size_t next_coming = 0;
    };
    struct Junction {
        const elmopp_junction_t *site = nullptr;
        std::vector<Arm> arms;                     ///< [approach]
        std::vector<std::vector<LaneQueue>> lanes; ///< [movement][pavement lane]
        std::uint32_t open = 0;
    };

    [[nodiscard]] static Junction build(const JunctionPlan &plan, const Comings &comings);
    void open(Junction &junction, std::uint32_t open) const;
    void cross(std::size_t junction);
    void cross_from(std::size_t junction, std::size_t movement, LaneQueue &lane);
    [[nodiscard]] bool may_go(const Junction &junction, std::size_t movement, LaneQueue &lane, const Way &way) const;
    bool move_on(const Vehicle &vehicle, const Way &way);
    void reach(std::size_t junction, Arm &arm);
    void come(Arm &arm);
    [[nodiscard]] std::int64_t begin_ds() const;
    /// Shows each lane's vehicles and all that wait outside: visit(vehicles, whether they are inside).
    template <typename Visit> void for_queues(const Visit &visit) const;

    std::vector<Comings> comings_;
    std::vector<Junction> junctions_;
    std::vector<JunctionCounts> counts_;
    std::int64_t now_ds_ = 0;
    std::size_t total_in_veh_ = 0;
    std::size_t total_out_veh_ = 0;
    double delay_veh_ds_ = 0.0;        ///< of those who have left their arm
    std::int64_t longest_wait_ds_ = 0; ///< likewise
};

} // namespace elmopp
