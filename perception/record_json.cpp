// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "record_json.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace elmopp {
namespace {

using Line = nlohmann::ordered_json;

/// As many decimals as mean something.
double rounded(double value) {
    constexpr double thousand = 1000.0;
    return std::round(value * thousand) / thousand;
}

Line lane_line(const LaneRecord &lane) {
    Line line;
    line["arrived_total"] = lane.arrived_total;
    line["inflow"] = lane.inflow;
    line["present"] = lane.present ? Line(*lane.present) : Line(nullptr);
    line["occupancy"] = rounded(lane.occupancy);
    line["valid"] = lane.valid;
    line["reason"] = reason_name(lane.reason);
    line["confidence"] = rounded(lane.confidence);
    return line;
}

} // namespace

std::string record_line(const Record &record, double latency_ms, std::uint64_t dropped) {
    Line line;
    line["t_s"] = rounded(record.t_s);
    line["frame"] = record.frame;
    line["lanes"] = Line::object();
    for (const LaneRecord &lane : record.lanes) {
        line["lanes"][lane.name] = lane_line(lane);
    }
    if (record.junction) {
        line["junction"] = {{"occupied", record.junction->occupied},
                            {"valid", record.junction->valid},
                            {"reason", reason_name(record.junction->reason)}};
    }
    line["latency_ms"] = rounded(latency_ms);
    line["dropped"] = dropped;
    return line.dump();
}

std::string crossing_line(const Crossing &crossing, const LaneFile &file) {
    Line line;
    line["frame"] = crossing.frame;
    line["lane"] = file.lanes[static_cast<std::size_t>(crossing.lane)].name;
    return line.dump();
}

} // namespace elmopp
