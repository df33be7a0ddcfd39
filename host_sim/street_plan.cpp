// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "street_plan.hpp"

#include "turns.hpp"
#include "view.hpp"

#include <cmath>

namespace elmopp {
namespace {

constexpr double turning_share = 0.2;
constexpr double straight_share = 0.6;

double weight_of(Turn turn) {
    return turn == Turn::straight ? straight_share : turning_share;
}

double weight_of(const elmopp_junction_t &junction, std::size_t movement) {
    double weight = 0.0;
    for (const Turn turn : turns_of(junction, movement)) {
        weight += weight_of(turn);
    }
    return weight;
}

/// True if every movement of the approach says where it leads.
bool is_named(const elmopp_junction_t &junction, std::size_t approach) {
    for (std::size_t j = 0; j < junction.movement_count; ++j) {
        if (junction.movement[j].approach == approach && turns_of(junction, j).empty()) {
            return false;
        }
    }
    return true;
}

std::int64_t driving_ds(double length_m, double speed_m_per_s) {
    return static_cast<std::int64_t>(std::lround(ds_per_s * length_m / speed_m_per_s));
}

} // namespace

std::vector<double> usual_shares(const elmopp_junction_t &junction) {
    std::vector<double> share(junction.movement_count);
    std::vector<double> sum(junction.approach_count);
    for (std::size_t j = 0; j < share.size(); ++j) {
        const elmopp_movement_t &movement = junction.movement[j];
        share[j] = is_named(junction, movement.approach) ? weight_of(junction, j) : static_cast<double>(movement.lanes);
        sum[movement.approach] += share[j];
    }
    for (std::size_t j = 0; j < share.size(); ++j) {
        share[j] /= sum[junction.movement[j].approach];
    }
    return share;
}

std::vector<Way> ways_of(const elmopp_junction_t &junction, std::size_t approach, const std::vector<double> &share) {
    std::vector<Way> ways;
    for (std::size_t j = 0; j < junction.movement_count; ++j) {
        if (junction.movement[j].approach != approach) {
            continue;
        }
        const auto turns = turns_of(junction, j);
        if (turns.empty()) {
            ways.push_back({j, share[j], std::nullopt, {}});
        }
        for (const Turn turn : turns) {
            const double part = weight_of(turn) / weight_of(junction, j);
            ways.push_back({j, share[j] * part, std::nullopt,
                            turn == Turn::left ? gives_way_to(junction, j) : std::vector<std::size_t>()});
        }
    }
    return ways;
}

StreetPlan plan_of(const Scenario &scenario) {
    JunctionPlan plan{&scenario.junction, {}};
    for (std::size_t i = 0; i < scenario.junction.approach_count; ++i) {
        const Road &road = scenario.surroundings().roads[i];
        plan.arms.push_back({road.length_m, road.speed_m_per_s, ways_of(scenario.junction, i, scenario.share), true});
    }
    return {plan};
}

std::int64_t road_ds(const elmopp_junction_t &junction, const ArmPlan &arm) {
    return driving_ds(arm.length_m, arm.speed_m_per_s) - reach_ds(junction, arm);
}

std::int64_t reach_ds(const elmopp_junction_t &junction, const ArmPlan &arm) {
    return driving_ds(static_cast<double>(junction.reach_m), arm.speed_m_per_s);
}

} // namespace elmopp
