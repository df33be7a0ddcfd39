/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/future.h"

#include "elmopp/assert.h"
#include "elmopp/elementary.h"

#define DS_PER_S 10.0F
#define GAP_WINDOW_S 5U  /* a gap is looked for so far ahead: the critical one, in whole seconds */
#define NOBODY_VEH 0.01F /* for the rule: less is rounding, and must not call for a change */
#define SLOW_PART                                                                                                      \
    0.25F /* of its flow squared, what the pressure of a short queue is below queue times flow at most                 \
           */

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
    self->learnt = self->junction->discharge == (uint8_t)ELMOPP_DISCHARGE_SATURATION;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        self->look_s[j] = options->look ? sight->options.travel_s[j] : (uint16_t)0U;
        self->looks = self->looks || (self->look_s[j] > 0U);
        list_foes(self, j);
        self->startup_s_of[j] = (float)self->junction->movement[j].startup_ds / DS_PER_S;
    }
    for (uint32_t s = 0U; s < self->junction->stage_count; s++) {
        list_served(self, s);
        for (uint32_t to = 0U; to < self->junction->stage_count; to++) {
            price_change(self, s, to);
        }
    }
}

/* --- a decision --- */

/* What the arrivals of the second before `step` add to queues times flow in a stage. */
static float coming_to(const elmopp_future_t *self, uint32_t stage, uint32_t step) {
    const uint8_t *served = self->served[stage];
    const uint32_t count = self->served_count[stage];
    const float *flow = self->sight->flow_veh_per_s[stage];
    float sum = 0.0F;
    for (uint32_t i = 0U; i < count; i++) {
        const float *arrived_veh = self->coming->arrived_veh[served[i]];
        sum += flow[served[i]] * (arrived_veh[step] - arrived_veh[step - 1U]);
    }
    return sum;
}

/* What a second's departures take from queues times flow in a stage. */
static float square_of(const elmopp_future_t *self, uint32_t stage) {
    const float *flow = self->sight->flow_veh_per_s[stage];
    float sum = 0.0F;
    for (uint32_t i = 0U; i < self->served_count[stage]; i++) {
        const uint32_t j = self->served[stage][i];
        sum += flow[j] * flow[j];
    }
    return sum;
}

/* What arrivals add to queues times flow until each step, in no stage more, and in a second of each stage at least. */
static void expect_growth(elmopp_future_t *self) {
    const uint32_t stages = self->junction->stage_count;
    const uint32_t horizon_s = self->coming->options.horizon_s;
    for (uint32_t s = 0U; s < stages; s++) {
        self->square[s] = square_of(self, s);
        self->calm[s] = coming_to(self, s, 1U);
    }
    self->come[0] = 0.0F;
    self->rush = 0.0F;
    float most = 0.0F;
    for (uint32_t k = 1U; k <= horizon_s; k++) {
        /* Later as many come as in the second before, but for roundings. */
        if (k <= (self->coming->even_step + 1U)) {
            most = 0.0F;
            for (uint32_t s = 0U; s < stages; s++) {
                const float more = coming_to(self, s, k);
                most = elmopp_greater(more, most);
                self->calm[s] = elmopp_lesser(more, self->calm[s]);
            }
        }
        self->come[k] = self->come[k - 1U] + most;
        self->rush = elmopp_greater(most, self->rush);
    }
}

void elmopp_future_begin(elmopp_future_t *self, elmopp_stage_t shown, uint32_t elapsed_s) {
    self->present = shown;
    self->present_s = elapsed_s;
    self->present_blocked = false;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const float flow = self->sight->flow_veh_per_s[shown][j];
        const bool blocked = elmopp_sight_is_blocked(self->sight, j);
        self->present_blocked = self->present_blocked || blocked;
        self->present_flow_veh_per_s[j] = blocked ? (self->options.blocked_share * flow) : flow;
    }
    expect_growth(self);
}

/* --- one future --- */

