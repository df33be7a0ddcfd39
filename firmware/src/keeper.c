/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/keeper.h"

#include "elmopp/assert.h"
#include "elmopp/site.h"

#include "elmopp_can.h"

#include <stddef.h>
#include <string.h>

#define DS_PER_S 10U
#define WEIGHTS 0U /* of the stores */
#define SITE 1U
#define IMAGE_VERDICTS 5U

static_assert(ELMOPP_KEEPER_IMAGE_MAX >= (ELMOPP_IMAGE_HEADER + sizeof(elmopp_junction_t)), "weights are the larger");
static_assert((ELMOPP_KEEPER_IMAGE_MAX % ELMOPP_STORE_WORD) == 0U, "the buffer has room for all of an image");

/* --- images --- */

static uint8_t *buffer_of(elmopp_keeper_t *self) {
    return (uint8_t *)self->buffer;
}

/* The body of an image that has been checked, where it stands. A medium's slots and the buffer begin at a word, and
   neither struct has a member that needs more. */
static const elmopp_weights_t *weights_of(const uint8_t *image) {
    const void *body = &image[ELMOPP_IMAGE_HEADER];
    return (const elmopp_weights_t *)body;
}

static uint32_t store_of(elmopp_transfer_kind_t kind) {
    return (kind == ELMOPP_TRANSFER_SITE) ? SITE : WEIGHTS;
}

static uint32_t whole_bytes(const elmopp_image_kind_t *kind) {
    return ELMOPP_IMAGE_HEADER + kind->body_bytes;
}

static const elmopp_image_kind_t *image_kind(elmopp_transfer_kind_t kind) {
    return (kind == ELMOPP_TRANSFER_SITE) ? elmopp_site_kind() : elmopp_weights_kind();
}

static elmopp_transfer_kind_t kind_of_length(uint32_t length) {
    const elmopp_transfer_kind_t other =
        (length == whole_bytes(elmopp_site_kind())) ? ELMOPP_TRANSFER_SITE : ELMOPP_TRANSFER_NOTHING;
    return (length == whole_bytes(elmopp_weights_kind())) ? ELMOPP_TRANSFER_WEIGHTS : other;
}

static bool is_simulation(const uint8_t *site_image) {
    return site_image[ELMOPP_IMAGE_HEADER + (uint32_t)offsetof(elmopp_junction_t, simulation_only)] != 0U;
}

/* --- what is stored --- */

static void use_stored_weights(elmopp_keeper_t *self) {
    const uint8_t *newest = elmopp_store_newest(&self->store[WEIGHTS]);
    const bool good = (newest != NULL) && (elmopp_weights_check(weights_of(newest)) == ELMOPP_WEIGHTS_OK);
    self->weights_image = good ? newest : NULL;
}

static void use_stored_site(elmopp_keeper_t *self) {
    const uint8_t *newest = elmopp_store_newest(&self->store[SITE]);
    self->has_site = (newest != NULL) && (!is_simulation(newest)) &&
                     (elmopp_site_load(newest, whole_bytes(elmopp_site_kind()), &self->site).fault == ELMOPP_SITE_OK);
}

static void open_store(elmopp_keeper_t *self, elmopp_transfer_kind_t kind, const elmopp_store_medium_t *medium) {
    elmopp_store_t *store = &self->store[store_of(kind)];
    elmopp_store_init(store, medium, image_kind(kind));
    self->damaged[store_of(kind)] = elmopp_store_is_damaged(store);
    if (!medium->erases_any_time) {
        elmopp_store_tidy(store);
    }
}

void elmopp_keeper_init(elmopp_keeper_t *self, const elmopp_keeper_config_t *config) {
    (void)memset(self, 0, sizeof *self);
    self->config = *config;
    self->told = (elmopp_transfer_report_t){
        .kind = ELMOPP_TRANSFER_NOTHING, .state = ELMOPP_TRANSFER_IDLE, .reason = ELMOPP_TRANSFER_NO_REASON};
    self->fault = ELMOPP_FAULT_NONE;
    open_store(self, ELMOPP_TRANSFER_WEIGHTS, &config->weights);
    open_store(self, ELMOPP_TRANSFER_SITE, &config->site);
    elmopp_transfer_init(&self->transfer);
    use_stored_weights(self);
    use_stored_site(self);
}

