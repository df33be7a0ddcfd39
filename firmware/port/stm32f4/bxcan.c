/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "bxcan.h"

/* Every node's own: by priority of ids (TXFP 0), sent again until it is taken back (NART 0), no way back from bus-off
 * but ours (ABOM 0), awake (SLEEP 0). */
#define NORMAL_MODE 0U
#define INITIALISATION_MODE ELMOPP_BXCAN_MCR_INRQ

void elmopp_bxcan_init(elmopp_bxcan_t *self, elmopp_bxcan_registers_t *registers, const elmopp_bxcan_config_t *config) {
    self->registers = registers;
    self->config = *config;
    self->state = ELMOPP_BXCAN_OFF;
    self->trouble = ELMOPP_BXCAN_WELL;
    self->off_bus = false;
    self->passive = false;
    self->since_ms = 0U;
    self->tries = 0U;
    self->returned = 0U;
    self->passives = 0U;
    for (uint32_t i = 0U; i < (uint32_t)ELMOPP_BXCAN_TROUBLES; i++) {
        self->count[i] = 0U;
    }
    elmopp_bxcan_fifo_init(&self->fifo, registers);
    elmopp_bxcan_mailboxes_init(&self->mailboxes, registers);
}

/* --- from state to state --- */

static void enter(elmopp_bxcan_t *self, elmopp_bxcan_state_t state, uint32_t now_ms) {
    self->state = state;
    self->since_ms = now_ms;
}

static bool has_lasted(const elmopp_bxcan_t *self, uint32_t limit_ms, uint32_t now_ms) {
    return (now_ms - self->since_ms) >= limit_ms;
}

static void set_mode(elmopp_bxcan_t *self, uint32_t mode) {
    elmopp_register_write(&self->registers->mcr, mode);
}

static uint32_t mode_shown(const elmopp_bxcan_t *self) {
    return elmopp_register_read(&self->registers->msr) & (ELMOPP_BXCAN_MSR_INAK | ELMOPP_BXCAN_MSR_SLAK);
}

static void reset(elmopp_bxcan_t *self, uint32_t now_ms) {
    set_mode(self, ELMOPP_BXCAN_MCR_RESET);
    elmopp_bxcan_mailboxes_clear(&self->mailboxes);
    enter(self, ELMOPP_BXCAN_RESETTING, now_ms);
}

void elmopp_bxcan_start(elmopp_bxcan_t *self, uint32_t now_ms) {
    self->tries = 0U;
    reset(self, now_ms);
}

/* Nothing is sent or heard from here on. At bus-off the hardware is left as it is: it has left the bus by itself. */
static void fail(elmopp_bxcan_t *self, elmopp_bxcan_trouble_t trouble, uint32_t now_ms) {
    self->trouble = trouble;
    self->count[trouble]++;
    self->tries++;
    self->off_bus = (trouble == ELMOPP_BXCAN_BUS_OFF) || (trouble == ELMOPP_BXCAN_NO_RETURN);
    elmopp_bxcan_fifo_listen(&self->fifo, false);
    elmopp_bxcan_mailboxes_clear(&self->mailboxes);
    const bool goes_on = self->tries < ELMOPP_BXCAN_TRIES;
    if ((!goes_on) || (!self->off_bus)) {
        set_mode(self, INITIALISATION_MODE);
    }
    enter(self, goes_on ? ELMOPP_BXCAN_PAUSING : ELMOPP_BXCAN_FAILED, now_ms);
}

static void fail_if_late(elmopp_bxcan_t *self, uint32_t limit_ms, elmopp_bxcan_trouble_t trouble, uint32_t now_ms) {
    if (has_lasted(self, limit_ms, now_ms)) {
        fail(self, trouble, now_ms);
    }
}

static void run(elmopp_bxcan_t *self, uint32_t now_ms) {
    elmopp_bxcan_fifo_listen(&self->fifo, true);
    enter(self, ELMOPP_BXCAN_RUNNING, now_ms);
}

/* --- what each state waits for --- */

