// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Serve: a junction that runs on and on, for people who look at it in a browser of this machine.
///
/// A run is that of `host_sim run --link inproc --full` with the same site, chooser, vehicles, seed and trial, or,
/// straight, of the same without --link: its lines are the same bytes, with whose the forecast is (`model`) behind
/// them. When its traffic is at an end, the next trial begins. The demand may change at any second, from which on it is
/// another run; another chooser begins anew at second 0 of the same trial, so that choosers are compared with the same
/// traffic, and because a controller that is replaced starts up.
///
/// The simulation runs in the thread that calls. Wishes come from the server's threads; whoever looks on, and how
/// slowly, changes nothing.

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace elmopp {

constexpr std::uint16_t usual_port = 8137;

struct ServeRequest {
    std::optional<std::filesystem::path> site; ///< four_way unless given
    std::optional<std::string> chooser; ///< the site's; cumulative:lstm, which has a forecast to see, without site
    unsigned vehicles = 600;
    std::uint64_t seed = 1;
    std::uint64_t trial = 0;
    std::uint16_t port = usual_port; ///< on 127.0.0.1; 0: any
    double speed = 1.0;              ///< simulated seconds a second
    bool paused = false;
    bool straight = false; ///< real-valued vehicles straight to the pilot: no frames, mode and faults
};

constexpr double lowest_speed = 0.1;
constexpr double highest_speed = 100.0;

/// Runs until an interrupt or a request to end has come. Throws BadRequest if it cannot begin.
void serve(const ServeRequest &request);

} // namespace elmopp