const elmopp_junction_t *elmopp_keeper_site(const elmopp_keeper_t *self) {
    return self->has_site ? &self->site : NULL;
}

const elmopp_weights_t *elmopp_keeper_weights(const elmopp_keeper_t *self) {
    return (self->weights_image == NULL) ? NULL : weights_of(self->weights_image);
}

bool elmopp_keeper_is_damaged(const elmopp_keeper_t *self, elmopp_transfer_kind_t kind) {
    return self->damaged[store_of(kind)];
}

/* --- how it stands --- */

static void tell(elmopp_keeper_t *self, elmopp_transfer_state_t state, elmopp_transfer_reason_t reason) {
    self->told.state = state;
    self->told.reason = reason;
    self->told.first = 0U;
    self->told.second = 0U;
    self->told.left_s = 0U;
    self->news = true;
}

static void count_refused(elmopp_keeper_t *self) {
    self->refused = (self->refused < UINT16_MAX) ? (uint16_t)(self->refused + 1U) : self->refused;
}

static void refuse(elmopp_keeper_t *self, elmopp_transfer_reason_t reason) {
    tell(self, ELMOPP_TRANSFER_REFUSED, reason);
    count_refused(self);
}

static void name_fault(elmopp_keeper_t *self, const elmopp_controller_t *controller) {
    self->told.first = (uint8_t)controller->fault;
    self->told.second = controller->fault_group;
}

static bool is_busy(const elmopp_keeper_t *self) {
    return (self->told.state == ELMOPP_TRANSFER_RECEIVING) || (self->told.state == ELMOPP_TRANSFER_ON_TRIAL) ||
           (self->told.state == ELMOPP_TRANSFER_STORING);
}

/* --- whether one may come --- */

/* A person is there, and nobody is told to drive. */
static bool is_safe_for_site(const elmopp_controller_t *controller) {
    return controller->reset_held && (!elmopp_mode_is_steady(controller->mode));
}

static bool has_fault(const elmopp_controller_t *controller) {
    return controller->fault != ELMOPP_FAULT_NONE;
}

static bool is_by_hand(const elmopp_keeper_t *self, elmopp_transfer_kind_t kind) {
    return (kind == ELMOPP_TRANSFER_SITE) ? self->config.site_by_hand : self->config.weights_by_hand;
}

static elmopp_transfer_reason_t why_not_now(const elmopp_controller_t *controller, elmopp_transfer_kind_t kind) {
    elmopp_transfer_reason_t reason = ELMOPP_TRANSFER_NO_REASON;
    if (has_fault(controller)) {
        reason = ELMOPP_TRANSFER_FAULT;
    } else if ((kind == ELMOPP_TRANSFER_SITE) && (!is_safe_for_site(controller))) {
        reason = ELMOPP_TRANSFER_NOT_SAFE;
    } else if ((kind == ELMOPP_TRANSFER_WEIGHTS) &&
               (!elmopp_forecast_is_network(controller->pilot.forecast.config.kind))) {
        reason = ELMOPP_TRANSFER_NETWORK;
    } else {
        /* it may */
    }
    return reason;
}

static elmopp_transfer_reason_t why_not(const elmopp_keeper_t *self, const elmopp_controller_t *controller,
                                        elmopp_transfer_kind_t kind) {
    elmopp_transfer_reason_t reason = why_not_now(controller, kind);
    if (kind == ELMOPP_TRANSFER_NOTHING) {
        reason = ELMOPP_TRANSFER_LENGTH;
    } else if (is_by_hand(self, kind)) {
        reason = ELMOPP_TRANSFER_BY_HAND;
    } else if ((reason == ELMOPP_TRANSFER_NO_REASON) && (!elmopp_store_has_room(&self->store[store_of(kind)]))) {
        reason = ELMOPP_TRANSFER_FULL;
    } else {
        /* as it is */
    }
    return reason;
}

static void refuse_now(elmopp_keeper_t *self, const elmopp_controller_t *controller, elmopp_transfer_reason_t reason) {
    refuse(self, reason);
    if (reason == ELMOPP_TRANSFER_FAULT) {
        name_fault(self, controller);
    }
}

