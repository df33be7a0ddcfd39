// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "turns.hpp"

#include <map>

namespace elmopp {
namespace {

const std::string sides = "NESW";

bool is_left(const elmopp_junction_t &junction, std::size_t movement) {
    const auto turns = turns_of(junction, movement);
    return !turns.empty() && turns.front() == Turn::left;
}

bool is_only_left(const elmopp_junction_t &junction, std::size_t movement) {
    return is_left(junction, movement) && turns_of(junction, movement).size() == 1;
}

bool conflict(const elmopp_junction_t &junction, std::size_t a, std::size_t b) {
    std::uint32_t foes = 0;
    for (std::uint32_t g = 0; g < junction.group_count; ++g) {
        foes |= elmopp_mask_has(junction.movement[a].groups, g) ? std::uint32_t{junction.conflict[g]} : 0U;
    }
    return (foes & junction.movement[b].groups) != 0;
}

} // namespace

std::optional<int> side_of(const elmopp_junction_t &junction, std::size_t approach) {
    return side_named(junction.approach_name[approach]);
}

std::optional<int> side_named(const std::string &name) {
    const auto found = sides.find(name);
    return name.size() == 1 && found != std::string::npos ? std::optional<int>(static_cast<int>(found)) : std::nullopt;
}

std::optional<std::size_t> approach_of(const elmopp_junction_t &junction, int side) {
    for (std::size_t i = 0; i < junction.approach_count; ++i) {
        if (side_of(junction, i) == side) {
            return i;
        }
    }
    return std::nullopt;
}

int exit_of(int side, Turn turn) {
    // From the north: left leads east, straight on south, right west.
    const int clockwise = turn == Turn::left ? 1 : turn == Turn::straight ? 2 : 3;
    return (side + clockwise) % side_count;
}

std::vector<Turn> turns_of(const elmopp_junction_t &junction, std::size_t movement) {
    static const std::map<char, std::vector<Turn>> letters{
        {'L', {Turn::left}}, {'M', {Turn::straight}}, {'R', {Turn::right}}, {'T', {Turn::straight, Turn::right}}};
    const std::string name = junction.movement[movement].name;
    const auto dot = name.find('.');
    std::vector<Turn> turns;
    for (std::size_t i = dot == std::string::npos ? name.size() : dot + 1; i < name.size(); ++i) {
        const auto found = letters.find(name[i]);
        if (found == letters.end()) {
            return {};
        }
        turns.insert(turns.end(), found->second.begin(), found->second.end());
    }
    return turns;
}

std::string side_name(int side) {
    return sides.substr(static_cast<std::size_t>(side), 1);
}

std::vector<std::size_t> gives_way_to(const elmopp_junction_t &junction, std::size_t movement) {
    const auto side = side_of(junction, junction.movement[movement].approach);
    const auto opposite = side ? approach_of(junction, exit_of(*side, Turn::straight)) : std::nullopt;
    std::vector<std::size_t> found;
    if (!opposite || !is_left(junction, movement)) {
        return found;
    }
    for (std::size_t j = 0; j < junction.movement_count; ++j) {
        if (junction.movement[j].approach == *opposite && !turns_of(junction, j).empty() &&
            !is_only_left(junction, j) && !conflict(junction, movement, j)) {
            found.push_back(j);
        }
    }
    return found;
}

} // namespace elmopp
