/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/rollout.h"

#include "elmopp/assert.h"
#include "elmopp/elementary.h"

#include <stddef.h>

elmopp_rollout_options_t elmopp_rollout_defaults(uint16_t travel_s) {
    return (elmopp_rollout_options_t){
        .sight = elmopp_sight_defaults(travel_s),
        .coming = {.horizon_s = 120U,
                   .rows_s = ELMOPP_ACCOUNT_PROBE_S,
                   .weigh_skill = true,
                   .fade_s = 60U,
                   .row_weight = 0.5F,
                   .mean_weight = 0.5F},
        .future =
            {.min_s = 5U, .max_s = 60U, .blocked_share = 0.5F, .yellow_used_s = 0.5F, .look = true, .stop_s = 1.5F},
        .red_s = 180U,
        .patience_s = 40U,
        .patience_veh_s = 60.0F,
        .others_max = 4U,
        .hold_count = 5U,
        .rule_count = 3U,
        .hold_s = {1U, 2U, 3U, 5U, 10U},
        .ratio = {2.5F, 4.0F, 6.0F},
        .caution = 0.5F};
}

/* --- prospects --- */

/* Costs of one first action under each rule. */
typedef struct {
    float veh_s[ELMOPP_ROLLOUT_RULE_MAX];
} costs_t;

static float play_one(elmopp_rollout_t *self, elmopp_stage_t first, uint16_t hold_s, float ratio) {
    const elmopp_future_action_t action = {.first = first, .hold_s = hold_s, .ratio = ratio};
    return elmopp_future_cost(&self->future, &action);
}

static void change(elmopp_rollout_t *self, elmopp_stage_t other, costs_t *changed) {
    for (uint32_t r = 0U; r < ELMOPP_ROLLOUT_RULE_MAX; r++) {
        changed->veh_s[r] = (r < self->options.rule_count) ? play_one(self, other, 0U, self->options.ratio[r]) : 0.0F;
    }
}

static float mean_of(const elmopp_rollout_t *self, const costs_t *costs) {
    float sum = 0.0F;
    for (uint32_t r = 0U; r < self->options.rule_count; r++) {
        sum += costs->veh_s[r];
    }
    return sum / (float)self->options.rule_count;
}

/* The stage shown, under one rule with the time that suits it best. Who would have kept it for so long anyway plays no
   other future. */
static float keep_under(elmopp_rollout_t *self, elmopp_stage_t shown, float ratio) {
    uint16_t played_s = self->options.hold_s[0];
    float best = play_one(self, shown, played_s, ratio);
    for (uint32_t h = 1U; h < self->options.hold_count; h++) {
        const uint16_t hold_s = self->options.hold_s[h];
        if ((hold_s < played_s) || (hold_s > self->future.left_step)) {
            best = elmopp_lesser(best, play_one(self, shown, hold_s, ratio));
            played_s = hold_s;
        }
    }
    return best;
}

static void keep(elmopp_rollout_t *self, elmopp_stage_t shown, costs_t *kept) {
    for (uint32_t r = 0U; r < ELMOPP_ROLLOUT_RULE_MAX; r++) {
        kept->veh_s[r] = (r < self->options.rule_count) ? keep_under(self, shown, self->options.ratio[r]) : 0.0F;
    }
}

/* What a change has to be charged with because its gain is less under the worst rule than in the mean. */
static float doubt_of(const elmopp_rollout_t *self, const costs_t *kept, const costs_t *changed) {
    const float mean = mean_of(self, kept) - mean_of(self, changed);
    float worst = kept->veh_s[0] - changed->veh_s[0];
    for (uint32_t r = 1U; r < self->options.rule_count; r++) {
        worst = elmopp_lesser(worst, kept->veh_s[r] - changed->veh_s[r]);
    }
    return self->options.caution * elmopp_greater(mean - worst, 0.0F);
}

/* --- the decision --- */