/* Looking for room takes a while: once a tick, however many would like to begin. */
static void take_first(elmopp_keeper_t *self, const elmopp_controller_t *controller, const elmopp_frame_t *frame) {
    if (is_busy(self) || self->news) {
        self->second = true;
        count_refused(self);
        return;
    }
    const elmopp_transfer_kind_t kind = kind_of_length(elmopp_transfer_announced(frame));
    const elmopp_transfer_reason_t reason = why_not(self, controller, kind);
    self->told.kind = kind;
    if (reason != ELMOPP_TRANSFER_NO_REASON) {
        refuse_now(self, controller, reason);
    } else {
        elmopp_transfer_begin(&self->transfer, frame, buffer_of(self));
        tell(self, ELMOPP_TRANSFER_RECEIVING, ELMOPP_TRANSFER_NO_REASON);
    }
}

bool elmopp_keeper_take(elmopp_keeper_t *self, const elmopp_controller_t *controller, const elmopp_frame_t *frame) {
    if (frame->id != ELMOPP_CAN_TRANSFER_FRAME_ID) {
        return false;
    }
    if (elmopp_transfer_announced(frame) != 0U) {
        take_first(self, controller, frame);
    } else {
        const elmopp_transfer_verdict_t verdict = elmopp_transfer_take(&self->transfer, frame);
        self->whole = self->whole || (verdict == ELMOPP_TRANSFER_WHOLE);
        if (verdict == ELMOPP_TRANSFER_BROKEN) {
            refuse(self, ELMOPP_TRANSFER_ORDER);
        } else if (verdict == ELMOPP_TRANSFER_STRANGE) {
            count_refused(self);
        } else {
            /* it goes on */
        }
    }
    return true;
}

/* --- what has come --- */

static elmopp_transfer_reason_t judge_envelope(elmopp_keeper_t *self) {
    static const elmopp_transfer_reason_t named[IMAGE_VERDICTS] = {[ELMOPP_IMAGE_OK] = ELMOPP_TRANSFER_NO_REASON,
                                                                   [ELMOPP_IMAGE_MAGIC] = ELMOPP_TRANSFER_MAGIC,
                                                                   [ELMOPP_IMAGE_VERSION] = ELMOPP_TRANSFER_VERSION,
                                                                   [ELMOPP_IMAGE_LENGTH] = ELMOPP_TRANSFER_LENGTH,
                                                                   [ELMOPP_IMAGE_CRC] = ELMOPP_TRANSFER_CHECKSUM};
    const elmopp_image_kind_t *kind = image_kind(self->told.kind);
    return named[elmopp_image_check(kind, buffer_of(self), whole_bytes(kind))];
}

static elmopp_keeper_change_t begin_trial(elmopp_keeper_t *self) {
    self->trial_ds = 0U;
    self->learned = false;
    tell(self, ELMOPP_TRANSFER_ON_TRIAL, ELMOPP_TRANSFER_NO_REASON);
    self->told.left_s = (uint16_t)(ELMOPP_KEEPER_TRIAL_DS / DS_PER_S);
    self->fault = ELMOPP_FAULT_NONE;
    return (self->told.kind == ELMOPP_TRANSFER_SITE) ? ELMOPP_KEEPER_BEGIN : ELMOPP_KEEPER_USE_WEIGHTS;
}

static elmopp_keeper_change_t judge_weights(elmopp_keeper_t *self, const elmopp_controller_t *controller) {
    const elmopp_weights_t *weights = weights_of(buffer_of(self));
    const elmopp_weights_fault_t fault = elmopp_weights_check(weights);
    if (fault != ELMOPP_WEIGHTS_OK) {
        refuse(self, ELMOPP_TRANSFER_CONTENT);
        self->told.first = (uint8_t)fault;
        return ELMOPP_KEEPER_GO_ON;
    }
    if (!elmopp_forecast_fits(controller->pilot.forecast.config.kind, weights)) {
        refuse(self, ELMOPP_TRANSFER_NETWORK);
        return ELMOPP_KEEPER_GO_ON;
    }
    self->weights_image = buffer_of(self);
    return begin_trial(self);
}

