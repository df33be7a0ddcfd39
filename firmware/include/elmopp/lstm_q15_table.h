/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// LSTM activation tables: sigmoid and tanh of whole numbers, as straight lines over short stretches. Data only;
/// firmware/src/lstm_q15_table.c is made by tools/lstm-table.
///
/// Both tables are read with a reach in Q21, that is within +-8 a stretch every 2^-6; beyond, the first and the last
/// entry hold. The sigmoid's is that of twice the reach, so that one bound serves both. An entry is a word: its lower
/// half, with a sign, is the slope s of the line; the word itself is the line's value v in Q31, the lower half
/// included. With r the reach and S its lower half, with a sign:
///
///   entry = table[ELMOPP_LSTM_Q15_TABLE_ZERO + (r >> 15, held within -512..511)]     result = entry + s S
///
/// S counts from the even end of the stretch, so no other bits have to be cut out of r. The first and the last slope
/// are 0. Results: sigmoid 0..2^31 - 1 and tanh less than 2^31 - 2^15 in size, so that no product of two leaves its
/// word. Error at most ELMOPP_LSTM_Q15_TABLE_ERROR, rounding included (tests/test_lstm_q15.c tries each seventh reach).

#ifndef ELMOPP_LSTM_Q15_TABLE_H
#define ELMOPP_LSTM_Q15_TABLE_H

#include <stdint.h>

#define ELMOPP_LSTM_Q15_TABLE_SIZE 1024U
#define ELMOPP_LSTM_Q15_TABLE_ZERO 512 ///< the entry of reach 0

/// Largest error of either table, for all reaches.
#define ELMOPP_LSTM_Q15_TABLE_ERROR 3.1e-5

extern const int32_t elmopp_lstm_q15_sigmoid[ELMOPP_LSTM_Q15_TABLE_SIZE];
extern const int32_t elmopp_lstm_q15_tanh[ELMOPP_LSTM_Q15_TABLE_SIZE];

#endif
