/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/coming.h"

#include "elmopp/assert.h"
#include "elmopp/elementary.h"

#define ROW_MAX_VEH 1.0e6F                                               /* more in a second is no forecast */
#define SKILL_MIN_S 60U                                                  /* compared for so long before skill counts */
#define NEAR_ROWS ((ELMOPP_COMING_NEAR_S + ELMOPP_ACCOUNT_PROBE_S) / 2U) /* have the skill of the nearer account */

static bool is_share(float value) {
    return (value >= 0.0F) && (value <= 1.0F);
}

void elmopp_coming_init(elmopp_coming_t *self, const elmopp_coming_options_t *options) {
    ELMOPP_ASSERT(options->fade_s >= 1U);
    ELMOPP_ASSERT((options->horizon_s >= 1U) && (options->horizon_s <= ELMOPP_HORIZON_MAX));
    ELMOPP_ASSERT(is_share(options->row_weight) && is_share(options->mean_weight));
    *self = (elmopp_coming_t){.options = *options};
}

/* Whether there is a row: of an approach of which nothing is foreseen the mean is all that is known. */
static bool has_row(const elmopp_view_t *view, uint32_t approach) {
    return view->foreseen_veh[approach] != NULL;
}

/* What a row says of a step: never less than nobody, and a NaN is nobody. */
static float said_veh(const elmopp_view_t *view, uint32_t approach, uint32_t row) {
    const float veh = view->foreseen_veh[approach][row];
    return (veh > 0.0F) ? elmopp_lesser(veh, ROW_MAX_VEH) : 0.0F;
}

/* Who came in this second and who comes in the mean, [approach]. */
typedef struct {
    float came_veh[ELMOPP_APPROACH_MAX];
    float mean_veh[ELMOPP_APPROACH_MAX];
} arrivals_t;

static void add_up(const elmopp_sight_t *sight, const elmopp_view_t *view, arrivals_t *arrivals) {
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        arrivals->came_veh[i] = 0.0F;
        arrivals->mean_veh[i] = 0.0F;
    }
    for (uint32_t j = 0U; j < view->junction->movement_count; j++) {
        const uint32_t approach = view->junction->movement[j].approach;
        arrivals->came_veh[approach] += view->arrivals_veh[j];
        arrivals->mean_veh[approach] += sight->mean_veh_per_s[j];
    }
}

/* Compares what rows said of this second with who came, and enters what they say now of `ahead_s` later. */
static void settle(elmopp_account_t *account, uint32_t ahead_s, const elmopp_view_t *view, const arrivals_t *arrivals) {
    const uint32_t approaches = view->junction->approach_count;
    elmopp_account_settle(account, arrivals->came_veh, approaches);
    if (view->foreseen_steps >= ahead_s) {
        elmopp_account_probe_t *page = elmopp_account_page(account, ahead_s);
        for (uint32_t i = 0U; i < approaches; i++) {
            page->forecast_veh[i] = has_row(view, i) ? said_veh(view, i, ahead_s - 1U) : arrivals->mean_veh[i];
            page->persistence_veh[i] = arrivals->came_veh[i];
            page->mean_veh[i] = arrivals->mean_veh[i];
        }
        page->said = true;
    }
}

/* How much of what the mean misses the rows have said lately: 0 nothing, 1 all. */
static float skill_of(const elmopp_account_error_t *error) {
    const bool better = (error->compared_s >= SKILL_MIN_S) && (error->forecast < error->mean);
    return better ? (1.0F - (error->forecast / error->mean)) : 0.0F;
}

void elmopp_coming_observe(elmopp_coming_t *self, const elmopp_sight_t *sight, const elmopp_view_t *view) {
    self->near_weight = self->options.row_weight;
    self->far_weight = self->options.row_weight;
    if (self->options.weigh_skill) {
        arrivals_t arrivals;
        add_up(sight, view, &arrivals);
        settle(&self->near, ELMOPP_COMING_NEAR_S, view, &arrivals);
        settle(&self->far, ELMOPP_ACCOUNT_PROBE_S, view, &arrivals);
        self->near_weight = skill_of(&self->near.error);
        self->far_weight = skill_of(&self->far.error);
    }
}

