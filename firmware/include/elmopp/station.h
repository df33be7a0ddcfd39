/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Station: a controller with everything that its site names: chooser, forecast, weights.
///
/// Decides nothing: it looks up what the site asks for and owns the memory that the parts need, so that a port has one
/// object to place. The forecast knows what a street knows: the shipped regression, running means.
///
/// A chooser's window is the site's. The rollout's state, 38 kB, lies here whether the site names it or not. The 46 kB
/// of learning on, and 87 kB more of a nested network's, do not: a board has them somewhere of its own, or not at all,
/// and then its sites run with the weights as they are.
///
/// No allocation. Not thread-safe; one owner, the port. Not movable: the parts point at each other.

#ifndef ELMOPP_STATION_H
#define ELMOPP_STATION_H

#include "elmopp/controller.h"
#include "elmopp/learner.h"
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

/// The weights of a site whose forecast is a network, which are watched (controller.h).
typedef struct {
    const elmopp_weights_t *base;   ///< null: none, the forecast is then a mean and says so
    const elmopp_weights_t *learnt; ///< learnt from them before, to go on with; null: nothing was. Only copied.
} elmopp_station_weights_t;

/// Room for learning on.
typedef struct {
    elmopp_learning_t *learning;          ///< null: there is none
    elmopp_trainer_inner_memory_t *inner; ///< for a nested network; null: there is none
} elmopp_station_room_t;

/// Which weights a site is to have, of those that are shipped, which can be used, and those that were kept (null:
/// none). What was kept is used if it can be. At a site that learns on, what may have been learnt from the shipped ones
/// is where it goes on, and the shipped ones are what it falls back to.
elmopp_station_weights_t elmopp_station_weights(const elmopp_junction_t *junction, const elmopp_weights_t *shipped,
                                                const elmopp_weights_t *kept);

/// Mode Starting. The junction must have passed elmopp_site_check(). `ar8`: the regression of every approach. All
/// pointers must outlive the station.
void elmopp_station_init(elmopp_station_t *self, const elmopp_junction_t *junction, const elmopp_ar8_t *ar8,
                         const elmopp_station_weights_t *weights, const elmopp_station_room_t *room);

/// Between two ticks: goes on with other weights, or with the same at another place (elmopp_controller_use_weights()).
void elmopp_station_use_weights(elmopp_station_t *self, const elmopp_station_weights_t *weights);

/// False if the site asks to learn on and there is no room for it, or no weights: it runs without.
bool elmopp_station_learns_as_asked(const elmopp_station_t *self);

#endif
