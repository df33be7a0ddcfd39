// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "streets.hpp"

#include "error.hpp"
#include "view.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace elmopp {
namespace {

constexpr std::int64_t gap_ds = 45;           ///< a left turn needs so much until the next opposing vehicle
constexpr double left_headway_ds = 25.0;      ///< the next one follows in the same gap
constexpr double whole = 1e-6;                ///< a float's 13.333333 lanes full of vehicles are 13
constexpr double outflow_unit_per_veh = 10.0; ///< of NeighbourOutflow

double headway_ds(const elmopp_movement_t &movement) {
    return ds_per_s * movement.lanes / static_cast<double>(movement.saturation_veh_per_s);
}

std::size_t storage_of(const elmopp_movement_t &movement) {
    return static_cast<std::size_t>(static_cast<double>(movement.capacity_veh) / movement.lanes + whole);
}

/// True if the head of a lane goes first: left turns from opposite sides pass before each other, and whoever is behind
/// one that waits is held up by it.
bool crosses(const std::vector<Way> &ways, const LaneQueue &lane) {
    return ways[lane.vehicles().front().way].gives_way.empty();
}

/// The way that a seed decides for.
std::size_t way_of(const ArmPlan &arm, std::uint64_t seed) {
    double left = SplitMix64(seed).uniform();
    std::size_t last = 0;
    for (std::size_t w = 0; w < arm.ways.size(); ++w) {
        if (arm.ways[w].share > 0.0) {
            last = w;
            if (left < arm.ways[w].share) {
                break;
            }
            left -= arm.ways[w].share;
        }
    }
    return last; // rounding may leave a rest beyond the last
}

/// What it decides with at the next junction.
std::uint64_t seed_after(std::uint64_t seed) {
    return SplitMix64(seed).next();
}

/// Road lanes by movement. A movement whose lanes are as long as the reach has road lanes of its own, as many; a bay
/// (shorter) hangs on its neighbour's nearest.
std::vector<std::vector<std::size_t>> road_lanes(const elmopp_junction_t &site, std::size_t approach) {
    const auto full_veh = static_cast<std::size_t>(static_cast<double>(site.reach_m) / vehicle_m + whole);
    std::vector<std::vector<std::size_t>> choice(site.movement_count);
    std::size_t count = 0;
    for (std::size_t j = 0; j < site.movement_count; ++j) {
        const elmopp_movement_t &movement = site.movement[j];
        const bool full = movement.approach == approach && storage_of(movement) >= full_veh;
        for (unsigned k = 0; full && k < movement.lanes; ++k) {
            choice[j].push_back(count);
            ++count;
        }
    }
    std::size_t before = 0;
    for (std::size_t j = 0; j < site.movement_count; ++j) {
        if (site.movement[j].approach != approach) {
            continue;
        }
        if (choice[j].empty()) {
            choice[j] = {std::min(before, count == 0 ? 0 : count - 1)};
        } else {
            before = choice[j].back();
        }
    }
    return choice;
}

/// The better place to drive in: the lane if it has room and fewer vehicles than the best until now (null: none).
LaneQueue *emptier(LaneQueue *best, LaneQueue &lane, std::int64_t now_ds) {
    const bool better = lane.has_room(now_ds) && (best == nullptr || lane.vehicles().size() < best->vehicles().size());
    return better ? &lane : best;
}

std::size_t lane_count(const std::vector<std::vector<std::size_t>> &choice) {
    std::size_t last = 0;
    for (const auto &lanes : choice) {
        last = lanes.empty() ? last : std::max(last, lanes.back());
    }
    return last + 1;
}

} // namespace

Streets::Streets(const StreetPlan &plan, std::vector<Comings> comings) : comings_(std::move(comings)) {
    for (std::size_t v = 0; v < plan.size(); ++v) {
        junctions_.push_back(build(plan[v], comings_[v]));
        counts_.emplace_back(plan[v].site->movement_count);
    }
    now_ds_ = begin_ds();
    const std::vector<std::uint32_t> closed(plan.size(), 0U);
    while (now_ds_ < 0) {
        tick(closed);
    }
    end_second();
}

