// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Street bus: the junction's bus with cameras that look, lamp nodes that are the firmware's own, and what can go
/// wrong.
///
/// A link between the simulator and whoever runs the controller. In place of the simulator's counts it sends what the
/// counters of the cameras say; in place of lamps that do as told it has elmopp_lamp_node, and what those show is what
/// the street sees. It can lose frames (each for everybody, by a seed) and pull the controller's plug in the middle of
/// a green. Troubles come by a list, at times of the run.
///
/// Owner: the Control that it is given to. Not thread-safe.

#pragma once

#include "camera_bus.hpp"
#include "control.hpp"
#include "film.hpp"
#include "witness.hpp"

extern "C" {
#include "elmopp/lamp_node.h"
}

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace elmopp {

/// One line of a list of troubles: KIND[:WHO]@FROM[-TO], seconds of the run.
/// - black, freeze, turn, gone: the camera of the approach WHO, or all; without TO to the end of the run.
/// - lose: WHO percent of the frames; without TO to the end of the run.
/// - reset: the controller's plug is pulled in the first green from FROM on, for TO - FROM seconds; without TO it
///   begins anew at once.
struct Trouble {
    std::string kind;
    std::string who;
    double from_s;
    double to_s;
};

/// Throws BadRequest naming what is wrong and what would be right.
std::vector<Trouble> parse_troubles(const std::string &text, const elmopp_junction_t &site);

/// Behind the bus: makes a controller, and makes it anew after a reset.
using ControllerMaker = std::function<std::unique_ptr<Link>()>;
/// Resets what is at the other end, if that does not end with the link.
using Reset = std::function<void()>;

/// What a second was like, for the log.
struct BusSecond {
    std::vector<elmopp_lamps_t> shown; ///< [tick]
    std::vector<Record> records;       ///< [camera]
    unsigned lost = 0;                 ///< frames
    bool reset = false;                ///< the plug was pulled
    bool silent = false;               ///< nobody controlled at its end
};

class StreetBus final : public Link {
  public:
    /// `films`: one an approach that has a camera, in the order of the site; empty: the simulator's own counts go
    /// through. `places`: kept up to date by the caller. Both must outlive it, as must the site.
    StreetBus(const elmopp_junction_t &site, ControllerMaker maker, Reset reset, std::vector<Film *> films,
              const std::vector<Place> &places, std::vector<Trouble> troubles, std::uint64_t seed);

    std::vector<elmopp_frame_t> tick(const std::vector<elmopp_frame_t> &frames, elmopp_ms_t now_ms) override;

    [[nodiscard]] bool has_node(std::uint32_t /*node*/) const override {
        return true;
    }
    /// What a camera has not seen nobody knows.
    [[nodiscard]] std::size_t history_s() const override {
        return 0;
    }

    /// Second 0 begins: troubles count from here.
    void begin();

    /// What burns now.
    [[nodiscard]] const elmopp_lamps_t &shown() const {
        return shown_;
    }
    [[nodiscard]] const Witness &witness() const {
        return witness_;
    }

    /// Takes what has been noted since the last call.
    BusSecond take_second();

    /// After every camera has looked.
    std::function<void(double t_s)> looked;

  private:
    [[nodiscard]] double run_s() const;
    [[nodiscard]] const Trouble *trouble_now(const std::string &kind, const std::string &who) const;
    [[nodiscard]] CameraTrouble trouble_of(std::size_t approach) const;
    void look();
    void tell(std::vector<elmopp_frame_t> &frames);
    void pull_or_put_plug();
    void light(const std::vector<elmopp_frame_t> &frames);
    std::vector<elmopp_frame_t> carried(const std::vector<elmopp_frame_t> &frames);

    const elmopp_junction_t &site_;
    ControllerMaker maker_;
    Reset reset_;
    std::unique_ptr<Link> controller_; ///< null: its plug is out
    std::int64_t back_ticks_ = 0;      ///< when it is in again
    std::vector<Film *> films_;
    std::vector<CameraBus> cameras_; ///< [film]
    const std::vector<Place> &places_;
    std::vector<Trouble> troubles_;
    SplitMix64 chance_;
    std::vector<elmopp_lamp_node_t> nodes_;
    elmopp_lamps_t shown_{};
    Witness witness_;
    BusSecond second_;
    std::int64_t ticks_ = 0;
    std::int64_t begun_ticks_ = -1; ///< -1: it has not begun
};

} // namespace elmopp
