/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "board.h"

#include "elmopp/image.h"
#include "elmopp/site.h"
#include "elmopp/station.h"
#include "elmopp_weights.h"
#include "note.h"
#include "pace.h"
#include "port.h"
#include "seal.h"

#include <stddef.h>

#define WORD 4U
#define ONES 0xFFU

/* What was found at the start. */
typedef struct {
    bool memory;
    bool processor;
    bool site;
    bool weights;
} troubles_t;

static elmopp_station_t station;
static elmopp_junction_t stored_site;
static elmopp_weights_t stored_weights;

/* --- what is stored --- */

static bool is_empty(const elmopp_port_slot_t *slot) {
    bool zeros = true;
    bool ones = true;
    for (uint32_t k = 0U; (slot->bytes != NULL) && (k < WORD); k++) {
        zeros = zeros && (slot->bytes[k] == 0U);
        ones = ones && (slot->bytes[k] == ONES);
    }
    return zeros || ones;
}

static const elmopp_junction_t *load_site(troubles_t *troubles) {
    const elmopp_port_slot_t slot = elmopp_port_site_slot();
    const uint32_t length = ELMOPP_IMAGE_HEADER + (uint32_t)sizeof stored_site;
    if (is_empty(&slot)) {
        return elmopp_board_site;
    }
    if ((slot.size < length) || (elmopp_site_load(slot.bytes, length, &stored_site).fault != ELMOPP_SITE_OK)) {
        elmopp_port_say("the stored site is refused: it is not what tools/site writes");
        troubles->site = true;
        return elmopp_board_site;
    }
    if (stored_site.simulation_only != 0U) {
        elmopp_port_say("the stored site is refused: it is simulation_only and drives no lamps:");
        elmopp_port_say(stored_site.name);
        troubles->site = true;
        return elmopp_board_site;
    }
    return &stored_site;
}

/* Null: nothing is stored, or nothing that can be used. */
static const elmopp_weights_t *load_weights(troubles_t *troubles) {
    const elmopp_port_slot_t slot = elmopp_port_weights_slot();
    const uint32_t length = ELMOPP_IMAGE_HEADER + (uint32_t)sizeof stored_weights;
    if (is_empty(&slot)) {
        return NULL;
    }
    const elmopp_weights_fault_t fault =
        (slot.size < length) ? ELMOPP_WEIGHTS_LENGTH : elmopp_weights_load(slot.bytes, length, &stored_weights);
    if (fault != ELMOPP_WEIGHTS_OK) {
        elmopp_port_say("the stored weights are refused:");
        elmopp_port_say(elmopp_weights_fault_name(fault));
        troubles->weights = true;
        return NULL;
    }
    return &stored_weights;
}

/* The stored network if it is of the kind that the site asks for, the shipped one otherwise. */
static const elmopp_weights_t *choose_weights(const elmopp_junction_t *junction, const elmopp_weights_t *stored,
                                              troubles_t *troubles) {
    const bool nested = elmopp_forecast_is_nested(junction->forecast);
    const elmopp_weights_t *shipped = nested ? &elmopp_weights_nlstm : &elmopp_weights_lstm;
    if (stored == NULL) {
        return shipped;
    }
    if ((stored->lstm.levels > 1U) != nested) {
        elmopp_port_say("the stored weights are refused: the site asks for a network of another kind");
        troubles->weights = true;
        return shipped;
    }
    if (elmopp_forecast_is_network(junction->forecast) && (!elmopp_forecast_fits(junction->forecast, stored))) {
        elmopp_port_say("the stored weights are refused: in whole numbers a row of them could overflow");
        troubles->weights = true;
        return shipped;
    }
    return stored;
}

/* --- a run --- */

static void begin(const elmopp_junction_t *junction, const elmopp_weights_t *weights, const troubles_t *troubles) {
    elmopp_controller_t *controller = &station.controller;
    elmopp_station_init(&station, junction, &elmopp_weights_lstm.ar8, weights);
    if (troubles->processor) {
        elmopp_controller_report(controller, ELMOPP_FAULT_PROCESSOR);
    }
    if (troubles->site) {
        elmopp_controller_report(controller, ELMOPP_FAULT_SITE_CHANGED);
    }
    if (troubles->weights) {
        elmopp_controller_report(controller, ELMOPP_FAULT_WEIGHTS_CHANGED);
    }
}

static void take_frames(elmopp_controller_t *controller) {
    elmopp_frame_t frame;
    bool go_on = true;
    for (uint32_t k = 0U; go_on && (k < ELMOPP_BOARD_FRAMES_MAX); k++) {
        go_on = elmopp_port_receive(&frame);
        if (go_on && elmopp_pace_take(&frame)) {
            go_on = false;
        } else if (go_on) {
            (void)elmopp_controller_take(controller, &frame);
        } else {
            /* nothing more has come */
        }
    }
}

/* What is still there is told again in every tick: no command clears it. */
static void report(elmopp_controller_t *controller, bool memory_is_broken) {
    const elmopp_fault_t found = elmopp_port_fault();
    if (memory_is_broken) {
        elmopp_controller_report(controller, ELMOPP_FAULT_MEMORY);
    }
    if (found != ELMOPP_FAULT_NONE) {
        elmopp_controller_report(controller, found);
    }
}

/* For people at the board, to whom a bus that is dead tells nothing. */
static void tell(const elmopp_controller_t *controller, elmopp_mode_t before) {
    const bool is_safe = controller->mode == ELMOPP_MODE_FAIL_SAFE;
    const bool was_safe = before == ELMOPP_MODE_FAIL_SAFE;
    if (is_safe && (!was_safe)) {
        elmopp_port_say("fail-safe, the lamps flash; fault:");
        elmopp_port_say(elmopp_fault_name(controller->fault));
    } else if (was_safe && (!is_safe)) {
        elmopp_port_say("the fault has been cleared");
    } else {
        /* no news */
    }
}

static void tick(elmopp_controller_t *controller, elmopp_ms_t now_ms, bool memory_is_broken) {
    elmopp_frame_t out[ELMOPP_FRAMES_PER_TICK];
    const elmopp_mode_t before = controller->mode;
    report(controller, memory_is_broken);
    elmopp_controller_refuse(controller, elmopp_port_dropped());
    elmopp_controller_hold_reset(controller, elmopp_port_reset_is_held());
    const uint32_t count = elmopp_controller_tick(controller, now_ms, out);
    elmopp_pace_send(controller, out, count);
    tell(controller, before);
    elmopp_port_kick_watchdog();
}

void elmopp_board_run(bool memory_is_good) {
    elmopp_controller_t *controller = &station.controller;
    troubles_t troubles = {false, false, false, false};
    elmopp_port_init();
    troubles.memory = !(memory_is_good && elmopp_seal_is_whole());
    troubles.processor = elmopp_note_take();
    const elmopp_junction_t *junction = load_site(&troubles);
    const elmopp_weights_t *weights = choose_weights(junction, load_weights(&troubles), &troubles);
    begin(junction, weights, &troubles);
    elmopp_pace_begin();
    for (;;) {
        elmopp_ms_t now_ms = 0U;
        take_frames(controller);
        const elmopp_pace_due_t due = elmopp_pace_due(&now_ms);
        if (due == ELMOPP_PACE_ANEW) {
            begin(junction, weights, &troubles);
        } else if (due == ELMOPP_PACE_TICK) {
            tick(controller, now_ms, troubles.memory);
        } else {
            elmopp_pace_wait();
        }
    }
}
