/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Station: a controller with everything that its site names: chooser, forecast, weights.
///
/// Decides nothing: it looks up what the site asks for and owns the memory that the parts need, so that a port has one
/// object to place. The forecast knows what a street knows: the shipped regression, running means.
///
/// A chooser's window is the site's. The rollout's state, 36 kB, lies here whether the site names it or not.
///
/// No allocation. Not thread-safe; one owner, the port. Not movable: the parts point at each other.

#ifndef ELMOPP_STATION_H
#define ELMOPP_STATION_H

#include "elmopp/controller.h"
#include "elmopp/pressure.h"
#include "elmopp/priced.h"
#include "elmopp/rollout.h"
#include "elmopp/urgency.h"

typedef struct {
    elmopp_controller_t controller;
    elmopp_urgency_t urgency;
    elmopp_pressure_t pressure;
    elmopp_priced_t priced;
    elmopp_rollout_t rollout;
    elmopp_ar8_t ar8[ELMOPP_APPROACH_MAX];
} elmopp_station_t;

/// Mode Starting. The junction must have passed elmopp_site_check(). `ar8`: the regression of every approach.
/// `weights`: for a site whose forecast is a network; may be null, the forecast is then a mean and says so. All
/// pointers must outlive the station.
void elmopp_station_init(elmopp_station_t *self, const elmopp_junction_t *junction, const elmopp_ar8_t *ar8,
                         const elmopp_weights_t *weights);

#endif
