/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Trainer kernel: the arithmetic that nearly all of a training update's time goes into, for a port to replace.
///
/// What is computed, and why, is said in trainer.h, the only room that calls this one. firmware/src/trainer_kernel.c is
/// the contract, in portable C; a build takes it or a port's file with the same functions, never both
/// (firmware/CMakeLists.txt; for a Cortex-M4 firmware/port/cortex_m/trainer_kernel.S). A replacement gives the same
/// bits: every product and every sum is rounded by itself, sums run in index order
/// (tests/board/test_trainer_kernel.c). It takes the same number of instructions whatever the numbers are.
///
/// A slope is the derivative of the error by the value of that name. Arrays belong to the caller and do not overlap,
/// where nothing else is said. No allocation.

#ifndef ELMOPP_TRAINER_KERNEL_H
#define ELMOPP_TRAINER_KERNEL_H

#include "elmopp/lstm_kernel.h"

#include <stdint.h>

/// What a network says in a step.
#define ELMOPP_TRAINER_KERNEL_OUTPUTS 4U

/// How far Adam goes (Kingma and Ba 2015). mean += mean_gain (s - mean) and square += square_gain (s^2 - square) for a
/// slope s = share * slope; weight -= rate * mean / sqrt(square + floor).
typedef struct {
    float share; ///< of the summed slopes: one sample's part, and what keeps a long step short
    float mean_gain;
    float square_gain;
    float rate;  ///< both averages' late start allowed for
    float floor; ///< added to the square, so that nothing is divided by 0
} elmopp_trainer_descent_t;

/// Through o * tanh(cell), the end of a level's step: the slope of what it gave back is added to the cell's, and the
/// gates' o become the slopes of their sums.
void elmopp_trainer_kernel_release(float gate[ELMOPP_LSTM_GATES], const float cell[ELMOPP_LSTM_UNITS],
                                   const float back_slope[ELMOPP_LSTM_UNITS], float cell_slope[ELMOPP_LSTM_UNITS]);

/// Through i * g and f * cell, whose slopes are `made_slope` and `kept_slope`: gates i, f and g become the slopes of
/// their sums, and `cell_slope`, which may be `kept_slope`, that of the cell before the step.
void elmopp_trainer_kernel_advance(float gate[ELMOPP_LSTM_GATES], const float cell[ELMOPP_LSTM_UNITS],
                                   const float made_slope[ELMOPP_LSTM_UNITS], const float *kept_slope,
                                   float *cell_slope);

/// Through the head, with d the slope of what was said: hidden_slope[u] += (row[u][0] d[0] + row[u][1] d[1]) +
/// (row[u][2] d[2] + row[u][3] d[3]), and row_slope[u][k] += hidden[u] d[k].
void elmopp_trainer_kernel_answer(const float (*row)[ELMOPP_TRAINER_KERNEL_OUTPUTS],
                                  const float said_slope[ELMOPP_TRAINER_KERNEL_OUTPUTS],
                                  const float hidden[ELMOPP_LSTM_UNITS], float hidden_slope[ELMOPP_LSTM_UNITS],
                                  float (*row_slope)[ELMOPP_TRAINER_KERNEL_OUTPUTS]);

/// Through the gates' sums: fed_slope[k] = sum over g of row[k][g] gate_slope[g], for k < `rows`.
void elmopp_trainer_kernel_project(const float (*row)[ELMOPP_LSTM_GATES], uint32_t rows,
                                   const float gate_slope[ELMOPP_LSTM_GATES], float *fed_slope);

/// One row of weights: row_slope[g] += sum over t < `steps` of fed[t * stride] gate_slope[t][g].
void elmopp_trainer_kernel_gather(const float *fed, uint32_t stride, const float (*gate_slope)[ELMOPP_LSTM_GATES],
                                  uint32_t steps, float row_slope[ELMOPP_LSTM_GATES]);

/// sum + the squares of `count` slopes, a multiple of four, one after the other.
float elmopp_trainer_kernel_squares(const float *slope, uint32_t count, float sum);

/// One step of Adam for `count` weights, a multiple of four. Their slopes become 0.
void elmopp_trainer_kernel_descend(const elmopp_trainer_descent_t *descent, float *weight, float *slope, float *mean,
                                   float *square, uint32_t count);

#endif
