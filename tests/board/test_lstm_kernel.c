/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The Cortex-M4's kernel gives the bits of the portable one (portable_kernel.c), beyond what the contract asks: also
/// where sums overflow and what follows is no number. It writes nothing else and keeps the caller's registers.

#include "elmopp/lstm_kernel.h"
#include "kept_registers.h"
#include "random.h"
#include "unity.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#define CASES 600U
#define ROWS_MAX 32U
#define GUARD 0x5AA5C33CU

void portable_kernel_open(const float *bias, const float (*row)[ELMOPP_LSTM_GATES], const float *fed, uint32_t rows,
                          float *gate);
void portable_kernel_advance(const float *gate, const float *cell, float *next);
void portable_kernel_release(const float *gate, float *back, float *cell);

typedef enum {
    VALUES_ZERO,     ///< of either sign
    VALUES_ORDINARY, ///< below 4 in size
    VALUES_STEEP,    ///< below 128
    VALUES_AT_BOUND, ///< about where tanh and sigmoid end
    VALUES_GREATEST, ///< up to 1000, the largest weight there is
    VALUES_LARGE,    ///< up to 1e30
    VALUES_TINY,     ///< subnormal
    VALUES_ANY,      ///< any bits, infinities too; a NaN becomes one
    VALUES_MIXED,    ///< each value of another kind, but of any bits
    VALUES_COUNT
} values_t;

/* With a guard behind what is written. */
typedef struct {
    float gate[ELMOPP_LSTM_GATES];
    uint32_t after_gate;
    float back[ELMOPP_LSTM_UNITS];
    uint32_t after_back;
    float cell[ELMOPP_LSTM_UNITS];
    uint32_t after_cell;
} written_t;

static float bias[ELMOPP_LSTM_GATES];
static float row[ROWS_MAX][ELMOPP_LSTM_GATES];
static const float (*const weights)[ELMOPP_LSTM_GATES] = (const float (*)[ELMOPP_LSTM_GATES])row;
static float fed[ROWS_MAX];
static written_t ours;
static written_t portable;
static uint64_t seed;

void setUp(void) {
    seed = 1U;
}
void tearDown(void) {}

static float float_of(uint32_t bits) {
    float value;
    (void)memcpy(&value, &bits, sizeof value);
    return value;
}

static float within(float size) {
    return ((float)random_below(&seed, 1U << 24U) - 8388608.0F) * (size / 8388608.0F);
}

static float with_sign(float size) {
    return (random_below(&seed, 2U) == 0U) ? size : -size;
}

/* Which of two NaNs a sum passes on is not in the contract. Those that sums make of infinities are compared. */
static float without_nan(uint32_t bits) {
    const bool is_nan = (bits & 0x7FFFFFFFU) > 0x7F800000U;
    return float_of(is_nan ? (bits & 0xFF800000U) : bits);
}

static float value_of(values_t kind) {
    switch (kind) {
    case VALUES_ORDINARY:
        return within(4.0F);
    case VALUES_STEEP:
        return within(128.0F);
    case VALUES_AT_BOUND:
        return with_sign(((random_below(&seed, 2U) == 0U) ? 7.9F : 15.8F) + within(2.0e-6F));
    case VALUES_GREATEST:
        return within(1000.0F);
    case VALUES_LARGE:
        return within(1.0e30F);
    case VALUES_TINY:
        return with_sign(float_of(random_below(&seed, 1U << 23U)));
    case VALUES_ANY:
        return without_nan((uint32_t)random_next(&seed));
    case VALUES_MIXED:
        return value_of((values_t)random_below(&seed, VALUES_ANY));
    case VALUES_ZERO:
    case VALUES_COUNT:
    default:
        return with_sign(0.0F);
    }
}

static void fill(float *values, uint32_t count, values_t kind) {
    for (uint32_t i = 0U; i < count; i++) {
        values[i] = value_of(kind);
    }
}

static void begin(void) {
    (void)memset(&ours, 0x11, sizeof ours);
    ours.after_gate = GUARD;
    ours.after_back = GUARD;
    ours.after_cell = GUARD;
}

static void expect_same_bits(void) {
    TEST_ASSERT_EQUAL_HEX32_ARRAY(&portable, &ours, sizeof ours / sizeof(uint32_t));
}