/* A site that is refused has not touched the one that runs. */
static elmopp_keeper_change_t judge_site(elmopp_keeper_t *self) {
    if (is_simulation(buffer_of(self))) {
        refuse(self, ELMOPP_TRANSFER_SIMULATION);
        return ELMOPP_KEEPER_GO_ON;
    }
    const elmopp_site_verdict_t verdict =
        elmopp_site_load(buffer_of(self), whole_bytes(elmopp_site_kind()), &self->site);
    if (verdict.fault != ELMOPP_SITE_OK) {
        refuse(self, ELMOPP_TRANSFER_CONTENT);
        self->told.first = (uint8_t)verdict.fault;
        self->told.second = verdict.first;
        return ELMOPP_KEEPER_GO_ON;
    }
    self->has_site = true;
    return begin_trial(self);
}

static elmopp_keeper_change_t judge_whole(elmopp_keeper_t *self, const elmopp_controller_t *controller) {
    const elmopp_transfer_reason_t now = why_not_now(controller, self->told.kind);
    const elmopp_transfer_reason_t reason = (now == ELMOPP_TRANSFER_NO_REASON) ? judge_envelope(self) : now;
    if (reason != ELMOPP_TRANSFER_NO_REASON) {
        refuse_now(self, controller, reason);
        return ELMOPP_KEEPER_GO_ON;
    }
    return (self->told.kind == ELMOPP_TRANSFER_SITE) ? judge_site(self) : judge_weights(self, controller);
}

/* --- the trial, and after it --- */

/* What ran before runs again. A fault stays latched, also through the new beginning that another site needs. */
static elmopp_keeper_change_t withdraw(elmopp_keeper_t *self, const elmopp_controller_t *controller,
                                       elmopp_transfer_reason_t reason) {
    tell(self, ELMOPP_TRANSFER_WITHDRAWN, reason);
    if (reason == ELMOPP_TRANSFER_FAULT) {
        name_fault(self, controller);
    }
    if (self->told.kind == ELMOPP_TRANSFER_SITE) {
        self->fault = controller->fault;
        use_stored_site(self);
        return ELMOPP_KEEPER_BEGIN;
    }
    use_stored_weights(self);
    return ELMOPP_KEEPER_USE_WEIGHTS;
}

static bool begin_storing(elmopp_keeper_t *self) {
    elmopp_store_t *store = &self->store[store_of(self->told.kind)];
    self->failed = store->failed;
    if (!elmopp_store_save(store, buffer_of(self))) {
        return false;
    }
    tell(self, ELMOPP_TRANSFER_STORING, ELMOPP_TRANSFER_NO_REASON);
    return true;
}

static bool is_no_better(const elmopp_keeper_t *self, const elmopp_controller_t *controller) {
    return (self->told.kind == ELMOPP_TRANSFER_WEIGHTS) && (controller->pilot.foresight == ELMOPP_FORESIGHT_DISTRUSTED);
}

static elmopp_keeper_change_t go_on_trying(elmopp_keeper_t *self, const elmopp_controller_t *controller) {
    elmopp_keeper_change_t change = ELMOPP_KEEPER_GO_ON;
    self->trial_ds = elmopp_mode_is_steady(controller->mode) ? (uint16_t)(self->trial_ds + 1U) : self->trial_ds;
    const uint32_t left_ds = ELMOPP_KEEPER_TRIAL_DS - self->trial_ds;
    self->told.left_s = (uint16_t)((left_ds + (DS_PER_S - 1U)) / DS_PER_S);
    if (has_fault(controller)) {
        change = withdraw(self, controller, ELMOPP_TRANSFER_FAULT);
    } else if ((left_ds == 0U) && is_no_better(self, controller)) {
        change = withdraw(self, controller, ELMOPP_TRANSFER_DISTRUSTED);
    } else if ((left_ds == 0U) && (!begin_storing(self))) {
        change = withdraw(self, controller, ELMOPP_TRANSFER_FULL);
    } else {
        /* not yet */
    }
    return change;
}

