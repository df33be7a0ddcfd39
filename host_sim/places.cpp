// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "places.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace elmopp {
namespace {

constexpr double tick_s = 0.1;
constexpr double starting_m_per_s2 = 1.7;
constexpr double braking_m_per_s2 = 3.0;
constexpr double across_per_s = 0.45; ///< lanes, of a vehicle that changes its own
constexpr double tail_m = 5.0;        ///< beyond the line, when a queued one has crossed it
constexpr double rolling_ds = 30.0;   ///< before its crossing a queue's first one starts
constexpr double gone_m = 60.0;       ///< beyond the line
constexpr double unplaced_m = 1e9;
constexpr double held_s = 0.25;
constexpr double queued_m_per_s = 3.0;

/// Index of a ring of so many ticks.
std::size_t slot(std::int64_t now_ds) {
    constexpr std::int64_t size = wave_ds + 1;
    return static_cast<std::size_t>(((now_ds % size) + size) % size);
}

/// The lane that the street would choose at the edge of the reach, as it is now.
std::size_t emptiest(const std::vector<LaneQueue> &lanes) {
    const auto fewer = [](const LaneQueue &a, const LaneQueue &b) { return a.vehicles().size() < b.vehicles().size(); };
    return static_cast<std::size_t>(std::min_element(lanes.begin(), lanes.end(), fewer) - lanes.begin());
}

} // namespace

std::vector<std::pair<std::size_t, std::size_t>> lanes_across(const elmopp_junction_t &site, std::size_t approach) {
    std::vector<std::pair<std::size_t, std::size_t>> lanes;
    for (std::size_t j = 0; j < site.movement_count; ++j) {
        for (std::size_t k = 0; site.movement[j].approach == approach && k < site.movement[j].lanes; ++k) {
            lanes.emplace_back(j, k);
        }
    }
    return lanes;
}

Places::Places(const StreetPlan &plan, std::size_t junction) : plan_(plan[junction]), junction_(junction) {
    const elmopp_junction_t &site = *plan_.site;
    for (std::size_t j = 0; j < site.movement_count; ++j) {
        across_.emplace_back(site.movement[j].lanes, 0.0);
        gone_.emplace_back(site.movement[j].lanes, 0U);
    }
    for (std::size_t i = 0; i < site.approach_count; ++i) {
        double at = 0.0;
        for (const auto &[movement, lane] : lanes_across(site, i)) {
            across_[movement][lane] = at;
            at += 1.0;
        }
    }
}

void Places::follow(const Streets &streets) {
    now_ds_ = streets.now_ds();
    order_.clear();
    for (std::size_t j = 0; j < across_.size(); ++j) {
        see_reach(streets, j);
    }
    for (std::size_t i = 0; i < plan_.arms.size(); ++i) {
        see_road(streets, i);
    }
    see_crossed();
    for (const std::uint64_t id : order_) {
        move(tracks_.at(id));
    }
    for (auto track = tracks_.begin(); track != tracks_.end();) {
        track = track->second.place.front_m < -gone_m ? tracks_.erase(track) : std::next(track);
    }
}

Places::Track &Places::see(const Vehicle &vehicle, std::size_t approach, std::size_t movement) {
    const auto [found, is_new] = tracks_.try_emplace(vehicle.seed);
    Track &track = found->second;
    if (is_new) {
        const elmopp_movement_t &site = plan_.site->movement[movement];
        const double headway_s = site.lanes / static_cast<double>(site.saturation_veh_per_s);
        const double wave_s = static_cast<double>(wave_ds) * tick_s;
        track.limit_m_per_s = plan_.arms[approach].speed_m_per_s;
        track.leaving_m_per_s = std::min(track.limit_m_per_s, vehicle_m / std::max(tick_s, headway_s - wave_s));
        track.place = {vehicle.seed,        approach, movement, vehicle.way, unplaced_m, across_[movement][0],
                       track.limit_m_per_s, false};
    }
    track.seen_ds = now_ds_;
    order_.push_back(vehicle.seed);
    return track;
}

void Places::see_reach(const Streets &streets, std::size_t movement) {
    const auto &lanes = streets.lanes_in_reach(junction_)[movement];
    const std::size_t approach = plan_.site->movement[movement].approach;
    const bool open = elmopp_mask_has(streets.open_movements(junction_), static_cast<std::uint32_t>(movement));
    for (std::size_t k = 0; k < lanes.size(); ++k) {
        std::uint64_t before = 0;
        for (const Vehicle &vehicle : lanes[k].vehicles()) {
            Track &track = see(vehicle, approach, movement);
            const bool goes = before == 0 && (open || lanes[k].in_the_box) &&
                              lanes[k].next_ds - static_cast<double>(now_ds_) <= rolling_ds;
            track.lane = k;
            track.leader = before; // of the head: who has left last, see_crossed()
            track.street = {track.limit_m_per_s * tick_s * static_cast<double>(vehicle.ready_ds - now_ds_),
                            track.limit_m_per_s};
            track.line = goes ? Bound{-tail_m, track.limit_m_per_s} : Bound{0.0, 0.0};
            change_lane(track, k);
            before = vehicle.seed;
        }
    }
}

