/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The Cortex-M4's kernel in whole numbers gives the bits of the portable one (portable_q15_kernel.c) for every kind of
/// numbers that a step can bring, to the ends of their words. It writes nothing else and keeps the caller's registers.

#include "elmopp/lstm_q15_kernel.h"
#include "elmopp/lstm_q15_table.h"
#include "kept_registers.h"
#include "random.h"
#include "unity.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define CASES 300U
#define ROUNDED_CASES 40000U
#define UNITS ELMOPP_LSTM_UNITS
#define GATES ELMOPP_LSTM_GATES
#define BAND ELMOPP_LSTM_Q15_BAND
#define BANDS ELMOPP_LSTM_Q15_BANDS
#define GUARD 0x5AA5C33C
#define TANH_MAX 0x7FFF7FFF
#define BACK_MAX (((int32_t)1 << 30) - ((int32_t)1 << 15))

void portable_q15_outer(const elmopp_lstm_q15_outer_t *band, const int16_t *fed, int32_t *gate);
void portable_q15_inner(const elmopp_lstm_q15_inner_t *band, const int16_t *fed, int32_t *gate);
void portable_q15_descend(const int32_t *gate, const int32_t *cell, int16_t *fed);
void portable_q15_advance(const int32_t *gate, int32_t *cell, int32_t *back);
void portable_q15_release(const int32_t *gate, int32_t *back, int32_t *cell);
void portable_q15_hide(const int32_t *back, int16_t *hidden);

/* With a guard behind what is written. */
typedef struct {
    int32_t gate[GATES];
    int32_t after_gate;
    int32_t cell[UNITS];
    int32_t after_cell;
    int32_t back[UNITS];
    int32_t after_back;
    int16_t fed[2U * UNITS];
    int32_t after_fed;
    int16_t hidden[UNITS];
    int32_t after_hidden;
} written_t;

static elmopp_lstm_q15_outer_t outer[BANDS];
static elmopp_lstm_q15_inner_t inner[BANDS];
static written_t ours;
static written_t portable;
static uint64_t seed;

void setUp(void) {
    seed = 1U;
    (void)memset(&ours, 0x11, sizeof ours);
    ours.after_gate = GUARD;
    ours.after_cell = GUARD;
    ours.after_back = GUARD;
    ours.after_fed = GUARD;
    ours.after_hidden = GUARD;
}
void tearDown(void) {}

static void expect_same_bits(void) {
    TEST_ASSERT_EQUAL_HEX32_ARRAY(&portable, &ours, sizeof ours / sizeof(int32_t));
    TEST_ASSERT_EQUAL_HEX32(GUARD, ours.after_gate);
    TEST_ASSERT_EQUAL_HEX32(GUARD, ours.after_cell);
    TEST_ASSERT_EQUAL_HEX32(GUARD, ours.after_back);
    TEST_ASSERT_EQUAL_HEX32(GUARD, ours.after_fed);
    TEST_ASSERT_EQUAL_HEX32(GUARD, ours.after_hidden);
}

/* Within +-most, often at an end, often small. */
static int32_t any_within(int32_t most) {
    const uint32_t kind = random_below(&seed, 8U);
    const uint32_t span = (kind == 0U) ? 3U : (uint32_t)most;
    const int32_t size = (kind < 2U) ? (most - (int32_t)random_below(&seed, 3U)) : (int32_t)random_below(&seed, span);
    return (random_below(&seed, 2U) == 0U) ? size : -size;
}

static int16_t any_half(void) {
    return (int16_t)((random_below(&seed, 4U) == 0U) ? (-32768 + (int32_t)random_below(&seed, 2U))
                                                     : ((int32_t)random_below(&seed, 65536U) - 32768));
}