/* What stands in the store now is what was in the buffer, so that this is free again. */
static elmopp_keeper_change_t keep_it(elmopp_keeper_t *self) {
    elmopp_keeper_change_t change = ELMOPP_KEEPER_GO_ON;
    self->saved = (self->saved < UINT16_MAX) ? (uint16_t)(self->saved + 1U) : self->saved;
    self->told.saved = (uint8_t)(self->saved & UINT8_MAX);
    tell(self, ELMOPP_TRANSFER_KEPT, ELMOPP_TRANSFER_NO_REASON);
    if (self->told.kind == ELMOPP_TRANSFER_WEIGHTS) {
        use_stored_weights(self);
        change = self->learned ? ELMOPP_KEEPER_GO_ON : ELMOPP_KEEPER_USE_WEIGHTS;
    }
    return change;
}

static elmopp_keeper_change_t go_on_storing(elmopp_keeper_t *self, const elmopp_controller_t *controller) {
    const elmopp_store_t *store = &self->store[store_of(self->told.kind)];
    elmopp_keeper_change_t change = ELMOPP_KEEPER_GO_ON;
    if (store->phase != ELMOPP_STORE_IDLE) {
        change = ELMOPP_KEEPER_GO_ON;
    } else if (store->failed == self->failed) {
        change = keep_it(self);
    } else if (self->learned) {
        refuse(self, ELMOPP_TRANSFER_MEDIUM);
    } else {
        change = withdraw(self, controller, ELMOPP_TRANSFER_MEDIUM);
    }
    return change;
}

/* What is quickly said comes first: a learner may ask in every tick. */
static elmopp_transfer_reason_t why_not_save(const elmopp_keeper_t *self, const elmopp_controller_t *controller,
                                             const elmopp_weights_t *weights) {
    elmopp_transfer_reason_t reason = ELMOPP_TRANSFER_NO_REASON;
    if (is_busy(self)) {
        reason = ELMOPP_TRANSFER_BUSY;
    } else if ((self->quiet_ds / DS_PER_S) < self->config.save_min_s) {
        reason = ELMOPP_TRANSFER_TOO_SOON;
    } else if (elmopp_weights_check(weights) != ELMOPP_WEIGHTS_OK) {
        reason = ELMOPP_TRANSFER_CONTENT;
    } else if (!elmopp_forecast_fits(controller->pilot.forecast.config.kind, weights)) {
        reason = ELMOPP_TRANSFER_NETWORK;
    } else {
        reason = why_not(self, controller, ELMOPP_TRANSFER_WEIGHTS);
    }
    return reason;
}

elmopp_transfer_reason_t elmopp_keeper_save(elmopp_keeper_t *self, const elmopp_controller_t *controller,
                                            const elmopp_weights_t *weights) {
    const elmopp_transfer_reason_t reason = why_not_save(self, controller, weights);
    if (reason == ELMOPP_TRANSFER_NO_REASON) {
        if (weights != weights_of(buffer_of(self))) {
            (void)memcpy(&buffer_of(self)[ELMOPP_IMAGE_HEADER], (const uint8_t *)weights, sizeof *weights);
        }
        elmopp_image_seal(elmopp_weights_kind(), buffer_of(self));
        self->told.kind = ELMOPP_TRANSFER_WEIGHTS;
        self->learned = true;
        self->quiet_ds = 0U;
        const bool begun = begin_storing(self);
        ELMOPP_ASSERT(begun);
    }
    return reason;
}

/* --- what is learnt here --- */

/* Null: nobody learns, or it is not worth it, or not now. */
static const elmopp_learner_t *worth_keeping(const elmopp_controller_t *controller) {
    const elmopp_pilot_t *pilot = &controller->pilot;
    const elmopp_learner_t *learner = pilot->forecast.config.learner;
    const bool worth = (learner != NULL) && (pilot->foresight == ELMOPP_FORESIGHT_OWN) && (!has_fault(controller)) &&
                       elmopp_learner_is_worth_keeping(learner);
    return worth ? learner : NULL;
}

/* Whether learning may have a slot now. */
static bool may_save(const elmopp_keeper_t *self) {
    const elmopp_store_medium_t *medium = &self->store[WEIGHTS].medium;
    const uint32_t slots = medium->erases_any_time ? UINT32_MAX : (medium->sector_slots - 1U);
    const bool later = (self->lessons > 0U) && (!medium->erases_any_time);
    const uint32_t quiet_s = self->quiet_ds / DS_PER_S;
    const uint32_t least_s = later ? (ELMOPP_KEEPER_LATER * self->config.save_min_s) : self->config.save_min_s;
    return (medium->bytes != NULL) && (!is_busy(self)) && (!self->config.weights_by_hand) && (self->lessons < slots) &&
           (quiet_s >= least_s);
}

