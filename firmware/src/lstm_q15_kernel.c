/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/lstm_q15_kernel.h"

#include "elmopp/lstm_q15_table.h"

#define UNITS ELMOPP_LSTM_UNITS
#define GATES ELMOPP_LSTM_GATES
#define BAND ELMOPP_LSTM_Q15_BAND
#define RUN ELMOPP_LSTM_Q15_RUN

#define STRETCH_BITS 15U ///< of reach, to one entry of a table
#define CELL_MAX INT32_MAX
#define CELL_MIN INT32_MIN

#define LIFT_BITS 62U /* no product of two results, and no other value here, is larger in size than 2^62 */

/* value / 2^bits, rounded down. C leaves open what a shift does to a negative number: shifted is a positive one. */
static inline int64_t shift_down(int64_t value, uint32_t bits) {
    const uint64_t lift = (uint64_t)1U << LIFT_BITS;
    const int64_t positive = value + (int64_t)lift;
    const uint64_t shifted = (uint64_t)positive >> bits;
    const uint64_t lowered = lift >> bits;
    return (int64_t)shifted - (int64_t)lowered;
}

/* The product of two words / 2^bits, rounded to nearest. */
static inline int32_t product(int32_t a, int32_t b, uint32_t bits) {
    const uint32_t half_bit = bits - 1U;
    const uint64_t half = (uint64_t)1U << half_bit;
    const int64_t wide = a;
    const int64_t exact = wide * b;
    return (int32_t)shift_down(exact + (int64_t)half, bits);
}

static inline int32_t high(int32_t a, int32_t b) {
    return product(a, b, 32U);
}

/* The lower half of a word, with its sign. */
static inline int32_t lower_half(int32_t word) {
    const int64_t positive = (int64_t)word - INT32_MIN;
    const uint32_t lifted = ((uint32_t)positive ^ 0x8000U) & 0xFFFFU;
    return (int32_t)lifted - 0x8000;
}

static inline int32_t activate(const int32_t table[ELMOPP_LSTM_Q15_TABLE_SIZE], int32_t reach) {
    const int32_t last = (int32_t)ELMOPP_LSTM_Q15_TABLE_SIZE - 1;
    const int32_t at = (int32_t)shift_down(reach, STRETCH_BITS) + ELMOPP_LSTM_Q15_TABLE_ZERO;
    const int32_t not_less = (at < 0) ? 0 : at;
    const int32_t entry = table[(not_less > last) ? last : not_less];
    return entry + (lower_half(entry) * lower_half(reach));
}

/* Products of a row and what it is fed, `count` of them, added to a sum. */
static inline int32_t add_products(int32_t sum, const int16_t *weight, const int16_t *fed, uint32_t count) {
    int32_t total = sum;
    for (uint32_t k = 0U; k < count; k++) {
        total += (int32_t)weight[k] * (int32_t)fed[k];
    }
    return total;
}

/* Gates `first` to `first + BAND - 1`: no band has gates of two kinds. */
static void open_band(const int32_t sum[BAND], const int32_t scale[BAND], const int32_t bias[BAND], uint32_t first,
                      int32_t gate[GATES]) {
    const int32_t *table = (first >= ELMOPP_LSTM_GATE_G) ? elmopp_lstm_q15_tanh : elmopp_lstm_q15_sigmoid;
    for (uint32_t r = 0U; r < BAND; r++) {
        gate[first + r] = activate(table, bias[r] + high(scale[r], sum[r]));
    }
}

void elmopp_lstm_q15_kernel_outer(const elmopp_lstm_q15_outer_t *band, const int16_t fed[ELMOPP_LSTM_OUTER_ROWS],
                                  int32_t gate[GATES]) {
    for (uint32_t b = 0U; b < ELMOPP_LSTM_Q15_BANDS; b++) {
        int32_t sum[BAND];
        for (uint32_t r = 0U; r < BAND; r++) {
            sum[r] = add_products(0, band[b].input[r], &fed[UNITS], ELMOPP_LSTM_INPUTS);
            for (uint32_t run = 0U; run < ELMOPP_LSTM_Q15_OUTER_RUNS; run++) {
                sum[r] = add_products(sum[r], band[b].hidden[run][r], &fed[run * RUN], RUN);
            }
        }
        open_band(sum, band[b].scale, band[b].bias, b * BAND, gate);
    }
}

void elmopp_lstm_q15_kernel_inner(const elmopp_lstm_q15_inner_t *band, const int16_t fed[ELMOPP_LSTM_INNER_ROWS],
                                  int32_t gate[GATES]) {
    for (uint32_t b = 0U; b < ELMOPP_LSTM_Q15_BANDS; b++) {
        int32_t sum[BAND];
        for (uint32_t r = 0U; r < BAND; r++) {
            sum[r] = 0;
            for (uint32_t run = 0U; run < ELMOPP_LSTM_Q15_INNER_RUNS; run++) {
                sum[r] = add_products(sum[r], band[b].fed[run][r], &fed[run * RUN], RUN);
            }
        }
        open_band(sum, band[b].scale, band[b].bias, b * BAND, gate);
    }
}

void elmopp_lstm_q15_kernel_descend(const int32_t gate[GATES], const int32_t cell[UNITS],
                                    int16_t fed[ELMOPP_LSTM_INNER_ROWS]) {
    for (uint32_t r = 0U; r < UNITS; r++) {
        fed[r] = (int16_t)product(gate[ELMOPP_LSTM_GATE_I + r], gate[ELMOPP_LSTM_GATE_G + r], 47U);
        fed[UNITS + r] = (int16_t)product(gate[ELMOPP_LSTM_GATE_F + r], cell[r], 46U);
    }
}

/* Of Q30 and Q21 parts: each is rounded by itself, and the sum saturates. */
static inline int32_t next_cell(int32_t i, int32_t g, int32_t f, int32_t cell) {
    const int64_t sum = shift_down(high(i, g), 9U) + (2 * (int64_t)high(f, cell));
    const int64_t not_less = (sum < CELL_MIN) ? CELL_MIN : sum;
    return (int32_t)((not_less > CELL_MAX) ? CELL_MAX : not_less);
}

void elmopp_lstm_q15_kernel_advance(const int32_t gate[GATES], int32_t cell[UNITS], int32_t back[UNITS]) {
    for (uint32_t r = 0U; r < UNITS; r++) {
        cell[r] = next_cell(gate[ELMOPP_LSTM_GATE_I + r], gate[ELMOPP_LSTM_GATE_G + r], gate[ELMOPP_LSTM_GATE_F + r],
                            cell[r]);
        back[r] = high(gate[ELMOPP_LSTM_GATE_O + r], activate(elmopp_lstm_q15_tanh, cell[r]));
    }
}

void elmopp_lstm_q15_kernel_release(const int32_t gate[GATES], int32_t back[UNITS], int32_t cell[UNITS]) {
    for (uint32_t r = 0U; r < UNITS; r++) {
        cell[r] = back[r];
        const int32_t reach = (int32_t)shift_down(back[r], 9U);
        back[r] = high(gate[ELMOPP_LSTM_GATE_O + r], activate(elmopp_lstm_q15_tanh, reach));
    }
}

void elmopp_lstm_q15_kernel_hide(const int32_t back[UNITS], int16_t hidden[UNITS]) {
    for (uint32_t r = 0U; r < UNITS; r++) {
        hidden[r] = (int16_t)product(back[r], 1, 15U);
    }
}
