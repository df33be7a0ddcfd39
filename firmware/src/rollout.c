/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/rollout.h"

#include "elmopp/assert.h"
#include "elmopp/elementary.h"

#include <stddef.h>

#define DS_PER_S 10.0F
#define NOBODY_VEH 0.01F   /* for the rule: less is rounding, and must not call for a change */
#define ROW_MAX_VEH 1.0e6F /* more in a second is no forecast */
#define SKILL_MIN_S 60U    /* compared for so long before skill counts */
#define NEAR_ROWS ((ELMOPP_ROLLOUT_NEAR_S + ELMOPP_ACCOUNT_PROBE_S) / 2U) /* have the skill of the nearer account */

/* A first action and the rule that follows it. */
typedef struct {
    elmopp_stage_t first;
    uint32_t hold_s; /* of the stage shown; 0: `first` is another one */
    float ratio;
} action_t;

elmopp_rollout_options_t elmopp_rollout_defaults(uint16_t travel_s) {
    return (elmopp_rollout_options_t){.sight = elmopp_sight_defaults(travel_s),
                                      .min_s = 5U,
                                      .max_s = 60U,
                                      .red_s = 120U,
                                      .horizon_s = 120U,
                                      .hold_count = 3U,
                                      .rule_count = 2U,
                                      .hold_s = {1U, 3U, 10U},
                                      .ratio = {3.0F, 6.0F},
                                      .rows_s = ELMOPP_ACCOUNT_PROBE_S,
                                      .weigh_skill = true,
                                      .row_weight = 0.5F,
                                      .mean_weight = 0.5F,
                                      .blocked_share = 0.5F,
                                      .yellow_used_s = 0.5F};
}

/* --- the junction, once --- */

static float startup_s(const elmopp_junction_t *junction, uint32_t movement) {
    return (float)junction->movement[movement].startup_ds / DS_PER_S;
}

/* The model moves by whole seconds; a change that ends within one has ended at its end. */
static void price_change(elmopp_rollout_t *self, uint32_t from, uint32_t to) {
    const uint16_t *groups = self->junction->stage_groups;
    const uint32_t clearing_ds = elmopp_junction_clearing_ds(self->junction, groups[from], groups[to]);
    const uint32_t whole_s = (clearing_ds + ELMOPP_LAMP_TICKS_PER_S - 1U) / ELMOPP_LAMP_TICKS_PER_S;
    self->change_s[from][to] = (uint16_t)whole_s;
}

static void list_served(elmopp_rollout_t *self, uint32_t stage) {
    uint32_t count = 0U;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        if (elmopp_mask_has(self->sight.serves[stage], j)) {
            self->served[stage][count] = (uint8_t)j;
            count++;
        }
    }
    self->served_count[stage] = (uint8_t)count;
}

static void know(elmopp_rollout_t *self, const elmopp_junction_t *junction) {
    self->junction = junction;
    elmopp_sight_init(&self->sight, junction, &self->options.sight);
    for (uint32_t s = 0U; s < junction->stage_count; s++) {
        list_served(self, s);
        for (uint32_t to = 0U; to < junction->stage_count; to++) {
            price_change(self, s, to);
        }
    }
}

/* --- who comes, once a decision --- */

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

static void add_up(const elmopp_rollout_t *self, const elmopp_view_t *view, arrivals_t *arrivals) {
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        arrivals->came_veh[i] = 0.0F;
        arrivals->mean_veh[i] = 0.0F;
    }
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const uint32_t approach = self->junction->movement[j].approach;
        arrivals->came_veh[approach] += view->arrivals_veh[j];
        arrivals->mean_veh[approach] += self->sight.mean_veh_per_s[j];
    }
}

