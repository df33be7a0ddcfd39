/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/urgency.h"

#include "elmopp/age.h"
#include "elmopp/assert.h"
#include "elmopp/elementary.h"

#define DS_PER_S 10.0F

static float age_factor(const elmopp_urgency_t *self, uint16_t red_ds) {
    const float span_ds = DS_PER_S * (float)self->options.max_s;
    return self->options.printed_sign ? elmopp_exp(1.0F - ((float)red_ds / span_ds))
                                      : elmopp_age_factor(red_ds, self->options.max_s);
}

/* k_t = 2 (1/t_max - t/t_max^2): 0 at t_max; the sum over t is 1 + 1/t_max and is not renormalised (docs/algorithm.md).
 */
static float kernel(float t_s, float max_s) {
    return (2.0F * (max_s - t_s)) / (max_s * max_s);
}

static void fill_weights(elmopp_urgency_t *self) {
    const float max_s = (float)self->options.max_s;
    const float direction = self->options.printed_sign ? -1.0F : 1.0F;
    for (uint32_t t = 0U; t <= self->options.max_s; t++) {
        const float t_s = (float)t;
        const float growth = self->options.constant_age ? 1.0F : elmopp_exp((direction * t_s) / max_s);
        self->weight_green[t] = kernel(t_s, max_s);
        self->weight_red[t] = self->weight_green[t] * growth;
    }
}

float elmopp_urgency_naive(const elmopp_urgency_t *self, float load, uint16_t red_ds) {
    return load * age_factor(self, red_ds);
}

float elmopp_urgency_cumulative(const elmopp_urgency_t *self, const elmopp_urgency_lane_t *lane) {
    if (!(lane->capacity_veh > 0.0F)) {
        return 0.0F;
    }
    const float *weight = lane->going ? self->weight_green : self->weight_red;
    float inflow_veh = 0.0F;
    float sum = 0.0F;
    for (uint32_t t = 0U; t < self->options.max_s; t++) {
        if ((t > 0U) && (t <= lane->steps)) {
            inflow_veh += lane->share * lane->foreseen_veh[t - 1U];
        }
        const float then_veh = lane->queue_veh + inflow_veh;
        const float load = ((then_veh < lane->capacity_veh) ? then_veh : lane->capacity_veh) / lane->capacity_veh;
        sum += weight[t] * load;
    }
    return sum * age_factor(self, lane->red_ds);
}

static float movement_urgency(const elmopp_urgency_t *self, const elmopp_view_t *view, uint32_t movement,
                              uint16_t red_ds, bool going) {
    const float queue_veh = view->queue_veh[movement];
    if (!self->options.cumulative) {
        return elmopp_urgency_naive(self, elmopp_junction_load(view->junction, movement, queue_veh), red_ds);
    }
    const elmopp_movement_t *site = &view->junction->movement[movement];
    const float *row_veh = view->foreseen_veh[site->approach];
    const elmopp_urgency_lane_t lane = {.queue_veh = queue_veh,
                                        .capacity_veh = site->capacity_veh,
                                        .foreseen_veh = row_veh,
                                        .steps = (row_veh != NULL) ? view->foreseen_steps : 0U,
                                        .share = view->share[movement],
                                        .red_ds = red_ds,
                                        .going = going};
    return elmopp_urgency_cumulative(self, &lane);
}

static uint16_t stage_age_ds(const elmopp_urgency_t *self, uint32_t stage) {
    const uint32_t age_ds = 10U * (uint32_t)self->stage_age_s[stage];
    return (uint16_t)((age_ds < UINT16_MAX) ? age_ds : UINT16_MAX);
}

/* T of a movement is the same in every stage that serves it, so its urgency is worked out once a second. */
static void score_by_movement(const elmopp_urgency_t *self, const elmopp_view_t *view, float score[ELMOPP_STAGE_MAX]) {
    float urgency[ELMOPP_MOVEMENT_MAX];
    for (uint32_t j = 0U; j < view->junction->movement_count; j++) {
        const bool going = elmopp_mask_has(view->going, j);
        urgency[j] = movement_urgency(self, view, j, view->red_ds[j], going);
    }
    for (uint32_t s = 0U; s < view->junction->stage_count; s++) {
        const uint16_t groups = view->junction->stage_groups[s];
        for (uint32_t j = 0U; j < view->junction->movement_count; j++) {
            score[s] += elmopp_junction_goes(view->junction, j, groups) ? urgency[j] : 0.0F;
        }
    }
}

static void score_by_stage(const elmopp_urgency_t *self, const elmopp_view_t *view, float score[ELMOPP_STAGE_MAX]) {
    for (uint32_t s = 0U; s < view->junction->stage_count; s++) {
        const uint16_t groups = view->junction->stage_groups[s];
        for (uint32_t j = 0U; j < view->junction->movement_count; j++) {
            if (elmopp_junction_goes(view->junction, j, groups)) {
                score[s] += movement_urgency(self, view, j, stage_age_ds(self, s), s == view->stage);
            }
        }
    }
}

