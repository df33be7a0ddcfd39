/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// LSTM shape: how many inputs, units and levels the recurrent networks have, in float (lstm_f32.h) and in whole
/// numbers (lstm_q15.h) alike, and the order of a level's gates. Nothing else: there is no source file.

#ifndef ELMOPP_LSTM_SHAPE_H
#define ELMOPP_LSTM_SHAPE_H

#define ELMOPP_LSTM_INPUTS 4U     ///< x of the outermost level, and outputs
#define ELMOPP_LSTM_LEVELS_MAX 3U ///< 1: plain; 2, 3: nested
#define ELMOPP_LSTM_UNITS 16U     ///< cells of a level
#define ELMOPP_LSTM_GATES (4U * ELMOPP_LSTM_UNITS)

/// What a level sees: x, then h. An inner level's x has as many values as it has units.
#define ELMOPP_LSTM_OUTER_ROWS (ELMOPP_LSTM_INPUTS + ELMOPP_LSTM_UNITS)
#define ELMOPP_LSTM_INNER_ROWS (2U * ELMOPP_LSTM_UNITS)

/// Where each gate begins among a level's gates.
#define ELMOPP_LSTM_GATE_I 0U
#define ELMOPP_LSTM_GATE_F ELMOPP_LSTM_UNITS
#define ELMOPP_LSTM_GATE_O (2U * ELMOPP_LSTM_UNITS)
#define ELMOPP_LSTM_GATE_G (3U * ELMOPP_LSTM_UNITS)

#endif
