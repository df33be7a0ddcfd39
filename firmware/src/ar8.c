/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/ar8.h"

void elmopp_ar8_roll_out(const elmopp_ar8_t *model, const float last[ELMOPP_AR8_LAGS], float *output, uint32_t steps) {
    float lag[ELMOPP_AR8_LAGS];
    for (uint32_t k = 0U; k < ELMOPP_AR8_LAGS; k++) {
        lag[k] = last[k];
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
        output[t] = next;
    }
}
