/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// A store in any state that it can have, over a medium that holds anything that it may have left there.
///
/// Parts 0 to 5, one a phase: the power is cut at any order, before it, within it or after it. What a start finds then
/// is the image that was in force, in its place and byte for byte; or, only if the order was a mark's, the new one,
/// which is whole. Never neither, never an older one. A mark that is there in full is the new one's. What a start finds
/// is again such a store. Parts 6 to 11: whatever is said of the order, what it leaves is such a store, too, and
/// "saved" is counted only if the mark stands. Part 12: so is what asking for room, or to save anything, leaves. From
/// order to order and start to start, that is any number of them.
///
/// A word that is cut has any of the ones yet that it ought to have lost, an erase any of the zeros. What passes an
/// image's check is left to chance, the same for the same bytes: it holds of any checksum. Bounded are the medium, two
/// sectors of SLOTS slots, and the image's body, one word; the code does not know either. Left out: a word that reads
/// otherwise at each start (tests/test_store.c tries that); a medium that says twice that a mark failed that stands; an
/// image in force that fails its check later, by itself.

#include "claims.h"

#include "store.c"

#define SECTORS 2U
#define SLOTS 1U
#define BODY 4U
#define IMAGE (ELMOPP_IMAGE_HEADER + BODY)
#define SLOT (ELMOPP_STORE_HEAD + IMAGE)
#define SECTOR ((SLOTS * SLOT) + ELMOPP_STORE_WORD)
#define MEDIUM (SECTORS * SECTOR)
#define IMAGE_WORDS (IMAGE / ELMOPP_STORE_WORD)
#define BLANK_WORD UINT32_MAX

typedef struct {
    uint8_t bytes[MEDIUM];
} bytes_t;

elmopp_store_t nondet_store(void);
bytes_t nondet_bytes(void);

#define PHASES 6
#define PHASE ((elmopp_store_phase_t)(PART % PHASES))

_Bool __CPROVER_uninterpreted_passes(uint32_t a, uint32_t b, uint32_t c, uint32_t d, uint32_t e);
elmopp_image_fault_t any_check(const elmopp_image_kind_t *kind, const uint8_t *image, uint32_t length);

elmopp_image_fault_t any_check(const elmopp_image_kind_t *kind, const uint8_t *image, uint32_t length) {
    CLAIM((kind->body_bytes == BODY) && (length == IMAGE), "an image of the kind is looked at");
    const bool passes = __CPROVER_uninterpreted_passes(word_of(image, 0U), word_of(image, 4U), word_of(image, 8U),
                                                       word_of(image, 12U), word_of(image, 16U));
    return passes ? ELMOPP_IMAGE_OK : ELMOPP_IMAGE_CRC;
}

static bytes_t now;  /* the medium */
static bytes_t sent; /* what is being saved: anything */

static uint32_t word_in(uint32_t slot, const elmopp_store_t *self, uint32_t at) {
    return word_of(now.bytes, slot_at(self, slot) + at);
}

static bool is_marked(const elmopp_store_t *self, uint32_t slot) {
    return word_in(slot, self, MARK_AT) == ELMOPP_STORE_MARK;
}

/* Of a slot that is neither the newest nor being written. */
static bool is_sound_slot(const elmopp_store_t *self, uint32_t slot) {
    const uint32_t mark = word_in(slot, self, MARK_AT);
    const uint32_t both = word_in(slot, self, NUMBER_AT) | word_in(slot, self, COMPLEMENT_AT);
    uint32_t number = 0U;
    uint32_t in_force = 0U;
    const bool numbered = is_numbered(self, slot, &number);
    const bool writes = (self->phase == ELMOPP_STORE_WRITING) || (self->phase == ELMOPP_STORE_SEALING);
    const bool is_target = writes && (slot == self->target);
    const bool older =
        (self->newest != ELMOPP_STORE_NONE) && is_numbered(self, self->newest, &in_force) && (number < in_force);
    return ((mark & ELMOPP_STORE_MARK) == ELMOPP_STORE_MARK) && (both == BLANK_WORD) &&
           ((!numbered) || is_target || (number <= self->highest)) &&
           ((!numbered) || is_target || (slot == self->newest) || (!is_marked(self, slot)) || older);
}

static bool is_sound_newest(const elmopp_store_t *self) {
    uint32_t number = 0U;
    return (self->newest == ELMOPP_STORE_NONE) ||
           ((self->newest < (SECTORS * SLOTS)) && is_numbered(self, self->newest, &number) &&
            is_marked(self, self->newest) && is_whole(self, self->newest));
}

static bool is_sound_target(const elmopp_store_t *self) {
    const uint32_t number = word_in(self->target, self, NUMBER_AT);
    const uint32_t complement = word_in(self->target, self, COMPLEMENT_AT);
    const uint32_t next = self->highest + 1U;
    if (self->phase == ELMOPP_STORE_SEALING) {
        return (number == next) && (complement == ~next) && is_whole(self, self->target);
    }
    const bool numbers = self->at == IMAGE_WORDS; /* perhaps in part, as long as it has not been answered */
    const bool complements = self->at == (IMAGE_WORDS + 1U);
    return (self->at < (IMAGE_WORDS + 2U)) && (word_in(self->target, self, MARK_AT) == BLANK_WORD) &&
           (numbers ? ((number & next) == next) : (number == (complements ? next : BLANK_WORD))) &&
           (complements ? ((complement & ~next) == ~next) : (complement == BLANK_WORD));
}

