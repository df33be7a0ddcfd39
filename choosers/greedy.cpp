// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "greedy.hpp"

#include "view.hpp"

#include <algorithm>
#include <cmath>

namespace elmopp {
namespace {

void score_vehicles(const elmopp_view_t &view, float *score) {
    for (std::size_t s = 0; s < view.junction->stage_count; ++s) {
        for_served(view, s, [&](std::size_t j) { score[s] += view.queue_veh[j]; });
    }
}

double load_of(const elmopp_view_t &view, std::size_t movement) {
    return static_cast<double>(
        elmopp_junction_load(view.junction, static_cast<std::uint32_t>(movement), view.queue_veh[movement]));
}

/// The best of the other stages; the shown one if it is the only one.
elmopp_stage_t best_other(const elmopp_view_t &view, const float *score) {
    elmopp_stage_t best = view.stage;
    for (elmopp_stage_t s = 0; s < view.junction->stage_count; ++s) {
        if (s != view.stage && (best == view.stage || score[s] > score[best])) {
            best = s;
        }
    }
    return best;
}

} // namespace

elmopp_stage_t LongestQueue::choose(const elmopp_view_t &view, float *score) {
    approaching.observe(view);
    double total_veh[ELMOPP_STAGE_MAX] = {};
    for (std::size_t s = 0; s < view.junction->stage_count; ++s) {
        for_served(view, s, [&](std::size_t j) {
            const double lanes = std::max<double>(1.0, view.junction->movement[j].lanes);
            score[s] = std::max(score[s], static_cast<float>(approaching.queued_veh(j) / lanes));
            total_veh[s] += approaching.queued_veh(j);
        });
    }
    if (!is_free(view, min_s)) {
        return view.target;
    }
    elmopp_stage_t best = best_or_stay(view, score);
    for (elmopp_stage_t s = 0; best != view.stage && s < view.junction->stage_count; ++s) {
        best = score[s] >= score[best] && total_veh[s] > total_veh[best] ? s : best;
    }
    return best;
}

elmopp_stage_t MaxWave::choose(const elmopp_view_t &view, float *score) {
    score_vehicles(view, score);
    return is_free(view, min_s) ? best_or_stay(view, score) : view.target;
}

elmopp_stage_t MaxWaveHold::choose(const elmopp_view_t &view, float *score) {
    score_vehicles(view, score);
    if (!is_free(view, min_s)) {
        return view.target;
    }
    const elmopp_stage_t best = best_or_stay(view, score);
    if (view.stage == ELMOPP_STAGE_NONE || best == view.stage) {
        return best;
    }
    const auto own_veh = static_cast<double>(score[view.stage]);
    const bool empty = own_veh < empty_veh * lanes_served(view, view.stage);
    // The best by its lead over what it would have to have.
    elmopp_stage_t wanted = view.stage;
    double widest_veh = 0.0;
    for (elmopp_stage_t s = 0; s < view.junction->stage_count; ++s) {
        const double lead_veh = static_cast<double>(score[s]) - own_veh - margin_veh * lanes_served(view, s);
        if (s != view.stage && (wanted == view.stage ? lead_veh >= 0.0 : lead_veh > widest_veh)) {
            wanted = s;
            widest_veh = lead_veh;
        }
    }
    return empty ? best : wanted;
}

elmopp_stage_t ElmoppHold::choose(const elmopp_view_t &view, float *score) {
    for (std::size_t s = 0; s < view.junction->stage_count; ++s) {
        for_served(view, s, [&](std::size_t j) {
            const bool going = elmopp_mask_has(view.going, static_cast<std::uint32_t>(j));
            const double age = view.red_ds[j] / (ds_per_s * max_s) - 1.0;
            const double factor = going ? weight : std::exp(std::min(age, double{ELMOPP_AGE_EXPONENT_MAX}));
            score[s] += static_cast<float>(load_of(view, j) * factor);
        });
    }
    if (!is_free(view, min_s)) {
        return view.target;
    }
    const bool over = view.stage != ELMOPP_STAGE_NONE && elapsed_s(view) >= max_s;
    const elmopp_stage_t other = over ? best_other(view, score) : view.stage;
    return over && score[other] > 0.0F ? other : best_or_stay(view, score);
}

elmopp_stage_t MaxPressure::choose(const elmopp_view_t &view, float *score) {
    for (std::size_t s = 0; s < view.junction->stage_count; ++s) {
        for_served(view, s, [&](std::size_t j) {
            const double behind_veh = downstream_veh == nullptr ? 0.0 : static_cast<double>(downstream_veh[j]);
            score[s] += static_cast<float>(saturation_veh_per_s(*view.junction, j) * (queue_of(view, j) - behind_veh));
        });
    }
    return is_due_every(view, interval_s) ? best_or_stay(view, score) : view.target;
}

elmopp_stage_t Random::choose(const elmopp_view_t &view, float * /*score*/) {
    if (!is_due_every(view, interval_s)) {
        return view.target;
    }
    // The remainder favours low stages by less than 2^-58, and is the same with every library.
    return static_cast<elmopp_stage_t>(generator() % view.junction->stage_count);
}

} // namespace elmopp
