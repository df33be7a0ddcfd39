/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Store: an image (image.h) that outlives a reset, in a memory whose writing may be cut off at any moment.
///
/// A medium is two sectors or more, a sector one slot or more; a sector is erased as a whole, a word is programmed
/// once. An image goes into a slot that is blank, never over the one that is in force, and the slot's mark is the last
/// word that is programmed: until it stands the old image is in force, afterwards the new one. Of the slots that are
/// whole, marked and pass elmopp_image_check(), the one with the highest number is the newest. So a cut, also within a
/// word or within an erase, leaves the old image or the new one (tests/test_store.c tries every one of them).
///
/// It decides what is to be written next and does no writing: it gives one order after the other, whoever owns the
/// medium carries it out when he can and answers. No call waits. What an image means, and how often one may be stored,
/// is for others to say.
///
/// What is cut may read well now and badly later. So a sector that has been erased to the end is marked as ready in its
/// last word, and only such a sector is written to; the first word of a slot is always the same, and may be programmed
/// twice; and a newest mark is programmed once more before its predecessors are erased.
///
/// A slot: number, its complement, mark, a word that stays blank, the image. Blank is all ones, as of flash.
///
/// Not thread-safe; one owner. The medium and an image that is being saved belong to the caller and must outlive it.

#ifndef ELMOPP_STORE_H
#define ELMOPP_STORE_H

#include "elmopp/image.h"

#include <stdbool.h>
#include <stdint.h>

#define ELMOPP_STORE_HEAD 16U ///< bytes of a slot before its image
#define ELMOPP_STORE_WORD 4U

/// Stands in a slot that is complete. A word that is cut while it is programmed has more ones than this.
#define ELMOPP_STORE_MARK 0x4B455054U

/// Where images are kept. All sizes in bytes, multiples of a word.
typedef struct {
    const uint8_t *bytes; ///< as it reads now; null: there is no medium, nothing is ever stored
    uint32_t sectors;     ///< two or more
    uint32_t sector_bytes;
    uint32_t sector_slots; ///< of a sector; a word at least is left of its bytes
    uint32_t slot_bytes;   ///< room for ELMOPP_STORE_HEAD and an image
    bool erases_any_time;  ///< false: only before lamps are driven, by elmopp_store_tidy(); erasing holds everything up
} elmopp_store_medium_t;

typedef enum {
    ELMOPP_STORE_ERASE = 0,   ///< the sector that begins at `at`
    ELMOPP_STORE_PROGRAM = 1, ///< `word` at `at`, little-endian; where ones stand, or the same word
    ELMOPP_STORE_SEAL = 2     ///< the same, the mark of a slot: everything before it must have reached the medium
} elmopp_store_action_t;

/// What is to be done to the medium next.
typedef struct {
    elmopp_store_action_t action;
    uint32_t at; ///< byte of the medium
    uint32_t word;
} elmopp_store_order_t;

typedef enum {
    ELMOPP_STORE_DONE = 0,
    ELMOPP_STORE_LATER = 1, ///< under way, or not now: the same order comes again
    ELMOPP_STORE_FAILED = 2
} elmopp_store_answer_t;

typedef enum {
    ELMOPP_STORE_IDLE = 0,
    ELMOPP_STORE_REFRESHING, ///< the newest mark once more, before its predecessor goes
    ELMOPP_STORE_TIDYING,    ///< sectors that hold nothing in force are erased
    ELMOPP_STORE_CLEARING,   ///< the sector for what is to be saved is erased
    ELMOPP_STORE_WRITING,    ///< image, number, its complement
    ELMOPP_STORE_SEALING
} elmopp_store_phase_t;

/// State. Set up by elmopp_store_init(); read `phase` and the counts, write nothing.
typedef struct {
    elmopp_store_medium_t medium;
    elmopp_image_kind_t kind;
    const uint8_t *image; ///< that is being saved
    elmopp_store_phase_t phase;
    uint32_t newest;  ///< slot, or ELMOPP_STORE_NONE
    uint32_t highest; ///< number of a slot, marked or not
    uint32_t target;  ///< slot that is being written
    uint32_t sector;  ///< that is being erased
    uint32_t at;      ///< word of the target
    bool erased;      ///< the sector has been, and is yet to be marked as ready
    bool again;       ///< the mark is being programmed a second time
    uint16_t saved;   ///< since the start; saturates
    uint16_t failed;  ///< orders that were not carried out; saturates
} elmopp_store_t;

#define ELMOPP_STORE_NONE UINT32_MAX

/// Finds the newest image. Asserts a medium whose slots have room for the kind, if there is one.
void elmopp_store_init(elmopp_store_t *self, const elmopp_store_medium_t *medium, const elmopp_image_kind_t *kind);

/// The image in force, in place; null: none. It stays where it is until something newer has been saved and
/// elmopp_store_tidy() or the next elmopp_store_save() follows.
const uint8_t *elmopp_store_newest(const elmopp_store_t *self);

/// True if a slot stands that was complete once, is newer than the newest image and is none any more: it was changed
/// where it lay. A cut makes no such slot.
bool elmopp_store_is_damaged(const elmopp_store_t *self);

/// Asks for room: everything that is not in force is erased. Only from idle, and only before lamps are driven.
void elmopp_store_tidy(elmopp_store_t *self);

/// True if an image could be saved now: idle, and there is a blank slot or one that may be made so.
bool elmopp_store_has_room(const elmopp_store_t *self);

/// Begins to save an image of the kind, which must not change until the phase is idle again. False without room. It is
/// saved when `saved` has grown. If `failed` has it is not in force now; if it was the mark that failed, and twice, it
/// may be in force after the next start.
bool elmopp_store_save(elmopp_store_t *self, const uint8_t *image);

/// The next order; false: nothing is to be done.
bool elmopp_store_next(const elmopp_store_t *self, elmopp_store_order_t *order);

/// What became of it. What says that it is done is looked at: a word or a sector that does not read back is a failure.
void elmopp_store_answer(elmopp_store_t *self, elmopp_store_answer_t answer);

#endif
