// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Network: several junctions and the roads between them, by the paper's adjacency tensor.
///
/// Entry (i, j) of the tensor are the left, middle and right lanes that the road from junction i has at junction j; a
/// road is there if any of them is. Where a turn has no lane nobody turns and its movement has no storage, the paper's
/// dead edge. Roads from and to the world outside are not in the tensor. Every road has the length and the limit of its
/// network unless it is told apart at the junction to which it leads, by the side from which it comes. It says where
/// roads lead and runs nothing.

#pragma once

#include "scenario.hpp"
#include "street_plan.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace elmopp {

/// [left, middle, right] lanes, 1 or 0.
using Entry = std::array<int, 3>;
using Tensor = std::vector<std::vector<Entry>>; ///< [tail][head]

/// How a road differs from the others of its network; no value: it does not.
struct RoadText {
    std::optional<double> length_m;
    std::optional<double> speed_km_per_h;
};

/// One junction as described.
struct Node {
    std::string name;
    std::string site;
    std::array<std::string, 4> neighbours; ///< [side] the junction there; empty: the world outside
    std::array<RoadText, 4> roads{};       ///< [side] the road that comes from there
};

/// A network as described.
struct NetworkText {
    std::string name;
    std::vector<Node> nodes;
    Tensor adjacency;
};

/// A network ready to run: scenarios and the plan that refers to them. To be moved, never copied.
struct Network {
    Network() = default;
    Network(const Network &) = delete;
    Network &operator=(const Network &) = delete;
    Network(Network &&) = default;
    Network &operator=(Network &&) = default;
    ~Network() = default;

    std::string name;
    std::vector<Scenario> scenarios; ///< [junction]
    StreetPlan plan;
};

/// A grid of `rows` x `columns` four_way junctions with every road two-way and every turn possible.
NetworkText grid(unsigned rows, unsigned columns);

/// Reads grid:ROWSxCOLUMNS or a TOML file (networks/g_alpha.toml). `profile` is filled with the file's length and
/// speed as options of profile discrete unless it has its own. Throws BadRequest naming what is wrong.
NetworkText read_network(const std::string &text, std::string &profile);

/// Builds it under a profile discrete without a site. Throws BadRequest naming junction, side and what would be right.
Network make_network(const NetworkText &text, const std::string &profile);

} // namespace elmopp
