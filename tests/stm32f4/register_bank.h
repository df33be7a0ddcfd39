/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Registers that are memory, behind register_access.h, and hardware that a test makes up: it is asked at each read
/// what the register says, and told of each write.

#ifndef ELMOPP_TESTS_REGISTER_BANK_H
#define ELMOPP_TESTS_REGISTER_BANK_H

#include "register_access.h"

/// What a register that holds `stored` reads as.
typedef uint32_t (*register_bank_answer_t)(const elmopp_register_t *place, uint32_t stored);

/// Null: as memory.
void register_bank_use(register_bank_answer_t answer);

/// Reads and writes since register_bank_use().
uint32_t register_bank_accesses(void);

/// The n-th value written to this register since then, UINT32_MAX if there is none.
uint32_t register_bank_written(const elmopp_register_t *place, uint32_t n);

#endif
