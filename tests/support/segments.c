/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "segments.h"

static uint32_t in_first(uint32_t length) {
    return (length > 4095U) ? 2U : 6U;
}

uint32_t segments_count(uint32_t length) {
    return 1U + ((length - in_first(length) + 6U) / 7U);
}

elmopp_frame_t segments_frame(const uint8_t *bytes, uint32_t length, uint32_t index) {
    elmopp_frame_t frame = {.id = SEGMENTS_TRANSFER, .length = 8U, .data = {0U}};
    const uint32_t first = in_first(length);
    uint32_t from = 0U;
    uint32_t to = 8U - first;
    if (index == 0U) {
        frame.data[0] = 0x10U;
        for (uint32_t i = 0U; (first == 2U) && (i < 4U); i++) {
            frame.data[2U + i] = (uint8_t)(length >> (24U - (8U * i)));
        }
        if (first == 6U) {
            frame.data[0] = (uint8_t)(0x10U | (length >> 8U));
            frame.data[1] = (uint8_t)length;
        }
    } else {
        frame.data[0] = (uint8_t)(0x20U | (index % 16U));
        from = first + ((index - 1U) * 7U);
        to = 1U;
    }
    for (; (to < 8U) && (from < length); to++) {
        frame.data[to] = bytes[from];
        from++;
    }
    return frame;
}
