// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Lane queue: vehicles one behind another on a stretch of finite length.
///
/// Nobody overtakes. Who leaves at the head makes room at the tail only when the gap has come there: a queue starts one
/// vehicle after another (a backward wave of wave_ds a vehicle). It decides no turn and knows no lamp.

#pragma once

#include <cstdint>
#include <deque>

namespace elmopp {

constexpr double vehicle_m = 7.5;         ///< of a queue, gap included
constexpr std::int64_t wave_ds = 10;      ///< from one vehicle's start to the next one's
constexpr std::int64_t following_ds = 10; ///< the shortest time between two that drive in at the tail

/// One vehicle on an arm.
struct Vehicle {
    std::int64_t due_ds;   ///< when it would cross the stop line if nobody had been in its way on this arm
    std::int64_t ready_ds; ///< when it is at the end of its stretch at the earliest
    std::uint64_t seed;    ///< what it will decide next
    std::size_t way;       ///< index into its arm's ways
};

class LaneQueue {
  public:
    explicit LaneQueue(std::size_t storage_veh) : storage_veh_(storage_veh) {}

    /// True if a further vehicle fits and the one before it is far enough ahead.
    [[nodiscard]] bool has_room(std::int64_t now_ds);
    void enter(const Vehicle &vehicle, std::int64_t now_ds);
    /// Takes the head out.
    void leave(std::int64_t now_ds);

    [[nodiscard]] const std::deque<Vehicle> &vehicles() const {
        return vehicles_;
    }
    /// True if the head has come to the end of the stretch.
    [[nodiscard]] bool is_ready(std::int64_t now_ds) const {
        return !vehicles_.empty() && vehicles_.front().ready_ds <= now_ds;
    }

    double next_ds = 0.0;    ///< of a lane at a stop line: the head may cross then at the earliest
    bool in_the_box = false; ///< the head waits beyond the stop line for a gap

  private:
    std::size_t storage_veh_;
    std::deque<Vehicle> vehicles_;
    std::deque<std::int64_t> gaps_ds_; ///< when the room of those who left reaches the tail
    std::int64_t next_in_ds_ = INT64_MIN;
};

} // namespace elmopp
