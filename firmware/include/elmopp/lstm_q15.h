/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// LSTM in whole numbers: the step of lstm_f32.h with 16-bit weights and values, for a processor that multiplies two
/// pairs of those at a time. Levels 1 to 3, the same equations.
///
/// Weights are 16 bits with a scale for each row, hidden values Q15, sums 32 bits, cells 32 bits, results rounded
/// (lstm_q15_kernel.h has the numbers, docs/design.md the reasons). Inputs are floats and the head is one in float:
/// what goes in and comes out is small, and a forecast runs on what comes out. An input is taken within the range for
/// which the weights were made.
///
/// No sum overflows: that is what lstm_quantize.h, who makes these weights of trained ones, sees to before they are
/// used. A cell that would leave +-1024 stays there; tanh has been 1 since 8.
///
/// The same bits on every target, and the same number of instructions for all numbers (tests/board/test_lstm_count.c).
/// Weights and state belong to the caller. No allocation. A step is bounded by ELMOPP_LSTM_LEVELS_MAX.

#ifndef ELMOPP_LSTM_Q15_H
#define ELMOPP_LSTM_Q15_H

#include "elmopp/lstm_q15_kernel.h"
#include "elmopp/lstm_shape.h"

#include <stdint.h>

/// All weights. Made by elmopp_lstm_quantize(), and by nobody else.
typedef struct {
    uint32_t levels;                                       ///< 1..ELMOPP_LSTM_LEVELS_MAX
    float head_bias[ELMOPP_LSTM_INPUTS];                   ///< by
    float head_row[ELMOPP_LSTM_UNITS][ELMOPP_LSTM_INPUTS]; ///< [unit][output] Wy for hidden values in Q15
    float input_middle[ELMOPP_LSTM_INPUTS];                ///< an input x is fed as (x - middle) * gain
    float input_gain[ELMOPP_LSTM_INPUTS];                  ///< > 0
    elmopp_lstm_q15_outer_t outer[ELMOPP_LSTM_Q15_BANDS];
    elmopp_lstm_q15_inner_t inner[ELMOPP_LSTM_LEVELS_MAX - 1U][ELMOPP_LSTM_Q15_BANDS]; ///< as in lstm_f32.h
} elmopp_lstm_q15_weights_t;

/// What it remembers. All zero: nothing yet.
typedef struct {
    int32_t cell[ELMOPP_LSTM_LEVELS_MAX][ELMOPP_LSTM_UNITS]; ///< [0] is the outermost level's
    int16_t hidden[ELMOPP_LSTM_UNITS];
} elmopp_lstm_q15_state_t;

/// One step. Inputs are finite.
void elmopp_lstm_q15_step(const elmopp_lstm_q15_weights_t *weights, elmopp_lstm_q15_state_t *state,
                          const float input[ELMOPP_LSTM_INPUTS]);

/// The head: what it expects as the next input.
void elmopp_lstm_q15_output(const elmopp_lstm_q15_weights_t *weights, const elmopp_lstm_q15_state_t *state,
                            float output[ELMOPP_LSTM_INPUTS]);

#endif
