/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Controller: joins forecast, chooser and plan. The seam between core and world.
///
/// Once a second elmopp_controller_step() takes real-valued counts and asks the chooser for a stage; every 100 ms
/// elmopp_controller_lamp_tick() moves the plan and returns the lamps. Order of a second: one step, then ten lamp
/// ticks. It counts T, the time since each movement was green, from the lamps that it returned and from nothing else.
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

/// State. Set up by elmopp_controller_init(); read `score` and `foreseen_sum_veh` for the log, write nothing.
typedef struct {
    const elmopp_junction_t *junction;
    elmopp_chooser_t chooser;
    elmopp_forecast_t forecast;
    elmopp_plan_t plan;
    uint16_t red_ds[ELMOPP_MOVEMENT_MAX]; ///< T; saturates
    uint32_t going;                       ///< mask of the movements that are green
    uint32_t waiting;                     ///< mask of the movements that waited on red in the last second
    elmopp_stage_t wanted;
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
