/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "register_bank.h"

#include <stddef.h>

#define WRITES_MAX 256U

static struct {
    register_bank_answer_t answer;
    uint32_t accesses;
    uint32_t writes;
    const elmopp_register_t *place[WRITES_MAX];
    uint32_t value[WRITES_MAX];
} bank;

void register_bank_use(register_bank_answer_t answer) {
    bank.answer = answer;
    bank.accesses = 0U;
    bank.writes = 0U;
}

uint32_t register_bank_accesses(void) {
    return bank.accesses;
}

uint32_t register_bank_written(const elmopp_register_t *place, uint32_t n) {
    uint32_t seen = 0U;
    for (uint32_t k = 0U; k < bank.writes; k++) {
        if (bank.place[k] == place) {
            if (seen == n) {
                return bank.value[k];
            }
            seen++;
        }
    }
    return UINT32_MAX;
}

uint32_t elmopp_register_read(const elmopp_register_t *place) {
    bank.accesses++;
    return (bank.answer != NULL) ? bank.answer(place, *place) : *place;
}

void elmopp_register_write(elmopp_register_t *place, uint32_t value) {
    bank.accesses++;
    *place = value;
    if (bank.writes < WRITES_MAX) {
        bank.place[bank.writes] = place;
        bank.value[bank.writes] = value;
        bank.writes++;
    }
}
