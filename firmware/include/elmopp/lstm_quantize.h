/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// LSTM quantisation: makes the 16-bit weights of lstm_q15.h of the float ones of lstm_f32.h, on the device as well as
/// anywhere else. The only place that does: what was trained a second ago is quantised by what quantised the shipped
/// weights.
///
/// Each row gets the largest scale with which no weight leaves 16 bits and no sum of the row's products, whatever is
/// fed, leaves 32. What the row can reach, its bias and all weights' sizes times what they may be fed, is bounded, so
/// that everything after the sum is within its word, too: a row that could reach ELMOPP_LSTM_QUANTIZE_REACH_MAX is
/// refused, and named.
///
/// It takes float additions, multiplications and divisions in a fixed order and rounds to nearest: the same bits on
/// every target, and as tests/reference/lstm_q15_reference.py says. No allocation, no state. Work: each weight twice.

#ifndef ELMOPP_LSTM_QUANTIZE_H
#define ELMOPP_LSTM_QUANTIZE_H

#include "elmopp/lstm_f32.h"
#include "elmopp/lstm_q15.h"

#include <stdbool.h>

/// A row of which more could come is refused. A sigmoid is 1 - 6e-8 from 17 on: nothing sensible is near.
#define ELMOPP_LSTM_QUANTIZE_REACH_MAX 128.0F

/// A narrower range of an input is taken as one of this width.
#define ELMOPP_LSTM_QUANTIZE_WIDTH_MIN 1.0e-6F

/// What came of it.
typedef struct {
    bool made;       ///< `out` is filled; otherwise it is as it was
    uint32_t level;  ///< the first row refused: its level, 0 the outermost
    uint32_t column; ///< ... and its gate, 0..ELMOPP_LSTM_GATES - 1 (lstm_shape.h)
    float reach;     ///< ... and what it could reach; no number if a weight is none
} elmopp_lstm_quantized_t;

/// Fills `out` from weights that have passed elmopp_weights_check(), for inputs that are kept within low[k]..high[k],
/// low[k] <= high[k]. `out` is in use by nobody meanwhile.
elmopp_lstm_quantized_t elmopp_lstm_quantize(const elmopp_lstm_f32_weights_t *weights,
                                             const float low[ELMOPP_LSTM_INPUTS], const float high[ELMOPP_LSTM_INPUTS],
                                             elmopp_lstm_q15_weights_t *out);

/// Whether it would: the same answer, and nothing made.
elmopp_lstm_quantized_t elmopp_lstm_quantize_check(const elmopp_lstm_f32_weights_t *weights,
                                                   const float low[ELMOPP_LSTM_INPUTS],
                                                   const float high[ELMOPP_LSTM_INPUTS]);

#endif
