// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "scats.hpp"

#include "view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace elmopp {
namespace {

constexpr double light = 0.3; ///< degrees of saturation that ask for the shortest, a medium and the longest cycle
constexpr double medium = 0.5;
constexpr double heavy = 0.9;
constexpr double step_s = 6.0;
constexpr double second_step_s = 9.0; ///< if the last change was already a whole step
constexpr std::size_t voting_rounds = 5;
constexpr std::size_t plans_max = 256;
constexpr std::size_t weight_max = 3; ///< finer plans would only scatter the votes

double between(double from_s, double to_s, double share) {
    return from_s + (to_s - from_s) * share;
}

/// A difference in seconds, damped where it is large.
double damped_s(double difference_s) {
    if (difference_s <= 4.0) {
        return difference_s;
    }
    return difference_s <= 8.0 ? 0.5 * difference_s + 2.0 : 0.25 * difference_s + 4.0;
}

/// Every vector of weights from 1 to `most`, the equal one first, without the multiples of others.
std::vector<std::vector<double>> splits(std::size_t positions, std::size_t most) {
    std::vector<std::vector<double>> all{std::vector<double>(positions, 1.0)};
    std::vector<double> weights = all.front();
    for (;;) {
        std::size_t digit = 0;
        while (digit < positions && weights[digit] >= static_cast<double>(most)) {
            weights[digit++] = 1.0;
        }
        if (digit == positions) {
            return all;
        }
        weights[digit] += 1.0;
        // Weights up to 3 have a common factor only if all are multiples of the least.
        const double least = *std::min_element(weights.begin(), weights.end());
        const auto is_multiple = [least](double weight) { return std::fmod(weight, least) == 0.0; };
        if (least < 2.0 || !std::all_of(weights.begin(), weights.end(), is_multiple)) {
            all.push_back(weights);
        }
    }
}

/// Three weights for few positions, two for more; with many, twice the green for any one.
std::vector<std::vector<double>> split_library(std::size_t positions) {
    std::size_t most = 1;
    while (most < plans_max &&
           std::pow(static_cast<double>(most + 1), static_cast<double>(positions)) <= static_cast<double>(plans_max)) {
        ++most;
    }
    if (most > 1) {
        return splits(positions, std::min(most, weight_max));
    }
    std::vector<std::vector<double>> all(positions + 1, std::vector<double>(positions, 1.0));
    for (std::size_t i = 0; i < positions; ++i) {
        all[i + 1][i] = 2.0;
    }
    return all;
}

std::vector<double> shares_of(const std::vector<double> &weights) {
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    std::vector<double> shares(weights);
    std::for_each(shares.begin(), shares.end(), [sum](double &share) { share /= sum; });
    return shares;
}

} // namespace

void Scats::prepare(const elmopp_view_t &view) {
    departures.observe(view);
    if (cycle.size() > 0) {
        return;
    }
    cycle.prepare(*view.junction);
    library = split_library(cycle.size());
    cycle_s = medium_cycle_s;
    wanted_s[0] = cycle_s;
    wanted_s[1] = cycle_s;
    begin_round(view);
}

void Scats::begin_round(const elmopp_view_t &view) {
    greens_s = share_greens_s(cycle, *view.junction, cycle_s, library[plan]);
    departed_veh.assign(cycle.size(), std::vector<double>(view.junction->movement_count, 0.0));
    shown_s.assign(cycle.size(), 0U);
}

void Scats::count_green(const elmopp_view_t &view, std::size_t position) {
    if (!cycle.shows(view) || view.elapsed_ds == 0) {
        return;
    }
    ++shown_s[position];
    for_served(view, view.stage, [&](std::size_t j) { departed_veh[position][j] += departures.veh(j); });
}

/// [position] of the movement that used its green best.
std::vector<double> Scats::saturations(const elmopp_view_t &view) const {
    std::vector<double> saturation(cycle.size());
    for (std::size_t i = 0; i < cycle.size(); ++i) {
        const double green_s = std::max(1.0, shown_s[i] - cycle.startup_of_s(*view.junction, i));
        for_served(view, cycle.stage(i), [&](std::size_t j) {
            const double possible_veh = green_s * saturation_veh_per_s(*view.junction, j);
            saturation[i] = std::max(saturation[i], departed_veh[i][j] / possible_veh);
        });
    }
    return saturation;
}

void Scats::step_cycle(double saturation) {
    const double shortest_s = shortest_cycle_s;
    const double longest_s = longest_cycle_s;
    double target_s = longest_s;
    if (saturation <= light) {
        target_s = shortest_s;
    } else if (saturation <= medium) {
        target_s = between(shortest_s, medium_cycle_s, (saturation - light) / (medium - light));
    } else if (saturation <= heavy) {
        target_s = between(medium_cycle_s, longest_s, (saturation - medium) / (heavy - medium));
    }
    const double change_s = damped_s(std::abs(target_s - cycle_s));
    const double now_s = cycle_s + (target_s > cycle_s ? change_s : -change_s);
    const double smooth_s = 0.45 * now_s + 0.33 * wanted_s[0] + 0.22 * wanted_s[1];
    wanted_s[1] = wanted_s[0];
    wanted_s[0] = now_s;
    const double most_s = has_stepped ? second_step_s : step_s;
    const double step = std::clamp(smooth_s - cycle_s, -most_s, most_s);
    has_stepped = std::abs(step) >= step_s;
    cycle_s = std::clamp(cycle_s + step, shortest_s, longest_s);
}

/// The plan that would have had the least of the largest saturations gets a vote; the one in use wins a tie.
void Scats::vote(const std::vector<double> &saturation) {
    const auto now = shares_of(library[plan]);
    const auto projected = [&](std::size_t candidate) {
        const auto shares = shares_of(library[candidate]);
        double worst = 0.0;
        for (std::size_t i = 0; i < shares.size(); ++i) {
            worst = std::max(worst, saturation[i] * now[i] / shares[i]);
        }
        return worst;
    };
    std::size_t best = plan;
    double least = projected(plan);
    for (std::size_t k = 0; k < library.size(); ++k) {
        const double worst = projected(k);
        if (worst < least) {
            best = k;
            least = worst;
        }
    }
    votes.push_back(best);
    if (votes.size() > voting_rounds) {
        votes.pop_front();
    }
    const auto count = [this](std::size_t k) { return std::count(votes.begin(), votes.end(), k); };
    std::size_t winner = votes.back(); // of equals the latest
    for (const std::size_t candidate : votes) {
        winner = count(candidate) > count(winner) ? candidate : winner;
    }
    plan = winner;
}

elmopp_stage_t Scats::choose(const elmopp_view_t &view, float * /*score*/) {
    prepare(view);
    if (view.target == ELMOPP_STAGE_NONE) {
        return cycle.stage(0);
    }
    const std::size_t here = cycle.position(view);
    count_green(view, here);
    const unsigned green_s = cycle.shows(view) ? greens_s[here] : min_green_s(*view.junction, view.stage);
    if (!is_free(view, green_s)) {
        return view.target;
    }
    const std::size_t next = (here + 1) % cycle.size();
    if (next == 0) {
        const auto saturation = saturations(view);
        vote(saturation);
        step_cycle(*std::max_element(saturation.begin(), saturation.end()));
        begin_round(view);
    }
    return cycle.stage(next);
}

} // namespace elmopp
