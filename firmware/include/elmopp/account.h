/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Account: how good a forecast has lately been, beside persistence and the mean.
///
/// Keeps what was said about some seconds later, ELMOPP_ACCOUNT_PROBE_S at most, until those have passed, and compares
/// it with what came. It judges nobody: whether a forecast is good enough is for the pilot and the rollout to say. A
/// second in which nothing was said leaves no trace.
///
/// Owner: the forecast, or the chooser that keeps one of its own. No allocation; bounded by ELMOPP_APPROACH_MAX.

#ifndef ELMOPP_ACCOUNT_H
#define ELMOPP_ACCOUNT_H

#include "elmopp/bounds.h"

#include <stdbool.h>
#include <stdint.h>

#define ELMOPP_ACCOUNT_PROBE_S 30U   ///< how far ahead it looks, at most
#define ELMOPP_ACCOUNT_WINDOW_S 300U ///< how far back it remembers

/// Mean squared errors over the last minutes, over all approaches; (vehicles/s)^2.
typedef struct {
    float forecast;
    float persistence;
    float mean;
    uint32_t compared_s; ///< seconds compared; saturates at UINT32_MAX. 0: nothing is known yet
} elmopp_account_error_t;

/// What was said in one second about a later one, [approach].
typedef struct {
    float forecast_veh[ELMOPP_APPROACH_MAX];
    float persistence_veh[ELMOPP_APPROACH_MAX];
    float mean_veh[ELMOPP_APPROACH_MAX];
    bool said;
} elmopp_account_probe_t;

/// State. All zero: nothing yet.
typedef struct {
    elmopp_account_probe_t probe[ELMOPP_ACCOUNT_PROBE_S]; ///< a ring
    uint32_t due;                                         ///< the probe that the next second settles
    elmopp_account_error_t error;
} elmopp_account_t;

/// Once a second: compares what was said about it with the vehicles that came, [approach].
void elmopp_account_settle(elmopp_account_t *self, const float *came_veh, uint32_t approaches);

/// The probe in which to enter what is said now about `ahead_s` later, 1 to ELMOPP_ACCOUNT_PROBE_S and always the same,
/// after the second was settled: the caller fills its rows and sets `said`. Entering twice in one second keeps the
/// last.
elmopp_account_probe_t *elmopp_account_page(elmopp_account_t *self, uint32_t ahead_s);

#endif
