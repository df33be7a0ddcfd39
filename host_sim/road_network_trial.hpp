// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Network trial: a network under one chooser at every junction, and an experiment of such trials.
///
/// Every junction has a controller of its own, which knows its own counts, how many vehicles are on the roads that lead
/// away (if its chooser asks) and, if neighbours speak, what has left them towards it. What they say is what a
/// NeighbourOutflow frame can carry: arrivals in the next 10, 30 and 60 seconds.

#pragma once

#include "choosers.hpp"
#include "road_network.hpp"
#include "trial.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace elmopp {

/// Everything that distinguishes a trial on one network.
struct NetworkCell {
    ChooserSpec chooser;
    bool neighbours;   ///< they announce their outflow
    unsigned vehicles; ///< to every arm from outside
    std::uint64_t trial;
    bool framed = false; ///< controllers hear and speak in frames; false: pilots in numbers
};

Metrics run_network(const Network &network, const NetworkCell &cell, std::uint64_t seed, std::size_t seconds);

struct NetworkRequest {
    std::string network; ///< grid:ROWSxCOLUMNS or a file
    std::string profile = "discrete";
    std::vector<ChooserSpec> choosers;
    std::vector<bool> neighbours{false};
    bool framed = false; ///< as of NetworkCell
    std::vector<unsigned> vehicles;
    std::uint64_t trials = 30;
    std::uint64_t seed = 1;
    unsigned jobs = 1;
    std::filesystem::path out{"out/experiment"};
};

/// Runs it and writes trials.csv, summary.json and pairs.csv to the folder `out`, all or nothing. The forecast of a row
/// with neighbours ends in "+neighbours", so that pairs.csv pairs with and without.
void run_network_experiment(const NetworkRequest &request);

} // namespace elmopp
