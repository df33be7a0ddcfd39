// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Run: one trial with a decision log, for people who want to see what the controller did and when.

#pragma once

#include "choosers.hpp"
#include "inflow.hpp"
#include "trial.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace elmopp {

struct RunRequest {
    std::optional<std::string> profile;        ///< paper, or saturation with a site
    std::optional<std::filesystem::path> site; ///< the paper's unless given
    std::optional<std::string> chooser;        ///< the site's unless given
    unsigned vehicles = 800;
    std::uint64_t seed = 1;
    std::uint64_t trial = 0;
    std::optional<std::filesystem::path> trace;   ///< replaces the generated inflow
    std::optional<std::filesystem::path> weights; ///< an ELMW image instead of the shipped weights
    std::optional<std::size_t> seconds;           ///< 2000, or the trace's length
    std::optional<std::filesystem::path> log;     ///< decision log, JSON lines; "-" for stdout
    bool full = false;                            ///< with queues, reds and departures
    std::optional<std::filesystem::path> summary; ///< metrics as JSON; stdout unless given
    std::string link;      ///< empty: the inner seam; otherwise through frames: inproc, can:IFACE, slcan:PLACE
    bool bus_clock = true; ///< over a bus: our time, or everybody's own
    std::vector<double> split;
    Mapping mapping = Mapping::abs;
    std::optional<Integrator> integrator;
};

/// Runs it; files are written whole or not at all.
void run_once(const RunRequest &request);

/// One second's line of the decision log, without a line feed. `full`: with queues, reds, departures and mode.
std::string log_line(const Second &second, const elmopp_junction_t &junction, bool full);

/// The `inflow` command: writes the trajectory (`mapping` empty: raw) of one trial as CSV.
void write_inflow(Integrator integrator, std::optional<Mapping> mapping, Scope scope, unsigned vehicles,
                  std::uint64_t seed, std::uint64_t trial, std::size_t points, const std::filesystem::path &file);

} // namespace elmopp
