/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/future.h"

#include "elmopp/assert.h"
#include "elmopp/elementary.h"

#include <string.h>

#define DS_PER_S 10.0F
#define GAP_WINDOW_S 5U  /* a gap is looked for so far ahead: the critical one, in whole seconds */
#define NOBODY_VEH 0.01F /* for the rule: less is rounding, and must not call for a change */

/* --- the junction, once --- */

bool elmopp_future_is_sound(const elmopp_future_options_t *options) {
    const bool window = (options->min_s >= 1U) && (options->min_s <= options->max_s);
    const bool share = (options->blocked_share >= 0.0F) && (options->blocked_share <= 1.0F);
    return window && share && (options->yellow_used_s >= 0.0F) && (options->stop_s >= 0.0F);
}

/* The model moves by whole seconds; a change that ends within one has ended at its end. */
static void price_change(elmopp_future_t *self, uint32_t from, uint32_t to) {
    const uint16_t *groups = self->junction->stage_groups;
    const uint32_t clearing_ds = elmopp_junction_clearing_ds(self->junction, groups[from], groups[to]);
    const uint32_t whole_s = (clearing_ds + ELMOPP_LAMP_TICKS_PER_S - 1U) / ELMOPP_LAMP_TICKS_PER_S;
    self->change_s[from][to] = (uint16_t)whole_s;
}

static void list_served(elmopp_future_t *self, uint32_t stage) {
    uint32_t count = 0U;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        if (elmopp_mask_has(self->sight->serves[stage], j)) {
            self->served[stage][count] = (uint8_t)j;
            count++;
        }
    }
    self->served_count[stage] = (uint8_t)count;
}

static void list_foes(elmopp_future_t *self, uint32_t movement) {
    uint32_t count = 0U;
    for (uint32_t f = 0U; f < self->junction->movement_count; f++) {
        if (elmopp_mask_has(self->junction->gives_way[movement], f)) {
            self->foe[movement][count] = (uint8_t)f;
            count++;
        }
    }
    self->foe_count[movement] = (uint8_t)count;
}

void elmopp_future_init(elmopp_future_t *self, const elmopp_future_options_t *options, const elmopp_sight_t *sight,
                        const elmopp_coming_t *coming) {
    ELMOPP_ASSERT(elmopp_future_is_sound(options));
    *self = (elmopp_future_t){.options = *options, .junction = sight->junction, .sight = sight, .coming = coming};
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        list_foes(self, j);
    }
    for (uint32_t s = 0U; s < self->junction->stage_count; s++) {
        list_served(self, s);
        for (uint32_t to = 0U; to < self->junction->stage_count; to++) {
            price_change(self, s, to);
        }
    }
}

/* --- a decision --- */

/* The most that arrivals of the second before `step` can add to half the pressure of any stage. */
static float most_coming(const elmopp_future_t *self, uint32_t step) {
    const float *now_veh = self->coming->arrived_veh[step];
    const float *before_veh = self->coming->arrived_veh[step - 1U];
    const uint32_t stages = self->junction->stage_count;
    float most = 0.0F;
    for (uint32_t s = 0U; s < stages; s++) {
        const uint8_t *served = self->served[s];
        const uint32_t count = self->served_count[s];
        const float *flow = self->sight->flow_veh_per_s[s];
        float sum = 0.0F;
        for (uint32_t i = 0U; i < count; i++) {
            sum += flow[served[i]] * (now_veh[served[i]] - before_veh[served[i]]);
        }
        most = elmopp_greater(sum, most);
    }
    return most;
}

void elmopp_future_begin(elmopp_future_t *self, elmopp_stage_t shown, uint32_t elapsed_s) {
    self->present = shown;
    self->present_s = elapsed_s;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const float flow = self->sight->flow_veh_per_s[shown][j];
        const bool blocked = elmopp_sight_is_blocked(self->sight, j);
        self->present_flow_veh_per_s[j] = blocked ? (self->options.blocked_share * flow) : flow;
    }
    self->come[0] = 0.0F;
    for (uint32_t k = 1U; k <= self->coming->options.horizon_s; k++) {
        self->come[k] = self->come[k - 1U] + most_coming(self, k);
    }
}

/* --- one future --- */

static bool is_flow_learnt(const elmopp_future_t *self) {
    return self->junction->discharge == (uint8_t)ELMOPP_DISCHARGE_SATURATION;
}

