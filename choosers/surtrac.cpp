// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "surtrac.hpp"

#include "cycle.hpp"
#include "view.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace elmopp {
namespace {

constexpr std::size_t phases_max = 8;
constexpr std::size_t clusters_max = 8; ///< of a phase, however few phases there are
constexpr std::size_t all_states_max = 6000;
constexpr unsigned pieces = 3; ///< of the mean flow until the horizon
constexpr double no_cluster_veh = 1e-6;

/// A cluster that is still growing.
struct Growing {
    std::array<double, ELMOPP_MOVEMENT_MAX> vehicles{};
    double arrival_s = 0.0;
    double last_s = 0.0; ///< arrival of the last one
};

/// The cluster as one.
Cluster whole(const elmopp_view_t &view, const Growing &growing) {
    Cluster cluster{growing.arrival_s, 0.0, 0.0, 0.0, 0.0};
    for (std::size_t j = 0; j < view.junction->movement_count; ++j) {
        cluster.length_s = std::max(cluster.length_s, growing.vehicles[j] / present_flow_veh_per_s(view, j));
        cluster.vehicles += growing.vehicles[j];
    }
    cluster.departure_s = std::max(growing.last_s + 1.0, growing.arrival_s + cluster.length_s);
    return cluster;
}

/// The cluster cut where one of its movements is done, into parts that are no shorter than least_s: as long as all flow
/// it is worth more.
void add_parts(const elmopp_view_t &view, const Growing &growing, double least_s, std::vector<Cluster> &clusters) {
    const Cluster all = whole(view, growing);
    std::vector<double> ends_s{all.length_s};
    ends_s.reserve(view.junction->movement_count + std::size_t{1});
    for (std::size_t j = 0; j < view.junction->movement_count; ++j) {
        ends_s.push_back(growing.vehicles[j] / present_flow_veh_per_s(view, j));
    }
    std::sort(ends_s.begin(), ends_s.end());
    double from_s = 0.0;
    for (const double to_s : ends_s) {
        const bool last = to_s >= all.length_s;
        if (to_s <= from_s || (!last && (to_s - from_s < least_s || all.length_s - to_s < least_s))) {
            continue;
        }
        Cluster part{all.arrival_s, last ? all.departure_s : all.arrival_s + to_s, to_s - from_s, 0.0, 0.0};
        for (std::size_t j = 0; j < view.junction->movement_count; ++j) {
            const double flow = present_flow_veh_per_s(view, j);
            part.vehicles += std::min(growing.vehicles[j], flow * to_s) - std::min(growing.vehicles[j], flow * from_s);
        }
        clusters.push_back(part);
        from_s = to_s;
    }
}

/// Seconds until a change of stage lets the first vehicle of a phase go; 0 to stay.
double setup_s(const elmopp_junction_t &junction, elmopp_stage_t from, elmopp_stage_t to) {
    return from == to ? 0.0 : switch_s(junction, from, to);
}

/// As many clusters a phase as the number of states allows.
std::size_t clusters_allowed(std::size_t phases, std::size_t states_max) {
    const auto states = [phases](std::size_t clusters) {
        std::size_t count = phases + 1;
        for (std::size_t p = 0; p < phases; ++p) {
            count *= clusters + 1;
        }
        return count;
    };
    std::size_t allowed = 1;
    while (allowed < clusters_max && states(allowed + 1) <= states_max) {
        ++allowed;
    }
    return allowed;
}

/// The last ones become one.
void merge_down_to(std::vector<Cluster> &clusters, std::size_t count) {
    while (clusters.size() > count) {
        const Cluster last = clusters.back();
        clusters.pop_back();
        auto &into = clusters.back();
        into.length_s += last.length_s;
        into.spread_s = std::max(into.spread_s, last.arrival_s + last.spread_s - into.arrival_s);
        into.vehicles += last.vehicles;
        into.departure_s = std::max(into.departure_s, last.departure_s);
    }
}

/// Wait of a vehicle of a cluster that begins so late, on average.
double mean_wait_s(const Cluster &cluster, double start_s) {
    const double late_s = start_s - cluster.arrival_s;
    if (late_s >= cluster.spread_s) {
        return late_s - cluster.spread_s / 2.0;
    }
    return late_s * late_s / (2.0 * cluster.spread_s);
}

double vehicles_of(const Phase &phase) {
    double vehicles = 0.0;
    for (const auto &cluster : phase.clusters) {
        vehicles += cluster.vehicles;
    }
    return vehicles;
}

/// The way to a state that has cost least.
struct Best {
    double cost_veh_s = std::numeric_limits<double>::infinity();
    double finish_s = 0.0;
    std::size_t first = 0; ///< phase of the first cluster
};

/// The dynamic programme: a state is how many clusters of each phase are done and which phase was last.
class Schedule {
  public:
    Schedule(const elmopp_junction_t &junction, elmopp_stage_t present, const Phases &phases, bool leave)
        : junction_(junction), phases_(phases), leave_(leave), done_(phases.size()) {
        stages_.reserve(phases.size() + 1);
        std::size_t codes = 1;
        for (const auto &phase : phases) {
            radix_.push_back(codes);
            codes *= phase.clusters.size() + 1;
            stages_.push_back(phase.stage);
        }
        stages_.push_back(present); // the last "phase": nothing has been done yet
        fill_setups();
        best_.resize(codes * stages_.size());
        best_[phases_.size()].cost_veh_s = 0.0;
        codes_ = codes;
    }

