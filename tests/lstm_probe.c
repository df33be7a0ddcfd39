/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The LSTM of the core as a program, for tests/python/test_lstm_reference.py: lstm_probe IMAGE INPUTS FREE
///
/// Loads the weights IMAGE, absorbs INPUTS (raw float32, rows of four) and writes the unclamped output after each; then
/// runs freely and writes FREE rows: each is the clamped output, and the next input. All of it is little-endian.
///
/// Exit status 2: the image is refused, and standard error says why. 1: anything else went wrong.

#include "elmopp/image.h"
#include "elmopp/lstm_f32.h"
#include "elmopp/weights.h"

#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#define FREE_MAX 1000000UL
#define ROW_BYTES (ELMOPP_LSTM_INPUTS * sizeof(float))

enum { EXIT_BROKEN = 1, EXIT_REFUSED = 2 };

/* One byte more than an image has, so that a longer one shows. */
static uint8_t image[ELMOPP_IMAGE_HEADER + sizeof(elmopp_weights_t) + 1U];
static elmopp_weights_t weights;
static elmopp_lstm_f32_state_t state;

static int broken(const char *what) {
    (void)fprintf(stderr, "lstm_probe: %s\n", what);
    return EXIT_BROKEN;
}

/* Bytes read into `image`, or a negative number. */
static int32_t read_image(const char *path) {
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        return -1;
    }
    const size_t length = fread(image, 1U, sizeof image, file);
    const bool good = ferror(file) == 0;
    (void)fclose(file);
    return good ? (int32_t)length : -1;
}

static bool write_row(const float row[ELMOPP_LSTM_INPUTS]) {
    return fwrite(row, sizeof(float), ELMOPP_LSTM_INPUTS, stdout) == ELMOPP_LSTM_INPUTS;
}

/* One row for each of `file`; false if that or writing fails. */
static bool absorb(FILE *file) {
    float row[ELMOPP_LSTM_INPUTS];
    size_t bytes = fread(row, 1U, ROW_BYTES, file);
    while (bytes == ROW_BYTES) {
        elmopp_lstm_f32_step(&weights.lstm, &state, row);
        elmopp_lstm_f32_output(&weights.lstm, &state, row);
        if (!write_row(row)) {
            return false;
        }
        bytes = fread(row, 1U, ROW_BYTES, file);
    }
    return (bytes == 0U) && (ferror(file) == 0);
}

static float clamp(float value, float low, float high) {
    const float not_less = (value < low) ? low : value;
    return (not_less > high) ? high : not_less;
}

static bool run_freely(unsigned long steps) {
    for (unsigned long t = 0U; t < steps; t++) {
        float row[ELMOPP_LSTM_INPUTS];
        elmopp_lstm_f32_output(&weights.lstm, &state, row);
        for (uint32_t k = 0U; k < ELMOPP_LSTM_INPUTS; k++) {
            row[k] = clamp(row[k], weights.low[k], weights.high[k]);
        }
        if (!write_row(row)) {
            return false;
        }
        elmopp_lstm_f32_step(&weights.lstm, &state, row);
    }
    return true;
}

static bool absorb_file(const char *path) {
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        return false;
    }
    const bool good = absorb(file);
    (void)fclose(file);
    return good;
}

int main(int argc, char **argv) {
    if (argc != 4) {
        return broken("usage: lstm_probe IMAGE INPUTS FREE");
    }
    char *end = NULL;
    errno = 0;
    const unsigned long steps = strtoul(argv[3], &end, 10);
    if ((errno != 0) || (end == argv[3]) || (*end != '\0') || (steps > FREE_MAX)) {
        return broken("FREE is no number of rows");
    }
    const int32_t length = read_image(argv[1]);
    if (length < 0) {
        return broken("IMAGE cannot be read");
    }
    const elmopp_weights_fault_t fault = elmopp_weights_load(image, (uint32_t)length, &weights);
    if (fault != ELMOPP_WEIGHTS_OK) {
        (void)fprintf(stderr, "lstm_probe: %s\n", elmopp_weights_fault_name(fault));
        return EXIT_REFUSED;
    }
    if (!absorb_file(argv[2])) {
        return broken("INPUTS cannot be read to its end, or nothing written");
    }
    if (!run_freely(steps) || (fflush(stdout) != 0)) {
        return broken("nothing can be written");
    }
    return EXIT_SUCCESS;
}
