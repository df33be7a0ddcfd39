// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace elmopp {
namespace {

/// The Greenshields parabola k v (1 - k) is highest at k = 1/2.
constexpr double greenshields_top = 0.25;
constexpr double least_flow_veh_per_s = 0.05;

std::uint16_t groups_of(const elmopp_junction_t &junction, elmopp_stage_t stage) {
    return stage < junction.stage_count ? junction.stage_groups[stage] : std::uint16_t{0};
}

} // namespace

double queue_of(const elmopp_view_t &view, std::size_t movement) {
    return static_cast<double>(view.queue_veh[movement]);
}

double startup_s(const elmopp_junction_t &junction, std::size_t movement) {
    return junction.movement[movement].startup_ds / ds_per_s;
}

double saturation_veh_per_s(const elmopp_junction_t &junction, std::size_t movement) {
    const double flow = junction.discharge == ELMOPP_DISCHARGE_SATURATION
                            ? static_cast<double>(junction.movement[movement].saturation_veh_per_s)
                            : static_cast<double>(junction.free_flow_m_per_s) * greenshields_top;
    return std::max(flow, least_flow_veh_per_s);
}

double present_flow_veh_per_s(const elmopp_view_t &view, std::size_t movement) {
    if (view.junction->discharge == ELMOPP_DISCHARGE_SATURATION) {
        return saturation_veh_per_s(*view.junction, movement);
    }
    const float queue_veh = std::max(view.queue_veh[movement], 1.0F);
    const float flow = elmopp_junction_discharge(view.junction, static_cast<std::uint32_t>(movement), queue_veh);
    return std::max(static_cast<double>(flow), least_flow_veh_per_s);
}

double crossing_s(const elmopp_view_t &view, std::size_t movement, double vehicles) {
    const auto index = static_cast<std::uint32_t>(movement);
    const double flow = static_cast<double>(elmopp_junction_discharge(view.junction, index, view.queue_veh[movement]));
    if (vehicles <= 0.0) {
        return 0.0;
    }
    return flow > 0.0 ? vehicles / flow : std::numeric_limits<double>::infinity();
}

std::uint32_t served_by(const elmopp_junction_t &junction, elmopp_stage_t stage) {
    return stage < junction.stage_count ? elmopp_junction_served(&junction, junction.stage_groups[stage]) : 0U;
}

double lanes_served(const elmopp_view_t &view, std::size_t stage) {
    double lanes = 0.0;
    for_served(view, stage, [&](std::size_t j) { lanes += view.junction->movement[j].lanes; });
    return lanes;
}

bool is_called(const elmopp_view_t &view, std::uint32_t movements) {
    for (std::uint32_t j = 0; j < view.junction->movement_count; ++j) {
        if (elmopp_mask_has(movements, j) && queue_of(view, j) >= head_min_veh) {
            return true;
        }
    }
    return false;
}

elmopp_stage_t argmax(const float *score, std::size_t count) {
    return static_cast<elmopp_stage_t>(std::max_element(score, score + count) - score);
}

elmopp_stage_t best_or_stay(const elmopp_view_t &view, const float *score) {
    const elmopp_stage_t best = argmax(score, view.junction->stage_count);
    const bool shown = view.stage < view.junction->stage_count;
    return shown && score[best] <= score[view.stage] ? view.stage : best;
}

unsigned elapsed_s(const elmopp_view_t &view) {
    return view.elapsed_ds / ELMOPP_LAMP_TICKS_PER_S;
}

bool is_free(const elmopp_view_t &view, unsigned min_s) {
    return view.target == ELMOPP_STAGE_NONE || (view.stage != ELMOPP_STAGE_NONE && elapsed_s(view) >= min_s);
}

bool is_due_every(const elmopp_view_t &view, unsigned interval_s) {
    if (view.target == ELMOPP_STAGE_NONE) {
        return true;
    }
    // An age that stands still at its end would never be a multiple.
    const bool endless = view.elapsed_ds == std::numeric_limits<std::uint16_t>::max();
    const bool multiple = elapsed_s(view) > 0 && elapsed_s(view) % interval_s == 0;
    return view.stage != ELMOPP_STAGE_NONE && (endless || multiple);
}

bool decision_is_due(const elmopp_view_t &view, unsigned &left_s) {
    if (view.target == ELMOPP_STAGE_NONE) {
        return true;
    }
    if (view.stage != ELMOPP_STAGE_NONE && left_s > 0) {
        --left_s;
    }
    return view.stage != ELMOPP_STAGE_NONE && left_s == 0;
}

unsigned min_green_s(const elmopp_junction_t &junction, elmopp_stage_t stage) {
    unsigned longest_ds = 0;
    for (std::uint32_t g = 0; g < junction.group_count; ++g) {
        if (elmopp_mask_has(groups_of(junction, stage), g)) {
            longest_ds = std::max<unsigned>(longest_ds, junction.group[g].min_green_ds);
        }
    }
    return (longest_ds + ELMOPP_LAMP_TICKS_PER_S - 1U) / ELMOPP_LAMP_TICKS_PER_S;
}

double change_s(const elmopp_junction_t &junction, elmopp_stage_t from, elmopp_stage_t to) {
    const bool starts = from >= junction.stage_count;
    return starts
               ? 0.0
               : elmopp_junction_clearing_ds(&junction, groups_of(junction, from), groups_of(junction, to)) / ds_per_s;
}

double new_startup_s(const elmopp_junction_t &junction, elmopp_stage_t from, elmopp_stage_t to) {
    return elmopp_junction_starting_ds(&junction, groups_of(junction, from), groups_of(junction, to)) / ds_per_s;
}

double switch_s(const elmopp_junction_t &junction, elmopp_stage_t from, elmopp_stage_t to) {
    return change_s(junction, from, to) + new_startup_s(junction, from, to);
}

} // namespace elmopp
