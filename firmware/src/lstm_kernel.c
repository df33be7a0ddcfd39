/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/lstm_kernel.h"

#include "elmopp/elementary.h"

#define UNITS ELMOPP_LSTM_UNITS
#define GATES ELMOPP_LSTM_GATES

/* Four rows in one pass keep the sums out of memory and leave their order as it is; `restrict` tells the compiler that
 * no sum is a weight. */
void elmopp_lstm_kernel_open(const float bias[GATES], const float (*row)[GATES], const float *fed, uint32_t rows,
                             float gate[restrict GATES]) {
    for (uint32_t r = 0U; r < GATES; r++) {
        gate[r] = bias[r];
    }
    for (uint32_t k = 0U; k < rows; k += ELMOPP_LSTM_ROWS_AT_ONCE) {
        const float a = fed[k];
        const float b = fed[k + 1U];
        const float c = fed[k + 2U];
        const float d = fed[k + 3U];
        for (uint32_t r = 0U; r < GATES; r++) {
            const float pair = (gate[r] + (row[k][r] * a)) + (row[k + 1U][r] * b);
            gate[r] = (pair + (row[k + 2U][r] * c)) + (row[k + 3U][r] * d);
        }
    }
    elmopp_sigmoid_each(&gate[ELMOPP_LSTM_GATE_I], 3U * UNITS);
    elmopp_tanh_each(&gate[ELMOPP_LSTM_GATE_G], UNITS);
}

void elmopp_lstm_kernel_advance(const float gate[GATES], const float cell[UNITS], float next[UNITS]) {
    for (uint32_t r = 0U; r < UNITS; r++) {
        next[r] =
            (gate[ELMOPP_LSTM_GATE_F + r] * cell[r]) + (gate[ELMOPP_LSTM_GATE_I + r] * gate[ELMOPP_LSTM_GATE_G + r]);
    }
}

void elmopp_lstm_kernel_release(const float gate[GATES], float back[UNITS], float cell[UNITS]) {
    for (uint32_t r = 0U; r < UNITS; r++) {
        cell[r] = back[r];
    }
    elmopp_tanh_each(back, UNITS);
    for (uint32_t r = 0U; r < UNITS; r++) {
        back[r] *= gate[ELMOPP_LSTM_GATE_O + r];
    }
}
