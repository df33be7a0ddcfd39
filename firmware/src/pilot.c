/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/pilot.h"

#include "elmopp/assert.h"
#include "elmopp/site.h"

#include <stddef.h>

#define COUNT_MAX_VEH 1.0e6F
#define SOON_S 10U
#define LATER_S 30U
#define ALL_MOVEMENTS (((uint32_t)1U << ELMOPP_MOVEMENT_MAX) - 1U)

void elmopp_pilot_init(elmopp_pilot_t *self, const elmopp_junction_t *junction, const elmopp_chooser_t *chooser,
                       const elmopp_forecast_config_t *forecast) {
    ELMOPP_ASSERT(elmopp_site_check_counts(junction).fault == ELMOPP_SITE_OK);
    ELMOPP_ASSERT((chooser->choose != NULL) && (chooser->horizon_s <= ELMOPP_HORIZON_MAX));
    *self = (elmopp_pilot_t){.junction = junction, .chooser = *chooser, .wanted = ELMOPP_STAGE_NONE};
    elmopp_forecast_init(&self->forecast, junction, forecast);
    elmopp_plan_init(&self->plan, junction);
}

void elmopp_pilot_restart(elmopp_pilot_t *self) {
    elmopp_plan_init(&self->plan, self->junction);
    self->going = 0U;
    self->waiting = 0U;
    self->begun = false;
    self->wanted = ELMOPP_STAGE_NONE;
    for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
        self->red_ds[j] = 0U;
    }
}

void elmopp_pilot_absorb(elmopp_pilot_t *self, const float *arrived_veh) {
    elmopp_forecast_observe(&self->forecast, arrived_veh);
    elmopp_forecast_learn(&self->forecast);
}

/* False for a NaN too. */
bool elmopp_pilot_is_count(float value_veh) {
    return (value_veh >= 0.0F) && (value_veh <= COUNT_MAX_VEH);
}

static bool are_counts(const elmopp_pilot_t *self, const elmopp_counts_t *counts) {
    bool good = true;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        good = good && elmopp_pilot_is_count(counts->present_veh[j]) && elmopp_pilot_is_count(counts->arrived_veh[j]);
    }
    return good;
}

static uint32_t waiting_movements(const elmopp_pilot_t *self, const elmopp_counts_t *counts) {
    uint32_t waiting = 0U;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const bool somebody = elmopp_mask_has(counts->recall, j) || (counts->present_veh[j] >= ELMOPP_PILOT_DEMAND_VEH);
        if (somebody && (!elmopp_mask_has(self->going, j))) {
            waiting |= (uint32_t)1U << j;
        }
    }
    return waiting;
}

/* Only a network can go astray on traffic that it was not made for; what it gives way to is the mean. */
static bool is_distrusted(const elmopp_forecast_t *forecast) {
    const elmopp_account_error_t error = elmopp_forecast_error(forecast);
    return elmopp_forecast_is_network(forecast->config.kind) && (error.forecast > error.mean) &&
           (error.compared_s >= ELMOPP_PILOT_ACCOUNT_MIN_S);
}

/* As far as the chooser looks, and as the forecast's account and the next half a minute ask. */
static uint16_t asked_steps(const elmopp_pilot_t *self) {
    const uint16_t asked_s = self->chooser.horizon_s;
    return (asked_s > LATER_S) ? asked_s : (uint16_t)LATER_S;
}

/* The forecast's own rows. Also when they are not used: the account has to go on. */
static void look_for_itself(elmopp_pilot_t *self, elmopp_view_t *view) {
    const uint16_t steps = asked_steps(self);
    view->foreseen_steps = elmopp_forecast_look(&self->forecast, steps, view->foreseen_veh);
    const elmopp_forecast_status_t status = elmopp_forecast_status(&self->forecast);
    self->foresight = ELMOPP_FORESIGHT_OWN;
    if (status == ELMOPP_FORECAST_UNARMED) {
        self->foresight = ELMOPP_FORESIGHT_UNARMED;
    } else if (status == ELMOPP_FORECAST_COLD) {
        self->foresight = ELMOPP_FORESIGHT_COLD;
    } else if (is_distrusted(&self->forecast)) {
        self->foresight = ELMOPP_FORESIGHT_DISTRUSTED;
        view->foreseen_steps = elmopp_forecast_fall_back(&self->forecast, steps, view->foreseen_veh);
    } else {
        /* as asked */
    }
}

static float sum_of_first(const elmopp_view_t *view, uint32_t approach, uint32_t steps) {
    float sum_veh = 0.0F;
    const float *row_veh = view->foreseen_veh[approach];
    const uint32_t known = (row_veh != NULL) ? view->foreseen_steps : 0U;
    for (uint32_t t = 0U; (t < known) && (t < steps); t++) {
        sum_veh += row_veh[t];
    }
    return sum_veh;
}

static void hear_neighbours(elmopp_pilot_t *self, const elmopp_outflow_t *outflow) {
    self->is_heard = outflow != NULL;
    for (uint32_t i = 0U; self->is_heard && (i < ELMOPP_APPROACH_MAX); i++) {
        self->outflow[i] = outflow[i];
    }
}

