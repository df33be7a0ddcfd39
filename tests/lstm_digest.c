/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Every bit that the networks and the elementary functions give, as one line a part: tests/python/test_bit_identity.py
/// builds this with many compilers and options and compares what it prints with tests/golden/lstm_digest.txt.
///
/// Weights, inputs and arguments come from integers, so that nothing but the core itself does arithmetic that rounds. A
/// digest is the 64-bit FNV-1a of bit patterns, low byte first. Infinities are arguments like any other.

#include "elmopp/ann_f32.h"
#include "elmopp/assert.h"
#include "elmopp/elementary.h"
#include "elmopp/gcn_f32.h"
#include "elmopp/lstm_f32.h"
#include "elmopp/lstm_q15.h"
#include "elmopp/lstm_quantize.h"
#include "elmopp/trainer.h"
#include "random.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DRIVEN_STEPS 500U
#define FREE_STEPS 60U
#define TRAINING_UPDATES 4U

#define ARGUMENT_STRIDE 16381U ///< a prime: takes every exponent and all kinds of low bits
#define SIGN_BIT 0x80000000U

#define FNV_BASIS 0xCBF29CE484222325ULL
#define FNV_PRIME 0x100000001B3ULL

static elmopp_lstm_f32_weights_t weights;
static elmopp_lstm_f32_state_t state;
static elmopp_lstm_q15_weights_t whole_weights;
static elmopp_lstm_q15_state_t whole_state;
static elmopp_ann_f32_weights_t ann;
static elmopp_gcn_f32_weights_t gcn;

void elmopp_assert_failed(const char *file, int line) {
    (void)fprintf(stderr, "assert of the core at %s:%d\n", file, line);
    exit(1);
}

static void take(uint64_t *digest, const float *values, size_t count) {
    for (size_t i = 0U; i < count; i++) {
        uint32_t bits;
        (void)memcpy(&bits, &values[i], sizeof bits);
        for (uint32_t shift = 0U; shift < 32U; shift += 8U) {
            *digest = (*digest ^ ((bits >> shift) & 0xFFU)) * FNV_PRIME;
        }
    }
}

static void take_bytes(uint64_t *digest, const void *bytes, size_t count) {
    const uint8_t *byte = bytes;
    for (size_t i = 0U; i < count; i++) {
        *digest = (*digest ^ byte[i]) * FNV_PRIME;
    }
}

static void print_digest(const char *name, uint64_t digest) {
    (void)printf("%s %016llx\n", name, (unsigned long long)digest);
}

/* In [-size, size), for a power of two as size: a whole number scaled by a power of two, hence exact. */
static float random_within(uint64_t *random, float size) {
    const int32_t whole = (int32_t)random_below(random, 1U << 24U) - (1 << 23);
    return (float)whole * (size / 8388608.0F);
}

static void fill(uint64_t *random, float *values, size_t count, float size) {
    for (size_t i = 0U; i < count; i++) {
        values[i] = random_within(random, size);
    }
}

/* Large enough that some gates saturate and the cells move far from zero, also without input. */
static void make_weights(uint32_t levels) {
    uint64_t random = levels;
    (void)memset(&weights, 0, sizeof weights);
    weights.levels = levels;
    fill(&random, weights.head_bias, ELMOPP_LSTM_INPUTS, 0.5F);
    fill(&random, weights.head_row[0], ELMOPP_LSTM_UNITS * ELMOPP_LSTM_INPUTS, 2.0F);
    fill(&random, weights.outer.bias, ELMOPP_LSTM_GATES, 2.0F);
    fill(&random, weights.outer.row[0], ELMOPP_LSTM_OUTER_ROWS * ELMOPP_LSTM_GATES, 1.0F);
    for (uint32_t i = 0U; (i + 1U) < levels; i++) {
        fill(&random, weights.inner[i].bias, ELMOPP_LSTM_GATES, 2.0F);
        fill(&random, weights.inner[i].row[0], ELMOPP_LSTM_INNER_ROWS * ELMOPP_LSTM_GATES, 1.0F);
    }
}

/* The output of a step becomes `next`. */
static void step(const float input[ELMOPP_LSTM_INPUTS], float next[ELMOPP_LSTM_INPUTS], uint64_t *digest) {
    elmopp_lstm_f32_step(&weights, &state, input);
    elmopp_lstm_f32_output(&weights, &state, next);
    take(digest, state.hidden, ELMOPP_LSTM_UNITS);
    take(digest, state.cell[0], ELMOPP_LSTM_LEVELS_MAX * ELMOPP_LSTM_UNITS);
    take(digest, next, ELMOPP_LSTM_INPUTS);
}

