/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/lstm_quantize.h"

#include "elmopp/assert.h"
#include "elmopp/elementary.h"

#include <stddef.h>
#include <string.h>

#define UNITS ELMOPP_LSTM_UNITS
#define GATES ELMOPP_LSTM_GATES
#define ROWS_MAX ELMOPP_LSTM_INNER_ROWS

#define WEIGHT_MAX 32767.0F
#define SUM_GOAL 65500.0F ///< rounding adds half to each of ROWS_MAX weights, and a float's own errors less than 1
#define STEP_MIN 2.384185791015625e-7F ///< 2^-22: no row is finer
#define Q15_ONE 32768.0F
#define REACH_ONE 2097152.0F      ///< Q21
#define SCALE_ONE 274877906944.0F ///< 2^38: reach = (sum * scale) / 2^32, in Q21; sums are in Q15 and steps

/* One row as its level is fed: values in that order, and what they are multiplied with at most. */
typedef struct {
    float weight[ROWS_MAX]; ///< for values of at most 1 in size
    uint32_t count;
    float bias;
    float sum;     ///< of the weights' sizes
    float largest; ///< of them
} row_t;

/* A row's weights and bias in whole numbers. */
typedef struct {
    int16_t weight[ROWS_MAX];
    int32_t scale;
    int32_t bias;
} quantized_t;

/* What an input is when it is fed. */
typedef struct {
    float middle[ELMOPP_LSTM_INPUTS];
    float half[ELMOPP_LSTM_INPUTS]; ///< a value of 1 in Q15; the ends of the range are one step less
} inputs_t;

static float size_of(float value) {
    return elmopp_with_sign(value, 1.0F);
}

static int32_t nearest(float value) {
    return (int32_t)(value + elmopp_with_sign(0.5F, value));
}

static void look_at_inputs(const float low[ELMOPP_LSTM_INPUTS], const float high[ELMOPP_LSTM_INPUTS], inputs_t *out) {
    for (uint32_t k = 0U; k < ELMOPP_LSTM_INPUTS; k++) {
        const float width = elmopp_greater(ELMOPP_LSTM_QUANTIZE_WIDTH_MIN, high[k] - low[k]);
        out->middle[k] = low[k] + (0.5F * width);
        out->half[k] = (0.5F * width) * (Q15_ONE / WEIGHT_MAX);
    }
}

/* Adds the next weight to a row, and what it says of the row's sizes. */
static void add(row_t *row, float weight) {
    const float size = size_of(weight);
    row->weight[row->count] = weight;
    row->count++;
    row->sum += size;
    row->largest = elmopp_larger(size, row->largest);
}

/* A row of the outermost level, fed its hidden values, then its inputs. */
static void take_outer(const elmopp_lstm_f32_outer_t *level, const inputs_t *inputs, uint32_t column, row_t *row) {
    row->bias = level->bias[column];
    for (uint32_t k = 0U; k < UNITS; k++) {
        add(row, level->row[ELMOPP_LSTM_INPUTS + k][column]);
    }
    for (uint32_t k = 0U; k < ELMOPP_LSTM_INPUTS; k++) {
        add(row, level->row[k][column] * inputs->half[k]);
        row->bias += level->row[k][column] * inputs->middle[k];
    }
}

static void take_inner(const elmopp_lstm_f32_inner_t *level, uint32_t column, row_t *row) {
    row->bias = level->bias[column];
    for (uint32_t k = 0U; k < ELMOPP_LSTM_INNER_ROWS; k++) {
        add(row, level->row[k][column]);
    }
}

static void take(const elmopp_lstm_f32_weights_t *weights, const inputs_t *inputs, uint32_t level, uint32_t column,
                 row_t *row) {
    row->count = 0U;
    row->sum = 0.0F;
    row->largest = 0.0F;
    if (level == 0U) {
        take_outer(&weights->outer, inputs, column, row);
    } else {
        take_inner(&weights->inner[level - 1U], column, row);
    }
}

/* What one step of the row's weights stands for: neither a weight nor their sum may be too large. */
static float step_of(const row_t *row) {
    return elmopp_larger(elmopp_larger(row->largest / WEIGHT_MAX, row->sum / SUM_GOAL), STEP_MIN);
}

/* A sigmoid's table is read with half of what the row says. */
static void quantize_row(const row_t *row, bool is_sigmoid, quantized_t *out) {
    const float part = is_sigmoid ? 0.5F : 1.0F;
    const float step = step_of(row);
    const float factor = 1.0F / step;
    int32_t sum = 0;
    for (uint32_t k = 0U; k < row->count; k++) {
        const int32_t weight = nearest(row->weight[k] * factor);
        sum += (weight < 0) ? -weight : weight;
        out->weight[k] = (int16_t)weight;
    }
    ELMOPP_ASSERT(sum <= ELMOPP_LSTM_Q15_SUM_MAX);
    out->scale = nearest((part * SCALE_ONE) * step);
    out->bias = nearest(row->bias * (part * REACH_ONE));
}

