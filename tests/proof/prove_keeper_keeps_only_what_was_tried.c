/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// What comes over the bus is handed to a store only after it was whole by its checksum, passed its own check, was no
/// site for simulation, and has run on trial, all of it, without a fault in that tick; nobody has written to the buffer
/// since it was looked at. It is called kept only when the store has come to its end without another failure. A trial
/// begins at nothing and grows by a tick in a steady mode only.
///
/// By induction over frames and ticks: any keeper that such steps leave, any controller, any frame. What looks at an
/// image, and the store, are replaced by others that say anything and note it. What was learned on the spot
/// (elmopp_keeper_save()) runs already and has no trial; it is left out but for the state in which it leaves the
/// keeper.

#include "keeper.c"

#include "claims.h"

elmopp_transfer_report_t nondet_report(void);
elmopp_fault_t nondet_fault(void);
elmopp_mode_t nondet_mode(void);
elmopp_foresight_t nondet_foresight(void);
elmopp_store_phase_t nondet_phase(void);
elmopp_frame_t nondet_frame(void);
elmopp_image_fault_t nondet_image_fault(void);
elmopp_weights_fault_t nondet_weights_fault(void);
elmopp_site_verdict_t nondet_site_verdict(void);
elmopp_transfer_verdict_t nondet_transfer_verdict(void);

static elmopp_keeper_t keeper;
static elmopp_controller_t controller;
static const elmopp_image_kind_t kinds[ELMOPP_KEEPER_STORES] = {{{'E', 'L', 'M', 'W'}, 2U, 40U},
                                                                {{'E', 'L', 'M', 'S'}, 4U, 20U}};

/* What is known of the bytes in the buffer. */
static bool is_intact;
static bool is_good;
static bool is_for_simulation;

static void forget(void) {
    is_intact = false;
    is_good = false;
    is_for_simulation = true;
}

const elmopp_image_kind_t *weights_kind(void);
const elmopp_image_kind_t *site_kind(void);
elmopp_image_fault_t any_envelope(const elmopp_image_kind_t *kind, const uint8_t *image, uint32_t length);
elmopp_weights_fault_t any_weights(const elmopp_weights_t *weights);
elmopp_site_verdict_t any_site(const uint8_t *image, uint32_t length, elmopp_junction_t *out);
bool any_simulation(const uint8_t *image);
bool any_fit(uint8_t kind, const elmopp_weights_t *weights);
bool any_network(uint8_t kind);
bool any_room(const elmopp_store_t *store);
const uint8_t *any_newest(const elmopp_store_t *store);
bool watched_save(elmopp_store_t *store, const uint8_t *image);
void watched_begin(elmopp_transfer_t *self, const elmopp_frame_t *first, uint8_t *bytes);
elmopp_transfer_verdict_t watched_take(elmopp_transfer_t *self, const elmopp_frame_t *frame);
void any_count(elmopp_controller_t *self, uint32_t refused);

const elmopp_image_kind_t *weights_kind(void) {
    return &kinds[WEIGHTS];
}

const elmopp_image_kind_t *site_kind(void) {
    return &kinds[SITE];
}

elmopp_image_fault_t any_envelope(const elmopp_image_kind_t *kind, const uint8_t *image, uint32_t length) {
    const elmopp_image_fault_t fault = nondet_image_fault();
    ASSUME((uint32_t)fault < IMAGE_VERDICTS);
    CLAIM((image == buffer_of(&keeper)) && (length == whole_bytes(kind)), "all of what has come is looked at");
    CLAIM(kind == &kinds[store_of(keeper.told.kind)], "as what it is");
    is_intact = fault == ELMOPP_IMAGE_OK;
    return fault;
}

elmopp_weights_fault_t any_weights(const elmopp_weights_t *weights) {
    const elmopp_weights_fault_t fault = nondet_weights_fault();
    if (weights == weights_of(buffer_of(&keeper))) {
        is_good = fault == ELMOPP_WEIGHTS_OK;
    }
    return fault;
}

