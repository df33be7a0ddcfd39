/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Any bytes as weights. First byte even: the rest is the image. Odd: the rest are changes of the shipped weights,
/// which get a right envelope.
///
/// Nothing beyond the image is read, a refused one leaves the caller's copy alone, and with one that is loaded the
/// networks say finite numbers, however long they run on what they said themselves.

#include "elmopp/weights.h"
#include "elmopp_weights.h"
#include "fuzz_input.h"
#include "image_writer.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define CANARY 0xA5
#define STEPS 70U
#define VERSION 2U

static float clamped(float value, float low, float high) {
    const float at_least = (value > low) ? value : low;
    return (at_least < high) ? at_least : high;
}

static void run_recurrent(const elmopp_weights_t *weights) {
    elmopp_lstm_f32_state_t state;
    (void)memset(&state, 0, sizeof state);
    float value[ELMOPP_LSTM_INPUTS];
    (void)memcpy(value, weights->high, sizeof value);
    for (uint32_t i = 0U; i < STEPS; i++) {
        elmopp_lstm_f32_step(&weights->lstm, &state, value);
        elmopp_lstm_f32_output(&weights->lstm, &state, value);
        for (uint32_t k = 0U; k < ELMOPP_LSTM_INPUTS; k++) {
            FUZZ_CHECK(isfinite(value[k]));
            value[k] = clamped(value[k], weights->low[k], weights->high[k]);
        }
    }
}

/* Four windows that begin full of the highest values, moved on by what the network says. */
static void run_windows(const elmopp_weights_t *weights, bool graph) {
    static float past[ELMOPP_GCN_NODES_MAX][ELMOPP_GCN_WINDOW_S + STEPS];
    static const uint8_t joined[ELMOPP_GCN_NODES_MAX] = {0x02U, 0x05U, 0x02U, 0U, 0U, 0U, 0U, 0U};
    elmopp_gcn_f32_graph_t path;
    elmopp_gcn_f32_join(&path, ELMOPP_ANN_INPUTS, joined);
    for (uint32_t k = 0U; k < (ELMOPP_ANN_INPUTS * ELMOPP_GCN_WINDOW_S); k++) {
        past[k / ELMOPP_GCN_WINDOW_S][k % ELMOPP_GCN_WINDOW_S] = weights->high[k / ELMOPP_GCN_WINDOW_S];
    }
    for (uint32_t i = 0U; i < STEPS; i++) {
        const float *window[ELMOPP_GCN_NODES_MAX];
        float next[ELMOPP_GCN_NODES_MAX] = {0.0F};
        for (uint32_t k = 0U; k < ELMOPP_GCN_NODES_MAX; k++) {
            window[k] = &past[k][i + (graph ? 0U : (ELMOPP_GCN_WINDOW_S - ELMOPP_ANN_WINDOW_S))];
        }
        if (graph) {
            elmopp_gcn_f32_next(&weights->gcn, &path, window, next);
        } else {
            elmopp_ann_f32_next(&weights->ann, window, next);
        }
        for (uint32_t k = 0U; k < ELMOPP_ANN_INPUTS; k++) {
            FUZZ_CHECK(isfinite(next[k]));
            past[k][i + ELMOPP_GCN_WINDOW_S] = clamped(next[k], weights->low[k], weights->high[k]);
        }
    }
}

static void load(const uint8_t *image, uint32_t length) {
    static elmopp_weights_t canary;
    static elmopp_weights_t out;
    (void)memset(&canary, CANARY, sizeof canary);
    (void)memset(&out, CANARY, sizeof out);
    const elmopp_weights_fault_t fault = elmopp_weights_load(image, length, &out);
    FUZZ_CHECK(elmopp_weights_fault_name(fault) != NULL);
    if (fault == ELMOPP_WEIGHTS_OK) {
        run_recurrent(&out);
        run_windows(&out, false);
        run_windows(&out, true);
    } else {
        FUZZ_CHECK(memcmp(&out, &canary, sizeof out) == 0);
    }
}

void fuzz_try(fuzz_input_t *input) {
    const uint8_t how = fuzz_byte(input);
    if ((how % 2U) == 0U) {
        uint8_t *exact = malloc(input->left);
        if (exact != NULL) {
            (void)memcpy(exact, input->at, input->left);
            load(exact, (uint32_t)input->left);
        }
        free(exact);
    } else {
        static uint8_t image[16U + sizeof(elmopp_weights_t)];
        const elmopp_weights_t *shipped = (((how / 2U) % 2U) == 0U) ? &elmopp_weights_lstm : &elmopp_weights_nlstm;
        (void)memcpy(&image[16], shipped, sizeof *shipped);
        fuzz_change(input, &image[16], sizeof *shipped);
        image_seal(image, "ELMW", VERSION, sizeof *shipped);
        load(image, sizeof image);
    }
}
