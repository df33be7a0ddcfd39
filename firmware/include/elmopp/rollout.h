/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Rollout: a chooser that tries every next stage in a small model of the junction and takes the cheapest.
///
/// Once a second, when the stage shown is min_s old, it plays the next horizon_s seconds for each first action: keep
/// the stage for one of a few times, or change to another stage that somebody waits for. After the first action a
/// reactive rule decides. The cost V of an action is the sum of all queues over the seconds, and x^2 / 2s for each
/// queue x that is left then: what it costs at least until it has gone at its flow s. The least V wins, ties go to the
/// lowest index. The score of a stage is -V, 0 where it was not tried.
///
/// The model. A queue stands at the stop line of each movement. Who drives reaches it when he must (sight.h) and may
/// pass in the same second; without a reach he is counted before he can go. Who will come is foreseen: the mean of the
/// arrivals at mean_weight, m, and, as far as rows_s, m + w (r - m) with a row's value r, each movement with its share.
/// m is half the mean, because who may come is not who will: counted in full he keeps greens for nobody. w is what the
/// rows have earned: accounts (account.h) of what they said 10 and 30 s ahead give their skill 1 - MSE of the rows /
/// MSE of the mean, never below 0, and each row has that of the nearer one. So a forecast that knows nothing does no
/// harm, and one that knows all counts in full. A green queue leaves with the flow that the stage was seen to give it,
/// or after the junction's discharge law where that depends on the queue; half as fast while it is blocked. A change of
/// stage takes the site's intergreen, of whose amber yellow_used_s are still driven, and the start-up of what is newly
/// green: the price of a change is worked out, never set.
///
/// The reactive rule is that of pressure.h, asked in every modelled second: leave for the stage of the greatest sum of
/// queue times flow when that is more than ratio times the own one's; at max_s leave anyway. Two ratios are played and
/// the cheaper counts: the small one changes soon, which is right in light traffic, the great one empties its queues
/// first, which is right where every change costs capacity. That nothing else says which it is, is the point.
///
/// Where nobody waits on red, green rests. A movement that has waited red_s on the chooser's own clock (sight.h) gets
/// the next change: when the costs say leave, or at max_s, the stage that serves it best follows, wherever they point.
/// It does not cut the green short, because a cycle that is short of capacity would lose still more of it. So a
/// movement that is overdue alone waits for red_s, the rest of a green and a change; of several one waits for another,
/// and a vehicle of a queue beyond the reach may need two greens. It is a rule for fairness; the promise about red is
/// the plan's (plan.h). A movement that is blocked for ever takes every second stage with it as long as it is.
///
/// What it never does: touch a lamp, look at a route, learn a parameter but the flows of sight.h, ask for a stage that
/// there is not. Every loop ends at a bound of bounds.h; one decision takes at most
/// (stages - 1 + holds) times rules rollouts of horizon_s seconds.
///
/// The idea is rollout over base policies (Bertsekas); why these, and what was tried: docs/design.md.
///
/// Its state is fixed memory that the caller owns: about 36 kB. Not thread-safe; one owner.

#ifndef ELMOPP_ROLLOUT_H
#define ELMOPP_ROLLOUT_H

#include "elmopp/account.h"
#include "elmopp/chooser.h"
#include "elmopp/sight.h"

#define ELMOPP_ROLLOUT_HOLD_MAX 3U
#define ELMOPP_ROLLOUT_RULE_MAX 2U
#define ELMOPP_ROLLOUT_NEAR_S 10U

