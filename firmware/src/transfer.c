/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/transfer.h"

#include "elmopp/assert.h"

#include "elmopp_can.h"

#include <stddef.h>
#include <string.h>

/* ISO 15765-2:2016, table 9: the high nibble of byte 0. */
#define SINGLE 0U
#define FIRST 1U
#define CONSECUTIVE 2U
#define FLOW 3U

#define NIBBLE 4U
#define LOW 0x0FU
#define BYTE 8U

#define SHORT_HEAD 2U   /* of a first frame whose length has 12 bits, */
#define LONG_HEAD 6U    /* ... and of one whose length has 32 */
#define SHORT_MAX 4095U /* a longer one needs the 32 */
#define SHORTEST 8U     /* less is for a single frame */
#define CONSECUTIVE_HEAD 1U
#define REPORT_BYTES 7U

void elmopp_transfer_init(elmopp_transfer_t *self) {
    *self = (elmopp_transfer_t){.bytes = NULL, .receiving = false};
}

static uint32_t type_of(const elmopp_frame_t *frame) {
    return (uint32_t)frame->data[0] >> NIBBLE;
}

static bool is_long(const elmopp_frame_t *frame) {
    return ((frame->data[0] & LOW) == 0U) && (frame->data[1] == 0U);
}

/* Most significant byte first, as all of the standard. */
static uint32_t length_of(const elmopp_frame_t *frame) {
    uint32_t length = ((uint32_t)(frame->data[0] & LOW) << BYTE) | frame->data[1];
    if (is_long(frame)) {
        for (uint32_t i = SHORT_HEAD; i < LONG_HEAD; i++) {
            length = (length << BYTE) | frame->data[i];
        }
    }
    return length;
}

uint32_t elmopp_transfer_announced(const elmopp_frame_t *frame) {
    const bool is_first = (frame->id == ELMOPP_CAN_TRANSFER_FRAME_ID) && (frame->length == ELMOPP_LINK_BYTES) &&
                          (type_of(frame) == FIRST);
    const uint32_t length = is_first ? length_of(frame) : 0U;
    const bool fits = is_long(frame) ? (length > SHORT_MAX) : (length >= SHORTEST);
    return fits ? length : 0U;
}

static void owe_flow(elmopp_transfer_t *self) {
    self->block = (uint8_t)ELMOPP_TRANSFER_BLOCK;
    self->owes_flow = true;
}

void elmopp_transfer_begin(elmopp_transfer_t *self, const elmopp_frame_t *first, uint8_t *bytes) {
    const uint32_t head = is_long(first) ? LONG_HEAD : SHORT_HEAD;
    const uint32_t length = elmopp_transfer_announced(first);
    ELMOPP_ASSERT(length != 0U);
    *self = (elmopp_transfer_t){
        .bytes = bytes, .length = length, .got = ELMOPP_LINK_BYTES - head, .next = 1U, .receiving = true};
    (void)memcpy(bytes, &first->data[head], self->got);
    owe_flow(self);
}

/* Whether the segment is the one that is waited for, and whole. */
static bool is_next(const elmopp_transfer_t *self, const elmopp_frame_t *frame, uint32_t piece) {
    return ((frame->data[0] & LOW) == self->next) && (frame->length >= (CONSECUTIVE_HEAD + piece)) &&
           (frame->length <= ELMOPP_LINK_BYTES) && (!self->owes_flow);
}

