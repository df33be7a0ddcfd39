/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/ann_f32.h"

#include "elmopp/dense.h"
#include "elmopp/elementary.h"

#include <assert.h>

#define ANN_UNITS ELMOPP_ANN_UNITS
#define ANN_WINDOW ELMOPP_ANN_WINDOW_S
#define ANN_NEWEST (ELMOPP_ANN_WINDOW_S - 1U)

static_assert(ELMOPP_ANN_UNITS == ELMOPP_DENSE_UNITS, "hidden layers are dense");

static void begin_with(const float bias[ANN_UNITS], float sum[ANN_UNITS]) {
    for (uint32_t r = 0U; r < ANN_UNITS; r++) {
        sum[r] = bias[r];
    }
}

void elmopp_ann_f32_next(const elmopp_ann_f32_weights_t *weights, const float *const past[ELMOPP_ANN_INPUTS],
                         float next[ELMOPP_ANN_INPUTS]) {
    float first[ANN_UNITS];
    float second[ANN_UNITS];
    begin_with(weights->first_bias, first);
    for (uint32_t i = 0U; i < ELMOPP_ANN_INPUTS; i++) {
        elmopp_dense_add(&weights->first_row[i * ANN_WINDOW], past[i], ANN_WINDOW, first);
    }
    elmopp_tanh_each(first, ANN_UNITS);
    begin_with(weights->second_bias, second);
    elmopp_dense_add(weights->second_row, first, ANN_UNITS, second);
    elmopp_tanh_each(second, ANN_UNITS);
    for (uint32_t i = 0U; i < ELMOPP_ANN_INPUTS; i++) {
        float change = weights->head_bias[i];
        for (uint32_t r = 0U; r < ANN_UNITS; r++) {
            change += weights->head_row[r][i] * second[r];
        }
        next[i] = past[i][ANN_NEWEST] + change;
    }
}
