/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Trainer: changes a network's weights by what it said and what came, in fixed memory: back-propagation through a
/// window of time (Werbos 1990), cut at its beginning, and Adam (Kingma and Ba 2015).
///
/// A sample is a stretch of seconds and the state before it, which counts as given. The network is fed the first of its
/// seconds as they came and runs on its own output from then on, as the forecast does (forecast.h); the error is the
/// mean square of what it said after each step but the first few against what came next. What it says is held in the
/// clamp; the slope passes the clamp as if it were not there. elmopp_trainer_take() adds a sample's slopes to those of
/// the samples before it, elmopp_trainer_update() makes one step down their mean: a batch may be spread over as many
/// ticks as it has samples. Slopes longer than ELMOPP_TRAINER_NORM_MAX together are shortened to it.
///
/// It decides nothing: which samples, how often, how fast and whether the result is any good is the learner's to say
/// (learner.h). It knows no traffic and no time.
///
/// The equations' way back, for one level, with d for a slope: do = dh tanh(c), dc += dh o (1 - tanh(c)^2), di = dc g,
/// dg = dc i, df = dc c', dc' = dc f, c' the cell before; each gate's sum gets its gate's slope times s(1 - s), or
/// 1 - g^2; then weights and what was fed. In a nested level i g and f c' are the inner level's x and h, and dc the
/// slope of what it gave back. All parameters' slopes are held against an independent implementation in double
/// precision and against central differences (tests/python/test_trainer_reference.py).
///
/// The sums are lstm_kernel.h and trainer_kernel.h, which a port may replace, bit for bit; the same bits on every
/// target. The number of instructions of a sample depends on its numbers of steps only, that of an update on nothing
/// (tools/budget).
///
/// Memory belongs to the caller: elmopp_trainer_memory_t, and for nested networks elmopp_trainer_inner_memory_t too,
/// which a network of one level does not need. One owner, not thread-safe, no allocation.

#ifndef ELMOPP_TRAINER_H
#define ELMOPP_TRAINER_H

#include "elmopp/lstm_f32.h"

#include <stdbool.h>
#include <stdint.h>

/// Most steps of a sample. The tape takes 400 bytes a step.
#ifndef ELMOPP_TRAINER_WINDOW
#define ELMOPP_TRAINER_WINDOW 30U
#endif

/// All slopes of an update together are no longer than this.
#define ELMOPP_TRAINER_NORM_MAX 1.0F

/// One value for each parameter but those of inner levels.
typedef struct {
    float head_bias[ELMOPP_LSTM_INPUTS];
    float head_row[ELMOPP_LSTM_UNITS][ELMOPP_LSTM_INPUTS];
    elmopp_lstm_f32_outer_t outer;
} elmopp_trainer_plain_t;

/// What a level leaves behind for the way back. Gates become their sums' slopes there.
typedef struct {
    float cell[ELMOPP_TRAINER_WINDOW][ELMOPP_LSTM_UNITS]; ///< after each step
    float gate[ELMOPP_TRAINER_WINDOW][ELMOPP_LSTM_GATES];
} elmopp_trainer_tape_t;

/// For the outermost level.
typedef struct {
    elmopp_trainer_plain_t weight;
    elmopp_trainer_plain_t slope; ///< summed over the samples of an update
    elmopp_trainer_plain_t mean;  ///< running mean of the slopes
    elmopp_trainer_plain_t square;
    elmopp_trainer_tape_t tape;
    float hidden[ELMOPP_TRAINER_WINDOW + 1U][ELMOPP_LSTM_UNITS]; ///< before each step, and after the last
    float said[ELMOPP_TRAINER_WINDOW][ELMOPP_LSTM_INPUTS];       ///< after each step, in the clamp
} elmopp_trainer_memory_t;

/// For inner levels.
typedef struct {
    elmopp_lstm_f32_inner_t weight[ELMOPP_LSTM_LEVELS_MAX - 1U];
    elmopp_lstm_f32_inner_t slope[ELMOPP_LSTM_LEVELS_MAX - 1U];
    elmopp_lstm_f32_inner_t mean[ELMOPP_LSTM_LEVELS_MAX - 1U];
    elmopp_lstm_f32_inner_t square[ELMOPP_LSTM_LEVELS_MAX - 1U];
    elmopp_trainer_tape_t tape[ELMOPP_LSTM_LEVELS_MAX - 1U];
} elmopp_trainer_inner_memory_t;

/// State. Set up by elmopp_trainer_init(); nobody else writes it.
typedef struct {
    elmopp_trainer_memory_t *memory;
    elmopp_trainer_inner_memory_t *inner; ///< null for one level
    uint32_t levels;
    uint32_t samples; ///< taken since the last update
    uint32_t updates; ///< saturates at UINT32_MAX
    float mean_left;  ///< share of the mean's beginning, 0, that is left in it
    float square_left;
} elmopp_trainer_t;

/// One stretch. Everything that it points at is the caller's and only read.
typedef struct {
    const elmopp_lstm_f32_state_t *before;   ///< the network's state before the first step
    const float (*seen)[ELMOPP_LSTM_INPUTS]; ///< [steps + 1] what came, in the clamp; step t answers with seen[t + 1]
    uint32_t steps;                          ///< 1 to ELMOPP_TRAINER_WINDOW
    uint32_t fed;                            ///< so many steps, 1 to `steps`, are fed what came
    uint32_t unscored;                       ///< after so many steps, below `steps`, errors begin to count
    uint32_t inputs;  ///< 1 to ELMOPP_LSTM_INPUTS: those after are fed 0, and what is said about them does not count
    const float *low; ///< [input] the clamp
    const float *high;
} elmopp_trainer_sample_t;

/// Begins with a copy of these weights. Asserts memory for their levels.
void elmopp_trainer_init(elmopp_trainer_t *self, elmopp_trainer_memory_t *memory, elmopp_trainer_inner_memory_t *inner,
                         const elmopp_lstm_f32_weights_t *weights);

/// Goes back to these weights, which have as many levels, and forgets all slopes.
void elmopp_trainer_reset(elmopp_trainer_t *self, const elmopp_lstm_f32_weights_t *weights);

/// Adds a sample's slopes. Returns its error: the mean square over scored steps and inputs.
float elmopp_trainer_take(elmopp_trainer_t *self, const elmopp_trainer_sample_t *sample);

/// One step of Adam along the mean slope of the samples since the last one, at least one. False if the slopes are no
/// finite numbers: then nothing moves and they are thrown away.
bool elmopp_trainer_update(elmopp_trainer_t *self, float rate);

/// The weights as a network that can be run, where they are: valid as long as the memory.
elmopp_lstm_f32_net_t elmopp_trainer_net(const elmopp_trainer_t *self);

/// The weights copied out, for whoever wants to keep or re-quantise them; `out` loses nothing but its recurrent
/// weights.
void elmopp_trainer_copy(const elmopp_trainer_t *self, elmopp_lstm_f32_weights_t *out);

#endif
