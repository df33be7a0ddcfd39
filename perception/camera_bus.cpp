// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "camera_bus.hpp"

extern "C" {
#include "elmopp/frames.h"
}

#include <algorithm>
#include <array>

namespace elmopp {
namespace {

struct Sum {
    std::int64_t present = 0;
    std::int64_t arrived = 0;
    bool known = true;
    bool valid = true;
    bool used = false;
};

elmopp_detector_report_t report_of(const Sum &sum) {
    elmopp_detector_report_t report{};
    constexpr std::int64_t most = ELMOPP_DETECTOR_UNKNOWN - 1;
    const bool known = sum.used && sum.known;
    report.present_veh = static_cast<std::uint16_t>(known ? std::min(sum.present, most) : ELMOPP_DETECTOR_UNKNOWN);
    report.arrivals = static_cast<std::uint8_t>(sum.arrived % ELMOPP_DETECTOR_MODULO);
    report.valid = sum.used && sum.valid;
    return report;
}

} // namespace

std::vector<elmopp_frame_t> CameraBus::counts(const Record &record) {
    std::map<int, std::array<Sum, ELMOPP_APPROACH_MOVEMENT_MAX>> approaches;
    std::map<int, Reason> reasons;
    for (std::size_t i = 0; i < file_.lanes.size(); ++i) {
        const int approach = file_.lanes[i].approach.value_or(-1);
        const int movement = file_.lanes[i].movement.value_or(-1);
        if (approach < 0 || movement < 0) {
            continue;
        }
        const LaneRecord &lane = record.lanes[i];
        Sum &sum = approaches[approach][static_cast<std::size_t>(movement)];
        sum.used = true;
        sum.present += lane.present.value_or(0);
        sum.known = sum.known && lane.present.has_value();
        sum.arrived += lane.arrived_total;
        sum.valid = sum.valid && lane.valid;
        // The worst of the lanes: a fault of the camera before "learning".
        Reason &reason = reasons[approach];
        reason = std::max(reason, lane.reason);
    }
    std::vector<elmopp_frame_t> frames;
    for (const auto &[approach, sums] : approaches) {
        std::array<elmopp_detector_report_t, ELMOPP_APPROACH_MOVEMENT_MAX> reports{};
        std::transform(sums.begin(), sums.end(), reports.begin(), report_of);
        elmopp_frame_t frame = elmopp_frames_make_counts(static_cast<std::uint32_t>(approach), reports.data(),
                                                         static_cast<std::uint8_t>(reasons[approach]));
        elmopp_link_seal(&frame, &counters_[approach]);
        frames.push_back(frame);
    }
    return frames;
}

std::optional<elmopp_frame_t> CameraBus::junction(const Record &record) {
    if (!record.junction) {
        return std::nullopt;
    }
    const elmopp_occupancy_t occupancy{record.junction->occupied, record.junction->valid,
                                       static_cast<std::uint8_t>(record.junction->reason)};
    elmopp_frame_t frame = elmopp_frames_make_occupancy(&occupancy);
    elmopp_link_seal(&frame, &junction_counter_);
    return frame;
}

} // namespace elmopp
