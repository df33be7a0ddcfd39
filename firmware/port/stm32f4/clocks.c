/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "clocks.h"

#include "clock_plan.h"

static bool comes(const elmopp_register_t *place, uint32_t mask, uint32_t wanted, uint32_t looks) {
    bool there = false;
    for (uint32_t k = 0U; (k < looks) && (!there); k++) {
        there = (elmopp_register_read(place) & mask) == wanted;
    }
    return there;
}

static void set(elmopp_register_t *place, uint32_t bits) {
    elmopp_register_write(place, elmopp_register_read(place) | bits);
}

static void clear(elmopp_register_t *place, uint32_t bits) {
    elmopp_register_write(place, elmopp_register_read(place) & ~bits);
}

/* Before the clock gets faster. */
static bool slow_the_flash_down(elmopp_flash_registers_t *flash) {
    const uint32_t caches = ELMOPP_FLASH_ACR_PRFTEN | ELMOPP_FLASH_ACR_ICEN | ELMOPP_FLASH_ACR_DCEN;
    elmopp_register_write(&flash->acr, caches | ELMOPP_FLASH_WAIT_STATES);
    return comes(&flash->acr, ELMOPP_FLASH_ACR_LATENCY, ELMOPP_FLASH_WAIT_STATES, ELMOPP_CLOCKS_LOOKS);
}

static bool lock_the_pll(elmopp_rcc_registers_t *rcc) {
    elmopp_register_write(&rcc->pllcfgr, ELMOPP_PLL_M | (ELMOPP_PLL_N << ELMOPP_RCC_PLLCFGR_N_AT) |
                                             (ELMOPP_PLL_P_CODE << ELMOPP_RCC_PLLCFGR_P_AT) |
                                             ELMOPP_RCC_PLLCFGR_SRC_HSE | (ELMOPP_PLL_Q << ELMOPP_RCC_PLLCFGR_Q_AT));
    set(&rcc->cr, ELMOPP_RCC_CR_PLLON);
    return comes(&rcc->cr, ELMOPP_RCC_CR_PLLRDY, ELMOPP_RCC_CR_PLLRDY, ELMOPP_CLOCKS_LOOKS);
}

static bool take_the_pll(elmopp_rcc_registers_t *rcc) {
    const uint32_t shown = ELMOPP_RCC_CFGR_SW << ELMOPP_RCC_CFGR_SWS_AT;
    elmopp_register_write(&rcc->cfgr, ELMOPP_RCC_CFGR_PPRE1_BY_4 | ELMOPP_RCC_CFGR_PPRE2_BY_2 | ELMOPP_RCC_CFGR_SW_PLL);
    return comes(&rcc->cfgr, shown, ELMOPP_RCC_CFGR_SW_PLL << ELMOPP_RCC_CFGR_SWS_AT, ELMOPP_CLOCKS_LOOKS);
}

static elmopp_clocks_trouble_t go_to_the_crystal(const elmopp_clocks_registers_t *registers) {
    elmopp_rcc_registers_t *rcc = registers->rcc;
    elmopp_clocks_trouble_t trouble = ELMOPP_CLOCKS_WELL;
    set(&rcc->cr, ELMOPP_RCC_CR_HSEON);
    set(&rcc->apb1enr, ELMOPP_RCC_APB1ENR_PWR);
    set(&registers->pwr->cr, ELMOPP_PWR_CR_VOS);
    if (!comes(&rcc->cr, ELMOPP_RCC_CR_HSERDY, ELMOPP_RCC_CR_HSERDY, ELMOPP_CLOCKS_CRYSTAL_LOOKS)) {
        trouble = ELMOPP_CLOCKS_NO_CRYSTAL;
    } else if (!slow_the_flash_down(registers->flash)) {
        trouble = ELMOPP_CLOCKS_NO_FLASH;
    } else if (!lock_the_pll(rcc)) {
        trouble = ELMOPP_CLOCKS_NO_PLL;
    } else if (!take_the_pll(rcc)) {
        trouble = ELMOPP_CLOCKS_NO_SWITCH;
    } else {
        set(&rcc->cr, ELMOPP_RCC_CR_CSSON);
    }
    return trouble;
}

elmopp_clocks_t elmopp_clocks_start(const elmopp_clocks_registers_t *registers) {
    elmopp_rcc_registers_t *rcc = registers->rcc;
    const elmopp_clocks_trouble_t trouble = go_to_the_crystal(registers);
    if (trouble != ELMOPP_CLOCKS_WELL) {
        elmopp_register_write(&rcc->cfgr, 0U); /* the internal oscillator, undivided */
        clear(&rcc->cr, ELMOPP_RCC_CR_PLLON | ELMOPP_RCC_CR_HSEON);
        return (elmopp_clocks_t){trouble, ELMOPP_HSI_HZ, ELMOPP_HSI_HZ, ELMOPP_HSI_HZ};
    }
    return (elmopp_clocks_t){trouble, ELMOPP_SYSCLK_HZ, ELMOPP_PCLK1_HZ, ELMOPP_PCLK2_HZ};
}

const char *elmopp_clocks_trouble_name(elmopp_clocks_trouble_t trouble) {
    const char *name;
    switch (trouble) {
    case ELMOPP_CLOCKS_WELL:
        name = "well";
        break;
    case ELMOPP_CLOCKS_NO_CRYSTAL:
        name = "the crystal does not swing";
        break;
    case ELMOPP_CLOCKS_NO_FLASH:
        name = "the flash does not take its wait states";
        break;
    case ELMOPP_CLOCKS_NO_PLL:
        name = "the PLL does not lock";
        break;
    case ELMOPP_CLOCKS_NO_SWITCH:
        name = "the PLL's clock is not taken";
        break;
    default:
        name = "unknown";
        break;
    }
    return name;
}
