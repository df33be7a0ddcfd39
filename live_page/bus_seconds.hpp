// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// BusSeconds: a controller on a bus as a stream of decision lines, from its frames alone.
///
/// The lines have the keys of the decision log. What no frame says is left out or named: the chooser's scores are 0
/// (only a controller on the bus clock sends them), `uncounted` lists the movements whose camera is silent or sees
/// nothing, `mode` and `fault_group` are missing while the controller is silent, `model` (whose the forecast is)
/// without Forecast. `aspects` are what is commanded; `differs` says in words what the lamps of a group do, by the
/// group's number, where their node reports something else or nothing. It listens and says nothing to anybody.

#pragma once

#include "junction_view.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace elmopp {

class BusSeconds {
  public:
    explicit BusSeconds(const elmopp_junction_t &junction) : junction_(junction), view_(junction) {}

    void hear(const elmopp_frame_t &frame, std::uint32_t now_ms);

    /// The line of the second that ends now.
    std::string line(std::uint32_t now_ms);

  private:
    struct Counted {
        std::array<float, ELMOPP_MOVEMENT_MAX> present_veh{};
        std::array<float, ELMOPP_MOVEMENT_MAX> arrived_veh{};
        std::string uncounted;
    };

    Counted count(const JunctionView::Seen &seen);
    float arrivals(std::size_t movement, std::uint8_t total);

    const elmopp_junction_t &junction_;
    JunctionView view_;
    std::array<std::optional<std::uint8_t>, ELMOPP_MOVEMENT_MAX> total_;
    std::size_t t_s_ = 0;
};

} // namespace elmopp