/// What can be varied. elmopp_rollout_defaults() says what was measured to be good; no site needs others.
typedef struct {
    elmopp_sight_options_t sight;             ///< travel_s among them
    uint16_t min_s;                           ///< a stage is never left before; at least 1
    uint16_t max_s;                           ///< ... and left at if another one is asked for
    uint16_t red_s;                           ///< who has waited so long is next; 0: no bound
    uint16_t horizon_s;                       ///< 1 to ELMOPP_HORIZON_MAX
    uint8_t hold_count;                       ///< of hold_s, at least 1
    uint8_t rule_count;                       ///< of ratio, at least 1
    uint16_t hold_s[ELMOPP_ROLLOUT_HOLD_MAX]; ///< how long the stage shown may be kept before the rule decides; >= 1
    float ratio[ELMOPP_ROLLOUT_RULE_MAX];     ///< how much more another stage must press for the rule; at least 1
    uint16_t rows_s;                          ///< foreseen rows are read so far; half the mean follows
    bool weigh_skill;                         ///< rows correct the mean as far as they have come true lately
    float row_weight;                         ///< otherwise they stand for themselves, by this weight, 0 to 1
    float mean_weight;                        ///< of the mean arrivals, 0 to 1
    float blocked_share;                      ///< of its flow, for a movement that is blocked
    float yellow_used_s;                      ///< of the amber, still driven; 0 or more
} elmopp_rollout_options_t;

/// One future as it is played. Its owner is the rollout.
typedef struct {
    const float *flow_veh_per_s;          ///< [movement] in the stage shown
    float left_veh[ELMOPP_MOVEMENT_MAX];  ///< departures until now
    float startup_s[ELMOPP_MOVEMENT_MAX]; ///< of the start-up, still to come
    float left_sum_veh;                   ///< all departures
    float ratio;
    float greatest;         ///< pressure of any stage when the rule last looked at all of them ...
    uint32_t greatest_step; ///< ... in this second
    bool looked;            ///< ... since the stage shown came
    uint32_t elapsed_s;     ///< of the stage shown
    uint32_t change_s;      ///< the intergreen to the target
    uint32_t remaining_s;   ///< ... and what is left of it
    elmopp_stage_t shown;   ///< or being left
    elmopp_stage_t target;  ///< being brought up, ELMOPP_STAGE_NONE: none
} elmopp_rollout_future_t;

/// State. Set up by elmopp_rollout_init(); read `sight` for a log, write nothing.
typedef struct {
    elmopp_rollout_options_t options;
    const elmopp_junction_t *junction; ///< of the first view; null before
    elmopp_sight_t sight;
    elmopp_account_t near;    ///< of the rows, ELMOPP_ROLLOUT_NEAR_S ahead
    elmopp_account_t account; ///< ... and ELMOPP_ACCOUNT_PROBE_S
    float near_weight;        ///< of the rows now, as far as the nearer account is nearer
    float row_weight;         ///< ... and of those behind
    elmopp_rollout_future_t future;
    uint8_t served_count[ELMOPP_STAGE_MAX];                          ///< movements that a stage lets go ...
    uint8_t served[ELMOPP_STAGE_MAX][ELMOPP_MOVEMENT_MAX];           ///< ... and which
    uint16_t change_s[ELMOPP_STAGE_MAX][ELMOPP_STAGE_MAX];           ///< [from][to] intergreen in whole seconds
    float present_flow_veh_per_s[ELMOPP_MOVEMENT_MAX];               ///< in the stage shown now, less where blocked
    float expected_veh_per_s[ELMOPP_MOVEMENT_MAX];                   ///< mean arrivals as they are weighted
    float arrived_veh[ELMOPP_HORIZON_MAX + 1U][ELMOPP_MOVEMENT_MAX]; ///< [step] the queue and who comes before it
    float arrived_sum_veh[ELMOPP_HORIZON_MAX + 1U];
    float come[ELMOPP_HORIZON_MAX + 1U]; ///< what arrivals before a step have added to half a pressure at most
} elmopp_rollout_t;

/// The measured setting: horizon 120 s, rows by their skill as far as it is measured, 30 s, holds 1, 3 and 10 s, ratios
/// 3 and 6, green 5 to 60 s, red 120 s, half a second of the amber driven.
elmopp_rollout_options_t elmopp_rollout_defaults(uint16_t travel_s);

/// Prepares the state and returns the chooser that uses it. Asserts what the options' comments say. The junction is
/// that of the views, always the same.
elmopp_chooser_t elmopp_rollout_init(elmopp_rollout_t *self, const elmopp_rollout_options_t *options);

#endif