elmopp_site_verdict_t any_site(const uint8_t *image, uint32_t length, elmopp_junction_t *out) {
    const elmopp_site_verdict_t verdict = nondet_site_verdict();
    (void)length;
    (void)out;
    if (image == buffer_of(&keeper)) {
        is_good = verdict.fault == ELMOPP_SITE_OK;
    }
    return verdict;
}

bool any_simulation(const uint8_t *image) {
    const bool is = nondet_bool();
    if (image == buffer_of(&keeper)) {
        is_for_simulation = is;
    }
    return is;
}

bool any_fit(uint8_t kind, const elmopp_weights_t *weights) {
    (void)kind;
    (void)weights;
    return nondet_bool();
}

bool any_network(uint8_t kind) {
    (void)kind;
    return nondet_bool();
}

bool any_room(const elmopp_store_t *store) {
    (void)store;
    return nondet_bool();
}

const uint8_t *any_newest(const elmopp_store_t *store) {
    static const uint8_t stored[2U * ELMOPP_IMAGE_HEADER];
    (void)store;
    return nondet_bool() ? stored : NULL;
}

static bool is_verified(void) {
    return is_intact && is_good && ((keeper.told.kind != ELMOPP_TRANSFER_SITE) || (!is_for_simulation));
}

bool watched_save(elmopp_store_t *store, const uint8_t *image) {
    CLAIM(store == &keeper.store[store_of(keeper.told.kind)], "into its own store");
    CLAIM(image == buffer_of(&keeper), "what is in the buffer");
    CLAIM(is_verified(), "what was verified");
    CLAIM((keeper.told.state == ELMOPP_TRANSFER_ON_TRIAL) && (keeper.trial_ds == ELMOPP_KEEPER_TRIAL_DS),
          "after all of its trial");
    CLAIM(controller.fault == ELMOPP_FAULT_NONE, "without a fault");
    return nondet_bool();
}

void watched_begin(elmopp_transfer_t *self, const elmopp_frame_t *first, uint8_t *bytes) {
    (void)first;
    CLAIM(bytes == buffer_of(&keeper), "into the buffer");
    CLAIM(!is_busy(&keeper), "while nothing is under way");
    forget();
    self->receiving = true;
}

elmopp_transfer_verdict_t watched_take(elmopp_transfer_t *self, const elmopp_frame_t *frame) {
    elmopp_transfer_verdict_t verdict = ELMOPP_TRANSFER_STRANGE;
    (void)frame;
    if (self->receiving) {
        verdict = nondet_transfer_verdict();
        ASSUME((uint32_t)verdict <= (uint32_t)ELMOPP_TRANSFER_STRANGE);
        self->receiving = (verdict == ELMOPP_TRANSFER_TAKEN) || (verdict == ELMOPP_TRANSFER_STRANGE);
        forget();
    }
    return verdict;
}

void any_count(elmopp_controller_t *self, uint32_t refused) {
    (void)self;
    (void)refused;
}

static bool is_sound(void) {
    const elmopp_transfer_state_t state = keeper.told.state;
    const bool comes = keeper.transfer.receiving || keeper.whole;
    bool sound = ((uint32_t)state <= (uint32_t)ELMOPP_TRANSFER_WITHDRAWN) &&
                 ((uint32_t)keeper.told.kind <= (uint32_t)ELMOPP_TRANSFER_SITE) &&
                 (!(keeper.transfer.receiving && keeper.whole)) && (comes == (state == ELMOPP_TRANSFER_RECEIVING));
    if (state == ELMOPP_TRANSFER_ON_TRIAL) {
        sound = sound && is_verified() && (!keeper.learned) && (keeper.trial_ds < ELMOPP_KEEPER_TRIAL_DS);
    } else if (state == ELMOPP_TRANSFER_STORING) {
        sound = sound && (keeper.learned || (is_verified() && (keeper.trial_ds == ELMOPP_KEEPER_TRIAL_DS)));
    } else if (state == ELMOPP_TRANSFER_RECEIVING) {
        sound = sound && (keeper.told.kind != ELMOPP_TRANSFER_NOTHING);
    } else {
        /* nothing is under way */
    }
    return sound;
}

