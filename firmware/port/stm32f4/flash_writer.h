/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Flash writer: erases and programs the four sectors in which images are kept, and no others.
///
/// Sectors 6 to 9 of RM0090 table 5, 128 KiB each; 0 to 5 are the program's and 10 and 11 are written by hand. A sector
/// number is worked out from a place within these four, so that there is none that would erase the program.
///
/// The STM32F405 has one bank of flash: while it erases or programs, whoever fetches from it stands still, interrupts
/// too (RM0090 section 3.6). A word takes 16 us, 100 at most; a sector of 128 KiB a second, two at most (DS8626, flash
/// memory characteristics, 32 bits at a time, which needs 2.7 V). So words may be programmed while lamps run, and
/// sectors are erased before the first lamp tick only. Code that runs from RAM would not help: a rollout needs more of
/// it than there is.
///
/// Every wait is a bounded number of looks at a register. An operation that fails leaves the flash locked.
/// Source: RM0090 sections 3.6 (erase, program), 3.5.2 (caches), 3.9 (registers).

#ifndef ELMOPP_STM32F4_FLASH_WRITER_H
#define ELMOPP_STM32F4_FLASH_WRITER_H

#include "registers.h"

#include <stdbool.h>

#define ELMOPP_FLASH_WRITER_FIRST 6U ///< sector
#define ELMOPP_FLASH_WRITER_SECTORS 4U
#define ELMOPP_FLASH_WRITER_SECTOR_BYTES 0x20000U
#define ELMOPP_FLASH_WRITER_BYTES (ELMOPP_FLASH_WRITER_SECTORS * ELMOPP_FLASH_WRITER_SECTOR_BYTES)

/// Looks at BSY. One takes six clocks of 168 MHz at least if it is fetched from the cache: 100 us and 2 s, with room.
#define ELMOPP_FLASH_WRITER_WORD_LOOKS 20000U
#define ELMOPP_FLASH_WRITER_ERASE_LOOKS 100000000U

typedef enum {
    ELMOPP_FLASH_WRITER_WELL = 0,
    ELMOPP_FLASH_WRITER_PLACE,  ///< none of these sectors, or not at a word; a sector not at its beginning
    ELMOPP_FLASH_WRITER_BUSY,   ///< an operation does not come to its end
    ELMOPP_FLASH_WRITER_LOCKED, ///< the keys do not open it
    ELMOPP_FLASH_WRITER_ERROR   ///< the flash says that it has not done it
} elmopp_flash_writer_trouble_t;

typedef struct {
    elmopp_flash_registers_t *registers;
    elmopp_register_t *memory; ///< first word of sector ELMOPP_FLASH_WRITER_FIRST
    uint32_t erase_looks;      ///< ELMOPP_FLASH_WRITER_ERASE_LOOKS
} elmopp_flash_writer_t;

/// Erases the sector that begins at byte `at` of the four, and what the caches hold of it.
elmopp_flash_writer_trouble_t elmopp_flash_writer_erase(const elmopp_flash_writer_t *self, uint32_t at);

/// Programs the word at byte `at` of the four: it can clear bits and set none.
elmopp_flash_writer_trouble_t elmopp_flash_writer_program(const elmopp_flash_writer_t *self, uint32_t at,
                                                          uint32_t word);

/// What a trouble is called, for a status line. Never null.
const char *elmopp_flash_writer_trouble_name(elmopp_flash_writer_trouble_t trouble);

#endif