/* Flow of a movement that is green: as learnt, or by the law of the junction's profile. */
static float flow_of(const elmopp_future_t *self, const float *flow_veh_per_s, uint32_t movement, float queue_veh) {
    return is_flow_learnt(self) ? flow_veh_per_s[movement]
                                : elmopp_junction_discharge(self->junction, movement, queue_veh);
}

/* Queue of a movement before second `step`. */
static float standing(const elmopp_future_t *self, uint32_t step, uint32_t movement) {
    return elmopp_greater(self->coming->arrived_veh[step][movement] - self->left_veh[movement], 0.0F);
}

/* Queue times flow, summed over a stage. The first loop is where most of a decision's time goes. */
static float pressure_of(const elmopp_future_t *self, uint32_t stage, const float *flow, const float *queue_veh) {
    const uint8_t *served = self->served[stage];
    const uint32_t count = self->served_count[stage];
    float sum = 0.0F;
    if (is_flow_learnt(self)) {
        for (uint32_t i = 0U; i < count; i++) {
            const float veh = queue_veh[served[i]];
            sum += veh * elmopp_lesser(flow[served[i]], veh);
        }
    } else {
        for (uint32_t i = 0U; i < count; i++) {
            const float veh = queue_veh[served[i]];
            sum += veh * elmopp_lesser(elmopp_junction_discharge(self->junction, served[i], veh), veh);
        }
    }
    return sum;
}

/* The stage with the greatest pressure in second `step`, and what that is. */
static elmopp_stage_t press_most(elmopp_future_t *self, uint32_t step) {
    float queue_veh[ELMOPP_MOVEMENT_MAX];
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const float standing_veh = self->coming->arrived_veh[step][j] - self->left_veh[j];
        queue_veh[j] = (standing_veh >= NOBODY_VEH) ? standing_veh : 0.0F;
    }
    float greatest = 0.0F;
    elmopp_stage_t best = self->shown;
    for (uint32_t s = 0U; s < self->junction->stage_count; s++) {
        const float *flow = (s == self->shown) ? self->flow_veh_per_s : self->sight->flow_veh_per_s[s];
        const float sum = pressure_of(self, s, flow, queue_veh);
        if (sum > greatest) {
            best = (elmopp_stage_t)s;
            greatest = sum;
        }
    }
    self->greatest = greatest;
    self->greatest_step = step;
    return best;
}

/* No stage presses more in second `step`, as long as the stage shown is the same: since the last look queues have grown
   by arrivals alone, and a vehicle more is a pressure more of twice its flow at most. The rest is more than all
   roundings. */
static float most_possible(const elmopp_future_t *self, uint32_t step) {
    const float come = self->come[step] - self->come[self->greatest_step];
    return (1.001F * self->greatest) + (2.001F * come) + (1.0e-5F * self->come[step]) + 0.01F;
}

/* Pressure of the stage shown. What the loop needs is read before it: no compiler knows that a call leaves it alone. */
static float own_pressure(const elmopp_future_t *self, uint32_t step) {
    const uint8_t *served = self->served[self->shown];
    const uint32_t count = self->served_count[self->shown];
    const float *arrived_veh = self->coming->arrived_veh[step];
    const float *left_veh = self->left_veh;
    const float *flow_veh_per_s = self->flow_veh_per_s;
    const bool learnt = is_flow_learnt(self);
    float sum = 0.0F;
    for (uint32_t i = 0U; i < count; i++) {
        const uint32_t j = served[i];
        const float standing_veh = arrived_veh[j] - left_veh[j];
        const float queue_veh = (standing_veh >= NOBODY_VEH) ? standing_veh : 0.0F;
        const float flow = learnt ? flow_veh_per_s[j] : elmopp_junction_discharge(self->junction, j, queue_veh);
        sum += queue_veh * elmopp_lesser(flow, queue_veh);
    }
    return sum;
}

/* The reactive rule: the stage that it wants shown in second `step`. It looks at the other stages only when one could
   press enough. */
