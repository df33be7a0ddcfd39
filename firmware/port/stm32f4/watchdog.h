/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The independent watchdog: an oscillator and a counter of its own that nobody can stop. Source: RM0090 section 21.
///
/// Its oscillator (LSI) is anything from 17 to 47 kHz, 32 mostly (DS8626, LSI oscillator characteristics). While the
/// board starts it allows 2.7 to 7.5 s, for the tests of memory and program; with the first complete lamp tick it
/// tightens to 0.25 to 0.71 s, 0.38 mostly: two and a half ticks at the least. Lamp nodes flash after 0.3 s by
/// themselves.
///
/// No call waits longer than a bounded number of looks at a register: if the watchdog's own clock does not answer, it
/// stays as it is.

#ifndef ELMOPP_STM32F4_WATCHDOG_H
#define ELMOPP_STM32F4_WATCHDOG_H

#include "registers.h"

#include <stdbool.h>

#define ELMOPP_WATCHDOG_LOOKS 20000U ///< a change takes five of LSI's clocks, 0.3 ms

typedef struct {
    elmopp_iwdg_registers_t *registers;
    bool tight;
} elmopp_watchdog_t;

/// Starts it with the long time.
void elmopp_watchdog_start(elmopp_watchdog_t *self, elmopp_iwdg_registers_t *registers);

/// Begins the long time anew, before something at the start that takes long. False once it is tight: nothing may then.
bool elmopp_watchdog_begin_anew(const elmopp_watchdog_t *self);

/// A lamp tick is complete.
void elmopp_watchdog_kick(elmopp_watchdog_t *self);

#endif
