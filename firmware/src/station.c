/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/station.h"

#include <stddef.h>

static elmopp_chooser_t urgency_of(elmopp_urgency_t *urgency, const elmopp_junction_t *junction) {
    const elmopp_urgency_options_t options = {.min_s = junction->hold_min_s,
                                              .max_s = junction->hold_max_s,
                                              .hysteresis = 1.0F,
                                              .cumulative = junction->chooser == (uint8_t)ELMOPP_CHOOSER_CUMULATIVE};
    return elmopp_urgency_init(urgency, &options);
}

static elmopp_chooser_t rollout_of(elmopp_rollout_t *rollout, const elmopp_junction_t *junction) {
    elmopp_rollout_options_t options;
    options = elmopp_rollout_defaults(0U);
    options.sight = elmopp_sight_of_site(junction);
    options.future.min_s = junction->hold_min_s;
    options.future.max_s = junction->hold_max_s;
    return elmopp_rollout_init(rollout, &options);
}

static elmopp_chooser_t chooser_of(elmopp_station_t *self, const elmopp_junction_t *junction) {
    elmopp_chooser_t chooser;
    switch (junction->chooser) {
    case (uint8_t)ELMOPP_CHOOSER_PRESSURE:
        self->pressure = (elmopp_pressure_t){
            .ratio = ELMOPP_PRESSURE_RATIO, .min_s = junction->hold_min_s, .max_s = junction->hold_max_s};
        chooser = elmopp_pressure_init(&self->pressure);
        break;
    case (uint8_t)ELMOPP_CHOOSER_PRICED:
        chooser = elmopp_priced_init(&self->priced, junction->hold_min_s, junction->hold_max_s);
        break;
    case (uint8_t)ELMOPP_CHOOSER_ROLLOUT:
        chooser = rollout_of(&self->rollout, junction);
        break;
    default: /* naive and cumulative */
        chooser = urgency_of(&self->urgency, junction);
        break;
    }
    return chooser;
}

static uint8_t forecast_of(const elmopp_junction_t *junction) {
    return elmopp_junction_looks_ahead(junction) ? junction->forecast : (uint8_t)ELMOPP_FORECAST_NONE;
}

/* Null: nobody asks, or there is no room, or nothing to begin with. */
static elmopp_learner_t *learner_for(const elmopp_junction_t *junction, const elmopp_weights_t *base,
                                     const elmopp_station_room_t *room) {
    const bool wanted = (junction->learning != 0U) && elmopp_forecast_fits(junction->forecast, base);
    const bool nested = elmopp_forecast_is_nested(junction->forecast);
    elmopp_learning_t *learning = room->learning;
    if ((!wanted) || (learning == NULL) || (nested && (room->inner == NULL))) {
        return NULL;
    }
    elmopp_learner_init(&learning->learner, &learning->trainer, nested ? room->inner : NULL, base,
                        ELMOPP_LEARNER_CAREFUL, junction->approach_count);
    return &learning->learner;
}

elmopp_station_weights_t elmopp_station_weights(const elmopp_junction_t *junction, const elmopp_weights_t *shipped,
                                                const elmopp_weights_t *kept) {
    elmopp_station_weights_t weights = {.base = shipped, .learnt = NULL};
    if (!elmopp_forecast_fits(junction->forecast, kept)) {
        /* as shipped */
    } else if ((junction->learning != 0U) && elmopp_weights_are_learnt_from(kept, shipped)) {
        weights.learnt = kept;
    } else {
        weights.base = kept;
    }
    return weights;
}

static void resume(elmopp_learner_t *learner, const elmopp_weights_t *learnt) {
    if ((learner != NULL) && (learnt != NULL)) {
        elmopp_learner_resume(learner, &learnt->lstm);
    }
}

void elmopp_station_init(elmopp_station_t *self, const elmopp_junction_t *junction, const elmopp_ar8_t *ar8,
                         const elmopp_station_weights_t *weights, const elmopp_station_room_t *room) {
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        self->ar8[i] = *ar8;
    }
    const uint8_t forecast = forecast_of(junction);
    elmopp_learner_t *learner = learner_for(junction, weights->base, room);
    const elmopp_controller_config_t config = {
        .junction = junction,
        .chooser = chooser_of(self, junction),
        .forecast = {.kind = forecast,
                     .ar8 = self->ar8,
                     .weights = elmopp_forecast_is_network(forecast) ? weights->base : NULL,
                     .learner = learner}};
    elmopp_controller_init(&self->controller, &config);
    resume(learner, weights->learnt);
}

void elmopp_station_use_weights(elmopp_station_t *self, const elmopp_station_weights_t *weights) {
    elmopp_controller_use_weights(&self->controller, weights->base);
    resume(self->controller.pilot.forecast.config.learner, weights->learnt);
}

bool elmopp_station_learns_as_asked(const elmopp_station_t *self) {
    const bool asked = self->controller.junction->learning != 0U;
    return (!asked) || (self->controller.pilot.forecast.config.learner != NULL);
}
