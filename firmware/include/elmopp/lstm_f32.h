/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// LSTM in single precision: one second of a long short-term memory, plain (Hochreiter and Schmidhuber 1997) or nested
/// (Moniz and Krueger 2017; the paper's NLSTM), with a linear head.
///
/// One step function for 1 to 3 levels: a nested LSTM of depth 1 is an LSTM. Each level computes from its input x and
/// its hidden input h, s = sigmoid:
///
///   i = s(Wi x + Ui h + bi)   f = s(Wf x + Uf h + bf)   o = s(Wo x + Uo h + bo)   g = tanh(Wg x + Ug h + bg)
///
/// The innermost level's new cell is c = f * c + i * g. A level with another inside gives it x = i * g and h = f * c,
/// and takes what comes back as its own new cell. What every level gives back is o * tanh(c); the outermost level's is
/// the hidden state, and the output is Wy h + by.
///
/// It knows no traffic, no scale and no time: it is arithmetic. Weights and state belong to the caller. Every sum
/// starts with the bias and runs over x, then h, in index order, products and sums rounded separately, so that gcc,
/// clang and a Cortex-M4 give the same bits. The sums are lstm_kernel.h, which a port may replace, bit for bit. No
/// branch depends on data: the number of instructions of a step is the same for every input
/// (tests/board/test_lstm_count.c).
///
/// No allocation. A step is bounded by ELMOPP_LSTM_LEVELS_MAX.

#ifndef ELMOPP_LSTM_F32_H
#define ELMOPP_LSTM_F32_H

#include "elmopp/lstm_shape.h"

#include <stdint.h>

/// The outermost level. Columns: gate i of every unit, then f, o, g.
typedef struct {
    float bias[ELMOPP_LSTM_GATES];
    float row[ELMOPP_LSTM_OUTER_ROWS][ELMOPP_LSTM_GATES]; ///< [x, then h][gate]
} elmopp_lstm_f32_outer_t;

/// A level inside another one, with columns as there.
typedef struct {
    float bias[ELMOPP_LSTM_GATES];
    float row[ELMOPP_LSTM_INNER_ROWS][ELMOPP_LSTM_GATES]; ///< [x, then h][gate]
} elmopp_lstm_f32_inner_t;

/// All weights. weights.h says whether they can be used.
typedef struct {
    uint32_t levels;                                       ///< 1..ELMOPP_LSTM_LEVELS_MAX
    float head_bias[ELMOPP_LSTM_INPUTS];                   ///< by
    float head_row[ELMOPP_LSTM_UNITS][ELMOPP_LSTM_INPUTS]; ///< [unit][output] Wy
    elmopp_lstm_f32_outer_t outer;
    elmopp_lstm_f32_inner_t inner[ELMOPP_LSTM_LEVELS_MAX - 1U]; ///< [0] is inside the outermost; unused ones are zero
} elmopp_lstm_f32_weights_t;

/// Where a network's weights are. Who learns a network of one level has no room for three (trainer.h).
typedef struct {
    uint32_t levels;
    const float *head_bias;                      ///< [output]
    const float (*head_row)[ELMOPP_LSTM_INPUTS]; ///< [unit][output]
    const elmopp_lstm_f32_outer_t *outer;
    const elmopp_lstm_f32_inner_t *inner; ///< [levels - 1]
} elmopp_lstm_f32_net_t;

/// What it remembers. All zero: nothing yet.
typedef struct {
    float hidden[ELMOPP_LSTM_UNITS];
    float cell[ELMOPP_LSTM_LEVELS_MAX][ELMOPP_LSTM_UNITS]; ///< [0] is the outermost level's
} elmopp_lstm_f32_state_t;

/// One step. The weights have passed elmopp_weights_check(); inputs are finite.
void elmopp_lstm_f32_step(const elmopp_lstm_f32_weights_t *weights, elmopp_lstm_f32_state_t *state,
                          const float input[ELMOPP_LSTM_INPUTS]);

/// The head: what it expects as the next input.
void elmopp_lstm_f32_output(const elmopp_lstm_f32_weights_t *weights, const elmopp_lstm_f32_state_t *state,
                            float output[ELMOPP_LSTM_INPUTS]);

/// The same network, by where its weights are; they must outlive it.
elmopp_lstm_f32_net_t elmopp_lstm_f32_net(const elmopp_lstm_f32_weights_t *weights);

/// A step of such a network, the same to the bit, that leaves its gates behind: [level], each of ELMOPP_LSTM_GATES.
void elmopp_lstm_f32_trace(const elmopp_lstm_f32_net_t *net, elmopp_lstm_f32_state_t *state,
                           const float input[ELMOPP_LSTM_INPUTS], float *const gate[ELMOPP_LSTM_LEVELS_MAX]);

/// A step, and the head, of such a network.
void elmopp_lstm_f32_net_step(const elmopp_lstm_f32_net_t *net, elmopp_lstm_f32_state_t *state,
                              const float input[ELMOPP_LSTM_INPUTS]);
void elmopp_lstm_f32_net_output(const elmopp_lstm_f32_net_t *net, const elmopp_lstm_f32_state_t *state,
                                float output[ELMOPP_LSTM_INPUTS]);

#endif