    /// The stage of the first cluster of the cheapest schedule.
    FirstStep first() {
        for (std::size_t code = 0; code < codes_; ++code) {
            decode(code);
            for (std::size_t last = 0; last < stages_.size(); ++last) {
                if (best_[code * stages_.size() + last].cost_veh_s < std::numeric_limits<double>::infinity()) {
                    extend(code, last);
                }
            }
        }
        const auto cheapest =
            std::min_element(best_.end() - static_cast<std::ptrdiff_t>(stages_.size()), best_.end(),
                             [](const Best &a, const Best &b) { return a.cost_veh_s < b.cost_veh_s; });
        return {stages_[cheapest->first], cheapest->cost_veh_s};
    }

  private:
    void fill_setups() {
        setup_s_.resize(stages_.size() * stages_.size());
        for (std::size_t from = 0; from < stages_.size(); ++from) {
            for (std::size_t to = 0; to < stages_.size(); ++to) {
                setup_s_[from * stages_.size() + to] = setup_s(junction_, stages_[from], stages_[to]);
            }
        }
    }

    void decode(std::size_t code) {
        for (std::size_t p = 0; p < phases_.size(); ++p) {
            done_[p] = code / radix_[p] % (phases_[p].clusters.size() + 1);
        }
    }

    void extend(std::size_t code, std::size_t last) {
        const Best from = best_[code * stages_.size() + last];
        const bool begins = last == phases_.size();
        for (std::size_t p = 0; p < phases_.size(); ++p) {
            const auto &clusters = phases_[p].clusters;
            const bool forbidden = begins && leave_ && stages_[p] == stages_[last];
            if (done_[p] == clusters.size() || forbidden) {
                continue;
            }
            const auto &cluster = clusters[done_[p]];
            const double ready_s = from.finish_s + setup_s_[last * stages_.size() + p];
            const double start_s = std::max(cluster.arrival_s, ready_s);
            const double finish_s = std::max(start_s + cluster.length_s, cluster.departure_s);
            const double cost = from.cost_veh_s + cluster.vehicles * mean_wait_s(cluster, start_s);
            Best &to = best_[(code + radix_[p]) * stages_.size() + p];
            if (cost < to.cost_veh_s || (cost == to.cost_veh_s && finish_s < to.finish_s)) {
                to = {cost, finish_s, begins ? p : from.first};
            }
        }
    }

    const elmopp_junction_t &junction_;
    const Phases &phases_;
    bool leave_;
    std::vector<std::size_t> done_;
    std::vector<std::size_t> radix_;
    std::vector<elmopp_stage_t> stages_;
    std::vector<double> setup_s_;
    std::vector<Best> best_;
    std::size_t codes_ = 1;
};

} // namespace

FirstStep first_of_schedule(const elmopp_junction_t &junction, elmopp_stage_t present, const Phases &phases, bool leave,
                            std::size_t states_max) {
    Phases busy;
    busy.reserve(phases.size());
    std::copy_if(phases.begin(), phases.end(), std::back_inserter(busy),
                 [](const Phase &phase) { return !phase.clusters.empty(); });
    if (busy.empty()) {
        return {ELMOPP_STAGE_NONE, 0.0};
    }
    std::stable_sort(busy.begin(), busy.end(), [present](const Phase &a, const Phase &b) {
        return (a.stage == present) != (b.stage == present) ? a.stage == present : vehicles_of(a) > vehicles_of(b);
    });
    busy.erase(busy.begin() + static_cast<std::ptrdiff_t>(std::min(busy.size(), phases_max)), busy.end());
    const std::size_t allowed = clusters_allowed(busy.size(), states_max);
    for (auto &phase : busy) {
        merge_down_to(phase.clusters, allowed);
    }
    const bool other = busy.size() > 1 || busy.front().stage != present;
    return Schedule(junction, present, busy, leave && other).first();
}