static void step_resetting(elmopp_bxcan_t *self, uint32_t now_ms) {
    if ((elmopp_register_read(&self->registers->mcr) & ELMOPP_BXCAN_MCR_RESET) == 0U) {
        set_mode(self, INITIALISATION_MODE);
        enter(self, ELMOPP_BXCAN_ENTERING, now_ms);
    } else {
        fail_if_late(self, ELMOPP_BXCAN_ANSWER_MS, ELMOPP_BXCAN_NO_RESET, now_ms);
    }
}

static void step_entering(elmopp_bxcan_t *self, uint32_t now_ms) {
    if (mode_shown(self) != ELMOPP_BXCAN_MSR_INAK) {
        fail_if_late(self, ELMOPP_BXCAN_ANSWER_MS, ELMOPP_BXCAN_NO_INIT, now_ms);
        return;
    }
    elmopp_register_write(&self->registers->btr, self->config.bit_timing);
    elmopp_bxcan_fifo_filter(&self->fifo, self->config.ids, self->config.id_count);
    if (elmopp_register_read(&self->registers->btr) != self->config.bit_timing) {
        fail(self, ELMOPP_BXCAN_NO_TIMING, now_ms);
    } else if (self->config.may_join) {
        set_mode(self, NORMAL_MODE);
        enter(self, ELMOPP_BXCAN_JOINING, now_ms);
    } else {
        enter(self, ELMOPP_BXCAN_HELD, now_ms);
    }
}

static bool is_on_bus(const elmopp_bxcan_t *self) {
    return (mode_shown(self) == 0U) && ((elmopp_register_read(&self->registers->esr) & ELMOPP_BXCAN_ESR_BOFF) == 0U);
}

static void step_joining(elmopp_bxcan_t *self, uint32_t now_ms) {
    if (is_on_bus(self)) {
        run(self, now_ms);
    } else {
        fail_if_late(self, ELMOPP_BXCAN_JOIN_MS, ELMOPP_BXCAN_NO_JOIN, now_ms);
    }
}

static void look_at_errors(elmopp_bxcan_t *self, uint32_t errors) {
    const bool passive = (errors & ELMOPP_BXCAN_ESR_EPVF) != 0U;
    self->passives += (passive && (!self->passive)) ? 1U : 0U;
    self->passive = passive;
}

static void step_running(elmopp_bxcan_t *self, uint32_t now_ms) {
    const uint32_t errors = elmopp_register_read(&self->registers->esr);
    look_at_errors(self, errors);
    if ((errors & ELMOPP_BXCAN_ESR_BOFF) != 0U) {
        fail(self, ELMOPP_BXCAN_BUS_OFF, now_ms);
    } else if (mode_shown(self) != 0U) {
        fail(self, ELMOPP_BXCAN_LEFT, now_ms);
    } else if (atomic_load(&self->fifo.stuck) != 0U) {
        fail(self, ELMOPP_BXCAN_NO_RELEASE, now_ms);
    } else if (!elmopp_bxcan_mailboxes_step(&self->mailboxes, now_ms)) {
        fail(self, ELMOPP_BXCAN_NO_MAILBOX, now_ms);
    } else if (has_lasted(self, ELMOPP_BXCAN_STEADY_MS, now_ms)) {
        self->tries = 0U;
        self->since_ms = now_ms; /* else the difference would wrap one day */
    } else {
        /* it runs */
    }
}

static uint32_t pause_ms(uint32_t tries) {
    uint32_t pause = ELMOPP_BXCAN_PAUSE_MS;
    for (uint32_t k = 1U; (k < tries) && (pause < ELMOPP_BXCAN_PAUSE_MAX_MS); k++) {
        pause *= 2U;
    }
    return (pause < ELMOPP_BXCAN_PAUSE_MAX_MS) ? pause : ELMOPP_BXCAN_PAUSE_MAX_MS;
}

static void step_pausing(elmopp_bxcan_t *self, uint32_t now_ms) {
    if (!has_lasted(self, pause_ms(self->tries), now_ms)) {
        return;
    }
    if (self->off_bus) {
        set_mode(self, INITIALISATION_MODE);
        enter(self, ELMOPP_BXCAN_LEAVING, now_ms);
    } else {
        reset(self, now_ms);
    }
}