static void look_ahead(elmopp_pilot_t *self, const elmopp_foreseen_t *foreseen, elmopp_view_t *view) {
    const uint16_t asked = asked_steps(self);
    self->looks_on = (foreseen == NULL) && (asked < ELMOPP_PILOT_TRACE_S);
    if (foreseen != NULL) {
        ELMOPP_ASSERT(foreseen->steps <= ELMOPP_HORIZON_MAX);
        self->foresight = ELMOPP_FORESIGHT_GIVEN;
        view->foreseen_steps = foreseen->steps;
        for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
            view->foreseen_veh[i] = foreseen->row_veh[i];
        }
    } else {
        look_for_itself(self, view);
    }
    if (self->is_heard) {
        view->foreseen_steps =
            elmopp_forecast_hear(&self->forecast, self->outflow, asked, view->foreseen_steps, view->foreseen_veh);
    }
    const uint16_t steps = view->foreseen_steps;
    self->foreseen_s = (steps < ELMOPP_PILOT_TRACE_S) ? steps : (uint16_t)ELMOPP_PILOT_TRACE_S;
    for (uint32_t i = 0U; i < self->junction->approach_count; i++) {
        self->soon_veh[0][i] = sum_of_first(view, i, SOON_S);
        self->soon_veh[1][i] = sum_of_first(view, i, LATER_S);
        self->foreseen_sum_veh[i] = sum_of_first(view, i, ELMOPP_PILOT_TRACE_S);
    }
}

/* In the order in which a step does it, on rows whose beginning has been summed up. */
void elmopp_pilot_look_on(elmopp_pilot_t *self) {
    if (!self->looks_on) {
        return;
    }
    const uint16_t minute = (uint16_t)ELMOPP_PILOT_TRACE_S;
    const float *row_veh[ELMOPP_APPROACH_MAX];
    uint16_t steps = elmopp_forecast_look_on(&self->forecast, minute, row_veh);
    if (self->foresight == ELMOPP_FORESIGHT_DISTRUSTED) {
        steps = elmopp_forecast_fall_back(&self->forecast, minute, row_veh);
    }
    if (self->is_heard) {
        steps = elmopp_forecast_hear(&self->forecast, self->outflow, minute, steps, row_veh);
    }
    for (uint32_t i = 0U; i < self->junction->approach_count; i++) {
        for (uint32_t t = self->foreseen_s; (row_veh[i] != NULL) && (t < steps); t++) {
            self->foreseen_sum_veh[i] += row_veh[i][t];
        }
    }
    self->foreseen_s = steps;
    self->looks_on = false;
}

void elmopp_pilot_step_blind(elmopp_pilot_t *self) {
    self->waiting = ALL_MOVEMENTS & ~self->going;
}

bool elmopp_pilot_step(elmopp_pilot_t *self, const elmopp_counts_t *counts, const elmopp_foreseen_t *foreseen) {
    self->looks_on = false;
    if (!are_counts(self, counts)) {
        elmopp_pilot_step_blind(self);
        return false;
    }
    elmopp_forecast_observe(&self->forecast, counts->arrived_veh);
    self->to_learn = true;
    self->since_ds = 0U;
    self->waiting = waiting_movements(self, counts);
    elmopp_view_t view = {.junction = self->junction,
                          .queue_veh = counts->present_veh,
                          .arrivals_veh = counts->arrived_veh,
                          .share = elmopp_forecast_share(&self->forecast),
                          .red_ds = self->red_ds,
                          .going = self->going,
                          .elapsed_ds = self->plan.elapsed_ds,
                          .stage = self->plan.stage,
                          .target = self->plan.target};
    hear_neighbours(self, counts->outflow);
    look_ahead(self, foreseen, &view);
    const elmopp_stage_t answer = self->chooser.choose(self->chooser.state, &view, self->score);
    const bool exists = answer < self->junction->stage_count;
    /* In an intergreen the plan has committed itself; an answer kept for later would be a second old when it counts. */
    self->wanted = (exists && self->plan.settled) ? answer : self->plan.target;
    return true;
}

void elmopp_pilot_learn(elmopp_pilot_t *self) {
    if (self->to_learn) {
        self->to_learn = false;
        elmopp_forecast_learn(&self->forecast);
    }
}

static void learn_in_time(elmopp_pilot_t *self) {
    self->since_ds = (self->since_ds < UINT8_MAX) ? (uint8_t)(self->since_ds + 1U) : self->since_ds;
    if (self->since_ds == ELMOPP_PILOT_LEARN_DS) {
        elmopp_pilot_learn(self);
    }
}

elmopp_lamps_t elmopp_pilot_lamp_tick(elmopp_pilot_t *self, elmopp_stage_t wanted, bool occupied) {
    learn_in_time(self);
    const elmopp_lamps_t lamps = elmopp_plan_step(&self->plan, wanted, self->waiting, occupied);
    if (self->plan.forced) {
        self->wanted = self->plan.target; /* the wish is older than the force */
    }
    self->going = elmopp_junction_served(self->junction, lamps.green);
    self->begun = self->begun || (self->plan.target != ELMOPP_STAGE_NONE);
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        if (elmopp_mask_has(self->going, j)) {
            self->red_ds[j] = 0U;
        } else if (self->begun && (self->red_ds[j] < UINT16_MAX)) {
            self->red_ds[j]++;
        } else {
            /* saturated, or nothing has been decided yet */
        }
    }
    return lamps;
}
