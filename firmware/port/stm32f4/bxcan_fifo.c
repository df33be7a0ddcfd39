/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "bxcan_fifo.h"

#include "elmopp/assert.h"

#define FIFO 0U /* everything goes to the first one */
#define IDS_OF_BANK 4U
#define ID_BITS 16U
#define BYTES_OF_WORD 4U
#define BITS_OF_BYTE 8U
#define RELEASE_READS 8U /* a release takes a clock or two of the bus, a read of a register more */

void elmopp_bxcan_fifo_init(elmopp_bxcan_fifo_t *self, elmopp_bxcan_registers_t *registers) {
    self->registers = registers;
    atomic_init(&self->put, 0U);
    atomic_init(&self->taken, 0U);
    atomic_init(&self->lost, 0U);
    atomic_init(&self->masked, 0U);
    atomic_init(&self->stuck, 0U);
}

/* --- filters --- */

static uint32_t entry(const uint16_t *ids, uint32_t count, uint32_t index) {
    const uint32_t last = (index < count) ? index : (count - 1U); /* a bank is filled up with the last id again */
    return (uint32_t)ids[last] << ELMOPP_BXCAN_BANK_ID_AT;
}

void elmopp_bxcan_fifo_filter(elmopp_bxcan_fifo_t *self, const uint16_t *ids, uint32_t count) {
    ELMOPP_ASSERT((count > 0U) && (count <= ELMOPP_BXCAN_IDS_MAX));
    elmopp_bxcan_registers_t *can = self->registers;
    const uint32_t banks = (count + (IDS_OF_BANK - 1U)) / IDS_OF_BANK;
    const uint32_t used = ELMOPP_BIT(banks) - 1U;
    const uint32_t split = ELMOPP_BXCAN_CAN1_BANKS << ELMOPP_BXCAN_FMR_CAN2SB_AT;
    elmopp_register_write(&can->fmr, split | ELMOPP_BXCAN_FMR_FINIT);
    elmopp_register_write(&can->fa1r, 0U);
    elmopp_register_write(&can->fm1r, used); /* lists of ids */
    elmopp_register_write(&can->fs1r, 0U);   /* of 16 bits */
    elmopp_register_write(&can->ffa1r, 0U);  /* into the first FIFO */
    for (uint32_t b = 0U; b < banks; b++) {
        const uint32_t at = IDS_OF_BANK * b;
        elmopp_register_write(&can->bank[b][0], entry(ids, count, at) | (entry(ids, count, at + 1U) << ID_BITS));
        elmopp_register_write(&can->bank[b][1], entry(ids, count, at + 2U) | (entry(ids, count, at + 3U) << ID_BITS));
    }
    elmopp_register_write(&can->fa1r, used);
    elmopp_register_write(&can->fmr, split);
}

/* --- interrupt --- */

void elmopp_bxcan_fifo_listen(elmopp_bxcan_fifo_t *self, bool on) {
    atomic_store(&self->masked, 0U);
    atomic_store(&self->stuck, 0U);
    elmopp_register_write(&self->registers->ier, on ? ELMOPP_BXCAN_IER_FMPIE0 : 0U);
}

static void mask(elmopp_bxcan_fifo_t *self) {
    elmopp_register_write(&self->registers->ier, 0U);
    atomic_store(&self->masked, 1U);
}

static void unpack(uint32_t word, uint8_t *bytes) {
    for (uint32_t i = 0U; i < BYTES_OF_WORD; i++) {
        bytes[i] = (uint8_t)((word >> (BITS_OF_BYTE * i)) & UINT8_MAX);
    }
}

/* The frame at the output. What is not a data frame with an 11-bit id has passed no filter; it is left out. */
static bool read_output(const elmopp_bxcan_slot_t *slot, elmopp_frame_t *frame) {
    const uint32_t id = elmopp_register_read(&slot->id);
    const uint32_t length = elmopp_register_read(&slot->length) & ELMOPP_BXCAN_LENGTH_DLC;
    frame->id = (uint16_t)((id >> ELMOPP_BXCAN_ID_STANDARD_AT) & ELMOPP_BXCAN_ID_STANDARD);
    frame->length = (uint8_t)((length < ELMOPP_LINK_BYTES) ? length : ELMOPP_LINK_BYTES);
    unpack(elmopp_register_read(&slot->low), &frame->data[0]);
    unpack(elmopp_register_read(&slot->high), &frame->data[BYTES_OF_WORD]);
    return (id & (ELMOPP_BXCAN_ID_IDE | ELMOPP_BXCAN_ID_RTR)) == 0U;
}

static void count_overrun(elmopp_bxcan_fifo_t *self, uint32_t status) {
    if ((status & ELMOPP_BXCAN_RFR_FOVR) != 0U) {
        elmopp_register_write(&self->registers->rfr[FIFO], ELMOPP_BXCAN_RFR_FOVR);
        (void)atomic_fetch_add(&self->lost, 1U);
    }
}

/* Gives the output back; false if the hardware does not take it. */
static bool release(elmopp_bxcan_registers_t *can) {
    bool released = false;
    elmopp_register_write(&can->rfr[FIFO], ELMOPP_BXCAN_RFR_RFOM);
    for (uint32_t k = 0U; (k < RELEASE_READS) && (!released); k++) {
        released = (elmopp_register_read(&can->rfr[FIFO]) & ELMOPP_BXCAN_RFR_RFOM) == 0U;
    }
    return released;
}

void elmopp_bxcan_fifo_interrupt(elmopp_bxcan_fifo_t *self) {
    elmopp_bxcan_registers_t *can = self->registers;
    for (uint32_t k = 0U; k < ELMOPP_BXCAN_STAGES; k++) {
        const uint32_t status = elmopp_register_read(&can->rfr[FIFO]);
        const uint32_t put = atomic_load(&self->put);
        count_overrun(self, status);
        if ((status & ELMOPP_BXCAN_RFR_FMP) == 0U) {
            return;
        }
        if ((put - atomic_load(&self->taken)) >= ELMOPP_BXCAN_RING) {
            mask(self);
            return;
        }
        const bool wanted = read_output(&can->fifo[FIFO], &self->frame[put % ELMOPP_BXCAN_RING]);
        atomic_store(&self->put, wanted ? (put + 1U) : put);
        if (!release(can)) {
            atomic_store(&self->stuck, 1U);
            mask(self);
            return;
        }
    }
}

/* --- main loop --- */

bool elmopp_bxcan_fifo_take(elmopp_bxcan_fifo_t *self, elmopp_frame_t *frame) {
    const uint32_t taken = atomic_load(&self->taken);
    if (taken == atomic_load(&self->put)) {
        if ((atomic_load(&self->masked) != 0U) && (atomic_load(&self->stuck) == 0U)) {
            elmopp_bxcan_fifo_listen(self, true);
        }
        return false;
    }
    *frame = self->frame[taken % ELMOPP_BXCAN_RING];
    atomic_store(&self->taken, taken + 1U);
    return true;
}
