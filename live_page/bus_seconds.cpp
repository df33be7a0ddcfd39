// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "bus_seconds.hpp"

#include "decision_log.hpp"

#include <nlohmann/json.hpp>

namespace elmopp {

void BusSeconds::hear(const elmopp_frame_t &frame, std::uint32_t now_ms) {
    view_.hear(frame, now_ms);
}

/// What a running counter has grown by since the last look; nothing at the first.
float BusSeconds::arrivals(std::size_t movement, std::uint8_t total) {
    const std::uint8_t before = total_.at(movement).value_or(total);
    total_.at(movement) = total;
    return static_cast<float>((total + ELMOPP_DETECTOR_MODULO - before) % ELMOPP_DETECTOR_MODULO);
}

BusSeconds::Counted BusSeconds::count(const JunctionView::Seen &seen) {
    Counted counted;
    std::array<std::size_t, ELMOPP_APPROACH_MAX> slot{};
    for (std::uint32_t j = 0; j < junction_.movement_count; ++j) {
        const std::uint8_t approach = junction_.movement[j].approach;
        const std::size_t place = slot.at(approach)++;
        const auto &counts = seen.counts.at(approach);
        if (counts && counts->report.at(place).valid) {
            const elmopp_detector_report_t &report = counts->report.at(place);
            const bool known = report.present_veh != ELMOPP_DETECTOR_UNKNOWN;
            counted.present_veh.at(j) = known ? static_cast<float>(report.present_veh) : 0.0F;
            counted.arrived_veh.at(j) = arrivals(j, report.arrivals);
        } else {
            counted.uncounted += (counted.uncounted.empty() ? "" : ",") + std::to_string(j);
        }
    }
    return counted;
}

std::string BusSeconds::line(std::uint32_t now_ms) {
    const JunctionView::Seen seen = view_.seen(now_ms);
    const Counted counted = count(seen);
    const std::array<float, ELMOPP_STAGE_MAX> no_score{};
    std::array<float, ELMOPP_APPROACH_MAX> foreseen_veh{};
    std::string model;
    for (std::size_t i = 0; i < junction_.approach_count; ++i) {
        const auto &forecast = seen.forecast.at(i);
        foreseen_veh.at(i) = forecast ? static_cast<float>(forecast->next_veh.back()) : 0.0F;
        model = forecast ? JunctionView::model_word(forecast->model) : model;
    }
    const bool shown = seen.status && seen.status->stage < junction_.stage_count;
    const auto stage = static_cast<elmopp_stage_t>(shown ? seen.status->stage : ELMOPP_STAGE_NONE);
    std::string text = decision_line({t_s_++, stage, seen.lamps.value_or(elmopp_lamps_t{}), &junction_,
                                      counted.present_veh.data(), counted.arrived_veh.data(), no_score.data(),
                                      foreseen_veh.data(), seen.status ? seen.status->fault : ELMOPP_FAULT_NONE});
    if (seen.status) {
        text += ",\"mode\":" + std::to_string(static_cast<unsigned>(seen.status->mode)) +
                ",\"fault_group\":" + std::to_string(seen.status->fault_group);
    }
    text += model.empty() ? "" : ",\"model\":\"" + model + "\"";
    nlohmann::json differs = nlohmann::json::object();
    for (std::size_t g = 0; g < junction_.group_count; ++g) {
        if (!seen.differs.at(g).empty()) {
            differs[std::to_string(g)] = seen.differs.at(g);
        }
    }
    return text + ",\"differs\":" + differs.dump() + ",\"uncounted\":[" + counted.uncounted + "]}";
}

} // namespace elmopp