/* Flow of a movement that is green: as learnt, or by the law of the junction's profile. */
static float flow_of(const elmopp_future_t *self, const float *flow_veh_per_s, uint32_t movement, float queue_veh) {
    return self->learnt ? flow_veh_per_s[movement] : elmopp_junction_discharge(self->junction, movement, queue_veh);
}

/* Queue of a movement before second `step`. */
static float standing(const elmopp_future_t *self, uint32_t step, uint32_t movement) {
    return elmopp_greater(self->coming->arrived_veh[movement][step] - self->left_veh[movement], 0.0F);
}

static uint32_t elapsed_s(const elmopp_future_t *self, uint32_t step) {
    return (step - self->shown_step) + self->shown_s;
}

/* --- the reactive rule --- */

/* The queue of a movement before second `step`, as the rule sees it. */
static inline float seen_veh(float arrived_veh, float left_veh) {
    const float standing_veh = arrived_veh - left_veh;
    return (standing_veh >= NOBODY_VEH) ? standing_veh : 0.0F;
}

static float pressure_by_law(const elmopp_future_t *self, uint32_t stage, uint32_t step) {
    float sum = 0.0F;
    for (uint32_t i = 0U; i < self->served_count[stage]; i++) {
        const uint32_t j = self->served[stage][i];
        const float queue_veh = seen_veh(self->coming->arrived_veh[j][step], self->left_veh[j]);
        sum += queue_veh * elmopp_lesser(elmopp_junction_discharge(self->junction, j, queue_veh), queue_veh);
    }
    return sum;
}

/* Queue times flow in second `step`, summed over a stage. */
static float pressure_of(const elmopp_future_t *self, uint32_t stage, const float *flow_veh_per_s, uint32_t step) {
    if (!self->learnt) {
        return pressure_by_law(self, stage, step);
    }
    const float (*arrived_veh)[ELMOPP_HORIZON_MAX + 1U] = self->coming->arrived_veh;
    const float *left_veh = self->left_veh;
    const uint8_t *served = self->served[stage];
    const uint8_t *const end = &served[self->served_count[stage]];
    float sum = 0.0F;
    while (served != end) {
        const uint32_t j = *served;
        const float queue_veh = seen_veh(arrived_veh[j][step], left_veh[j]);
        sum += queue_veh * elmopp_lesser(flow_veh_per_s[j], queue_veh);
        served++;
    }
    return sum;
}

/* Who will drive up to a movement's line in second `step`, as far as more come than come in the mean. */
static float driving_up(const elmopp_future_t *self, uint32_t movement, uint32_t step) {
    const uint32_t horizon_s = self->coming->options.horizon_s;
    const uint32_t ahead = step + self->look_s[movement];
    const uint32_t until = (ahead < horizon_s) ? ahead : horizon_s;
    const uint32_t span_s = until - step;
    const float *arrived_veh = self->coming->arrived_veh[movement];
    const float more_veh =
        (arrived_veh[until] - arrived_veh[step]) - (self->coming->expected_veh_per_s[movement] * (float)span_s);
    return (more_veh >= NOBODY_VEH) ? more_veh : 0.0F;
}

/* Of the stage shown: its queues and who drives up to them. */
static float own_pressure(const elmopp_future_t *self, uint32_t step) {
    if ((!self->looks) || (step >= self->coming->even_step)) {
        return pressure_of(self, self->shown, self->flow_veh_per_s, step); /* no more come than in the mean */
    }
    float sum = 0.0F;
    for (uint32_t i = 0U; i < self->served_count[self->shown]; i++) {
        const uint32_t j = self->served[self->shown][i];
        const float arrived_veh = self->coming->arrived_veh[j][step] + driving_up(self, j, step);
        const float queue_veh = seen_veh(arrived_veh, self->left_veh[j]);
        sum += queue_veh * elmopp_lesser(flow_of(self, self->flow_veh_per_s, j, queue_veh), queue_veh);
    }
    return sum;
}

/* What a pressure can have grown by since the last look, but for 1.001 times itself: queues have grown by arrivals
   alone. What is below a second's flow grows faster at first, which `pressed` has. The rest is more than all roundings.
 */