std::vector<Phases> ways_to_serve_all(const elmopp_junction_t &junction) {
    const auto cycles = smallest_cycles(junction);
    std::vector<Phases> ways;
    ways.reserve(cycles.size());
    for (const auto &stages : cycles) {
        Phases phases;
        phases.reserve(stages.size());
        std::uint32_t taken = 0;
        for (const elmopp_stage_t stage : stages) {
            const std::uint32_t served = served_by(junction, stage);
            phases.push_back({stage, served & ~taken});
            taken |= served;
        }
        ways.push_back(std::move(phases));
    }
    return ways;
}

std::vector<Cluster> Surtrac::clusters_of(const elmopp_view_t &view, std::uint32_t movements) const {
    std::vector<Cluster> clusters;
    Growing growing;
    const auto finish = [&] {
        if (whole(view, growing).vehicles > no_cluster_veh) {
            add_parts(view, growing, gap_s, clusters);
        }
        growing = {};
    };
    for (std::uint32_t j = 0; j < view.junction->movement_count; ++j) {
        growing.vehicles[j] = elmopp_mask_has(movements, j) ? approaching.queued_veh(j) : 0.0;
    }
    for (unsigned second = 0; second < approaching.longest_travel_s(); ++second) {
        for (std::uint32_t j = 0; j < view.junction->movement_count; ++j) {
            const double due_veh = elmopp_mask_has(movements, j) ? approaching.due_veh(j, second) : 0.0;
            if (due_veh <= 0.0) {
                continue;
            }
            const double arrival_s = second + 1.0;
            const Cluster so_far = whole(view, growing);
            if (so_far.vehicles <= no_cluster_veh || arrival_s - so_far.departure_s >= gap_s) {
                finish();
                growing.arrival_s = arrival_s;
            }
            growing.vehicles[j] += due_veh;
            growing.last_s = arrival_s;
        }
    }
    finish();
    add_mean_flow(view, movements, clusters);
    return clusters;
}

/// Who will come after those that are seen.
void Surtrac::add_mean_flow(const elmopp_view_t &view, std::uint32_t movements, std::vector<Cluster> &clusters) const {
    const double seen_s = approaching.longest_travel_s();
    const double piece_s = (horizon_s - seen_s) / pieces;
    for (unsigned i = 0; piece_s > 0.0 && i < pieces; ++i) {
        Cluster cluster{seen_s + i * piece_s, seen_s + (i + 1) * piece_s, 0.0, piece_s, 0.0};
        for (std::uint32_t j = 0; j < view.junction->movement_count; ++j) {
            const double coming_veh = elmopp_mask_has(movements, j) ? flow.veh_per_s(j) * piece_s : 0.0;
            cluster.vehicles += coming_veh;
            cluster.length_s = std::max(cluster.length_s, coming_veh / saturation_veh_per_s(*view.junction, j));
        }
        if (cluster.vehicles > no_cluster_veh) {
            clusters.push_back(cluster);
        }
    }
}

elmopp_stage_t Surtrac::choose(const elmopp_view_t &view, float *score) {
    if (ways.empty()) {
        ways = ways_to_serve_all(*view.junction);
    }
    approaching.observe(view);
    flow.observe(view);
    for (std::size_t s = 0; s < view.junction->stage_count; ++s) {
        for_served(view, s, [&](std::size_t j) { score[s] += view.queue_veh[j]; });
    }
    if (!is_free(view, min_s)) {
        return view.target;
    }
    const bool leave = view.stage != ELMOPP_STAGE_NONE && elapsed_s(view) >= max_s;
    FirstStep best{ELMOPP_STAGE_NONE, std::numeric_limits<double>::infinity()};
    for (auto &phases : ways) {
        for (auto &phase : phases) {
            phase.clusters = clusters_of(view, phase.movements);
        }
        const FirstStep step =
            first_of_schedule(*view.junction, view.stage, phases, leave, all_states_max / ways.size());
        best = step.stage != ELMOPP_STAGE_NONE && step.cost_veh_s < best.cost_veh_s ? step : best;
    }
    const elmopp_stage_t stay = view.target == ELMOPP_STAGE_NONE ? elmopp_stage_t{0} : view.target;
    return best.stage != ELMOPP_STAGE_NONE ? best.stage : stay;
}

} // namespace elmopp
