/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/link.h"

#define CRC_POLYNOMIAL 0x1DU
#define CRC_START 0xFFU
#define CRC_FINAL 0xFFU
#define BITS_PER_BYTE 8U
#define TOP_BIT 0x80U
#define BYTE_MASK 0xFFU
#define COUNTER_MASK 0x0FU
#define CRC_BYTE (ELMOPP_LINK_BYTES - 1U)

static uint8_t crc_with(uint8_t crc, uint8_t byte) {
    uint32_t rest = (uint32_t)crc ^ byte;
    for (uint32_t bit = 0U; bit < BITS_PER_BYTE; bit++) {
        const bool top = (rest & TOP_BIT) != 0U;
        rest = (rest << 1U) & BYTE_MASK;
        rest ^= top ? CRC_POLYNOMIAL : 0U;
    }
    return (uint8_t)rest;
}

static uint8_t crc_over(uint8_t crc, const uint8_t *bytes, uint32_t length) {
    uint8_t sum = crc;
    for (uint32_t i = 0U; i < length; i++) {
        sum = crc_with(sum, bytes[i]);
    }
    return sum;
}

uint8_t elmopp_link_crc8(const uint8_t *bytes, uint32_t length) {
    return (uint8_t)(crc_over(CRC_START, bytes, length) ^ CRC_FINAL);
}

uint8_t elmopp_link_crc(uint16_t id, const uint8_t data[ELMOPP_LINK_BYTES - 1U]) {
    const uint8_t low = (uint8_t)(id & BYTE_MASK);
    const uint8_t high = (uint8_t)((uint32_t)id >> BITS_PER_BYTE);
    const uint8_t of_id = crc_with(crc_with(CRC_START, low), high);
    return (uint8_t)(crc_over(of_id, data, CRC_BYTE) ^ CRC_FINAL);
}

void elmopp_link_init(elmopp_link_t *self) {
    self->age_ds = UINT16_MAX;
    self->counter = 0U;
    self->started = false;
}

void elmopp_link_tick(elmopp_link_t *self) {
    self->age_ds = (self->age_ds < UINT16_MAX) ? (uint16_t)(self->age_ds + 1U) : self->age_ds;
}

bool elmopp_link_fresh(const elmopp_link_t *self, uint16_t timeout_ds) {
    return self->started && (self->age_ds < timeout_ds);
}

static uint8_t counter_of(const elmopp_frame_t *frame) {
    return frame->data[0] & COUNTER_MASK;
}

/* A frame by itself. */
static elmopp_link_verdict_t judge_frame(const elmopp_frame_t *frame) {
    elmopp_link_verdict_t verdict = ELMOPP_LINK_OK;
    if (frame->length != ELMOPP_LINK_BYTES) {
        verdict = ELMOPP_LINK_LENGTH;
    } else if (elmopp_link_crc(frame->id, frame->data) != frame->data[CRC_BYTE]) {
        verdict = ELMOPP_LINK_CRC;
    } else if (counter_of(frame) >= ELMOPP_LINK_COUNTERS) {
        verdict = ELMOPP_LINK_COUNTER;
    } else {
        /* whole */
    }
    return verdict;
}

bool elmopp_link_is_whole(const elmopp_frame_t *frame) {
    return judge_frame(frame) == ELMOPP_LINK_OK;
}

/* The counter of a whole frame, after the last believed one's. */
static elmopp_link_verdict_t judge_order(const elmopp_link_t *self, uint8_t counter, uint16_t timeout_ds) {
    const uint32_t ahead = ((uint32_t)counter + ELMOPP_LINK_COUNTERS - self->counter) % ELMOPP_LINK_COUNTERS;
    elmopp_link_verdict_t verdict = ELMOPP_LINK_OK;
    if (!elmopp_link_fresh(self, timeout_ds)) {
        verdict = ELMOPP_LINK_OK;
    } else if (ahead == 0U) {
        verdict = ELMOPP_LINK_REPEATED;
    } else if (ahead > ELMOPP_LINK_LOST_MAX) {
        verdict = ELMOPP_LINK_SEQUENCE;
    } else {
        /* in order */
    }
    return verdict;
}

elmopp_link_verdict_t elmopp_link_take(elmopp_link_t *self, const elmopp_frame_t *frame, uint16_t id,
                                       uint16_t timeout_ds) {
    const uint8_t counter = counter_of(frame);
    elmopp_link_verdict_t verdict = (frame->id == id) ? judge_frame(frame) : ELMOPP_LINK_FOREIGN;
    if (verdict == ELMOPP_LINK_OK) {
        verdict = judge_order(self, counter, timeout_ds);
    }
    if (verdict == ELMOPP_LINK_OK) {
        self->counter = counter;
        self->started = true;
        self->age_ds = 0U;
    }
    return verdict;
}

void elmopp_link_seal(elmopp_frame_t *frame, uint8_t *counter) {
    frame->length = (uint8_t)ELMOPP_LINK_BYTES;
    const uint32_t rest = frame->data[0] & ~(uint32_t)COUNTER_MASK;
    frame->data[0] = (uint8_t)(rest | ((uint32_t)*counter & COUNTER_MASK));
    frame->data[CRC_BYTE] = elmopp_link_crc(frame->id, frame->data);
    *counter = (uint8_t)((*counter + 1U) % ELMOPP_LINK_COUNTERS);
}
