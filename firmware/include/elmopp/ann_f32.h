/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// ANN in single precision: one second of a plain feed-forward network (the "vanilla" one that the paper names for
/// further work), two hidden layers wide, which sees the last seconds of a few inputs and says their next one.
///
///   a = tanh(W1 x + b1)   b = tanh(W2 a + b2)   next = newest + W3 b + b3
///
/// x holds the seconds of the first input, oldest first, then those of the second, and so on. What it learns is the
/// change from the newest second, so that a network without any weights says persistence.
///
/// It knows no traffic, no scale and no time, and keeps no state: whoever wants to look further ahead moves the window
/// on by what it said. Every sum starts with the bias and runs over its inputs in index order, products and sums
/// rounded separately, so that gcc, clang and a Cortex-M4 give the same bits. No branch depends on data. No allocation;
/// bounded by the sizes below. Weights belong to the caller.

#ifndef ELMOPP_ANN_F32_H
#define ELMOPP_ANN_F32_H

#include <stdint.h>

#define ELMOPP_ANN_INPUTS 4U    ///< and outputs
#define ELMOPP_ANN_WINDOW_S 16U ///< seconds of each input that it sees
#define ELMOPP_ANN_UNITS 16U    ///< of each hidden layer

/// All weights. weights.h says whether they can be used.
typedef struct {
    float first_bias[ELMOPP_ANN_UNITS];                                         ///< b1
    float first_row[ELMOPP_ANN_INPUTS * ELMOPP_ANN_WINDOW_S][ELMOPP_ANN_UNITS]; ///< [x][unit] W1
    float second_bias[ELMOPP_ANN_UNITS];                                        ///< b2
    float second_row[ELMOPP_ANN_UNITS][ELMOPP_ANN_UNITS];                       ///< [unit before][unit] W2
    float head_bias[ELMOPP_ANN_INPUTS];                                         ///< b3
    float head_row[ELMOPP_ANN_UNITS][ELMOPP_ANN_INPUTS];                        ///< [unit][output] W3
} elmopp_ann_f32_weights_t;

/// What comes in the next second. `past`[input] points to ELMOPP_ANN_WINDOW_S finite values, oldest first. The weights
/// have passed elmopp_weights_check().
void elmopp_ann_f32_next(const elmopp_ann_f32_weights_t *weights, const float *const past[ELMOPP_ANN_INPUTS],
                         float next[ELMOPP_ANN_INPUTS]);

#endif