static void print_lstm(uint32_t levels) {
    static const char *const driven_name[] = {"lstm-1-driven", "lstm-2-driven", "lstm-3-driven"};
    static const char *const free_name[] = {"lstm-1-free", "lstm-2-free", "lstm-3-free"};
    uint64_t driven = FNV_BASIS;
    uint64_t freely = FNV_BASIS;
    uint64_t random = 100U + levels;
    float input[ELMOPP_LSTM_INPUTS];
    float next[ELMOPP_LSTM_INPUTS];
    make_weights(levels);
    (void)memset(&state, 0, sizeof state);
    for (uint32_t i = 0U; i < DRIVEN_STEPS; i++) {
        fill(&random, input, ELMOPP_LSTM_INPUTS, 4.0F);
        step(input, next, &driven);
    }
    for (uint32_t i = 0U; i < FREE_STEPS; i++) {
        (void)memcpy(input, next, sizeof input);
        step(input, next, &freely);
    }
    print_digest(driven_name[levels - 1U], driven);
    print_digest(free_name[levels - 1U], freely);
}

/* The same in whole numbers: the weights made of the float ones, driven beyond their range, too, and on its own. */
static void print_whole_lstm(uint32_t levels) {
    static const char *const name[] = {"lstm-q15-1", "lstm-q15-2", "lstm-q15-3"};
    static const float low[ELMOPP_LSTM_INPUTS] = {-3.5F, -3.5F, -3.5F, -3.5F};
    static const float high[ELMOPP_LSTM_INPUTS] = {3.75F, 3.75F, 3.75F, 3.75F};
    uint64_t digest = FNV_BASIS;
    uint64_t random = 200U + levels;
    float input[ELMOPP_LSTM_INPUTS];
    make_weights(levels);
    if (!elmopp_lstm_quantize(&weights, low, high, &whole_weights).made) {
        exit(1);
    }
    take_bytes(&digest, &whole_weights, sizeof whole_weights);
    (void)memset(&whole_state, 0, sizeof whole_state);
    for (uint32_t i = 0U; i < (DRIVEN_STEPS + FREE_STEPS); i++) {
        if (i < DRIVEN_STEPS) {
            fill(&random, input, ELMOPP_LSTM_INPUTS, 4.0F);
        }
        elmopp_lstm_q15_step(&whole_weights, &whole_state, input);
        elmopp_lstm_q15_output(&whole_weights, &whole_state, input);
        take_bytes(&digest, &whole_state, sizeof whole_state);
        take(&digest, input, ELMOPP_LSTM_INPUTS);
    }
    print_digest(name[levels - 1U], digest);
}

/* Units are neither shut nor linear, and the windows stay near the random ones that they begin with. */
static void make_window_weights(void) {
    uint64_t random = 7U;
    fill(&random, ann.first_bias, ELMOPP_ANN_UNITS, 0.5F);
    fill(&random, ann.first_row[0], ELMOPP_ANN_INPUTS * ELMOPP_ANN_WINDOW_S * ELMOPP_ANN_UNITS, 0.25F);
    fill(&random, ann.second_bias, ELMOPP_ANN_UNITS, 0.5F);
    fill(&random, ann.second_row[0], ELMOPP_ANN_UNITS * ELMOPP_ANN_UNITS, 0.5F);
    fill(&random, ann.head_bias, ELMOPP_ANN_INPUTS, 0.03125F);
    fill(&random, ann.head_row[0], ELMOPP_ANN_UNITS * ELMOPP_ANN_INPUTS, 0.0625F);
    fill(&random, gcn.first_bias, ELMOPP_GCN_UNITS, 0.5F);
    fill(&random, gcn.first_own[0], ELMOPP_GCN_WINDOW_S * ELMOPP_GCN_UNITS, 0.25F);
    fill(&random, gcn.first_passed[0], ELMOPP_GCN_WINDOW_S * ELMOPP_GCN_UNITS, 0.25F);
    fill(&random, gcn.second_bias, ELMOPP_GCN_UNITS, 0.5F);
    fill(&random, gcn.second_own[0], ELMOPP_GCN_UNITS * ELMOPP_GCN_UNITS, 0.5F);
    fill(&random, gcn.second_passed[0], ELMOPP_GCN_UNITS * ELMOPP_GCN_UNITS, 0.5F);
    fill(&random, &gcn.head_bias, 1U, 0.03125F);
    fill(&random, gcn.head, ELMOPP_GCN_UNITS, 0.0625F);
}

/* Runs a network that sees windows on its own output: eight nodes in a ring, or four inputs. */
static void print_windows(const char *name, bool ring) {
    static float past[ELMOPP_GCN_NODES_MAX][ELMOPP_GCN_WINDOW_S + DRIVEN_STEPS];
    static const uint8_t joined[ELMOPP_GCN_NODES_MAX] = {0x82U, 0x05U, 0x0AU, 0x14U, 0x28U, 0x50U, 0xA0U, 0x41U};
    const uint32_t width = ring ? ELMOPP_GCN_NODES_MAX : ELMOPP_ANN_INPUTS;
    uint64_t digest = FNV_BASIS;
    uint64_t random = 9U;
    elmopp_gcn_f32_graph_t graph;
    elmopp_gcn_f32_join(&graph, ELMOPP_GCN_NODES_MAX, joined);
    for (uint32_t i = 0U; i < width; i++) {
        fill(&random, past[i], ELMOPP_GCN_WINDOW_S, 2.0F);
    }
    for (uint32_t step_s = 0U; step_s < DRIVEN_STEPS; step_s++) {
        const float *window[ELMOPP_GCN_NODES_MAX];
        float next[ELMOPP_GCN_NODES_MAX];
        for (uint32_t i = 0U; i < ELMOPP_GCN_NODES_MAX; i++) {
            window[i] = &past[i][step_s];
        }
        if (ring) {
            elmopp_gcn_f32_next(&gcn, &graph, window, next);
        } else {
            elmopp_ann_f32_next(&ann, window, next);
        }
        take(&digest, next, width);
        for (uint32_t i = 0U; i < width; i++) {
            /* In range again without rounding. */
            past[i][step_s + ELMOPP_GCN_WINDOW_S] = (next[i] > 4.0F) ? -2.0F : ((next[i] < -4.0F) ? 2.0F : next[i]);
        }
    }
    print_digest(name, digest);
}