/* Compares what rows said of this second with who came, and enters what they say now of `ahead_s` later. */
static void settle(elmopp_account_t *account, uint32_t ahead_s, const elmopp_view_t *view, const arrivals_t *arrivals) {
    const uint32_t approaches = view->junction->approach_count;
    elmopp_account_settle(account, arrivals->came_veh, approaches);
    if (view->foreseen_steps >= ahead_s) {
        elmopp_account_probe_t *page = elmopp_account_page(account, ahead_s);
        for (uint32_t i = 0U; i < approaches; i++) {
            page->forecast_veh[i] = said_veh(view, i, ahead_s - 1U);
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

static void weigh_rows(elmopp_rollout_t *self, const elmopp_view_t *view) {
    self->near_weight = self->options.row_weight;
    self->row_weight = self->options.row_weight;
    if (self->options.weigh_skill) {
        arrivals_t arrivals;
        add_up(self, view, &arrivals);
        settle(&self->near, ELMOPP_ROLLOUT_NEAR_S, view, &arrivals);
        settle(&self->account, ELMOPP_ACCOUNT_PROBE_S, view, &arrivals);
        self->near_weight = skill_of(&self->near.error);
        self->row_weight = skill_of(&self->account.error);
    }
}

/* Who reaches the queue in second `step`, beyond the reach: the mean, corrected by a row as far as it is believed. */
static float foreseen(const elmopp_rollout_t *self, const elmopp_view_t *view, uint32_t movement, uint32_t step) {
    const float expected_veh = self->expected_veh_per_s[movement];
    const uint32_t row = step - self->options.sight.travel_s[movement];
    if ((row >= view->foreseen_steps) || (row >= self->options.rows_s)) {
        return expected_veh;
    }
    const float said = view->share[movement] * said_veh(view, self->junction->movement[movement].approach, row);
    const float base_veh = self->options.weigh_skill ? expected_veh : 0.0F;
    const float weight = (row < NEAR_ROWS) ? self->near_weight : self->row_weight;
    return base_veh + (weight * (said - base_veh));
}

/* The queue and who comes before each second. Who is hidden behind a full reach comes as fast as a queue can. */
static void sum_arrivals(elmopp_rollout_t *self, const elmopp_view_t *view, uint32_t movement) {
    const elmopp_sight_t *sight = &self->sight;
    float hidden_veh = sight->hidden_veh[movement];
    float sum_veh = sight->queued_veh[movement];
    self->expected_veh_per_s[movement] = self->options.mean_weight * sight->mean_veh_per_s[movement];
    self->arrived_veh[0][movement] = sum_veh;
    for (uint32_t k = 0U; k < self->options.horizon_s; k++) {
        float came_veh;
        if (k < self->options.sight.travel_s[movement]) {
            came_veh = sight->due_veh[movement][k];
        } else {
            came_veh = foreseen(self, view, movement, k);
            const float room_veh = elmopp_greater(sight->site_veh_per_s[movement] - came_veh, 0.0F);
            const float shown_veh = elmopp_lesser(room_veh, hidden_veh);
            hidden_veh -= shown_veh;
            came_veh += shown_veh;
        }
        sum_veh += came_veh;
        self->arrived_veh[k + 1U][movement] = sum_veh;
    }
}

static void expect_all(elmopp_rollout_t *self, const elmopp_view_t *view) {
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        sum_arrivals(self, view, j);
        const float flow = self->sight.flow_veh_per_s[view->stage][j];
        const bool blocked = elmopp_sight_is_blocked(&self->sight, j);
        self->present_flow_veh_per_s[j] = blocked ? (self->options.blocked_share * flow) : flow;
    }
    for (uint32_t k = 0U; k <= self->options.horizon_s; k++) {
        float sum_veh = 0.0F;
        for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
            sum_veh += self->arrived_veh[k][j];
        }
        self->arrived_sum_veh[k] = sum_veh;
    }
}

/* --- the model --- */

/* Flow of a movement that is green: as learnt, or by the law of the junction's profile. */
static float flow_of(const elmopp_rollout_t *self, const float *flow_veh_per_s, uint32_t movement, float queue_veh) {
    const bool learnt = self->junction->discharge == (uint8_t)ELMOPP_DISCHARGE_SATURATION;
    return learnt ? flow_veh_per_s[movement] : elmopp_junction_discharge(self->junction, movement, queue_veh);
}

/* Queue of a movement before second `step` of the future. */
static float standing(const elmopp_rollout_t *self, uint32_t step, uint32_t movement) {
    return elmopp_greater(self->arrived_veh[step][movement] - self->future.left_veh[movement], 0.0F);
}

/* Queue times flow, summed over a stage. */
static float pressure_of(const elmopp_rollout_t *self, uint32_t stage, const float *flow, const float *queue_veh) {
    float sum = 0.0F;
    for (uint32_t i = 0U; i < self->served_count[stage]; i++) {
        const uint32_t j = self->served[stage][i];
        sum += queue_veh[j] * elmopp_lesser(flow_of(self, flow, j, queue_veh[j]), queue_veh[j]);
    }
    return sum;
}

/* The reactive rule: the stage that it wants shown in second `step`. */
static elmopp_stage_t react(const elmopp_rollout_t *self, uint32_t step) {
    const elmopp_rollout_future_t *future = &self->future;
    if (future->elapsed_s < self->options.min_s) {
        return future->shown;
    }
    float queue_veh[ELMOPP_MOVEMENT_MAX];
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const float standing_veh = standing(self, step, j);
        queue_veh[j] = (standing_veh >= NOBODY_VEH) ? standing_veh : 0.0F;
    }
    float own = 0.0F;
    float greatest = 0.0F;
    elmopp_stage_t best = future->shown;
    for (uint32_t s = 0U; s < self->junction->stage_count; s++) {
        const float *flow = (s == future->shown) ? future->flow_veh_per_s : self->sight.flow_veh_per_s[s];
        const float sum = pressure_of(self, s, flow, queue_veh);
        own = (s == future->shown) ? sum : own;
        if (sum > greatest) {
            best = (elmopp_stage_t)s;
            greatest = sum;
        }
    }
    const bool leave = (future->elapsed_s >= self->options.max_s) || (greatest > (future->ratio * own));
    return leave ? best : future->shown;
}