static bool is_sound_phase(const elmopp_store_t *self) {
    const bool sector = (self->sector < SECTORS) && (!holds_newest(self, self->sector));
    bool sound = true;
    switch (self->phase) {
    case ELMOPP_STORE_REFRESHING:
        sound = sector && (self->newest != ELMOPP_STORE_NONE);
        break;
    case ELMOPP_STORE_TIDYING:
        sound = sector;
        break;
    case ELMOPP_STORE_CLEARING:
        sound = sector && (self->target == (self->sector * SLOTS)) && (self->at == 0U) &&
                ((!self->erased) || is_blank(self, self->sector * SECTOR, SLOTS * SLOT));
        break;
    case ELMOPP_STORE_WRITING:
    case ELMOPP_STORE_SEALING:
        sound = (self->target < (SECTORS * SLOTS)) && (self->target != self->newest) && is_sound_target(self);
        break;
    case ELMOPP_STORE_IDLE:
        break;
    default:
        sound = false;
        break;
    }
    return sound;
}

static bool is_sound(const elmopp_store_t *self) {
    bool sound = is_sound_newest(self) && is_sound_phase(self);
    for (uint32_t slot = 0U; sound && (slot < (SECTORS * SLOTS)); slot++) {
        sound = is_sound_slot(self, slot);
    }
    return sound;
}

static elmopp_store_t any_store(void) {
    elmopp_store_t self = nondet_store();
    now = nondet_bytes();
    sent = nondet_bytes();
    self.medium = (elmopp_store_medium_t){now.bytes, SECTORS, SECTOR, SLOTS, SLOT, nondet_bool()};
    self.kind = (elmopp_image_kind_t){{'E', 'L', 'M', 'W'}, 2U, BODY};
    self.image = sent.bytes;
    self.phase = (PART < (2 * PHASES)) ? PHASE : self.phase;
    ASSUME(self.highest < (UINT32_MAX - 1U)); /* nobody saves so often */
    ASSUME(is_sound(&self));
    return self;
}

/* As much of it as the power lets through. */
static void carry_out(const elmopp_store_order_t *order, bool all) {
    const bytes_t chance = nondet_bytes();
    const uint32_t length = (order->action == ELMOPP_STORE_ERASE) ? SECTOR : ELMOPP_STORE_WORD;
    for (uint32_t i = 0U; i < length; i++) {
        const uint8_t old = now.bytes[order->at + i];
        const uint8_t wanted = (uint8_t)((order->word >> (8U * (i % ELMOPP_STORE_WORD))) & UINT8_MAX);
        const uint8_t erased = all ? 0xFFU : (uint8_t)(old | chance.bytes[i]);
        const uint8_t written = (uint8_t)(old & (all ? wanted : (uint8_t)(wanted | chance.bytes[i])));
        now.bytes[order->at + i] = (order->action == ELMOPP_STORE_ERASE) ? erased : written;
    }
}

#if PART == (2 * PHASES)

void harness(void) {
    elmopp_store_t self = any_store();
    if (nondet_bool()) {
        (void)elmopp_store_save(&self, sent.bytes);
    } else {
        ASSUME(self.phase == ELMOPP_STORE_IDLE);
        elmopp_store_tidy(&self);
    }
    CLAIM(is_sound(&self), "room and a beginning leave such a store");
    REACHABLE();
}

#else

void harness(void) {
    elmopp_store_t self = any_store();
    const elmopp_store_t before = self;
    const bytes_t was = now;
    const bool all = nondet_bool();
    elmopp_store_order_t order;
    const bool ordered = elmopp_store_next(&self, &order);
    CLAIM(ordered == (self.phase != ELMOPP_STORE_IDLE), "whoever is not idle orders something");
    if (ordered) {
        carry_out(&order, all);
    }
#if PART < PHASES
    elmopp_store_t found;
    const uint32_t k = nondet_u32();
    ASSUME(k < IMAGE);
    elmopp_store_init(&found, &self.medium, &self.kind);
    const bool sealing = before.phase == ELMOPP_STORE_SEALING;
    CLAIM((found.newest == before.newest) || (sealing && (found.newest == before.target)),
          "the old one or the new one");
    CLAIM((!sealing) || (!all) || (found.newest == before.target), "with its mark it is the new one");
    if (found.newest != ELMOPP_STORE_NONE) {
        const uint32_t at = slot_at(&found, found.newest) + ELMOPP_STORE_HEAD + k;
        CLAIM(now.bytes[at] == was.bytes[at], "byte for byte");
    }
    CLAIM(is_sound(&found), "a start finds such a store");
#else
    const elmopp_store_answer_t answer = (elmopp_store_answer_t)(nondet_u8() % 3U);
    const bool stands = is_marked(&self, before.target % (SECTORS * SLOTS));
    ASSUME((before.phase != ELMOPP_STORE_SEALING) || (!stands) || (!before.again) || (answer != ELMOPP_STORE_FAILED));
    elmopp_store_answer(&self, answer);
    CLAIM(is_sound(&self), "an answer leaves such a store");
    CLAIM((self.saved == before.saved) || ((before.phase == ELMOPP_STORE_SEALING) && stands),
          "saved is what is marked");
#endif
    REACHABLE();
}

#endif