/* Weights of a row whose sizes are together at most what they may be, in an order that begins anywhere. */
static void fill_row(int16_t *weight, uint32_t count) {
    int32_t left = ELMOPP_LSTM_Q15_SUM_MAX;
    const uint32_t begin = random_below(&seed, count);
    const uint32_t share = 1U + random_below(&seed, count);
    for (uint32_t i = 0U; i < count; i++) {
        const int32_t most = (left / (int32_t)share < 32767) ? (left / (int32_t)share) : 32767;
        const int32_t value = any_within((most > 3) ? most : 3);
        const int32_t size = abs(value);
        const bool fits = size <= left;
        weight[(begin + i) % count] = (int16_t)(fits ? value : 0);
        left -= fits ? size : 0;
    }
}

static void fill_bands(void) {
    for (uint32_t b = 0U; b < BANDS; b++) {
        for (uint32_t r = 0U; r < BAND; r++) {
            int16_t row[2U * UNITS];
            fill_row(row, UNITS + ELMOPP_LSTM_INPUTS);
            (void)memcpy(outer[b].hidden[0][r], &row[0], 16U);
            (void)memcpy(outer[b].hidden[1][r], &row[8], 16U);
            (void)memcpy(outer[b].input[r], &row[UNITS], 8U);
            outer[b].scale[r] = abs(any_within((int32_t)1 << 30));
            outer[b].bias[r] = any_within((int32_t)1 << 28);
            fill_row(row, 2U * UNITS);
            for (uint32_t run = 0U; run < ELMOPP_LSTM_Q15_INNER_RUNS; run++) {
                (void)memcpy(inner[b].fed[run][r], &row[8U * run], 16U);
            }
            inner[b].scale[r] = abs(any_within((int32_t)1 << 30));
            inner[b].bias[r] = any_within((int32_t)1 << 28);
        }
    }
}

static void test_gates_have_the_portable_bits_for_every_kind_of_numbers(void) {
    for (uint32_t i = 0U; i < CASES; i++) {
        fill_bands();
        for (uint32_t k = 0U; k < (2U * UNITS); k++) {
            ours.fed[k] = any_half();
        }
        portable = ours;
        elmopp_lstm_q15_kernel_outer(outer, ours.fed, ours.gate);
        portable_q15_outer(outer, portable.fed, portable.gate);
        expect_same_bits();
        elmopp_lstm_q15_kernel_inner(inner, ours.fed, ours.gate);
        portable_q15_inner(inner, portable.fed, portable.gate);
        expect_same_bits();
    }
}

/* By the biases of rows without weights: every entry of both tables, and what is beyond, to the ends of a word. */
static void test_activations_have_the_portable_bits_over_all_reaches(void) {
    (void)memset(outer, 0, sizeof outer);
    (void)memset(ours.fed, 0, sizeof ours.fed);
    int64_t reach = -((int64_t)1 << 25);
    uint32_t ends = 0U;
    while (reach < ((int64_t)1 << 25)) {
        for (uint32_t k = 0U; k < GATES; k++) {
            const int64_t step = (k < (GATES / 2U)) ? k : (k * 2047);
            const int32_t end = ((ends % 2U) == 0U) ? INT32_MAX : INT32_MIN;
            outer[k / BAND].bias[k % BAND] = (ends < 4U) ? (end / (1 + (int32_t)k)) : (int32_t)(reach + step);
        }
        ends++;
        reach += 16381 * 4;
        portable = ours;
        elmopp_lstm_q15_kernel_outer(outer, ours.fed, ours.gate);
        portable_q15_outer(outer, portable.fed, portable.gate);
        expect_same_bits();
    }
}

static void fill_gates(void) {
    for (uint32_t k = 0U; k < GATES; k++) {
        ours.gate[k] = (k < ELMOPP_LSTM_GATE_G) ? abs(any_within(INT32_MAX)) : any_within(TANH_MAX);
    }
}

