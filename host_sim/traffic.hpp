// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Traffic: the vehicles at one junction, as a fluid, in double precision.
///
/// Vehicles come to a movement, wait inside its capacity or, when that is full, outside, and leave on green. None is
/// ever dropped: conservation is checked every second, in release builds too. It decides no lamp and knows no
/// controller.
///
/// Order of a second: arrive(), the controller's turn, leave().

#pragma once

#include "counted.hpp"
#include "scenario.hpp"

#include <vector>

namespace elmopp {

class Traffic final : public Counted {
  public:
    explicit Traffic(const Scenario &scenario);

    /// One second of inflow, [approach] vehicles. What does not fit waits outside and enters when there is room.
    void arrive(const std::vector<double> &inflow_veh);

    /// One second of discharge; `flowing` is the part of the second in which each movement's queue moves, [movement]
    /// 0..1.
    void leave(const std::vector<double> &flowing);

    /// Throws Failure if a vehicle has been lost or made: |initial + arrived - left - queued - outside| > 1e-6.
    void check_conservation() const;

    [[nodiscard]] double total_in_veh() const {
        return total_in_veh_;
    } ///< with the initial ones
    [[nodiscard]] double total_out_veh() const {
        return total_out_veh_;
    }

  private:
    [[nodiscard]] double flow_veh(std::size_t movement) const;

    const Scenario &scenario_;
    double total_in_veh_ = 0.0;
    double total_out_veh_ = 0.0;
};

/// Flow on full green, vehicles per second, never more than the queue: the laws of elmopp_junction_discharge() in
/// double.
double discharge_veh_per_s(int law, double queue_veh, double capacity_veh, double free_flow_m_per_s,
                           double saturation_veh_per_s);

} // namespace elmopp
