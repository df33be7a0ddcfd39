/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The LSTM of the core in whole numbers as a program: lstm_q15_probe FILE
///
/// FILE is raw and little-endian: two words, the inputs absorbed and the steps run freely; the input range (four least,
/// four largest values); an elmopp_lstm_f32_weights_t; the inputs, rows of four floats. Written are, raw: the
/// elmopp_lstm_q15_weights_t made of it; a row of output after each input, then as many of the float network; then the
/// free run, each row the output held in the range and the next input, and that of the float network; the state in
/// whole numbers. tests/python/test_lstm_q15.py compares it, and tools/bench-cortex-m4 takes the errors of free runs
/// from it: it runs on the emulated board, too.
///
/// Exit status 2: a row is refused, `LEVEL COLUMN REACH` on standard error. 1: anything else went wrong.

#include "elmopp/assert.h"
#include "elmopp/lstm_f32.h"
#include "elmopp/lstm_q15.h"
#include "elmopp/lstm_quantize.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define INPUTS ELMOPP_LSTM_INPUTS
#define STEPS_MAX 1000U

enum { EXIT_BROKEN = 1, EXIT_REFUSED = 2 };

static struct {
    uint32_t absorbed;
    uint32_t free_steps;
    float low[INPUTS];
    float high[INPUTS];
    elmopp_lstm_f32_weights_t weights;
} head;
static float given[STEPS_MAX][INPUTS];
static float said[STEPS_MAX][INPUTS];
static elmopp_lstm_q15_weights_t quantized;
static elmopp_lstm_q15_state_t whole;
static elmopp_lstm_f32_state_t floating;

void elmopp_assert_failed(const char *file, int line) {
    (void)fprintf(stderr, "assert of the core at %s:%d\n", file, line);
    exit(EXIT_BROKEN);
}

static int broken(const char *what) {
    (void)fprintf(stderr, "lstm_q15_probe: %s\n", what);
    return EXIT_BROKEN;
}

static bool read_file(const char *path) {
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        return false;
    }
    bool good = (fread(&head, sizeof head, 1U, file) == 1U) && (head.absorbed <= STEPS_MAX) &&
                (head.free_steps <= STEPS_MAX) && (head.weights.levels >= 1U) &&
                (head.weights.levels <= ELMOPP_LSTM_LEVELS_MAX);
    good = good && (fread(given, sizeof given[0], head.absorbed, file) == head.absorbed);
    (void)fclose(file);
    return good;
}

static void step(bool in_whole, const float input[INPUTS], float output[INPUTS]) {
    if (in_whole) {
        elmopp_lstm_q15_step(&quantized, &whole, input);
        elmopp_lstm_q15_output(&quantized, &whole, output);
    } else {
        elmopp_lstm_f32_step(&head.weights, &floating, input);
        elmopp_lstm_f32_output(&head.weights, &floating, output);
    }
}

static bool write_rows(uint32_t count) {
    return fwrite(said, sizeof said[0], count, stdout) == count;
}

static bool absorb(bool in_whole, float next[INPUTS]) {
    for (uint32_t t = 0U; t < head.absorbed; t++) {
        step(in_whole, given[t], said[t]);
        (void)memcpy(next, said[t], sizeof said[t]);
    }
    return write_rows(head.absorbed);
}

static bool run_freely(bool in_whole, float next[INPUTS]) {
    for (uint32_t t = 0U; t < head.free_steps; t++) {
        for (uint32_t k = 0U; k < INPUTS; k++) {
            const float not_less = (next[k] < head.low[k]) ? head.low[k] : next[k];
            said[t][k] = (not_less > head.high[k]) ? head.high[k] : not_less;
        }
        step(in_whole, said[t], next);
    }
    return write_rows(head.free_steps);
}

int main(int argc, char **argv) {
    float next[2][INPUTS] = {{0.0F}};
    if ((argc != 2) || !read_file(argv[1])) {
        return broken("usage: lstm_q15_probe FILE, and FILE as its source says");
    }
    const elmopp_lstm_quantized_t made = elmopp_lstm_quantize(&head.weights, head.low, head.high, &quantized);
    if (!made.made) {
        (void)fprintf(stderr, "%u %u %.9g\n", (unsigned)made.level, (unsigned)made.column, (double)made.reach);
        return EXIT_REFUSED;
    }
    const bool written = (fwrite(&quantized, sizeof quantized, 1U, stdout) == 1U) && absorb(true, next[0]) &&
                         absorb(false, next[1]) && run_freely(true, next[0]) && run_freely(false, next[1]) &&
                         (fwrite(&whole, sizeof whole, 1U, stdout) == 1U);
    return (written && (fflush(stdout) == 0)) ? EXIT_SUCCESS : broken("nothing can be written");
}