/* Whether somebody of a movement is there and a stage does not serve him. */
static bool is_passed_over(const elmopp_rollout_t *self, uint32_t stage, uint32_t movement) {
    return (self->sight.present_veh[movement] > 0.0F) && (!elmopp_sight_is_served(&self->sight, stage, movement));
}

static bool is_somebody_passed_over(const elmopp_rollout_t *self, uint32_t stage) {
    bool found = false;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        found = found || is_passed_over(self, stage, j);
    }
    return found;
}

static bool is_called_for(const elmopp_rollout_t *self, uint32_t stage) {
    bool found = false;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        found = found || ((self->sight.present_veh[j] > 0.0F) && elmopp_sight_is_served(&self->sight, stage, j));
    }
    return found;
}

/* The movement that has been passed over longest and too long; movement_count if there is none. */
static uint32_t overdue_movement(const elmopp_rollout_t *self, elmopp_stage_t shown) {
    uint32_t found = self->junction->movement_count;
    uint32_t longest_s = self->options.red_s;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        if (is_passed_over(self, shown, j) && (self->sight.red_s[j] >= longest_s)) {
            found = j;
            longest_s = (uint32_t)self->sight.red_s[j] + 1U; /* another one must have waited longer */
        }
    }
    return found;
}

/* Vehicles that are there, each times the flow that the stage has for it. */
static float weight_of(const elmopp_rollout_t *self, uint32_t stage) {
    float sum = 0.0F;
    for (uint32_t i = 0U; i < self->future.served_count[stage]; i++) {
        const uint32_t j = self->future.served[stage][i];
        sum += self->sight.present_veh[j] * elmopp_sight_usual(&self->sight, stage, j);
    }
    return sum;
}

/* Seconds beyond half of the bound that those have waited whom the stage would serve and the one shown does not,
   together: who will be overdue next. */
static uint32_t lateness_of(const elmopp_rollout_t *self, elmopp_stage_t shown, uint32_t stage) {
    const uint32_t half_s = (uint32_t)self->options.red_s / 2U;
    uint32_t sum_s = 0U;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const bool late = is_passed_over(self, shown, j) && (self->sight.red_s[j] > half_s);
        if (late && elmopp_sight_is_served(&self->sight, stage, j)) {
            sum_s += (uint32_t)self->sight.red_s[j] - half_s;
        }
    }
    return sum_s;
}

/* What a stage is worth to who is overdue: the flow for his movement counts, then whom it takes along. */
typedef struct {
    float flow;
    uint32_t late_s;
    float weight;
} relief_t;

static bool is_better_relief(const relief_t *one, const relief_t *than) {
    const bool as_late = (one->late_s == than->late_s) && (one->weight > than->weight);
    return (one->flow > than->flow) || ((one->flow >= than->flow) && ((one->late_s > than->late_s) || as_late));
}

/* The stage that serves a movement best; ELMOPP_STAGE_NONE if none does. */
static elmopp_stage_t stage_for(const elmopp_rollout_t *self, elmopp_stage_t shown, uint32_t movement) {
    elmopp_stage_t best = ELMOPP_STAGE_NONE;
    relief_t most = {.flow = 0.0F, .late_s = 0U, .weight = 0.0F};
    for (uint32_t s = 0U; s < self->junction->stage_count; s++) {
        const relief_t relief = {.flow = elmopp_sight_usual(&self->sight, s, movement),
                                 .late_s = lateness_of(self, shown, s),
                                 .weight = weight_of(self, s)};
        const bool better = (best == ELMOPP_STAGE_NONE) || is_better_relief(&relief, &most);
        if (better && elmopp_sight_is_served(&self->sight, s, movement)) {
            best = (elmopp_stage_t)s;
            most = relief;
        }
    }
    return best;
}

static elmopp_stage_t heaviest_stage(const elmopp_rollout_t *self) {
    elmopp_stage_t best = 0U;
    for (uint32_t s = 1U; s < self->junction->stage_count; s++) {
        best = (weight_of(self, s) > weight_of(self, best)) ? (elmopp_stage_t)s : best;
    }
    return best;
}

