/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/store.h"

#include "elmopp/assert.h"

#include <stddef.h>

#define BLANK_BYTE 0xFFU
#define NUMBER_AT 0U
#define COMPLEMENT_AT 4U
#define MARK_AT 8U

/* --- what stands where --- */

static uint32_t word_of(const uint8_t *bytes, uint32_t at) {
    uint32_t word = 0U;
    for (uint32_t i = ELMOPP_STORE_WORD; i > 0U; i--) {
        word = (word << 8U) | bytes[at + i - 1U];
    }
    return word;
}

static uint32_t slot_count(const elmopp_store_t *self) {
    return (self->medium.bytes == NULL) ? 0U : (self->medium.sectors * self->medium.sector_slots);
}

static uint32_t sector_of(const elmopp_store_t *self, uint32_t slot) {
    return slot / self->medium.sector_slots;
}

static uint32_t slot_at(const elmopp_store_t *self, uint32_t slot) {
    const uint32_t in_sector = slot % self->medium.sector_slots;
    return (sector_of(self, slot) * self->medium.sector_bytes) + (in_sector * self->medium.slot_bytes);
}

static uint32_t bytes_of_image(const elmopp_store_t *self) {
    return ELMOPP_IMAGE_HEADER + self->kind.body_bytes;
}

static bool is_blank(const elmopp_store_t *self, uint32_t at, uint32_t length) {
    bool blank = true;
    for (uint32_t i = 0U; blank && (i < length); i++) {
        blank = self->medium.bytes[at + i] == BLANK_BYTE;
    }
    return blank;
}

static uint32_t ready_mark_at(const elmopp_store_t *self, uint32_t sector) {
    return ((sector + 1U) * self->medium.sector_bytes) - ELMOPP_STORE_WORD;
}

/* Its last erase has come to its end. */
static bool is_ready(const elmopp_store_t *self, uint32_t sector) {
    return word_of(self->medium.bytes, ready_mark_at(self, sector)) == ELMOPP_STORE_MARK;
}

static bool is_free_slot(const elmopp_store_t *self, uint32_t slot) {
    return is_ready(self, sector_of(self, slot)) && is_blank(self, slot_at(self, slot), self->medium.slot_bytes);
}

static bool is_free_sector(const elmopp_store_t *self, uint32_t sector) {
    const uint32_t length = self->medium.sector_bytes - ELMOPP_STORE_WORD;
    return is_ready(self, sector) && is_blank(self, sector * self->medium.sector_bytes, length);
}

static bool holds_newest(const elmopp_store_t *self, uint32_t sector) {
    return (self->newest != ELMOPP_STORE_NONE) && (sector_of(self, self->newest) == sector);
}

static bool is_whole(const elmopp_store_t *self, uint32_t slot) {
    const uint8_t *image = &self->medium.bytes[slot_at(self, slot) + ELMOPP_STORE_HEAD];
    return elmopp_image_check(&self->kind, image, bytes_of_image(self)) == ELMOPP_IMAGE_OK;
}

static bool is_numbered(const elmopp_store_t *self, uint32_t slot, uint32_t *number) {
    const uint32_t head = slot_at(self, slot);
    *number = word_of(self->medium.bytes, head + NUMBER_AT);
    return (*number != UINT32_MAX) && (word_of(self->medium.bytes, head + COMPLEMENT_AT) == ~*number);
}

/* A mark that was cut may be read at one start and not at another: no number is used a second time, marked or not. */
static void find_newest(elmopp_store_t *self) {
    uint32_t newest_number = 0U;
    self->newest = ELMOPP_STORE_NONE;
    self->highest = 0U;
    for (uint32_t slot = 0U; slot < slot_count(self); slot++) {
        uint32_t number = 0U;
        if (is_numbered(self, slot, &number)) {
            const bool marked = word_of(self->medium.bytes, slot_at(self, slot) + MARK_AT) == ELMOPP_STORE_MARK;
            const bool newer = (self->newest == ELMOPP_STORE_NONE) || (number > newest_number);
            if (marked && newer && is_whole(self, slot)) {
                self->newest = slot;
                newest_number = number;
            }
            self->highest = (number > self->highest) ? number : self->highest;
        }
    }
}

void elmopp_store_init(elmopp_store_t *self, const elmopp_store_medium_t *medium, const elmopp_image_kind_t *kind) {
    *self = (elmopp_store_t){
        .medium = *medium, .kind = *kind, .phase = ELMOPP_STORE_IDLE, .newest = ELMOPP_STORE_NONE, .image = NULL};
    if (medium->bytes != NULL) {
        ELMOPP_ASSERT((medium->sectors >= 2U) && (medium->sector_slots >= 1U));
        ELMOPP_ASSERT(((medium->slot_bytes % ELMOPP_STORE_WORD) == 0U) &&
                      ((kind->body_bytes % ELMOPP_STORE_WORD) == 0U));
        ELMOPP_ASSERT((ELMOPP_STORE_HEAD + bytes_of_image(self)) <= medium->slot_bytes);
        ELMOPP_ASSERT(((medium->sector_slots * medium->slot_bytes) + ELMOPP_STORE_WORD) <= medium->sector_bytes);
        find_newest(self);
    }
}

