// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// What a camera says on the bus: DetectorCounts of each approach and JunctionOccupied, as frames to send.
///
/// Lanes of one movement are summed; a movement is valid if all of its lanes are. A lane without a zone does not know
/// who is present, and so does its movement not. Lanes without an approach are not sent. It counts the frames' own
/// counters and does nothing else.

#pragma once

#include "lanes.hpp"
#include "record.hpp"

extern "C" {
#include "elmopp/link.h"
}

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace elmopp {

class CameraBus {
  public:
    explicit CameraBus(const LaneFile &file) : file_(file) {}

    /// The DetectorCounts of a second, sealed.
    std::vector<elmopp_frame_t> counts(const Record &record);

    /// JunctionOccupied, sealed; none without a junction in the record.
    std::optional<elmopp_frame_t> junction(const Record &record);

  private:
    LaneFile file_;
    std::map<int, std::uint8_t> counters_; ///< by approach
    std::uint8_t junction_counter_ = 0;
};

} // namespace elmopp
