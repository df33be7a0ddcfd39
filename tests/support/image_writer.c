/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "image_writer.h"

#include <string.h>

uint32_t image_checksum(const uint8_t *bytes, uint32_t length) {
    static const uint32_t nibble[16] = {0x00000000U, 0x1DB71064U, 0x3B6E20C8U, 0x26D930ACU, 0x76DC4190U, 0x6B6B51F4U,
                                        0x4DB26158U, 0x5005713CU, 0xEDB88320U, 0xF00F9344U, 0xD6D6A3E8U, 0xCB61B38CU,
                                        0x9B64C2B0U, 0x86D3D2D4U, 0xA00AE278U, 0xBDBDF21CU};
    uint32_t crc = 0xFFFFFFFFU;
    for (uint32_t i = 0U; i < length; i++) {
        crc = nibble[(crc ^ bytes[i]) & 0xFU] ^ (crc >> 4U);
        crc = nibble[(crc ^ ((uint32_t)bytes[i] >> 4U)) & 0xFU] ^ (crc >> 4U);
    }
    return crc ^ 0xFFFFFFFFU;
}

void image_put_word(uint8_t *at, uint32_t word) {
    for (uint32_t i = 0U; i < 4U; i++) {
        at[i] = (uint8_t)(word >> (8U * i));
    }
}

void image_seal(uint8_t *image, const char *magic, uint32_t version, uint32_t body_bytes) {
    (void)memcpy(image, magic, 4U);
    image_put_word(&image[4], version);
    image_put_word(&image[8], body_bytes);
    image_put_word(&image[12], image_checksum(&image[16], body_bytes));
}
