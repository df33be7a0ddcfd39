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

/* Only these two look ahead. */
static uint8_t forecast_of(const elmopp_junction_t *junction) {
    const bool looks = (junction->chooser == (uint8_t)ELMOPP_CHOOSER_CUMULATIVE) ||
                       (junction->chooser == (uint8_t)ELMOPP_CHOOSER_ROLLOUT);
    return looks ? junction->forecast : (uint8_t)ELMOPP_FORECAST_NONE;
}

void elmopp_station_init(elmopp_station_t *self, const elmopp_junction_t *junction, const elmopp_ar8_t *ar8,
                         const elmopp_weights_t *weights) {
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        self->ar8[i] = *ar8;
    }
    const uint8_t forecast = forecast_of(junction);
    const elmopp_controller_config_t config = {
        .junction = junction,
        .chooser = chooser_of(self, junction),
        .forecast = {
            .kind = forecast, .ar8 = self->ar8, .weights = elmopp_forecast_is_network(forecast) ? weights : NULL}};
    elmopp_controller_init(&self->controller, &config);
}
