/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Forecast: the vehicles that each approach will bring in the coming seconds, and how they split over its movements.
///
/// Absorbs one observation a second and looks ahead as far as the chooser asks. It decides nothing. `oracle` is not
/// here: a simulator that knows the future hands its rows to elmopp_controller_step() itself.
///
///   none         no row: the chooser sees no further inflow
///   mean         the given long-run mean, or the running mean of the last 15 minutes, in every step
///   persistence  the last second in every step
///   ewma         an exponentially weighted mean, time constant 120 s, in every step
///   ar8          y(t+1) = a0 + sum a_i y(t+1-i), i = 1..8, iterated on its own output; y = arrivals / demand scale.
///                Each output is held inside [low, high] of the model. The mean until eight seconds have been seen.
///
/// The demand scale is the given mean or the running one: causal either way. Running means weigh the n-th observation
/// by 1 / min(n, window), exact averages until the window is full and exponential ones after it: no ring of 900 values.
///
/// Owner: the controller. Not thread-safe; bounded by ELMOPP_APPROACH_MAX times the steps asked for.

#ifndef ELMOPP_FORECAST_H
#define ELMOPP_FORECAST_H

#include "elmopp/junction.h"

#define ELMOPP_AR8_LAGS 8U
#define ELMOPP_FORECAST_MEAN_WINDOW_S 900U ///< running mean and shares
#define ELMOPP_FORECAST_EWMA_WINDOW_S 120U
#define ELMOPP_FORECAST_SHARE_MIN_S 60U ///< shares are equal until so many seconds have been seen

/// Coefficients of one approach, in units of its demand scale. Fitted outside of the core (host_sim, tools).
typedef struct {
    float intercept;
    float lag[ELMOPP_AR8_LAGS]; ///< [0] is the newest second
    float low;                  ///< smallest output: training minimum, widened by a tenth of the range, at least 0
    float high;                 ///< largest output
} elmopp_ar8_t;

/// Which forecast, and its data. The pointers must outlive the forecast.
typedef struct {
    uint8_t kind;                ///< ELMOPP_FORECAST_* (junction.h)
    const elmopp_ar8_t *ar8;     ///< [approach], for ar8 only
    const float *mean_veh_per_s; ///< [approach] long-run means; null: running means
} elmopp_forecast_config_t;

/// State. Set up by elmopp_forecast_init(); nobody else writes it.
typedef struct {
    elmopp_forecast_config_t config;
    const elmopp_junction_t *junction;
    uint32_t seen_s; ///< observations so far; saturates at UINT32_MAX
    float mean_veh[ELMOPP_APPROACH_MAX];
    float ewma_veh[ELMOPP_APPROACH_MAX];
    float movement_mean_veh[ELMOPP_MOVEMENT_MAX];
    float share[ELMOPP_MOVEMENT_MAX];
    float last_veh[ELMOPP_APPROACH_MAX][ELMOPP_AR8_LAGS]; ///< [0] is the newest second
    float row_veh[ELMOPP_APPROACH_MAX][ELMOPP_HORIZON_MAX];
} elmopp_forecast_t;

/// Starts cold. Asserts a known kind, and coefficients for ar8.
void elmopp_forecast_init(elmopp_forecast_t *self, const elmopp_junction_t *junction,
                          const elmopp_forecast_config_t *config);

/// Absorbs the vehicles per movement of one second: finite, >= 0.
void elmopp_forecast_observe(elmopp_forecast_t *self, const float *arrivals_veh);

/// Fills `rows[approach]` with pointers to `steps` (at most ELMOPP_HORIZON_MAX) values each, valid until the next call,
/// and returns the steps; with `none` the rows are null and it returns 0.
uint16_t elmopp_forecast_look(elmopp_forecast_t *self, uint16_t steps, const float *rows[ELMOPP_APPROACH_MAX]);

/// Share of each movement in its approach's arrivals: [movement], sums to 1 over an approach.
const float *elmopp_forecast_share(const elmopp_forecast_t *self);

#endif
