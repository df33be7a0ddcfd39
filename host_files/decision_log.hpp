// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The decision log: what a controller saw, thought and did in one second, as a line of JSON. The same bytes wherever
/// the controller ran.

#pragma once

#include "core.hpp"

#include <cstddef>
#include <string>

namespace elmopp {

struct Decision {
    std::size_t t_s;
    elmopp_stage_t stage; ///< shown at the end of the second
    elmopp_lamps_t lamps;
    const elmopp_junction_t *junction;
    const float *present_veh;  ///< [movement] as the core saw them
    const float *arrived_veh;  ///< [movement]
    const float *score;        ///< [stage] the chooser's; 0 where it has none
    const float *foreseen_veh; ///< [approach] in the next 60 s
    elmopp_fault_t fault;
};

/// The line without its closing brace: further keys may follow.
std::string decision_line(const Decision &decision);

/// A number of such a line.
std::string log_number(double value);

/// [v,v,...] with nine digits each, so that every float comes back as it was.
template <typename Values> std::string list_of(const Values &values, std::size_t count) {
    std::string text = "[";
    for (std::size_t i = 0; i < count; ++i) {
        text += (i == 0 ? "" : ",") + log_number(static_cast<double>(values[i]));
    }
    return text + "]";
}

} // namespace elmopp
