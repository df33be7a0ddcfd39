/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Future: a small model of the junction that plays one future of it and says what it costs.
///
/// A queue stands at the stop line of each movement. Who drives reaches it when he must and may pass in the same
/// second; without a reach he is counted before he can go. A green queue leaves with the flow that the stage was seen
/// to give it, or after the junction's discharge law where that depends on the queue; blocked_share of it while it is
/// blocked. A change of stage takes the site's intergreen, of whose amber yellow_used_s are still driven, and the
/// start-up of what is newly green: the price of a change is worked out, never set.
///
/// A movement that gives way in the stage shown (site key gives_way) waits while a queue of those who go first stands,
/// and goes after it as the gaps between those let it who reach the line in the next five seconds (gaps.h). Of lanes
/// that others share as many go before as stand in front of the first one who gives way in the mean; in the stage shown
/// now nobody does, as who stands in front is not known. Nobody is credited with clearing the junction at the end of
/// the green: a model that is paid for each end ends its greens.
///
/// A future begins with an action: keep the stage shown for some seconds, or change to another one. Then a reactive
/// rule decides, that of pressure.h, asked in every modelled second: leave for the stage of the greatest sum of queue
/// times flow when that is more than ratio times the own one's; at max_s leave anyway.
///
/// The cost V is the sum of all queues over the seconds, stop_s for each vehicle of a queue that gets green, and
/// x^2 / 2s for each queue x that is left at the horizon: what it costs at least until it has gone at its flow s. A
/// queue at a line knows who waits, not that he has braked before it and has yet to gain speed behind it: stop_s is
/// that. Where there is no reach nobody is seen to drive, and no stop costs anything.
///
/// What it never does: decide, observe, touch a lamp. One future takes at most horizon_s times (stages + movements)
/// steps, and as many more for each pair that gives way. It owns fixed memory of about 5 kB; sight and table belong to
/// the caller. Not thread-safe.

#ifndef ELMOPP_FUTURE_H
#define ELMOPP_FUTURE_H

#include "elmopp/coming.h"
#include "elmopp/sight.h"

/// What does not vary between the futures of a decision.
typedef struct {
    uint16_t min_s;      ///< no stage is left before
    uint16_t max_s;      ///< ... and every one then, if another one is asked for
    float blocked_share; ///< of its flow, for a movement that is blocked, 0 to 1
    float yellow_used_s; ///< of the amber, still driven; 0 or more
    float stop_s;        ///< lost by who starts from a queue, beside his wait and the start-up; 0 or more
} elmopp_future_options_t;

/// A first action and the rule that follows it.
typedef struct {
    elmopp_stage_t first;
    uint16_t hold_s; ///< the stage shown is kept for so long; 0: `first` is another one
    float ratio;     ///< how much more another stage must press for the rule
} elmopp_future_action_t;

/// State. Set up by elmopp_future_init(); read `served`, write nothing.
typedef struct {
    elmopp_future_options_t options;
    const elmopp_junction_t *junction;
    const elmopp_sight_t *sight;
    const elmopp_coming_t *coming;
    uint8_t served_count[ELMOPP_STAGE_MAX];                ///< movements that a stage lets go ...
    uint8_t served[ELMOPP_STAGE_MAX][ELMOPP_MOVEMENT_MAX]; ///< ... and which
    uint16_t change_s[ELMOPP_STAGE_MAX][ELMOPP_STAGE_MAX]; ///< [from][to] intergreen in whole seconds
    uint8_t foe_count[ELMOPP_MOVEMENT_MAX];                ///< movements to which one gives way where they go ...
    uint8_t foe[ELMOPP_MOVEMENT_MAX][ELMOPP_MOVEMENT_MAX]; ///< ... and which
    float present_flow_veh_per_s[ELMOPP_MOVEMENT_MAX];     ///< in the stage shown now, less where blocked
    elmopp_stage_t present;                                ///< the stage shown now ...
    float come[ELMOPP_HORIZON_MAX + 1U]; ///< what arrivals before a step add to half a pressure at most
    uint32_t present_s;                  ///< ... and for how long
    /* The one that is played. */
    const float *flow_veh_per_s;                ///< [movement] in the stage shown
    float left_veh[ELMOPP_MOVEMENT_MAX];        ///< departures until now
    float left_before_veh[ELMOPP_MOVEMENT_MAX]; ///< ... until this second, where somebody gives way
    float startup_s[ELMOPP_MOVEMENT_MAX];       ///< of the start-up, still to come
    float unhindered_veh[ELMOPP_MOVEMENT_MAX];  ///< may go before the first who gives way
    float left_sum_veh;                         ///< all departures
    float stopped_veh;                          ///< all who stood in a queue when it got green
    float greatest;                             ///< pressure of any stage when the rule last looked at all of them ...
    uint32_t greatest_step;                     ///< ... in this second
    bool looked;                                ///< ... since the stage shown came
    uint32_t elapsed_s;                         ///< of the stage shown
    uint32_t changing_s;                        ///< the intergreen to the target
    uint32_t remaining_s;                       ///< ... and what is left of it
    elmopp_stage_t shown;                       ///< or being left
    elmopp_stage_t target;                      ///< being brought up, ELMOPP_STAGE_NONE: none
} elmopp_future_t;

/// True if the options are what their comments say, with 1 <= min_s <= max_s.
bool elmopp_future_is_sound(const elmopp_future_options_t *options);

/// Reads the junction of an initialised sight. Asserts options that are sound. All three pointers must outlive the
/// future.
void elmopp_future_init(elmopp_future_t *self, const elmopp_future_options_t *options, const elmopp_sight_t *sight,
                        const elmopp_coming_t *coming);

/// Where all futures begin: the stage shown, for elapsed_s already. Call it before those of a decision, with the table
/// of `coming` filled.
void elmopp_future_begin(elmopp_future_t *self, elmopp_stage_t shown, uint32_t elapsed_s);

/// Plays one. Returns V in vehicle-seconds.
float elmopp_future_cost(elmopp_future_t *self, const elmopp_future_action_t *action);

#endif