static void step_leaving(elmopp_bxcan_t *self, uint32_t now_ms) {
    if (mode_shown(self) == ELMOPP_BXCAN_MSR_INAK) {
        set_mode(self, NORMAL_MODE);
        enter(self, ELMOPP_BXCAN_RETURNING, now_ms);
    } else {
        fail_if_late(self, ELMOPP_BXCAN_ANSWER_MS, ELMOPP_BXCAN_NO_INIT, now_ms);
    }
}

static void step_returning(elmopp_bxcan_t *self, uint32_t now_ms) {
    if (is_on_bus(self)) {
        self->returned++;
        run(self, now_ms);
    } else {
        fail_if_late(self, ELMOPP_BXCAN_JOIN_MS, ELMOPP_BXCAN_NO_RETURN, now_ms);
    }
}

void elmopp_bxcan_step(elmopp_bxcan_t *self, uint32_t now_ms) {
    switch (self->state) {
    case ELMOPP_BXCAN_RESETTING:
        step_resetting(self, now_ms);
        break;
    case ELMOPP_BXCAN_ENTERING:
        step_entering(self, now_ms);
        break;
    case ELMOPP_BXCAN_JOINING:
        step_joining(self, now_ms);
        break;
    case ELMOPP_BXCAN_RUNNING:
        step_running(self, now_ms);
        break;
    case ELMOPP_BXCAN_PAUSING:
        step_pausing(self, now_ms);
        break;
    case ELMOPP_BXCAN_LEAVING:
        step_leaving(self, now_ms);
        break;
    case ELMOPP_BXCAN_RETURNING:
        step_returning(self, now_ms);
        break;
    case ELMOPP_BXCAN_OFF:
    case ELMOPP_BXCAN_HELD:
    case ELMOPP_BXCAN_FAILED:
    default:
        break;
    }
}

/* --- frames --- */

bool elmopp_bxcan_send(elmopp_bxcan_t *self, const elmopp_frame_t *frame, uint32_t now_ms) {
    if (self->state != ELMOPP_BXCAN_RUNNING) {
        self->mailboxes.unsent++;
        return false;
    }
    return elmopp_bxcan_mailboxes_put(&self->mailboxes, frame, now_ms);
}

bool elmopp_bxcan_receive(elmopp_bxcan_t *self, elmopp_frame_t *frame) {
    return elmopp_bxcan_fifo_take(&self->fifo, frame);
}

void elmopp_bxcan_interrupt(elmopp_bxcan_t *self) {
    elmopp_bxcan_fifo_interrupt(&self->fifo);
}

uint32_t elmopp_bxcan_overruns(const elmopp_bxcan_t *self) {
    return atomic_load(&self->fifo.lost);
}

const char *elmopp_bxcan_trouble_name(elmopp_bxcan_trouble_t trouble) {
    static const char *const names[ELMOPP_BXCAN_TROUBLES] = {
        [ELMOPP_BXCAN_WELL] = "well",
        [ELMOPP_BXCAN_NO_RESET] = "its reset does not end",
        [ELMOPP_BXCAN_NO_INIT] = "it does not answer",
        [ELMOPP_BXCAN_NO_TIMING] = "its bit timing does not read back",
        [ELMOPP_BXCAN_NO_JOIN] = "the bus is never idle",
        [ELMOPP_BXCAN_BUS_OFF] = "bus-off",
        [ELMOPP_BXCAN_NO_RETURN] = "no way back from bus-off",
        [ELMOPP_BXCAN_NO_MAILBOX] = "a mailbox does not empty",
        [ELMOPP_BXCAN_NO_RELEASE] = "its FIFO releases no frame",
        [ELMOPP_BXCAN_LEFT] = "it left the bus unasked",
    };
    const uint32_t number = (uint32_t)trouble;
    return (number < (uint32_t)ELMOPP_BXCAN_TROUBLES) ? names[number] : "unknown";
}
