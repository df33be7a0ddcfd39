/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The portable trainer kernel under other names, beside the one that the board's build links.

#define elmopp_trainer_kernel_release portable_trainer_release
#define elmopp_trainer_kernel_advance portable_trainer_advance
#define elmopp_trainer_kernel_answer portable_trainer_answer
#define elmopp_trainer_kernel_project portable_trainer_project
#define elmopp_trainer_kernel_gather portable_trainer_gather
#define elmopp_trainer_kernel_squares portable_trainer_squares
#define elmopp_trainer_kernel_descend portable_trainer_descend

#include "../../firmware/src/trainer_kernel.c"
