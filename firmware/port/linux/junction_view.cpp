// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "junction_view.hpp"

#include "bus_log.hpp"

extern "C" {
#include "elmopp_can.h"
}

#include <algorithm>
#include <cstdio>
#include <iterator>

namespace elmopp {
namespace {

constexpr double tenth = 0.1;
constexpr unsigned burns = 7; ///< the bits of LampFeedback
constexpr unsigned flashes = 8;

const std::array<const char *, ELMOPP_ASPECT_COUNT + 1> aspect_words{
    "dark", "red", "red-amber", "GREEN", "amber", "flashing amber", "flashing red", "no aspect"};

const std::array<const char *, 13> reason_words{"ok",           "learning", "black", "white", "frozen",
                                                "blurred",      "covered",  "moved", "lost",  "no activity",
                                                "max presence", "erratic",  "stale"};

const std::array<const char *, 16> model_words{"none",
                                               "mean",
                                               "persistence",
                                               "ewma",
                                               "ar8",
                                               "lstm",
                                               "nlstm",
                                               "ann",
                                               "gcn",
                                               "lstm-q15",
                                               "nlstm-q15",
                                               "learnt",
                                               "given",
                                               "mean (cold)",
                                               "mean (no weights)",
                                               "mean (distrusted)"};

template <typename Words> std::string word_of(const Words &words, unsigned number) {
    return number < words.size() ? words.at(number) : "?";
}

std::string padded(std::string text, std::size_t width) {
    text.resize(std::max(text.size() + 1, width), ' ');
    return text;
}

bool is_of_approach(const elmopp_frame_t &frame) {
    constexpr std::array<unsigned, 3> firsts{ELMOPP_CAN_DETECTOR_COUNTS_FRAME_ID, ELMOPP_CAN_FORECAST_FRAME_ID,
                                             ELMOPP_CAN_NEIGHBOUR_OUTFLOW_FRAME_ID};
    return std::any_of(firsts.begin(), firsts.end(),
                       [&frame](unsigned first) { return frame.id - first < ELMOPP_APPROACH_MAX; });
}

std::string fixed(double value) {
    std::array<char, 32> text{};
    (void)std::snprintf(text.data(), text.size(), "%.1f", value);
    return text.data();
}

} // namespace

void JunctionView::hear(const elmopp_frame_t &frame, std::uint32_t now_ms) {
    const unsigned node = frame.id - ELMOPP_CAN_LAMP_FEEDBACK_FRAME_ID;
    const bool command = frame.id == ELMOPP_CAN_LAMP_COMMAND_FRAME_ID;
    const bool status = frame.id == ELMOPP_CAN_CONTROLLER_STATUS_FRAME_ID;
    const bool junction = frame.id == ELMOPP_CAN_JUNCTION_OCCUPIED_FRAME_ID;
    if (!command && !status && !junction && node >= ELMOPP_NODE_MAX && !is_of_approach(frame)) {
        return;
    }
    elmopp_lamps_t lamps{};
    if (!elmopp_link_is_whole(&frame) || (command && !elmopp_frames_lamps(&frame, &lamps))) {
        ++spoilt_;
    } else if (command) {
        lamps_.set(lamps, now_ms);
    } else if (status) {
        hear_status(frame, now_ms);
    } else if (junction) {
        occupancy_.set(elmopp_frames_occupancy(&frame), now_ms);
    } else if (node < ELMOPP_NODE_MAX) {
        hear_feedback(elmopp_frames_feedback(&frame), node, now_ms);
    } else {
        hear_approach(frame, now_ms);
    }
}

void JunctionView::hear_approach(const elmopp_frame_t &frame, std::uint32_t now_ms) {
    const unsigned camera = frame.id - ELMOPP_CAN_DETECTOR_COUNTS_FRAME_ID;
    const unsigned neighbour = frame.id - ELMOPP_CAN_NEIGHBOUR_OUTFLOW_FRAME_ID;
    if (camera < ELMOPP_APPROACH_MAX) {
        Counts counts{};
        counts.reason = elmopp_frames_counts(&frame, counts.report.data());
        counts_.at(camera).set(counts, now_ms);
    } else if (neighbour < ELMOPP_APPROACH_MAX) {
        outflow_.at(neighbour).set(elmopp_frames_outflow(&frame), now_ms);
    } else {
        hear_forecast(frame, frame.id - ELMOPP_CAN_FORECAST_FRAME_ID, now_ms);
    }
}

/// Held against the command of this moment. What flashes is lit or dark just now.
void JunctionView::hear_feedback(const elmopp_feedback_t &feedback, unsigned node, std::uint32_t now_ms) {
    std::uint16_t off = 0;
    for (std::uint32_t g = 0; g < junction_.group_count; ++g) {
        const unsigned told = elmopp_lamps_bits(&lamps_.value, g);
        const unsigned shown = elmopp_lamps_bits(&feedback.lamps, g) & burns;
        const bool as_told = (told & flashes) != 0 ? (shown & ~told) == 0 : shown == (told & burns);
        off = static_cast<std::uint16_t>(off | (as_told ? 0U : 1U << g));
    }
    nodes_.at(node).set({feedback, off, nodes_.at(node).value.off}, now_ms);
}

/// Twice in a row: a report may have crossed its command on the bus.
std::string JunctionView::differs(std::uint32_t group, std::uint32_t now_ms) const {
    const auto &node = nodes_.at(junction_.group[group].node);
    if (!node.is_fresh(now_ms, ELMOPP_CAN_LAMP_FEEDBACK_CYCLE_TIME_MS)) {
        return "node silent";
    }
    if (node.value.feedback.own_fail_safe) {
        return "node flashes by itself";
    }
    const bool off = elmopp_mask_has(static_cast<std::uint16_t>(node.value.off & node.value.off_before), group);
    return off ? "shows " + word_of(aspect_words, elmopp_lamps_aspect(&node.value.feedback.lamps, group)) : "";
}

void JunctionView::hear_status(const elmopp_frame_t &frame, std::uint32_t now_ms) {
    elmopp_can_controller_status_t status{};
    (void)elmopp_can_controller_status_unpack(&status, std::begin(frame.data), ELMOPP_LINK_BYTES);
    status_.set({static_cast<elmopp_mode_t>(status.mode), status.stage, status.elapsed_ds,
                 static_cast<elmopp_fault_t>(status.first_fault), status.fault_group, status.refused},
                now_ms);
}

void JunctionView::hear_forecast(const elmopp_frame_t &frame, unsigned approach, std::uint32_t now_ms) {
    elmopp_can_forecast_t forecast{};
    (void)elmopp_can_forecast_unpack(&forecast, std::begin(frame.data), ELMOPP_LINK_BYTES);
    forecast_.at(approach).set(
        {forecast.model, {forecast.next10 * tenth, forecast.next30 * tenth, forecast.next60 * tenth}}, now_ms);
}

const char *JunctionView::model_word(unsigned model) {
    return model < model_words.size() ? model_words.at(model) : "?";
}

JunctionView::Seen JunctionView::seen(std::uint32_t now_ms) const {
    Seen seen;
    seen.status = status_.if_fresh(now_ms, ELMOPP_CAN_CONTROLLER_STATUS_CYCLE_TIME_MS);
    seen.lamps = lamps_.if_fresh(now_ms, ELMOPP_CAN_LAMP_COMMAND_CYCLE_TIME_MS);
    for (std::size_t i = 0; i < counts_.size(); ++i) {
        seen.counts.at(i) = counts_.at(i).if_fresh(now_ms, ELMOPP_CAN_DETECTOR_COUNTS_CYCLE_TIME_MS);
        seen.forecast.at(i) = forecast_.at(i).if_fresh(now_ms, ELMOPP_CAN_FORECAST_CYCLE_TIME_MS);
    }
    for (std::uint32_t g = 0; g < junction_.group_count; ++g) {
        seen.differs.at(g) = differs(g, now_ms);
    }
    return seen;
}

std::string JunctionView::status_line(std::uint32_t now_ms) const {
    if (!status_.is_fresh(now_ms, ELMOPP_CAN_CONTROLLER_STATUS_CYCLE_TIME_MS)) {
        return "controller  silent";
    }
    const Status &status = status_.value;
    std::string text = std::string("controller  ") + mode_name(status.mode);
    if (status.stage < junction_.stage_count) {
        text += ", stage " + std::to_string(status.stage) + " for " + fixed(status.elapsed_ds * tenth) + " s";
    } else if (elmopp_mode_is_steady(status.mode)) {
        text += ", between stages";
    }
    if (status.fault != ELMOPP_FAULT_NONE) {
        text += std::string(", FAULT ") + elmopp_fault_name(status.fault);
        text += status.fault_group < junction_.group_count
                    ? std::string(" at ") + junction_.group[status.fault_group].name
                    : "";
    }
    return text + ", refused " + std::to_string(status.refused);
}

std::string JunctionView::lamps_line(std::uint32_t now_ms) const {
    std::string text = "lamps      ";
    if (!lamps_.is_fresh(now_ms, ELMOPP_CAN_LAMP_COMMAND_CYCLE_TIME_MS)) {
        return text + " nobody commands";
    }
    for (std::uint32_t g = 0; g < junction_.group_count; ++g) {
        text += std::string(" ") + junction_.group[g].name + " " +
                word_of(aspect_words, elmopp_lamps_aspect(&lamps_.value, g));
        const std::string otherwise = differs(g, now_ms);
        text += otherwise.empty() ? "" : " (" + otherwise + ")";
        text += g + 1U < junction_.group_count ? "," : "";
    }
    return text;
}

std::string JunctionView::junction_line(std::uint32_t now_ms) const {
    const std::string text = "junction    ";
    if (!occupancy_.is_fresh(now_ms, ELMOPP_CAN_JUNCTION_OCCUPIED_CYCLE_TIME_MS)) {
        return text + "camera silent";
    }
    if (!occupancy_.value.valid) {
        return text + "camera " + word_of(reason_words, occupancy_.value.reason);
    }
    return text + (occupancy_.value.occupied ? "occupied" : "clear");
}

std::string JunctionView::counts_of(std::uint32_t approach, std::uint32_t now_ms) const {
    if (!elmopp_mask_has(junction_.cameras, approach)) {
        return "no camera";
    }
    const auto &heard = counts_.at(approach);
    if (!heard.is_fresh(now_ms, ELMOPP_CAN_DETECTOR_COUNTS_CYCLE_TIME_MS)) {
        return "camera silent";
    }
    std::string text = heard.value.reason == 0 ? "" : "camera " + word_of(reason_words, heard.value.reason) + " ";
    std::size_t slot = 0;
    for (std::uint32_t j = 0; j < junction_.movement_count; ++j) {
        if (junction_.movement[j].approach == approach) {
            const elmopp_detector_report_t &report = heard.value.report.at(slot++);
            const bool known = report.valid && report.present_veh != ELMOPP_DETECTOR_UNKNOWN;
            text += (text.empty() ? "" : " ") + std::string(junction_.movement[j].name) + " " +
                    (known ? std::to_string(report.present_veh) : "?");
        }
    }
    return text;
}

std::string JunctionView::forecast_of(std::uint32_t approach, std::uint32_t now_ms) const {
    const auto &heard = forecast_.at(approach);
    if (!heard.is_fresh(now_ms, ELMOPP_CAN_FORECAST_CYCLE_TIME_MS)) {
        return "no forecast";
    }
    const auto &next = heard.value.next_veh;
    return std::string(model_word(heard.value.model)) + " " + fixed(next[0]) + " " + fixed(next[1]) + " " +
           fixed(next[2]);
}

/// Nothing of one that has never spoken: most approaches have no neighbour.
std::string JunctionView::neighbour_of(std::uint32_t approach, std::uint32_t now_ms) const {
    const auto &heard = outflow_.at(approach);
    if (!heard.at_ms) {
        return "";
    }
    if (!heard.is_fresh(now_ms, ELMOPP_CAN_NEIGHBOUR_OUTFLOW_CYCLE_TIME_MS)) {
        return ", neighbour silent";
    }
    const elmopp_outflow_t &outflow = heard.value;
    return ", neighbour " + fixed(outflow.next10_veh) + " " + fixed(outflow.next30_veh) + " " +
           fixed(outflow.next60_veh) + " of " + std::to_string(outflow.ahead_s) + " s";
}

std::string JunctionView::approach_line(std::uint32_t approach, std::uint32_t now_ms) const {
    constexpr std::size_t name_width = 12;
    constexpr std::size_t counts_width = 28;
    return padded(junction_.approach_name[approach], name_width) + padded(counts_of(approach, now_ms), counts_width) +
           forecast_of(approach, now_ms) + neighbour_of(approach, now_ms);
}

std::vector<std::string> JunctionView::lines(std::uint32_t now_ms) const {
    std::vector<std::string> all{status_line(now_ms), lamps_line(now_ms)};
    if (junction_.junction_wait_ds > 0) {
        all.push_back(junction_line(now_ms));
    }
    all.emplace_back("approach    vehicles there              next 10, 30, 60 s");
    for (std::uint32_t i = 0; i < junction_.approach_count; ++i) {
        all.push_back(approach_line(i, now_ms));
    }
    if (spoilt_ > 0) {
        all.push_back("spoilt frames: " + std::to_string(spoilt_));
    }
    return all;
}

} // namespace elmopp
