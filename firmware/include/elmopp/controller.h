/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Controller: joins forecast, chooser and plan. The seam between core and world.
///
/// Once a second elmopp_controller_step() takes real-valued counts and asks the chooser for a stage; every 100 ms
/// elmopp_controller_lamp_tick() moves the plan and returns the lamps. Order of a second: one step, then ten lamp
/// ticks. A network whose account of the last minutes is worse than the mean's is not listened to
/// until it is better again; its rows are then the mean. It counts T, the time since each movement was green, from the
/// lamps that it returned and from nothing else.
///
/// Owns the state of forecast and plan; the chooser's state and the junction belong to the caller and must outlive it.
/// It reads no clock, does no I/O, allocates nothing. Not thread-safe; one owner.

#ifndef ELMOPP_CONTROLLER_H
#define ELMOPP_CONTROLLER_H

#include "elmopp/chooser.h"
#include "elmopp/forecast.h"
#include "elmopp/plan.h"

/// The decision log shows each approach's forecast summed over so many seconds.
#define ELMOPP_CONTROLLER_TRACE_S 60U

/// A network's forecast is trusted again, or not, once so many seconds of its account (account.h) are in.
#define ELMOPP_CONTROLLER_ACCOUNT_MIN_S 60U

/// A movement waits if at least this many vehicles are counted on it.
#define ELMOPP_CONTROLLER_DEMAND_VEH 1.0F

/// What was counted in the last second. Arrays of movement_count values, finite and >= 0.
typedef struct {
    const float *present_veh; ///< vehicles inside the reach
    const float *arrived_veh; ///< vehicles that came in the last second
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

/// State. Set up by elmopp_controller_init(); read `score`, `foreseen_sum_veh` and `foresight` for the log, write
/// nothing.
typedef struct {
    const elmopp_junction_t *junction;
    elmopp_chooser_t chooser;
    elmopp_forecast_t forecast;
    elmopp_plan_t plan;
    uint16_t red_ds[ELMOPP_MOVEMENT_MAX]; ///< T; saturates
    uint32_t going;                       ///< mask of the movements that are green
    uint32_t waiting;                     ///< mask of the movements that waited on red in the last second
    elmopp_stage_t wanted;
    elmopp_foresight_t foresight;                ///< of the last second
    float score[ELMOPP_STAGE_MAX];               ///< the chooser's scores in the last second
    float foreseen_sum_veh[ELMOPP_APPROACH_MAX]; ///< forecast of the next ELMOPP_CONTROLLER_TRACE_S seconds
} elmopp_controller_t;

/// All red, cold forecast. Asserts a junction that passes elmopp_site_check_counts() and a horizon within
/// ELMOPP_HORIZON_MAX.
void elmopp_controller_init(elmopp_controller_t *self, const elmopp_junction_t *junction,
                            const elmopp_chooser_t *chooser, const elmopp_forecast_config_t *forecast);

/// Shows the forecast one second of arrivals without deciding: a warm start from recorded traffic.
void elmopp_controller_absorb(elmopp_controller_t *self, const float *arrived_veh);

/// Decides, once a second. With `foreseen` (null: none) its rows replace the forecast's. False if a count is negative
/// or not finite: nothing is learnt, the wish stays, and every movement on red counts as waiting, so that maximum
/// greens still end.
bool elmopp_controller_step(elmopp_controller_t *self, const elmopp_counts_t *counts,
                            const elmopp_foreseen_t *foreseen);

/// Moves the plan by one lamp tick (100 ms) and returns the lamps until the next.
elmopp_lamps_t elmopp_controller_lamp_tick(elmopp_controller_t *self);

#endif