/* The heaviest stage that is called for, not shown and not yet tried; ELMOPP_STAGE_NONE if there is none. */
static elmopp_stage_t next_other(const elmopp_rollout_t *self, elmopp_stage_t shown, uint32_t tried) {
    elmopp_stage_t next = ELMOPP_STAGE_NONE;
    float heaviest = 0.0F;
    for (uint32_t s = 0U; s < self->junction->stage_count; s++) {
        const float weight = weight_of(self, s);
        const bool heavier = (next == ELMOPP_STAGE_NONE) || (weight > heaviest);
        if (heavier && (s != shown) && (!elmopp_mask_has(tried, s)) && is_called_for(self, s)) {
            next = (elmopp_stage_t)s;
            heaviest = weight;
        }
    }
    return next;
}

/* What a stage is worth beside its costs because of who has waited longest for it and is not served now. */
static float urge_of(const elmopp_rollout_t *self, elmopp_stage_t shown, elmopp_stage_t stage) {
    uint32_t longest_s = self->options.patience_s;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const bool waits = is_passed_over(self, shown, j) && elmopp_sight_is_served(&self->sight, stage, j);
        if (waits && (self->sight.red_s[j] > longest_s)) {
            longest_s = self->sight.red_s[j];
        }
    }
    const uint32_t beyond_s = longest_s - self->options.patience_s;
    const float beyond = (float)beyond_s;
    const float most = self->options.patience_veh_s;
    return (most > 0.0F) ? elmopp_lesser(beyond * (1.0F + (beyond / most)), most) : 0.0F;
}

/* The stage with the best prospects. `kept` is null where the stage shown cannot be kept. */
static elmopp_stage_t best_of_others(elmopp_rollout_t *self, elmopp_stage_t shown, const costs_t *kept,
                                     float score[ELMOPP_STAGE_MAX]) {
    elmopp_stage_t best = (kept != NULL) ? shown : ELMOPP_STAGE_NONE;
    uint32_t tried = 0U;
    elmopp_stage_t other = next_other(self, shown, tried);
    for (uint32_t n = 0U; (n < self->options.others_max) && (other != ELMOPP_STAGE_NONE); n++) {
        costs_t changed;
        change(self, other, &changed);
        const float doubt = (kept != NULL) ? doubt_of(self, kept, &changed) : 0.0F;
        score[other] = urge_of(self, shown, other) - (mean_of(self, &changed) + doubt);
        best = ((best == ELMOPP_STAGE_NONE) || (score[other] > score[best])) ? other : best;
        tried |= (uint32_t)1U << other;
        other = next_other(self, shown, tried);
    }
    return (best == ELMOPP_STAGE_NONE) ? shown : best;
}

static elmopp_stage_t best_prospects(elmopp_rollout_t *self, elmopp_stage_t shown, uint32_t elapsed_s,
                                     float score[ELMOPP_STAGE_MAX]) {
    elmopp_future_begin(&self->future, shown, elapsed_s);
    if (elapsed_s >= self->options.future.max_s) {
        return best_of_others(self, shown, NULL, score);
    }
    costs_t kept;
    keep(self, shown, &kept);
    score[shown] = -mean_of(self, &kept);
    return best_of_others(self, shown, &kept, score);
}

/* The stage of who has been passed over too long; ELMOPP_STAGE_NONE if nobody has, or none serves him. */
static elmopp_stage_t rescue_from(const elmopp_rollout_t *self, elmopp_stage_t shown) {
    const uint32_t overdue =
        (self->options.red_s > 0U) ? overdue_movement(self, shown) : self->junction->movement_count;
    return (overdue < self->junction->movement_count) ? stage_for(self, shown, overdue) : ELMOPP_STAGE_NONE;
}

