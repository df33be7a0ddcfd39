/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/account.h"

#include "elmopp/elementary.h"

static float squared_error(const float *said_veh, const float *came_veh, uint32_t approaches) {
    float sum = 0.0F;
    for (uint32_t i = 0U; i < approaches; i++) {
        const float error = said_veh[i] - came_veh[i];
        sum += error * error;
    }
    return sum / (float)approaches;
}

void elmopp_account_settle(elmopp_account_t *self, const float *came_veh, uint32_t approaches) {
    elmopp_account_probe_t *due = &self->probe[self->due];
    if (due->said) {
        elmopp_account_error_t *error = &self->error;
        error->compared_s += (error->compared_s < UINT32_MAX) ? 1U : 0U;
        const uint32_t seen = error->compared_s;
        elmopp_average(&error->forecast, squared_error(due->forecast_veh, came_veh, approaches), seen,
                       ELMOPP_ACCOUNT_WINDOW_S);
        elmopp_average(&error->persistence, squared_error(due->persistence_veh, came_veh, approaches), seen,
                       ELMOPP_ACCOUNT_WINDOW_S);
        elmopp_average(&error->mean, squared_error(due->mean_veh, came_veh, approaches), seen, ELMOPP_ACCOUNT_WINDOW_S);
    }
    due->said = false;
    self->due = (self->due + 1U) % ELMOPP_ACCOUNT_PROBE_S;
}

/* The next second settles the due probe, so the `ahead_s`th one that many less one after it. */
elmopp_account_probe_t *elmopp_account_page(elmopp_account_t *self, uint32_t ahead_s) {
    return &self->probe[(self->due + ahead_s - 1U) % ELMOPP_ACCOUNT_PROBE_S];
}
