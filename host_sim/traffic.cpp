// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "traffic.hpp"

#include "csv.hpp"
#include "error.hpp"
#include "stats.hpp"

#include <algorithm>
#include <cmath>

namespace elmopp {
namespace {

constexpr double conservation_veh = 1e-6;

} // namespace

double discharge_veh_per_s(int law, double queue_veh, double capacity_veh, double free_flow_m_per_s,
                           double saturation_veh_per_s) {
    double flow = saturation_veh_per_s;
    if (law != ELMOPP_DISCHARGE_SATURATION) {
        double load = capacity_veh > 0.0 ? queue_veh / capacity_veh : 0.0;
        if (law == ELMOPP_DISCHARGE_NOLOCK) {
            load = std::min(load, 0.5);
        }
        flow = load * free_flow_m_per_s * (1.0 - load);
    }
    return std::clamp(flow, 0.0, queue_veh);
}

Traffic::Traffic(const Scenario &scenario) : Counted(scenario.capacity_veh.size()), scenario_(scenario) {
    for (std::size_t j = 0; j < queue_veh_.size(); ++j) {
        queue_veh_[j] = scenario.profile.initial_load * scenario.capacity_veh[j];
    }
    total_in_veh_ = sum(queue_veh_);
}

void Traffic::arrive(const std::vector<double> &inflow_veh) {
    for (std::size_t j = 0; j < queue_veh_.size(); ++j) {
        arrived_veh_[j] = inflow_veh[scenario_.junction.movement[j].approach] * scenario_.share[j];
        total_in_veh_ += arrived_veh_[j];
        outside_veh_[j] += arrived_veh_[j];
        const double room_veh = std::max(0.0, scenario_.capacity_veh[j] - queue_veh_[j]);
        const double entering_veh = std::min(outside_veh_[j], room_veh);
        queue_veh_[j] += entering_veh;
        outside_veh_[j] -= entering_veh;
    }
}

double Traffic::flow_veh(std::size_t movement) const {
    return discharge_veh_per_s(scenario_.junction.discharge, queue_veh_[movement], scenario_.capacity_veh[movement],
                               static_cast<double>(scenario_.junction.free_flow_m_per_s),
                               static_cast<double>(scenario_.junction.movement[movement].saturation_veh_per_s));
}

void Traffic::leave(const std::vector<double> &flowing) {
    for (std::size_t j = 0; j < queue_veh_.size(); ++j) {
        left_veh_[j] = flow_veh(j) * flowing[j];
        queue_veh_[j] -= left_veh_[j];
        total_out_veh_ += left_veh_[j];
    }
}

void Traffic::check_conservation() const {
    const double lost_veh = total_in_veh_ - total_out_veh_ - sum(queue_veh_) - sum(outside_veh_);
    if (!(std::abs(lost_veh) <= conservation_veh)) {
        throw Failure("conservation: " + format_number(lost_veh, 6) + " vehicles lost; right would be 0 within 1e-6");
    }
}

} // namespace elmopp
