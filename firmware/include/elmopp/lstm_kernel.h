/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// LSTM kernel: the arithmetic that nearly all of a step's time goes into, in three functions that a port may replace.
///
/// What is computed, and why, is said in lstm_f32.h, the only room that calls this one. firmware/src/lstm_kernel.c is
/// the contract, in portable C; a build takes it or a port's file with the same functions, never both
/// (firmware/CMakeLists.txt; for a Cortex-M4 firmware/port/cortex_m/lstm_kernel.S). A replacement gives the same bits:
/// every sum starts with the bias and runs over the rows in index order, every product and every sum is rounded by
/// itself, activations are those of elementary.h (tests/board/test_lstm_kernel.c). It takes the same number of
/// instructions whatever the numbers are.
///
/// All values are finite. Arrays belong to the caller and do not overlap, where nothing else is said. No allocation.

#ifndef ELMOPP_LSTM_KERNEL_H
#define ELMOPP_LSTM_KERNEL_H

#include "elmopp/lstm_shape.h"

#include <stdint.h>

/// Rows are taken four at a time: a level has a multiple of them.
#define ELMOPP_LSTM_ROWS_AT_ONCE 4U

/// All gates of a level: gate = s(bias + sum over k < `rows` of row[k] fed[k]), s the sigmoid for i, f and o, tanh for
/// g.
void elmopp_lstm_kernel_open(const float bias[ELMOPP_LSTM_GATES], const float (*row)[ELMOPP_LSTM_GATES],
                             const float *fed, uint32_t rows, float gate[ELMOPP_LSTM_GATES]);

/// The innermost level's new cell: next = f * cell + i * g.
void elmopp_lstm_kernel_advance(const float gate[ELMOPP_LSTM_GATES], const float cell[ELMOPP_LSTM_UNITS],
                                float next[ELMOPP_LSTM_UNITS]);

/// A level's cell becomes `back`, and `back` becomes what the level gives back: o * tanh(cell).
void elmopp_lstm_kernel_release(const float gate[ELMOPP_LSTM_GATES], float back[ELMOPP_LSTM_UNITS],
                                float cell[ELMOPP_LSTM_UNITS]);

#endif
