// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// A record and a crossing as lines of JSON.

#pragma once

#include "lanes.hpp"
#include "record.hpp"
#include "section.hpp"

#include <cstdint>
#include <string>

namespace elmopp {

/// Keys in the order in which they are documented (docs/camera.md). Without a line end.
std::string record_line(const Record &record, double latency_ms, std::uint64_t dropped);

std::string crossing_line(const Crossing &crossing, const LaneFile &file);

} // namespace elmopp