static elmopp_stage_t wish(const elmopp_rollout_t *self, const action_t *action, uint32_t step) {
    if (step == 0U) {
        return action->first;
    }
    return (step >= action->hold_s) ? react(self, step) : self->future.shown;
}

static void begin_change(elmopp_rollout_t *self, elmopp_stage_t wanted) {
    elmopp_rollout_future_t *future = &self->future;
    if (wanted != future->shown) {
        future->target = wanted;
        future->change_s = self->change_s[future->shown][wanted];
        future->remaining_s = future->change_s;
    }
}

static void show_target(elmopp_rollout_t *self) {
    elmopp_rollout_future_t *future = &self->future;
    const elmopp_stage_t target = future->target;
    for (uint32_t i = 0U; i < self->served_count[target]; i++) {
        const uint32_t j = self->served[target][i];
        const bool stays = elmopp_mask_has(self->sight.serves[future->shown], j);
        future->startup_s[j] = stays ? 0.0F : startup_s(self->junction, j);
    }
    future->flow_veh_per_s = self->sight.flow_veh_per_s[target];
    future->shown = target;
    future->target = ELMOPP_STAGE_NONE;
    future->elapsed_s = 0U;
}

/* Flow of a movement of the stage shown, of which `amber_share` is left if the movement ends. */
static float open_flow(const elmopp_rollout_t *self, uint32_t movement, float queue_veh, float amber_share) {
    const elmopp_rollout_future_t *future = &self->future;
    float flow = flow_of(self, future->flow_veh_per_s, movement, queue_veh);
    if (future->target != ELMOPP_STAGE_NONE) {
        const bool stays = elmopp_mask_has(self->sight.serves[future->target], movement);
        const float *next = self->sight.flow_veh_per_s[future->target];
        flow = stays ? elmopp_lesser(flow, flow_of(self, next, movement, queue_veh)) : (flow * amber_share);
    }
    return flow;
}

/* One second of departures. Who is seen to reach the line in this second may pass in it; without a reach he is counted
   first, and goes in the next one at the earliest. */
static void let_go(elmopp_rollout_t *self, uint32_t step) {
    elmopp_rollout_future_t *future = &self->future;
    const uint32_t since_s = future->change_s - future->remaining_s;
    const float changing_s = (float)since_s;
    const float amber_share = elmopp_lesser(elmopp_greater(self->options.yellow_used_s - changing_s, 0.0F), 1.0F);
    for (uint32_t i = 0U; i < self->served_count[future->shown]; i++) {
        const uint32_t j = self->served[future->shown][i];
        const float lost_s = future->startup_s[j];
        if (lost_s >= 1.0F) {
            future->startup_s[j] = lost_s - 1.0F;
        } else {
            const uint32_t there = step + ((self->options.sight.travel_s[j] > 0U) ? 1U : 0U);
            const float queue_veh = standing(self, there, j);
            const float flow = open_flow(self, j, queue_veh, amber_share) * (1.0F - lost_s);
            const float leaving_veh = elmopp_lesser(flow, queue_veh);
            future->startup_s[j] = 0.0F;
            future->left_veh[j] += leaving_veh;
            future->left_sum_veh += leaving_veh;
        }
    }
}

