/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The sending half of the CAN controller: three mailboxes, and what waits for them.
///
/// Mailbox 0 is kept for urgent frames (ids below ELMOPP_BXCAN_URGENT_BELOW, LampCommand): a bus that is full of
/// less important frames cannot hold a lamp command up behind a forecast. Only the newest urgent frame counts; an older
/// one that is still there is taken back. The other two mailboxes serve a queue in order; two frames with one id are
/// never in both at once, which would let them change places. What has not gone out within ELMOPP_BXCAN_SEND_MS is
/// taken back and counted: the next tick has something newer to say.
///
/// No call waits. Each looks at the hardware once and remembers since when something was asked for; a mailbox that was
/// not given back ELMOPP_BXCAN_ABORT_MS after it was asked for is broken. Source: RM0090 section 32.7.1 (transmission).

#ifndef ELMOPP_STM32F4_BXCAN_MAILBOX_H
#define ELMOPP_STM32F4_BXCAN_MAILBOX_H

#include "elmopp/link.h"
#include "registers.h"

#define ELMOPP_BXCAN_URGENT_BELOW 0x100U
#define ELMOPP_BXCAN_QUEUE 16U
#define ELMOPP_BXCAN_SEND_MS 100U
#define ELMOPP_BXCAN_ABORT_MS 10U ///< an abort ends at the latest with the frame on the wire, 0.3 ms

/// What is in a mailbox.
typedef struct {
    bool busy;
    bool aborting;
    uint16_t id;
    uint32_t since_ms; ///< since when it is to be sent, or to be taken back
} elmopp_bxcan_letter_t;

typedef struct {
    elmopp_frame_t frame;
    uint32_t since_ms;
} elmopp_bxcan_waiting_t;

typedef struct {
    elmopp_bxcan_registers_t *registers;
    elmopp_bxcan_letter_t letter[ELMOPP_BXCAN_MAILBOXES];
    elmopp_bxcan_waiting_t queue[ELMOPP_BXCAN_QUEUE];
    uint32_t first; ///< of the queue
    uint32_t count;
    elmopp_bxcan_waiting_t urgent;
    bool urgent_waits;
    uint32_t sent;   ///< acknowledged by somebody; wraps
    uint32_t unsent; ///< taken back, or no room; wraps
} elmopp_bxcan_mailboxes_t;

/// Nothing to send. Touches no register.
void elmopp_bxcan_mailboxes_init(elmopp_bxcan_mailboxes_t *self, elmopp_bxcan_registers_t *registers);

/// Forgets what waits and asks for all three mailboxes back.
void elmopp_bxcan_mailboxes_clear(elmopp_bxcan_mailboxes_t *self);

/// Takes a frame to send. False if there is no room; it is then counted as unsent.
bool elmopp_bxcan_mailboxes_put(elmopp_bxcan_mailboxes_t *self, const elmopp_frame_t *frame, uint32_t now_ms);

/// Moves on what can be moved. False if a mailbox is broken: not given back in time, or not empty when nothing is in
/// it.
bool elmopp_bxcan_mailboxes_step(elmopp_bxcan_mailboxes_t *self, uint32_t now_ms);

#endif
