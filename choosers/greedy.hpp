// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Greedy rules: weigh every stage by what is there now and show the heaviest. None plans a green, looks ahead or
/// remembers whom it has not served: that nobody waits for ever is the plan's work. Ties stay, then go to the lowest
/// stage.

#pragma once

#include "approaching.hpp"

#include <random>

namespace elmopp {

/// The stage that contains the longest queue a lane, and of several the one with most vehicles queued. Folklore; the
/// usual lower bar of studies of adaptive control.
struct LongestQueue {
    unsigned min_s;
    Approaching approaching{};

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);
};

/// The stage with most vehicles, waiting or on their way (the greedy rule that Alegre et al. and other studies of
/// learnt control call max wave).
struct MaxWave {
    unsigned min_s;

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);
};

/// Max wave that stays: it leaves for a stage with margin_veh more vehicles for each lane which that stage serves, or
/// for the best one when fewer than empty_veh a lane are left of its own.
struct MaxWaveHold {
    unsigned min_s;
    double margin_veh;
    double empty_veh;

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);
};

/// The naive urgency of ELMOPP, L exp(T/t_max - 1), in which the load of a movement that is green counts `weight` times
/// and without its e^-1. At max_s it leaves for the best other stage, as the naive rule does, if somebody is there.
struct ElmoppHold {
    unsigned min_s;
    unsigned max_s;
    double weight;

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);
};

/// Max pressure (P. Varaiya, Max pressure control of a network of signalized intersections, Transp. Res. C 36, 2013):
/// every interval_s the stage with the largest sum of saturation flow times (vehicles here less vehicles where they
/// go). Without a count of the roads behind, these are taken as empty.
struct MaxPressure {
    unsigned interval_s;
    const float *downstream_veh; ///< [movement], may be null

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);
};

/// Any stage, drawn anew every interval_s: the bottom of every table, and what the safety of the plan is tried with.
struct Random {
    unsigned interval_s;
    std::mt19937_64 generator;

    elmopp_stage_t choose(const elmopp_view_t &view, float *score);
};

} // namespace elmopp
