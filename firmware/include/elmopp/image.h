/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Image: the envelope in which data reach the controller, a site (site.h) or weights (weights.h).
///
/// Says whether the bytes are those that a tool once wrote: magic, version, length, checksum. It decides nothing about
/// what is inside, copies nothing and keeps no state. Little-endian; all of our targets are.

#ifndef ELMOPP_IMAGE_H
#define ELMOPP_IMAGE_H

#include <stdint.h>

/// Bytes before the body: magic, version, length of the body, CRC-32 (IEEE 802.3) of the body; little-endian words.
#define ELMOPP_IMAGE_HEADER 16U

/// What is wrong with an envelope, in the order in which it is looked at.
typedef enum {
    ELMOPP_IMAGE_OK = 0,
    ELMOPP_IMAGE_MAGIC,   ///< too short, or begins with other letters
    ELMOPP_IMAGE_VERSION, ///< another layout
    ELMOPP_IMAGE_LENGTH,  ///< cut or too long
    ELMOPP_IMAGE_CRC      ///< changed on the way
} elmopp_image_fault_t;

/// What an image must be.
typedef struct {
    uint8_t magic[4];
    uint32_t version;
    uint32_t body_bytes;
} elmopp_image_kind_t;

/// First fault of `length` bytes that ought to be an image of this kind; its body begins at ELMOPP_IMAGE_HEADER.
elmopp_image_fault_t elmopp_image_check(const elmopp_image_kind_t *kind, const uint8_t *image, uint32_t length);

/// Writes the envelope in front of a body of this kind, which stands at ELMOPP_IMAGE_HEADER already.
void elmopp_image_seal(const elmopp_image_kind_t *kind, uint8_t *image);

/// The sum of no bytes.
#define ELMOPP_IMAGE_SUM_START 0xFFFFFFFFU

/// Goes on with a sum over `length` more bytes. The CRC-32 of all bytes is the complement of their sum.
uint32_t elmopp_image_sum(uint32_t sum, const uint8_t *bytes, uint32_t length);

#endif
