// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Surtrac: schedules the clusters of vehicles that are seen, and does what the best schedule does first.
///
/// The vehicles of each phase become clusters: the queue, then those on their way, merged where they follow within gap_s.
/// A forward dynamic programme goes through every order that keeps the clusters of a phase in turn. A cluster begins when
/// it has come and the one before has gone, after the change of stage if its phase is another; it costs its vehicles
/// times their wait. Of all ways to have the same clusters done with the same phase last, the cheapest is kept. The present
/// stage stays as long as the best schedule begins with one of its clusters, but not beyond max_s if others have some.
/// The schedule is made anew every second, so that a cluster can be left before it has gone. It counts nobody who is not
/// seen.
///
/// Phases are the stages of the covering cycle, each with the movements that no earlier one serves: a partition, which
/// the schedule needs. The work is bounded: at most 8 phases, and so many clusters a phase, the last ones merged, that there
/// are at most some 6,000 states.
///
/// Source: X.-F. Xie, S. Smith, L. Lu and G. Barlow, Schedule-driven intersection control, Transp. Res. C 24, 2012.
/// Reconstructed: the neighbours' outflow is left out (one junction), and so is the splitting of clusters that are
/// longer than a green: deciding every second does it.

#pragma once

#include "approaching.hpp"
#include "cycle.hpp"

#include <cstdint>
#include <vector>

namespace elmopp {

struct Surtrac {
    unsigned min_s;
    unsigned max_s;
    unsigned gap_s;
    Approaching approaching{};
    Cycle cycle{};
    std::vector<std::uint32_t> movements{}; ///< [phase] mask of its own ones

    /// Vehicles that go one behind the other.
    struct Cluster {
        double arrival_s;
        double departure_s; ///< of the last one, if nothing held him
        double length_s;    ///< at saturation flow
        double vehicles;
    };

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);

  private:
    void prepare(const elmopp_junction_t &junction);
    [[nodiscard]] std::vector<Cluster> clusters_of(const elmopp_view_t &view, std::size_t phase) const;
};

/// One phase of a schedule.
struct SurtracPhase {
    elmopp_stage_t stage;
    std::vector<Surtrac::Cluster> clusters; ///< in turn
};

/// The stage with which the cheapest schedule begins; ELMOPP_STAGE_NONE if there is no cluster. `leave`: not with the
/// present one, if another has clusters.
elmopp_stage_t first_of_schedule(const elmopp_junction_t &junction, elmopp_stage_t present,
                                 const std::vector<SurtracPhase> &phases, bool leave);

} // namespace elmopp