elmopp_transfer_verdict_t elmopp_transfer_take(elmopp_transfer_t *self, const elmopp_frame_t *frame) {
    if ((!self->receiving) || (frame->id != ELMOPP_CAN_TRANSFER_FRAME_ID) || (frame->length == 0U) ||
        (type_of(frame) != CONSECUTIVE)) {
        return ELMOPP_TRANSFER_STRANGE;
    }
    const uint32_t left = self->length - self->got;
    const uint32_t room = ELMOPP_LINK_BYTES - CONSECUTIVE_HEAD;
    const uint32_t piece = (left < room) ? left : room;
    if (!is_next(self, frame, piece)) {
        self->receiving = false;
        return ELMOPP_TRANSFER_BROKEN;
    }
    (void)memcpy(&self->bytes[self->got], &frame->data[CONSECUTIVE_HEAD], piece);
    self->got += piece;
    self->next = (uint8_t)((self->next + 1U) & LOW);
    self->age_ds = 0U;
    self->block--;
    if (self->got == self->length) {
        self->receiving = false;
        return ELMOPP_TRANSFER_WHOLE;
    }
    if (self->block == 0U) {
        owe_flow(self);
    }
    return ELMOPP_TRANSFER_TAKEN;
}

bool elmopp_transfer_tick(elmopp_transfer_t *self) {
    if (self->receiving) {
        self->age_ds++;
        self->receiving = self->age_ds < ELMOPP_TRANSFER_TIMEOUT_DS;
        return self->receiving;
    }
    return true;
}

static elmopp_frame_t answer(uint32_t type, uint32_t low) {
    return (elmopp_frame_t){.id = ELMOPP_CAN_TRANSFER_ACK_FRAME_ID,
                            .length = ELMOPP_LINK_BYTES,
                            .data = {(uint8_t)((type << NIBBLE) | low), 0U, 0U, 0U, 0U, 0U, 0U, 0U}};
}

bool elmopp_transfer_flow(elmopp_transfer_t *self, elmopp_frame_t *out) {
    if ((!self->receiving) || (!self->owes_flow)) {
        return false;
    }
    self->owes_flow = false;
    *out = answer(FLOW, 0U); /* go on */
    out->data[1] = (uint8_t)ELMOPP_TRANSFER_BLOCK;
    out->data[2] = (uint8_t)ELMOPP_TRANSFER_GAP_MS;
    return true;
}

elmopp_frame_t elmopp_transfer_make_report(const elmopp_transfer_report_t *report) {
    elmopp_frame_t frame;
    frame = answer(SINGLE, REPORT_BYTES);
    frame.data[1] = (uint8_t)((uint32_t)report->kind | ((uint32_t)report->state << NIBBLE));
    frame.data[2] = (uint8_t)report->reason;
    frame.data[3] = report->first;
    frame.data[4] = report->second;
    frame.data[5] = (uint8_t)((uint32_t)report->left_s >> BYTE);
    frame.data[6] = (uint8_t)(report->left_s & UINT8_MAX);
    frame.data[7] = report->saved;
    return frame;
}

bool elmopp_transfer_read_report(const elmopp_frame_t *frame, elmopp_transfer_report_t *report) {
    if ((frame->id != ELMOPP_CAN_TRANSFER_ACK_FRAME_ID) || (frame->length != ELMOPP_LINK_BYTES) ||
        (frame->data[0] != REPORT_BYTES)) {
        return false;
    }
    const uint32_t kind = (uint32_t)frame->data[1] & LOW;
    const uint32_t state = (uint32_t)frame->data[1] >> NIBBLE;
    if ((kind > (uint32_t)ELMOPP_TRANSFER_SITE) || (state > (uint32_t)ELMOPP_TRANSFER_WITHDRAWN) ||
        (frame->data[2] > (uint8_t)ELMOPP_TRANSFER_TOO_SOON)) {
        return false;
    }
    *report = (elmopp_transfer_report_t){.kind = (elmopp_transfer_kind_t)kind,
                                         .state = (elmopp_transfer_state_t)state,
                                         .reason = (elmopp_transfer_reason_t)frame->data[2],
                                         .first = frame->data[3],
                                         .second = frame->data[4],
                                         .left_s = (uint16_t)(((uint32_t)frame->data[5] << BYTE) | frame->data[6]),
                                         .saved = frame->data[7]};
    return true;
}