/* What is learnt is put together in the buffer: the weights that learning began with, and what it made of them. */
static void save_lesson(elmopp_keeper_t *self, const elmopp_controller_t *controller) {
    const elmopp_learner_t *learner = worth_keeping(controller);
    if ((learner != NULL) && may_save(self)) {
        void *body = &buffer_of(self)[ELMOPP_IMAGE_HEADER];
        elmopp_weights_t *draft = (elmopp_weights_t *)body;
        *draft = *learner->shipped;
        elmopp_learner_copy(learner, &draft->lstm);
        if (elmopp_keeper_save(self, controller, draft) == ELMOPP_TRANSFER_NO_REASON) {
            self->lessons = (self->lessons < UINT16_MAX) ? (uint16_t)(self->lessons + 1U) : self->lessons;
        }
    }
}

/* --- orders --- */

bool elmopp_keeper_next(const elmopp_keeper_t *self, elmopp_transfer_kind_t *kind, elmopp_store_order_t *order) {
    *kind = ELMOPP_TRANSFER_WEIGHTS;
    if (elmopp_store_next(&self->store[WEIGHTS], order)) {
        return true;
    }
    *kind = ELMOPP_TRANSFER_SITE;
    return elmopp_store_next(&self->store[SITE], order);
}

void elmopp_keeper_answer(elmopp_keeper_t *self, elmopp_transfer_kind_t kind, elmopp_store_answer_t answer) {
    elmopp_store_answer(&self->store[store_of(kind)], answer);
}

/* --- a tick --- */

/* Whoever wants to send beside another is told first: what follows is not meant for him. */
static uint32_t report(elmopp_keeper_t *self, elmopp_frame_t out[ELMOPP_KEEPER_FRAMES]) {
    uint32_t count = 0U;
    if (self->second) {
        const elmopp_transfer_report_t busy = {
            .kind = self->told.kind, .state = ELMOPP_TRANSFER_REFUSED, .reason = ELMOPP_TRANSFER_BUSY};
        out[count] = elmopp_transfer_make_report(&busy);
        count++;
        self->second = false;
    }
    if (self->news || (is_busy(self) && (self->told_ds >= DS_PER_S))) {
        out[count] = elmopp_transfer_make_report(&self->told);
        count++;
        self->news = false;
        self->told_ds = 0U;
    }
    if (elmopp_transfer_flow(&self->transfer, &out[count])) {
        count++;
    }
    return count;
}

static void let_pass(elmopp_keeper_t *self) {
    self->quiet_ds = (self->quiet_ds < UINT32_MAX) ? (self->quiet_ds + 1U) : self->quiet_ds;
    self->told_ds = (self->told_ds < UINT16_MAX) ? (uint16_t)(self->told_ds + 1U) : self->told_ds;
    if (!elmopp_transfer_tick(&self->transfer)) {
        refuse(self, ELMOPP_TRANSFER_SILENCE);
    }
}

elmopp_keeper_change_t elmopp_keeper_tick(elmopp_keeper_t *self, elmopp_controller_t *controller,
                                          elmopp_frame_t out[ELMOPP_KEEPER_FRAMES], uint32_t *count) {
    elmopp_keeper_change_t change = ELMOPP_KEEPER_GO_ON;
    let_pass(self);
    if (self->whole) {
        self->whole = false;
        change = judge_whole(self, controller);
    } else if (self->told.state == ELMOPP_TRANSFER_ON_TRIAL) {
        change = go_on_trying(self, controller);
    } else if (self->told.state == ELMOPP_TRANSFER_STORING) {
        change = go_on_storing(self, controller);
    } else if (controller->second_ds == ELMOPP_KEEPER_SAVE_DS) {
        save_lesson(self, controller);
    } else {
        /* nothing is under way, or segments are yet to come */
    }
    *count = report(self, out);
    elmopp_controller_refuse(controller, self->refused);
    self->refused = 0U;
    return change;
}
