/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// A model of the STM32F405's flash interface and of the four sectors behind it, written from RM0090
/// sections 3.5.2, 3.6 and 3.9, apart from the driver: keys and lock, one operation at a time, what it complains of,
/// and what a loss of power leaves of an operation. Each fault can be there for a while, counted in accesses to
/// registers.

#ifndef ELMOPP_TESTS_FLASH_MODEL_H
#define ELMOPP_TESTS_FLASH_MODEL_H

#include <stdbool.h>
#include <stdint.h>

#define FLASH_MODEL_SECTOR_BYTES 0x20000U
#define FLASH_MODEL_BYTES (4U * FLASH_MODEL_SECTOR_BYTES) /* sectors 6 to 9 */

typedef enum {
    FLASH_FAULT_NONE,
    FLASH_FAULT_DEAD,   /* registers read as ones, nothing that is written comes to them */
    FLASH_FAULT_BUSY,   /* an operation never ends */
    FLASH_FAULT_LOCKED, /* the keys do nothing */
    FLASH_FAULT_ERROR,  /* an operation ends with an error, half done */
    FLASH_FAULT_LOST,   /* an operation does nothing and says nothing */
    FLASH_FAULT_POWER,  /* the power goes: `flash_model_power_lost` is called, which must not return */
    FLASH_FAULT_COUNT
} flash_fault_t;

/* What the sectors hold. */
extern volatile uint32_t flash_model_memory[FLASH_MODEL_BYTES / 4U];
void flash_model_fill(uint32_t word);

/* Blank sectors, registers as after a reset, no fault. */
void flash_model_reset(void);
/* A reset: registers as after one, an operation that was under way is torn, sectors stay. */
void flash_model_restart(void);
/* The fault is there from the access number `from` on until before `to`. */
void flash_model_break(flash_fault_t fault, uint32_t from, uint32_t to);

uint32_t flash_model_read(uint32_t offset);
void flash_model_write(uint32_t offset, uint32_t value);
/* A 32-bit write to the byte `at` of the sectors. */
void flash_model_program(uint32_t at, uint32_t word);

/* Since the reset. */
uint32_t flash_model_accesses(void);
uint32_t flash_model_erases(void);
bool flash_model_is_locked(void);
/* What the manual forbids, and the driver has done; null: nothing. */
const char *flash_model_complaint(void);

/* The test's. */
_Noreturn void flash_model_power_lost(void);

#endif
