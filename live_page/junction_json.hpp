// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// A junction as the page is told of it: names and what belongs together, the words for modes and faults.

#pragma once

extern "C" {
#include "elmopp/junction.h"
}

#include <nlohmann/json.hpp>

namespace elmopp {

/// {name, reach_m, approaches[name], movements[{name, approach, groups[], lanes, capacity_veh}], groups[{name,
/// conflicts[]}], stages[{groups[], movements[]}], modes[], faults{code: name}, foreseen_s}; numbers are indices.
nlohmann::ordered_json junction_json(const elmopp_junction_t &junction);

} // namespace elmopp