Streets::Junction Streets::build(const JunctionPlan &plan, const Comings &comings) {
    const elmopp_junction_t &site = *plan.site;
    Junction junction;
    junction.site = &site;
    for (std::size_t i = 0; i < plan.arms.size(); ++i) {
        Arm arm;
        arm.plan = &plan.arms[i];
        arm.road_ds = elmopp::road_ds(site, *arm.plan);
        arm.reach_ds = elmopp::reach_ds(site, *arm.plan);
        arm.choice = road_lanes(site, i);
        const double road_m = arm.plan->length_m - static_cast<double>(site.reach_m);
        arm.road.assign(lane_count(arm.choice), LaneQueue(static_cast<std::size_t>(road_m / vehicle_m + whole)));
        arm.outside.resize(arm.road.size());
        arm.comings = &comings[i];
        // Who came to the reach before second 0 is nobody's business.
        const auto first = std::find_if(comings[i].begin(), comings[i].end(),
                                        [](const Coming &coming) { return coming.edge_ds >= 0; });
        arm.next_coming = static_cast<std::size_t>(first - comings[i].begin());
        junction.arms.push_back(std::move(arm));
    }
    for (std::size_t j = 0; j < site.movement_count; ++j) {
        junction.lanes.emplace_back(site.movement[j].lanes, LaneQueue(storage_of(site.movement[j])));
    }
    return junction;
}

std::int64_t Streets::begin_ds() const {
    std::int64_t longest_ds = 0;
    for (const auto &junction : junctions_) {
        for (const auto &arm : junction.arms) {
            longest_ds = std::max(longest_ds, arm.road_ds);
        }
    }
    return -longest_ds;
}

void Streets::begin_second() {
    for (auto &counts : counts_) {
        std::fill(counts.arrived_veh_.begin(), counts.arrived_veh_.end(), 0.0);
        std::fill(counts.left_veh_.begin(), counts.left_veh_.end(), 0.0);
    }
}

void Streets::tick(const std::vector<std::uint32_t> &open) {
    for (std::size_t v = 0; v < junctions_.size(); ++v) {
        this->open(junctions_[v], open[v]);
        cross(v);
    }
    for (std::size_t v = 0; v < junctions_.size(); ++v) {
        for (auto &arm : junctions_[v].arms) {
            reach(v, arm);
            come(arm);
        }
    }
    ++now_ds_;
}

/// Who waits when a movement opens starts late.
void Streets::open(Junction &junction, std::uint32_t open) const {
    const std::uint32_t opening = open & ~junction.open;
    junction.open = open;
    for (std::uint32_t j = 0; j < junction.site->movement_count; ++j) {
        const elmopp_movement_t &movement = junction.site->movement[j];
        for (auto &lane : junction.lanes[j]) {
            if (elmopp_mask_has(opening, j) && lane.is_ready(now_ds_)) {
                const double first_ds = static_cast<double>(now_ds_ + movement.startup_ds) + headway_ds(movement);
                lane.next_ds = std::max(lane.next_ds, first_ds);
            }
        }
    }
}

void Streets::cross(std::size_t junction) {
    for (std::size_t j = 0; j < junctions_[junction].lanes.size(); ++j) {
        for (auto &lane : junctions_[junction].lanes[j]) {
            cross_from(junction, j, lane);
        }
    }
}

void Streets::cross_from(std::size_t junction, std::size_t movement, LaneQueue &lane) {
    const Junction &here = junctions_[junction];
    if (!lane.is_ready(now_ds_)) {
        return;
    }
    const Vehicle vehicle = lane.vehicles().front();
    const elmopp_movement_t &site = here.site->movement[movement];
    const Way &way = here.arms[site.approach].plan->ways[vehicle.way];
    if (!may_go(here, movement, lane, way) || !move_on(vehicle, way)) {
        return;
    }
    lane.leave(now_ds_);
    lane.in_the_box = false;
    const double apart_ds = way.gives_way.empty() ? headway_ds(site) : std::max(headway_ds(site), left_headway_ds);
    // On time within this tick: the next one follows from then, so that fractions of a tick do not add up.
    const auto now = static_cast<double>(now_ds_);
    lane.next_ds = (lane.next_ds > now - 1.0 ? lane.next_ds : now) + apart_ds;
    counts_[junction].left_veh_[movement] += 1.0;
    delay_veh_ds_ += static_cast<double>(now_ds_ - vehicle.due_ds);
    longest_wait_ds_ = std::max(longest_wait_ds_, now_ds_ - vehicle.due_ds);
}

