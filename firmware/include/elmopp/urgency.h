/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Urgency: ELMOPP's own chooser, naive and cumulative (the paper's Algorithm 1 and its equations U_t, Uc and k_t).
///
/// The urgency of a stage is the sum over the movements it serves. Naive: load times an exponential of the time since
/// green. Cumulative: the same, averaged over the next t_max seconds with a triangular kernel, with the foreseen inflow
/// in the load. A hold window keeps the stage for at least min_s and at most max_s seconds; in between it leaves for
/// the best other stage when that one is strictly more urgent. Ties go to the lowest index. Errata of the paper:
/// docs/algorithm.md.
///
/// It knows no lamp and no clearance. Its state is bounded and needs no allocation. Not thread-safe; one owner.

#ifndef ELMOPP_URGENCY_H
#define ELMOPP_URGENCY_H

#include "elmopp/chooser.h"

/// What can be varied. All false, hysteresis 1: the algorithm as adopted.
typedef struct {
    uint16_t min_s; ///< a stage is never left before
    uint16_t max_s; ///< ... and always left at; also t_max of the exponential and of the kernel, 1..ELMOPP_HORIZON_MAX
    float hysteresis;  ///< h >= 1: another stage must exceed h times the active one
    bool cumulative;   ///< sum over the forecast instead of now only
    bool frozen;       ///< compare with the urgency that the active stage had when it was chosen (the paper's prose)
    bool constant_age; ///< T does not grow inside the cumulative sum
    bool printed_sign; ///< exp(1 - T/t_max) as printed, which starves
    bool stage_age;    ///< T per stage (the paper's LENCONF) instead of per movement (its eq. 2)
    bool windowless;   ///< Algorithm 1 as printed: the best stage of every second; the active one stays while it ties
} elmopp_urgency_options_t;

/// State of one chooser. Set up by elmopp_urgency_init(); nobody else writes it.
typedef struct {
    elmopp_urgency_options_t options;
    float weight_red[ELMOPP_HORIZON_MAX + 1U];   ///< k_t e^(t/t_max): a red movement, whose T grows
    float weight_green[ELMOPP_HORIZON_MAX + 1U]; ///< k_t: a green movement, whose T stays
    elmopp_stage_t chosen;                       ///< the active stage as this chooser knows it
    float chosen_score; ///< its urgency in the second that chose it, or that found it if a maximum green brought it up
    uint16_t stage_age_s[ELMOPP_STAGE_MAX]; ///< seconds since each stage was active
} elmopp_urgency_t;

/// Prepares the state and returns the chooser that uses it. Asserts 1 <= min_s <= max_s <= ELMOPP_HORIZON_MAX,
/// hysteresis >= 1.
elmopp_chooser_t elmopp_urgency_init(elmopp_urgency_t *self, const elmopp_urgency_options_t *options);

/// U = L exp(T/t_max - 1) of one movement (eq. U_t with the sign that the text means; docs/algorithm.md).
float elmopp_urgency_naive(const elmopp_urgency_t *self, float load, uint16_t red_ds);

/// One movement as the cumulative sum sees it.
typedef struct {
    float queue_veh;           ///< Q
    float capacity_veh;        ///< C; 0: its urgency is 0
    const float *foreseen_veh; ///< [step] vehicles a second of its approach; null if steps is 0
    uint16_t steps;
    float share;     ///< of its approach's vehicles
    uint16_t red_ds; ///< T now
    bool going;      ///< green now: T stays as it is instead of growing
} elmopp_urgency_lane_t;

/// Uc of one movement: sum over t = 0..t_max of k_t min(Q + inflow until t, C)/C exp(T(t)/t_max - 1), with T(t) = T + t
/// on red.
float elmopp_urgency_cumulative(const elmopp_urgency_t *self, const elmopp_urgency_lane_t *lane);

#endif