static void claim_of_states(elmopp_transfer_state_t before, uint16_t trial_ds, bool was_idle, bool has_failed) {
    const elmopp_transfer_state_t after = keeper.told.state;
    const bool tries = after == ELMOPP_TRANSFER_ON_TRIAL;
    const bool steady = elmopp_mode_is_steady(controller.mode);
    if (before != after) {
        CLAIM((!tries) || (before == ELMOPP_TRANSFER_RECEIVING), "only what has come is tried");
        CLAIM((!tries) || (keeper.trial_ds == 0U), "a trial begins at nothing");
        CLAIM((after != ELMOPP_TRANSFER_STORING) || (before == ELMOPP_TRANSFER_ON_TRIAL),
              "only what was tried is written");
        CLAIM((after != ELMOPP_TRANSFER_KEPT) || ((before == ELMOPP_TRANSFER_STORING) && was_idle && (!has_failed)),
              "only what is written is kept");
    } else {
        CLAIM((!tries) || ((uint32_t)keeper.trial_ds <= (trial_ds + (steady ? 1U : 0U))),
              "a tick a tick, while steady");
    }
}

/* Everything that is read; nobody here looks into an image, a site or a medium. */
static void make_any(void) {
    keeper.config.weights_by_hand = nondet_bool();
    keeper.config.site_by_hand = nondet_bool();
    for (uint32_t k = 0U; k < ELMOPP_KEEPER_STORES; k++) {
        keeper.store[k].phase = nondet_phase();
        keeper.store[k].failed = nondet_u16();
    }
    keeper.transfer.receiving = nondet_bool();
    keeper.transfer.owes_flow = nondet_bool();
    keeper.transfer.age_ds = nondet_u8() % ELMOPP_TRANSFER_TIMEOUT_DS;
    keeper.told = nondet_report();
    keeper.quiet_ds = nondet_u32();
    keeper.trial_ds = nondet_u16();
    keeper.failed = nondet_u16();
    keeper.told_ds = nondet_u16();
    keeper.refused = nondet_u16();
    keeper.saved = nondet_u16();
    keeper.has_site = nondet_bool();
    keeper.learned = nondet_bool();
    keeper.whole = nondet_bool();
    keeper.news = nondet_bool();
    keeper.second = nondet_bool();
    controller.fault = nondet_fault();
    controller.fault_group = nondet_u8();
    controller.mode = nondet_mode();
    controller.reset_held = nondet_bool();
    controller.pilot.foresight = nondet_foresight();
    controller.pilot.forecast.config.kind = nondet_u8();
    is_intact = nondet_bool();
    is_good = nondet_bool();
    is_for_simulation = nondet_bool();
}

void harness(void) {
    elmopp_frame_t out[ELMOPP_KEEPER_FRAMES];
    uint32_t count = 0U;
    make_any();
    ASSUME(is_sound());
    const elmopp_transfer_state_t before = keeper.told.state;
    const uint16_t trial_ds = keeper.trial_ds;
    const elmopp_store_t *store = &keeper.store[store_of(keeper.told.kind)];
    const bool was_idle = store->phase == ELMOPP_STORE_IDLE;
    const bool has_failed = store->failed != keeper.failed;
#if PART == 0
    (void)elmopp_keeper_tick(&keeper, &controller, out, &count);
#else
    const elmopp_frame_t frame = nondet_frame();
    (void)out;
    (void)count;
    (void)elmopp_keeper_take(&keeper, &controller, &frame);
#endif
    CLAIM(is_sound(), "a step leaves such a keeper");
    claim_of_states(before, trial_ds, was_idle, has_failed);
    REACHABLE();
}
