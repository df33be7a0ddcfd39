/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/forecast.h"

#include "elmopp/assert.h"
#include "elmopp/elementary.h"

#include <stddef.h>
#include <string.h>

/* Sums a value of each movement over its approach, in the order of the movements. */
static void sum_by_approach(const elmopp_junction_t *junction, const float *value, float sum[ELMOPP_APPROACH_MAX]) {
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        sum[i] = 0.0F;
    }
    for (uint32_t j = 0U; j < junction->movement_count; j++) {
        sum[junction->movement[j].approach] += value[j];
    }
}

static float equal_share(const elmopp_junction_t *junction, uint32_t approach) {
    uint32_t count = 0U;
    for (uint32_t j = 0U; j < junction->movement_count; j++) {
        count += (junction->movement[j].approach == approach) ? 1U : 0U;
    }
    return 1.0F / (float)count;
}

static void update_shares(elmopp_forecast_t *self) {
    float sum_veh[ELMOPP_APPROACH_MAX];
    sum_by_approach(self->junction, self->movement_mean_veh, sum_veh);
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const uint32_t i = self->junction->movement[j].approach;
        const bool known = (self->seen_s >= ELMOPP_FORECAST_SHARE_MIN_S) && (sum_veh[i] > 0.0F);
        self->share[j] = known ? (self->movement_mean_veh[j] / sum_veh[i]) : equal_share(self->junction, i);
    }
}

bool elmopp_forecast_is_nested(uint8_t kind) {
    return (kind == (uint8_t)ELMOPP_FORECAST_NLSTM) || (kind == (uint8_t)ELMOPP_FORECAST_NLSTM_Q15);
}

static bool is_q15(uint8_t kind) {
    return (kind == (uint8_t)ELMOPP_FORECAST_LSTM_Q15) || (kind == (uint8_t)ELMOPP_FORECAST_NLSTM_Q15);
}

static bool is_recurrent(uint8_t kind) {
    return (kind == (uint8_t)ELMOPP_FORECAST_LSTM) || is_q15(kind) || elmopp_forecast_is_nested(kind);
}

bool elmopp_forecast_is_network(uint8_t kind) {
    return is_recurrent(kind) || (kind == (uint8_t)ELMOPP_FORECAST_ANN) || (kind == (uint8_t)ELMOPP_FORECAST_GCN);
}

bool elmopp_forecast_fits(uint8_t kind, const elmopp_weights_t *weights) {
    if ((!elmopp_forecast_is_network(kind)) || (weights == NULL) ||
        (elmopp_weights_check(weights) != ELMOPP_WEIGHTS_OK)) {
        return false;
    }
    const bool nested = weights->lstm.levels > 1U;
    if (is_recurrent(kind) && (nested != elmopp_forecast_is_nested(kind))) {
        return false;
    }
    return (!is_q15(kind)) || elmopp_forecast_quantized(weights).made;
}

/* An input without an approach is 0, whatever the clamp. */
static const float least_input[ELMOPP_LSTM_INPUTS] = {0.0F, 0.0F, 0.0F, 0.0F};

elmopp_lstm_quantized_t elmopp_forecast_quantized(const elmopp_weights_t *weights) {
    return elmopp_lstm_quantize_check(&weights->lstm, least_input, weights->high);
}

/* Looks whether the weights can be used; in whole numbers it keeps what is made of them. */
static void arm(elmopp_forecast_t *self) {
    const elmopp_weights_t *weights = self->config.weights;
    self->armed = elmopp_forecast_fits(self->config.kind, weights);
    if (self->armed && is_q15(self->config.kind)) {
        (void)elmopp_lstm_quantize(&weights->lstm, least_input, weights->high, &self->q15);
    }
}

/* The signal groups of an approach, and those that conflict with one of them. */
static uint32_t groups_of(const elmopp_junction_t *junction, uint32_t approach) {
    uint32_t groups = 0U;
    for (uint32_t j = 0U; j < junction->movement_count; j++) {
        groups |= (junction->movement[j].approach == approach) ? junction->movement[j].groups : 0U;
    }
    return groups;
}

static uint32_t conflicts_of(const elmopp_junction_t *junction, uint32_t approach) {
    const uint32_t own = groups_of(junction, approach);
    uint32_t groups = 0U;
    for (uint32_t g = 0U; g < junction->group_count; g++) {
        groups |= elmopp_mask_has(own, g) ? junction->conflict[g] : 0U;
    }
    return groups;
}

