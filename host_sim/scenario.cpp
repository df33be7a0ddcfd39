// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "scenario.hpp"

#include "csv.hpp"
#include "error.hpp"
#include "sites.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace elmopp {
namespace {

constexpr float paper_free_flow_m_per_s = 10.0F;

/// Movements of one approach, in site order.
std::vector<std::size_t> movements_of(const elmopp_junction_t &junction, std::size_t approach) {
    std::vector<std::size_t> found;
    for (std::size_t j = 0; j < junction.movement_count; ++j) {
        if (junction.movement[j].approach == approach) {
            found.push_back(j);
        }
    }
    return found;
}

std::vector<double> shares(const elmopp_junction_t &junction, const std::vector<double> &split) {
    const double sum = std::accumulate(split.begin(), split.end(), 0.0);
    std::vector<double> share(junction.movement_count);
    for (std::size_t i = 0; i < junction.approach_count; ++i) {
        const auto lanes = movements_of(junction, i);
        if (!split.empty() && split.size() != lanes.size()) {
            throw BadRequest("--split has " + std::to_string(split.size()) + " shares, approach " +
                             junction.approach_name[i] + " has " + std::to_string(lanes.size()) +
                             " movements; right would be one share each");
        }
        for (std::size_t k = 0; k < lanes.size(); ++k) {
            share[lanes[k]] = split.empty() ? 1.0 / static_cast<double>(lanes.size()) : split[k] / sum;
        }
    }
    return share;
}

} // namespace

const std::vector<Profile> &profiles() {
    static const std::vector<Profile> all{
        {"paper", "the reproduction: Greenshields discharge, RK4, a fifth full at the start", Integrator::rk4,
         Scope::per_inroad, ELMOPP_DISCHARGE_GREENSHIELDS, 0.2, std::nullopt, false},
        {"saturation", "queues leave at 0.5 vehicle/s a lane and start empty: the realistic regime", Integrator::rk4,
         Scope::per_inroad, ELMOPP_DISCHARGE_SATURATION, 0.0, std::nullopt, false},
        {"figure", "N over all approaches, window 5 to 20 s: the reading that fits the printed curve", Integrator::rk4,
         Scope::total, ELMOPP_DISCHARGE_GREENSHIELDS, 0.2, std::make_pair(5U, 20U), false},
        {"literal", "Algorithm 1 and Euler as printed, for the record", Integrator::euler, Scope::per_inroad,
         ELMOPP_DISCHARGE_GREENSHIELDS, 0.2, std::nullopt, true},
    };
    return all;
}

const Profile &find_profile(const std::string &name) {
    std::vector<std::string> names;
    for (const auto &profile : profiles()) {
        if (profile.name == name) {
            return profile;
        }
        names.push_back(profile.name);
    }
    throw BadRequest("unknown profile \"" + name + "\"; right would be one of " + join(names, ", "));
}

std::vector<std::string> Scenario::approach_names() const {
    return {&junction.approach_name[0], &junction.approach_name[junction.approach_count]};
}

Setting Scenario::setting() const {
    return {junction, own_site, profile.literal};
}

Scenario make_scenario(const Profile &profile, const elmopp_junction_t *site, const std::vector<double> &split) {
    const bool paper = site == nullptr;
    Scenario scenario{profile, !paper, paper ? elmopp_site_paper : *site, {}, {}};
    elmopp_junction_t &junction = scenario.junction;
    junction.discharge = static_cast<std::uint8_t>(profile.discharge);
    if (profile.discharge != ELMOPP_DISCHARGE_SATURATION) {
        junction.simulation_only = 1; // no street discharges like that
    }
    junction.free_flow_m_per_s = paper_free_flow_m_per_s;
    if (profile.hold_s) {
        junction.hold_min_s = static_cast<std::uint16_t>(profile.hold_s->first);
        junction.hold_max_s = static_cast<std::uint16_t>(profile.hold_s->second);
    }
    for (std::size_t j = 0; j < junction.movement_count; ++j) {
        // The paper's 1000/3 is no float; the world keeps the exact value.
        scenario.capacity_veh.push_back(paper ? 1000.0 / 3.0 : static_cast<double>(junction.movement[j].capacity_veh));
    }
    scenario.share = shares(junction, split);
    return scenario;
}

} // namespace elmopp