const uint8_t *elmopp_store_newest(const elmopp_store_t *self) {
    return (self->newest == ELMOPP_STORE_NONE) ? NULL
                                               : &self->medium.bytes[slot_at(self, self->newest) + ELMOPP_STORE_HEAD];
}

/* Number and complement fit each other only as long as no bit of them has changed, and the mark came after the whole.
 */
bool elmopp_store_is_damaged(const elmopp_store_t *self) {
    uint32_t newest_number = 0U;
    bool damaged = false;
    if (self->newest != ELMOPP_STORE_NONE) {
        (void)is_numbered(self, self->newest, &newest_number);
    }
    for (uint32_t slot = 0U; slot < slot_count(self); slot++) {
        uint32_t number = 0U;
        const bool marked = word_of(self->medium.bytes, slot_at(self, slot) + MARK_AT) == ELMOPP_STORE_MARK;
        if (marked && is_numbered(self, slot, &number) && (number > newest_number)) {
            damaged = damaged || (!is_whole(self, slot));
        }
    }
    return damaged;
}

/* --- room --- */

/* The next sector from `from` on that has nothing in force and something in it; `sectors` if there is none. */
static uint32_t next_untidy(const elmopp_store_t *self, uint32_t from) {
    uint32_t sector = from;
    while ((sector < self->medium.sectors) && (holds_newest(self, sector) || is_free_sector(self, sector))) {
        sector++;
    }
    return sector;
}

void elmopp_store_tidy(elmopp_store_t *self) {
    ELMOPP_ASSERT(self->phase == ELMOPP_STORE_IDLE);
    const uint32_t untidy = (self->medium.bytes == NULL) ? self->medium.sectors : next_untidy(self, 0U);
    if (untidy < self->medium.sectors) {
        self->sector = untidy;
        self->erased = false;
        self->phase = (self->newest == ELMOPP_STORE_NONE) ? ELMOPP_STORE_TIDYING : ELMOPP_STORE_REFRESHING;
    }
}

/* A slot to write to; in the newest one's sector first, so that the other ones can be erased as long as possible. */
static uint32_t free_slot(const elmopp_store_t *self) {
    uint32_t found = ELMOPP_STORE_NONE;
    bool beside = false;
    for (uint32_t slot = 0U; (!beside) && (slot < slot_count(self)); slot++) {
        const bool here = holds_newest(self, sector_of(self, slot));
        if (((found == ELMOPP_STORE_NONE) || here) && is_free_slot(self, slot)) {
            found = slot;
            beside = here;
        }
    }
    return found;
}

bool elmopp_store_has_room(const elmopp_store_t *self) {
    const bool can_be_made = self->medium.erases_any_time && (self->medium.bytes != NULL);
    return (self->phase == ELMOPP_STORE_IDLE) && (can_be_made || (free_slot(self) != ELMOPP_STORE_NONE));
}

bool elmopp_store_save(elmopp_store_t *self, const uint8_t *image) {
    if (!elmopp_store_has_room(self)) {
        return false;
    }
    self->image = image;
    self->at = 0U;
    self->again = false;
    self->target = free_slot(self);
    self->phase = ELMOPP_STORE_WRITING;
    if (self->target == ELMOPP_STORE_NONE) {
        self->sector = holds_newest(self, 0U) ? 1U : 0U;
        self->target = self->sector * self->medium.sector_slots;
        self->erased = false;
        self->phase = ELMOPP_STORE_CLEARING;
    }
    return true;
}

/* --- orders --- */

static elmopp_store_order_t seal_of(const elmopp_store_t *self, uint32_t slot) {
    return (elmopp_store_order_t){
        .action = ELMOPP_STORE_SEAL, .at = slot_at(self, slot) + MARK_AT, .word = ELMOPP_STORE_MARK};
}

static elmopp_store_order_t clear_of(const elmopp_store_t *self) {
    elmopp_store_order_t order = {
        .action = ELMOPP_STORE_ERASE, .at = self->sector * self->medium.sector_bytes, .word = 0U};
    if (self->erased) {
        order.action = ELMOPP_STORE_PROGRAM;
        order.at = ready_mark_at(self, self->sector);
        order.word = ELMOPP_STORE_MARK;
    }
    return order;
}

