/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Clocks: from the internal oscillator, with which the processor starts, to the crystal and 168 MHz.
///
/// Every wait is a bounded number of looks at a register. What does not come in time is named and the processor stays
/// on the internal oscillator, 16 MHz, where everything works but CAN (bit_timing.h says why). Once the crystal runs it
/// is watched: should it stop, the hardware goes back to the internal oscillator by itself and raises NMI, which is a
/// fault of the processor here; the start after that finds no crystal.
///
/// Registers are those of RM0090 sections 3.9 (FLASH_ACR), 5.4.1 (voltage scale), 7.2 and 7.3.

#ifndef ELMOPP_STM32F4_CLOCKS_H
#define ELMOPP_STM32F4_CLOCKS_H

#include "registers.h"

#include <stdbool.h>

/// Looks at a register. One takes ten clocks of 16 MHz at least: 0.1 s or more for the crystal, which needs 2 ms by the
/// data sheet (DS8626, HSE oscillator characteristics), 6 ms or more for the PLL (0.3 ms) and the switch.
#define ELMOPP_CLOCKS_CRYSTAL_LOOKS 160000U
#define ELMOPP_CLOCKS_LOOKS 10000U

typedef enum {
    ELMOPP_CLOCKS_WELL = 0,
    ELMOPP_CLOCKS_NO_CRYSTAL, ///< it does not swing
    ELMOPP_CLOCKS_NO_FLASH,   ///< the flash does not take its wait states
    ELMOPP_CLOCKS_NO_PLL,     ///< the PLL does not lock
    ELMOPP_CLOCKS_NO_SWITCH   ///< the processor does not take the PLL's clock
} elmopp_clocks_trouble_t;

/// Where the registers are.
typedef struct {
    elmopp_rcc_registers_t *rcc;
    elmopp_flash_registers_t *flash;
    elmopp_pwr_registers_t *pwr;
} elmopp_clocks_registers_t;

/// What runs at which frequency.
typedef struct {
    elmopp_clocks_trouble_t trouble; ///< WELL: from the crystal
    uint32_t processor_hz;
    uint32_t pclk1_hz; ///< CAN
    uint32_t pclk2_hz; ///< the serial port
} elmopp_clocks_t;

/// Call it once, on the internal oscillator.
elmopp_clocks_t elmopp_clocks_start(const elmopp_clocks_registers_t *registers);

/// What a trouble is called, for a status line. Never null.
const char *elmopp_clocks_trouble_name(elmopp_clocks_trouble_t trouble);

#endif
