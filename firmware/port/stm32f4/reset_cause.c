/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "reset_cause.h"

#define FLAGS 7U

/* What says most comes first. At power-on both POR and BOR are set, at a brown-out BOR alone. */
static const struct {
    uint32_t flag;
    elmopp_reset_cause_t cause;
} flags[FLAGS] = {{ELMOPP_RCC_CSR_LPWRRSTF, ELMOPP_RESET_LOW_POWER}, {ELMOPP_RCC_CSR_WWDGRSTF, ELMOPP_RESET_WATCHDOG},
                  {ELMOPP_RCC_CSR_IWDGRSTF, ELMOPP_RESET_WATCHDOG},  {ELMOPP_RCC_CSR_SFTRSTF, ELMOPP_RESET_SOFTWARE},
                  {ELMOPP_RCC_CSR_PORRSTF, ELMOPP_RESET_POWER},      {ELMOPP_RCC_CSR_BORRSTF, ELMOPP_RESET_BROWN_OUT},
                  {ELMOPP_RCC_CSR_PINRSTF, ELMOPP_RESET_PIN}};

elmopp_reset_cause_t elmopp_reset_cause_take(elmopp_rcc_registers_t *rcc) {
    const uint32_t status = elmopp_register_read(&rcc->csr);
    elmopp_reset_cause_t cause = ELMOPP_RESET_UNKNOWN;
    for (uint32_t k = 0U; (k < FLAGS) && (cause == ELMOPP_RESET_UNKNOWN); k++) {
        cause = ((status & flags[k].flag) != 0U) ? flags[k].cause : cause;
    }
    elmopp_register_write(&rcc->csr, status | ELMOPP_RCC_CSR_RMVF);
    return cause;
}

const char *elmopp_reset_cause_name(elmopp_reset_cause_t cause) {
    const char *name = "unknown";
    switch (cause) {
    case ELMOPP_RESET_POWER:
        name = "power";
        break;
    case ELMOPP_RESET_BROWN_OUT:
        name = "brown-out";
        break;
    case ELMOPP_RESET_PIN:
        name = "reset pin";
        break;
    case ELMOPP_RESET_SOFTWARE:
        name = "software";
        break;
    case ELMOPP_RESET_WATCHDOG:
        name = "watchdog";
        break;
    case ELMOPP_RESET_LOW_POWER:
        name = "low-power mode";
        break;
    case ELMOPP_RESET_UNKNOWN:
    default:
        break;
    }
    return name;
}

bool elmopp_brown_out_is_set(const elmopp_flash_registers_t *flash) {
    return (elmopp_register_read(&flash->optcr) & ELMOPP_FLASH_OPTCR_BOR_LEV) == ELMOPP_FLASH_OPTCR_BOR_LEVEL_3;
}
