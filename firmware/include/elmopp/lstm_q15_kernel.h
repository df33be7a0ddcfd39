/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// LSTM kernel in whole numbers: what nearly all of a step of lstm_q15.h consists of, in functions that a port may
/// replace.
///
/// What is computed, and why, is said in lstm_q15.h. firmware/src/lstm_q15_kernel.c is the contract, in portable C; a
/// build takes it or a port's file with the same functions, never both (firmware/CMakeLists.txt; for a Cortex-M4
/// firmware/port/cortex_m/lstm_q15_kernel.S). A replacement gives the same bits (tests/board/test_lstm_q15_kernel.c)
/// and takes the same number of instructions whatever the numbers are.
///
/// Numbers. Qn is a whole number in units of 2^-n.
///
///   fed         Q15, 16 bits    what a level sees: inputs, hidden values
///   gate, back  Q31, Q30        what a gate opens to; what a level gives back; 32 bits
///   cell        Q21             the innermost level's, within +-1024
///               Q30             any other's: it is what the level inside gave back
///   reach       Q21             what goes into an activation: the sum of a row, half of it where a sigmoid follows
///
/// high(a, b) below is the upper word of the 64-bit product of two words, rounded: (a b + 2^31) >> 32.
///
/// Arrays belong to the caller, do not overlap and begin at an address that four divides. No allocation.

#ifndef ELMOPP_LSTM_Q15_KERNEL_H
#define ELMOPP_LSTM_Q15_KERNEL_H

#include "elmopp/lstm_shape.h"

#include <assert.h>
#include <stdint.h>

/// Rows are taken four at a time, a band, and of what is fed eight values at a time.
#define ELMOPP_LSTM_Q15_BAND 4U
#define ELMOPP_LSTM_Q15_RUN 8U
#define ELMOPP_LSTM_Q15_BANDS (ELMOPP_LSTM_GATES / ELMOPP_LSTM_Q15_BAND)
#define ELMOPP_LSTM_Q15_OUTER_RUNS (ELMOPP_LSTM_UNITS / ELMOPP_LSTM_Q15_RUN)
#define ELMOPP_LSTM_Q15_INNER_RUNS (ELMOPP_LSTM_INNER_ROWS / ELMOPP_LSTM_Q15_RUN)

/// The weights of a row are at most so much, all sizes together: with 16-bit values no sum of products leaves 32 bits.
#define ELMOPP_LSTM_Q15_SUM_MAX 65535

/// Four rows of the outermost level. It is fed its hidden values, then its inputs.
typedef struct {
    int16_t hidden[ELMOPP_LSTM_Q15_OUTER_RUNS][ELMOPP_LSTM_Q15_BAND][ELMOPP_LSTM_Q15_RUN]; ///< [run][row][value]
    int16_t input[ELMOPP_LSTM_Q15_BAND][ELMOPP_LSTM_INPUTS];                               ///< [row][value]
    int32_t scale[ELMOPP_LSTM_Q15_BAND];                                                   ///< >= 0
    int32_t bias[ELMOPP_LSTM_Q15_BAND];                                                    ///< Q21
} elmopp_lstm_q15_outer_t;

/// Four rows of a level inside another one. It is fed x, then its hidden values.
typedef struct {
    int16_t fed[ELMOPP_LSTM_Q15_INNER_RUNS][ELMOPP_LSTM_Q15_BAND][ELMOPP_LSTM_Q15_RUN]; ///< [run][row][value]
    int32_t scale[ELMOPP_LSTM_Q15_BAND];                                                ///< >= 0
    int32_t bias[ELMOPP_LSTM_Q15_BAND];                                                 ///< Q21
} elmopp_lstm_q15_inner_t;

static_assert(sizeof(elmopp_lstm_q15_outer_t) == 192U, "a port knows the layout");
static_assert(sizeof(elmopp_lstm_q15_inner_t) == 288U, "a port knows the layout");

/// All gates of a level: reach = bias + high(scale, sum over k of weight[k] fed[k]); gate = sigmoid of twice the reach
/// for i, f and o, tanh of it for g, as lstm_q15_table.h has them. ELMOPP_LSTM_Q15_BANDS bands, the rows in the order
/// of lstm_shape.h's gates.
void elmopp_lstm_q15_kernel_outer(const elmopp_lstm_q15_outer_t *band, const int16_t fed[ELMOPP_LSTM_OUTER_ROWS],
                                  int32_t gate[ELMOPP_LSTM_GATES]);
void elmopp_lstm_q15_kernel_inner(const elmopp_lstm_q15_inner_t *band, const int16_t fed[ELMOPP_LSTM_INNER_ROWS],
                                  int32_t gate[ELMOPP_LSTM_GATES]);

/// What the level inside is fed, rounded: x = i * g and h = f * cell.
void elmopp_lstm_q15_kernel_descend(const int32_t gate[ELMOPP_LSTM_GATES], const int32_t cell[ELMOPP_LSTM_UNITS],
                                    int16_t fed[ELMOPP_LSTM_INNER_ROWS]);

/// The innermost level: cell = f * cell + i * g, saturated; back = o * tanh(cell).
void elmopp_lstm_q15_kernel_advance(const int32_t gate[ELMOPP_LSTM_GATES], int32_t cell[ELMOPP_LSTM_UNITS],
                                    int32_t back[ELMOPP_LSTM_UNITS]);

/// Any other level: its cell becomes `back`, and `back` becomes o * tanh(cell).
void elmopp_lstm_q15_kernel_release(const int32_t gate[ELMOPP_LSTM_GATES], int32_t back[ELMOPP_LSTM_UNITS],
                                    int32_t cell[ELMOPP_LSTM_UNITS]);

/// The outermost level's `back` as hidden values: Q30 rounded to Q15.
void elmopp_lstm_q15_kernel_hide(const int32_t back[ELMOPP_LSTM_UNITS], int16_t hidden[ELMOPP_LSTM_UNITS]);

#endif
