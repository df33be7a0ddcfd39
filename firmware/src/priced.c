/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/priced.h"

#include "elmopp/age.h"
#include "elmopp/assert.h"
#include "elmopp/elementary.h"

#include <stddef.h>

#define DS_PER_S 10.0F

/* What a side of the comparison weighs: some movements, and how much a vehicle of each counts. */
typedef struct {
    const elmopp_view_t *view;
    const float *weight;
    uint32_t movements;
} side_t;

/* --- the junction, once --- */

static uint32_t shorter(uint32_t one, uint32_t other) {
    return (one < other) ? one : other;
}

/* Of the ambers that a change shows, the shortest tells how much is still driven. */
static uint32_t driven_ds(const elmopp_junction_t *junction, uint32_t from, uint32_t to) {
    const uint32_t ending = (uint32_t)junction->stage_groups[from] & ~(uint32_t)junction->stage_groups[to];
    uint32_t driven = ELMOPP_PRICED_AMBER_DRIVEN_DS;
    for (uint32_t g = 0U; g < junction->group_count; g++) {
        driven = elmopp_mask_has(ending, g) ? shorter(driven, junction->group[g].amber_ds) : driven;
    }
    return driven;
}

static float price_s(const elmopp_junction_t *junction, uint32_t from, uint32_t to) {
    const uint16_t before = junction->stage_groups[from];
    const uint16_t after = junction->stage_groups[to];
    const uint32_t lost_ds =
        elmopp_junction_clearing_ds(junction, before, after) + elmopp_junction_starting_ds(junction, before, after);
    const uint32_t price_ds = lost_ds - shorter(driven_ds(junction, from, to), lost_ds);
    return (float)price_ds / DS_PER_S;
}

static void price_changes(elmopp_priced_t *self, const elmopp_junction_t *junction) {
    self->junction = junction;
    for (uint32_t s = 0U; s < junction->stage_count; s++) {
        self->serves[s] = elmopp_junction_served(junction, junction->stage_groups[s]);
        for (uint32_t to = 0U; to < junction->stage_count; to++) {
            self->price_s[s][to] = price_s(junction, s, to);
        }
    }
}

/* --- rates of urgency --- */

/* Urgency that leaves in so many seconds of green. */
static float leaving(const side_t *side, float seconds) {
    float sum = 0.0F;
    for (uint32_t j = 0U; j < side->view->junction->movement_count; j++) {
        if (elmopp_mask_has(side->movements, j)) {
            const float queue_veh = side->view->queue_veh[j];
            const float flow = elmopp_junction_discharge(side->view->junction, j, queue_veh);
            sum += side->weight[j] * elmopp_lesser(queue_veh, flow * seconds);
        }
    }
    return sum;
}

/* The greatest rate: green until one of the queues is gone, for each second of it and of what is lost before. */
static float best_rate(const side_t *side, float lost_s, float least_s, float most_s) {
    float best = 0.0F;
    for (uint32_t j = 0U; j < side->view->junction->movement_count; j++) {
        if (elmopp_mask_has(side->movements, j)) {
            const float queue_veh = side->view->queue_veh[j];
            const float flow = elmopp_junction_discharge(side->view->junction, j, queue_veh);
            float needed_s = most_s;
            if (queue_veh < (most_s * flow)) { /* and so flow is not 0 */
                needed_s = queue_veh / flow;
            }
            const float green_s = elmopp_within(needed_s, least_s, most_s);
            const float rate = leaving(side, green_s) / (lost_s + green_s);
            best = elmopp_greater(rate, best);
        }
    }
    return best;
}

/* --- the decision --- */

/* Urgency of one vehicle: as part of the load, so that the paper's junction has the paper's urgency. */
static float vehicle_weight(const elmopp_priced_t *self, const elmopp_view_t *view, uint32_t movement) {
    const bool going = elmopp_mask_has(view->going, movement);
    const float age = going ? 1.0F : elmopp_age_factor(view->red_ds[movement], self->max_s);
    return age * elmopp_junction_load(view->junction, movement, 1.0F);
}

