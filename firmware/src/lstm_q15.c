/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/lstm_q15.h"

#include "elmopp/assert.h"
#include "elmopp/elementary.h"

#include <assert.h>
#include <string.h>

#define UNITS ELMOPP_LSTM_UNITS
#define FED_MAX 32767.0F

/* What a step writes on. Words come first, so that what is fed begins at one, too, as the kernel wants. */
typedef struct {
    int32_t back[UNITS];
    int16_t fed[ELMOPP_LSTM_INNER_ROWS];
} sheet_t;

/* Rounded by way of a positive number, which a conversion rounds down. */
static int16_t fed_input(float scaled) {
    const float lifted = elmopp_bounded(scaled, FED_MAX) + 32768.5F;
    const int32_t rounded = (int32_t)lifted - 32768;
    return (int16_t)rounded;
}

static void feed_outermost(const elmopp_lstm_q15_weights_t *weights, const elmopp_lstm_q15_state_t *state,
                           const float input[ELMOPP_LSTM_INPUTS], int16_t fed[ELMOPP_LSTM_OUTER_ROWS]) {
    (void)memcpy(fed, state->hidden, sizeof state->hidden);
    for (uint32_t k = 0U; k < ELMOPP_LSTM_INPUTS; k++) {
        fed[UNITS + k] = fed_input((input[k] - weights->input_middle[k]) * weights->input_gain[k]);
    }
}

void elmopp_lstm_q15_step(const elmopp_lstm_q15_weights_t *weights, elmopp_lstm_q15_state_t *state,
                          const float input[ELMOPP_LSTM_INPUTS]) {
    ELMOPP_ASSERT((weights->levels >= 1U) && (weights->levels <= ELMOPP_LSTM_LEVELS_MAX));
    const uint32_t innermost = weights->levels - 1U;
    int32_t gate[ELMOPP_LSTM_LEVELS_MAX][ELMOPP_LSTM_GATES];
    sheet_t sheet;
    feed_outermost(weights, state, input, sheet.fed);
    elmopp_lstm_q15_kernel_outer(weights->outer, sheet.fed, gate[0]);
    for (uint32_t level = 0U; level < innermost; level++) {
        elmopp_lstm_q15_kernel_descend(gate[level], state->cell[level], sheet.fed);
        elmopp_lstm_q15_kernel_inner(weights->inner[level], sheet.fed, gate[level + 1U]);
    }
    elmopp_lstm_q15_kernel_advance(gate[innermost], state->cell[innermost], sheet.back);
    for (uint32_t level = innermost; level > 0U; level--) {
        elmopp_lstm_q15_kernel_release(gate[level - 1U], sheet.back, state->cell[level - 1U]);
    }
    elmopp_lstm_q15_kernel_hide(sheet.back, state->hidden);
}

static_assert(ELMOPP_LSTM_INPUTS == 4U, "the head's sums are written out");

void elmopp_lstm_q15_output(const elmopp_lstm_q15_weights_t *weights, const elmopp_lstm_q15_state_t *state,
                            float output[ELMOPP_LSTM_INPUTS]) {
    float a = weights->head_bias[0];
    float b = weights->head_bias[1];
    float c = weights->head_bias[2];
    float d = weights->head_bias[3];
    for (uint32_t r = 0U; r < UNITS; r++) {
        const float *row = weights->head_row[r];
        const float hidden = (float)state->hidden[r];
        a += row[0] * hidden;
        b += row[1] * hidden;
        c += row[2] * hidden;
        d += row[3] * hidden;
    }
    output[0] = a;
    output[1] = b;
    output[2] = c;
    output[3] = d;
}
