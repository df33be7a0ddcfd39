// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Surtrac: schedules the clusters of vehicles that are seen, and does what the best schedule does first.
///
/// The vehicles of each phase become clusters: the queue, then those on their way, merged where they follow within
/// gap_s then until horizon_s pieces of the mean flow of the last two minutes. A forward dynamic programme goes through
/// every order that keeps the clusters of a phase in turn. A cluster begins when it has come and the one before has
/// gone, after the change of stage if its phase is another; it costs its vehicles times their wait. Of all ways to have
/// the same clusters done with the same phase last, the cheapest is kept. The present stage stays as long as the best
/// schedule begins with one of its clusters, but not beyond max_s if others have some. The schedule is made anew every
/// second, so that a cluster can be left before it has gone.
///
/// Phases have to divide the movements among them. Where the stages can be combined in several ways to a smallest
/// cycle, each is scheduled and the cheapest schedule counts. The work is bounded: at most 8 ways, 8 phases, and so
/// many clusters a phase, the last ones merged, that all programmes together have 6,000 states at most.
///
/// Source: X.-F. Xie, S. Smith, L. Lu and G. Barlow, Schedule-driven intersection control, Transp. Res. C 24, 2012.
/// Reconstructed: what neighbours say that they will send is replaced by the mean flow, and the splitting of clusters
/// that are longer than a green is left out: deciding every second does it.

#pragma once

#include "approaching.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace elmopp {

/// Vehicles that go one behind the other.
struct Cluster {
    double arrival_s;
    double departure_s; ///< of the last one, if nothing held him
    double length_s;    ///< at saturation flow
    double spread_s;    ///< within which they come evenly; 0: they are there
    double vehicles;
};

/// One phase of a schedule.
struct Phase {
    elmopp_stage_t stage;
    std::uint32_t movements;         ///< mask of those that are its own
    std::vector<Cluster> clusters{}; ///< in turn
};

/// A way to serve every movement: phases that divide them among them.
using Phases = std::vector<Phase>;

/// The smallest sets of stages that serve every movement, at most 8 of them; a movement belongs to the first stage that
/// serves it.
std::vector<Phases> ways_to_serve_all(const elmopp_junction_t &junction);

/// What the cheapest schedule begins with.
struct FirstStep {
    elmopp_stage_t stage; ///< ELMOPP_STAGE_NONE if there is no cluster
    double cost_veh_s;    ///< of the whole schedule
};

/// `leave`: not with the present stage, if another has clusters. `states_max`: clusters are merged until so many will
/// do.
FirstStep first_of_schedule(const elmopp_junction_t &junction, elmopp_stage_t present, const Phases &phases, bool leave,
                            std::size_t states_max);

struct Surtrac {
    unsigned min_s;
    unsigned max_s;
    unsigned gap_s;
    unsigned horizon_s;
    Approaching approaching{};
    MeanFlow flow{120};
    std::vector<Phases> ways{}; ///< filled at the first call

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);

  private:
    [[nodiscard]] std::vector<Cluster> clusters_of(const elmopp_view_t &view, std::uint32_t movements) const;
    void add_mean_flow(const elmopp_view_t &view, std::uint32_t movements, std::vector<Cluster> &clusters) const;
};

} // namespace elmopp
