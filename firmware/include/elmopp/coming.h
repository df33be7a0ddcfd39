/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Coming: who reaches each queue in each of the next seconds, for a chooser that plans ahead.
///
/// Who drives in the reach arrives when he must (sight.h). Who will come is foreseen: the mean of the arrivals at
/// mean_weight, m, and, as far as rows_s, m + w (r - m) with a forecast row's value r, each movement with its share. m
/// is half the mean, because who may come is not who will: counted in full he keeps greens for nobody. w is what the
/// rows have earned, and fades: accounts (account.h) of what they said 10 and 30 s ahead give their skill 1 - MSE of
/// the rows / MSE of the mean, never below 0; each row has that of the nearer one, times 1 - k / fade_s for the row of
/// k seconds later. So a forecast that knows nothing does no harm, and one that knows all counts in full at first; the
/// later a row, the more often will have been decided anew until then, even if it is right. Who is hidden behind a full
/// reach comes as fast as a queue can.
///
/// It decides nothing and knows neither stage nor lamp. A row below 0 or not a number says nobody; of an approach
/// without a row the mean is all that is expected, and on the account.
///
/// Its state is fixed memory of 21 kB, most of it the table of sums; its owner is the chooser. Not thread-safe.

#ifndef ELMOPP_COMING_H
#define ELMOPP_COMING_H

#include "elmopp/account.h"
#include "elmopp/chooser.h"
#include "elmopp/sight.h"

#define ELMOPP_COMING_NEAR_S 10U

/// What can be varied.
typedef struct {
    uint16_t horizon_s; ///< seconds in the table, 1 to ELMOPP_HORIZON_MAX
    uint16_t rows_s;    ///< foreseen rows are read so far; the mean, as it is weighted, follows
    bool weigh_skill;   ///< rows correct the mean as far as they have come true lately, the later the less
    uint16_t fade_s;    ///< ... and not at all so late; at least 1
    float row_weight;   ///< otherwise they stand for themselves, by this weight, 0 to 1
    float mean_weight;  ///< of the mean arrivals, 0 to 1
} elmopp_coming_options_t;

/// State. Set up by elmopp_coming_init(); read `arrived_veh` and `arrived_sum_veh`, write nothing.
typedef struct {
    elmopp_coming_options_t options;
    elmopp_account_t near;                         ///< of the rows, ELMOPP_COMING_NEAR_S ahead
    elmopp_account_t far;                          ///< ... and ELMOPP_ACCOUNT_PROBE_S
    float near_weight;                             ///< of the rows of the nearer account now, before they fade
    float far_weight;                              ///< ... and of those behind
    float expected_veh_per_s[ELMOPP_MOVEMENT_MAX]; ///< mean arrivals as they are weighted
    float arrived_veh[ELMOPP_MOVEMENT_MAX][ELMOPP_HORIZON_MAX + 1U]; ///< [][step] the queue and who comes before it
    float arrived_sum_veh[ELMOPP_HORIZON_MAX + 1U];                  ///< ... of all movements
    uint32_t even_step; ///< from then on as many come in every second as are expected in the mean
} elmopp_coming_t;

/// Nothing has been said yet. Asserts what the options' comments say.
void elmopp_coming_init(elmopp_coming_t *self, const elmopp_coming_options_t *options);

/// Once a second, after the sight has observed the same view: holds what rows said against who came.
void elmopp_coming_observe(elmopp_coming_t *self, const elmopp_sight_t *sight, const elmopp_view_t *view);

/// Fills the table. After elmopp_coming_observe().
void elmopp_coming_expect(elmopp_coming_t *self, const elmopp_sight_t *sight, const elmopp_view_t *view);

#endif