static elmopp_stage_t decide_by_cost(elmopp_rollout_t *self, const elmopp_view_t *view, float score[ELMOPP_STAGE_MAX]) {
    const uint32_t elapsed_s = (uint32_t)view->elapsed_ds / ELMOPP_LAMP_TICKS_PER_S;
    if ((elapsed_s < self->options.future.min_s) || (!is_somebody_passed_over(self, view->stage))) {
        return view->stage;
    }
    elmopp_coming_expect(&self->coming, &self->sight, view);
    const elmopp_stage_t wanted = best_prospects(self, view->stage, elapsed_s, score);
    const elmopp_stage_t rescue = rescue_from(self, view->stage);
    return ((wanted != view->stage) && (rescue != ELMOPP_STAGE_NONE)) ? rescue : wanted;
}

static void know(elmopp_rollout_t *self, const elmopp_junction_t *junction) {
    self->junction = junction;
    elmopp_sight_init(&self->sight, junction, &self->options.sight);
    elmopp_future_init(&self->future, &self->options.future, &self->sight, &self->coming);
}

static elmopp_stage_t choose_by_rollout(void *state, const elmopp_view_t *view, float score[ELMOPP_STAGE_MAX]) {
    elmopp_rollout_t *self = state;
    if (self->junction == NULL) {
        know(self, view->junction);
    }
    ELMOPP_ASSERT(self->junction == view->junction);
    for (uint32_t s = 0U; s < ELMOPP_STAGE_MAX; s++) {
        score[s] = 0.0F;
    }
    elmopp_sight_observe(&self->sight, view);
    elmopp_coming_observe(&self->coming, &self->sight, view);
    elmopp_stage_t wanted;
    if (view->stage < self->junction->stage_count) {
        wanted = decide_by_cost(self, view, score);
    } else if (view->target < self->junction->stage_count) {
        wanted = view->target; /* in the intergreen: the plan has committed itself */
    } else {
        wanted = heaviest_stage(self);
    }
    return wanted;
}

static uint16_t shortest_travel_s(const elmopp_sight_options_t *sight) {
    uint16_t shortest_s = ELMOPP_SIGHT_TRAVEL_MAX_S;
    for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
        ELMOPP_ASSERT(sight->travel_s[j] <= ELMOPP_SIGHT_TRAVEL_MAX_S);
        shortest_s = (sight->travel_s[j] < shortest_s) ? sight->travel_s[j] : shortest_s;
    }
    return shortest_s;
}

elmopp_chooser_t elmopp_rollout_init(elmopp_rollout_t *self, const elmopp_rollout_options_t *options) {
    ELMOPP_ASSERT((options->hold_count >= 1U) && (options->hold_count <= ELMOPP_ROLLOUT_HOLD_MAX));
    ELMOPP_ASSERT((options->rule_count >= 1U) && (options->rule_count <= ELMOPP_ROLLOUT_RULE_MAX));
    ELMOPP_ASSERT((options->others_max >= 1U) && (options->caution >= 0.0F) && (options->caution <= 1.0F));
    ELMOPP_ASSERT(options->patience_veh_s >= 0.0F);
    ELMOPP_ASSERT(elmopp_future_is_sound(&options->future));
    for (uint32_t h = 0U; h < options->hold_count; h++) {
        ELMOPP_ASSERT(options->hold_s[h] >= 1U);
    }
    for (uint32_t r = 0U; r < options->rule_count; r++) {
        ELMOPP_ASSERT(options->ratio[r] >= 1.0F);
    }
    *self = (elmopp_rollout_t){.options = *options};
    elmopp_coming_init(&self->coming, &options->coming);
    const uint16_t travel_s = shortest_travel_s(&options->sight);
    const uint16_t horizon_s = options->coming.horizon_s;
    /* Who is seen at the edge of the reach now arrives travel_s later: rows beyond the horizon are of no use. */
    const uint16_t useful_s = (horizon_s > travel_s) ? (uint16_t)(horizon_s - travel_s) : 0U;
    const uint16_t rows_s = (useful_s < options->coming.rows_s) ? useful_s : options->coming.rows_s;
    return (elmopp_chooser_t){.choose = choose_by_rollout, .state = self, .horizon_s = rows_s};
}
