// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "self_control.hpp"

#include "view.hpp"

#include <algorithm>
#include <cmath>

namespace elmopp {
namespace {

constexpr double longest_clearing_s = 60.0;
constexpr double least_spare_flow =
    0.1; ///< of the saturation flow: a queue that grows as fast as it leaves never clears

/// The stage that serves a movement with the highest score; the present one stays if it does.
elmopp_stage_t stage_for(const elmopp_view_t &view, std::size_t movement, const float *score) {
    const auto index = static_cast<std::uint32_t>(movement);
    if (elmopp_mask_has(served_by(*view.junction, view.stage), index)) {
        return view.stage;
    }
    elmopp_stage_t best = ELMOPP_STAGE_NONE;
    for (elmopp_stage_t s = 0; s < view.junction->stage_count; ++s) {
        const bool serves = elmopp_mask_has(served_by(*view.junction, s), index);
        best = serves && (best == ELMOPP_STAGE_NONE || score[s] > score[best]) ? s : best;
    }
    return best;
}

} // namespace

/// Green until the queue is gone that will be there after before_s.
double SelfControl::clearing_s(const elmopp_view_t &view, std::size_t movement, double before_s) const {
    const double rate = present_flow_veh_per_s(view, movement);
    const double come_veh = flow.veh_per_s(movement);
    const double spare = std::max(rate - come_veh, least_spare_flow * rate);
    double green_s =
        (queue_of(view, movement) + come_veh * std::max(0.0, before_s - approaching.travel_s(movement))) / spare;
    // Who is still on his way cannot leave before he is there.
    for (unsigned second = 0; second < approaching.travel_s(movement); ++second) {
        const double wait_s = second + 1.0 - before_s;
        green_s = approaching.due_veh(movement, second) > 0.0 ? std::max(green_s, wait_s) : green_s;
    }
    return std::min(green_s, longest_clearing_s);
}

/// Vehicles that are at the stop line until a green of this length, which begins after before_s, is over.
double SelfControl::expected_veh(std::size_t movement, double before_s, double green_s) const {
    const double end_s = before_s + green_s;
    const double beyond_s = std::max(0.0, end_s - approaching.travel_s(movement));
    const auto seconds = static_cast<unsigned>(std::ceil(end_s));
    return approaching.queued_veh(movement) + approaching.due_within_veh(movement, seconds) +
           flow.veh_per_s(movement) * beyond_s;
}

/// Vehicles a second, best over how long the stage is green.
double SelfControl::index_of(const elmopp_view_t &view, elmopp_stage_t stage) const {
    const bool present = stage == view.stage;
    const double before_s = present ? 0.0 : switch_s(*view.junction, view.stage, stage);
    const double back_s =
        present ? 0.0 : switch_s(*view.junction, stage, view.stage < view.junction->stage_count ? view.stage : stage);
    double best = 0.0;
    for_served(view, stage, [&](std::size_t critical) {
        const double green_s = std::max(1.0, clearing_s(view, critical, before_s));
        double veh = 0.0;
        for_served(view, stage, [&](std::size_t j) {
            const double most_veh = present_flow_veh_per_s(view, j) * green_s;
            veh += std::min(most_veh, expected_veh(j, before_s, green_s));
        });
        best = std::max(best, veh / (before_s + back_s + green_s));
    });
    return best;
}

/// What a movement may have of a period: its own flow's green and an equal part of what is spare.
double SelfControl::share_s(const elmopp_view_t &view, std::size_t movement) const {
    const elmopp_junction_t &junction = *view.junction;
    const double own_s = flow.veh_per_s(movement) / saturation_veh_per_s(junction, movement) * period_s;
    return own_s + static_cast<double>(period_s) / junction.movement_count;
}

bool SelfControl::is_late(const elmopp_view_t &view, std::size_t movement) const {
    if (queue_of(view, movement) < head_min_veh) {
        return false;
    }
    const double interval_s =
        view.red_ds[movement] / ds_per_s + startup_s(*view.junction, movement) + clearing_s(view, movement, 0.0);
    const double flow_veh_per_s = std::max(flow.veh_per_s(movement), 1.0 / period_s);
    const double span_s = std::max(1.0, static_cast<double>(longest_s) - period_s);
    const double critical_veh = flow_veh_per_s * period_s * (longest_s - interval_s) / span_s;
    return queue_of(view, movement) >= critical_veh;
}

void SelfControl::keep_urgent(const elmopp_view_t &view) {
    const auto is_going = [&view](std::size_t j) { return elmopp_mask_has(view.going, static_cast<std::uint32_t>(j)); };
    for (Late &late : urgent) {
        late.green_s += is_going(late.movement) ? 1U : 0U;
    }
    const auto is_done = [&](const Late &late) {
        const bool cleared = is_going(late.movement) && approaching.queued_veh(late.movement) < head_min_veh;
        return cleared || late.green_s >= std::max<double>(min_s, share_s(view, late.movement));
    };
    urgent.erase(std::remove_if(urgent.begin(), urgent.end(), is_done), urgent.end());
    for (std::size_t j = 0; j < view.junction->movement_count; ++j) {
        const bool known =
            std::any_of(urgent.begin(), urgent.end(), [j](const Late &late) { return late.movement == j; });
        if (!known && !is_going(j) && is_late(view, j)) {
            urgent.push_back({j, 0U});
        }
    }
}

elmopp_stage_t SelfControl::choose(const elmopp_view_t &view, float *score) {
    approaching.observe(view);
    flow.observe(view);
    for (elmopp_stage_t s = 0; s < view.junction->stage_count; ++s) {
        score[s] = static_cast<float>(index_of(view, s));
    }
    keep_urgent(view);
    if (!is_free(view, min_s)) {
        return view.target;
    }
    if (!urgent.empty()) {
        return stage_for(view, urgent.front().movement, score);
    }
    return best_or_stay(view, score);
}

} // namespace elmopp
