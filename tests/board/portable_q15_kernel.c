/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The portable kernel in whole numbers under other names, beside the one that the board's build links.

#define elmopp_lstm_q15_kernel_outer portable_q15_outer
#define elmopp_lstm_q15_kernel_inner portable_q15_inner
#define elmopp_lstm_q15_kernel_descend portable_q15_descend
#define elmopp_lstm_q15_kernel_advance portable_q15_advance
#define elmopp_lstm_q15_kernel_release portable_q15_release
#define elmopp_lstm_q15_kernel_hide portable_q15_hide

#include "../../firmware/src/lstm_q15_kernel.c"
