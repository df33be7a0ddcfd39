// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "rounds.hpp"

#include "view.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

namespace elmopp {
namespace {

constexpr double itlc_green_min_s = 5.0;
constexpr double oaf_green_min_s = 1.0;
constexpr double green_max_s = 60.0;

unsigned whole_seconds(double seconds, double shortest) {
    return static_cast<unsigned>(std::ceil(std::clamp(seconds, shortest, green_max_s)));
}

/// One more second of arrivals; who is no longer inside has left, oldest first.
void keep_clock(Oaf::Lane &lane, double now_s, double arrived_veh, double queue_veh) {
    if (arrived_veh > 0.0) {
        lane.waiting.push_back({now_s, arrived_veh});
    }
    lane.total_veh += arrived_veh;
    double left_veh = lane.total_veh - queue_veh;
    while (left_veh > 0.0 && !lane.waiting.empty()) {
        auto &head = lane.waiting.front();
        const double leaving_veh = std::min(left_veh, head.vehicles);
        head.vehicles -= leaving_veh;
        lane.total_veh -= leaving_veh;
        left_veh -= leaving_veh;
        if (head.vehicles <= 0.0) {
            lane.waiting.pop_front();
        }
    }
}

void keep_clocks(Oaf &self, const elmopp_view_t &view) {
    const bool first = self.lanes.empty();
    self.now_s += first ? 0.0 : 1.0;
    self.lanes.resize(view.junction->movement_count);
    for (std::size_t j = 0; j < view.junction->movement_count; ++j) {
        const double queue_veh = queue_of(view, j);
        keep_clock(self.lanes[j], self.now_s, first ? queue_veh : static_cast<double>(view.arrivals_veh[j]), queue_veh);
    }
}

/// Age of the vehicle at the stop line; below 0 for a lane without one.
double head_age_s(const Oaf &self, const elmopp_view_t &view, std::size_t movement) {
    const bool has_head = queue_of(view, movement) >= head_min_veh && !self.lanes[movement].waiting.empty();
    return has_head ? self.now_s - self.lanes[movement].waiting.front().at_s : -1.0;
}

/// The lane whose head came first, the lowest among equals; none if nobody waits.
std::optional<std::size_t> oldest_lane(const Oaf &self, const elmopp_view_t &view) {
    std::optional<std::size_t> oldest;
    for (std::size_t j = 0; j < view.junction->movement_count; ++j) {
        const double age_s = head_age_s(self, view, j);
        if (age_s >= 0.0 && (!oldest || age_s > head_age_s(self, view, *oldest))) {
            oldest = j;
        }
    }
    return oldest;
}

/// Among the stages that serve the lane the one with the largest sum of head ages, which becomes their score.
elmopp_stage_t stage_for(const Oaf &self, const elmopp_view_t &view, std::size_t lane, float *score) {
    elmopp_stage_t best = ELMOPP_STAGE_NONE;
    for (std::size_t s = 0; s < view.junction->stage_count; ++s) {
        double ages_s = 0.0;
        bool holds_lane = false;
        for_served(view, s, [&](std::size_t j) {
            ages_s += std::max(0.0, head_age_s(self, view, j));
            holds_lane = holds_lane || j == lane;
        });
        if (holds_lane) {
            score[s] = static_cast<float>(ages_s);
            best = best == ELMOPP_STAGE_NONE || score[s] > score[best] ? static_cast<elmopp_stage_t>(s) : best;
        }
    }
    return best;
}

bool serves(const elmopp_view_t &view, elmopp_stage_t stage, std::size_t movement) {
    return elmopp_mask_has(served_by(*view.junction, stage), static_cast<std::uint32_t>(movement));
}

} // namespace

elmopp_stage_t Itlc::choose(const elmopp_view_t &view, float *score) {
    for (std::size_t s = 0; s < view.junction->stage_count; ++s) {
        double ready = 0.0;
        for_served(view, s, [&](std::size_t j) { ready += std::min(queue_of(view, j), ready_veh); });
        score[s] = static_cast<float>(ready);
    }
    if (!decision_is_due(view, left_s)) {
        return view.target;
    }
    const elmopp_stage_t chosen = argmax(score, view.junction->stage_count);
    double green_s = 0.0;
    for_served(view, chosen, [&](std::size_t j) {
        const double lost_s = chosen != view.target ? startup_s(*view.junction, j) : 0.0;
        green_s = std::max(green_s, crossing_s(view, j, std::min(queue_of(view, j), ready_veh)) + lost_s);
    });
    left_s = whole_seconds(green_s, itlc_green_min_s);
    return chosen;
}

double ItlcRounds::ready_of(const elmopp_view_t &view, std::size_t movement) const {
    return std::min(queue_of(view, movement),
                    ready_veh * std::max<double>(1.0, view.junction->movement[movement].lanes));
}

/// The stage with the highest density of movements that are not served yet, which becomes its score; ELMOPP_STAGE_NONE
/// if nobody waits on one.
elmopp_stage_t ItlcRounds::densest(const elmopp_view_t &view, float *score) const {
    elmopp_stage_t best = ELMOPP_STAGE_NONE;
    for (elmopp_stage_t s = 0; s < view.junction->stage_count; ++s) {
        score[s] = 0.0F;
        for_served(view, s, [&](std::size_t j) {
            const auto index = static_cast<std::uint32_t>(j);
            const auto ready = static_cast<float>(ready_of(view, j));
            score[s] += elmopp_mask_has(served, index) ? 0.0F : elmopp_junction_load(view.junction, index, ready);
        });
        const bool called = is_called(view, served_by(*view.junction, s) & ~served);
        best = called && (best == ELMOPP_STAGE_NONE || score[s] > score[best]) ? s : best;
    }
    return best;
}

void ItlcRounds::give(const elmopp_view_t &view, elmopp_stage_t stage) {
    double green_s = 0.0;
    for_served(view, stage, [&](std::size_t j) {
        const double lost_s = serves(view, view.target, j) ? 0.0 : startup_s(*view.junction, j);
        green_s = std::max(green_s, lost_s + crossing_s(view, j, ready_of(view, j)));
        for (unsigned second = 0; second < approaching.travel_s(j); ++second) { // the farthest has to come first
            green_s = approaching.due_veh(j, second) > 0.0 ? std::max(green_s, second + 1.0) : green_s;
        }
    });
    given = stage;
    served |= served_by(*view.junction, stage);
    left_s = whole_seconds(green_s, itlc_green_min_s);
}

elmopp_stage_t ItlcRounds::choose(const elmopp_view_t &view, float *score) {
    approaching.observe(view);
    if (view.stage != ELMOPP_STAGE_NONE && view.stage != given) {
        give(view, view.stage); // the plan has forced it: it is served all the same
    }
    elmopp_stage_t chosen = densest(view, score);
    if (!decision_is_due(view, left_s)) {
        return view.target;
    }
    if (chosen == ELMOPP_STAGE_NONE) {
        served = 0;
        chosen = densest(view, score);
    }
    if (chosen == ELMOPP_STAGE_NONE) {
        return view.target == ELMOPP_STAGE_NONE ? elmopp_stage_t{0} : view.target;
    }
    give(view, chosen);
    return chosen;
}

elmopp_stage_t Oaf::choose(const elmopp_view_t &view, float *score) {
    keep_clocks(*this, view);
    const auto lane = oldest_lane(*this, view);
    const bool begin = view.target == ELMOPP_STAGE_NONE;
    const elmopp_stage_t stay = begin ? elmopp_stage_t{0} : view.target;
    const elmopp_stage_t chosen = lane ? stage_for(*this, view, *lane, score) : stay;
    if (!decision_is_due(view, left_s)) {
        return view.target;
    }
    double green_s = chosen != view.target ? startup_s(*view.junction, lane.value_or(0)) : 0.0;
    if (lane) {
        green_s += crossing_s(view, *lane, std::min(queue_of(view, *lane), platoon_veh));
    }
    left_s = whole_seconds(green_s, oaf_green_min_s);
    return chosen;
}

} // namespace elmopp