/* The graph of the approaches: joined are those that meet. */
static void join_approaches(elmopp_gcn_f32_graph_t *graph, const elmopp_junction_t *junction) {
    uint8_t joined[ELMOPP_GCN_NODES_MAX];
    for (uint32_t a = 0U; a < ELMOPP_GCN_NODES_MAX; a++) {
        const uint32_t against = conflicts_of(junction, a);
        uint32_t mask = 0U;
        for (uint32_t b = 0U; b < junction->approach_count; b++) {
            mask |= ((against & groups_of(junction, b)) != 0U) ? ((uint32_t)1U << b) : 0U;
        }
        joined[a] = (uint8_t)mask;
    }
    elmopp_gcn_f32_join(graph, junction->approach_count, joined);
}

void elmopp_forecast_init(elmopp_forecast_t *self, const elmopp_junction_t *junction,
                          const elmopp_forecast_config_t *config) {
    ELMOPP_ASSERT(config->kind < (uint8_t)ELMOPP_FORECAST_COUNT);
    ELMOPP_ASSERT((config->kind != (uint8_t)ELMOPP_FORECAST_AR8) || (config->ar8 != NULL));
    ELMOPP_ASSERT((config->learner == NULL) || (config->learner->shipped == config->weights));
    *self = (elmopp_forecast_t){.config = *config, .junction = junction};
    arm(self);
    join_approaches(&self->graph, junction);
    update_shares(self);
}

void elmopp_forecast_rearm(elmopp_forecast_t *self, const elmopp_weights_t *weights, bool anew) {
    elmopp_learner_t *learner = self->config.learner;
    self->config.weights = weights;
    self->said_s = 0U; /* what the old weights have begun to foresee, the new ones do not carry on */
    arm(self);
    if ((learner != NULL) && self->armed && anew) {
        elmopp_learner_begin(learner, weights);
    } else if (learner != NULL) {
        elmopp_learner_move(learner, weights);
    } else {
        /* nobody learns */
    }
    if (anew) {
        (void)memset(self->memory, 0, sizeof self->memory);
        (void)memset(self->whole_memory, 0, sizeof self->whole_memory);
    }
}

static float scale_of(const elmopp_forecast_t *self, uint32_t approach) {
    return (self->config.mean_veh_per_s != NULL) ? self->config.mean_veh_per_s[approach] : self->mean_veh[approach];
}

static uint32_t group_count(const elmopp_forecast_t *self) {
    return (self->junction->approach_count + ELMOPP_FORECAST_GROUP_SIZE - 1U) / ELMOPP_FORECAST_GROUP_SIZE;
}

/* Only what is in floats learns. */
static elmopp_learner_t *learner_of(const elmopp_forecast_t *self) {
    const bool learns = is_recurrent(self->config.kind) && (!is_q15(self->config.kind));
    return (self->armed && learns) ? self->config.learner : NULL;
}

/* What a group's network is fed of this second, and what came of it: of whole vehicles another number. Inputs without
   an approach, or without any demand, stay 0. */
static void see_second(const elmopp_forecast_t *self, const float came_veh[ELMOPP_APPROACH_MAX], uint32_t group,
                       elmopp_learner_second_t *second) {
    const elmopp_weights_t *weights = self->config.weights;
    for (uint32_t k = 0U; k < ELMOPP_FORECAST_GROUP_SIZE; k++) {
        const uint32_t approach = (group * ELMOPP_FORECAST_GROUP_SIZE) + k;
        const float scale_veh = (approach < self->junction->approach_count) ? scale_of(self, approach) : 0.0F;
        if (scale_veh > 0.0F) {
            const float fed = elmopp_within(self->last_veh[approach][0] / scale_veh, weights->low[k], weights->high[k]);
            second->input[group][k] = fed;
            second->came[group][k] = self->config.whole ? (came_veh[approach] / scale_veh) : fed;
        }
    }
}

static void remember(elmopp_forecast_t *self, const float came_veh[ELMOPP_APPROACH_MAX]) {
    elmopp_learner_second_t second;
    (void)memset(&second, 0, sizeof second);
    for (uint32_t group = 0U; group < group_count(self); group++) {
        see_second(self, came_veh, group, &second);
        if (is_q15(self->config.kind)) {
            elmopp_lstm_q15_step(&self->q15, &self->whole_memory[group], second.input[group]);
        } else {
            elmopp_lstm_f32_step(&self->config.weights->lstm, &self->memory[group], second.input[group]);
        }
    }
    elmopp_learner_t *learner = learner_of(self);
    if (learner != NULL) {
        elmopp_learner_see(learner, &second);
    }
}

