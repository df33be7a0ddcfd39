/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Pins: what each of the board's pins that this port uses is for. docs/bench.md has the wiring.
///
///   PB6       USART1 transmit, lines for people
///   PB8, PB9  CAN1 receive and transmit; receive is pulled up, so that a missing transceiver reads as an idle bus
///   PC4       the key switch to ground; pulled up, so that a broken wire reads as "let go"
///
/// All other pins stay as the reset leaves them: inputs. Source: RM0090 section 8.4; alternate functions DS8626, table
/// Alternate function mapping.

#ifndef ELMOPP_STM32F4_PINS_H
#define ELMOPP_STM32F4_PINS_H

#include "registers.h"

#include <stdbool.h>

typedef struct {
    elmopp_rcc_registers_t *rcc;
    elmopp_gpio_registers_t *b;
    elmopp_gpio_registers_t *c;
} elmopp_pins_registers_t;

/// Sets them up, and lets clocks to them, to CAN1 and to USART1.
void elmopp_pins_start(const elmopp_pins_registers_t *registers);

/// True if the key switch is closed at this moment.
bool elmopp_pins_key_is_closed(const elmopp_gpio_registers_t *c);

#endif