static float growth(const elmopp_future_t *self, uint32_t step) {
    return (1.001F * (self->come[step] - self->come[self->look_step])) + (1.0e-5F * self->come[step]) + 0.05F;
}

/* No other stage than the one shown presses more in second `step`. */
static float most_possible(const elmopp_future_t *self, uint32_t step) {
    return (1.001F * self->others_pressed) + growth(self, step);
}

/* The stage with the greatest pressure in second `step`, the stage shown, which presses by `own`, if none presses more
   than `enough`. Those that cannot are reckoned with and not looked at. */
static elmopp_stage_t press_most(elmopp_future_t *self, uint32_t step, float own, float enough) {
    const float grown = growth(self, step);
    const uint32_t shown = self->shown;
    const uint32_t stages = self->junction->stage_count;
    const bool looked = self->looked;
    uint32_t best = shown;
    float greatest = enough;
    float others = 0.0F;
    for (uint32_t s = 0U; s < stages; s++) {
        float possible = (1.001F * self->pressed[s]) + grown;
        if ((!looked) || (s == shown) || (possible > greatest)) {
            const float sum = (s == shown) ? own : pressure_of(self, s, self->sight->flow_veh_per_s[s], step);
            possible = sum + (SLOW_PART * self->square[s]);
            best = (sum > greatest) ? s : best;
            greatest = elmopp_greater(sum, greatest);
        }
        self->pressed[s] = possible;
        others = (s != shown) ? elmopp_greater(possible, others) : others;
    }
    self->others_pressed = others;
    self->look_step = step;
    self->looked = self->learnt;
    return (elmopp_stage_t)best;
}

/* For so many seconds after this one the rule keeps the stage shown, whatever is played: nobody can press enough,
   although the own queues leave as fast as they can and the others grow as fast. Again less than all roundings. */
static uint32_t quiet_s(const elmopp_future_t *self, float ratio, uint32_t step, float own) {
    if (!self->looked) {
        return 0U;
    }
    const float square = self->square[self->shown];
    const float least = (0.999F * own) - (SLOW_PART * square) - 0.01F;
    /* `calm` is of the usual flows, and of who arrives in one second, not of who drives up in several. */
    const bool calms = (self->flow_veh_per_s != self->present_flow_veh_per_s) && (!self->looks);
    const float falling = calms ? elmopp_greater(square - self->calm[self->shown], 0.0F) : square;
    const float spare = (ratio * least) - most_possible(self, step);
    const float per_s = (1.001F * ratio * falling) + (1.002F * self->rush) + 0.001F;
    return (uint32_t)elmopp_within(spare / per_s, 0.0F, (float)ELMOPP_HORIZON_MAX);
}

/* The stage that the rule wants shown in second `step`, and until when it need not be asked again. It looks at the
   other stages only when one could press enough. */
static elmopp_stage_t react(elmopp_future_t *self, float ratio, uint32_t step) {
    const uint32_t since_s = elapsed_s(self, step);
    if (since_s < self->options.min_s) {
        self->ask_step = step + (self->options.min_s - since_s);
        return self->shown;
    }
    const bool late = since_s >= self->options.max_s;
    const float own = own_pressure(self, step);
    const float enough = ratio * own;
    elmopp_stage_t wanted = self->shown;
    if (late || (!self->looked) || (most_possible(self, step) > enough)) {
        wanted = press_most(self, step, own, late ? 0.0F : enough);
    }
    if (late) {
        self->ask_step = step + 1U;
    } else {
        const uint32_t quiet = quiet_s(self, ratio, step, own);
        const uint32_t left_s = self->options.max_s - since_s;
        self->ask_step = step + ((quiet < left_s) ? quiet : (left_s - 1U)) + 1U;
    }
    return wanted;
}

static elmopp_stage_t wish(elmopp_future_t *self, const elmopp_future_action_t *action, uint32_t step) {
    if (step == 0U) {
        self->ask_step = (action->hold_s > 0U) ? action->hold_s : 1U;
        return action->first;
    }
    return react(self, action->ratio, step);
}

/* --- changes --- */

