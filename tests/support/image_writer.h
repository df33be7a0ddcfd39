/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Writes images for the tests of loaders, with a checksum of its own: not the code under test.

#ifndef ELMOPP_TEST_IMAGE_WRITER_H
#define ELMOPP_TEST_IMAGE_WRITER_H

#include <stdint.h>

/// CRC-32 (IEEE 802.3), half a byte at a time.
uint32_t image_checksum(const uint8_t *bytes, uint32_t length);

/// Four bytes, little-endian.
void image_put_word(uint8_t *at, uint32_t word);

/// Writes the envelope in front of a body of so many bytes, which begins at image[16]. `magic` has four letters.
void image_seal(uint8_t *image, const char *magic, uint32_t version, uint32_t body_bytes);

#endif