static bool is_called(const side_t *side) {
    bool found = false;
    for (uint32_t j = 0U; j < side->view->junction->movement_count; j++) {
        found = found || (elmopp_mask_has(side->movements, j) && (side->view->queue_veh[j] > 0.0F));
    }
    return found;
}

static elmopp_stage_t first_stage(const elmopp_priced_t *self, side_t *side, float score[ELMOPP_STAGE_MAX]) {
    elmopp_stage_t best = 0U;
    for (uint32_t s = 0U; s < self->junction->stage_count; s++) {
        side->movements = self->serves[s];
        for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
            score[s] += elmopp_mask_has(side->movements, j) ? (side->weight[j] * side->view->queue_veh[j]) : 0.0F;
        }
        best = (score[s] > score[best]) ? (elmopp_stage_t)s : best;
    }
    return best;
}

/* What a change to another stage gains, for each second. */
static float lead_of(const elmopp_priced_t *self, const side_t *other, uint32_t stage) {
    const uint32_t shown = other->view->stage;
    const side_t own = {other->view, other->weight, self->serves[shown] & ~self->serves[stage]};
    const float price = ELMOPP_PRICED_CHANGES * self->price_s[shown][stage];
    const float longest_s = elmopp_greater((float)self->max_s, ELMOPP_PRICED_WINDOW_S);
    return best_rate(other, price, (float)self->min_s, (float)self->max_s) -
           best_rate(&own, 0.0F, ELMOPP_PRICED_WINDOW_S, longest_s);
}

static elmopp_stage_t best_lead(const elmopp_priced_t *self, side_t *side, float score[ELMOPP_STAGE_MAX]) {
    const elmopp_stage_t shown = side->view->stage;
    const uint32_t elapsed_s = (uint32_t)side->view->elapsed_ds / ELMOPP_LAMP_TICKS_PER_S;
    const bool over = elapsed_s >= self->max_s;
    elmopp_stage_t wanted = shown;
    for (uint32_t s = 0U; s < self->junction->stage_count; s++) {
        if (s != shown) {
            side->movements = self->serves[s] & ~self->serves[shown];
            score[s] = lead_of(self, side, s);
            const bool first_over = over && (wanted == shown) && is_called(side);
            const bool better = score[s] > ((wanted == shown) ? 0.0F : score[wanted]);
            wanted = (first_over || better) ? (elmopp_stage_t)s : wanted;
        }
    }
    return (elapsed_s < self->min_s) ? shown : wanted;
}

static elmopp_stage_t choose_priced(void *state, const elmopp_view_t *view, float score[ELMOPP_STAGE_MAX]) {
    elmopp_priced_t *self = state;
    if (self->junction == NULL) {
        price_changes(self, view->junction);
    }
    ELMOPP_ASSERT(self->junction == view->junction);
    float weight[ELMOPP_MOVEMENT_MAX];
    for (uint32_t j = 0U; j < view->junction->movement_count; j++) {
        weight[j] = vehicle_weight(self, view, j);
    }
    for (uint32_t s = 0U; s < ELMOPP_STAGE_MAX; s++) {
        score[s] = 0.0F;
    }
    side_t side = {view, weight, 0U};
    elmopp_stage_t wanted;
    if (view->stage < self->junction->stage_count) {
        wanted = best_lead(self, &side, score);
    } else if (view->target < self->junction->stage_count) {
        wanted = view->target; /* in the intergreen: the plan has committed itself */
    } else {
        wanted = first_stage(self, &side, score);
    }
    return wanted;
}

elmopp_chooser_t elmopp_priced_init(elmopp_priced_t *self, uint16_t min_s, uint16_t max_s) {
    ELMOPP_ASSERT((min_s >= 1U) && (min_s <= max_s));
    *self = (elmopp_priced_t){.min_s = min_s, .max_s = max_s};
    return (elmopp_chooser_t){.choose = choose_priced, .state = self, .horizon_s = 0U};
}