/* Highest score, the lowest index among equals; `excluded` may be ELMOPP_STAGE_NONE. */
static elmopp_stage_t best_stage(const elmopp_view_t *view, const float score[ELMOPP_STAGE_MAX],
                                 elmopp_stage_t excluded) {
    elmopp_stage_t best = ELMOPP_STAGE_NONE;
    for (uint32_t s = 0U; s < view->junction->stage_count; s++) {
        if ((s != excluded) && ((best == ELMOPP_STAGE_NONE) || (score[s] > score[best]))) {
            best = (elmopp_stage_t)s;
        }
    }
    return best;
}

static elmopp_stage_t hold_or_leave(const elmopp_urgency_t *self, const elmopp_view_t *view,
                                    const float score[ELMOPP_STAGE_MAX]) {
    const uint32_t elapsed_s = (uint32_t)view->elapsed_ds / ELMOPP_LAMP_TICKS_PER_S;
    const elmopp_stage_t other = best_stage(view, score, view->stage);
    if ((other == ELMOPP_STAGE_NONE) || (elapsed_s < self->options.min_s)) {
        return view->stage;
    }
    const float own = self->options.frozen ? self->chosen_score : score[view->stage];
    const bool leave = (elapsed_s >= self->options.max_s) || (score[other] > (self->options.hysteresis * own));
    return leave ? other : view->stage;
}

/* Algorithm 1: do not switch while the active stage's urgency equals the highest. */
static elmopp_stage_t leader(const elmopp_view_t *view, const float score[ELMOPP_STAGE_MAX]) {
    const elmopp_stage_t best = best_stage(view, score, ELMOPP_STAGE_NONE);
    return (score[best] > score[view->stage]) ? best : view->stage;
}

static void age_stages(elmopp_urgency_t *self, const elmopp_view_t *view, elmopp_stage_t active) {
    for (uint32_t s = 0U; s < view->junction->stage_count; s++) {
        if (s == active) {
            self->stage_age_s[s] = 0U;
        } else if (self->stage_age_s[s] < UINT16_MAX) {
            self->stage_age_s[s]++;
        } else {
            /* saturated */
        }
    }
}

static elmopp_stage_t decide(const elmopp_urgency_t *self, const elmopp_view_t *view,
                             const float score[ELMOPP_STAGE_MAX]) {
    elmopp_stage_t wanted;
    if ((view->stage == ELMOPP_STAGE_NONE) && (view->target != ELMOPP_STAGE_NONE)) {
        wanted = view->target; /* in the intergreen: the plan has committed itself */
    } else if (view->stage == ELMOPP_STAGE_NONE) {
        wanted = best_stage(view, score, ELMOPP_STAGE_NONE);
    } else if (self->options.windowless) {
        wanted = leader(view, score);
    } else {
        wanted = hold_or_leave(self, view, score);
    }
    return wanted;
}

static void remember_choice(elmopp_urgency_t *self, elmopp_stage_t stage, const float score[ELMOPP_STAGE_MAX]) {
    if ((stage != ELMOPP_STAGE_NONE) && (stage != self->chosen)) {
        self->chosen = stage;
        self->chosen_score = score[stage];
    }
}

static elmopp_stage_t choose_by_urgency(void *state, const elmopp_view_t *view, float score[ELMOPP_STAGE_MAX]) {
    elmopp_urgency_t *self = state;
    for (uint32_t s = 0U; s < ELMOPP_STAGE_MAX; s++) {
        score[s] = 0.0F;
    }
    if (self->options.stage_age) {
        score_by_stage(self, view, score);
    } else {
        score_by_movement(self, view, score);
    }
    remember_choice(self, view->stage, score); /* a maximum green may have brought it up */
    const elmopp_stage_t wanted = decide(self, view, score);
    remember_choice(self, wanted, score);
    age_stages(self, view, wanted);
    return wanted;
}

elmopp_chooser_t elmopp_urgency_init(elmopp_urgency_t *self, const elmopp_urgency_options_t *options) {
    ELMOPP_ASSERT((options->min_s >= 1U) && (options->min_s <= options->max_s));
    ELMOPP_ASSERT((options->max_s <= ELMOPP_HORIZON_MAX) && (options->hysteresis >= 1.0F));
    self->options = *options;
    self->chosen = ELMOPP_STAGE_NONE;
    self->chosen_score = 0.0F;
    for (uint32_t t = 0U; t <= ELMOPP_HORIZON_MAX; t++) {
        self->weight_red[t] = 0.0F;
        self->weight_green[t] = 0.0F;
    }
    fill_weights(self);
    for (uint32_t s = 0U; s < ELMOPP_STAGE_MAX; s++) {
        self->stage_age_s[s] = 0U;
    }
    /* The kernel is 0 at t_max, so the last second of the window needs no forecast. */
    const uint16_t horizon_s = options->cumulative ? (uint16_t)(options->max_s - 1U) : 0U;
    return (elmopp_chooser_t){.choose = choose_by_urgency, .state = self, .horizon_s = horizon_s};
}