void elmopp_forecast_learn(elmopp_forecast_t *self) {
    elmopp_learner_t *learner = learner_of(self);
    if (learner != NULL) {
        elmopp_learner_work(learner, self->memory);
    }
}

bool elmopp_forecast_is_learnt(const elmopp_forecast_t *self) {
    const elmopp_learner_t *learner = learner_of(self);
    return (learner != NULL) && elmopp_learner_is_in_use(learner);
}

static bool is_observer(const elmopp_forecast_t *self) {
    return self->config.whole && self->armed;
}

/* What is believed to have come in this second; below, behind what a network says of it. */
static void believe(elmopp_forecast_t *self, const float came_veh[ELMOPP_APPROACH_MAX],
                    float believed_veh[ELMOPP_APPROACH_MAX]);

static void put_down(elmopp_forecast_t *self, const float believed_veh[ELMOPP_APPROACH_MAX]) {
    for (uint32_t i = 0U; i < self->junction->approach_count; i++) {
        for (uint32_t lag = ELMOPP_FORECAST_PAST_S - 1U; lag > 0U; lag--) {
            self->last_veh[i][lag] = self->last_veh[i][lag - 1U];
        }
        self->last_veh[i][0] = believed_veh[i];
    }
}

void elmopp_forecast_observe(elmopp_forecast_t *self, const float *arrivals_veh) {
    self->seen_s += (self->seen_s < UINT32_MAX) ? 1U : 0U;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        elmopp_average(&self->movement_mean_veh[j], arrivals_veh[j], self->seen_s, ELMOPP_FORECAST_MEAN_WINDOW_S);
    }
    float came_veh[ELMOPP_APPROACH_MAX];
    sum_by_approach(self->junction, arrivals_veh, came_veh);
    for (uint32_t i = 0U; i < self->junction->approach_count; i++) {
        elmopp_average(&self->mean_veh[i], came_veh[i], self->seen_s, ELMOPP_FORECAST_MEAN_WINDOW_S);
        elmopp_average(&self->ewma_veh[i], came_veh[i], self->seen_s, ELMOPP_FORECAST_EWMA_WINDOW_S);
    }
    update_shares(self);
    float believed_veh[ELMOPP_APPROACH_MAX];
    believe(self, came_veh, believed_veh);
    put_down(self, believed_veh);
    elmopp_account_settle(&self->account, came_veh, self->junction->approach_count);
    if (self->armed && is_recurrent(self->config.kind)) {
        remember(self, came_veh);
    }
}

elmopp_forecast_status_t elmopp_forecast_status(const elmopp_forecast_t *self) {
    if (elmopp_forecast_is_network(self->config.kind)) {
        const elmopp_forecast_status_t armed =
            (self->seen_s < ELMOPP_FORECAST_COLD_S) ? ELMOPP_FORECAST_COLD : ELMOPP_FORECAST_READY;
        return self->armed ? armed : ELMOPP_FORECAST_UNARMED;
    }
    const bool short_of_lags = (self->config.kind == (uint8_t)ELMOPP_FORECAST_AR8) && (self->seen_s < ELMOPP_AR8_LAGS);
    return short_of_lags ? ELMOPP_FORECAST_COLD : ELMOPP_FORECAST_READY;
}

elmopp_account_error_t elmopp_forecast_error(const elmopp_forecast_t *self) {
    return self->account.error;
}

static void fill_constant(elmopp_forecast_t *self, uint32_t approach, float value_veh, uint32_t steps) {
    for (uint32_t t = 0U; t < steps; t++) {
        self->row_veh[approach][t] = value_veh;
    }
}

static void fill_with_regression(elmopp_forecast_t *self, uint32_t approach, uint32_t steps) {
    const float scale_veh = scale_of(self, approach);
    if (scale_veh <= 0.0F) {
        fill_constant(self, approach, 0.0F, steps);
        return;
    }
    float last[ELMOPP_AR8_LAGS];
    for (uint32_t k = 0U; k < ELMOPP_AR8_LAGS; k++) {
        last[k] = self->last_veh[approach][k] / scale_veh;
    }
    elmopp_ar8_roll_out(&self->config.ar8[approach], last, self->row_veh[approach], steps);
    for (uint32_t t = 0U; t < steps; t++) {
        self->row_veh[approach][t] *= scale_veh;
    }
}