/* The image's words, then the two of the number: whatever comes before the mark is in no hurry to be in order. */
static elmopp_store_order_t write_of(const elmopp_store_t *self) {
    const uint32_t slot = slot_at(self, self->target);
    const uint32_t byte = self->at * ELMOPP_STORE_WORD;
    const uint32_t number = self->highest + 1U;
    elmopp_store_order_t order = {.action = ELMOPP_STORE_PROGRAM, .at = slot + ELMOPP_STORE_HEAD + byte, .word = 0U};
    if (byte < bytes_of_image(self)) {
        order.word = word_of(self->image, byte);
    } else if (byte == bytes_of_image(self)) {
        order.at = slot + NUMBER_AT;
        order.word = number;
    } else {
        order.at = slot + COMPLEMENT_AT;
        order.word = ~number;
    }
    return order;
}

static uint32_t words_to_write(const elmopp_store_t *self) {
    return (bytes_of_image(self) / ELMOPP_STORE_WORD) + 2U;
}

bool elmopp_store_next(const elmopp_store_t *self, elmopp_store_order_t *order) {
    bool something = true;
    switch (self->phase) {
    case ELMOPP_STORE_REFRESHING:
        *order = seal_of(self, self->newest);
        break;
    case ELMOPP_STORE_TIDYING:
    case ELMOPP_STORE_CLEARING:
        *order = clear_of(self);
        break;
    case ELMOPP_STORE_WRITING:
        *order = write_of(self);
        break;
    case ELMOPP_STORE_SEALING:
        *order = seal_of(self, self->target);
        break;
    case ELMOPP_STORE_IDLE:
    default:
        something = false;
        break;
    }
    return something;
}

static void count_one(uint16_t *counter) {
    *counter = (*counter < UINT16_MAX) ? (uint16_t)(*counter + 1U) : *counter;
}

/* What has failed may stand there all the same, mark and all: its number is not used again. */
static void give_up(elmopp_store_t *self) {
    count_one(&self->failed);
    self->highest++;
    self->phase = ELMOPP_STORE_IDLE;
}

/* A sector that cannot be erased is left alone, so that the others have their turn. */
static void next_sector(elmopp_store_t *self) {
    self->sector = next_untidy(self, self->sector + 1U);
    self->erased = false;
    self->phase = (self->sector < self->medium.sectors) ? ELMOPP_STORE_TIDYING : ELMOPP_STORE_IDLE;
}

/* Before the mark, once more the whole: what was programmed long ago may have failed since. */
static void go_on_writing(elmopp_store_t *self) {
    self->at++;
    if (self->at == words_to_write(self)) {
        self->phase = ELMOPP_STORE_SEALING;
        if (!is_whole(self, self->target)) {
            give_up(self);
        }
    }
}

static void finish(elmopp_store_t *self) {
    self->newest = self->target;
    self->highest++;
    self->phase = ELMOPP_STORE_IDLE;
    count_one(&self->saved);
}

/* A sector is erased, then marked as ready. */
static void go_on_clearing(elmopp_store_t *self) {
    if (!self->erased) {
        self->erased = true;
    } else if (self->phase == ELMOPP_STORE_TIDYING) {
        next_sector(self);
    } else {
        self->phase = ELMOPP_STORE_WRITING;
    }
}

static void advance(elmopp_store_t *self) {
    switch (self->phase) {
    case ELMOPP_STORE_REFRESHING:
        self->phase = ELMOPP_STORE_TIDYING;
        break;
    case ELMOPP_STORE_TIDYING:
    case ELMOPP_STORE_CLEARING:
        go_on_clearing(self);
        break;
    case ELMOPP_STORE_WRITING:
        go_on_writing(self);
        break;
    case ELMOPP_STORE_SEALING:
        finish(self);
        break;
    case ELMOPP_STORE_IDLE:
    default:
        /* nothing was ordered */
        break;
    }
}

/* It reads back as what was ordered. */
static bool is_as_ordered(const elmopp_store_t *self, const elmopp_store_order_t *order) {
    return (order->action == ELMOPP_STORE_ERASE) ? is_blank(self, order->at, self->medium.sector_bytes)
                                                 : (word_of(self->medium.bytes, order->at) == order->word);
}

void elmopp_store_answer(elmopp_store_t *self, elmopp_store_answer_t answer) {
    elmopp_store_order_t order;
    if ((answer == ELMOPP_STORE_LATER) || (!elmopp_store_next(self, &order))) {
        return;
    }
    const bool stands = is_as_ordered(self, &order);
    if ((answer == ELMOPP_STORE_DONE) && stands) {
        advance(self);
    } else if ((self->phase == ELMOPP_STORE_SEALING) && stands && (!self->again)) {
        self->again = true; /* a mark that stands, and of which it is said that it does not: once more */
    } else if (self->phase == ELMOPP_STORE_TIDYING) {
        count_one(&self->failed);
        next_sector(self);
    } else {
        give_up(self);
    }
}