static void play_second(elmopp_rollout_t *self, const action_t *action, uint32_t step) {
    elmopp_rollout_future_t *future = &self->future;
    if (future->target == ELMOPP_STAGE_NONE) {
        begin_change(self, wish(self, action, step));
    }
    if ((future->target != ELMOPP_STAGE_NONE) && (future->remaining_s == 0U)) {
        show_target(self);
    }
    let_go(self, step);
    if (future->target == ELMOPP_STAGE_NONE) {
        future->elapsed_s++;
    } else {
        future->remaining_s--;
    }
}

/* What is left at the horizon, cleared movement by movement and at once: x at flow s takes x / s, the mean x / 2. Who
   can never go is the same in every future. */
static float cost_of_rest(const elmopp_rollout_t *self) {
    float cost = 0.0F;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const float left_veh = standing(self, self->options.horizon_s, j);
        const float flow = self->sight.site_veh_per_s[j];
        cost += (flow > 0.0F) ? ((left_veh * left_veh) / (2.0F * flow)) : 0.0F;
    }
    return cost;
}

/* V of one action: the queues of all seconds, and of those after them what they are at least. */
static float cost_of(elmopp_rollout_t *self, const elmopp_view_t *view, const action_t *action) {
    const uint32_t horizon_s = self->options.horizon_s;
    self->future = (elmopp_rollout_future_t){.flow_veh_per_s = self->present_flow_veh_per_s,
                                             .ratio = action->ratio,
                                             .elapsed_s = (uint32_t)view->elapsed_ds / ELMOPP_LAMP_TICKS_PER_S,
                                             .shown = view->stage,
                                             .target = ELMOPP_STAGE_NONE};
    float cost = 0.0F;
    for (uint32_t k = 0U; k < horizon_s; k++) {
        play_second(self, action, k);
        cost += elmopp_greater(self->arrived_sum_veh[k + 1U] - self->future.left_sum_veh, 0.0F);
    }
    return cost + cost_of_rest(self);
}

/* --- the decision --- */

/* The cheapest that begins with this stage. */
static float value_of(elmopp_rollout_t *self, const elmopp_view_t *view, uint32_t stage) {
    const bool keep = stage == view->stage;
    const uint32_t holds = keep ? self->options.hold_count : 1U;
    float best = 0.0F;
    for (uint32_t h = 0U; h < holds; h++) {
        for (uint32_t r = 0U; r < self->options.rule_count; r++) {
            const action_t action = {.first = (elmopp_stage_t)stage,
                                     .hold_s = keep ? self->options.hold_s[h] : 0U,
                                     .ratio = self->options.ratio[r]};
            const float cost = cost_of(self, view, &action);
            best = ((h + r) == 0U) ? cost : elmopp_lesser(cost, best);
        }
    }
    return best;
}

static bool is_somebody_passed_over(const elmopp_rollout_t *self, uint32_t stage) {
    bool found = false;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        found = found || ((self->sight.present_veh[j] > 0.0F) && (!elmopp_sight_is_served(&self->sight, stage, j)));
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
        const bool waits = (self->sight.present_veh[j] > 0.0F) && (!elmopp_sight_is_served(&self->sight, shown, j));
        if (waits && (self->sight.red_s[j] >= longest_s)) {
            found = j;
            longest_s = (uint32_t)self->sight.red_s[j] + 1U; /* another one must have waited longer */
        }
    }
    return found;
}

/* Vehicles that are there, each times the flow that the stage has for it. */
static float weight_of(const elmopp_rollout_t *self, uint32_t stage) {
    float sum = 0.0F;
    for (uint32_t i = 0U; i < self->served_count[stage]; i++) {
        const uint32_t j = self->served[stage][i];
        sum += self->sight.present_veh[j] * self->sight.flow_veh_per_s[stage][j];
    }
    return sum;
}