void Places::see_road(const Streets &streets, std::size_t approach) {
    const auto reach_m = static_cast<double>(plan_.site->reach_m);
    for (const LaneQueue &road : streets.lanes_on_road({junction_, approach})) {
        std::uint64_t before = 0;
        for (const Vehicle &vehicle : road.vehicles()) {
            const std::size_t movement = plan_.arms[approach].ways[vehicle.way].movement;
            Track &track = see(vehicle, approach, movement);
            const double away_m = track.limit_m_per_s * tick_s * static_cast<double>(vehicle.ready_ds - now_ds_);
            track.leader = before;
            track.street = {reach_m + away_m, track.limit_m_per_s};
            change_lane(track, emptiest(streets.lanes_in_reach(junction_)[movement]));
            // Whoever should have been let in by now stands at the edge of a full reach.
            const bool held = away_m < -held_s * track.limit_m_per_s;
            track.line = held ? Bound{reach_m, 0.0} : track.street;
            before = vehicle.seed;
        }
    }
}

/// Sideways, towards the middle of a lane of its movement.
void Places::change_lane(Track &track, std::size_t lane) const {
    const double away = across_[track.place.movement][lane] - track.place.across;
    track.place.across += std::clamp(away, -across_per_s * tick_s, across_per_s * tick_s);
}

/// Whoever the street no longer has is across.
void Places::see_crossed() {
    std::vector<std::uint64_t> away;
    for (auto &[id, track] : tracks_) {
        if (track.seen_ds != now_ds_) {
            std::uint64_t &last = gone_[track.place.movement][track.lane];
            if (!track.crossed) {
                track.leader = last;
                last = id;
            }
            track.crossed = true;
            away.push_back(id);
        } else if (track.leader == 0 && track.line.front_m <= 0.0) {
            track.leader = gone_[track.place.movement][track.lane];
        }
    }
    std::sort(away.begin(), away.end(), [this](std::uint64_t a, std::uint64_t b) {
        return tracks_.at(a).place.front_m < tracks_.at(b).place.front_m;
    });
    order_.insert(order_.begin(), away.begin(), away.end());
}

/// One tick. A queue keeps to Newell's rule: each is where the one before it was a wave ago, a vehicle's room behind.
void Places::move(Track &track) {
    std::vector<Bound> bounds;
    if (!track.crossed) {
        bounds = {track.street, track.line};
    }
    const auto leader = tracks_.find(track.leader);
    if (leader != tracks_.end()) {
        const Track &before = leader->second;
        const double there_m = track.queued ? before.before_m[slot(now_ds_ + 1)] : before.place.front_m;
        bounds.push_back({there_m + vehicle_m, before.place.speed_m_per_s});
    }
    double &front_m = track.place.front_m;
    double least_m = -unplaced_m;
    double speed = std::min(track.place.speed_m_per_s + starting_m_per_s2 * tick_s,
                            track.queued && !track.crossed ? track.leaving_m_per_s : track.limit_m_per_s);
    for (const Bound &bound : bounds) {
        const double gap_m = std::max(0.0, front_m - bound.front_m);
        speed = std::min(speed, std::sqrt(bound.speed_m_per_s * bound.speed_m_per_s + 2.0 * braking_m_per_s2 * gap_m));
        least_m = std::max(least_m, bound.front_m);
    }
    if (front_m == unplaced_m) {
        front_m = least_m;
        track.before_m.fill(front_m);
        return;
    }
    const double next_m = std::min(front_m, std::max(least_m, front_m - speed * tick_s));
    const double drove_m_per_s = (front_m - next_m) / tick_s;
    track.place.braking = drove_m_per_s < track.place.speed_m_per_s - 0.05 || drove_m_per_s < 0.3;
    track.place.speed_m_per_s = drove_m_per_s;
    track.queued = track.queued || (!track.crossed && drove_m_per_s < queued_m_per_s);
    track.before_m[slot(now_ds_)] = front_m;
    front_m = next_m;
}

std::vector<Place> Places::all() const {
    std::vector<Place> places;
    places.reserve(tracks_.size());
    for (const auto &[id, track] : tracks_) {
        places.push_back(track.place);
    }
    return places;
}

} // namespace elmopp
