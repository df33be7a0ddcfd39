// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Turns: what the names of a site say of its shape.
///
/// A site file says who conflicts with whom, not where a road leads. Names do, by a convention that the sites here
/// keep: an approach named N, E, S or W comes from that side, and the letters after the dot of a movement's name are
/// its turns, L left, M straight on (middle), R right, T straight on and right, so "N.LM" is a lane for both. Whatever
/// is named otherwise has no shape: it leads outside and gives way to nobody. Right-hand traffic.

#pragma once

#include "core.hpp"

#include <optional>
#include <string>
#include <vector>

namespace elmopp {

enum class Turn { left, straight, right };

constexpr int side_count = 4; ///< N, E, S, W, clockwise

/// The side from which an approach comes, 0..3; none if its name is not one of the four.
std::optional<int> side_of(const elmopp_junction_t &junction, std::size_t approach);
/// The side of that name, N, E, S or W; nothing if it is none.
std::optional<int> side_named(const std::string &name);

/// The approach that comes from a side; none if there is none.
std::optional<std::size_t> approach_of(const elmopp_junction_t &junction, int side);

/// The side to which a turn leads who comes from `side`.
int exit_of(int side, Turn turn);

/// The turns of a movement; empty if its name does not say.
std::vector<Turn> turns_of(const elmopp_junction_t &junction, std::size_t movement);

/// The side's letter.
std::string side_name(int side);

/// The movements to which a left turn of this movement gives way: straight on or right from the opposite side, and by
/// the site's conflicts allowed to be green with it.
std::vector<std::size_t> gives_way_to(const elmopp_junction_t &junction, std::size_t movement);

} // namespace elmopp
