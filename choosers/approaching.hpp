// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Approaching: of the vehicles inside the counted reach, who has reached the queue and who is still on his way; and
/// how many come.
///
/// A camera says how many are there and how many came. Who came less than travel_s ago drives, in the order of arrival;
/// if fewer are there than drive, the oldest have left early. With a travel time of 0 everybody is queued.

#pragma once

#include "setting.hpp"

#include <cstddef>
#include <vector>

namespace elmopp {

class Approaching {
  public:
    Approaching() = default;
    explicit Approaching(const Travel &travel_s) : travel_s_(travel_s) {}

    /// Once a second, in the intergreen too. At the first call all but the last second's arrivals are queued.
    void observe(const elmopp_view_t &view);

    [[nodiscard]] unsigned travel_s(std::size_t movement) const {
        return travel_s_.at(movement);
    }
    /// Of all movements.
    [[nodiscard]] unsigned longest_travel_s() const;
    [[nodiscard]] double queued_veh(std::size_t movement) const {
        return queued_veh_[movement];
    }
    /// Vehicles that reach the queue or the stop line in second `second`, 0 being the next.
    [[nodiscard]] double due_veh(std::size_t movement, unsigned second) const;
    /// The same in the next so many seconds.
    [[nodiscard]] double due_within_veh(std::size_t movement, unsigned seconds) const;

  private:
    Travel travel_s_{};
    std::vector<double> queued_veh_;
    std::vector<std::vector<double>> due_veh_; ///< [movement][second]
};

/// Arrivals of each movement: the mean of all seconds so far, then one that forgets with this window.
class MeanFlow {
  public:
    explicit MeanFlow(unsigned window_s) : window_s_(window_s) {}

    void observe(const elmopp_view_t &view);

    [[nodiscard]] double veh_per_s(std::size_t movement) const {
        return veh_per_s_[movement];
    }
    [[nodiscard]] unsigned seen_s() const {
        return seen_s_;
    }

  private:
    unsigned window_s_;
    unsigned seen_s_ = 0;
    std::vector<double> veh_per_s_;
};

/// Vehicles that left each movement in the last second.
class Departures {
  public:
    void observe(const elmopp_view_t &view);

    [[nodiscard]] double veh(std::size_t movement) const {
        return left_veh_[movement];
    }

  private:
    std::vector<double> before_veh_;
    std::vector<double> left_veh_;
};

} // namespace elmopp