static void open_case(uint32_t rows, values_t kind, values_t values) {
    begin();
    portable = ours;
    fill(bias, ELMOPP_LSTM_GATES, kind);
    fill(row[0], ROWS_MAX * ELMOPP_LSTM_GATES, kind);
    fill(fed, ROWS_MAX, values);
    elmopp_lstm_kernel_open(bias, weights, fed, rows, ours.gate);
    portable_kernel_open(bias, weights, fed, rows, portable.gate);
    expect_same_bits();
}

static void test_gates_have_the_portable_bits_for_every_kind_of_numbers(void) {
    static const uint32_t rows[] = {4U, 20U, 32U};
    for (uint32_t i = 0U; i < CASES; i++) {
        const values_t values = (values_t)(i % VALUES_COUNT);
        open_case(rows[i % 3U], (values_t)((i / VALUES_COUNT) % VALUES_COUNT), values);
    }
}

/* With no input the gates are the activations of the biases: each column and each float near the bounds. */
static void test_activations_have_the_portable_bits_over_all_floats(void) {
    (void)memset(fed, 0, sizeof fed);
    (void)memset(row, 0, sizeof row);
    begin();
    portable = ours;
    for (uint32_t bits = 0U; bits < 0x7F800000U; bits += 0x00010001U) {
        for (uint32_t i = 0U; i < ELMOPP_LSTM_GATES; i++) {
            bias[i] = float_of((bits + (i * 0x0401U)) ^ ((i % 2U) << 31U));
        }
        elmopp_lstm_kernel_open(bias, weights, fed, ELMOPP_LSTM_ROWS_AT_ONCE, ours.gate);
        portable_kernel_open(bias, weights, fed, ELMOPP_LSTM_ROWS_AT_ONCE, portable.gate);
        expect_same_bits();
    }
}

static void test_cells_have_the_portable_bits_for_every_kind_of_numbers(void) {
    for (uint32_t i = 0U; i < CASES; i++) {
        begin();
        fill(ours.gate, ELMOPP_LSTM_GATES, (values_t)((i / VALUES_COUNT) % VALUES_COUNT));
        fill(ours.cell, ELMOPP_LSTM_UNITS, (values_t)(i % VALUES_COUNT));
        portable = ours;
        elmopp_lstm_kernel_advance(ours.gate, ours.cell, ours.back);
        portable_kernel_advance(portable.gate, portable.cell, portable.back);
        expect_same_bits();
        elmopp_lstm_kernel_release(ours.gate, ours.back, ours.cell);
        portable_kernel_release(portable.gate, portable.back, portable.cell);
        expect_same_bits();
    }
}

static void test_the_callers_registers_are_kept(void) {
    begin();
    fill(ours.gate, ELMOPP_LSTM_GATES, VALUES_ORDINARY);
    const call_t open = {(uintptr_t)&elmopp_lstm_kernel_open,
                         {(uintptr_t)bias, (uintptr_t)row, (uintptr_t)fed, ROWS_MAX, (uintptr_t)ours.gate}};
    const call_t advance = {(uintptr_t)&elmopp_lstm_kernel_advance,
                            {(uintptr_t)ours.gate, (uintptr_t)ours.cell, (uintptr_t)ours.back, 0U, 0U}};
    const call_t release = {(uintptr_t)&elmopp_lstm_kernel_release,
                            {(uintptr_t)ours.gate, (uintptr_t)ours.back, (uintptr_t)ours.cell, 0U, 0U}};
    expect_registers_kept(&open);
    expect_registers_kept(&advance);
    expect_registers_kept(&release);
}

static void test_two_kernels_are_compared(void) {
    TEST_ASSERT_TRUE((uintptr_t)&elmopp_lstm_kernel_open != (uintptr_t)&portable_kernel_open);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_two_kernels_are_compared);
    RUN_TEST(test_gates_have_the_portable_bits_for_every_kind_of_numbers);
    RUN_TEST(test_activations_have_the_portable_bits_over_all_floats);
    RUN_TEST(test_cells_have_the_portable_bits_for_every_kind_of_numbers);
    RUN_TEST(test_the_callers_registers_are_kept);
    return UNITY_END();
}
