/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/lstm_f32.h"

#include "elmopp/assert.h"
#include "elmopp/lstm_kernel.h"

#include <assert.h>
#include <string.h>

#define UNITS ELMOPP_LSTM_UNITS
#define GATES ELMOPP_LSTM_GATES

static_assert(ELMOPP_LSTM_INPUTS == 4U, "the head's sums are written out");
static_assert((ELMOPP_LSTM_OUTER_ROWS % ELMOPP_LSTM_ROWS_AT_ONCE) == 0U, "the kernel takes whole groups of rows");
static_assert((ELMOPP_LSTM_INNER_ROWS % ELMOPP_LSTM_ROWS_AT_ONCE) == 0U, "the kernel takes whole groups of rows");

/* The gates of every level, from the outermost inwards. */
static void open_gates(const elmopp_lstm_f32_weights_t *weights, const elmopp_lstm_f32_state_t *state,
                       const float input[ELMOPP_LSTM_INPUTS], float gate[ELMOPP_LSTM_LEVELS_MAX][GATES]) {
    float fed[ELMOPP_LSTM_INNER_ROWS];
    (void)memcpy(fed, input, ELMOPP_LSTM_INPUTS * sizeof fed[0]);
    (void)memcpy(&fed[ELMOPP_LSTM_INPUTS], state->hidden, sizeof state->hidden);
    elmopp_lstm_kernel_open(weights->outer.bias, weights->outer.row, fed, ELMOPP_LSTM_OUTER_ROWS, gate[0]);
    for (uint32_t level = 1U; level < weights->levels; level++) {
        const float *outside = gate[level - 1U];
        for (uint32_t r = 0U; r < UNITS; r++) {
            fed[r] = outside[ELMOPP_LSTM_GATE_I + r] * outside[ELMOPP_LSTM_GATE_G + r];
            fed[UNITS + r] = outside[ELMOPP_LSTM_GATE_F + r] * state->cell[level - 1U][r];
        }
        const elmopp_lstm_f32_inner_t *inner = &weights->inner[level - 1U];
        elmopp_lstm_kernel_open(inner->bias, inner->row, fed, ELMOPP_LSTM_INNER_ROWS, gate[level]);
    }
}

void elmopp_lstm_f32_step(const elmopp_lstm_f32_weights_t *weights, elmopp_lstm_f32_state_t *state,
                          const float input[ELMOPP_LSTM_INPUTS]) {
    ELMOPP_ASSERT((weights->levels >= 1U) && (weights->levels <= ELMOPP_LSTM_LEVELS_MAX));
    float gate[ELMOPP_LSTM_LEVELS_MAX][GATES];
    open_gates(weights, state, input, gate);
    /* The old hidden state has gone into the gates: its place holds what a level gives back, from the innermost
     * outwards. */
    float *back = state->hidden;
    elmopp_lstm_kernel_advance(gate[weights->levels - 1U], state->cell[weights->levels - 1U], back);
    for (uint32_t level = weights->levels; level > 0U; level--) {
        elmopp_lstm_kernel_release(gate[level - 1U], back, state->cell[level - 1U]);
    }
}

void elmopp_lstm_f32_output(const elmopp_lstm_f32_weights_t *weights, const elmopp_lstm_f32_state_t *state,
                            float output[ELMOPP_LSTM_INPUTS]) {
    float a = weights->head_bias[0];
    float b = weights->head_bias[1];
    float c = weights->head_bias[2];
    float d = weights->head_bias[3];
    for (uint32_t r = 0U; r < UNITS; r++) {
        const float *row = weights->head_row[r];
        const float hidden = state->hidden[r];
        a += row[0] * hidden;
        b += row[1] * hidden;
        c += row[2] * hidden;
        d += row[3] * hidden;
    }
    output[0] = a;
    output[1] = b;
    output[2] = c;
    output[3] = d;
}