static elmopp_stage_t react(elmopp_future_t *self, float ratio, uint32_t step) {
    if (self->elapsed_s < self->options.min_s) {
        return self->shown;
    }
    const bool late = self->elapsed_s >= self->options.max_s;
    const float enough = ratio * own_pressure(self, step);
    if ((!late) && self->looked && (most_possible(self, step) <= enough)) {
        return self->shown;
    }
    const elmopp_stage_t best = press_most(self, step);
    self->looked = is_flow_learnt(self);
    return (late || (self->greatest > enough)) ? best : self->shown;
}

static elmopp_stage_t wish(elmopp_future_t *self, const elmopp_future_action_t *action, uint32_t step) {
    if (step == 0U) {
        return action->first;
    }
    return (step >= action->hold_s) ? react(self, action->ratio, step) : self->shown;
}

static void begin_change(elmopp_future_t *self, elmopp_stage_t wanted) {
    if (wanted != self->shown) {
        self->target = wanted;
        self->changing_s = self->change_s[self->shown][wanted];
        self->remaining_s = self->changing_s;
    }
}

/* Of lanes that others share, who goes until the first one who gives way is at the head: one in 1 / share does. */
static float unhindered(const elmopp_future_t *self, uint32_t movement) {
    const float share = elmopp_sight_yielding_share(self->sight, movement);
    return (float)self->junction->movement[movement].lanes * ((1.0F - share) / share);
}

static void show_target(elmopp_future_t *self, uint32_t step) {
    const elmopp_stage_t target = self->target;
    const uint32_t yields = self->sight->yields[target];
    for (uint32_t i = 0U; i < self->served_count[target]; i++) {
        const uint32_t j = self->served[target][i];
        const bool stays = elmopp_mask_has(self->sight->serves[self->shown], j);
        if (yields != 0U) {
            const bool begins = elmopp_mask_has(yields, j) && (!stays);
            self->unhindered_veh[j] = begins ? unhindered(self, j) : 0.0F;
        }
        self->startup_s[j] = stays ? 0.0F : ((float)self->junction->movement[j].startup_ds / DS_PER_S);
        if ((!stays) && (self->sight->options.travel_s[j] > 0U)) {
            self->stopped_veh += standing(self, step, j);
        }
    }
    self->flow_veh_per_s = self->sight->flow_veh_per_s[target];
    self->shown = target;
    self->looked = false;
    self->target = ELMOPP_STAGE_NONE;
    self->elapsed_s = 0U;
}

/* Flow of a movement of the stage shown, of which `amber_share` is left if the movement ends. */
static float open_flow(const elmopp_future_t *self, uint32_t movement, float queue_veh, float amber_share) {
    float flow = flow_of(self, self->flow_veh_per_s, movement, queue_veh);
    if (self->target != ELMOPP_STAGE_NONE) {
        const bool stays = elmopp_mask_has(self->sight->serves[self->target], movement);
        const float *next = self->sight->flow_veh_per_s[self->target];
        flow = stays ? elmopp_lesser(flow, flow_of(self, next, movement, queue_veh)) : (flow * amber_share);
    }
    return flow;
}

/* Vehicles a second of a movement that reach the line from second `step` on. */
static float coming(const elmopp_future_t *self, uint32_t step, uint32_t movement) {
    const uint32_t ends = step + GAP_WINDOW_S;
    const uint32_t horizon_s = self->coming->options.horizon_s;
    const uint32_t until = (ends < horizon_s) ? ends : horizon_s;
    const uint32_t span_s = until - step;
    return (self->coming->arrived_veh[until][movement] - self->coming->arrived_veh[step][movement]) / (float)span_s;
}

/* What is left of a flow of a movement that gives way: nothing while a queue of those who go first stands. A queue that
   gives way itself goes when it can: of those only who need not give way count. */
static float flow_through_gaps(const elmopp_future_t *self, uint32_t step, uint32_t movement, float flow) {
    if (self->unhindered_veh[movement] > 0.0F) {
        return flow;
    }
    const uint32_t serves = self->sight->serves[self->shown];
    const uint32_t yields = self->sight->yields[self->shown];
    float opposing = 0.0F;
    float queue_veh = 0.0F;
    for (uint32_t i = 0U; i < self->foe_count[movement]; i++) {
        const uint32_t f = self->foe[movement][i];
        if (elmopp_mask_has(serves, f)) {
            const float left_veh = self->coming->arrived_veh[step][f] - self->left_before_veh[f];
            opposing += elmopp_sight_first_share(self->sight, self->shown, f) * coming(self, step, f);
            queue_veh += elmopp_mask_has(yields, f) ? 0.0F : elmopp_greater(left_veh, 0.0F);
        }
    }
    const float open = elmopp_greater(1.0F - queue_veh, 0.0F);
    return (open > 0.0F) ? (open * elmopp_sight_through(self->sight, movement, flow, opposing)) : 0.0F;
}

