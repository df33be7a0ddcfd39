/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// SLCAN: a CAN bus as text on a serial line, the adaptor's side (Lawicel, CAN232 manual, version 3).
///
/// Takes characters, one at a time, and says what they were: nothing yet, a command that it has obeyed or refused, or a
/// frame for the bus. A line ends with a carriage return. What is too long, garbled or unknown is answered with BEL,
/// dropped and counted; the next line is a new one.
///
///   S6 s001C     the bit rate, 500 kbit/s: the one there is    O L C    open, open to listen only, close
///   t T r R      a frame (11 bits, 29 bits; data, remote)      F        status flags, cleared by reading
///   V N          version, serial number                        Z0 Z1    time stamps
///   X1           frames are sent as they come: always          M m      the filter, as far as it lets all through
///
/// Frames with 29 bits and remote frames go onto the bus, where nobody on this side listens to them. Anything but the
/// above is refused, a bit rate that the bus does not have and a filter that would hide frames among it. It reads no
/// clock, does no I/O, allocates nothing. Owner of the state: the port.

#ifndef ELMOPP_SLCAN_H
#define ELMOPP_SLCAN_H

#include "elmopp/link.h"

#define ELMOPP_SLCAN_LINE_MAX 30U ///< T, 8 digits, length, 16 digits, and a time stamp of 4
#define ELMOPP_SLCAN_TEXT_MAX 32U ///< what one frame or one answer is as text, at most

/// Status flags of F.
enum {
    ELMOPP_SLCAN_RECEIVE_FULL = 0x01, ///< frames for the bus were lost for want of room
    ELMOPP_SLCAN_SEND_FULL = 0x02,    ///< frames from the bus were
    ELMOPP_SLCAN_OVERRUN = 0x08       ///< characters were
};

typedef struct {
    char line[ELMOPP_SLCAN_LINE_MAX];
    uint8_t length;
    bool overlong; ///< the line has had no room; what is left of it is swallowed
    bool rate_is_good;
    bool open;
    bool listens; ///< only
    bool stamps;
    uint8_t flags;
    uint32_t dropped; ///< lines that were no command of ours; wraps
} elmopp_slcan_t;

/// What a character has completed.
typedef struct {
    bool has_frame; ///< `frame` is for the bus
    elmopp_frame_t frame;
    uint8_t answer_length; ///< 0: nothing to say yet
    char answer[ELMOPP_SLCAN_TEXT_MAX];
} elmopp_slcan_event_t;

/// Closed.
void elmopp_slcan_init(elmopp_slcan_t *self);

/// Takes a character.
void elmopp_slcan_take(elmopp_slcan_t *self, char character, elmopp_slcan_event_t *event);

/// Something was lost, for F.
void elmopp_slcan_flag(elmopp_slcan_t *self, uint8_t flag);

/// A frame as a line, with the carriage return and, if asked for, the milliseconds of the minute. Returns its length;
/// 0 while the channel is closed.
uint32_t elmopp_slcan_say(const elmopp_slcan_t *self, const elmopp_frame_t *frame, uint32_t now_ms,
                          char text[ELMOPP_SLCAN_TEXT_MAX]);

/// The two translations by themselves, for the other side: a data frame with 11 bits as a line without its end, and
/// back. False if the line is anything else; a time stamp behind it is left out.
uint32_t elmopp_slcan_write(const elmopp_frame_t *frame, char text[ELMOPP_SLCAN_TEXT_MAX]);
bool elmopp_slcan_read(const char *line, uint32_t length, elmopp_frame_t *frame);

#endif
