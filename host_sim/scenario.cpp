// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "scenario.hpp"

#include "comings.hpp"
#include "csv.hpp"
#include "error.hpp"
#include "sites.hpp"
#include "stats.hpp"
#include "street_plan.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

namespace elmopp {
namespace {

constexpr float paper_free_flow_m_per_s = 10.0F;
constexpr double km_per_h = 1.0 / 3.6;
constexpr double usual_road_m = 200.0; ///< of an arm before the counted reach
constexpr double shortest_road_m = 15.0;
constexpr double longest_arm_m = 10000.0;
constexpr double lowest_speed_km_per_h = ELMOPP_SITE_LIMIT_MIN_KM_PER_H;
constexpr double highest_speed_km_per_h = ELMOPP_SITE_LIMIT_MAX_KM_PER_H;

/// The junctions that profile discrete knows by name.
const std::map<std::string, const elmopp_junction_t *> &named_sites() {
    static const std::map<std::string, const elmopp_junction_t *> sites{
        {"five_way", &elmopp_site_five_way},         {"four_way", &elmopp_site_four_way},
        {"left_lanes", &elmopp_site_left_lanes},     {"one_way", &elmopp_site_one_way},
        {"shared_lanes", &elmopp_site_shared_lanes}, {"three_way", &elmopp_site_three_way}};
    return sites;
}

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
    const double whole = sum(split);
    std::vector<double> share(junction.movement_count);
    for (std::size_t i = 0; i < junction.approach_count; ++i) {
        const auto lanes = movements_of(junction, i);
        if (!split.empty() && split.size() != lanes.size()) {
            throw BadRequest("--split has " + std::to_string(split.size()) + " shares, approach " +
                             junction.approach_name[i] + " has " + std::to_string(lanes.size()) +
                             " movements; right would be one share each");
        }
        for (std::size_t k = 0; k < lanes.size(); ++k) {
            share[lanes[k]] = split.empty() ? 1.0 / static_cast<double>(lanes.size()) : split[k] / whole;
        }
    }
    return share;
}

/// The limit on an approach: its movements agree.
double limit_km_per_h(const elmopp_junction_t &junction, std::size_t approach) {
    const auto movements = movements_of(junction, approach);
    const std::size_t movement = movements.empty() ? 0 : movements.front();
    return elmopp_junction_limit_km_per_h(&junction, static_cast<std::uint32_t>(movement));
}

/// A place for single vehicles: a street's junction, with the usual surroundings.
Scenario make_discrete(const Profile &profile, const elmopp_junction_t &site, const std::vector<double> &split) {
    Scenario scenario{profile, true, site, {}, {}};
    elmopp_junction_t &junction = scenario.junction;
    junction.discharge = ELMOPP_DISCHARGE_SATURATION;
    for (std::size_t j = 0; j < junction.movement_count; ++j) {
        scenario.capacity_veh.push_back(static_cast<double>(junction.movement[j].capacity_veh));
    }
    scenario.share = split.empty() ? usual_shares(junction) : shares(junction, split);
    scenario.street = Surroundings{"alternating", {}};
    for (std::size_t i = 0; i < junction.approach_count; ++i) {
        scenario.street->roads.push_back(
            {static_cast<double>(junction.reach_m) + usual_road_m, limit_km_per_h(junction, i) * km_per_h});
    }
    return scenario;
}

using Options = std::map<std::string, std::string>;

/// Throws BadRequest for a number that is not between bounds.
void check_between(const std::string &what, double value, double lowest, double highest) {
    if (!(value >= lowest && value <= highest)) {
        throw BadRequest(what + " is " + format_number(value, 9) + "; right would be " + format_number(lowest, 6) +
                         " to " + format_number(highest, 6));
    }
}

std::optional<double> option_of(const Options &options, const std::string &name) {
    const auto found = options.find(name);
    if (found == options.end()) {
        return std::nullopt;
    }
    double value = 0.0;
    if (!parse_number(found->second, value)) {
        throw BadRequest("option " + name + " of profile discrete is \"" + found->second +
                         "\"; right would be a number");
    }
    return value;
}

const elmopp_junction_t *named_site(const std::string &name) {
    const auto found = named_sites().find(name);
    if (found == named_sites().end()) {
        throw BadRequest("option site of profile discrete is \"" + name + "\"; right would be one of " +
                         join(site_names(), ", "));
    }
    return found->second;
}

/// NAME@OPTION=VALUE...: the options.
Options options_of(const std::vector<std::string> &words) {
    Options options;
    for (std::size_t i = 1; i < words.size(); ++i) {
        const auto equals = words[i].find('=');
        const std::string name = words[i].substr(0, equals);
        if (name != "site" && name != "demand" && name != "speed" && name != "length") {
            throw BadRequest("unknown option \"" + name +
                             "\" of profile discrete; right would be one of site, demand, speed, length");
        }
        if (!options.emplace(name, equals == std::string::npos ? "" : words[i].substr(equals + 1)).second) {
            throw BadRequest("option \"" + name + "\" is given twice in profile \"" + join(words, "@") +
                             "\"; right would be once");
        }
    }
    return options;
}

void apply(const Options &options, Scenario &scenario) {
    Surroundings street = scenario.surroundings();
    if (const auto found = options.find("demand"); found != options.end()) {
        (void)rates(found->second, Series(1, std::vector<double>(1)), 1, 0.0, 0, 0); // refuses what is unknown
        street.demand = found->second;
    }
    scenario.street = street;
    for (std::size_t i = 0; i < scenario.junction.approach_count; ++i) {
        scenario.pave(i, option_of(options, "speed"), option_of(options, "length"), "profile discrete, option ");
    }
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
        {"discrete", "single vehicles, finite lanes, counts within a reach; light and heavy by turns", Integrator::rk4,
         Scope::per_inroad, ELMOPP_DISCHARGE_SATURATION, 0.0, std::nullopt, false, true},
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

const Surroundings &Scenario::surroundings() const {
    if (!street) {
        throw std::logic_error("a fluid has no street");
    }
    return *street;
}

void Scenario::pave(std::size_t approach, std::optional<double> speed_km_per_h, std::optional<double> length_m,
                    const std::string &where) {
    Surroundings paved = surroundings();
    Road &road = paved.roads.at(approach);
    if (speed_km_per_h) {
        check_between(where + "speed", *speed_km_per_h, lowest_speed_km_per_h, highest_speed_km_per_h);
        road.speed_m_per_s = *speed_km_per_h * km_per_h;
    }
    if (length_m) {
        check_between(where + "length", *length_m, static_cast<double>(junction.reach_m) + shortest_road_m,
                      longest_arm_m);
        road.length_m = *length_m;
    }
    street = paved;
}

Setting Scenario::setting() const {
    Setting setting{junction, own_site, profile.literal};
    setting.stops_free = true;
    if (street) {
        for (std::size_t j = 0; j < junction.movement_count; ++j) {
            const Road &road = street->roads[junction.movement[j].approach];
            setting.travel_s.at(j) =
                static_cast<unsigned>(std::lround(static_cast<double>(junction.reach_m) / road.speed_m_per_s));
        }
    }
    setting.downstream_veh = downstream_veh;
    return setting;
}

Scenario make_scenario(const Profile &profile, const elmopp_junction_t *site, const std::vector<double> &split) {
    if (profile.discrete) {
        return make_discrete(profile, site == nullptr ? elmopp_site_four_way : *site, split);
    }
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

std::vector<std::string> site_names() {
    std::vector<std::string> names;
    for (const auto &[name, site] : named_sites()) {
        names.push_back(name);
    }
    return names;
}

Scenario make_scenario(const std::string &profile, const elmopp_junction_t *site, const std::vector<double> &split) {
    const auto words = elmopp::split(profile, '@');
    const Profile &kind = find_profile(words.front());
    if (!kind.discrete) {
        if (words.size() > 1) {
            throw BadRequest("profile " + profile + ": only discrete has options; right would be " + kind.name);
        }
        return make_scenario(kind, site, split);
    }
    const Options options = options_of(words);
    const auto name = options.find("site");
    if (name != options.end() && site != nullptr) {
        throw BadRequest("profile " + profile + " with --site: two sites; right would be one of them");
    }
    Scenario scenario = make_scenario(kind, name == options.end() ? site : named_site(name->second), split);
    scenario.profile.name = profile;
    apply(options, scenario);
    return scenario;
}

} // namespace elmopp
