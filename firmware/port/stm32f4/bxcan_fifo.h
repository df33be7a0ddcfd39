/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The receiving half of the CAN controller: which ids it lets through, and a ring that an interrupt fills.
///
/// The hardware keeps three frames, which a busy bus fills in 0.3 ms; a decision takes longer. So an interrupt empties
/// the hardware into a ring of ELMOPP_BXCAN_RING frames and the main loop takes them from there. A full ring, and an
/// output that will not be released, mask the interrupt: no bus and no broken controller can keep the main loop from
/// its tick. What the hardware then has no room for it drops and says so, and it is counted.
///
/// Filters are lists of 11-bit ids, four to a bank of the fourteen that belong to CAN1: foreign frames cost nothing.
///
/// elmopp_bxcan_fifo_interrupt() is called by the interrupt alone, the rest by the main loop alone. Source: RM0090
/// sections 32.7.3 (reception), 32.7.4 (filters).

#ifndef ELMOPP_STM32F4_BXCAN_FIFO_H
#define ELMOPP_STM32F4_BXCAN_FIFO_H

#include "elmopp/link.h"
#include "registers.h"

#include <stdatomic.h>

#define ELMOPP_BXCAN_RING 64U    ///< a power of two
#define ELMOPP_BXCAN_STAGES 3U   ///< frames that the hardware keeps
#define ELMOPP_BXCAN_IDS_MAX 56U ///< fourteen banks of four
#define ELMOPP_BXCAN_CAN1_BANKS 14U

typedef struct {
    elmopp_bxcan_registers_t *registers;
    elmopp_frame_t frame[ELMOPP_BXCAN_RING];
    atomic_uint_least32_t put;    ///< frames that the interrupt has put in; wraps
    atomic_uint_least32_t taken;  ///< ... and the main loop has taken out
    atomic_uint_least32_t lost;   ///< times that the hardware had no room; wraps
    atomic_uint_least32_t masked; ///< 1: the interrupt has switched itself off
    atomic_uint_least32_t stuck;  ///< 1: an output was not released
} elmopp_bxcan_fifo_t;

/// An empty ring. Touches no register.
void elmopp_bxcan_fifo_init(elmopp_bxcan_fifo_t *self, elmopp_bxcan_registers_t *registers);

/// Lets these ids through, at most ELMOPP_BXCAN_IDS_MAX, and nothing else. Only while the controller is in its
/// initialisation mode.
void elmopp_bxcan_fifo_filter(elmopp_bxcan_fifo_t *self, const uint16_t *ids, uint32_t count);

/// Switches the interrupt of the controller on, or off.
void elmopp_bxcan_fifo_listen(elmopp_bxcan_fifo_t *self, bool on);

/// The interrupt: at most ELMOPP_BXCAN_STAGES frames.
void elmopp_bxcan_fifo_interrupt(elmopp_bxcan_fifo_t *self);

/// The next frame, or false. An empty ring switches the interrupt on again where it has masked itself.
bool elmopp_bxcan_fifo_take(elmopp_bxcan_fifo_t *self, elmopp_frame_t *frame);

#endif
