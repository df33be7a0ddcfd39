/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Rollout: a chooser that tries the next stages in a small model of the junction and takes what has the best
/// prospects.
///
/// Once a second, when the stage shown is min_s old, it plays the next horizon_s seconds (future.h, with who comes from
/// coming.h) for each first action: keep the stage for one of a few times, or change to one of the others_max stages
/// for which most vehicles are there, each times its flow. After the first action a reactive rule decides, once for
/// each of a few ratios.
///
/// The gain of a change is what it costs less than the best time to keep the stage, under the same rule. What counts is
/// the mean gain over the rules less caution times how much worse the worst of them is: a change must pay whatever is
/// done after it. To take the best rule of each action instead is to believe the luckiest of many guesses: near
/// capacity it changed twice as often as was good. The greatest gain above 0 wins, of equal ones the stage with more
/// weight; the stage shown wins ties. A stage's score is minus its mean cost, less that doubt and more its urge where a
/// change is one; 0 where it was not tried. At max_s, when the stage cannot be kept, the greatest score wins.
///
/// The urge of a stage is what it is worth beside its costs because somebody there has waited on red longer than
/// patience_s: with o seconds beyond, o (1 + o / m), m = patience_veh_s at most. A minute of a vehicle brings him his
/// green in light traffic, where a change costs little, and is nothing near capacity, where one costs many.
///
/// The small ratios change soon, which is right in light traffic, the great ones empty their queues first, which is
/// right where every change costs capacity. That nothing else says which it is, is the point.
///
/// Where nobody waits on red, green rests. A movement that has waited red_s on the chooser's own clock (sight.h) gets
/// the next change: when the costs say leave, or at max_s, the stage that serves it best follows, wherever they point;
/// of several the one that takes along who will be overdue next, so that each bound costs few changes.
/// It does not cut the green short, because a cycle that is short of capacity would lose still more of it. So a
/// movement that is overdue alone waits for red_s, the rest of a green and a change; of several one waits for another,
/// and a vehicle of a queue beyond the reach may need two greens. It is a rule for fairness; the promise about red is
/// the plan's (plan.h). A movement that is blocked for ever takes every second stage with it as long as it is.
///
/// What it never does: touch a lamp, look at a route, learn a parameter but the flows of sight.h, ask for a stage that
/// there is not. Every loop ends at a bound of bounds.h; one decision plays at most (holds + others_max) times rules
/// futures.
///
/// The idea is rollout over base policies (Bertsekas); why these, and what was tried: docs/design.md.
///
/// Its state is fixed memory that the caller owns: 38 kB. Not thread-safe; one owner.

#ifndef ELMOPP_ROLLOUT_H
#define ELMOPP_ROLLOUT_H

#include "elmopp/chooser.h"
#include "elmopp/coming.h"
#include "elmopp/future.h"
#include "elmopp/sight.h"

#define ELMOPP_ROLLOUT_HOLD_MAX 5U
#define ELMOPP_ROLLOUT_RULE_MAX 3U

/// What can be varied. elmopp_rollout_defaults() says what was measured to be good; no site needs others.
typedef struct {
    elmopp_sight_options_t sight;             ///< travel_s among them
    elmopp_coming_options_t coming;           ///< horizon_s among them
    elmopp_future_options_t future;           ///< min_s and max_s among them
    uint16_t red_s;                           ///< who has waited so long is next; 0: no bound
    uint16_t patience_s;                      ///< who has waited longer urges his stage
    float patience_veh_s;                     ///< ... by so much at most; 0: nobody does
    uint8_t others_max;                       ///< stages tried beside the one shown, at least 1
    uint8_t hold_count;                       ///< of hold_s, at least 1
    uint8_t rule_count;                       ///< of ratio, at least 1
    uint16_t hold_s[ELMOPP_ROLLOUT_HOLD_MAX]; ///< how long the stage shown may be kept before the rule decides; >= 1
    float ratio[ELMOPP_ROLLOUT_RULE_MAX];     ///< how much more another stage must press for the rule; at least 1
    float caution;                            ///< 0: the mean gain counts, 1: that under the worst rule
} elmopp_rollout_options_t;

/// State. Set up by elmopp_rollout_init(); read `sight` for a log, write nothing.
typedef struct {
    elmopp_rollout_options_t options;
    const elmopp_junction_t *junction; ///< of the first view; null before
    elmopp_sight_t sight;
    elmopp_coming_t coming;
    elmopp_future_t future;
} elmopp_rollout_t;

/// The measured setting: horizon 120 s, rows by their skill as far as it is measured, 30 s, holds 1, 2, 3, 5 and 10 s,
/// ratios 2.5, 4 and 6, caution 0.5, four other stages, green 5 to 60 s, red 180 s, patience 40 s and 60 veh s, half a
/// second of the amber driven, 1.5 s for a stop.
elmopp_rollout_options_t elmopp_rollout_defaults(uint16_t travel_s);

/// Prepares the state and returns the chooser that uses it. Asserts what the options' comments say. The junction is
/// that of the views, always the same.
elmopp_chooser_t elmopp_rollout_init(elmopp_rollout_t *self, const elmopp_rollout_options_t *options);

#endif
