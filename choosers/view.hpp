// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// View: the questions that more than one rule asks of the chooser's view and of the junction.

#pragma once

#include "core.hpp"

#include <cstddef>
#include <cstdint>

namespace elmopp {

constexpr double ds_per_s = 10.0;
constexpr double head_min_veh = 1.0; ///< a lane with less has no head vehicle: nobody waits there

/// Vehicles inside the counted reach, queued or on their way.
double queue_of(const elmopp_view_t &view, std::size_t movement);

double startup_s(const elmopp_junction_t &junction, std::size_t movement);

/// Flow of the movement at its best, whatever stands there now.
double saturation_veh_per_s(const elmopp_junction_t &junction, std::size_t movement);

/// Flow with which a queue as it is now leaves. Never 0, so that it can be divided by.
double present_flow_veh_per_s(const elmopp_view_t &view, std::size_t movement);

/// Seconds until `vehicles` of a movement have crossed at its present rate; 0 for none, endless for one that stands.
double crossing_s(const elmopp_view_t &view, std::size_t movement, double vehicles);

/// Mask of the movements that a stage serves; none for ELMOPP_STAGE_NONE.
std::uint32_t served_by(const elmopp_junction_t &junction, elmopp_stage_t stage);

template <typename Visit> void for_served(const elmopp_view_t &view, std::size_t stage, const Visit &visit) {
    for (std::uint32_t j = 0; j < view.junction->movement_count; ++j) {
        if (elmopp_junction_goes(view.junction, j, view.junction->stage_groups[stage])) {
            visit(static_cast<std::size_t>(j));
        }
    }
}

/// Pavement lanes that a stage serves.
double lanes_served(const elmopp_view_t &view, std::size_t stage);

/// True if somebody waits on a movement of the mask.
bool is_called(const elmopp_view_t &view, std::uint32_t movements);

/// The stage with the highest score, the lowest among equals.
elmopp_stage_t argmax(const float *score, std::size_t count);

/// The same, but the stage that is shown stays while none is better.
elmopp_stage_t best_or_stay(const elmopp_view_t &view, const float *score);

/// Seconds for which the stage has been shown.
unsigned elapsed_s(const elmopp_view_t &view);

/// True if a rule may name another stage: at the start, and when a stage has been shown for min_s.
bool is_free(const elmopp_view_t &view, unsigned min_s);

/// True once in so many seconds of a stage that is shown, and at the start.
bool is_due_every(const elmopp_view_t &view, unsigned interval_s);

/// The time of a stage runs while it is shown. True when a new decision is due.
bool decision_is_due(const elmopp_view_t &view, unsigned &left_s);

/// The longest minimum green of a stage's groups, in whole seconds.
unsigned min_green_s(const elmopp_junction_t &junction, elmopp_stage_t stage);

/// Seconds in which nothing new is green when a stage follows another one; 0 at the start.
double change_s(const elmopp_junction_t &junction, elmopp_stage_t from, elmopp_stage_t to);

/// The longest start-up of the movements that go in `to` and not in `from`.
double new_startup_s(const elmopp_junction_t &junction, elmopp_stage_t from, elmopp_stage_t to);

/// What a change of stage costs: both of the above.
double switch_s(const elmopp_junction_t &junction, elmopp_stage_t from, elmopp_stage_t to);

} // namespace elmopp