static elmopp_lstm_f32_net_t net_in_use(const elmopp_forecast_t *self) {
    return elmopp_forecast_is_learnt(self) ? elmopp_trainer_net(&self->config.learner->trainer)
                                           : elmopp_lstm_f32_net(&self->config.weights->lstm);
}

static void begin_run(elmopp_forecast_t *self, uint32_t group) {
    self->run.f32[group] = elmopp_forecast_is_learnt(self) ? self->config.learner->memory[group] : self->memory[group];
    self->run.q15[group] = self->whole_memory[group];
}

/* One second of a recurrent network on its own output, in the arithmetic of the kind: it is fed what it said, unless
   nothing has been said yet, and says what comes next. */
static void run_on(elmopp_forecast_t *self, const elmopp_lstm_f32_net_t *net, uint32_t group, bool fed) {
    elmopp_forecast_run_t *run = &self->run;
    if (is_q15(self->config.kind)) {
        if (fed) {
            elmopp_lstm_q15_step(&self->q15, &run->q15[group], run->said[group]);
        }
        elmopp_lstm_q15_output(&self->q15, &run->q15[group], run->said[group]);
    } else {
        if (fed) {
            elmopp_lstm_f32_net_step(net, &run->f32[group], run->said[group]);
        }
        elmopp_lstm_f32_net_output(net, &run->f32[group], run->said[group]);
    }
}

/* Runs one group's recurrent network on its own output, from a copy of its memory. */
static void fill_from_memory(elmopp_forecast_t *self, uint32_t group, uint32_t from, uint32_t steps) {
    const elmopp_weights_t *weights = self->config.weights;
    const elmopp_lstm_f32_net_t net = net_in_use(self);
    float *said = self->run.said[group];
    if (from == 0U) {
        begin_run(self, group);
    }
    for (uint32_t t = from; t < steps; t++) {
        run_on(self, &net, group, t > 0U);
        for (uint32_t k = 0U; k < ELMOPP_FORECAST_GROUP_SIZE; k++) {
            const uint32_t approach = (group * ELMOPP_FORECAST_GROUP_SIZE) + k;
            if (approach < self->junction->approach_count) {
                said[k] = elmopp_within(said[k], weights->low[k], weights->high[k]);
                self->row_veh[approach][t] = said[k] * scale_of(self, approach);
            } else {
                said[k] = 0.0F;
            }
        }
    }
}

/* What a network that sees windows may see and say of an approach, in units of the demand scale. */
static float held_for(const elmopp_forecast_t *self, uint32_t approach, float value) {
    const elmopp_weights_t *weights = self->config.weights;
    const uint32_t k = approach % ELMOPP_FORECAST_GROUP_SIZE;
    return (self->config.kind == (uint8_t)ELMOPP_FORECAST_GCN)
               ? elmopp_within(value, weights->ar8.low, weights->ar8.high)
               : elmopp_within(value, weights->low[k], weights->high[k]);
}

/* The windows of all approaches, oldest second first. Those without an approach, or without any demand, are 0. */
static void open_windows(const elmopp_forecast_t *self, float past[ELMOPP_APPROACH_MAX][ELMOPP_FORECAST_PAST_S]) {
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        const float scale_veh = (i < self->junction->approach_count) ? scale_of(self, i) : 0.0F;
        for (uint32_t k = 0U; k < ELMOPP_FORECAST_PAST_S; k++) {
            const float came_veh = self->last_veh[i][(ELMOPP_FORECAST_PAST_S - 1U) - k];
            past[i][k] = (scale_veh > 0.0F) ? held_for(self, i, came_veh / scale_veh) : 0.0F;
        }
    }
}

/* The next second of every approach, by the network that the kind names. The plain one sees the newest seconds only. */
static void say_next(const elmopp_forecast_t *self, const float *const past[ELMOPP_APPROACH_MAX],
                     float next[ELMOPP_APPROACH_MAX]) {
    const elmopp_weights_t *weights = self->config.weights;
    if (self->config.kind == (uint8_t)ELMOPP_FORECAST_GCN) {
        elmopp_gcn_f32_next(&weights->gcn, &self->graph, past, next);
        return;
    }
    const float *newest[ELMOPP_APPROACH_MAX];
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        newest[i] = &past[i][ELMOPP_FORECAST_PAST_S - ELMOPP_ANN_WINDOW_S];
    }
    for (uint32_t group = 0U; group < group_count(self); group++) {
        const uint32_t first = group * ELMOPP_FORECAST_GROUP_SIZE;
        elmopp_ann_f32_next(&weights->ann, &newest[first], &next[first]);
    }
}

