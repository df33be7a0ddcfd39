// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "scoot.hpp"

#include "view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace elmopp {
namespace {

constexpr unsigned interval_s = 4;
constexpr std::size_t steps_max = 60;
constexpr double fresh = 0.3; ///< weight of the last round in the profile
constexpr unsigned decide_before_s = 5;
constexpr int shift_s = 4;
constexpr unsigned review_after_s = 300;
constexpr unsigned review_while_growing_s = 150;
constexpr double no_saturation = 0.01; ///< where nobody came, the longer green counts as the emptier one
constexpr double first_cycle_s = 70.0;

int sign_of(int value) {
    return (value > 0 ? 1 : 0) - (value < 0 ? 1 : 0);
}

/// By how much a cycle of this length changes at a time.
int cycle_step_s(double cycle_s) {
    if (cycle_s < 64.0) {
        return 4;
    }
    return cycle_s < 128.0 ? 8 : 16;
}

unsigned shifted(unsigned seconds, int by_s, unsigned least_s) {
    return static_cast<unsigned>(std::max(static_cast<int>(seconds) + by_s, static_cast<int>(least_s)));
}

} // namespace

void Scoot::prepare(const elmopp_view_t &view) {
    if (cycle.size() > 0) {
        return;
    }
    cycle.prepare(*view.junction);
    const double first_s = std::min<double>(first_cycle_s, longest_cycle_s);
    greens_s = share_greens_s(cycle, *view.junction, first_s, std::vector<double>(cycle.size(), 1.0));
    saturation.assign(cycle.size(), 0.0);
    const std::size_t movements = view.junction->movement_count;
    profile_veh_per_s.assign(movements, std::vector<double>(steps_max, -1.0));
    step_veh.assign(movements, 0.0);
    departed_veh.assign(movements, 0.0);
}

/// One more second of arrivals in the profile, and of departures in the green.
void Scoot::observe(const elmopp_view_t &view) {
    departures.observe(view);
    flow.observe(view);
    const std::size_t step = std::min<std::size_t>(round_s / interval_s, steps_max - 1);
    const bool complete = (round_s + 1) % interval_s == 0;
    for (std::size_t j = 0; j < step_veh.size(); ++j) {
        departed_veh[j] += departures.veh(j);
        step_veh[j] += static_cast<double>(view.arrivals_veh[j]);
        if (complete) {
            double &rate = profile_veh_per_s[j][step];
            const double now = step_veh[j] / interval_s;
            rate = rate < 0.0 ? now : rate + fresh * (now - rate);
            step_veh[j] = 0.0;
        }
    }
    ++round_s;
    ++review_s;
}

double Scoot::cycle_s(const elmopp_view_t &view) const {
    double sum_s = std::accumulate(greens_s.begin(), greens_s.end(), 0.0);
    for (std::size_t i = 0; cycle.size() > 1 && i < cycle.size(); ++i) {
        sum_s += change_s(*view.junction, cycle.stage(i), cycle.stage(i + 1));
    }
    return sum_s;
}

/// Vehicles that the profile expects in the next so many seconds.
double Scoot::coming_veh(std::size_t movement, double seconds, double round_length_s) const {
    double sum_veh = 0.0;
    for (unsigned t = 0; t < seconds; ++t) {
        const double at_s = std::fmod(static_cast<double>(round_s) + t, round_length_s);
        const std::size_t step = std::min(static_cast<std::size_t>(at_s) / interval_s, steps_max - 1);
        const double rate = profile_veh_per_s[movement][step];
        sum_veh += rate < 0.0 ? flow.veh_per_s(movement) : rate;
    }
    return sum_veh;
}

/// Degree of saturation of a stage's green of this length that ends in until_s.
double Scoot::modelled(const elmopp_view_t &view, std::size_t position, double until_s, double green_s) const {
    const bool present = cycle.stage(position) == view.stage;
    const double round_length_s = std::max(1.0, cycle_s(view));
    const double useful_s = std::max(1.0, green_s - cycle.startup_of_s(*view.junction, position));
    double worst = 0.0;
    for_served(view, cycle.stage(position), [&](std::size_t j) {
        const double gone_veh = present ? departed_veh[j] : 0.0;
        const double wanting_veh = gone_veh + queue_of(view, j) + coming_veh(j, until_s, round_length_s);
        worst = std::max(worst, wanting_veh / (useful_s * saturation_veh_per_s(*view.junction, j)));
    });
    return worst;
}