bool Streets::may_go(const Junction &junction, std::size_t movement, LaneQueue &lane, const Way &way) const {
    const bool open = elmopp_mask_has(junction.open, static_cast<std::uint32_t>(movement));
    if (lane.next_ds > static_cast<double>(now_ds_) || !(open || lane.in_the_box)) {
        return false;
    }
    for (const std::size_t foe : way.gives_way) {
        const bool foe_open = elmopp_mask_has(junction.open, static_cast<std::uint32_t>(foe));
        const auto &ways = junction.arms[junction.site->movement[foe].approach].plan->ways;
        for (const auto &other : junction.lanes[foe]) {
            if (foe_open && other.is_ready(now_ds_ + gap_ds) && crosses(ways, other)) {
                lane.in_the_box = true; // it waits for the gap inside the junction and clears at the end
                return false;
            }
        }
    }
    return true;
}

/// Onto the next arm, if there is room, or out of the plan.
bool Streets::move_on(const Vehicle &vehicle, const Way &way) {
    if (!way.to) {
        ++total_out_veh_;
        return true;
    }
    Arm &arm = junctions_[way.to->junction].arms[way.to->approach];
    const std::size_t next = way_of(*arm.plan, vehicle.seed);
    LaneQueue *best = nullptr;
    for (const std::size_t k : arm.choice[arm.plan->ways[next].movement]) {
        best = emptier(best, arm.road[k], now_ds_);
    }
    if (best == nullptr) {
        return false;
    }
    const std::int64_t edge_ds = now_ds_ + arm.road_ds;
    best->enter({edge_ds + arm.reach_ds, edge_ds, seed_after(vehicle.seed), next}, now_ds_);
    arm.announced_ds.push_back(edge_ds);
    return true;
}

/// From the road into the lanes of the reach.
void Streets::reach(std::size_t junction, Arm &arm) {
    for (auto &road : arm.road) {
        if (!road.is_ready(now_ds_)) {
            continue;
        }
        Vehicle vehicle = road.vehicles().front();
        const std::size_t movement = arm.plan->ways[vehicle.way].movement;
        LaneQueue *best = nullptr;
        for (auto &lane : junctions_[junction].lanes[movement]) {
            best = emptier(best, lane, now_ds_);
        }
        if (best != nullptr) {
            road.leave(now_ds_);
            vehicle.ready_ds = now_ds_ + arm.reach_ds;
            best->enter(vehicle, now_ds_);
            counts_[junction].arrived_veh_[movement] += 1.0;
        }
    }
}

/// From outside onto the road.
void Streets::come(Arm &arm) {
    while (arm.next_coming < arm.comings->size() && (*arm.comings)[arm.next_coming].edge_ds - arm.road_ds <= now_ds_) {
        const Coming &coming = (*arm.comings)[arm.next_coming];
        const std::size_t way = way_of(*arm.plan, coming.seed);
        const auto &lanes = arm.choice[arm.plan->ways[way].movement];
        const auto shorter = [&arm](std::size_t a, std::size_t b) {
            return arm.outside[a].size() + arm.road[a].vehicles().size() <
                   arm.outside[b].size() + arm.road[b].vehicles().size();
        };
        const std::size_t lane = *std::min_element(lanes.begin(), lanes.end(), shorter);
        arm.outside[lane].push_back({coming.edge_ds + arm.reach_ds, 0, seed_after(coming.seed), way});
        ++arm.next_coming;
        ++total_in_veh_;
    }
    for (std::size_t k = 0; k < arm.road.size(); ++k) {
        if (!arm.outside[k].empty() && arm.road[k].has_room(now_ds_)) {
            Vehicle vehicle = arm.outside[k].front();
            arm.outside[k].pop_front();
            vehicle.ready_ds = now_ds_ + arm.road_ds;
            arm.road[k].enter(vehicle, now_ds_);
        }
    }
}

void Streets::end_second() {
    for (std::size_t v = 0; v < junctions_.size(); ++v) {
        const Junction &junction = junctions_[v];
        JunctionCounts &counts = counts_[v];
        counts.junction_occupied_ = is_occupied(v);
        std::fill(counts.outside_veh_.begin(), counts.outside_veh_.end(), 0.0);
        for (std::size_t j = 0; j < junction.lanes.size(); ++j) {
            std::size_t there = 0;
            for (const auto &lane : junction.lanes[j]) {
                there += lane.vehicles().size();
            }
            counts.queue_veh_[j] = static_cast<double>(there);
        }
        for (const auto &arm : junction.arms) {
            for (const auto &queue : arm.outside) {
                for (const auto &vehicle : queue) {
                    counts.outside_veh_[arm.plan->ways[vehicle.way].movement] += 1.0;
                }
            }
        }
    }
    for (auto &junction : junctions_) {
        for (auto &arm : junction.arms) {
            while (!arm.announced_ds.empty() && arm.announced_ds.front() < now_ds_) {
                arm.announced_ds.pop_front();
            }
        }
    }
}

