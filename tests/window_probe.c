/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The core's networks that see windows as a program, for tests/python/test_window_reference.py:
///
///   window_probe IMAGE ann INPUTS FREE              four inputs
///   window_probe IMAGE gcn INPUTS FREE MASK...      a node for each mask of the nodes that it is joined to
///
/// Loads the weights IMAGE and reads INPUTS (raw float32, a row a second). Writes what comes, unclamped, for each
/// second whose window is full; then runs freely from the last window and writes FREE rows: each is clamped, and the
/// windows' next second. All of it is little-endian. Exit status 2: the image is refused. 1: anything else went wrong.

#include "elmopp/image.h"
#include "elmopp/weights.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FREE_MAX 1000000UL
#define SECONDS_MAX 4000U
#define WIDTH_MAX ELMOPP_GCN_NODES_MAX

enum { EXIT_BROKEN = 1, EXIT_REFUSED = 2 };

static uint8_t image[ELMOPP_IMAGE_HEADER + sizeof(elmopp_weights_t) + 1U];
static elmopp_weights_t weights;
static elmopp_gcn_f32_graph_t graph;
static bool is_gcn;
static uint32_t width;
static uint32_t window_s;
static float seen[WIDTH_MAX][SECONDS_MAX];

static int broken(const char *what) {
    (void)fprintf(stderr, "window_probe: %s\n", what);
    return EXIT_BROKEN;
}

/* What comes after the window that ends before `second`. */
static void say(uint32_t second, float next[WIDTH_MAX]) {
    const float *past[WIDTH_MAX];
    for (uint32_t i = 0U; i < WIDTH_MAX; i++) {
        past[i] = &seen[i][second - window_s];
    }
    if (is_gcn) {
        elmopp_gcn_f32_next(&weights.gcn, &graph, past, next);
    } else {
        elmopp_ann_f32_next(&weights.ann, past, next);
    }
}

static float clamped(uint32_t input, float value) {
    const float low = is_gcn ? weights.ar8.low : weights.low[input];
    const float high = is_gcn ? weights.ar8.high : weights.high[input];
    const float not_less = (value < low) ? low : value;
    return (not_less > high) ? high : not_less;
}

static bool write_row(const float *row) {
    return fwrite(row, sizeof(float), width, stdout) == width;
}

/* Seconds read, SECONDS_MAX if there are too many. */
static uint32_t read_inputs(FILE *file) {
    uint32_t second = 0U;
    float row[WIDTH_MAX];
    while ((second < SECONDS_MAX) && (fread(row, sizeof(float), width, file) == width)) {
        for (uint32_t i = 0U; i < width; i++) {
            seen[i][second] = row[i];
        }
        second++;
    }
    return second;
}

static bool run(uint32_t seconds, uint32_t steps) {
    float next[WIDTH_MAX];
    bool good = true;
    for (uint32_t second = window_s; good && (second <= seconds); second++) {
        say(second, next);
        good = write_row(next);
    }
    for (uint32_t second = seconds; good && (second < (seconds + steps)); second++) {
        say(second, next);
        for (uint32_t i = 0U; i < width; i++) {
            next[i] = clamped(i, next[i]);
            seen[i][second] = next[i];
        }
        good = write_row(next);
    }
    return good;
}

/* The graph of the arguments; false if they are no graph. */
static bool take_network(int argc, char **argv) {
    is_gcn = strcmp(argv[2], "gcn") == 0;
    if (!is_gcn) {
        width = ELMOPP_ANN_INPUTS;
        window_s = ELMOPP_ANN_WINDOW_S;
        return (strcmp(argv[2], "ann") == 0) && (argc == 5);
    }
    width = (uint32_t)argc - 5U;
    window_s = ELMOPP_GCN_WINDOW_S;
    if ((width < 1U) || (width > WIDTH_MAX)) {
        return false;
    }
    uint8_t joined[WIDTH_MAX] = {0U};
    for (uint32_t i = 0U; i < width; i++) {
        joined[i] = (uint8_t)strtoul(argv[i + 5U], NULL, 10);
    }
    elmopp_gcn_f32_join(&graph, width, joined);
    return true;
}

static bool load(const char *path, elmopp_weights_fault_t *fault) {
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        return false;
    }
    const size_t length = fread(image, 1U, sizeof image, file);
    (void)fclose(file);
    *fault = elmopp_weights_load(image, (uint32_t)length, &weights);
    return true;
}

int main(int argc, char **argv) {
    if ((argc < 5) || !take_network(argc, argv)) {
        return broken("usage: window_probe IMAGE ann|gcn INPUTS FREE [MASK...]");
    }
    elmopp_weights_fault_t fault = ELMOPP_WEIGHTS_OK;
    if (!load(argv[1], &fault)) {
        return broken("IMAGE cannot be read");
    }
    if (fault != ELMOPP_WEIGHTS_OK) {
        (void)fprintf(stderr, "window_probe: %s\n", elmopp_weights_fault_name(fault));
        return EXIT_REFUSED;
    }
    FILE *file = fopen(argv[3], "rb");
    if (file == NULL) {
        return broken("INPUTS cannot be read");
    }
    const uint32_t seconds = read_inputs(file);
    (void)fclose(file);
    const unsigned long steps = strtoul(argv[4], NULL, 10);
    if ((seconds < window_s) || (steps > FREE_MAX) || ((seconds + steps) > SECONDS_MAX)) {
        return broken("too few or too many seconds");
    }
    return run(seconds, (uint32_t)steps) ? EXIT_SUCCESS : broken("the rows cannot be written");
}
