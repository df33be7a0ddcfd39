/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Any id, any data: the checksum is the remainder of both bytes of the id, low byte first, and all seven of the data,
/// by x^8 + x^4 + x^3 + x^2 + 1, started and ended with 0xFF (SAE J1850), written here bit by bit.

#include "claims.h"

#include "elmopp/link.h"

#define SUMMED 9U

void harness(void) {
    const uint16_t id = nondet_u16();
    uint8_t message[SUMMED];
    message[0] = (uint8_t)(id & 0xFFU);
    message[1] = (uint8_t)(id >> 8U);
    for (uint32_t i = 2U; i < SUMMED; i++) {
        message[i] = nondet_u8();
    }
    uint32_t rest = 0xFFU;
    for (uint32_t bit = 0U; bit < (SUMMED * 8U); bit++) {
        const uint32_t next = ((uint32_t)message[bit / 8U] >> (7U - (bit % 8U))) & 1U;
        const bool carry = ((rest >> 7U) ^ next) != 0U;
        rest = ((rest << 1U) & 0xFFU) ^ (carry ? 0x1DU : 0U);
    }
    CLAIM(elmopp_link_crc(id, &message[2]) == (rest ^ 0xFFU), "the checksum is that of the standard");
    REACHABLE();
}
