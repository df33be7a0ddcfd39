/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/watch.h"

#include "elmopp/image.h"

#include <stddef.h>

elmopp_watch_t elmopp_watch_over(const uint8_t *bytes, uint32_t length) {
    const uint32_t sum = (bytes == NULL) ? 0U : elmopp_image_sum(ELMOPP_IMAGE_SUM_START, bytes, length);
    return (elmopp_watch_t){.bytes = bytes, .length = length, .at = 0U, .sum = ELMOPP_IMAGE_SUM_START, .expected = sum};
}

bool elmopp_watch_is_unchanged(elmopp_watch_t *self) {
    if (self->bytes == NULL) {
        return true;
    }
    const uint32_t left = self->length - self->at;
    const uint32_t piece = (left < ELMOPP_WATCH_PIECE_BYTES) ? left : ELMOPP_WATCH_PIECE_BYTES;
    self->sum = elmopp_image_sum(self->sum, &self->bytes[self->at], piece);
    self->at += piece;
    const bool whole = self->at == self->length;
    const bool same = (!whole) || (self->sum == self->expected);
    self->at = whole ? 0U : self->at;
    self->sum = whole ? ELMOPP_IMAGE_SUM_START : self->sum;
    return same;
}
