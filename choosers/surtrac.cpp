// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "surtrac.hpp"

#include "view.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace elmopp {
namespace {

constexpr std::size_t phases_max = 8;
constexpr std::size_t clusters_max = 8; ///< of a phase, however few phases there are
constexpr std::size_t states_max = 6000;
constexpr double no_cluster_veh = 1e-6;

/// A cluster that is still growing.
struct Growing {
    std::array<double, ELMOPP_MOVEMENT_MAX> vehicles{};
    double arrival_s = 0.0;
    double last_s = 0.0; ///< arrival of the last one
};

Surtrac::Cluster finished(const elmopp_view_t &view, const Growing &growing) {
    Surtrac::Cluster cluster{growing.arrival_s, 0.0, 0.0, 0.0};
    for (std::size_t j = 0; j < view.junction->movement_count; ++j) {
        if (growing.vehicles[j] > 0.0) {
            cluster.length_s = std::max(cluster.length_s, growing.vehicles[j] / present_flow_veh_per_s(view, j));
        }
        cluster.vehicles += growing.vehicles[j];
    }
    cluster.departure_s = std::max(growing.last_s + 1.0, growing.arrival_s + cluster.length_s);
    return cluster;
}

/// Seconds until a change of stage lets the first vehicle of a phase go; 0 to stay.
double setup_s(const elmopp_junction_t &junction, elmopp_stage_t from, elmopp_stage_t to) {
    return from == to ? 0.0 : switch_s(junction, from, to);
}

/// As many clusters a phase as the number of states allows.
std::size_t clusters_allowed(std::size_t phases) {
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
void merge_down_to(std::vector<Surtrac::Cluster> &clusters, std::size_t count) {
    while (clusters.size() > count) {
        const Surtrac::Cluster last = clusters.back();
        clusters.pop_back();
        auto &into = clusters.back();
        into.length_s += last.length_s;
        into.vehicles += last.vehicles;
        into.departure_s = std::max(into.departure_s, last.departure_s);
    }
}

double vehicles_of(const SurtracPhase &phase) {
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
    Schedule(const elmopp_junction_t &junction, elmopp_stage_t present, const std::vector<SurtracPhase> &phases,
             bool leave)
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

    /// The phase of the first cluster of the cheapest schedule.
    std::size_t first() {
        for (std::size_t code = 0; code < codes_; ++code) {
            decode(code);
            for (std::size_t last = 0; last < stages_.size(); ++last) {
                if (best_[code * stages_.size() + last].cost_veh_s < std::numeric_limits<double>::infinity()) {
                    extend(code, last);
                }
            }
        }
        const auto end = best_.end();
        return std::min_element(end - static_cast<std::ptrdiff_t>(stages_.size()), end,
                                [](const Best &a, const Best &b) { return a.cost_veh_s < b.cost_veh_s; })
            ->first;
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
            const double cost = from.cost_veh_s + cluster.vehicles * (start_s - cluster.arrival_s);
            Best &to = best_[(code + radix_[p]) * stages_.size() + p];
            if (cost < to.cost_veh_s || (cost == to.cost_veh_s && finish_s < to.finish_s)) {
                to = {cost, finish_s, begins ? p : from.first};
            }
        }
    }

    const elmopp_junction_t &junction_;
    const std::vector<SurtracPhase> &phases_;
    bool leave_;
    std::vector<std::size_t> done_;
    std::vector<std::size_t> radix_;
    std::vector<elmopp_stage_t> stages_;
    std::vector<double> setup_s_;
    std::vector<Best> best_;
    std::size_t codes_ = 1;
};

} // namespace

elmopp_stage_t first_of_schedule(const elmopp_junction_t &junction, elmopp_stage_t present,
                                 const std::vector<SurtracPhase> &phases, bool leave) {
    std::vector<SurtracPhase> busy;
    busy.reserve(phases.size());
    std::copy_if(phases.begin(), phases.end(), std::back_inserter(busy),
                 [](const SurtracPhase &phase) { return !phase.clusters.empty(); });
    if (busy.empty()) {
        return ELMOPP_STAGE_NONE;
    }
    std::stable_sort(busy.begin(), busy.end(), [present](const SurtracPhase &a, const SurtracPhase &b) {
        return (a.stage == present) != (b.stage == present) ? a.stage == present : vehicles_of(a) > vehicles_of(b);
    });
    busy.erase(busy.begin() + static_cast<std::ptrdiff_t>(std::min(busy.size(), phases_max)), busy.end());
    const std::size_t allowed = clusters_allowed(busy.size());
    for (auto &phase : busy) {
        merge_down_to(phase.clusters, allowed);
    }
    const bool other = busy.size() > 1 || busy.front().stage != present;
    return busy[Schedule(junction, present, busy, leave && other).first()].stage;
}

void Surtrac::prepare(const elmopp_junction_t &junction) {
    if (cycle.size() > 0) {
        return;
    }
    cycle.prepare(junction);
    movements.reserve(cycle.size());
    std::uint32_t taken = 0;
    for (std::size_t i = 0; i < cycle.size(); ++i) {
        const std::uint32_t served = served_by(junction, cycle.stage(i));
        movements.push_back(served & ~taken);
        taken |= served;
    }
}

std::vector<Surtrac::Cluster> Surtrac::clusters_of(const elmopp_view_t &view, std::size_t phase) const {
    std::vector<Cluster> clusters;
    Growing growing;
    const auto finish = [&] {
        const Cluster cluster = finished(view, growing);
        if (cluster.vehicles > no_cluster_veh) {
            clusters.push_back(cluster);
        }
        growing = {};
    };
    for (std::uint32_t j = 0; j < view.junction->movement_count; ++j) {
        growing.vehicles[j] = elmopp_mask_has(movements[phase], j) ? approaching.queued_veh(j) : 0.0;
    }
    for (unsigned second = 0; second < approaching.travel_s(); ++second) {
        for (std::uint32_t j = 0; j < view.junction->movement_count; ++j) {
            const double due_veh = elmopp_mask_has(movements[phase], j) ? approaching.due_veh(j, second) : 0.0;
            if (due_veh <= 0.0) {
                continue;
            }
            const double arrival_s = second + 1.0;
            const Cluster so_far = finished(view, growing);
            if (so_far.vehicles <= no_cluster_veh || arrival_s - so_far.departure_s >= gap_s) {
                finish();
                growing.arrival_s = arrival_s;
            }
            growing.vehicles[j] += due_veh;
            growing.last_s = arrival_s;
        }
    }
    finish();
    return clusters;
}

elmopp_stage_t Surtrac::choose(const elmopp_view_t &view, float *score) {
    prepare(*view.junction);
    approaching.observe(view);
    for (std::size_t s = 0; s < view.junction->stage_count; ++s) {
        for_served(view, s, [&](std::size_t j) { score[s] += view.queue_veh[j]; });
    }
    if (!is_free(view, min_s)) {
        return view.target;
    }
    std::vector<SurtracPhase> phases;
    phases.reserve(cycle.size());
    for (std::size_t i = 0; i < cycle.size(); ++i) {
        phases.push_back({cycle.stage(i), clusters_of(view, i)});
    }
    const bool leave = view.stage != ELMOPP_STAGE_NONE && elapsed_s(view) >= max_s;
    const elmopp_stage_t first = first_of_schedule(*view.junction, view.stage, phases, leave);
    const bool begin = view.target == ELMOPP_STAGE_NONE;
    return first != ELMOPP_STAGE_NONE ? first : begin ? cycle.stage(0) : view.target;
}

} // namespace elmopp
