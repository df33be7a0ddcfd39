/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Memory test: March C- over words (van de Goor, Testing Semiconductor Memories, 1991): stuck bits, bits that do not
/// change, cells that change with another, and addresses that lead to the same cell.
///
/// Destroys what was there: every word is zero afterwards if all are good. Keeps no state.

#ifndef ELMOPP_MEMORY_TEST_H
#define ELMOPP_MEMORY_TEST_H

#include <stdbool.h>
#include <stdint.h>

/// True if all words from `begin` up to, without, `end` keep what is written into them.
bool elmopp_memory_test(volatile uint32_t *begin, volatile uint32_t *end);

#endif
