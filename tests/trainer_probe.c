/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The trainer of the core as a program, for tests/python/test_trainer_reference.py:
///
///     trainer_probe IMAGE SAMPLE STEPS FED UNSCORED INPUTS RATE UPDATES
///
/// Loads the weights IMAGE, takes SAMPLE once (raw float32: the state before, hidden and three cells, then STEPS + 1
/// rows of four) and writes its error and all slopes; then makes UPDATES updates with RATE, the sample taken once for
/// each, and writes all weights. All of it is little-endian float32, parameters in the order of the image.
///
/// Exit status 1: it cannot.

#include "elmopp/image.h"
#include "elmopp/trainer.h"
#include "elmopp/weights.h"

#include <stdio.h>
#include <stdlib.h>

#define STATE_FLOATS (ELMOPP_LSTM_UNITS * (1U + ELMOPP_LSTM_LEVELS_MAX))

static uint8_t image[ELMOPP_IMAGE_HEADER + sizeof(elmopp_weights_t)];
static elmopp_weights_t weights;
static elmopp_lstm_f32_weights_t out;
static elmopp_trainer_memory_t memory;
static elmopp_trainer_inner_memory_t inner;
static elmopp_lstm_f32_state_t before;
static float seen[ELMOPP_TRAINER_WINDOW + 1U][ELMOPP_LSTM_INPUTS];

static int broken(const char *what) {
    (void)fprintf(stderr, "trainer_probe: %s\n", what);
    return 1;
}

static size_t read_into(const char *path, void *to, size_t bytes) {
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        return 0U;
    }
    const size_t got = fread(to, 1U, bytes, file);
    (void)fclose(file);
    return got;
}

static int read_sample(const char *path, uint32_t steps) {
    static float raw[STATE_FLOATS + ((ELMOPP_TRAINER_WINDOW + 1U) * ELMOPP_LSTM_INPUTS)];
    const size_t bytes = (STATE_FLOATS + ((steps + 1U) * ELMOPP_LSTM_INPUTS)) * sizeof raw[0];
    if (read_into(path, raw, sizeof raw) != bytes) {
        return 0;
    }
    for (uint32_t u = 0U; u < ELMOPP_LSTM_UNITS; u++) {
        before.hidden[u] = raw[u];
        for (uint32_t level = 0U; level < ELMOPP_LSTM_LEVELS_MAX; level++) {
            before.cell[level][u] = raw[((level + 1U) * ELMOPP_LSTM_UNITS) + u];
        }
    }
    for (uint32_t k = 0U; k < ((steps + 1U) * ELMOPP_LSTM_INPUTS); k++) {
        seen[k / ELMOPP_LSTM_INPUTS][k % ELMOPP_LSTM_INPUTS] = raw[STATE_FLOATS + k];
    }
    return 1;
}

static void write_part(const elmopp_trainer_plain_t *plain, const elmopp_lstm_f32_inner_t *levels, uint32_t count) {
    (void)fwrite(plain, sizeof *plain, 1U, stdout);
    (void)fwrite(levels, sizeof *levels, count - 1U, stdout);
}

int main(int argc, char **argv) {
    if (argc != 9) {
        return broken("usage: trainer_probe IMAGE SAMPLE STEPS FED UNSCORED INPUTS RATE UPDATES");
    }
    const uint32_t steps = (uint32_t)strtoul(argv[3], NULL, 10);
    if ((steps < 1U) || (steps > ELMOPP_TRAINER_WINDOW) || (read_sample(argv[2], steps) == 0)) {
        return broken("SAMPLE is none of STEPS steps");
    }
    if (elmopp_weights_load(image, (uint32_t)read_into(argv[1], image, sizeof image), &weights) != ELMOPP_WEIGHTS_OK) {
        return broken("IMAGE is none");
    }
    const elmopp_trainer_sample_t sample = {.before = &before,
                                            .seen = (const float (*)[ELMOPP_LSTM_INPUTS])seen,
                                            .steps = steps,
                                            .fed = (uint32_t)strtoul(argv[4], NULL, 10),
                                            .unscored = (uint32_t)strtoul(argv[5], NULL, 10),
                                            .inputs = (uint32_t)strtoul(argv[6], NULL, 10),
                                            .low = weights.low,
                                            .high = weights.high};
    elmopp_trainer_t trainer;
    elmopp_trainer_init(&trainer, &memory, &inner, &weights.lstm);
    const float error = elmopp_trainer_take(&trainer, &sample);
    (void)fwrite(&error, sizeof error, 1U, stdout);
    write_part(&memory.slope, inner.slope, trainer.levels);
    for (unsigned long n = strtoul(argv[8], NULL, 10); n > 0U; n--) {
        (void)elmopp_trainer_update(&trainer, strtof(argv[7], NULL));
        (void)elmopp_trainer_take(&trainer, &sample);
    }
    elmopp_trainer_copy(&trainer, &out);
    (void)fwrite(out.head_bias, sizeof out.head_bias, 1U, stdout);
    (void)fwrite(out.head_row, sizeof out.head_row, 1U, stdout);
    (void)fwrite(&out.outer, sizeof out.outer, 1U, stdout);
    (void)fwrite(out.inner, sizeof out.inner[0], trainer.levels - 1U, stdout);
    return (fflush(stdout) == 0) ? 0 : broken("nothing can be written");
}
