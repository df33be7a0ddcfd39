/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "flash_writer.h"

#define WORD 4U
#define ERRORS                                                                                                         \
    (ELMOPP_FLASH_SR_OPERR | ELMOPP_FLASH_SR_WRPERR | ELMOPP_FLASH_SR_PGAERR | ELMOPP_FLASH_SR_PGPERR |                \
     ELMOPP_FLASH_SR_PGSERR)
#define CACHES_ON (ELMOPP_FLASH_ACR_DCEN | ELMOPP_FLASH_ACR_ICEN)
#define CACHES_RESET (ELMOPP_FLASH_ACR_DCRST | ELMOPP_FLASH_ACR_ICRST)

static bool is_idle(const elmopp_flash_writer_t *self, uint32_t looks) {
    bool busy = true;
    for (uint32_t k = 0U; (k < looks) && busy; k++) {
        busy = (elmopp_register_read(&self->registers->sr) & ELMOPP_FLASH_SR_BSY) != 0U;
    }
    return !busy;
}

/* The keys are written only where it is locked: a key too much locks it until the next reset. Errors of before are
   cleared by writing ones. */
static elmopp_flash_writer_trouble_t open_flash(const elmopp_flash_writer_t *self) {
    elmopp_flash_registers_t *flash = self->registers;
    if (!is_idle(self, ELMOPP_FLASH_WRITER_WORD_LOOKS)) {
        return ELMOPP_FLASH_WRITER_BUSY;
    }
    if ((elmopp_register_read(&flash->cr) & ELMOPP_FLASH_CR_LOCK) != 0U) {
        elmopp_register_write(&flash->keyr, ELMOPP_FLASH_KEY_1);
        elmopp_register_write(&flash->keyr, ELMOPP_FLASH_KEY_2);
    }
    if ((elmopp_register_read(&flash->cr) & ELMOPP_FLASH_CR_LOCK) != 0U) {
        return ELMOPP_FLASH_WRITER_LOCKED;
    }
    elmopp_register_write(&flash->sr, ERRORS | ELMOPP_FLASH_SR_EOP);
    return ELMOPP_FLASH_WRITER_WELL;
}

/* Waits for the end, locks, and says what the flash says. */
static elmopp_flash_writer_trouble_t close_flash(const elmopp_flash_writer_t *self, uint32_t looks) {
    const bool idle = is_idle(self, looks);
    const uint32_t status = elmopp_register_read(&self->registers->sr);
    elmopp_register_write(&self->registers->cr, ELMOPP_FLASH_CR_LOCK);
    elmopp_flash_writer_trouble_t trouble = ELMOPP_FLASH_WRITER_WELL;
    if (!idle) {
        trouble = ELMOPP_FLASH_WRITER_BUSY;
    } else if ((status & ERRORS) != 0U) {
        trouble = ELMOPP_FLASH_WRITER_ERROR;
    } else {
        /* it has been done */
    }
    return trouble;
}

/* A cache is reset while it is off. */
static void forget_caches(const elmopp_flash_writer_t *self) {
    elmopp_register_t *acr = &self->registers->acr;
    const uint32_t before = elmopp_register_read(acr);
    const uint32_t off = before & ~CACHES_ON;
    elmopp_register_write(acr, off);
    elmopp_register_write(acr, off | CACHES_RESET);
    elmopp_register_write(acr, off);
    elmopp_register_write(acr, before);
}

elmopp_flash_writer_trouble_t elmopp_flash_writer_erase(const elmopp_flash_writer_t *self, uint32_t at) {
    if ((at >= ELMOPP_FLASH_WRITER_BYTES) || ((at % ELMOPP_FLASH_WRITER_SECTOR_BYTES) != 0U)) {
        return ELMOPP_FLASH_WRITER_PLACE;
    }
    elmopp_flash_writer_trouble_t trouble = open_flash(self);
    if (trouble == ELMOPP_FLASH_WRITER_WELL) {
        const uint32_t number = ELMOPP_FLASH_WRITER_FIRST + (at / ELMOPP_FLASH_WRITER_SECTOR_BYTES);
        const uint32_t what = ELMOPP_FLASH_CR_SER | (number << ELMOPP_FLASH_CR_SNB_AT) | ELMOPP_FLASH_CR_PSIZE_32;
        elmopp_register_write(&self->registers->cr, what);
        elmopp_register_write(&self->registers->cr, what | ELMOPP_FLASH_CR_STRT);
        trouble = close_flash(self, self->erase_looks);
        forget_caches(self);
    }
    return trouble;
}

elmopp_flash_writer_trouble_t elmopp_flash_writer_program(const elmopp_flash_writer_t *self, uint32_t at,
                                                          uint32_t word) {
    if ((at >= ELMOPP_FLASH_WRITER_BYTES) || ((at % WORD) != 0U)) {
        return ELMOPP_FLASH_WRITER_PLACE;
    }
    elmopp_flash_writer_trouble_t trouble = open_flash(self);
    if (trouble == ELMOPP_FLASH_WRITER_WELL) {
        elmopp_register_write(&self->registers->cr, ELMOPP_FLASH_CR_PG | ELMOPP_FLASH_CR_PSIZE_32);
        elmopp_register_write(&self->memory[at / WORD], word);
        trouble = close_flash(self, ELMOPP_FLASH_WRITER_WORD_LOOKS);
    }
    return trouble;
}

const char *elmopp_flash_writer_trouble_name(elmopp_flash_writer_trouble_t trouble) {
    static const char *const name[] = {"well", "not a place for it", "it does not come to its end",
                                       "its lock does not open", "it reports an error"};
    return (trouble <= ELMOPP_FLASH_WRITER_ERROR) ? name[trouble] : "unknown";
}