template <typename Visit> void Streets::for_queues(const Visit &visit) const {
    for (const auto &junction : junctions_) {
        for (const auto &lanes : junction.lanes) {
            for (const auto &lane : lanes) {
                visit(lane.vehicles(), true);
            }
        }
        for (const auto &arm : junction.arms) {
            for (const auto &lane : arm.road) {
                visit(lane.vehicles(), true);
            }
            for (const auto &queue : arm.outside) {
                visit(queue, false);
            }
        }
    }
}

std::size_t Streets::late_veh(std::size_t junction, std::size_t movement) const {
    std::size_t late = 0;
    for (const auto &lane : junctions_[junction].lanes[movement]) {
        for (const auto &vehicle : lane.vehicles()) {
            late += vehicle.due_ds < now_ds_ ? 1U : 0U;
        }
    }
    return late;
}

std::vector<float> Streets::downstream_veh(std::size_t junction) const {
    const Junction &here = junctions_[junction];
    std::vector<double> sum(here.lanes.size());
    std::vector<double> share(here.lanes.size());
    for (const auto &arm : here.arms) {
        for (const auto &way : arm.plan->ways) {
            share[way.movement] += way.share;
            if (!way.to) {
                continue;
            }
            const ArmId to = *way.to;
            const Junction &there = junctions_[to.junction];
            std::size_t count = 0;
            for (const auto &lane : there.arms[to.approach].road) {
                count += lane.vehicles().size();
            }
            for (std::size_t j = 0; j < there.lanes.size(); ++j) {
                for (const auto &lane : there.lanes[j]) {
                    count += there.site->movement[j].approach == to.approach ? lane.vehicles().size() : 0U;
                }
            }
            sum[way.movement] += way.share * static_cast<double>(count);
        }
    }
    std::vector<float> mean(sum.size());
    for (std::size_t j = 0; j < mean.size(); ++j) {
        mean[j] = share[j] > 0.0 ? static_cast<float>(sum[j] / share[j]) : 0.0F;
    }
    return mean;
}

Outflow Streets::outflow_to(ArmId arm) const {
    const auto within = [&](std::int64_t ahead_ds) {
        const auto &due_ds = junctions_[arm.junction].arms[arm.approach].announced_ds;
        const auto count = std::count_if(due_ds.begin(), due_ds.end(),
                                         [&](std::int64_t edge_ds) { return edge_ds < now_ds_ + ahead_ds; });
        return static_cast<unsigned>(outflow_unit_per_veh * static_cast<double>(count));
    };
    return {within(100), within(300), within(600)};
}

bool Streets::is_occupied(std::size_t junction) const {
    for (const auto &lanes : junctions_[junction].lanes) {
        if (std::any_of(lanes.begin(), lanes.end(), [](const LaneQueue &lane) { return lane.in_the_box; })) {
            return true;
        }
    }
    return false;
}

std::size_t Streets::inside_veh() const {
    std::size_t count = 0;
    for_queues([&count](const std::deque<Vehicle> &queue, bool inside) { count += inside ? queue.size() : 0U; });
    return count;
}

std::size_t Streets::outside_veh() const {
    std::size_t count = 0;
    for_queues([&count](const std::deque<Vehicle> &queue, bool inside) { count += inside ? 0U : queue.size(); });
    return count;
}

double Streets::delay_veh_s() const {
    double delay_ds = delay_veh_ds_;
    for_queues([&](const std::deque<Vehicle> &queue, bool /*inside*/) {
        for (const auto &vehicle : queue) {
            delay_ds += static_cast<double>(std::max<std::int64_t>(0, now_ds_ - vehicle.due_ds));
        }
    });
    return delay_ds / ds_per_s;
}

double Streets::longest_wait_s() const {
    std::int64_t longest_ds = longest_wait_ds_;
    for_queues([&](const std::deque<Vehicle> &queue, bool /*inside*/) {
        for (const auto &vehicle : queue) {
            longest_ds = std::max(longest_ds, now_ds_ - vehicle.due_ds);
        }
    });
    return static_cast<double>(longest_ds) / ds_per_s;
}

void Streets::check_conservation() const {
    const std::size_t there = total_out_veh_ + inside_veh() + outside_veh();
    if (total_in_veh_ != there) {
        throw Failure("conservation: " + std::to_string(total_in_veh_) + " vehicles came, " + std::to_string(there) +
                      " are accounted for; right would be as many");
    }
}

} // namespace elmopp
