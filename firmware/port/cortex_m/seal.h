/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Seal: the checksum of the program itself, at its end. cmake/seal_image.py writes it after linking.

#ifndef ELMOPP_SEAL_H
#define ELMOPP_SEAL_H

#include <stdbool.h>

/// True if every byte from the vectors to the seal is what the linker made: code, constants, what variables begin with.
bool elmopp_seal_is_whole(void);

#endif
