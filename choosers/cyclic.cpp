// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "cyclic.hpp"

#include "view.hpp"

#include <algorithm>
#include <numeric>

namespace elmopp {
namespace {

constexpr unsigned counted_s = 900;   ///< the flows are known after so long
constexpr unsigned too_early_s = 120; ///< a mean of less says little
constexpr double longest_ratio = 0.95;

} // namespace

elmopp_stage_t Fixed::choose(const elmopp_view_t &view, float * /*score*/) {
    if (cycle.empty()) {
        cycle = covering_cycle(*view.junction);
    }
    if (view.target == ELMOPP_STAGE_NONE) {
        return cycle.front();
    }
    if (view.stage == ELMOPP_STAGE_NONE || view.elapsed_ds < green_s * ds_per_s) {
        return view.target;
    }
    const auto here = std::find(cycle.begin(), cycle.end(), view.stage);
    return here == cycle.end() || here + 1 == cycle.end() ? cycle.front() : *(here + 1);
}

void Webster::plan(const elmopp_view_t &view) {
    const elmopp_junction_t &junction = *view.junction;
    std::vector<double> flows(junction.movement_count);
    for (std::size_t j = 0; j < flows.size(); ++j) {
        flows[j] = flow.veh_per_s(j);
    }
    const auto ratios = flow_ratios(cycle, junction, flows);
    const double busy = std::min(longest_ratio, std::accumulate(ratios.begin(), ratios.end(), 0.0));
    const double best_s = (1.5 * cycle.lost_s(junction) + 5.0) / (1.0 - busy);
    const double cycle_s =
        std::clamp(best_s, static_cast<double>(shortest_cycle_s), static_cast<double>(longest_cycle_s));
    greens_s = share_greens_s(cycle, junction, cycle_s, ratios);
}

elmopp_stage_t Webster::choose(const elmopp_view_t &view, float * /*score*/) {
    cycle.prepare(*view.junction);
    if (greens_s.empty()) {
        greens_s.assign(cycle.size(), default_s);
    }
    if (!settled) {
        flow.observe(view);
    }
    if (view.target == ELMOPP_STAGE_NONE) {
        return cycle.stage(0);
    }
    const std::size_t here = cycle.position(view);
    const unsigned green_s = cycle.shows(view) ? greens_s[here] : min_green_s(*view.junction, view.stage);
    if (!is_free(view, green_s)) {
        return view.target;
    }
    const std::size_t next = (here + 1) % cycle.size();
    if (next == 0 && !settled && flow.seen_s() >= too_early_s) {
        plan(view);
        settled = flow.seen_s() >= counted_s;
    }
    return cycle.stage(next);
}

} // namespace elmopp
