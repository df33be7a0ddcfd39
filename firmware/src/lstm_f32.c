/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/lstm_f32.h"

#include "elmopp/assert.h"
#include "elmopp/elementary.h"

#include <assert.h>
#include <string.h>

#define UNITS ELMOPP_LSTM_UNITS
#define GATES ELMOPP_LSTM_GATES
#define ROWS_AT_ONCE 4U

/* Where each gate's columns begin. */
#define GATE_I 0U
#define GATE_F UNITS
#define GATE_O (2U * UNITS)
#define GATE_G (3U * UNITS)
#define SIGMOID_GATES (3U * UNITS)

static_assert((ELMOPP_LSTM_OUTER_ROWS % ROWS_AT_ONCE) == 0U, "sums take whole groups of rows");
static_assert((ELMOPP_LSTM_INNER_ROWS % ROWS_AT_ONCE) == 0U, "sums take whole groups of rows");

/* All gates of a level: sums of bias, then the rows in index order, and their activations. Four rows in one pass keep
 * the sums out of memory and leave their order as it is; `restrict` tells the compiler that no sum is a weight. */
static void open_level(const float bias[GATES], const float (*row)[GATES], const float *input, uint32_t rows,
                       float gate[restrict GATES]) {
    for (uint32_t r = 0U; r < GATES; r++) {
        gate[r] = bias[r];
    }
    for (uint32_t k = 0U; k < rows; k += ROWS_AT_ONCE) {
        const float a = input[k];
        const float b = input[k + 1U];
        const float c = input[k + 2U];
        const float d = input[k + 3U];
        for (uint32_t r = 0U; r < GATES; r++) {
            const float pair = (gate[r] + (row[k][r] * a)) + (row[k + 1U][r] * b);
            gate[r] = (pair + (row[k + 2U][r] * c)) + (row[k + 3U][r] * d);
        }
    }
    elmopp_sigmoid_each(&gate[GATE_I], SIGMOID_GATES);
    elmopp_tanh_each(&gate[GATE_G], UNITS);
}

/* The gates of every level, from the outermost inwards. */
static void open_gates(const elmopp_lstm_f32_weights_t *weights, const elmopp_lstm_f32_state_t *state,
                       const float input[ELMOPP_LSTM_INPUTS], float gate[ELMOPP_LSTM_LEVELS_MAX][GATES]) {
    float fed[ELMOPP_LSTM_INNER_ROWS];
    for (uint32_t k = 0U; k < ELMOPP_LSTM_INPUTS; k++) {
        fed[k] = input[k];
    }
    for (uint32_t r = 0U; r < UNITS; r++) {
        fed[ELMOPP_LSTM_INPUTS + r] = state->hidden[r];
    }
    open_level(weights->outer.bias, weights->outer.row, fed, ELMOPP_LSTM_OUTER_ROWS, gate[0]);
    for (uint32_t level = 1U; level < weights->levels; level++) {
        const float *outside = gate[level - 1U];
        for (uint32_t r = 0U; r < UNITS; r++) {
            fed[r] = outside[GATE_I + r] * outside[GATE_G + r];
            fed[UNITS + r] = outside[GATE_F + r] * state->cell[level - 1U][r];
        }
        const elmopp_lstm_f32_inner_t *inner = &weights->inner[level - 1U];
        open_level(inner->bias, inner->row, fed, ELMOPP_LSTM_INNER_ROWS, gate[level]);
    }
}

void elmopp_lstm_f32_step(const elmopp_lstm_f32_weights_t *weights, elmopp_lstm_f32_state_t *state,
                          const float input[ELMOPP_LSTM_INPUTS]) {
    ELMOPP_ASSERT((weights->levels >= 1U) && (weights->levels <= ELMOPP_LSTM_LEVELS_MAX));
    float gate[ELMOPP_LSTM_LEVELS_MAX][GATES];
    open_gates(weights, state, input, gate);
    float back[UNITS]; /* what a level gives back, from the innermost outwards */
    const float *innermost = gate[weights->levels - 1U];
    const float *cell = state->cell[weights->levels - 1U];
    for (uint32_t r = 0U; r < UNITS; r++) {
        back[r] = (innermost[GATE_F + r] * cell[r]) + (innermost[GATE_I + r] * innermost[GATE_G + r]);
    }
    for (uint32_t level = weights->levels; level > 0U; level--) {
        for (uint32_t r = 0U; r < UNITS; r++) {
            state->cell[level - 1U][r] = back[r];
        }
        elmopp_tanh_each(back, UNITS);
        for (uint32_t r = 0U; r < UNITS; r++) {
            back[r] *= gate[level - 1U][GATE_O + r];
        }
    }
    for (uint32_t r = 0U; r < UNITS; r++) {
        state->hidden[r] = back[r];
    }
}

void elmopp_lstm_f32_output(const elmopp_lstm_f32_weights_t *weights, const elmopp_lstm_f32_state_t *state,
                            float output[ELMOPP_LSTM_INPUTS]) {
    for (uint32_t k = 0U; k < ELMOPP_LSTM_INPUTS; k++) {
        output[k] = weights->head_bias[k];
    }
    for (uint32_t r = 0U; r < UNITS; r++) {
        for (uint32_t k = 0U; k < ELMOPP_LSTM_INPUTS; k++) {
            output[k] += weights->head_row[r][k] * state->hidden[r];
        }
    }
}
