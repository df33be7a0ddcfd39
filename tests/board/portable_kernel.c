/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The portable kernel under other names, beside the one that the board's build links.

#define elmopp_lstm_kernel_open portable_kernel_open
#define elmopp_lstm_kernel_advance portable_kernel_advance
#define elmopp_lstm_kernel_release portable_kernel_release

#include "../../firmware/src/lstm_kernel.c"
