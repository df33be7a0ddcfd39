// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "decision_log.hpp"

#include "csv.hpp"

namespace elmopp {
namespace {

constexpr int log_digits = 9;

/// One digit a signal group, in the codes of LampCommand; groups that the site does not have show 0.
std::string aspects_of(const elmopp_lamps_t &lamps) {
    std::string text(ELMOPP_GROUP_MAX, '0');
    for (std::uint32_t g = 0; g < ELMOPP_GROUP_MAX; ++g) {
        text[g] = static_cast<char>('0' + elmopp_lamps_aspect(&lamps, g));
    }
    return text;
}

} // namespace

std::string log_number(double value) {
    return format_number(value, log_digits);
}

std::string decision_line(const Decision &decision) {
    const elmopp_junction_t &junction = *decision.junction;
    return "{\"t_s\":" + std::to_string(decision.t_s) +
           ",\"stage\":" + std::to_string(static_cast<unsigned>(decision.stage)) + ",\"aspects\":\"" +
           aspects_of(decision.lamps) + "\",\"present\":" + list_of(decision.present_veh, junction.movement_count) +
           ",\"arrived\":" + list_of(decision.arrived_veh, junction.movement_count) +
           ",\"urgency\":" + list_of(decision.score, junction.stage_count) +
           ",\"forecast\":" + list_of(decision.foreseen_veh, junction.approach_count) +
           ",\"fault\":" + std::to_string(static_cast<unsigned>(decision.fault));
}

} // namespace elmopp
