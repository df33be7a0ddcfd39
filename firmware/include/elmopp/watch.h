/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Watch: are data that must not change still what they were?
///
/// Sums the bytes up once at the start, and then again and again, a piece at a time, so that no tick pays for all of
/// them. It decides nothing about what a change means and mends nothing. The bytes belong to whoever hands them over
/// and must outlive the watch, or the next one over others. Not thread-safe; one owner.

#ifndef ELMOPP_WATCH_H
#define ELMOPP_WATCH_H

#include <stdbool.h>
#include <stdint.h>

/// Bytes that one piece sums up.
#define ELMOPP_WATCH_PIECE_BYTES 64U

/// Set up by elmopp_watch_over(); nobody else writes it.
typedef struct {
    const uint8_t *bytes; ///< null: nothing to watch
    uint32_t length;
    uint32_t at;       ///< next byte
    uint32_t sum;      ///< of the bytes before it
    uint32_t expected; ///< of all
} elmopp_watch_t;

/// Sums up `length` bytes as they should stay; null watches nothing, and its sum is 0.
elmopp_watch_t elmopp_watch_over(const uint8_t *bytes, uint32_t length);

/// A piece more. False when the whole has been summed up and is no longer what it was; then it begins anew.
bool elmopp_watch_is_unchanged(elmopp_watch_t *self);

#endif
