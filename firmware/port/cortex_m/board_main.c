/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "board.h"

#include "elmopp/image.h"
#include "elmopp/keeper.h"
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
#define DIGITS 3U /* of what a verdict names */
#define TEN 10U
#define FIRST_AT 3U /* of its digits */
#define SECOND_AT 11U
#define DECIDED 1U /* second_ds after the tick of a decision */

/* What was found at the start. */
typedef struct {
    bool memory;
    bool processor;
    bool site;
    bool weights;
} troubles_t;

/* What a person has put into the board. */
typedef struct {
    bool has_site; /* something stands there, good or not */
    bool has_weights;
    const elmopp_junction_t *site; /* null: none that can be used */
    const elmopp_weights_t *weights;
} by_hand_t;

static elmopp_station_t station;
static elmopp_keeper_t keeper;
static elmopp_junction_t stored_site;
static by_hand_t by_hand;

/* --- what is stored by hand --- */

static bool is_empty(const elmopp_port_slot_t *slot) {
    bool zeros = true;
    bool ones = true;
    for (uint32_t k = 0U; (slot->bytes != NULL) && (k < WORD); k++) {
        zeros = zeros && (slot->bytes[k] == 0U);
        ones = ones && (slot->bytes[k] == ONES);
    }
    return zeros || ones;
}

static void put_number(char *digits, uint32_t number) {
    uint32_t rest = number;
    for (uint32_t k = DIGITS; k > 0U; k--) {
        digits[k - 1U] = (char)('0' + (char)(rest % TEN));
        rest /= TEN;
    }
}

/* The rule in words, and what it names by numbers: the names are in what is refused. */
static void say_site_fault(const elmopp_site_verdict_t *verdict) {
    char places[] = "at 000 and 000, counted from 0 (site.h)";
    put_number(&places[FIRST_AT], verdict->first);
    put_number(&places[SECOND_AT], verdict->second);
    elmopp_port_say("the stored site is refused:");
    elmopp_port_say(elmopp_site_fault_name(verdict->fault));
    elmopp_port_say(places);
}

/* Null: nothing is stored, or nothing that can be used. */
static const elmopp_junction_t *load_site(const elmopp_port_slot_t *slot, troubles_t *troubles) {
    const uint32_t length = ELMOPP_IMAGE_HEADER + (uint32_t)sizeof stored_site;
    elmopp_site_verdict_t verdict = {.fault = ELMOPP_SITE_IMAGE_LENGTH, .first = 0U, .second = 0U};
    if (slot->size >= length) {
        verdict = elmopp_site_load(slot->bytes, length, &stored_site);
    }
    if (verdict.fault != ELMOPP_SITE_OK) {
        say_site_fault(&verdict);
        troubles->site = true;
        return NULL;
    }
    if (stored_site.simulation_only != 0U) {
        elmopp_port_say("the stored site is refused: it is simulation_only and drives no lamps:");
        elmopp_port_say(stored_site.name);
        troubles->site = true;
        return NULL;
    }
    return &stored_site;
}

/* They are used where they stand. */
static const elmopp_weights_t *load_weights(const elmopp_port_slot_t *slot, troubles_t *troubles) {
    const uint32_t length = ELMOPP_IMAGE_HEADER + (uint32_t)sizeof(elmopp_weights_t);
    const elmopp_weights_fault_t fault =
        (slot->size < length) ? ELMOPP_WEIGHTS_LENGTH : elmopp_weights_check_image(slot->bytes, length);
    if (fault != ELMOPP_WEIGHTS_OK) {
        elmopp_port_say("the stored weights are refused:");
        elmopp_port_say(elmopp_weights_fault_name(fault));
        troubles->weights = true;
        return NULL;
    }
    const void *body = &slot->bytes[ELMOPP_IMAGE_HEADER];
    return (const elmopp_weights_t *)body;
}

