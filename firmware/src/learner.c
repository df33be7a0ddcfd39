/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/learner.h"

#include "elmopp/assert.h"
#include "elmopp/elementary.h"

#include <assert.h>
#include <stddef.h>
#include <string.h>

#define INPUTS ELMOPP_LSTM_INPUTS
#define WINDOW ELMOPP_TRAINER_WINDOW

static_assert(ELMOPP_LEARNER_FED_S <= WINDOW, "a stretch has seconds that are fed");
static_assert(ELMOPP_LEARNER_UNSCORED_S < WINDOW, "a stretch has errors that count");
static_assert(ELMOPP_LEARNER_AHEAD_S >= ELMOPP_LEARNER_CYCLE_S, "a probe is due before its place is needed again");

void elmopp_learner_init(elmopp_learner_t *self, elmopp_trainer_memory_t *memory, elmopp_trainer_inner_memory_t *inner,
                         const elmopp_weights_t *shipped, elmopp_learner_course_t course, uint32_t approaches) {
    ELMOPP_ASSERT((approaches >= 1U) && (approaches <= ELMOPP_APPROACH_MAX));
    (void)memset(self, 0, sizeof *self);
    self->shipped = shipped;
    self->course = course;
    self->groups = ((approaches + INPUTS) - 1U) / INPUTS;
    uint32_t left = approaches;
    for (uint32_t group = 0U; (group < self->groups) && (group < ELMOPP_LEARNER_GROUPS_MAX); group++) {
        self->inputs[group] = (left < INPUTS) ? left : INPUTS;
        left -= self->inputs[group];
    }
    self->chance = 1U;
    self->in_use = course == ELMOPP_LEARNER_LITERAL;
    elmopp_trainer_init(&self->trainer, memory, inner, &shipped->lstm);
}

void elmopp_learner_begin(elmopp_learner_t *self, const elmopp_weights_t *shipped) {
    uint32_t approaches = 0U;
    for (uint32_t group = 0U; group < ELMOPP_LEARNER_GROUPS_MAX; group++) {
        approaches += self->inputs[group];
    }
    elmopp_learner_init(self, self->trainer.memory, self->trainer.inner, shipped, self->course, approaches);
}

void elmopp_learner_move(elmopp_learner_t *self, const elmopp_weights_t *shipped) {
    self->shipped = shipped;
}

void elmopp_learner_resume(elmopp_learner_t *self, const elmopp_lstm_f32_weights_t *learnt) {
    elmopp_learner_begin(self, self->shipped);
    elmopp_trainer_reset(&self->trainer, learnt);
    self->in_use = true;
}

/* Xorshift (Marsaglia 2003). Which stretch comes next decides nothing that anybody could gain by. */
static uint32_t any_below(elmopp_learner_t *self, uint32_t count) {
    self->chance ^= self->chance << 13U;
    self->chance ^= self->chance >> 17U;
    self->chance ^= self->chance << 5U;
    return self->chance % count;
}

static void begin_anew(elmopp_learner_t *self, const elmopp_lstm_f32_state_t *shipped_memory) {
    elmopp_trainer_reset(&self->trainer, &self->shipped->lstm);
    for (uint32_t group = 0U; (group < self->groups) && (group < ELMOPP_LEARNER_GROUPS_MAX); group++) {
        self->memory[group] = shipped_memory[group];
    }
    const elmopp_learner_error_t nothing = {0.0F, 0.0F, 0U};
    self->error = nothing;
    for (uint32_t k = 0U; k < ELMOPP_LEARNER_AHEAD_S; k++) {
        self->probe[k].said = false;
    }
    self->given_up += (self->given_up < UINT32_MAX) ? 1U : 0U;
    self->in_use = self->course == ELMOPP_LEARNER_LITERAL;
}

/* --- the guard --- */

static float squared_error_of(const float said[INPUTS], const float came[INPUTS], uint32_t inputs) {
    float sum = 0.0F;
    for (uint32_t k = 0U; k < inputs; k++) {
        const float error = said[k] - came[k];
        sum += error * error;
    }
    return sum / (float)inputs;
}

/* False for a NaN too: then the learnt weights are no good. */
static bool is_at_most(float value, float limit) {
    return value <= limit;
}