/* One second of departures. Who is seen to reach the line in this second may pass in it; without a reach he is counted
   first, and goes in the next one at the earliest. */
static void let_go(elmopp_future_t *self, uint32_t step) {
    const uint32_t since_s = self->changing_s - self->remaining_s;
    const float changing_s = (float)since_s;
    const float amber_share = elmopp_lesser(elmopp_greater(self->options.yellow_used_s - changing_s, 0.0F), 1.0F);
    const uint8_t *served = self->served[self->shown];
    const uint32_t count = self->served_count[self->shown];
    const uint32_t yields = self->sight->yields[self->shown];
    if (yields != 0U) {
        (void)memcpy(self->left_before_veh, self->left_veh, sizeof self->left_veh);
    }
    for (uint32_t i = 0U; i < count; i++) {
        const uint32_t j = served[i];
        const float lost_s = self->startup_s[j];
        if (lost_s >= 1.0F) {
            self->startup_s[j] = lost_s - 1.0F;
        } else {
            const uint32_t there = step + ((self->sight->options.travel_s[j] > 0U) ? 1U : 0U);
            const float queue_veh = standing(self, there, j);
            const float open = open_flow(self, j, queue_veh, amber_share);
            const bool waits = (yields != 0U) && elmopp_mask_has(yields, j);
            const float flow = waits ? flow_through_gaps(self, step, j, open) : open;
            const float leaving_veh = elmopp_lesser(flow * (1.0F - lost_s), queue_veh);
            self->startup_s[j] = 0.0F;
            self->left_veh[j] += leaving_veh;
            self->left_sum_veh += leaving_veh;
            if (waits) {
                self->unhindered_veh[j] -= leaving_veh;
            }
        }
    }
}

static void play_second(elmopp_future_t *self, const elmopp_future_action_t *action, uint32_t step) {
    if (self->target == ELMOPP_STAGE_NONE) {
        begin_change(self, wish(self, action, step));
    }
    if ((self->target != ELMOPP_STAGE_NONE) && (self->remaining_s == 0U)) {
        show_target(self, step);
    }
    let_go(self, step);
    if (self->target == ELMOPP_STAGE_NONE) {
        self->elapsed_s++;
    } else {
        self->remaining_s--;
    }
}

/* What is left at the horizon, cleared movement by movement and at once: x at flow s takes x / s, the mean x / 2. Who
   can never go is the same in every future. */
static float cost_of_rest(const elmopp_future_t *self, uint32_t horizon_s) {
    float cost = 0.0F;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const float left_veh = standing(self, horizon_s, j);
        const float flow = self->sight->site_veh_per_s[j];
        cost += (flow > 0.0F) ? ((left_veh * left_veh) / (2.0F * flow)) : 0.0F;
    }
    return cost;
}

static void start(elmopp_future_t *self) {
    self->flow_veh_per_s = self->present_flow_veh_per_s;
    self->left_sum_veh = 0.0F;
    self->stopped_veh = 0.0F;
    self->looked = false;
    self->elapsed_s = self->present_s;
    self->changing_s = 0U;
    self->remaining_s = 0U;
    self->shown = self->present;
    self->target = ELMOPP_STAGE_NONE;
    for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
        self->left_veh[j] = 0.0F;
        self->startup_s[j] = 0.0F;
        self->unhindered_veh[j] = 0.0F;
    }
}

float elmopp_future_cost(elmopp_future_t *self, const elmopp_future_action_t *action) {
    const uint32_t horizon_s = self->coming->options.horizon_s;
    start(self);
    float cost = 0.0F;
    for (uint32_t k = 0U; k < horizon_s; k++) {
        play_second(self, action, k);
        cost += elmopp_greater(self->coming->arrived_sum_veh[k + 1U] - self->left_sum_veh, 0.0F);
    }
    return cost + (self->options.stop_s * self->stopped_veh) + cost_of_rest(self, horizon_s);
}