static void load_by_hand(troubles_t *troubles) {
    const elmopp_port_slot_t site = elmopp_port_site_slot();
    const elmopp_port_slot_t weights = elmopp_port_weights_slot();
    by_hand.has_site = !is_empty(&site);
    by_hand.has_weights = !is_empty(&weights);
    by_hand.site = by_hand.has_site ? load_site(&site, troubles) : NULL;
    by_hand.weights = by_hand.has_weights ? load_weights(&weights, troubles) : NULL;
}

/* --- what is in force: by hand, from the bus, or compiled in --- */

static const elmopp_junction_t *site_in_force(void) {
    const elmopp_junction_t *site = by_hand.has_site ? by_hand.site : elmopp_keeper_site(&keeper);
    return (site == NULL) ? elmopp_board_site : site;
}

/* Those by hand, if they can be used; who put some there wants no others. */
static const elmopp_weights_t *shipped_for(const elmopp_junction_t *junction) {
    const elmopp_weights_t *compiled =
        elmopp_forecast_is_nested(junction->forecast) ? &elmopp_weights_nlstm : &elmopp_weights_lstm;
    return elmopp_forecast_fits(junction->forecast, by_hand.weights) ? by_hand.weights : compiled;
}

/* What came over the bus was right for the site that ran then; another one may have no use for it. */
static elmopp_station_weights_t weights_in_force(const elmopp_junction_t *junction) {
    const elmopp_weights_t *kept = by_hand.has_weights ? NULL : elmopp_keeper_weights(&keeper);
    return elmopp_station_weights(junction, shipped_for(junction), kept);
}

/* Weights by hand must be of the kind that the site asks for: who put them there meant them to be used. */
static void check_weights_by_hand(const elmopp_junction_t *junction, troubles_t *troubles) {
    const bool nested = elmopp_forecast_is_nested(junction->forecast);
    if ((by_hand.weights != NULL) && ((by_hand.weights->lstm.levels > 1U) != nested)) {
        elmopp_port_say("the stored weights are refused: the site asks for a network of another kind");
        troubles->weights = true;
        by_hand.weights = NULL;
    }
    if ((by_hand.weights != NULL) && elmopp_forecast_is_network(junction->forecast) &&
        (!elmopp_forecast_fits(junction->forecast, by_hand.weights))) {
        elmopp_port_say("the stored weights are refused: in whole numbers a row of them could overflow");
        troubles->weights = true;
        by_hand.weights = NULL;
    }
}

/* --- what outlives a reset --- */

static void work_for_store(uint32_t orders_max) {
    elmopp_transfer_kind_t kind = ELMOPP_TRANSFER_NOTHING;
    elmopp_store_order_t order;
    for (uint32_t k = 0U; (k < orders_max) && elmopp_keeper_next(&keeper, &kind, &order); k++) {
        elmopp_keeper_answer(&keeper, kind, elmopp_port_store(kind, &order));
    }
}

static void look_for_damage(elmopp_transfer_kind_t kind, bool is_in_use, bool *trouble) {
    if (is_in_use && elmopp_keeper_is_damaged(&keeper, kind)) {
        elmopp_port_say((kind == ELMOPP_TRANSFER_SITE)
                            ? "the site that was kept is damaged: an older one is in force"
                            : "the weights that were kept are damaged: older ones are in force");
        *trouble = true;
    }
}

static void open_keeper(troubles_t *troubles) {
    const elmopp_keeper_config_t config = {.weights = elmopp_port_medium(ELMOPP_TRANSFER_WEIGHTS),
                                           .site = elmopp_port_medium(ELMOPP_TRANSFER_SITE),
                                           .weights_by_hand = by_hand.has_weights,
                                           .site_by_hand = by_hand.has_site,
                                           .save_min_s = elmopp_port_save_min_s()};
    elmopp_keeper_init(&keeper, &config);
    look_for_damage(ELMOPP_TRANSFER_WEIGHTS, !by_hand.has_weights, &troubles->weights);
    look_for_damage(ELMOPP_TRANSFER_SITE, !by_hand.has_site, &troubles->site);
    work_for_store(ELMOPP_KEEPER_TIDY_ORDERS_MAX);
}

