/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/trainer_kernel.h"

#include "elmopp/elementary.h"

#include <string.h>

#define UNITS ELMOPP_LSTM_UNITS
#define GATES ELMOPP_LSTM_GATES

void elmopp_trainer_kernel_release(float gate[GATES], const float cell[UNITS], const float back_slope[UNITS],
                                   float cell_slope[UNITS]) {
    float bent[UNITS];
    (void)memcpy(bent, cell, sizeof bent);
    elmopp_tanh_each(bent, UNITS);
    for (uint32_t u = 0U; u < UNITS; u++) {
        const float open = gate[ELMOPP_LSTM_GATE_O + u];
        const float reach = back_slope[u] * open;
        cell_slope[u] += reach - ((reach * bent[u]) * bent[u]);
        gate[ELMOPP_LSTM_GATE_O + u] = (back_slope[u] * bent[u]) * (open - (open * open));
    }
}

void elmopp_trainer_kernel_advance(float gate[GATES], const float cell[UNITS], const float made_slope[UNITS],
                                   const float *kept_slope, float *cell_slope) {
    for (uint32_t u = 0U; u < UNITS; u++) {
        const float in = gate[ELMOPP_LSTM_GATE_I + u];
        const float keep = gate[ELMOPP_LSTM_GATE_F + u];
        const float given = gate[ELMOPP_LSTM_GATE_G + u];
        const float made = made_slope[u];
        const float kept = kept_slope[u];
        const float through = made * in;
        gate[ELMOPP_LSTM_GATE_I + u] = (made * given) * (in - (in * in));
        gate[ELMOPP_LSTM_GATE_F + u] = (kept * cell[u]) * (keep - (keep * keep));
        gate[ELMOPP_LSTM_GATE_G + u] = through - ((through * given) * given);
        cell_slope[u] = kept * keep;
    }
}

void elmopp_trainer_kernel_answer(const float (*row)[ELMOPP_TRAINER_KERNEL_OUTPUTS],
                                  const float said_slope[ELMOPP_TRAINER_KERNEL_OUTPUTS], const float hidden[UNITS],
                                  float hidden_slope[UNITS], float (*row_slope)[ELMOPP_TRAINER_KERNEL_OUTPUTS]) {
    for (uint32_t u = 0U; u < UNITS; u++) {
        const float first = (row[u][0] * said_slope[0]) + (row[u][1] * said_slope[1]);
        const float second = (row[u][2] * said_slope[2]) + (row[u][3] * said_slope[3]);
        hidden_slope[u] += first + second;
        for (uint32_t k = 0U; k < ELMOPP_TRAINER_KERNEL_OUTPUTS; k++) {
            row_slope[u][k] += hidden[u] * said_slope[k];
        }
    }
}

void elmopp_trainer_kernel_project(const float (*row)[GATES], uint32_t rows, const float gate_slope[GATES],
                                   float *fed_slope) {
    for (uint32_t k = 0U; k < rows; k++) {
        float sum = 0.0F;
        for (uint32_t g = 0U; g < GATES; g++) {
            sum += row[k][g] * gate_slope[g];
        }
        fed_slope[k] = sum;
    }
}

void elmopp_trainer_kernel_gather(const float *fed, uint32_t stride, const float (*gate_slope)[GATES], uint32_t steps,
                                  float row_slope[GATES]) {
    for (uint32_t t = 0U; t < steps; t++) {
        const float value = fed[t * stride];
        for (uint32_t g = 0U; g < GATES; g++) {
            row_slope[g] += value * gate_slope[t][g];
        }
    }
}

float elmopp_trainer_kernel_squares(const float *slope, uint32_t count, float sum) {
    float total = sum;
    for (uint32_t k = 0U; k < count; k++) {
        total += slope[k] * slope[k];
    }
    return total;
}

void elmopp_trainer_kernel_descend(const elmopp_trainer_descent_t *descent, float *weight, float *slope, float *mean,
                                   float *square, uint32_t count) {
    const elmopp_trainer_descent_t by = *descent;
    for (uint32_t k = 0U; k < count; k++) {
        const float now = by.share * slope[k];
        mean[k] += by.mean_gain * (now - mean[k]);
        square[k] += by.square_gain * ((now * now) - square[k]);
        weight[k] -= (by.rate * mean[k]) * elmopp_inverse_root(square[k] + by.floor);
        slope[k] = 0.0F;
    }
}
