/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The sending end of a transfer for tests, written from ISO 15765-2 apart from the firmware and from elmopp-send.

#ifndef ELMOPP_TEST_SEGMENTS_H
#define ELMOPP_TEST_SEGMENTS_H

#include "elmopp/link.h"

#include <stdint.h>

#define SEGMENTS_TRANSFER 0x300U
#define SEGMENTS_ACK 0x301U

/// How many frames so many bytes are.
uint32_t segments_count(uint32_t length);

/// Frame number `index` of them; 0 is the first frame.
elmopp_frame_t segments_frame(const uint8_t *bytes, uint32_t length, uint32_t index);

#endif