/* --- a run --- */

static void begin(const troubles_t *troubles) {
    elmopp_controller_t *controller = &station.controller;
    const elmopp_junction_t *junction = site_in_force();
    const elmopp_station_weights_t weights = weights_in_force(junction);
    const elmopp_station_room_t room = {.learning = elmopp_port_learning(), .inner = NULL};
    elmopp_station_init(&station, junction, &elmopp_weights_lstm.ar8, &weights, &room);
    if (!elmopp_station_learns_as_asked(&station)) {
        elmopp_port_say("the site asks to learn on, and this board has no room for such a network: it does not learn");
    }
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
        } else if (go_on && (!elmopp_keeper_take(&keeper, controller, &frame))) {
            (void)elmopp_controller_take(controller, &frame);
        } else {
            /* nothing more has come, or the keeper has taken it */
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

static void use_what_is_new(elmopp_keeper_change_t change, const troubles_t *troubles) {
    if (change == ELMOPP_KEEPER_BEGIN) {
        begin(troubles);
        if (keeper.fault != ELMOPP_FAULT_NONE) {
            elmopp_controller_report(&station.controller, keeper.fault);
        }
    } else if (change == ELMOPP_KEEPER_USE_WEIGHTS) {
        const elmopp_station_weights_t weights = weights_in_force(station.controller.junction);
        elmopp_station_use_weights(&station, &weights);
    } else {
        /* it goes on */
    }
}

static elmopp_keeper_change_t keep(elmopp_controller_t *controller) {
    elmopp_frame_t out[ELMOPP_KEEPER_FRAMES];
    uint32_t count = 0U;
    const elmopp_keeper_change_t change = elmopp_keeper_tick(&keeper, controller, out, &count);
    for (uint32_t k = 0U; k < count; k++) {
        (void)elmopp_port_send(&out[k]);
    }
    return change;
}

static void tick(elmopp_controller_t *controller, elmopp_ms_t now_ms, const troubles_t *troubles) {
    elmopp_frame_t out[ELMOPP_FRAMES_PER_TICK];
    const elmopp_mode_t before = controller->mode;
    report(controller, troubles->memory);
    elmopp_controller_refuse(controller, elmopp_port_dropped());
    elmopp_controller_hold_reset(controller, elmopp_port_reset_is_held());
    const uint32_t count = elmopp_controller_tick(controller, now_ms, out);
    const elmopp_keeper_change_t change = (count > 0U) ? keep(controller) : ELMOPP_KEEPER_GO_ON;
    elmopp_pace_send(controller, out, count);
    tell(controller, before);
    use_what_is_new(change, troubles);
    if (controller->second_ds != DECIDED) {
        work_for_store(ELMOPP_BOARD_ORDERS_MAX);
    }
    elmopp_port_kick_watchdog();
}

void elmopp_board_run(bool memory_is_good) {
    elmopp_controller_t *controller = &station.controller;
    troubles_t troubles = {false, false, false, false};
    elmopp_port_init();
    troubles.memory = !(memory_is_good && elmopp_seal_is_whole());
    troubles.processor = elmopp_note_take();
    load_by_hand(&troubles);
    open_keeper(&troubles);
    check_weights_by_hand(site_in_force(), &troubles);
    begin(&troubles);
    elmopp_pace_begin();
    for (;;) {
        elmopp_ms_t now_ms = 0U;
        take_frames(controller);
        const elmopp_pace_due_t due = elmopp_pace_due(&now_ms);
        if (due == ELMOPP_PACE_ANEW) {
            begin(&troubles);
        } else if (due == ELMOPP_PACE_TICK) {
            tick(controller, now_ms, &troubles);
        } else {
            elmopp_pace_wait();
        }
    }
}
