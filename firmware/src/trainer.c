/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/trainer.h"

#include "elmopp/assert.h"
#include "elmopp/elementary.h"
#include "elmopp/trainer_kernel.h"

#include <assert.h>
#include <stddef.h>
#include <string.h>

#define UNITS ELMOPP_LSTM_UNITS
#define GATES ELMOPP_LSTM_GATES
#define INPUTS ELMOPP_LSTM_INPUTS
#define INNER_MAX (ELMOPP_LSTM_LEVELS_MAX - 1U)

/* Adam as its authors have it: how fast the averages move, and what keeps a divisor from 0. */
#define MEAN_GAIN 0.1F
#define SQUARE_GAIN 0.001F
#define FLOOR 1.0e-16F

/* Sums of squares beyond this are no use: the slopes were not finite, or next to it. */
#define SQUARES_MAX 1.0e30F

static_assert(INPUTS == ELMOPP_TRAINER_KERNEL_OUTPUTS, "the kernel's head is the network's");
static_assert(sizeof(elmopp_trainer_memory_t) ==
                  ((4U * sizeof(elmopp_trainer_plain_t)) + (((ELMOPP_TRAINER_WINDOW * 100U) + UNITS) * sizeof(float))),
              "what the header says that a step takes");

/* What is on its way back from one step to the one before. */
typedef struct {
    float hidden[UNITS];
    float cell[ELMOPP_LSTM_LEVELS_MAX][UNITS];
    float said[INPUTS]; /* by what the later step was fed; 0 if it was fed what came */
} slopes_t;

static void copy_in(elmopp_trainer_t *self, const elmopp_lstm_f32_weights_t *weights) {
    elmopp_trainer_plain_t *plain = &self->memory->weight;
    (void)memcpy(plain->head_bias, weights->head_bias, sizeof plain->head_bias);
    (void)memcpy(plain->head_row, weights->head_row, sizeof plain->head_row);
    plain->outer = weights->outer;
    if (self->inner != NULL) {
        (void)memcpy(self->inner->weight, weights->inner, sizeof self->inner->weight);
    }
}

static void forget_slopes(elmopp_trainer_t *self) {
    (void)memset(&self->memory->slope, 0, sizeof self->memory->slope);
    if (self->inner != NULL) {
        (void)memset(self->inner->slope, 0, sizeof self->inner->slope);
    }
    self->samples = 0U;
}

void elmopp_trainer_reset(elmopp_trainer_t *self, const elmopp_lstm_f32_weights_t *weights) {
    ELMOPP_ASSERT(weights->levels == self->levels);
    copy_in(self, weights);
    forget_slopes(self);
    (void)memset(&self->memory->mean, 0, sizeof self->memory->mean);
    (void)memset(&self->memory->square, 0, sizeof self->memory->square);
    if (self->inner != NULL) {
        (void)memset(self->inner->mean, 0, sizeof self->inner->mean);
        (void)memset(self->inner->square, 0, sizeof self->inner->square);
    }
    self->mean_left = 1.0F;
    self->square_left = 1.0F;
}

void elmopp_trainer_init(elmopp_trainer_t *self, elmopp_trainer_memory_t *memory, elmopp_trainer_inner_memory_t *inner,
                         const elmopp_lstm_f32_weights_t *weights) {
    ELMOPP_ASSERT((weights->levels >= 1U) && (weights->levels <= ELMOPP_LSTM_LEVELS_MAX));
    ELMOPP_ASSERT((memory != NULL) && ((weights->levels == 1U) || (inner != NULL)));
    *self = (elmopp_trainer_t){
        .memory = memory, .inner = (weights->levels == 1U) ? NULL : inner, .levels = weights->levels};
    elmopp_trainer_reset(self, weights);
}

elmopp_lstm_f32_net_t elmopp_trainer_net(const elmopp_trainer_t *self) {
    const elmopp_trainer_plain_t *plain = &self->memory->weight;
    const elmopp_lstm_f32_net_t net = {.levels = self->levels,
                                       .head_bias = plain->head_bias,
                                       .head_row = plain->head_row,
                                       .outer = &plain->outer,
                                       .inner = (self->inner != NULL) ? self->inner->weight : NULL};
    return net;
}

void elmopp_trainer_copy(const elmopp_trainer_t *self, elmopp_lstm_f32_weights_t *out) {
    const elmopp_trainer_plain_t *plain = &self->memory->weight;
    out->levels = self->levels;
    (void)memcpy(out->head_bias, plain->head_bias, sizeof out->head_bias);
    (void)memcpy(out->head_row, plain->head_row, sizeof out->head_row);
    out->outer = plain->outer;
    if (self->inner != NULL) {
        (void)memcpy(out->inner, self->inner->weight, sizeof out->inner);
    } else {
        (void)memset(out->inner, 0, sizeof out->inner);
    }
}

