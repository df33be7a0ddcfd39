// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "approaching.hpp"

#include "view.hpp"

#include <algorithm>
#include <numeric>

namespace elmopp {
namespace {

/// Who is due first has left first, until no more drive than are there.
void drop_excess(std::vector<double> &due_veh, double present_veh) {
    double excess_veh = std::accumulate(due_veh.begin(), due_veh.end(), 0.0) - present_veh;
    for (double &cell_veh : due_veh) {
        const double leaving_veh = std::clamp(excess_veh, 0.0, cell_veh);
        cell_veh -= leaving_veh;
        excess_veh -= leaving_veh;
    }
}

} // namespace

void Approaching::observe(const elmopp_view_t &view) {
    const std::size_t movements = view.junction->movement_count;
    queued_veh_.resize(movements);
    due_veh_.resize(movements);
    for (std::size_t j = 0; j < movements; ++j) {
        auto &due_veh = due_veh_[j];
        due_veh.resize(travel_s(j), 0.0);
        if (!due_veh.empty()) {
            std::rotate(due_veh.begin(), due_veh.begin() + 1, due_veh.end());
            due_veh.back() = static_cast<double>(view.arrivals_veh[j]);
            drop_excess(due_veh, queue_of(view, j));
        }
        queued_veh_[j] = std::max(0.0, queue_of(view, j) - due_within_veh(j, travel_s(j)));
    }
}

unsigned Approaching::longest_travel_s() const {
    return *std::max_element(travel_s_.begin(), travel_s_.end());
}

double Approaching::due_veh(std::size_t movement, unsigned second) const {
    return second < travel_s(movement) ? due_veh_[movement][second] : 0.0;
}

double Approaching::due_within_veh(std::size_t movement, unsigned seconds) const {
    const auto &due_veh = due_veh_[movement];
    return std::accumulate(due_veh.begin(), due_veh.begin() + std::min(seconds, travel_s(movement)), 0.0);
}

void MeanFlow::observe(const elmopp_view_t &view) {
    veh_per_s_.resize(view.junction->movement_count);
    seen_s_ = std::min(seen_s_ + 1, window_s_);
    for (std::size_t j = 0; j < veh_per_s_.size(); ++j) {
        veh_per_s_[j] += (static_cast<double>(view.arrivals_veh[j]) - veh_per_s_[j]) / seen_s_;
    }
}

void Departures::observe(const elmopp_view_t &view) {
    const bool first = before_veh_.empty();
    before_veh_.resize(view.junction->movement_count);
    left_veh_.resize(view.junction->movement_count);
    for (std::size_t j = 0; j < before_veh_.size(); ++j) {
        const double could_veh = before_veh_[j] + static_cast<double>(view.arrivals_veh[j]);
        left_veh_[j] = first ? 0.0 : std::max(0.0, could_veh - queue_of(view, j));
        before_veh_[j] = queue_of(view, j);
    }
}

} // namespace elmopp