static void begin_change(elmopp_future_t *self, elmopp_stage_t wanted, uint32_t step) {
    if (wanted != self->shown) {
        self->target = wanted;
        self->change_step = step;
        self->left_step = (step < self->left_step) ? step : self->left_step;
        self->ready_step = step + self->change_s[self->shown][wanted];
        self->open_until = step;
    }
}

/* Of lanes that others share, who goes until the first one who gives way is at the head: one in 1 / share does. */
static float unhindered(const elmopp_future_t *self, uint32_t movement) {
    const float share = elmopp_sight_yielding_share(self->sight, movement);
    return (float)self->junction->movement[movement].lanes * ((1.0F - share) / share);
}

/* What the other stages press at most, as the last look has it. */
static float others_pressed(const elmopp_future_t *self, uint32_t shown) {
    const uint32_t stages = self->junction->stage_count;
    float most = 0.0F;
    for (uint32_t s = 0U; s < stages; s++) {
        most = (s != shown) ? elmopp_greater(self->pressed[s], most) : most;
    }
    return most;
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
        self->startup_s[j] = stays ? 0.0F : self->startup_s_of[j];
        if ((!stays) && (self->sight->options.travel_s[j] > 0U)) {
            self->stopped_veh += standing(self, step, j);
        }
    }
    /* A queue that is no longer blocked presses more than the last look has seen. */
    self->looked = self->looked && (self->flow_veh_per_s != self->present_flow_veh_per_s);
    self->flow_veh_per_s = self->sight->flow_veh_per_s[target];
    self->shown = target;
    self->shown_step = step;
    self->shown_s = 0U;
    self->others_pressed = others_pressed(self, target);
    self->target = ELMOPP_STAGE_NONE;
    self->ask_step = step + 1U;
    self->open_until = step;
}

/* --- departures --- */

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
    return (self->coming->arrived_veh[movement][until] - self->coming->arrived_veh[movement][step]) / (float)span_s;
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
            opposing += elmopp_sight_first_share(self->sight, self->shown, f) * coming(self, step, f);
            queue_veh += elmopp_mask_has(yields, f) ? 0.0F : standing(self, step, f);
        }
    }
    const float open = elmopp_greater(1.0F - queue_veh, 0.0F);
    return (open > 0.0F) ? (open * elmopp_sight_through(self->sight, movement, flow, opposing)) : 0.0F;
}

/* Of a movement in second `step`, by the queues that stand before anybody leaves. Who is seen to reach the line in this
   second may pass in it; without a reach he is counted first, and goes in the next one at the earliest. */
static void open_lane(elmopp_future_t *self, uint32_t step, uint32_t movement, float amber_share) {
    const uint32_t ahead = (self->sight->options.travel_s[movement] > 0U) ? (uint32_t)1U : (uint32_t)0U;
    const bool waits = elmopp_mask_has(self->sight->yields[self->shown], movement);
    /* A flow that is learnt does not hang on the queue. */
    const float queue_veh = (self->learnt && (!waits)) ? 0.0F : standing(self, step + ahead, movement);
    float flow = open_flow(self, movement, queue_veh, amber_share);
    if (waits) {
        flow = flow_through_gaps(self, step, movement, flow);
    }
    flow *= 1.0F - self->startup_s[movement];
    self->startup_s[movement] = 0.0F;
    if (waits) {
        self->unhindered_veh[movement] -= elmopp_lesser(flow, queue_veh);
    }
    if (flow > 0.0F) {
        self->open[self->open_count] =
            (elmopp_future_open_t){.flow_veh_per_s = flow,
                                   .arrived_veh = &self->coming->arrived_veh[movement][ahead],
                                   .left_veh = &self->left_veh[movement]};
        self->open_count++;
    }
}