/* What is left of a row's skill so much later; a fixed weight does not fade. */
static float fade_of(const elmopp_coming_t *self, uint32_t row) {
    const float left = 1.0F - ((float)row / (float)self->options.fade_s);
    return self->options.weigh_skill ? elmopp_greater(left, 0.0F) : 1.0F;
}

/* Who reaches the edge of the reach in a later second: the mean, corrected by a row as far as it is believed. */
static float foreseen(const elmopp_coming_t *self, const elmopp_view_t *view, uint32_t movement, uint32_t row) {
    const float expected_veh = self->expected_veh_per_s[movement];
    const uint32_t approach = view->junction->movement[movement].approach;
    if (!has_row(view, approach)) {
        return expected_veh;
    }
    const float said = view->share[movement] * said_veh(view, approach, row);
    const float base_veh = self->options.weigh_skill ? expected_veh : 0.0F;
    const float weight = (row < NEAR_ROWS) ? self->near_weight : self->far_weight;
    return base_veh + (weight * fade_of(self, row) * (said - base_veh));
}

/* Who is hidden behind a full reach and comes in a second in which so many come anyway. */
static float shown_veh(const elmopp_sight_t *sight, uint32_t movement, float came_veh, float hidden_veh) {
    return elmopp_lesser(elmopp_greater(sight->site_veh_per_s[movement] - came_veh, 0.0F), hidden_veh);
}

static void sum_arrivals(elmopp_coming_t *self, const elmopp_sight_t *sight, const elmopp_view_t *view,
                         uint32_t movement) {
    const uint32_t horizon_s = self->options.horizon_s;
    const uint32_t travel_s = sight->options.travel_s[movement];
    const uint32_t rows_s = (view->foreseen_steps < self->options.rows_s) ? view->foreseen_steps : self->options.rows_s;
    const float expected_veh = self->options.mean_weight * sight->mean_veh_per_s[movement];
    float *arrived_veh = self->arrived_veh[movement];
    float hidden_veh = sight->hidden_veh[movement];
    float sum_veh = sight->queued_veh[movement];
    self->expected_veh_per_s[movement] = expected_veh;
    arrived_veh[0] = sum_veh;
    for (uint32_t k = 0U; (k < travel_s) && (k < horizon_s); k++) {
        sum_veh += sight->due_veh[movement][k];
        arrived_veh[k + 1U] = sum_veh;
    }
    uint32_t k = travel_s;
    const uint32_t rows_end = travel_s + rows_s;
    bool is_even = (k >= rows_end) && (hidden_veh <= 0.0F);
    while ((k < horizon_s) && (!is_even)) {
        const float came_veh = (k < rows_end) ? foreseen(self, view, movement, k - travel_s) : expected_veh;
        const float late_veh = shown_veh(sight, movement, came_veh, hidden_veh);
        hidden_veh -= late_veh;
        sum_veh += came_veh + late_veh;
        k++;
        arrived_veh[k] = sum_veh;
        is_even = (k >= rows_end) && (hidden_veh <= 0.0F);
    }
    self->even_step = (k > self->even_step) ? k : self->even_step;
    for (; k < horizon_s; k++) {
        sum_veh += expected_veh;
        arrived_veh[k + 1U] = sum_veh;
    }
}

void elmopp_coming_expect(elmopp_coming_t *self, const elmopp_sight_t *sight, const elmopp_view_t *view) {
    self->even_step = 0U;
    for (uint32_t k = 0U; k <= self->options.horizon_s; k++) {
        self->arrived_sum_veh[k] = 0.0F;
    }
    for (uint32_t j = 0U; j < view->junction->movement_count; j++) {
        sum_arrivals(self, sight, view, j);
        for (uint32_t k = 0U; k <= self->options.horizon_s; k++) {
            self->arrived_sum_veh[k] += self->arrived_veh[j][k];
        }
    }
}
