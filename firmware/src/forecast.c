/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/forecast.h"

#include "elmopp/assert.h"

#include <stddef.h>

static void average(float *mean, float value, uint32_t seen, uint32_t window) {
    const uint32_t weight = (seen < window) ? seen : window;
    *mean += (value - *mean) / (float)weight;
}

static uint32_t lanes_of(const elmopp_junction_t *junction, uint32_t approach, const float *value, float *sum) {
    uint32_t count = 0U;
    *sum = 0.0F;
    for (uint32_t j = 0U; j < junction->movement_count; j++) {
        if (junction->movement[j].approach == approach) {
            *sum += value[j];
            count++;
        }
    }
    return count;
}

static void update_shares(elmopp_forecast_t *self) {
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        float sum_veh;
        const uint32_t count =
            lanes_of(self->junction, self->junction->movement[j].approach, self->movement_mean_veh, &sum_veh);
        const bool known = (self->seen_s >= ELMOPP_FORECAST_SHARE_MIN_S) && (sum_veh > 0.0F);
        self->share[j] = known ? (self->movement_mean_veh[j] / sum_veh) : (1.0F / (float)count);
    }
}

void elmopp_forecast_init(elmopp_forecast_t *self, const elmopp_junction_t *junction,
                          const elmopp_forecast_config_t *config) {
    ELMOPP_ASSERT(config->kind < (uint8_t)ELMOPP_FORECAST_COUNT);
    ELMOPP_ASSERT((config->kind != (uint8_t)ELMOPP_FORECAST_AR8) || (config->ar8 != NULL));
    *self = (elmopp_forecast_t){.config = *config, .junction = junction};
    update_shares(self);
}

void elmopp_forecast_observe(elmopp_forecast_t *self, const float *arrivals_veh) {
    self->seen_s += (self->seen_s < UINT32_MAX) ? 1U : 0U;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        average(&self->movement_mean_veh[j], arrivals_veh[j], self->seen_s, ELMOPP_FORECAST_MEAN_WINDOW_S);
    }
    for (uint32_t i = 0U; i < self->junction->approach_count; i++) {
        float sum_veh;
        (void)lanes_of(self->junction, i, arrivals_veh, &sum_veh);
        average(&self->mean_veh[i], sum_veh, self->seen_s, ELMOPP_FORECAST_MEAN_WINDOW_S);
        average(&self->ewma_veh[i], sum_veh, self->seen_s, ELMOPP_FORECAST_EWMA_WINDOW_S);
        for (uint32_t lag = ELMOPP_AR8_LAGS - 1U; lag > 0U; lag--) {
            self->last_veh[i][lag] = self->last_veh[i][lag - 1U];
        }
        self->last_veh[i][0] = sum_veh;
    }
    update_shares(self);
}

static float scale_of(const elmopp_forecast_t *self, uint32_t approach) {
    return (self->config.mean_veh_per_s != NULL) ? self->config.mean_veh_per_s[approach] : self->mean_veh[approach];
}

/* Iterates the regression in units of the demand scale; its own output becomes the newest lag. */
static void roll_out(const elmopp_ar8_t *model, const float last_veh[ELMOPP_AR8_LAGS], float scale_veh, float *row_veh,
                     uint32_t steps) {
    float lag[ELMOPP_AR8_LAGS];
    for (uint32_t k = 0U; k < ELMOPP_AR8_LAGS; k++) {
        lag[k] = last_veh[k] / scale_veh;
    }
    for (uint32_t t = 0U; t < steps; t++) {
        float next = model->intercept;
        for (uint32_t k = 0U; k < ELMOPP_AR8_LAGS; k++) {
            next += model->lag[k] * lag[k];
        }
        next = (next > model->low) ? next : model->low;
        next = (next < model->high) ? next : model->high;
        for (uint32_t k = ELMOPP_AR8_LAGS - 1U; k > 0U; k--) {
            lag[k] = lag[k - 1U];
        }
        lag[0] = next;
        row_veh[t] = next * scale_veh;
    }
}

static void fill_row(elmopp_forecast_t *self, uint32_t approach, uint32_t steps) {
    const float scale_veh = scale_of(self, approach);
    const uint8_t kind = self->config.kind;
    if ((kind == (uint8_t)ELMOPP_FORECAST_AR8) && (self->seen_s >= ELMOPP_AR8_LAGS) && (scale_veh > 0.0F)) {
        roll_out(&self->config.ar8[approach], self->last_veh[approach], scale_veh, self->row_veh[approach], steps);
        return;
    }
    float value_veh = scale_veh;
    if (kind == (uint8_t)ELMOPP_FORECAST_PERSISTENCE) {
        value_veh = self->last_veh[approach][0];
    } else if (kind == (uint8_t)ELMOPP_FORECAST_EWMA) {
        value_veh = self->ewma_veh[approach];
    } else {
        /* the mean, also for a regression that has seen too little */
    }
    for (uint32_t t = 0U; t < steps; t++) {
        self->row_veh[approach][t] = value_veh;
    }
}

uint16_t elmopp_forecast_look(elmopp_forecast_t *self, uint16_t steps, const float *rows[ELMOPP_APPROACH_MAX]) {
    ELMOPP_ASSERT(steps <= ELMOPP_HORIZON_MAX);
    const bool none = self->config.kind == (uint8_t)ELMOPP_FORECAST_NONE;
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        rows[i] = NULL;
        if ((!none) && (i < self->junction->approach_count)) {
            fill_row(self, i, steps);
            rows[i] = self->row_veh[i];
        }
    }
    return none ? 0U : steps;
}

const float *elmopp_forecast_share(const elmopp_forecast_t *self) {
    return self->share;
}
