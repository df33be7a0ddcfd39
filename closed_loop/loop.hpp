// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Closed loop: one street, once with counts that are right and once with those of cameras that look at its drawing,
/// and what the difference costs.
///
/// Both runs have the same vehicles, the same start-up and the same bus. Everything follows from the request: the same
/// one writes the same files, byte for byte, whatever the link.

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace elmopp {

struct LoopRequest {
    std::size_t seconds = 600; ///< 1 to simulated_points
    unsigned vehicles = 400;   ///< of an approach in 2,000 s
    std::uint64_t seed = 1;
    std::filesystem::path out;
    std::filesystem::path site = "sites/four_way.toml";
    std::optional<std::string> chooser; ///< the site's unless given
    std::string demand = "hyperchaos";
    std::string link = "inproc"; ///< or can:IFACE, slcan:PLACE
    std::string scene = "day";
    std::string overlay; ///< video or picture; empty: none
    std::string faults;  ///< list of troubles (bus.hpp); in the run with cameras
    std::string reset;   ///< command that resets what is at the other end of the link
};

/// Runs it and writes closed_loop.json, street.jsonl and the lane files into `out`. Throws BadRequest, and Failure if
/// lamps showed what they must not.
void run_loop(const LoopRequest &request);

} // namespace elmopp
