/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "flash_model.h"

#include <stddef.h>
#include <string.h>

#define ACR 0x00U
#define KEYR 0x04U
#define SR 0x0CU
#define CR 0x10U

#define BSY (1U << 16U)
#define OPERR (1U << 1U)
#define PGPERR (1U << 6U)
#define PGSERR (1U << 7U)
#define EOP 1U
#define PG 1U
#define SER 2U
#define SNB(cr) (((cr) >> 3U) & 0xFU)
#define PSIZE(cr) (((cr) >> 8U) & 3U)
#define STRT (1U << 16U)
#define LOCK (1U << 31U)
#define CACHES (3U << 9U)
#define CACHE_RESETS (3U << 11U)
#define LOOKS 3U /* that an operation takes */
#define FIRST_SECTOR 6U

volatile uint32_t flash_model_memory[FLASH_MODEL_BYTES / 4U];

static struct {
    uint32_t acr, sr, cr;
    uint32_t keys; /* right ones so far */
    bool shut;     /* a wrong key: until the next reset */
    uint32_t looks_left;
    bool erasing;
    uint32_t at; /* of the operation, in words */
    uint32_t word;
    flash_fault_t fault;
    uint32_t from, to;
    uint32_t accesses;
    uint32_t erases;
    uint32_t noise;
    const char *complaint;
} model;

static uint32_t any(void) {
    model.noise = (model.noise * 1664525U) + 1013904223U;
    return model.noise ^ (model.noise >> 13U);
}

static void complain(const char *of) {
    model.complaint = (model.complaint == NULL) ? of : model.complaint;
}

static bool is(flash_fault_t fault) {
    return (model.fault == fault) && (model.accesses >= model.from) && (model.accesses < model.to);
}

static void registers_after_reset(void) {
    model.acr = 0U;
    model.sr = 0U;
    model.cr = LOCK;
    model.keys = 0U;
    model.shut = false;
    model.looks_left = 0U;
}

void flash_model_fill(uint32_t word) {
    for (uint32_t k = 0U; k < (FLASH_MODEL_BYTES / 4U); k++) {
        flash_model_memory[k] = word;
    }
}

void flash_model_reset(void) {
    (void)memset(&model, 0, sizeof model);
    model.noise = 1U;
    registers_after_reset();
    flash_model_fill(UINT32_MAX);
}

/* The words that an operation changes. */
static uint32_t words(void) {
    return model.erasing ? (FLASH_MODEL_SECTOR_BYTES / 4U) : 1U;
}

static void change(bool whole) {
    for (uint32_t k = 0U; k < words(); k++) {
        volatile uint32_t *word = &flash_model_memory[model.at + k];
        const uint32_t wanted = model.erasing ? UINT32_MAX : (*word & model.word);
        *word ^= (*word ^ wanted) & (whole ? UINT32_MAX : any());
    }
}

void flash_model_restart(void) {
    if (model.looks_left > 0U) {
        change(false);
    }
    registers_after_reset();
}

void flash_model_break(flash_fault_t fault, uint32_t from, uint32_t to) {
    model.fault = fault;
    model.from = from;
    model.to = to;
}

static void begin(bool erasing, uint32_t at, uint32_t word) {
    if (model.looks_left > 0U) {
        complain("an operation while another one is under way");
    }
    if (PSIZE(model.cr) != 2U) {
        complain("not 32 bits at a time");
    }
    model.erasing = erasing;
    model.at = at;
    model.word = word;
    model.sr |= BSY;
    model.looks_left = LOOKS;
    model.erases += erasing ? 1U : 0U;
}

static void end(void) {
    if (is(FLASH_FAULT_ERROR)) {
        change(false);
        model.sr |= OPERR;
    } else if (!is(FLASH_FAULT_LOST)) {
        change(true);
    } else {
        /* it has done nothing */
    }
    model.sr &= ~BSY;
    model.cr &= ~STRT;
}

static void access(void) {
    model.accesses++;
    if (is(FLASH_FAULT_POWER)) {
        flash_model_power_lost();
    }
}

uint32_t flash_model_read(uint32_t offset) {
    access();
    if (is(FLASH_FAULT_DEAD)) {
        return UINT32_MAX;
    }
    if ((offset == SR) && (model.looks_left > 0U) && (!is(FLASH_FAULT_BUSY))) {
        model.looks_left--;
        if (model.looks_left == 0U) {
            end();
        }
    }
    uint32_t value = (offset == CR) ? model.cr : ((offset == SR) ? model.sr : 0U);
    value = (offset == ACR) ? model.acr : value;
    return (is(FLASH_FAULT_BUSY) && (offset == SR)) ? (value | BSY) : value;
}

static void take_key(uint32_t value) {
    static const uint32_t right[2] = {0x45670123U, 0xCDEF89ABU};
    if ((model.cr & LOCK) == 0U) {
        complain("a key where nothing is locked");
        model.shut = true;
    } else if (model.shut || (value != right[model.keys])) {
        model.shut = true;
    } else {
        model.keys++;
    }
    if ((model.keys == 2U) && (!model.shut)) {
        model.cr &= ~LOCK;
        model.keys = 0U;
    }
}

static void take_control(uint32_t value) {
    if ((model.sr & BSY) != 0U) {
        if (value != LOCK) {
            complain("FLASH_CR while an operation is under way");
        }
        return;
    }
    if ((model.cr & LOCK) != 0U) {
        if (value != LOCK) {
            complain("FLASH_CR while it is locked");
        }
        return;
    }
    model.cr = value;
    if ((value & STRT) != 0U) {
        const uint32_t sector = SNB(value) - FIRST_SECTOR;
        if (((value & SER) == 0U) || ((value & PG) != 0U) || (sector >= 4U)) {
            complain("an erase of something else than sectors 6 to 9");
        } else {
            begin(true, sector * (FLASH_MODEL_SECTOR_BYTES / 4U), 0U);
        }
    }
}

void flash_model_write(uint32_t offset, uint32_t value) {
    access();
    if (is(FLASH_FAULT_DEAD)) {
        return;
    }
    if (offset == KEYR) {
        if (!is(FLASH_FAULT_LOCKED)) {
            take_key(value);
        }
    } else if (offset == SR) {
        model.sr &= ~value | BSY;
    } else if (offset == CR) {
        take_control(value);
    } else if (offset == ACR) {
        if (((value & CACHE_RESETS) != 0U) && ((value & CACHES) != 0U)) {
            complain("a cache is reset while it is on");
        }
        model.acr = value;
    } else {
        complain("a register that is not to be written");
    }
}

void flash_model_program(uint32_t at, uint32_t word) {
    access();
    if (is(FLASH_FAULT_DEAD)) {
        return;
    }
    if ((at >= FLASH_MODEL_BYTES) || ((at % 4U) != 0U)) {
        complain("a write outside of the sectors");
    } else if (((model.cr & LOCK) != 0U) || ((model.cr & PG) == 0U)) {
        complain("a write without PG");
        model.sr |= PGSERR;
    } else if ((model.sr & (PGPERR | PGSERR | OPERR)) != 0U) {
        complain("a write with errors that were not cleared");
    } else {
        begin(false, at / 4U, word);
    }
}

uint32_t flash_model_accesses(void) {
    return model.accesses;
}

uint32_t flash_model_erases(void) {
    return model.erases;
}

bool flash_model_is_locked(void) {
    return (model.cr & LOCK) != 0U;
}

const char *flash_model_complaint(void) {
    return model.complaint;
}
