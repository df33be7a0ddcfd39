/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Pilot: joins forecast, chooser and plan. The inner seam: real-valued vehicles in, lamps out.
///
/// Once a second elmopp_pilot_step() takes counts and asks the chooser for a stage; every 100 ms
/// elmopp_pilot_lamp_tick() moves the plan towards what the caller wants, in automatic operation the chooser's wish,
/// and returns the lamps. Order of a second: one step, then ten lamp ticks, in the fifth of which a forecast that
/// learns on learns from the second: a decision and what it takes to learn never come together. A step foresees as far
/// as the chooser looks, and the forecast's account; what only a log or a frame wants to know of the minute,
/// elmopp_pilot_look_on() works out later, in a lamp tick that has the time. A network whose account of the last
/// minutes is worse than the mean's is not listened to until it is better again; its rows are then the mean. It counts
/// T, the time since each movement was green, from the lamps that it returned and from nothing else. A chooser that
/// names no stage there is has no wish.
///
/// It knows no frame, no mode and no fault; the fluid experiment drives it directly, the controller (controller.h)
/// through frames. Owns the state of forecast and plan; the chooser's state and the junction belong to the caller and
/// must outlive it. It reads no clock, does no I/O, allocates nothing. Not thread-safe; one owner.

#ifndef ELMOPP_PILOT_H
#define ELMOPP_PILOT_H

#include "elmopp/chooser.h"
#include "elmopp/forecast.h"
#include "elmopp/plan.h"

/// The decision log shows each approach's forecast summed over so many seconds.
#define ELMOPP_PILOT_TRACE_S 60U

/// A network's forecast is trusted again, or not, once so many seconds of its account (account.h) are in.
#define ELMOPP_PILOT_ACCOUNT_MIN_S 60U

/// A forecast learns from a second so many lamp ticks after the step, half a second from either decision.
#define ELMOPP_PILOT_LEARN_DS 5U

/// A movement waits if at least this many vehicles are counted on it.
#define ELMOPP_PILOT_DEMAND_VEH 1.0F

/// What is known of the last second. Arrays of movement_count values, finite and >= 0.
typedef struct {
    const float *present_veh; ///< vehicles inside the reach
    const float *arrived_veh; ///< vehicles that came in the last second
    uint32_t recall;          ///< mask of the movements whose counts are not to be believed: somebody may wait there
    const elmopp_outflow_t *outflow; ///< [ELMOPP_APPROACH_MAX] what neighbours announce; null: nobody does
} elmopp_counts_t;

/// A forecast from outside (a simulator's oracle): rows as in elmopp_view_t.
typedef struct {
    const float *row_veh[ELMOPP_APPROACH_MAX];
    uint16_t steps; ///< at most ELMOPP_HORIZON_MAX
} elmopp_foreseen_t;

/// Where the chooser's rows come from.
typedef enum {
    ELMOPP_FORESIGHT_OWN = 0,   ///< the forecast that was asked for
    ELMOPP_FORESIGHT_GIVEN,     ///< from outside
    ELMOPP_FORESIGHT_COLD,      ///< the mean: the forecast has seen too little
    ELMOPP_FORESIGHT_UNARMED,   ///< the mean: the network's weights cannot be used
    ELMOPP_FORESIGHT_DISTRUSTED ///< the mean: the network has lately done worse than the mean
} elmopp_foresight_t;

/// State. Set up by elmopp_pilot_init(); read `score`, `foreseen_sum_veh` and `foresight` for the log, write
/// nothing.
typedef struct {
    const elmopp_junction_t *junction;
    elmopp_chooser_t chooser;
    elmopp_forecast_t forecast;
    elmopp_plan_t plan;
    uint16_t red_ds[ELMOPP_MOVEMENT_MAX];          ///< T; saturates
    uint32_t going;                                ///< mask of the movements that are green
    uint32_t waiting;                              ///< mask of the movements that waited on red in the last second
    bool begun;                                    ///< a stage has been aimed at: T counts
    bool to_learn;                                 ///< the last step's second has not been learnt from
    uint8_t since_ds;                              ///< lamp ticks since the last step; saturates
    elmopp_stage_t wanted;                         ///< the chooser's wish; ELMOPP_STAGE_NONE: none
    elmopp_foresight_t foresight;                  ///< of the last second
    float score[ELMOPP_STAGE_MAX];                 ///< the chooser's scores in the last second
    float soon_veh[2][ELMOPP_APPROACH_MAX];        ///< forecast of the next 10 and 30 seconds
    float foreseen_sum_veh[ELMOPP_APPROACH_MAX];   ///< ... and of ELMOPP_PILOT_TRACE_S, as soon as they are foreseen
    uint16_t foreseen_s;                           ///< seconds in that sum
    bool looks_on;                                 ///< there is more to foresee of the minute ...
    bool is_heard;                                 ///< ... over which neighbours have announced
    elmopp_outflow_t outflow[ELMOPP_APPROACH_MAX]; ///< ... this
} elmopp_pilot_t;

/// All red, cold forecast. Asserts a junction that passes elmopp_site_check_counts() and a horizon within
/// ELMOPP_HORIZON_MAX.
void elmopp_pilot_init(elmopp_pilot_t *self, const elmopp_junction_t *junction, const elmopp_chooser_t *chooser,
                       const elmopp_forecast_config_t *forecast);

/// Shows the forecast one second of arrivals without deciding: a warm start from recorded traffic.
void elmopp_pilot_absorb(elmopp_pilot_t *self, const float *arrived_veh);

/// All red again, every intergreen running, T at 0: after the lamps were somebody else's. The forecast is kept.
void elmopp_pilot_restart(elmopp_pilot_t *self);

/// Whether a number can be a count of vehicles: finite, not negative, at most a million.
bool elmopp_pilot_is_count(float value_veh);

/// Decides, once a second. What neighbours announce is laid over the beginning of the rows that the chooser sees, where
/// they come from whatsoever; nothing else hears of it. With `foreseen` (null: none) its rows replace the forecast's.
/// False if a value is no count: the second was then a blind one.
bool elmopp_pilot_step(elmopp_pilot_t *self, const elmopp_counts_t *counts, const elmopp_foreseen_t *foreseen);

/// The rest of ELMOPP_PILOT_TRACE_S, for those who only want to know: `foreseen_sum_veh` is whole after it. Once after
/// a step and before the next; nothing else hangs on it.
void elmopp_pilot_look_on(elmopp_pilot_t *self);

/// In place of a step, for a second in which nobody could count: nothing is learnt, the wish stays, and every movement
/// on red counts as waiting, so that maximum greens and the bound on red still turn the stages.
void elmopp_pilot_step_blind(elmopp_pilot_t *self);

/// Learns from the last step's second, unless that has been done: what a lamp tick does, for whoever drives no lamps.
void elmopp_pilot_learn(elmopp_pilot_t *self);

/// Moves the plan by one lamp tick (100 ms) and returns the lamps until the next. `wanted`: the pilot's own wish, or
/// somebody else's (a stage, ELMOPP_STAGE_RED or ELMOPP_STAGE_NONE). `occupied`: as elmopp_plan_step() has it.
elmopp_lamps_t elmopp_pilot_lamp_tick(elmopp_pilot_t *self, elmopp_stage_t wanted, bool occupied);

#endif
