/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Link: when to believe a frame, and for how long. End-to-end protection after AUTOSAR E2E profile 1.
///
/// A frame is believed if it has eight bytes, its checksum is right for its id, and its counter is one to
/// ELMOPP_LINK_LOST_MAX ahead of the last believed one's: a repeated, a late, a reordered and a foreign frame are not.
/// The first frame, and the first after a silence of the time-out, may carry any counter. The elmopp.dbc says where the
/// bits are; this room knows counter (low nibble of byte 0) and checksum (byte 7) and nothing of what is between.
///
/// It keeps an age in lamp ticks, never a timestamp, which would wrap. Pure but for the one receiver's state. Owner of
/// a receiver: whoever listens to that id. Not thread-safe.

#ifndef ELMOPP_LINK_H
#define ELMOPP_LINK_H

#include <stdbool.h>
#include <stdint.h>

#define ELMOPP_LINK_BYTES 8U
#define ELMOPP_LINK_COUNTERS 15U ///< counters run from 0 to 14; 15 is invalid
#define ELMOPP_LINK_LOST_MAX 3U  ///< a believed counter is at most so far ahead

/// A classic CAN frame.
typedef struct {
    uint16_t id;    ///< 11 bits
    uint8_t length; ///< of `data` that is meant
    uint8_t data[ELMOPP_LINK_BYTES];
} elmopp_frame_t;

/// Why a frame is not believed, in the order in which it is looked at.
typedef enum {
    ELMOPP_LINK_OK = 0,
    ELMOPP_LINK_FOREIGN,  ///< another id
    ELMOPP_LINK_LENGTH,   ///< not eight bytes
    ELMOPP_LINK_CRC,      ///< changed on the way, or made for another id
    ELMOPP_LINK_COUNTER,  ///< a counter that does not exist
    ELMOPP_LINK_REPEATED, ///< the same counter again
    ELMOPP_LINK_SEQUENCE  ///< too far ahead, or behind
} elmopp_link_verdict_t;

/// Receiver of one id. Set up by elmopp_link_init(); nobody else writes it.
typedef struct {
    uint16_t age_ds; ///< of the last believed frame; saturates
    uint8_t counter; ///< its counter
    bool started;    ///< there was one
} elmopp_link_t;

/// Nothing believed yet.
void elmopp_link_init(elmopp_link_t *self);

/// Judges a frame that should have this id. On ELMOPP_LINK_OK it is taken: its counter is remembered and the age is 0;
/// otherwise the receiver is unchanged.
elmopp_link_verdict_t elmopp_link_take(elmopp_link_t *self, const elmopp_frame_t *frame, uint16_t id,
                                       uint16_t timeout_ds);

/// True if a frame is right by itself: eight bytes, the checksum of its own id, a counter that exists. For whoever
/// looks on, to whom it is no matter in which order frames come.
bool elmopp_link_is_whole(const elmopp_frame_t *frame);

/// A lamp tick passes.
void elmopp_link_tick(elmopp_link_t *self);

/// True if a frame was believed less than timeout_ds ago.
bool elmopp_link_fresh(const elmopp_link_t *self, uint16_t timeout_ds);

/// Finishes a frame to send: length, counter, checksum. Steps the sender's counter.
void elmopp_link_seal(elmopp_frame_t *frame, uint8_t *counter);

/// Checksum of an id (low byte, high byte) and the seven bytes before the checksum.
uint8_t elmopp_link_crc(uint16_t id, const uint8_t data[ELMOPP_LINK_BYTES - 1U]);

/// CRC-8 SAE J1850 of bytes: polynomial 0x1D, start and final exclusive or 0xFF; "123456789" gives 0x4B.
uint8_t elmopp_link_crc8(const uint8_t *bytes, uint32_t length);

#endif
