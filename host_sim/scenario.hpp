// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Scenario: which junction stands under which profile of inflow and discharge.
///
/// The profile sets inflow and discharge, the site the junction (docs/algorithm.md, section Profiles). Profile
/// `discrete` moves single vehicles and has options of its own, part of its name as a chooser's are:
///
///     discrete[@site=NAME][@demand=PATTERN][@speed=KM_PER_H][@length=M]
///
/// Without speed, the limits are the site's, 50 km/h where it does not say.

#pragma once

#include "core.hpp"
#include "inflow.hpp"
#include "setting.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace elmopp {

struct Profile {
    std::string name;
    std::string what; ///< one line for --help and list
    Integrator integrator;
    Scope scope;
    int discharge;                                       ///< ELMOPP_DISCHARGE_*
    double initial_load;                                 ///< of every movement at second 0
    std::optional<std::pair<unsigned, unsigned>> hold_s; ///< replaces the site's window
    bool literal;                                        ///< Algorithm 1 as printed, for the choosers of the paper
    bool discrete = false;                               ///< single vehicles, not a fluid
};

/// One arm of a junction.
struct Road {
    double length_m;      ///< to the stop line; the last reach_m of it are counted
    double speed_m_per_s; ///< the limit
};

/// What the profile `discrete` knows beyond its site.
struct Surroundings {
    std::string demand = "alternating"; ///< pattern of comings.hpp
    std::vector<Road> roads;            ///< [approach]
};

/// All profiles, in the order of the documentation.
const std::vector<Profile> &profiles();

/// Those that profile discrete and networks know by name.
std::vector<std::string> site_names();

/// Throws BadRequest naming the value and the profiles there are. The name only, without options.
const Profile &find_profile(const std::string &name);

struct Scenario {
    Profile profile;
    bool own_site;                                     ///< a site file's junction, not the paper's
    elmopp_junction_t junction;                        ///< the site with the profile's discharge and window
    std::vector<double> capacity_veh;                  ///< [movement], in double
    std::vector<double> share;                         ///< [movement] of its approach's inflow
    std::optional<Surroundings> street = std::nullopt; ///< profile discrete only
    /// What a chooser may know of the roads behind, Setting::downstream_veh; null: nothing.
    const float *downstream_veh = nullptr;

    [[nodiscard]] std::vector<std::string> approach_names() const;
    /// What a chooser is told. The fluid reaches the queue as soon as it is counted, a vehicle after its drive through
    /// the reach. Valid as long as the scenario.
    [[nodiscard]] Setting setting() const;
    /// How one arm of profile discrete differs from the others: kilometres per hour and metres, no value: it does not.
    /// Throws BadRequest naming the value, with `where` before it.
    void pave(std::size_t approach, std::optional<double> speed_km_per_h, std::optional<double> length_m,
              const std::string &where);
    /// `street` of a scenario that has one. Throws std::logic_error if it has none: a caller's mistake.
    [[nodiscard]] const Surroundings &surroundings() const;
};

/// `site` null: the paper's own. `split`: shares of an approach's movements in site order, empty for equal ones.
Scenario make_scenario(const Profile &profile, const elmopp_junction_t *site, const std::vector<double> &split = {});

/// The same by the text of a request, options of the profile included. With `site` the option site is refused. Throws
/// BadRequest naming the option, the value and what would be right.
Scenario make_scenario(const std::string &profile, const elmopp_junction_t *site,
                       const std::vector<double> &split = {});

} // namespace elmopp
