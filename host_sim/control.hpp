// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Control: the firmware at one junction, by one of its two seams.
///
/// Directly, the pilot gets real-valued vehicles, as the paper's fluid has them. Through frames, the whole controller
/// gets what a camera and a lamp node would send, and the simulator sees of it what is on the bus.

#pragma once

#include "choosers.hpp"
#include "scenario.hpp"
#include "traffic.hpp"

#include <memory>
#include <vector>

namespace elmopp {

struct Demand;

class Control {
  public:
    Control() = default;
    Control(const Control &) = delete;
    Control &operator=(const Control &) = delete;
    virtual ~Control() = default;

    /// Once a second, after the arrivals.
    virtual void count(const Traffic &traffic, std::size_t t_s) = 0;
    /// Ten times a second after it: the lamps until the next.
    virtual elmopp_lamps_t lamp_tick() = 0;

    [[nodiscard]] virtual const elmopp_pilot_t &pilot() const = 0;
    /// [movement] as the core saw them in this second.
    [[nodiscard]] virtual const float *present_veh() const = 0;
    [[nodiscard]] virtual const float *arrived_veh() const = 0;
    /// ELMOPP_MODE_COUNT: the pilot alone has none.
    [[nodiscard]] virtual elmopp_mode_t mode() const = 0;
    [[nodiscard]] virtual elmopp_fault_t fault() const = 0;
};

/// The inner seam. Shows the pilot what is known before second 0.
std::unique_ptr<Control> make_direct(const Scenario &scenario, const ChooserSpec &spec, const Demand &demand);

/// The outer seam: runs the controller through its start-up, in the seconds before second 0 and with nobody waiting,
/// until it is in automatic mode. Throws BadRequest for a forecast from outside: no frame carries one.
std::unique_ptr<Control> make_framed(const Scenario &scenario, const ChooserSpec &spec, const Demand &demand);

} // namespace elmopp
