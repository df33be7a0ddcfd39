// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "rivals.hpp"

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
constexpr double head_min_veh = 1.0; ///< a lane with less has no head vehicle
constexpr double ds_per_s = 10.0;

double queue_of(const elmopp_view_t &view, std::size_t movement) {
    return static_cast<double>(view.queue_veh[movement]);
}

/// Seconds until `vehicles` of a lane have crossed at its present rate; 0 for none, endless for a lane that stands.
double crossing_s(const elmopp_view_t &view, std::size_t movement, double vehicles) {
    const auto index = static_cast<std::uint32_t>(movement);
    const double flow = static_cast<double>(elmopp_junction_discharge(view.junction, index, view.queue_veh[movement]));
    if (vehicles <= 0.0) {
        return 0.0;
    }
    return flow > 0.0 ? vehicles / flow : std::numeric_limits<double>::infinity();
}

double startup_s(const elmopp_view_t &view, std::size_t movement) {
    return view.junction->movement[movement].startup_ds / ds_per_s;
}

template <typename Visit> void for_served(const elmopp_view_t &view, std::size_t stage, const Visit &visit) {
    for (std::uint32_t j = 0; j < view.junction->movement_count; ++j) {
        if (elmopp_junction_goes(view.junction, j, view.junction->stage_groups[stage])) {
            visit(static_cast<std::size_t>(j));
        }
    }
}

unsigned whole_seconds(double seconds, double shortest) {
    return static_cast<unsigned>(std::ceil(std::clamp(seconds, shortest, green_max_s)));
}

/// The time of a stage runs while it is shown. True when a new decision is due.
bool decision_is_due(const elmopp_view_t &view, unsigned &left_s) {
    if (view.target == ELMOPP_STAGE_NONE) {
        return true;
    }
    if (view.stage != ELMOPP_STAGE_NONE && left_s > 0) {
        --left_s;
    }
    return view.stage != ELMOPP_STAGE_NONE && left_s == 0;
}

elmopp_stage_t argmax(const float *score, std::size_t count) {
    return static_cast<elmopp_stage_t>(std::max_element(score, score + count) - score);
}

elmopp_stage_t choose_itlc(void *state, const elmopp_view_t *view, float *score) {
    auto &self = *static_cast<Itlc *>(state);
    std::fill_n(score, ELMOPP_STAGE_MAX, 0.0F);
    for (std::size_t s = 0; s < view->junction->stage_count; ++s) {
        double ready = 0.0;
        for_served(*view, s, [&](std::size_t j) { ready += std::min(queue_of(*view, j), self.ready_veh); });
        score[s] = static_cast<float>(ready);
    }
    if (!decision_is_due(*view, self.left_s)) {
        return view->target;
    }
    const elmopp_stage_t chosen = argmax(score, view->junction->stage_count);
    double green_s = 0.0;
    for_served(*view, chosen, [&](std::size_t j) {
        const double lost_s = chosen != view->target ? startup_s(*view, j) : 0.0;
        green_s = std::max(green_s, crossing_s(*view, j, std::min(queue_of(*view, j), self.ready_veh)) + lost_s);
    });
    self.left_s = whole_seconds(green_s, itlc_green_min_s);
    return chosen;
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

elmopp_stage_t choose_oaf(void *state, const elmopp_view_t *view, float *score) {
    auto &self = *static_cast<Oaf *>(state);
    keep_clocks(self, *view);
    std::fill_n(score, ELMOPP_STAGE_MAX, 0.0F);
    const auto lane = oldest_lane(self, *view);
    const bool begin = view->target == ELMOPP_STAGE_NONE;
    const elmopp_stage_t stay = begin ? elmopp_stage_t{0} : view->target;
    const elmopp_stage_t chosen = lane ? stage_for(self, *view, *lane, score) : stay;
    if (!decision_is_due(*view, self.left_s)) {
        return view->target;
    }
    double green_s = chosen != view->target ? startup_s(*view, lane.value_or(0)) : 0.0;
    if (lane) {
        green_s += crossing_s(*view, *lane, std::min(queue_of(*view, *lane), self.platoon_veh));
    }
    self.left_s = whole_seconds(green_s, oaf_green_min_s);
    return chosen;
}

elmopp_stage_t choose_fixed(void *state, const elmopp_view_t *view, float *score) {
    auto &self = *static_cast<Fixed *>(state);
    std::fill_n(score, ELMOPP_STAGE_MAX, 0.0F);
    if (self.cycle.empty()) {
        self.cycle = covering_cycle(*view->junction);
    }
    if (view->target == ELMOPP_STAGE_NONE) {
        return self.cycle.front();
    }
    if (view->stage == ELMOPP_STAGE_NONE || view->elapsed_ds < self.green_s * ds_per_s) {
        return view->target;
    }
    const auto here = std::find(self.cycle.begin(), self.cycle.end(), view->stage);
    return here == self.cycle.end() || here + 1 == self.cycle.end() ? self.cycle.front() : *(here + 1);
}

} // namespace

elmopp_chooser_t plug(Itlc &state) {
    return {choose_itlc, &state, 0};
}

elmopp_chooser_t plug(Oaf &state) {
    return {choose_oaf, &state, 0};
}

elmopp_chooser_t plug(Fixed &state) {
    return {choose_fixed, &state, 0};
}

std::vector<elmopp_stage_t> covering_cycle(const elmopp_junction_t &junction) {
    std::vector<elmopp_stage_t> cycle;
    std::uint32_t covered = 0;
    for (std::size_t s = 0; s < junction.stage_count; ++s) {
        const std::uint32_t served = elmopp_junction_served(&junction, junction.stage_groups[s]);
        if ((served & ~covered) != 0) {
            cycle.push_back(static_cast<elmopp_stage_t>(s));
            covered |= served;
        }
    }
    return cycle;
}

} // namespace elmopp
