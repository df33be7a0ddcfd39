/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/image.h"

#include <stdbool.h>
#include <string.h>

#define WORD 4U

/* Four steps of the polynomial 0xEDB88320: bit by bit an image of weights would take more than a hundredth of a second
   of a board. */
static uint32_t four_bits(uint32_t crc) {
    static const uint32_t by_nibble[16] = {0x00000000U, 0x1DB71064U, 0x3B6E20C8U, 0x26D930ACU, 0x76DC4190U, 0x6B6B51F4U,
                                           0x4DB26158U, 0x5005713CU, 0xEDB88320U, 0xF00F9344U, 0xD6D6A3E8U, 0xCB61B38CU,
                                           0x9B64C2B0U, 0x86D3D2D4U, 0xA00AE278U, 0xBDBDF21CU};
    return (crc >> 4U) ^ by_nibble[crc & 0xFU];
}

uint32_t elmopp_image_sum(uint32_t sum, const uint8_t *bytes, uint32_t length) {
    uint32_t crc = sum;
    for (uint32_t i = 0U; i < length; i++) {
        crc = four_bits(four_bits(crc ^ bytes[i]));
    }
    return crc;
}

static uint32_t word_at(const uint8_t *bytes) {
    return (uint32_t)bytes[0] | ((uint32_t)bytes[1] << 8U) | ((uint32_t)bytes[2] << 16U) | ((uint32_t)bytes[3] << 24U);
}

elmopp_image_fault_t elmopp_image_check(const elmopp_image_kind_t *kind, const uint8_t *image, uint32_t length) {
    if ((length < ELMOPP_IMAGE_HEADER) || (memcmp(image, kind->magic, sizeof kind->magic) != 0)) {
        return ELMOPP_IMAGE_MAGIC;
    }
    if (word_at(&image[4]) != kind->version) {
        return ELMOPP_IMAGE_VERSION;
    }
    if ((word_at(&image[8]) != kind->body_bytes) || (length != (ELMOPP_IMAGE_HEADER + kind->body_bytes))) {
        return ELMOPP_IMAGE_LENGTH;
    }
    const bool intact =
        word_at(&image[12]) == ~elmopp_image_sum(ELMOPP_IMAGE_SUM_START, &image[ELMOPP_IMAGE_HEADER], kind->body_bytes);
    return intact ? ELMOPP_IMAGE_OK : ELMOPP_IMAGE_CRC;
}

static void put_word(uint8_t *bytes, uint32_t word) {
    for (uint32_t i = 0U; i < WORD; i++) {
        bytes[i] = (uint8_t)((word >> (8U * i)) & UINT8_MAX);
    }
}

void elmopp_image_seal(const elmopp_image_kind_t *kind, uint8_t *image) {
    const uint32_t sum = elmopp_image_sum(ELMOPP_IMAGE_SUM_START, &image[ELMOPP_IMAGE_HEADER], kind->body_bytes);
    (void)memcpy(image, kind->magic, sizeof kind->magic);
    put_word(&image[4], kind->version);
    put_word(&image[8], kind->body_bytes);
    put_word(&image[12], ~sum);
}