/* Over floats of either sign, from zero past infinity to the last NaN. */
static void print_function(const char *name, float (*function)(float)) {
    uint64_t digest = FNV_BASIS;
    for (uint32_t magnitude = 0U; magnitude < SIGN_BIT; magnitude += ARGUMENT_STRIDE) {
        for (uint32_t sign = 0U; sign < 2U; sign++) {
            const uint32_t bits = magnitude | (sign << 31U);
            float argument;
            (void)memcpy(&argument, &bits, sizeof argument);
            const float result = function(argument);
            take(&digest, &result, 1U);
        }
    }
    print_digest(name, digest);
}

/* A few updates on two batches of random seconds: slopes, averages and weights after each. */
static void print_training(uint32_t levels) {
    static const char *const name[] = {"train-1", "train-2", "train-3"};
    static elmopp_trainer_memory_t memory;
    static elmopp_trainer_inner_memory_t inner;
    static float seen[ELMOPP_TRAINER_WINDOW + 1U][ELMOPP_LSTM_INPUTS];
    static const float low[ELMOPP_LSTM_INPUTS] = {0.0F, 0.0F, 0.0F, 0.0F};
    static const float high[ELMOPP_LSTM_INPUTS] = {4.0F, 4.0F, 4.0F, 4.0F};
    uint64_t digest = FNV_BASIS;
    uint64_t random = 200U + levels;
    elmopp_trainer_t trainer;
    make_weights(levels);
    (void)memset(&state, 0, sizeof state);
    elmopp_trainer_init(&trainer, &memory, &inner, &weights);
    for (uint32_t update = 0U; update < TRAINING_UPDATES; update++) {
        for (uint32_t k = 0U; k < 2U; k++) {
            fill(&random, seen[0], (ELMOPP_TRAINER_WINDOW + 1U) * ELMOPP_LSTM_INPUTS, 4.0F);
            fill(&random, state.hidden, ELMOPP_LSTM_UNITS, 1.0F);
            const elmopp_trainer_sample_t sample = {.before = &state,
                                                    .seen = (const float (*)[ELMOPP_LSTM_INPUTS])seen,
                                                    .steps = ELMOPP_TRAINER_WINDOW - k,
                                                    .fed = 10U,
                                                    .unscored = 5U,
                                                    .inputs = ELMOPP_LSTM_INPUTS - k,
                                                    .low = low,
                                                    .high = high};
            const float error = elmopp_trainer_take(&trainer, &sample);
            take(&digest, &error, 1U);
            take(&digest, memory.slope.head_bias, ELMOPP_LSTM_INPUTS);
            take(&digest, memory.slope.outer.row[0], ELMOPP_LSTM_OUTER_ROWS * ELMOPP_LSTM_GATES);
        }
        (void)elmopp_trainer_update(&trainer, 1.0F / 256.0F);
        take(&digest, memory.weight.head_bias, ELMOPP_LSTM_INPUTS);
        take(&digest, memory.weight.outer.row[0], ELMOPP_LSTM_OUTER_ROWS * ELMOPP_LSTM_GATES);
        take(&digest, memory.square.outer.row[0], ELMOPP_LSTM_OUTER_ROWS * ELMOPP_LSTM_GATES);
        for (uint32_t k = 0U; (k + 1U) < levels; k++) {
            take(&digest, inner.weight[k].row[0], ELMOPP_LSTM_INNER_ROWS * ELMOPP_LSTM_GATES);
        }
    }
    print_digest(name[levels - 1U], digest);
}

int main(void) {
    print_function("exp", elmopp_exp);
    print_function("tanh", elmopp_tanh);
    print_function("sigmoid", elmopp_sigmoid);
    for (uint32_t levels = 1U; levels <= ELMOPP_LSTM_LEVELS_MAX; levels++) {
        print_lstm(levels);
    }
    for (uint32_t levels = 1U; levels <= ELMOPP_LSTM_LEVELS_MAX; levels++) {
        print_whole_lstm(levels);
    }
    for (uint32_t levels = 1U; levels <= ELMOPP_LSTM_LEVELS_MAX; levels++) {
        print_training(levels);
    }
    make_window_weights();
    print_windows("ann", false);
    print_windows("gcn", true);
    return 0;
}