/* --- the way forth --- */

static elmopp_trainer_tape_t *tape_of(const elmopp_trainer_t *self, uint32_t level) {
    ELMOPP_ASSERT((level == 0U) || ((level < ELMOPP_LSTM_LEVELS_MAX) && (self->inner != NULL)));
    return (level == 0U) ? &self->memory->tape : &self->inner->tape[level - 1U];
}

/* Levels that there are not get the outermost one's place and are not touched. */
static void places_of_gates(const elmopp_trainer_t *self, uint32_t t, float *gate[ELMOPP_LSTM_LEVELS_MAX]) {
    for (uint32_t level = 0U; level < ELMOPP_LSTM_LEVELS_MAX; level++) {
        gate[level] = tape_of(self, (level < self->levels) ? level : 0U)->gate[t];
    }
}

static void keep_state(const elmopp_trainer_t *self, uint32_t t, const elmopp_lstm_f32_state_t *state) {
    (void)memcpy(self->memory->hidden[t + 1U], state->hidden, sizeof state->hidden);
    for (uint32_t level = 0U; level < ELMOPP_LSTM_LEVELS_MAX; level++) {
        if (level < self->levels) {
            (void)memcpy(tape_of(self, level)->cell[t], state->cell[level], sizeof state->cell[level]);
        }
    }
}

static void run_forth(const elmopp_trainer_t *self, const elmopp_trainer_sample_t *sample) {
    const elmopp_lstm_f32_net_t net = elmopp_trainer_net(self);
    elmopp_trainer_memory_t *memory = self->memory;
    elmopp_lstm_f32_state_t state;
    state = *sample->before;
    (void)memcpy(memory->hidden[0], state.hidden, sizeof state.hidden);
    for (uint32_t t = 0U; t < sample->steps; t++) {
        float *gate[ELMOPP_LSTM_LEVELS_MAX];
        places_of_gates(self, t, gate);
        elmopp_lstm_f32_trace(&net, &state, (t < sample->fed) ? sample->seen[t] : memory->said[t - 1U], gate);
        keep_state(self, t, &state);
        elmopp_lstm_f32_net_output(&net, &state, memory->said[t]);
        for (uint32_t k = 0U; k < INPUTS; k++) {
            const float held = elmopp_within(memory->said[t][k], sample->low[k], sample->high[k]);
            memory->said[t][k] = (k < sample->inputs) ? held : 0.0F;
        }
    }
}

/* --- the way back --- */

static const float *cell_before(const elmopp_trainer_t *self, const elmopp_trainer_sample_t *sample, uint32_t level,
                                uint32_t t) {
    ELMOPP_ASSERT(level < ELMOPP_LSTM_LEVELS_MAX);
    return (t == 0U) ? sample->before->cell[level] : tape_of(self, level)->cell[t - 1U];
}

/* Through the head of step t: returns the squared errors of what it said. `gain` makes a mean of squares of them. */
static float answer_for(const elmopp_trainer_t *self, const elmopp_trainer_sample_t *sample, uint32_t t, float gain,
                        slopes_t *slopes) {
    elmopp_trainer_memory_t *memory = self->memory;
    float squares = 0.0F;
    for (uint32_t k = 0U; k < INPUTS; k++) {
        const bool scored = (t >= sample->unscored) && (k < sample->inputs);
        const float error = scored ? (memory->said[t][k] - sample->seen[t + 1U][k]) : 0.0F;
        squares += error * error;
        slopes->said[k] = (k < sample->inputs) ? (slopes->said[k] + (gain * error)) : 0.0F;
        memory->slope.head_bias[k] += slopes->said[k];
    }
    const elmopp_trainer_memory_t *read = memory;
    elmopp_trainer_kernel_answer(read->weight.head_row, slopes->said, memory->hidden[t + 1U], slopes->hidden,
                                 memory->slope.head_row);
    return squares;
}

