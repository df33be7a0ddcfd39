/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// A receiver in any state that a transfer can have, with a buffer that is exactly as long as was announced, whatever
/// frame comes, or none:
///
/// Part 0: what was a first frame leaves such a state. Part 1: whatever comes next does, too; nothing is written beyond
/// the buffer, what has come before stays, and a frame that is taken brings at least a byte nearer to the end, so that
/// a transfer has an end. Part 2: so has silence: after ELMOPP_TRANSFER_TIMEOUT_DS ticks nothing is being received.
///
/// Any length up to LENGTH_MAX; the code has no loop and no branch that depends on a larger one but for the two heads
/// of a first frame, and both are below it.

#include "claims.h"

#include "elmopp/transfer.h"

#include <stdlib.h>

#define LENGTH_MAX 65536U

elmopp_transfer_t nondet_transfer(void);
elmopp_frame_t nondet_frame(void);

static bool is_sound(const elmopp_transfer_t *self) {
    return (!self->receiving) ||
           ((self->got < self->length) && (self->next < 16U) && (self->block >= 1U) &&
            (self->block <= ELMOPP_TRANSFER_BLOCK) && (self->age_ds < ELMOPP_TRANSFER_TIMEOUT_DS));
}

#if PART == 0

void harness(void) {
    elmopp_transfer_t self = nondet_transfer();
    const elmopp_frame_t frame = nondet_frame();
    const uint32_t length = elmopp_transfer_announced(&frame);
    ASSUME((length != 0U) && (length <= LENGTH_MAX));
    uint8_t *bytes = malloc(length);
    ASSUME(bytes != NULL);
    elmopp_transfer_begin(&self, &frame, bytes);
    CLAIM(self.receiving && is_sound(&self), "a first frame begins a transfer");
    CLAIM((self.length == length) && (self.bytes == bytes), "into the bytes given");
    REACHABLE();
}

#else

void harness(void) {
    elmopp_transfer_t self = nondet_transfer();
    ASSUME((self.length >= 1U) && (self.length <= LENGTH_MAX));
    self.bytes = malloc(self.length);
    ASSUME((self.bytes != NULL) && is_sound(&self));
#if PART == 1
    const elmopp_transfer_t before = self;
    const elmopp_frame_t frame = nondet_frame();
    const uint32_t old = nondet_u32();
    ASSUME((old < before.length) && ((!before.receiving) || (old < before.got)));
    const uint8_t byte = self.bytes[old];
    const elmopp_transfer_verdict_t verdict = elmopp_transfer_take(&self, &frame);
    const bool taken = (verdict == ELMOPP_TRANSFER_TAKEN) || (verdict == ELMOPP_TRANSFER_WHOLE);
    CLAIM(is_sound(&self), "what comes leaves a state that a transfer can have");
    CLAIM((self.bytes == before.bytes) && (self.length == before.length), "nobody else's bytes");
    CLAIM(self.bytes[old] == byte, "what has come before stays");
    CLAIM((!taken) || (before.receiving && (self.got > before.got)), "a frame that is taken brings it nearer");
    CLAIM(taken || (self.got == before.got), "one that is not brings nothing");
    CLAIM((verdict != ELMOPP_TRANSFER_WHOLE) || ((self.got == self.length) && (!self.receiving)), "whole is all of it");
#else
    for (uint32_t k = 0U; k < ELMOPP_TRANSFER_TIMEOUT_DS; k++) {
        (void)elmopp_transfer_tick(&self);
    }
    CLAIM(!self.receiving, "silence ends a transfer");
#endif
    REACHABLE();
}

#endif
