/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "bxcan_mailbox.h"

#define URGENT 0U /* the mailbox for it */
#define BYTES_OF_WORD 4U
#define BITS_OF_BYTE 8U

void elmopp_bxcan_mailboxes_init(elmopp_bxcan_mailboxes_t *self, elmopp_bxcan_registers_t *registers) {
    *self = (elmopp_bxcan_mailboxes_t){.registers = registers};
}

static uint32_t of_mailbox(uint32_t bits, uint32_t mailbox) {
    return bits << (ELMOPP_BXCAN_TSR_PER_MAILBOX * mailbox);
}

static bool is_empty(uint32_t status, uint32_t mailbox) {
    return (status & (ELMOPP_BXCAN_TSR_TME << mailbox)) != 0U;
}

void elmopp_bxcan_mailboxes_clear(elmopp_bxcan_mailboxes_t *self) {
    for (uint32_t m = 0U; m < ELMOPP_BXCAN_MAILBOXES; m++) {
        elmopp_register_write(&self->registers->tsr, of_mailbox(ELMOPP_BXCAN_TSR_ABRQ, m));
        self->unsent += self->letter[m].busy ? 1U : 0U;
        self->letter[m] = (elmopp_bxcan_letter_t){.busy = false};
    }
    self->unsent += self->count + (self->urgent_waits ? 1U : 0U);
    self->count = 0U;
    self->urgent_waits = false;
}

/* --- what waits --- */

bool elmopp_bxcan_mailboxes_put(elmopp_bxcan_mailboxes_t *self, const elmopp_frame_t *frame, uint32_t now_ms) {
    const elmopp_bxcan_waiting_t waiting = {.frame = *frame, .since_ms = now_ms};
    bool room = true;
    if (frame->id < ELMOPP_BXCAN_URGENT_BELOW) {
        self->unsent += self->urgent_waits ? 1U : 0U;
        self->urgent = waiting;
        self->urgent_waits = true;
    } else if (self->count < ELMOPP_BXCAN_QUEUE) {
        self->queue[(self->first + self->count) % ELMOPP_BXCAN_QUEUE] = waiting;
        self->count++;
    } else {
        self->unsent++;
        room = false;
    }
    return room;
}

static void leave_queue(elmopp_bxcan_mailboxes_t *self) {
    self->first = (self->first + 1U) % ELMOPP_BXCAN_QUEUE;
    self->count--;
}

static bool is_late(uint32_t since_ms, uint32_t now_ms) {
    return (now_ms - since_ms) >= ELMOPP_BXCAN_SEND_MS;
}

static void drop_late(elmopp_bxcan_mailboxes_t *self, uint32_t now_ms) {
    for (uint32_t k = 0U; k < ELMOPP_BXCAN_QUEUE; k++) {
        if ((self->count == 0U) || (!is_late(self->queue[self->first].since_ms, now_ms))) {
            break;
        }
        leave_queue(self);
        self->unsent++;
    }
    if (self->urgent_waits && is_late(self->urgent.since_ms, now_ms)) {
        self->urgent_waits = false;
        self->unsent++;
    }
}

/* --- mailboxes --- */

static uint32_t word_of(const uint8_t *bytes) {
    uint32_t word = 0U;
    for (uint32_t i = 0U; i < BYTES_OF_WORD; i++) {
        word |= (uint32_t)bytes[i] << (BITS_OF_BYTE * i);
    }
    return word;
}

static void load(elmopp_bxcan_mailboxes_t *self, uint32_t mailbox, const elmopp_bxcan_waiting_t *waiting) {
    elmopp_bxcan_slot_t *slot = &self->registers->mailbox[mailbox];
    const elmopp_frame_t *frame = &waiting->frame;
    const uint32_t id = (uint32_t)frame->id << ELMOPP_BXCAN_ID_STANDARD_AT;
    elmopp_register_write(&slot->id, id);
    elmopp_register_write(&slot->length, frame->length);
    elmopp_register_write(&slot->low, word_of(&frame->data[0]));
    elmopp_register_write(&slot->high, word_of(&frame->data[BYTES_OF_WORD]));
    elmopp_register_write(&slot->id, id | ELMOPP_BXCAN_ID_TXRQ);
    self->letter[mailbox] =
        (elmopp_bxcan_letter_t){.busy = true, .aborting = false, .id = frame->id, .since_ms = waiting->since_ms};
}

/* A mailbox that the hardware has given back. */
static void finish(elmopp_bxcan_mailboxes_t *self, uint32_t mailbox, uint32_t status) {
    const bool sent = (status & of_mailbox(ELMOPP_BXCAN_TSR_TXOK, mailbox)) != 0U;
    elmopp_register_write(&self->registers->tsr, of_mailbox(ELMOPP_BXCAN_TSR_RQCP, mailbox)); /* clears the others */
    self->sent += sent ? 1U : 0U;
    self->unsent += sent ? 0U : 1U;
    self->letter[mailbox].busy = false;
}

static void take_back(elmopp_bxcan_mailboxes_t *self, uint32_t mailbox, uint32_t now_ms) {
    elmopp_bxcan_letter_t *letter = &self->letter[mailbox];
    elmopp_register_write(&self->registers->tsr, of_mailbox(ELMOPP_BXCAN_TSR_ABRQ, mailbox));
    letter->aborting = true;
    letter->since_ms = now_ms;
}

/* False if it is broken. */
static bool look_after(elmopp_bxcan_mailboxes_t *self, uint32_t mailbox, uint32_t status, uint32_t now_ms) {
    const elmopp_bxcan_letter_t *letter = &self->letter[mailbox];
    const bool overtaken = (mailbox == URGENT) && self->urgent_waits;
    bool well = true;
    if (!letter->busy) {
        well = is_empty(status, mailbox);
    } else if (is_empty(status, mailbox)) {
        finish(self, mailbox, status);
    } else if (letter->aborting) {
        well = (now_ms - letter->since_ms) < ELMOPP_BXCAN_ABORT_MS;
    } else if (overtaken || is_late(letter->since_ms, now_ms)) {
        take_back(self, mailbox, now_ms);
    } else {
        /* on its way */
    }
    return well;
}

static bool is_under_way(const elmopp_bxcan_mailboxes_t *self, uint16_t id) {
    bool found = false;
    for (uint32_t m = 0U; m < ELMOPP_BXCAN_MAILBOXES; m++) {
        found = found || (self->letter[m].busy && (self->letter[m].id == id));
    }
    return found;
}

static void fill(elmopp_bxcan_mailboxes_t *self) {
    if (self->urgent_waits && (!self->letter[URGENT].busy)) {
        load(self, URGENT, &self->urgent);
        self->urgent_waits = false;
    }
    for (uint32_t m = URGENT + 1U; m < ELMOPP_BXCAN_MAILBOXES; m++) {
        const elmopp_bxcan_waiting_t *next = &self->queue[self->first];
        if ((self->count > 0U) && (!self->letter[m].busy) && (!is_under_way(self, next->frame.id))) {
            load(self, m, next);
            leave_queue(self);
        }
    }
}

bool elmopp_bxcan_mailboxes_step(elmopp_bxcan_mailboxes_t *self, uint32_t now_ms) {
    const uint32_t status = elmopp_register_read(&self->registers->tsr);
    bool well = true;
    drop_late(self, now_ms);
    for (uint32_t m = 0U; m < ELMOPP_BXCAN_MAILBOXES; m++) {
        well = look_after(self, m, status, now_ms) && well;
    }
    if (well) {
        fill(self);
    }
    return well;
}