/* Lists who goes in second `step`, how fast, and until when that holds. */
static void open_lanes(elmopp_future_t *self, uint32_t step) {
    const bool changing = self->target != ELMOPP_STAGE_NONE;
    const uint32_t since_s = step - self->change_step;
    const float changing_s = (float)since_s;
    const float amber_share = elmopp_lesser(elmopp_greater(self->options.yellow_used_s - changing_s, 0.0F), 1.0F);
    bool settled = self->learnt && (self->sight->yields[self->shown] == 0U) && ((!changing) || (amber_share <= 0.0F));
    self->open_count = 0U;
    for (uint32_t i = 0U; i < self->served_count[self->shown]; i++) {
        const uint32_t j = self->served[self->shown][i];
        const float lost_s = self->startup_s[j];
        settled = settled && (lost_s <= 0.0F);
        if (lost_s >= 1.0F) {
            self->startup_s[j] = lost_s - 1.0F;
        } else {
            open_lane(self, step, j, amber_share);
        }
    }
    self->open_until = settled ? self->coming->options.horizon_s : (step + 1U);
}

/* The seconds from `step` to `until`, in which nothing but queues changes. Nearly all of a decision's time goes into
   the inner loop. */
static void let_go(elmopp_future_t *self, uint32_t step, uint32_t until) {
    const elmopp_future_open_t *const end = &self->open[self->open_count];
    const float *arrived_sum_veh = &self->coming->arrived_sum_veh[1];
    float left_sum_veh = self->left_sum_veh;
    float cost = self->cost_veh_s;
    for (uint32_t k = step; k < until; k++) {
        for (const elmopp_future_open_t *open = self->open; open != end; open++) {
            const float left_veh = *open->left_veh;
            const float queue_veh = elmopp_greater(open->arrived_veh[k] - left_veh, 0.0F);
            const float leaving_veh = elmopp_lesser(open->flow_veh_per_s, queue_veh);
            *open->left_veh = left_veh + leaving_veh;
            left_sum_veh += leaving_veh;
        }
        cost += elmopp_greater(arrived_sum_veh[k] - left_sum_veh, 0.0F);
    }
    self->left_sum_veh = left_sum_veh;
    self->cost_veh_s = cost;
}

/* --- the whole --- */

/* Plays second `step` and those after it in which the rule has nothing to say and nobody's flow changes. Returns the
   next one. */
static uint32_t play(elmopp_future_t *self, const elmopp_future_action_t *action, uint32_t step) {
    if ((self->target == ELMOPP_STAGE_NONE) && (step >= self->ask_step)) {
        begin_change(self, wish(self, action, step), step);
    }
    if ((self->target != ELMOPP_STAGE_NONE) && (step >= self->ready_step)) {
        show_target(self, step);
    }
    if (step >= self->open_until) {
        open_lanes(self, step);
    }
    const uint32_t event = (self->target == ELMOPP_STAGE_NONE) ? self->ask_step : self->ready_step;
    const uint32_t until = (event < self->open_until) ? event : self->open_until;
    const uint32_t horizon_s = self->coming->options.horizon_s;
    const uint32_t next = (until < horizon_s) ? until : horizon_s;
    let_go(self, step, next);
    return next;
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
    self->flow_veh_per_s =
        self->present_blocked ? self->present_flow_veh_per_s : self->sight->flow_veh_per_s[self->present];
    self->left_sum_veh = 0.0F;
    self->cost_veh_s = 0.0F;
    self->stopped_veh = 0.0F;
    self->looked = false;
    self->shown = self->present;
    self->shown_step = 0U;
    self->shown_s = self->present_s;
    self->target = ELMOPP_STAGE_NONE;
    self->left_step = self->coming->options.horizon_s;
    self->ask_step = 0U;
    self->open_until = 0U;
    for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
        self->left_veh[j] = 0.0F;
        self->startup_s[j] = 0.0F;
        self->unhindered_veh[j] = 0.0F;
    }
}

float elmopp_future_cost(elmopp_future_t *self, const elmopp_future_action_t *action) {
    const uint32_t horizon_s = self->coming->options.horizon_s;
    start(self);
    uint32_t step = 0U;
    while (step < horizon_s) {
        step = play(self, action, step);
    }
    return self->cost_veh_s + (self->options.stop_s * self->stopped_veh) + cost_of_rest(self, horizon_s);
}
