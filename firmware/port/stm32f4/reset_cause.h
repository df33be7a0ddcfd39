/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Reset cause: why the processor has begun anew, and whether the brown-out reset watches over the supply.
///
/// The flags pile up until somebody clears them, and every reset also pulls the reset pin: the one that says most is
/// named. Option bytes are read and never written: whoever builds the board sets them (docs/bench.md).
/// Source: RM0090 sections 7.3.21 (RCC_CSR), 3.9 (FLASH_OPTCR).

#ifndef ELMOPP_STM32F4_RESET_CAUSE_H
#define ELMOPP_STM32F4_RESET_CAUSE_H

#include "registers.h"

#include <stdbool.h>

typedef enum {
    ELMOPP_RESET_UNKNOWN = 0,
    ELMOPP_RESET_POWER,     ///< the power has come
    ELMOPP_RESET_BROWN_OUT, ///< ... after it was too low
    ELMOPP_RESET_PIN,
    ELMOPP_RESET_SOFTWARE, ///< a fault handler's end, or a debugger's wish
    ELMOPP_RESET_WATCHDOG,
    ELMOPP_RESET_LOW_POWER
} elmopp_reset_cause_t;

/// The cause, and clears the flags for the next one.
elmopp_reset_cause_t elmopp_reset_cause_take(elmopp_rcc_registers_t *rcc);

/// What it is called, for a status line. Never null.
const char *elmopp_reset_cause_name(elmopp_reset_cause_t cause);

/// True if the supply must be above the highest threshold, 2.7 V or more: below, flash at 168 MHz is not promised.
bool elmopp_brown_out_is_set(const elmopp_flash_registers_t *flash);

#endif