/* Compares what was said about this second with what came. */
static void settle_comparison(elmopp_learner_t *self, const elmopp_learner_second_t *second) {
    elmopp_learner_probe_t *due = &self->probe[self->due];
    if (due->said) {
        elmopp_learner_error_t *error = &self->error;
        const uint32_t inputs = self->inputs[due->group];
        error->judged += (error->judged < UINT32_MAX) ? 1U : 0U;
        elmopp_average(&error->shipped, squared_error_of(due->shipped, second->came[due->group], inputs), error->judged,
                       ELMOPP_LEARNER_JUDGED_WINDOW);
        elmopp_average(&error->learnt, squared_error_of(due->learnt, second->came[due->group], inputs), error->judged,
                       ELMOPP_LEARNER_JUDGED_WINDOW);
        if (error->judged >= ELMOPP_LEARNER_JUDGED_MIN) {
            self->in_use = is_at_most(error->learnt, error->shipped);
        }
    }
    due->said = false;
    self->due = (self->due + 1U) % ELMOPP_LEARNER_AHEAD_S;
}

static bool is_hopeless(const elmopp_learner_t *self) {
    const elmopp_learner_error_t *error = &self->error;
    return (error->judged >= ELMOPP_LEARNER_JUDGED_MIN) &&
           (!is_at_most(error->learnt, ELMOPP_LEARNER_GIVE_UP * error->shipped));
}

/* Runs a network on its own output and leaves what it says of the last second. */
static void say_ahead(const elmopp_learner_t *self, const elmopp_lstm_f32_net_t *net, elmopp_lstm_f32_state_t memory,
                      uint32_t inputs, float said[INPUTS]) {
    for (uint32_t t = 0U; t < ELMOPP_LEARNER_AHEAD_S; t++) {
        elmopp_lstm_f32_net_output(net, &memory, said);
        for (uint32_t k = 0U; k < INPUTS; k++) {
            const float held = elmopp_within(said[k], self->shipped->low[k], self->shipped->high[k]);
            said[k] = (k < inputs) ? held : 0.0F;
        }
        elmopp_lstm_f32_net_step(net, &memory, said);
    }
}

static void compare(elmopp_learner_t *self, const elmopp_lstm_f32_state_t *shipped_memory) {
    const uint32_t group = self->compared_group;
    const uint32_t inputs = self->inputs[group];
    /* The place just settled is the one for the second that is AHEAD_S seconds away. */
    elmopp_learner_probe_t *page = &self->probe[((self->due + ELMOPP_LEARNER_AHEAD_S) - 1U) % ELMOPP_LEARNER_AHEAD_S];
    const elmopp_lstm_f32_net_t shipped = elmopp_lstm_f32_net(&self->shipped->lstm);
    const elmopp_lstm_f32_net_t learnt = elmopp_trainer_net(&self->trainer);
    say_ahead(self, &shipped, shipped_memory[group], inputs, page->shipped);
    say_ahead(self, &learnt, self->memory[group], inputs, page->learnt);
    page->group = group;
    page->said = true;
    self->compared_group = (group + 1U) % self->groups;
}

/* --- stretches --- */

static void keep_stretch(elmopp_learner_t *self, const elmopp_learner_stretch_t *stretch) {
    self->newest = (self->count == 0U) ? 0U : ((self->newest + 1U) % ELMOPP_LEARNER_STRETCHES);
    self->kept[self->newest] = *stretch;
    self->count += (self->count < ELMOPP_LEARNER_STRETCHES) ? 1U : 0U;
}

/* Before the networks see this second. */
static void grow(elmopp_learner_t *self, const elmopp_learner_second_t *second) {
    for (uint32_t group = 0U; (group < self->groups) && (group < ELMOPP_LEARNER_GROUPS_MAX); group++) {
        elmopp_learner_stretch_t *stretch = &self->growing[group];
        (void)memcpy(stretch->seen[self->grown], second->input[group], sizeof stretch->seen[0]);
        if (self->grown == WINDOW) {
            stretch->inputs = self->inputs[group];
            keep_stretch(self, stretch);
        }
        if ((self->grown == 0U) || (self->grown == WINDOW)) {
            stretch->before = self->memory[group];
            (void)memcpy(stretch->seen[0], second->input[group], sizeof stretch->seen[0]);
        }
    }
    self->grown = (self->grown == WINDOW) ? 1U : (self->grown + 1U);
}

