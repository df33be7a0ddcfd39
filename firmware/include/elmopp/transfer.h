/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Transfer: an image (image.h) in segments over the bus, and what the controller says about it.
///
/// Transfer carries the segments of ISO 15765-2 (normal addressing, classic CAN): a first frame with the length, then
/// consecutive frames with a number from 0 to 15. TransferAck carries back flow control, by which the receiver lets the
/// sender go on for ELMOPP_TRANSFER_BLOCK segments, and reports, which are single frames of that standard. This room is
/// the receiver: it knows segments, not images; it asks nobody and decides nothing about what may be received.
///
/// Segments have neither counter nor checksum of the bus's: what came is whole if its CRC-32 says so, and whoever owns
/// the bytes looks. A segment that is lost, repeated or out of order ends the transfer, as does a second of silence;
/// the sender begins anew. A first frame while another transfer is under way does not touch that.
///
/// Flow control is asked for once a lamp tick, so that a block a tick is the fastest that anybody can make the receiver
/// work: 320 segments a second, less than a tenth of the bus.
///
/// No allocation: the bytes go where the caller says. Not thread-safe; one owner.

#ifndef ELMOPP_TRANSFER_H
#define ELMOPP_TRANSFER_H

#include "elmopp/link.h"

#include <stdbool.h>
#include <stdint.h>

#define ELMOPP_TRANSFER_BLOCK 32U      ///< segments between two flow controls
#define ELMOPP_TRANSFER_GAP_MS 1U      ///< asked for between two segments
#define ELMOPP_TRANSFER_TIMEOUT_DS 10U ///< of silence (N_Cr)

/// What an image is. The numbers are those of a report.
typedef enum {
    ELMOPP_TRANSFER_NOTHING = 0,
    ELMOPP_TRANSFER_WEIGHTS = 1,
    ELMOPP_TRANSFER_SITE = 2
} elmopp_transfer_kind_t;

/// What has become of an image. The numbers are those of a report.
typedef enum {
    ELMOPP_TRANSFER_IDLE = 0,
    ELMOPP_TRANSFER_RECEIVING = 1,
    ELMOPP_TRANSFER_ON_TRIAL = 2, ///< it runs; a reset brings the old one back
    ELMOPP_TRANSFER_STORING = 3,  ///< it has run without a fault and is being written
    ELMOPP_TRANSFER_KEPT = 4,     ///< it outlives a reset
    ELMOPP_TRANSFER_REFUSED = 5,  ///< it has never run
    ELMOPP_TRANSFER_WITHDRAWN = 6 ///< it ran, and the old one runs again
} elmopp_transfer_state_t;

/// Why. The numbers are those of a report; `first` and `second` are what the report says with it.
typedef enum {
    ELMOPP_TRANSFER_NO_REASON = 0,
    ELMOPP_TRANSFER_BUSY = 1,      ///< another one is being received, on trial or being written
    ELMOPP_TRANSFER_LENGTH = 2,    ///< nothing that this firmware reads is so long
    ELMOPP_TRANSFER_ORDER = 3,     ///< a segment was lost, repeated or out of order
    ELMOPP_TRANSFER_SILENCE = 4,   ///< the sender has stopped in the middle
    ELMOPP_TRANSFER_BY_HAND = 5,   ///< somebody has put one into the board by hand, and that is in force
    ELMOPP_TRANSFER_NOT_SAFE = 6,  ///< a site only with the key held, while lamps flash or are dark
    ELMOPP_TRANSFER_FULL = 7,      ///< nowhere to keep it until the next start, or at all
    ELMOPP_TRANSFER_MAGIC = 8,     ///< no image of this kind
    ELMOPP_TRANSFER_VERSION = 9,   ///< of another layout
    ELMOPP_TRANSFER_CHECKSUM = 10, ///< changed on the way
    ELMOPP_TRANSFER_CONTENT = 11,  ///< breaks a rule: elmopp_weights_fault_t, or elmopp_site_fault_t and what it names
    ELMOPP_TRANSFER_NETWORK = 12,  ///< the site has no use for this network
    ELMOPP_TRANSFER_SIMULATION = 13, ///< a site that must not drive lamps
    ELMOPP_TRANSFER_FAULT = 14,      ///< there is or was a fault: elmopp_fault_t and its group
    ELMOPP_TRANSFER_DISTRUSTED = 15, ///< the forecast was no better than the mean
    ELMOPP_TRANSFER_MEDIUM = 16,     ///< it could not be written
    ELMOPP_TRANSFER_TOO_SOON = 17    ///< the last one was stored only just now
} elmopp_transfer_reason_t;

/// A report.
typedef struct {
    elmopp_transfer_kind_t kind;
    elmopp_transfer_state_t state;
    elmopp_transfer_reason_t reason;
    uint8_t first;
    uint8_t second;
    uint16_t left_s; ///< of the trial
    uint8_t saved;   ///< images written since the start, modulo 256
} elmopp_transfer_report_t;

/// What a frame was to the receiver.
typedef enum {
    ELMOPP_TRANSFER_TAKEN = 0,
    ELMOPP_TRANSFER_WHOLE,  ///< ... and was the last one
    ELMOPP_TRANSFER_BROKEN, ///< out of order: the transfer has ended
    ELMOPP_TRANSFER_STRANGE ///< no segment, or one that nobody waits for: nothing has changed
} elmopp_transfer_verdict_t;

/// Receiver. Set up by elmopp_transfer_init(); nobody else writes it.
typedef struct {
    uint8_t *bytes;  ///< the caller's, for what comes
    uint32_t length; ///< of the whole
    uint32_t got;    ///< so far
    uint8_t next;    ///< number of the segment to come
    uint8_t block;   ///< segments that the sender may still send
    uint8_t age_ds;  ///< of the last segment
    bool receiving;
    bool owes_flow; ///< flow control is due
} elmopp_transfer_t;

/// Nobody sends.
void elmopp_transfer_init(elmopp_transfer_t *self);

/// Length that a first frame announces; 0: it is none. Frames of another id are none.
uint32_t elmopp_transfer_announced(const elmopp_frame_t *frame);

/// Begins with a first frame whose announced length has room in `bytes`. Whatever was under way is forgotten.
void elmopp_transfer_begin(elmopp_transfer_t *self, const elmopp_frame_t *first, uint8_t *bytes);

/// Takes a consecutive frame.
elmopp_transfer_verdict_t elmopp_transfer_take(elmopp_transfer_t *self, const elmopp_frame_t *frame);

/// A lamp tick passes. False if the sender has been silent for too long: the transfer has ended.
bool elmopp_transfer_tick(elmopp_transfer_t *self);

/// Flow control if it is due, not more than once a block.
bool elmopp_transfer_flow(elmopp_transfer_t *self, elmopp_frame_t *out);

/// The frame of a report, and what a TransferAck reports; false: it is no report, or has a number that does not exist.
elmopp_frame_t elmopp_transfer_make_report(const elmopp_transfer_report_t *report);
bool elmopp_transfer_read_report(const elmopp_frame_t *frame, elmopp_transfer_report_t *report);

#endif
