/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/lstm_f32.h"

#include "elmopp/assert.h"
#include "elmopp/lstm_kernel.h"

#include <assert.h>
#include <string.h>

#define UNITS ELMOPP_LSTM_UNITS
#define GATES ELMOPP_LSTM_GATES

static_assert(ELMOPP_LSTM_LEVELS_MAX == 3U, "the levels' gates are listed");
static_assert(ELMOPP_LSTM_INPUTS == 4U, "the head's sums are written out");
static_assert((ELMOPP_LSTM_OUTER_ROWS % ELMOPP_LSTM_ROWS_AT_ONCE) == 0U, "the kernel takes whole groups of rows");
static_assert((ELMOPP_LSTM_INNER_ROWS % ELMOPP_LSTM_ROWS_AT_ONCE) == 0U, "the kernel takes whole groups of rows");

/* What goes into the level inside another one: x, then h. */
static void feed_inner(const float outside[GATES], const float cell[UNITS], float fed[ELMOPP_LSTM_INNER_ROWS]) {
    for (uint32_t r = 0U; r < UNITS; r++) {
        fed[r] = outside[ELMOPP_LSTM_GATE_I + r] * outside[ELMOPP_LSTM_GATE_G + r];
        fed[UNITS + r] = outside[ELMOPP_LSTM_GATE_F + r] * cell[r];
    }
}

/* The gates of every level, from the outermost inwards. */
static void open_gates(const elmopp_lstm_f32_net_t *net, const elmopp_lstm_f32_state_t *state,
                       const float input[ELMOPP_LSTM_INPUTS], float *const gate[ELMOPP_LSTM_LEVELS_MAX]) {
    float fed[ELMOPP_LSTM_INNER_ROWS];
    (void)memcpy(fed, input, ELMOPP_LSTM_INPUTS * sizeof fed[0]);
    (void)memcpy(&fed[ELMOPP_LSTM_INPUTS], state->hidden, sizeof state->hidden);
    elmopp_lstm_kernel_open(net->outer->bias, net->outer->row, fed, ELMOPP_LSTM_OUTER_ROWS, gate[0]);
    for (uint32_t level = 1U; level < net->levels; level++) {
        feed_inner(gate[level - 1U], state->cell[level - 1U], fed);
        const elmopp_lstm_f32_inner_t *inner = &net->inner[level - 1U];
        elmopp_lstm_kernel_open(inner->bias, inner->row, fed, ELMOPP_LSTM_INNER_ROWS, gate[level]);
    }
}

void elmopp_lstm_f32_trace(const elmopp_lstm_f32_net_t *net, elmopp_lstm_f32_state_t *state,
                           const float input[ELMOPP_LSTM_INPUTS], float *const gate[ELMOPP_LSTM_LEVELS_MAX]) {
    ELMOPP_ASSERT((net->levels >= 1U) && (net->levels <= ELMOPP_LSTM_LEVELS_MAX));
    open_gates(net, state, input, gate);
    /* The old hidden state has gone into the gates: its place holds what a level gives back, from the innermost
     * outwards. */
    float *back = state->hidden;
    elmopp_lstm_kernel_advance(gate[net->levels - 1U], state->cell[net->levels - 1U], back);
    for (uint32_t level = net->levels; level > 0U; level--) {
        elmopp_lstm_kernel_release(gate[level - 1U], back, state->cell[level - 1U]);
    }
}

void elmopp_lstm_f32_net_step(const elmopp_lstm_f32_net_t *net, elmopp_lstm_f32_state_t *state,
                              const float input[ELMOPP_LSTM_INPUTS]) {
    float gate[ELMOPP_LSTM_LEVELS_MAX][GATES];
    float *const into[ELMOPP_LSTM_LEVELS_MAX] = {gate[0], gate[1], gate[2]};
    elmopp_lstm_f32_trace(net, state, input, into);
}

elmopp_lstm_f32_net_t elmopp_lstm_f32_net(const elmopp_lstm_f32_weights_t *weights) {
    const elmopp_lstm_f32_net_t net = {.levels = weights->levels,
                                       .head_bias = weights->head_bias,
                                       .head_row = weights->head_row,
                                       .outer = &weights->outer,
                                       .inner = weights->inner};
    return net;
}

void elmopp_lstm_f32_step(const elmopp_lstm_f32_weights_t *weights, elmopp_lstm_f32_state_t *state,
                          const float input[ELMOPP_LSTM_INPUTS]) {
    const elmopp_lstm_f32_net_t net = elmopp_lstm_f32_net(weights);
    elmopp_lstm_f32_net_step(&net, state, input);
}

void elmopp_lstm_f32_net_output(const elmopp_lstm_f32_net_t *net, const elmopp_lstm_f32_state_t *state,
                                float output[ELMOPP_LSTM_INPUTS]) {
    float a = net->head_bias[0];
    float b = net->head_bias[1];
    float c = net->head_bias[2];
    float d = net->head_bias[3];
    for (uint32_t r = 0U; r < UNITS; r++) {
        const float *row = net->head_row[r];
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

void elmopp_lstm_f32_output(const elmopp_lstm_f32_weights_t *weights, const elmopp_lstm_f32_state_t *state,
                            float output[ELMOPP_LSTM_INPUTS]) {
    const elmopp_lstm_f32_net_t net = elmopp_lstm_f32_net(weights);
    elmopp_lstm_f32_net_output(&net, state, output);
}