static void step_learnt(elmopp_learner_t *self, const elmopp_learner_second_t *second) {
    const elmopp_lstm_f32_net_t net = elmopp_trainer_net(&self->trainer);
    for (uint32_t group = 0U; (group < self->groups) && (group < ELMOPP_LEARNER_GROUPS_MAX); group++) {
        elmopp_lstm_f32_net_step(&net, &self->memory[group], second->input[group]);
    }
}

static elmopp_trainer_sample_t sample_of(const elmopp_learner_t *self, const elmopp_learner_stretch_t *stretch) {
    const elmopp_trainer_sample_t sample = {.before = &stretch->before,
                                            .seen = stretch->seen,
                                            .steps = WINDOW,
                                            .fed = ELMOPP_LEARNER_FED_S,
                                            .unscored = ELMOPP_LEARNER_UNSCORED_S,
                                            .inputs = stretch->inputs,
                                            .low = self->shipped->low,
                                            .high = self->shipped->high};
    return sample;
}

/* --- the two courses --- */

static void learn_carefully(elmopp_learner_t *self, const elmopp_lstm_f32_state_t *shipped_memory) {
    bool good = true;
    if (self->count > 0U) {
        if (self->second < ELMOPP_LEARNER_BATCH) {
            const uint32_t which = (self->second == 0U) ? self->newest : any_below(self, self->count);
            const elmopp_trainer_sample_t sample = sample_of(self, &self->kept[which]);
            (void)elmopp_trainer_take(&self->trainer, &sample);
        } else if (self->second == ELMOPP_LEARNER_BATCH) {
            good = elmopp_trainer_update(&self->trainer, ELMOPP_LEARNER_RATE);
        } else {
            compare(self, shipped_memory);
        }
        self->second = (self->second + 1U) % ELMOPP_LEARNER_CYCLE_S;
    }
    if ((!good) || is_hopeless(self)) {
        begin_anew(self, shipped_memory);
    }
}

/* The stretch that ends with the newest second: the growing one, or the one that this second has completed. */
static const elmopp_learner_stretch_t *ending_now(const elmopp_learner_t *self, uint32_t group) {
    const uint32_t back = (self->groups - 1U) - group;
    const uint32_t completed = ((self->newest + ELMOPP_LEARNER_STRETCHES) - back) % ELMOPP_LEARNER_STRETCHES;
    return (self->grown >= 2U) ? &self->growing[group] : &self->kept[completed];
}

/* One step on what the newest second should have been. */
static void learn_literally(elmopp_learner_t *self, const elmopp_lstm_f32_state_t *shipped_memory) {
    bool good = true;
    const bool known = (self->grown >= 2U) || (self->count > 0U);
    for (uint32_t group = 0U; (group < self->groups) && (group < ELMOPP_LEARNER_GROUPS_MAX) && known; group++) {
        elmopp_trainer_sample_t sample = sample_of(self, ending_now(self, group));
        sample.inputs = self->inputs[group];
        sample.steps = (self->grown >= 2U) ? (self->grown - 1U) : WINDOW;
        sample.fed = sample.steps;
        sample.unscored = sample.steps - 1U;
        (void)elmopp_trainer_take(&self->trainer, &sample);
        good = elmopp_trainer_update(&self->trainer, ELMOPP_LEARNER_LITERAL_RATE) && good;
    }
    if (!good) {
        begin_anew(self, shipped_memory);
    }
}

void elmopp_learner_see(elmopp_learner_t *self, const elmopp_learner_second_t *second) {
    settle_comparison(self, second);
    grow(self, second);
    step_learnt(self, second);
}

void elmopp_learner_work(elmopp_learner_t *self, const elmopp_lstm_f32_state_t *shipped_memory) {
    if (self->course == ELMOPP_LEARNER_LITERAL) {
        learn_literally(self, shipped_memory);
    } else {
        learn_carefully(self, shipped_memory);
    }
}

bool elmopp_learner_is_in_use(const elmopp_learner_t *self) {
    return self->in_use;
}

bool elmopp_learner_is_worth_keeping(const elmopp_learner_t *self) {
    const elmopp_learner_error_t *error = &self->error;
    return self->in_use && (error->judged >= ELMOPP_LEARNER_JUDGED_WINDOW) &&
           is_at_most(error->learnt, ELMOPP_LEARNER_WORTH * error->shipped);
}

void elmopp_learner_copy(const elmopp_learner_t *self, elmopp_lstm_f32_weights_t *out) {
    if (self->in_use) {
        elmopp_trainer_copy(&self->trainer, out);
    } else {
        *out = self->shipped->lstm;
    }
}
