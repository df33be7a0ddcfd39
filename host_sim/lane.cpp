// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "lane.hpp"

namespace elmopp {

bool LaneQueue::has_room(std::int64_t now_ds) {
    while (!gaps_ds_.empty() && gaps_ds_.front() <= now_ds) {
        gaps_ds_.pop_front();
    }
    return now_ds >= next_in_ds_ && vehicles_.size() + gaps_ds_.size() < storage_veh_;
}

void LaneQueue::enter(const Vehicle &vehicle, std::int64_t now_ds) {
    vehicles_.push_back(vehicle);
    next_in_ds_ = now_ds + following_ds;
}

void LaneQueue::leave(std::int64_t now_ds) {
    vehicles_.pop_front();
    gaps_ds_.push_back(now_ds + wave_ds * static_cast<std::int64_t>(storage_veh_));
}

} // namespace elmopp
