// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "actuated.hpp"

#include "view.hpp"

namespace elmopp {
namespace {

constexpr double vehicle_soon_veh = 0.5; ///< a fraction of a vehicle is none

} // namespace

/// The next stage of the cycle with a call that the present one does not serve; the present one if there is none.
elmopp_stage_t Actuated::next_called(const elmopp_view_t &view) {
    const std::uint32_t served = served_by(*view.junction, view.target);
    const std::size_t here = cycle.position(view);
    for (std::size_t i = 1; i <= cycle.size(); ++i) {
        const elmopp_stage_t next = cycle.stage(here + i);
        if (is_called(view, served_by(*view.junction, next) & ~served)) {
            return next;
        }
    }
    return view.target;
}

bool Actuated::is_gap(const elmopp_view_t &view, elmopp_stage_t next) const {
    const std::uint32_t leaving = served_by(*view.junction, view.stage) & ~served_by(*view.junction, next);
    for (std::uint32_t j = 0; j < view.junction->movement_count; ++j) {
        const bool follows =
            approaching.queued_veh(j) >= head_min_veh || approaching.due_within_veh(j, gap_s) >= vehicle_soon_veh;
        if (elmopp_mask_has(leaving, j) && follows) {
            return false;
        }
    }
    return true;
}

void Actuated::count_contest(const elmopp_view_t &view) {
    if (view.stage != shown) {
        shown = view.stage;
        contested_s = 0;
    }
    const bool called = is_called(view, ~served_by(*view.junction, view.stage));
    contested_s += called || contested_s > 0 ? 1U : 0U;
}

elmopp_stage_t Actuated::choose(const elmopp_view_t &view, float *score) {
    cycle.prepare(*view.junction);
    approaching.observe(view);
    for (std::size_t s = 0; s < view.junction->stage_count; ++s) {
        for_served(view, s, [&](std::size_t j) { score[s] += view.queue_veh[j]; });
    }
    if (view.target == ELMOPP_STAGE_NONE) {
        for (std::size_t i = 0; i < cycle.size(); ++i) {
            if (is_called(view, served_by(*view.junction, cycle.stage(i)))) {
                return cycle.stage(i);
            }
        }
        return cycle.stage(0);
    }
    count_contest(view);
    if (!is_free(view, min_s)) {
        return view.target;
    }
    const elmopp_stage_t next = next_called(view);
    return is_gap(view, next) || contested_s > max_s ? next : view.target;
}

} // namespace elmopp