void Scoot::decide_change(const elmopp_view_t &view, std::size_t position) {
    const elmopp_junction_t &junction = *view.junction;
    const std::size_t next = (position + 1) % cycle.size();
    const auto least_s = cycle.min_greens_s(junction);
    const double change = change_s(junction, cycle.stage(position), cycle.stage(next));
    double best = std::numeric_limits<double>::infinity();
    int best_s = 0;
    for (const int by_s : {0, -shift_s, shift_s}) {
        const int green = static_cast<int>(end_s) + by_s;
        const int next_green = static_cast<int>(greens_s[next]) - by_s;
        const int rest_s = green - static_cast<int>(elapsed_s(view));
        const bool fits = green >= static_cast<int>(least_s[position]) && next_green >= static_cast<int>(least_s[next]);
        if (by_s != 0 && (!fits || rest_s < 1)) {
            continue;
        }
        const double own = modelled(view, position, std::max(0, rest_s), green);
        const double others = modelled(view, next, std::max(0, rest_s) + change + next_green, next_green);
        if (std::max(own, others) < best) {
            best = std::max(own, others);
            best_s = by_s;
            saturation[position] = own;
        }
    }
    // A second for good, the rest for this time only.
    const int for_good_s = sign_of(best_s);
    end_s = shifted(end_s, best_s, 1);
    greens_s[position] = shifted(greens_s[position], for_good_s, least_s[position]);
    greens_s[next] = shifted(greens_s[next], -for_good_s, least_s[next]);
    late_s = best_s - for_good_s;
    decided = true;
}

/// The most saturated green gains, the least saturated one loses, second by second.
void Scoot::resize(const elmopp_view_t &view, int seconds) {
    const auto least_s = cycle.min_greens_s(*view.junction);
    const auto before_s = greens_s;
    for (int i = 0; i < std::abs(seconds); ++i) {
        std::size_t chosen = cycle.size();
        double extreme = 0.0;
        for (std::size_t p = 0; p < cycle.size(); ++p) {
            const double now = std::max(saturation[p], no_saturation) * before_s[p] / greens_s[p];
            const bool may = seconds > 0 || greens_s[p] > least_s[p];
            if (may && (chosen == cycle.size() || (seconds > 0 ? now > extreme : now < extreme))) {
                chosen = p;
                extreme = now;
            }
        }
        if (chosen < cycle.size()) {
            greens_s[chosen] = shifted(greens_s[chosen], sign_of(seconds), 1);
        }
    }
}

void Scoot::review_cycle(const elmopp_view_t &view) {
    if (review_s < (grows ? review_while_growing_s : review_after_s)) {
        return;
    }
    review_s = 0;
    const double now_s = cycle_s(view);
    const double worst = *std::max_element(saturation.begin(), saturation.end());
    const int change = cycle_step_s(now_s);
    grows = worst > target;
    if (grows) {
        resize(view, std::min(change, std::max(0, static_cast<int>(longest_cycle_s) - static_cast<int>(now_s))));
        return;
    }
    const double lost_s = cycle.lost_s(*view.junction);
    const double shorter_s = std::max(now_s - change, lost_s + 1.0);
    const double then = worst * (shorter_s / now_s) * std::max(0.0, now_s - lost_s) / (shorter_s - lost_s);
    if (then <= target) {
        resize(view, -change);
    }
}

void Scoot::begin_green(const elmopp_view_t &view, std::size_t position) {
    if (view.stage == shown) {
        return;
    }
    shown = view.stage;
    std::fill(departed_veh.begin(), departed_veh.end(), 0.0);
    const bool planned = cycle.shows(view);
    const unsigned least_s = min_green_s(*view.junction, view.stage);
    end_s = planned ? shifted(greens_s[position], -late_s, least_s) : least_s;
    late_s = 0;
    decided = !planned || cycle.size() == 1;
}

elmopp_stage_t Scoot::choose(const elmopp_view_t &view, float * /*score*/) {
    prepare(view);
    observe(view);
    if (view.target == ELMOPP_STAGE_NONE) {
        return cycle.stage(0);
    }
    const std::size_t here = cycle.position(view);
    if (view.stage == ELMOPP_STAGE_NONE) {
        shown = ELMOPP_STAGE_NONE;
        return view.target;
    }
    begin_green(view, here);
    if (!decided && elapsed_s(view) + decide_before_s >= end_s) {
        decide_change(view, here);
    }
    if (!is_free(view, end_s)) {
        return view.target;
    }
    const std::size_t next = (here + 1) % cycle.size();
    if (next == 0) {
        review_cycle(view);
        round_s = 0;
        std::fill(step_veh.begin(), step_veh.end(), 0.0);
    }
    return cycle.stage(next);
}

} // namespace elmopp
