/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Serial: lines for people, 115,200 baud, 8 bits, no parity, one way. Source: RM0090 section 30.6.
///
/// Lines wait in a ring; what it has no room for is lost. Each look gives the hardware what it takes at once, one
/// character on a chip: with a look a millisecond a line takes a tenth of a second and never holds anybody up.

#ifndef ELMOPP_STM32F4_SERIAL_H
#define ELMOPP_STM32F4_SERIAL_H

#include "registers.h"

#define ELMOPP_SERIAL_RING 1024U
#define ELMOPP_SERIAL_BURST 64U   ///< characters of a look at most
#define ELMOPP_SERIAL_LOOKS 4000U ///< for one character, when everything is to go out: 0.1 ms at least

typedef struct {
    elmopp_usart_registers_t *registers;
    char ring[ELMOPP_SERIAL_RING];
    uint32_t put; ///< wraps
    uint32_t out;
} elmopp_serial_t;

void elmopp_serial_start(elmopp_serial_t *self, elmopp_usart_registers_t *registers, uint32_t clock_hz);

/// A line, as far as there is room for it.
void elmopp_serial_say(elmopp_serial_t *self, const char *text);

/// Gives the hardware what it takes now.
void elmopp_serial_look(elmopp_serial_t *self);

/// Everything, with bounded waits: for the end of a run.
void elmopp_serial_flush(elmopp_serial_t *self);

#endif