/* What the network in use says of the second after those that it has seen, in units of the demand scale. */
static void say_second(elmopp_forecast_t *self, float said[ELMOPP_APPROACH_MAX]) {
    if (is_recurrent(self->config.kind)) {
        const elmopp_lstm_f32_net_t net = net_in_use(self);
        for (uint32_t group = 0U; group < group_count(self); group++) {
            begin_run(self, group);
            run_on(self, &net, group, false);
            (void)memcpy(&said[group * ELMOPP_FORECAST_GROUP_SIZE], self->run.said[group],
                         sizeof self->run.said[group]);
        }
        return;
    }
    const float *window[ELMOPP_APPROACH_MAX];
    open_windows(self, self->run.past);
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        window[i] = self->run.past[i];
    }
    say_next(self, window, said);
}

/* A count tells of one second only, and coarsely; what the network says of it goes by all seconds before. In the first
 * ones it has seen too little to say anything. */
static void believe(elmopp_forecast_t *self, const float came_veh[ELMOPP_APPROACH_MAX],
                    float believed_veh[ELMOPP_APPROACH_MAX]) {
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        believed_veh[i] = came_veh[i];
    }
    if (!is_observer(self)) {
        return;
    }
    const float least = is_recurrent(self->config.kind) ? ELMOPP_FORECAST_GAIN : ELMOPP_FORECAST_WINDOW_GAIN;
    const float gain = elmopp_greater(least, 1.0F / (float)self->seen_s);
    float said[ELMOPP_APPROACH_MAX];
    say_second(self, said);
    for (uint32_t i = 0U; i < self->junction->approach_count; i++) {
        const float said_veh = held_for(self, i, said[i]) * scale_of(self, i);
        believed_veh[i] = said_veh + (gain * (came_veh[i] - said_veh));
    }
}

/* Runs a network that sees windows on its own output: what it says is the windows' next second. */
static void fill_from_windows(elmopp_forecast_t *self, uint32_t from, uint32_t steps) {
    const float *window[ELMOPP_APPROACH_MAX];
    float next[ELMOPP_APPROACH_MAX];
    if (from == 0U) {
        open_windows(self, self->run.past);
    }
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        window[i] = self->run.past[i];
    }
    for (uint32_t t = from; t < steps; t++) {
        say_next(self, window, next);
        for (uint32_t i = 0U; i < self->junction->approach_count; i++) {
            float *past = self->run.past[i];
            const float held = held_for(self, i, next[i]);
            self->row_veh[i][t] = held * scale_of(self, i);
            for (uint32_t k = 1U; k < ELMOPP_FORECAST_PAST_S; k++) {
                past[k - 1U] = past[k];
            }
            past[ELMOPP_FORECAST_PAST_S - 1U] = held;
        }
    }
}

static void fill_by_approach(elmopp_forecast_t *self, uint32_t approach, uint32_t steps) {
    switch (self->config.kind) {
    case ELMOPP_FORECAST_AR8:
        fill_with_regression(self, approach, steps);
        break;
    case ELMOPP_FORECAST_PERSISTENCE:
        fill_constant(self, approach, self->last_veh[approach][0], steps);
        break;
    case ELMOPP_FORECAST_EWMA:
        fill_constant(self, approach, self->ewma_veh[approach], steps);
        break;
    default:
        fill_constant(self, approach, scale_of(self, approach), steps);
        break;
    }
}

static void fill_with_mean(elmopp_forecast_t *self, uint32_t steps) {
    for (uint32_t i = 0U; i < self->junction->approach_count; i++) {
        fill_constant(self, i, scale_of(self, i), steps);
    }
}

/* The rows from one step on. What is no network's is said anew from the first. */
static void fill_rows(elmopp_forecast_t *self, uint32_t from, uint32_t steps) {
    if (elmopp_forecast_status(self) != ELMOPP_FORECAST_READY) {
        fill_with_mean(self, steps);
    } else if (is_recurrent(self->config.kind)) {
        for (uint32_t group = 0U; group < group_count(self); group++) {
            fill_from_memory(self, group, from, steps);
        }
    } else if (elmopp_forecast_is_network(self->config.kind)) {
        fill_from_windows(self, from, steps);
    } else {
        for (uint32_t i = 0U; i < self->junction->approach_count; i++) {
            fill_by_approach(self, i, steps);
        }
    }
}

