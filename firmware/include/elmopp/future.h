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
/// times flow when that is more than ratio times the own one's; at max_s leave anyway. To the queues of the stage shown
/// belongs who will be seen to drive up to them by then, as far as more come than come in the mean: a rule that sees
/// queues alone leaves a green in the midst of a platoon that flows through it, for anybody who waits.
///
/// The cost V is the sum of all queues over the seconds, stop_s for each vehicle of a queue that gets green, and
/// x^2 / 2s for each queue x that is left at the horizon: what it costs at least until it has gone at its flow s. A
/// queue at a line knows who waits, not that he has braked before it and has yet to gain speed behind it: stop_s is
/// that. Where there is no reach nobody is seen to drive, and no stop costs anything.
///
/// It is played from event to event: who goes and how fast is listed and holds until something changes, and the rule is
/// asked again only when another stage could press enough by then, which is never later than it would answer otherwise.
///
/// What it never does: decide, observe, touch a lamp. One future takes at most horizon_s times (stages + movements)
/// steps, and as many more for each pair that gives way. It owns fixed memory of 5.6 kB; sight and table belong to
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
    bool look;           ///< the rule sees who drives up to its green
    float stop_s;        ///< lost by who starts from a queue, beside his wait and the start-up; 0 or more
} elmopp_future_options_t;

/// A first action and the rule that follows it.
typedef struct {
    elmopp_stage_t first;
    uint16_t hold_s; ///< the stage shown is kept for so long; 0: `first` is another one
    float ratio;     ///< how much more another stage must press for the rule
} elmopp_future_action_t;

/// A movement that goes.
typedef struct {
    float flow_veh_per_s;
    const float *arrived_veh; ///< [step] of coming.h; one later where who reaches the line in a second may pass in it
    float *left_veh;
} elmopp_future_open_t;

/// State. Set up by elmopp_future_init(); read `served`, write nothing.
typedef struct {
    elmopp_future_options_t options;
    const elmopp_junction_t *junction;
    const elmopp_sight_t *sight;
    const elmopp_coming_t *coming;
    uint8_t served_count[ELMOPP_STAGE_MAX];                ///< movements that a stage lets go ...
    uint8_t served[ELMOPP_STAGE_MAX][ELMOPP_MOVEMENT_MAX]; ///< ... and which
    uint16_t change_s[ELMOPP_STAGE_MAX][ELMOPP_STAGE_MAX]; ///< [from][to] intergreen in whole seconds
    uint16_t look_s[ELMOPP_MOVEMENT_MAX];                  ///< so far the rule sees up a road that is green
    bool looks;                                            ///< ... if any
    bool learnt;                                           ///< flows are those of sight.h, else the junction's law
    float startup_s_of[ELMOPP_MOVEMENT_MAX];               ///< of a movement that begins
    uint8_t foe_count[ELMOPP_MOVEMENT_MAX];                ///< movements to which one gives way where they go ...
    uint8_t foe[ELMOPP_MOVEMENT_MAX][ELMOPP_MOVEMENT_MAX]; ///< ... and which
    elmopp_stage_t present;                                ///< the stage shown now ...
    uint32_t present_s;                                    ///< ... for how long ...
    bool present_blocked;                                  ///< ... with a movement that is blocked ...
    float present_flow_veh_per_s[ELMOPP_MOVEMENT_MAX];     ///< ... and its flows then
    float square[ELMOPP_STAGE_MAX];      ///< flows squared, summed: what a second takes from queues times flow
    float calm[ELMOPP_STAGE_MAX];        ///< ... and what arrivals add to it at least
    float come[ELMOPP_HORIZON_MAX + 1U]; ///< what arrivals before a step add to a long queue's pressure ...
    float rush;                          ///< ... and in the dearest second
    /* The one that is played. */
    const float *flow_veh_per_s;                    ///< [movement] in the stage shown
    float left_veh[ELMOPP_MOVEMENT_MAX];            ///< departures until now
    float startup_s[ELMOPP_MOVEMENT_MAX];           ///< of the start-up, still to come
    float unhindered_veh[ELMOPP_MOVEMENT_MAX];      ///< may go before the first who gives way
    float left_sum_veh;                             ///< all departures
    float cost_veh_s;                               ///< all queues until now
    float stopped_veh;                              ///< all who stood in a queue when it got green
    float pressed[ELMOPP_STAGE_MAX];                ///< what no stage was above when the rule last looked ...
    float others_pressed;                           ///< ... nor any other than the one shown ...
    uint32_t look_step;                             ///< ... in this second
    bool looked;                                    ///< ... and that it has
    elmopp_stage_t shown;                           ///< or being left
    uint32_t shown_step;                            ///< since when ...
    uint32_t shown_s;                               ///< ... and for how long before that
    elmopp_stage_t target;                          ///< being brought up, ELMOPP_STAGE_NONE: none
    uint32_t change_step;                           ///< the intergreen to the target begins ...
    uint32_t ready_step;                            ///< ... and has ended
    uint32_t left_step;                             ///< the stage shown now is left, at the horizon at the latest
    uint32_t ask_step;                              ///< the rule keeps the stage shown until then
    uint32_t open_until;                            ///< so long does this list hold:
    uint32_t open_count;                            ///< movements that go ...
    elmopp_future_open_t open[ELMOPP_MOVEMENT_MAX]; ///< ... and how fast
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

/// Plays one. Returns V in vehicle-seconds. `left_step` then says how long the stage shown now was kept: to hold it for
/// longer than that action did, but not beyond, is the same future under the same ratio.
float elmopp_future_cost(elmopp_future_t *self, const elmopp_future_action_t *action);

#endif
