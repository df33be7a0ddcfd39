// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Street plan: junctions and the arms that lead to them, as data for Streets.
///
/// Says how long an arm is, how fast one drives there, which ways lead on from it and to which other arm. One junction
/// whose arms all come from outside is a plan too. It holds no vehicle and decides nothing.

#pragma once

#include "scenario.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace elmopp {

/// One arm: approach `approach` of junction `junction`.
struct ArmId {
    std::size_t junction;
    std::size_t approach;
};

/// One way on from an arm: on the lanes of a movement, to the next arm.
struct Way {
    std::size_t movement;
    double share;                       ///< of the vehicles of its arm
    std::optional<ArmId> to;            ///< none: it leaves the plan
    std::vector<std::size_t> gives_way; ///< movements of the same junction that go first
};

struct ArmPlan {
    double length_m;       ///< from where the road begins to the stop line
    double speed_m_per_s;  ///< the limit
    std::vector<Way> ways; ///< in site order
    bool from_outside;     ///< vehicles begin here, not at another junction of the plan
};

struct JunctionPlan {
    const elmopp_junction_t *site; ///< must outlive the plan
    std::vector<ArmPlan> arms;     ///< [approach]
};

using StreetPlan = std::vector<JunctionPlan>;

/// Shares of an approach's movements where nobody says: a fifth turns left, a fifth right, three fifths go straight on
/// (those of a turn that there is no lane for go with the others in proportion); by lanes where names do not say.
std::vector<double> usual_shares(const elmopp_junction_t &junction);

/// The ways of an approach, each leading outside; a movement of several turns has one for each. `share`: [movement].
std::vector<Way> ways_of(const elmopp_junction_t &junction, std::size_t approach, const std::vector<double> &share);

/// The plan of a scenario of its own: every arm comes from outside. Valid as long as the scenario.
StreetPlan plan_of(const Scenario &scenario);

/// From the beginning of an arm to the edge of the counted reach, and from there to the stop line, at the limit.
std::int64_t road_ds(const elmopp_junction_t &junction, const ArmPlan &arm);
std::int64_t reach_ds(const elmopp_junction_t &junction, const ArmPlan &arm);

} // namespace elmopp
