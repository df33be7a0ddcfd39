// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Control: the firmware at one junction, by one of its two seams.
///
/// Directly, the pilot gets real-valued vehicles, as the paper's fluid has them. Through frames, the whole controller
/// gets what a camera and a lamp node would send, and the simulator sees of it what is on the bus.

#pragma once

#include "choosers.hpp"
#include "counted.hpp"
#include "scenario.hpp"
#include "wire.hpp"

#include <memory>
#include <vector>

namespace elmopp {

struct Demand;

/// What the controller has told of its last decision. Arrays live until the next tick.
struct Told {
    elmopp_stage_t stage; ///< shown; ELMOPP_STAGE_NONE: none
    elmopp_mode_t mode;   ///< ELMOPP_MODE_COUNT: the pilot alone has none
    elmopp_fault_t fault;
    elmopp_foresight_t foresight;
    const float *present_veh;  ///< [movement] as the core saw them in this second
    const float *arrived_veh;  ///< [movement]
    const float *score;        ///< [stage]
    const float *foreseen_veh; ///< [approach] in the next ELMOPP_PILOT_TRACE_S seconds
};

class Control {
  public:
    Control() = default;
    Control(const Control &) = delete;
    Control &operator=(const Control &) = delete;
    virtual ~Control() = default;

    /// Once a second, after the arrivals.
    virtual void count(const Counted &world, std::size_t t_s) = 0;
    /// Ten times a second after it: the lamps until the next.
    virtual elmopp_lamps_t lamp_tick() = 0;
    [[nodiscard]] virtual Told told() const = 0;
};

/// The inner seam. Shows the pilot what is known before second 0.
std::unique_ptr<Control> make_direct(const Scenario &scenario, const ChooserSpec &spec, const Demand &demand);

/// A junction's frames and lamp ticks: whoever runs the controller behind it.
class Link {
  public:
    Link() = default;
    Link(const Link &) = delete;
    Link &operator=(const Link &) = delete;
    virtual ~Link() = default;

    /// One lamp tick at this time: frames to the controller, and what it has answered.
    virtual std::vector<elmopp_frame_t> tick(const std::vector<elmopp_frame_t> &frames, elmopp_ms_t now_ms) = 0;

    /// True if somebody else plays this lamp node.
    [[nodiscard]] virtual bool has_node(std::uint32_t node) const = 0;

    /// Seconds of known arrivals that are replayed before second 0, beyond the start-up.
    [[nodiscard]] virtual std::size_t history_s() const = 0;
};

/// What a refused frame means: a mistake of the simulator's, or that frames before it were lost.
enum class Refused { mistake, loss };

/// The controller in this process, with what a street knows: the shipped regression, running means. The scenario must
/// outlive it.
std::unique_ptr<Link> make_inproc(const Scenario &scenario, const ChooserSpec &spec, const Demand &demand,
                                  Refused refused = Refused::mistake);

/// A controller at the other end of a wire: of its own time (real), or of ours (bus).
std::unique_ptr<Link> make_bus(std::unique_ptr<Wire> wire, bool bus_clock);

/// The outer seam: runs the controller through its start-up, in the seconds before second 0 and with nobody waiting,
/// until it is in automatic mode. Throws BadRequest for a forecast from outside: no frame carries one.
std::unique_ptr<Control> make_framed(const Scenario &scenario, const ChooserSpec &spec, const Demand &demand,
                                     std::unique_ptr<Link> link);

} // namespace elmopp
