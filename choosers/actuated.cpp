// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "actuated.hpp"

#include "view.hpp"

namespace elmopp {
namespace {

constexpr double vehicle_soon_veh = 0.5; ///< a fraction of a vehicle is none

/// The stage that keeps these movements and serves somebody who calls besides, most vehicles first; the present one if
/// there is none.
elmopp_stage_t stage_beside(const elmopp_view_t &view, std::uint32_t held, const float *score) {
    const std::uint32_t served = served_by(*view.junction, view.stage);
    elmopp_stage_t best = view.stage;
    for (elmopp_stage_t s = 0; s < view.junction->stage_count; ++s) {
        const std::uint32_t theirs = served_by(*view.junction, s);
        const bool fits = (held & ~theirs) == 0 && is_called(view, theirs & ~served);
        if (fits && (best == view.stage || score[s] > score[best])) {
            best = s;
        }
    }
    return best;
}

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

/// Mask of the movements that go and still hold the green.
std::uint32_t Actuated::holding(const elmopp_view_t &view) const {
    std::uint32_t mask = 0;
    for (std::uint32_t j = 0; j < view.junction->movement_count; ++j) {
        const bool follows =
            approaching.queued_veh(j) >= head_min_veh || approaching.due_within_veh(j, gap_s) >= vehicle_soon_veh;
        if (follows && contested_s[j] < max_s) {
            mask |= 1U << j;
        }
    }
    return mask & served_by(*view.junction, view.stage);
}

void Actuated::count_contest(const elmopp_view_t &view) {
    contested_s.resize(view.junction->movement_count);
    const bool called = is_called(view, ~served_by(*view.junction, view.target));
    for (std::uint32_t j = 0; j < contested_s.size(); ++j) {
        const bool counts = elmopp_mask_has(view.going, j) && (called || contested_s[j] > 0);
        contested_s[j] = counts ? contested_s[j] + 1U : 0U;
    }
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
    const std::uint32_t held = holding(view);
    return held == 0 ? next_called(view) : stage_beside(view, held, score);
}

} // namespace elmopp