static void test_cells_have_the_portable_bits_to_the_ends_of_their_words(void) {
    for (uint32_t i = 0U; i < CASES; i++) {
        fill_gates();
        for (uint32_t k = 0U; k < UNITS; k++) {
            ours.back[k] = any_within(BACK_MAX);
            ours.cell[k] = any_within(INT32_MAX);
        }
        portable = ours;
        elmopp_lstm_q15_kernel_hide(ours.back, ours.hidden);
        portable_q15_hide(portable.back, portable.hidden);
        elmopp_lstm_q15_kernel_release(ours.gate, ours.back, ours.cell);
        portable_q15_release(portable.gate, portable.back, portable.cell);
        expect_same_bits();
        elmopp_lstm_q15_kernel_descend(ours.gate, ours.cell, ours.fed);
        portable_q15_descend(portable.gate, portable.cell, portable.fed);
        expect_same_bits();
        for (uint32_t k = 0U; k < UNITS; k++) {
            ours.cell[k] = any_within(INT32_MAX);
        }
        ours.cell[0] = INT32_MIN;
        portable = ours;
        elmopp_lstm_q15_kernel_advance(ours.gate, ours.cell, ours.back);
        portable_q15_advance(portable.gate, portable.cell, portable.back);
        expect_same_bits();
    }
}

/* Where a kernel rounds twice, or not at all, one value in 2^15 shows it. */
static void test_what_is_fed_inwards_is_rounded_once(void) {
    for (uint32_t i = 0U; i < ROUNDED_CASES; i++) {
        for (uint32_t k = 0U; k < GATES; k++) {
            ours.gate[k] = (int32_t)(random_next(&seed) >> 33U);
        }
        for (uint32_t k = 0U; k < UNITS; k++) {
            ours.cell[k] = (int32_t)(random_next(&seed) >> 34U) - ((int32_t)1 << 29);
        }
        elmopp_lstm_q15_kernel_descend(ours.gate, ours.cell, ours.fed);
        portable_q15_descend(ours.gate, ours.cell, portable.fed);
        TEST_ASSERT_EQUAL_HEX16_ARRAY(portable.fed, ours.fed, 2U * UNITS);
    }
}

static void test_the_callers_registers_are_kept(void) {
    fill_bands();
    fill_gates();
    (void)memset(ours.cell, 0, sizeof ours.cell);
    const call_t calls[] = {
        {(uintptr_t)&elmopp_lstm_q15_kernel_outer,
         {(uintptr_t)outer, (uintptr_t)ours.fed, (uintptr_t)ours.gate, 0U, 0U}},
        {(uintptr_t)&elmopp_lstm_q15_kernel_inner,
         {(uintptr_t)inner, (uintptr_t)ours.fed, (uintptr_t)ours.gate, 0U, 0U}},
        {(uintptr_t)&elmopp_lstm_q15_kernel_descend,
         {(uintptr_t)ours.gate, (uintptr_t)ours.cell, (uintptr_t)ours.fed, 0U, 0U}},
        {(uintptr_t)&elmopp_lstm_q15_kernel_advance,
         {(uintptr_t)ours.gate, (uintptr_t)ours.cell, (uintptr_t)ours.back, 0U, 0U}},
        {(uintptr_t)&elmopp_lstm_q15_kernel_release,
         {(uintptr_t)ours.gate, (uintptr_t)ours.back, (uintptr_t)ours.cell, 0U, 0U}},
        {(uintptr_t)&elmopp_lstm_q15_kernel_hide, {(uintptr_t)ours.back, (uintptr_t)ours.hidden, 0U, 0U, 0U}},
    };
    for (uint32_t i = 0U; i < (sizeof calls / sizeof calls[0]); i++) {
        expect_registers_kept(&calls[i]);
    }
}

static void test_two_kernels_are_compared(void) {
    TEST_ASSERT_TRUE((uintptr_t)&elmopp_lstm_q15_kernel_outer != (uintptr_t)&portable_q15_outer);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_two_kernels_are_compared);
    RUN_TEST(test_gates_have_the_portable_bits_for_every_kind_of_numbers);
    RUN_TEST(test_activations_have_the_portable_bits_over_all_reaches);
    RUN_TEST(test_cells_have_the_portable_bits_to_the_ends_of_their_words);
    RUN_TEST(test_what_is_fed_inwards_is_rounded_once);
    RUN_TEST(test_the_callers_registers_are_kept);
    return UNITY_END();
}
