// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// What a camera says once a second, for each lane.

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace elmopp {

/// Why something is not to be believed. The numbers are the reasons of DetectorCounts.
enum class Reason { ok = 0, learning, black, white, frozen, blurred, covered, moved, lost };

const char *reason_name(Reason reason);

struct LaneRecord {
    std::string name;
    std::int64_t arrived_total = 0; ///< never decreases
    std::int64_t inflow = 0;        ///< since the last record
    std::optional<int> present;     ///< vehicles in the zone; none: the lane has no zone
    double occupancy = 0.0;         ///< share of the time since the last record in which a vehicle was on the line
    bool valid = false;
    Reason reason = Reason::lost;
    double confidence = 0.0; ///< 0 to 1
};

struct JunctionRecord {
    bool occupied = false;
    bool valid = false;
    Reason reason = Reason::lost;
};

struct Record {
    double t_s = 0.0;        ///< of the last frame
    std::int64_t frame = -1; ///< its number, from 0; -1: none yet
    std::vector<LaneRecord> lanes;
    std::optional<JunctionRecord> junction;
};

} // namespace elmopp