/* The stage that serves a movement best, the heaviest among equals; ELMOPP_STAGE_NONE if none does. */
static elmopp_stage_t stage_for(const elmopp_rollout_t *self, uint32_t movement) {
    elmopp_stage_t best = ELMOPP_STAGE_NONE;
    float best_flow = 0.0F;
    float best_weight = 0.0F;
    for (uint32_t s = 0U; s < self->junction->stage_count; s++) {
        const float flow = self->sight.flow_veh_per_s[s][movement];
        const float weight = weight_of(self, s);
        const bool better =
            (best == ELMOPP_STAGE_NONE) || (flow > best_flow) || ((flow >= best_flow) && (weight > best_weight));
        if (better && elmopp_sight_is_served(&self->sight, s, movement)) {
            best = (elmopp_stage_t)s;
            best_flow = flow;
            best_weight = weight;
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

static elmopp_stage_t cheapest(elmopp_rollout_t *self, const elmopp_view_t *view, uint32_t elapsed_s,
                               float score[ELMOPP_STAGE_MAX]) {
    expect_all(self, view);
    elmopp_stage_t best = ELMOPP_STAGE_NONE;
    for (uint32_t s = 0U; s < self->junction->stage_count; s++) {
        const bool tried = (s == view->stage) ? (elapsed_s < self->options.max_s) : is_called_for(self, s);
        if (tried) {
            score[s] = -value_of(self, view, s);
            best = ((best == ELMOPP_STAGE_NONE) || (score[s] > score[best])) ? (elmopp_stage_t)s : best;
        }
    }
    return (best == ELMOPP_STAGE_NONE) ? view->stage : best;
}

/* The stage of who has been passed over too long; ELMOPP_STAGE_NONE if nobody has, or none serves him. */
static elmopp_stage_t rescue_from(const elmopp_rollout_t *self, elmopp_stage_t shown) {
    const uint32_t overdue =
        (self->options.red_s > 0U) ? overdue_movement(self, shown) : self->junction->movement_count;
    return (overdue < self->junction->movement_count) ? stage_for(self, overdue) : ELMOPP_STAGE_NONE;
}

static elmopp_stage_t decide_by_cost(elmopp_rollout_t *self, const elmopp_view_t *view, float score[ELMOPP_STAGE_MAX]) {
    const uint32_t elapsed_s = (uint32_t)view->elapsed_ds / ELMOPP_LAMP_TICKS_PER_S;
    if ((elapsed_s < self->options.min_s) || (!is_somebody_passed_over(self, view->stage))) {
        return view->stage;
    }
    const elmopp_stage_t wanted = cheapest(self, view, elapsed_s, score);
    const elmopp_stage_t rescue = rescue_from(self, view->stage);
    return ((wanted != view->stage) && (rescue != ELMOPP_STAGE_NONE)) ? rescue : wanted;
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
    weigh_rows(self, view);
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

static bool is_share(float value) {
    return (value >= 0.0F) && (value <= 1.0F);
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
    ELMOPP_ASSERT((options->min_s >= 1U) && (options->min_s <= options->max_s));
    ELMOPP_ASSERT((options->horizon_s >= 1U) && (options->horizon_s <= ELMOPP_HORIZON_MAX));
    ELMOPP_ASSERT((options->hold_count >= 1U) && (options->hold_count <= ELMOPP_ROLLOUT_HOLD_MAX));
    ELMOPP_ASSERT((options->rule_count >= 1U) && (options->rule_count <= ELMOPP_ROLLOUT_RULE_MAX));
    ELMOPP_ASSERT(is_share(options->row_weight) && is_share(options->mean_weight));
    ELMOPP_ASSERT(is_share(options->blocked_share) && (options->yellow_used_s >= 0.0F));
    for (uint32_t h = 0U; h < options->hold_count; h++) {
        ELMOPP_ASSERT(options->hold_s[h] >= 1U);
    }
    for (uint32_t r = 0U; r < options->rule_count; r++) {
        ELMOPP_ASSERT(options->ratio[r] >= 1.0F);
    }
    *self = (elmopp_rollout_t){.options = *options};
    const uint16_t travel_s = shortest_travel_s(&options->sight);
    /* Who is seen at the edge of the reach now arrives travel_s later: rows beyond the horizon are of no use. */
    const uint16_t useful_s = (options->horizon_s > travel_s) ? (uint16_t)(options->horizon_s - travel_s) : 0U;
    const uint16_t rows_s = (useful_s < options->rows_s) ? useful_s : options->rows_s;
    return (elmopp_chooser_t){.choose = choose_by_rollout, .state = self, .horizon_s = rows_s};
}