/* An inner level's slopes of one step: its weights', and that of its x and h, which are i * g and f * cell outside. */
static void through_inner(const elmopp_trainer_t *self, uint32_t level, uint32_t t, const float *outside_cell,
                          float fed_slope[ELMOPP_LSTM_INNER_ROWS]) {
    ELMOPP_ASSERT((level >= 1U) && (level <= INNER_MAX));
    elmopp_lstm_f32_inner_t *slope = &self->inner->slope[level - 1U];
    const elmopp_trainer_inner_memory_t *memory = self->inner;
    const float (*gate_slope)[GATES] = &memory->tape[level - 1U].gate[t];
    const float *outside = tape_of(self, level - 1U)->gate[t];
    static const float one = 1.0F;
    elmopp_trainer_kernel_gather(&one, 0U, gate_slope, 1U, slope->bias);
    for (uint32_t u = 0U; u < UNITS; u++) {
        const float x = outside[ELMOPP_LSTM_GATE_I + u] * outside[ELMOPP_LSTM_GATE_G + u];
        const float h = outside[ELMOPP_LSTM_GATE_F + u] * outside_cell[u];
        elmopp_trainer_kernel_gather(&x, 0U, gate_slope, 1U, slope->row[u]);
        elmopp_trainer_kernel_gather(&h, 0U, gate_slope, 1U, slope->row[UNITS + u]);
    }
    elmopp_trainer_kernel_project(memory->weight[level - 1U].row, ELMOPP_LSTM_INNER_ROWS, gate_slope[0], fed_slope);
}

/* Through all levels of step t: inwards through what each gave back, then outwards through its gates. All gates of the
 * step become the slopes of their sums. */
static void through_levels(const elmopp_trainer_t *self, const elmopp_trainer_sample_t *sample, uint32_t t,
                           slopes_t *slopes) {
    const float *back = slopes->hidden;
    for (uint32_t level = 0U; level < ELMOPP_LSTM_LEVELS_MAX; level++) {
        if (level < self->levels) {
            elmopp_trainer_tape_t *tape = tape_of(self, level);
            elmopp_trainer_kernel_release(tape->gate[t], tape->cell[t], back, slopes->cell[level]);
            back = slopes->cell[level];
        }
    }
    for (uint32_t outwards = 0U; outwards < ELMOPP_LSTM_LEVELS_MAX; outwards++) {
        const uint32_t level = (ELMOPP_LSTM_LEVELS_MAX - 1U) - outwards;
        if (level < self->levels) {
            const float *cell = cell_before(self, sample, level, t);
            float *gate = tape_of(self, level)->gate[t];
            float fed_slope[ELMOPP_LSTM_INNER_ROWS];
            const bool innermost = (level + 1U) == self->levels;
            if (!innermost) {
                through_inner(self, level + 1U, t, cell, fed_slope);
            }
            const float *made = innermost ? slopes->cell[level] : fed_slope;
            const float *kept = innermost ? slopes->cell[level] : &fed_slope[UNITS];
            elmopp_trainer_kernel_advance(gate, cell, made, kept, slopes->cell[level]);
        }
    }
}

/* To the step before: by the hidden state, and by what it said if step t was fed that. */
static void through_feed(const elmopp_trainer_t *self, const elmopp_trainer_sample_t *sample, uint32_t t,
                         slopes_t *slopes) {
    const elmopp_lstm_f32_outer_t *outer = &self->memory->weight.outer;
    const float *gate_slope = self->memory->tape.gate[t];
    elmopp_trainer_kernel_project(&outer->row[INPUTS], UNITS, gate_slope, slopes->hidden);
    if (t >= sample->fed) {
        elmopp_trainer_kernel_project(outer->row, INPUTS, gate_slope, slopes->said);
    } else {
        (void)memset(slopes->said, 0, sizeof slopes->said);
    }
}

/* The outermost level's weights, over all steps at once: that keeps their sums in registers. */
static void gather_outer(const elmopp_trainer_t *self, const elmopp_trainer_sample_t *sample) {
    static const float one = 1.0F;
    const elmopp_trainer_memory_t *memory = self->memory;
    elmopp_lstm_f32_outer_t *slope = &self->memory->slope.outer;
    const float (*gate_slope)[GATES] = memory->tape.gate;
    const uint32_t own = sample->steps - sample->fed;
    elmopp_trainer_kernel_gather(&one, 0U, gate_slope, sample->steps, slope->bias);
    for (uint32_t k = 0U; k < INPUTS; k++) {
        elmopp_trainer_kernel_gather(&sample->seen[0][k], INPUTS, gate_slope, sample->fed, slope->row[k]);
        elmopp_trainer_kernel_gather(&memory->said[sample->fed - 1U][k], INPUTS, &gate_slope[sample->fed], own,
                                     slope->row[k]);
    }
    for (uint32_t u = 0U; u < UNITS; u++) {
        float *row = slope->row[INPUTS + u];
        elmopp_trainer_kernel_gather(&memory->hidden[0][u], UNITS, gate_slope, sample->steps, row);
    }
}