/* Enters what is said about the probe's second. */
static void enter(elmopp_forecast_t *self) {
    elmopp_account_probe_t *page = elmopp_account_page(&self->account, ELMOPP_ACCOUNT_PROBE_S);
    for (uint32_t i = 0U; i < self->junction->approach_count; i++) {
        page->forecast_veh[i] = self->row_veh[i][ELMOPP_ACCOUNT_PROBE_S - 1U];
        page->persistence_veh[i] = self->last_veh[i][0];
        page->mean_veh[i] = scale_of(self, i);
    }
    page->said = true;
}

static uint16_t hand_out(const elmopp_forecast_t *self, uint16_t steps, const float *rows[ELMOPP_APPROACH_MAX]) {
    const bool none = self->config.kind == (uint8_t)ELMOPP_FORECAST_NONE;
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        rows[i] = ((!none) && (i < self->junction->approach_count)) ? self->row_veh[i] : NULL;
    }
    return none ? 0U : steps;
}

uint16_t elmopp_forecast_look(elmopp_forecast_t *self, uint16_t steps, const float *rows[ELMOPP_APPROACH_MAX]) {
    ELMOPP_ASSERT(steps <= ELMOPP_HORIZON_MAX);
    if (self->config.kind != (uint8_t)ELMOPP_FORECAST_NONE) {
        fill_rows(self, 0U, steps);
        self->said_s = steps;
        if (steps >= ELMOPP_ACCOUNT_PROBE_S) {
            enter(self);
        }
    }
    return hand_out(self, steps, rows);
}

uint16_t elmopp_forecast_look_on(elmopp_forecast_t *self, uint16_t steps, const float *rows[ELMOPP_APPROACH_MAX]) {
    ELMOPP_ASSERT((steps <= ELMOPP_HORIZON_MAX) && (steps >= self->said_s));
    if (self->config.kind != (uint8_t)ELMOPP_FORECAST_NONE) {
        fill_rows(self, self->said_s, steps);
        self->said_s = steps;
    }
    return hand_out(self, steps, rows);
}

uint16_t elmopp_forecast_fall_back(elmopp_forecast_t *self, uint16_t steps, const float *rows[ELMOPP_APPROACH_MAX]) {
    ELMOPP_ASSERT(steps <= ELMOPP_HORIZON_MAX);
    fill_with_mean(self, steps);
    return hand_out(self, steps, rows);
}

/* What is known of an approach apart from its neighbour: the rows that are there, or nobody; true if there are any. */
static bool keep_row(elmopp_forecast_t *self, uint32_t approach, const float *row, uint16_t length) {
    for (uint32_t t = 0U; t < length; t++) {
        self->row_veh[approach][t] = (row == NULL) ? 0.0F : row[t];
    }
    return row != NULL;
}

static bool anybody_says(const elmopp_forecast_t *self, const elmopp_outflow_t outflow[ELMOPP_APPROACH_MAX]) {
    bool known = false;
    for (uint32_t i = 0U; i < self->junction->approach_count; i++) {
        known = known || elmopp_outflow_is_known(&outflow[i]);
    }
    return known;
}

uint16_t elmopp_forecast_hear(elmopp_forecast_t *self, const elmopp_outflow_t outflow[ELMOPP_APPROACH_MAX],
                              uint16_t asked, uint16_t steps, const float *rows[ELMOPP_APPROACH_MAX]) {
    ELMOPP_ASSERT((asked <= ELMOPP_HORIZON_MAX) && (steps <= ELMOPP_HORIZON_MAX));
    if (!anybody_says(self, outflow)) {
        return steps;
    }
    const uint16_t length = (steps == 0U) ? asked : steps;
    for (uint32_t i = 0U; i < self->junction->approach_count; i++) {
        bool known = keep_row(self, i, (steps == 0U) ? NULL : rows[i], length);
        if (elmopp_outflow_is_known(&outflow[i])) {
            elmopp_outflow_lay(&outflow[i], self->row_veh[i], length);
            known = true;
        }
        rows[i] = known ? self->row_veh[i] : NULL;
    }
    return length;
}

const float *elmopp_forecast_share(const elmopp_forecast_t *self) {
    return self->share;
}
