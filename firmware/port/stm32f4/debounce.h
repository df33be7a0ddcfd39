/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Debounce: a key switch that is held, or is let go, when it has said so for ELMOPP_DEBOUNCE_MS without a break.
///
/// Pure; one owner. It begins as let go. Milliseconds wrap; look at it at least once in 24 days.

#ifndef ELMOPP_STM32F4_DEBOUNCE_H
#define ELMOPP_STM32F4_DEBOUNCE_H

#include <stdbool.h>
#include <stdint.h>

#define ELMOPP_DEBOUNCE_MS 50U

typedef struct {
    bool held;
    uint32_t since_ms; ///< last time that it said what is held true
} elmopp_debounce_t;

void elmopp_debounce_init(elmopp_debounce_t *self, uint32_t now_ms);

/// `closed`: what the contact says now. Returns what is believed.
bool elmopp_debounce_look(elmopp_debounce_t *self, bool closed, uint32_t now_ms);

#endif
