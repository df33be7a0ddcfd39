/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "watchdog.h"

#include <assert.h>

/* RM0090 21.4.2: LSI is divided by 4 << code. */
#define LONG_CODE 4U /* by 64: 500 Hz */
#define LONG_COUNT 2000U
#define TIGHT_CODE 2U /* by 16: 2 kHz */
#define TIGHT_COUNT 750U
#define COUNT_MAX 0xFFFU

#define LSI_FASTEST_HZ 47000U
#define LSI_SLOWEST_HZ 17000U
#define TICK_MS 100U
#define LONGEST_MS(code, count, hz) ((1000U * (count) * (4U << (code))) / (hz))

static_assert((LONG_COUNT <= COUNT_MAX) && (TIGHT_COUNT <= COUNT_MAX), "RM0090 21.4.3");
static_assert(LONGEST_MS(TIGHT_CODE, TIGHT_COUNT, LSI_FASTEST_HZ) >= (2U * TICK_MS), "a tick may be a tick late");
static_assert(LONGEST_MS(TIGHT_CODE, TIGHT_COUNT, LSI_SLOWEST_HZ) <= 1000U, "a second without a tick is too long");
static_assert(LONGEST_MS(LONG_CODE, LONG_COUNT, LSI_FASTEST_HZ) >= 2500U, "the tests at the start, at 16 MHz");

static void set_time(elmopp_iwdg_registers_t *registers, uint32_t code, uint32_t count) {
    bool busy = true;
    for (uint32_t k = 0U; (k < ELMOPP_WATCHDOG_LOOKS) && busy; k++) {
        busy = (elmopp_register_read(&registers->sr) & ELMOPP_IWDG_SR_BUSY) != 0U;
    }
    if (!busy) {
        elmopp_register_write(&registers->kr, ELMOPP_IWDG_KR_UNLOCK);
        elmopp_register_write(&registers->pr, code);
        elmopp_register_write(&registers->rlr, count);
    }
    elmopp_register_write(&registers->kr, ELMOPP_IWDG_KR_RELOAD);
}

void elmopp_watchdog_start(elmopp_watchdog_t *self, elmopp_iwdg_registers_t *registers) {
    self->registers = registers;
    self->tight = false;
    elmopp_register_write(&registers->kr, ELMOPP_IWDG_KR_START); /* starts LSI, too, without which nothing changes */
    set_time(registers, LONG_CODE, LONG_COUNT);
}

bool elmopp_watchdog_begin_anew(const elmopp_watchdog_t *self) {
    if (!self->tight) {
        elmopp_register_write(&self->registers->kr, ELMOPP_IWDG_KR_RELOAD);
    }
    return !self->tight;
}

void elmopp_watchdog_kick(elmopp_watchdog_t *self) {
    if (!self->tight) {
        set_time(self->registers, TIGHT_CODE, TIGHT_COUNT);
        self->tight = true;
    }
    elmopp_register_write(&self->registers->kr, ELMOPP_IWDG_KR_RELOAD);
}