static void put_outer(const quantized_t *from, uint32_t column, elmopp_lstm_q15_outer_t *bands) {
    elmopp_lstm_q15_outer_t *band = &bands[column / ELMOPP_LSTM_Q15_BAND];
    const uint32_t r = column % ELMOPP_LSTM_Q15_BAND;
    for (uint32_t run = 0U; run < ELMOPP_LSTM_Q15_OUTER_RUNS; run++) {
        (void)memcpy(band->hidden[run][r], &from->weight[run * ELMOPP_LSTM_Q15_RUN], sizeof band->hidden[run][r]);
    }
    (void)memcpy(band->input[r], &from->weight[UNITS], sizeof band->input[r]);
    band->scale[r] = from->scale;
    band->bias[r] = from->bias;
}

static void put_inner(const quantized_t *from, uint32_t column, elmopp_lstm_q15_inner_t *bands) {
    elmopp_lstm_q15_inner_t *band = &bands[column / ELMOPP_LSTM_Q15_BAND];
    const uint32_t r = column % ELMOPP_LSTM_Q15_BAND;
    for (uint32_t run = 0U; run < ELMOPP_LSTM_Q15_INNER_RUNS; run++) {
        (void)memcpy(band->fed[run][r], &from->weight[run * ELMOPP_LSTM_Q15_RUN], sizeof band->fed[run][r]);
    }
    band->scale[r] = from->scale;
    band->bias[r] = from->bias;
}

/* The first row that could reach too much, or that is no number. */
static elmopp_lstm_quantized_t judge(const elmopp_lstm_f32_weights_t *weights, const inputs_t *inputs) {
    for (uint32_t level = 0U; level < weights->levels; level++) {
        for (uint32_t column = 0U; column < GATES; column++) {
            row_t row;
            take(weights, inputs, level, column, &row);
            const float reach = size_of(row.bias) + row.sum;
            if (!(reach < ELMOPP_LSTM_QUANTIZE_REACH_MAX)) {
                return (elmopp_lstm_quantized_t){.made = false, .level = level, .column = column, .reach = reach};
            }
        }
    }
    return (elmopp_lstm_quantized_t){.made = true, .level = 0U, .column = 0U, .reach = 0.0F};
}

static void quantize_rows(const elmopp_lstm_f32_weights_t *weights, const inputs_t *inputs,
                          elmopp_lstm_q15_weights_t *out) {
    for (uint32_t level = 0U; level < weights->levels; level++) {
        for (uint32_t column = 0U; column < GATES; column++) {
            row_t row;
            quantized_t quantized = {.scale = 0, .bias = 0};
            take(weights, inputs, level, column, &row);
            quantize_row(&row, column < ELMOPP_LSTM_GATE_G, &quantized);
            if (level == 0U) {
                put_outer(&quantized, column, out->outer);
            } else {
                put_inner(&quantized, column, out->inner[level - 1U]);
            }
        }
    }
}

elmopp_lstm_quantized_t elmopp_lstm_quantize_check(const elmopp_lstm_f32_weights_t *weights,
                                                   const float low[ELMOPP_LSTM_INPUTS],
                                                   const float high[ELMOPP_LSTM_INPUTS]) {
    ELMOPP_ASSERT((weights->levels >= 1U) && (weights->levels <= ELMOPP_LSTM_LEVELS_MAX));
    inputs_t inputs;
    look_at_inputs(low, high, &inputs);
    return judge(weights, &inputs);
}

elmopp_lstm_quantized_t elmopp_lstm_quantize(const elmopp_lstm_f32_weights_t *weights,
                                             const float low[ELMOPP_LSTM_INPUTS], const float high[ELMOPP_LSTM_INPUTS],
                                             elmopp_lstm_q15_weights_t *out) {
    const elmopp_lstm_quantized_t result = elmopp_lstm_quantize_check(weights, low, high);
    inputs_t inputs;
    look_at_inputs(low, high, &inputs);
    if (!result.made) {
        return result;
    }
    (void)memset(out, 0, sizeof *out);
    out->levels = weights->levels;
    for (uint32_t k = 0U; k < ELMOPP_LSTM_INPUTS; k++) {
        out->head_bias[k] = weights->head_bias[k];
        out->input_middle[k] = inputs.middle[k];
        out->input_gain[k] = Q15_ONE / inputs.half[k];
        for (uint32_t r = 0U; r < UNITS; r++) {
            out->head_row[r][k] = weights->head_row[r][k] / Q15_ONE;
        }
    }
    quantize_rows(weights, &inputs, out);
    return result;
}