float elmopp_trainer_take(elmopp_trainer_t *self, const elmopp_trainer_sample_t *sample) {
    ELMOPP_ASSERT((sample->steps >= 1U) && (sample->steps <= ELMOPP_TRAINER_WINDOW));
    ELMOPP_ASSERT((sample->fed >= 1U) && (sample->fed <= sample->steps) && (sample->unscored < sample->steps));
    ELMOPP_ASSERT((sample->inputs >= 1U) && (sample->inputs <= INPUTS));
    run_forth(self, sample);
    const uint32_t scored = (sample->steps - sample->unscored) * sample->inputs;
    const float each = 1.0F / (float)scored;
    slopes_t slopes;
    (void)memset(&slopes, 0, sizeof slopes);
    float squares = 0.0F;
    for (uint32_t t = sample->steps; t > 0U; t--) {
        squares += answer_for(self, sample, t - 1U, 2.0F * each, &slopes);
        through_levels(self, sample, t - 1U, &slopes);
        through_feed(self, sample, t - 1U, &slopes);
    }
    gather_outer(self, sample);
    self->samples++;
    return squares * each;
}

/* --- the step down --- */

static float squares_of_slopes(const elmopp_trainer_t *self) {
    const elmopp_trainer_plain_t *slope = &self->memory->slope;
    float sum = elmopp_trainer_kernel_squares(slope->head_bias, INPUTS, 0.0F);
    sum = elmopp_trainer_kernel_squares(slope->head_row[0], UNITS * INPUTS, sum);
    sum = elmopp_trainer_kernel_squares(slope->outer.bias, GATES, sum);
    sum = elmopp_trainer_kernel_squares(slope->outer.row[0], ELMOPP_LSTM_OUTER_ROWS * GATES, sum);
    for (uint32_t k = 0U; k < INNER_MAX; k++) {
        if ((k + 1U) < self->levels) {
            sum = elmopp_trainer_kernel_squares(self->inner->slope[k].bias, GATES, sum);
            sum = elmopp_trainer_kernel_squares(self->inner->slope[k].row[0], ELMOPP_LSTM_INNER_ROWS * GATES, sum);
        }
    }
    return sum;
}

static void descend(const elmopp_trainer_t *self, const elmopp_trainer_descent_t *by) {
    elmopp_trainer_memory_t *m = self->memory;
    elmopp_trainer_kernel_descend(by, m->weight.head_bias, m->slope.head_bias, m->mean.head_bias, m->square.head_bias,
                                  INPUTS);
    elmopp_trainer_kernel_descend(by, m->weight.head_row[0], m->slope.head_row[0], m->mean.head_row[0],
                                  m->square.head_row[0], UNITS * INPUTS);
    elmopp_trainer_kernel_descend(by, m->weight.outer.bias, m->slope.outer.bias, m->mean.outer.bias,
                                  m->square.outer.bias, GATES);
    elmopp_trainer_kernel_descend(by, m->weight.outer.row[0], m->slope.outer.row[0], m->mean.outer.row[0],
                                  m->square.outer.row[0], ELMOPP_LSTM_OUTER_ROWS * GATES);
    for (uint32_t k = 0U; k < INNER_MAX; k++) {
        if ((k + 1U) < self->levels) {
            elmopp_trainer_inner_memory_t *n = self->inner;
            elmopp_trainer_kernel_descend(by, n->weight[k].bias, n->slope[k].bias, n->mean[k].bias, n->square[k].bias,
                                          GATES);
            elmopp_trainer_kernel_descend(by, n->weight[k].row[0], n->slope[k].row[0], n->mean[k].row[0],
                                          n->square[k].row[0], ELMOPP_LSTM_INNER_ROWS * GATES);
        }
    }
}

bool elmopp_trainer_update(elmopp_trainer_t *self, float rate) {
    ELMOPP_ASSERT(self->samples >= 1U);
    const float squares = squares_of_slopes(self);
    if (!(squares <= SQUARES_MAX)) {
        forget_slopes(self);
        return false;
    }
    const float part = 1.0F / (float)self->samples;
    /* The length of the mean slope is sqrt(squares) * part; FLOOR keeps the root of 0 away. */
    const float shortening = (ELMOPP_TRAINER_NORM_MAX / part) * elmopp_inverse_root(squares + FLOOR);
    self->mean_left *= 1.0F - MEAN_GAIN;
    self->square_left *= 1.0F - SQUARE_GAIN;
    const float late = 1.0F - self->square_left;
    const elmopp_trainer_descent_t by = {.share = part * elmopp_lesser(1.0F, shortening),
                                         .mean_gain = MEAN_GAIN,
                                         .square_gain = SQUARE_GAIN,
                                         .rate = (rate / (1.0F - self->mean_left)) * (late * elmopp_inverse_root(late)),
                                         .floor = FLOOR};
    descend(self, &by);
    self->samples = 0U;
    self->updates += (self->updates < UINT32_MAX) ? 1U : 0U;
    return true;
}
