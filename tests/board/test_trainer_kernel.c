/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The Cortex-M4's trainer kernel gives the bits of the portable one (portable_trainer_kernel.c), also where numbers
/// overflow: then both have no number in the same places. It writes nothing else and keeps the caller's registers.

#include "elmopp/trainer_kernel.h"
#include "random.h"
#include "unity.h"

#include <stdint.h>
#include <string.h>

#define CASES 300U
#define UNITS ELMOPP_LSTM_UNITS
#define GATES ELMOPP_LSTM_GATES
#define ROWS 20U
#define STEPS 30U
#define COUNT 64U
#define SPACE 4U ///< floats behind everything that is written, which stay as they are
#define KEPT 24U ///< s16 to s31, r4 to r11

void portable_trainer_release(float *gate, const float *cell, const float *back_slope, float *cell_slope);
void portable_trainer_advance(float *gate, const float *cell, const float *made_slope, const float *kept_slope,
                              float *cell_slope);
void portable_trainer_answer(const float (*row)[4], const float *said_slope, const float *hidden, float *hidden_slope,
                             float (*row_slope)[4]);
void portable_trainer_project(const float (*row)[GATES], uint32_t rows, const float *gate_slope, float *fed_slope);
void portable_trainer_gather(const float *fed, uint32_t stride, const float (*gate_slope)[GATES], uint32_t steps,
                             float *row_slope);
float portable_trainer_squares(const float *slope, uint32_t count, float sum);
void portable_trainer_descend(const elmopp_trainer_descent_t *descent, float *weight, float *slope, float *mean,
                              float *square, uint32_t count);

/* What the functions write: one for ours, one for the portable ones. */
typedef struct {
    float gate[GATES + SPACE];
    float cell_slope[UNITS + SPACE];
    float hidden_slope[UNITS + SPACE];
    float row_slope[COUNT + SPACE];
    float fed_slope[ROWS + SPACE];
    float weight[COUNT + SPACE];
    float slope[COUNT + SPACE];
    float mean[COUNT + SPACE];
    float square[COUNT + SPACE];
} written_t;

static written_t ours;
static written_t portable;
static float cell[UNITS];
static float back[UNITS];
static float row[ROWS][GATES];
static float gates[STEPS][GATES];
static float fed[STEPS * 16U];
static const float (*const rows)[GATES] = (const float (*)[GATES])row;
static const float (*const slopes)[GATES] = (const float (*)[GATES])gates;
static uint64_t seed;

void setUp(void) {
    seed = 1U;
}
void tearDown(void) {}

static float value_of(uint32_t kind) {
    static const float size[] = {0.0F, 1.0e-30F, 1.0e-3F, 1.0F, 4.0F, 128.0F, 1000.0F, 1.0e19F, 1.0e30F};
    const float of_kind = size[kind % (sizeof size / sizeof size[0])];
    return ((float)random_below(&seed, 1U << 24U) - 8388608.0F) * (of_kind / 8388608.0F);
}

static void fill(float *values, uint32_t count, uint32_t kind) {
    for (uint32_t k = 0U; k < count; k++) {
        values[k] = value_of(kind);
    }
}

static float size_of(float value) {
    return (value < 0.0F) ? -value : value;
}

/* Both start alike; gates are what gates can be. */
static void begin(uint32_t kind) {
    fill(ours.gate, sizeof ours / sizeof(float), kind);
    for (uint32_t g = 0U; g < GATES; g++) {
        ours.gate[g] = value_of(3U);
        ours.gate[g] = (g < ELMOPP_LSTM_GATE_G) ? size_of(ours.gate[g]) : ours.gate[g];
    }
    for (uint32_t k = 0U; k < COUNT; k++) {
        ours.square[k] = size_of(ours.square[k]);
    }
    portable = ours;
    fill(cell, UNITS, kind + 1U);
    fill(back, UNITS, kind);
    fill(row[0], ROWS * GATES, kind);
    fill(gates[0], STEPS * GATES, kind + 1U);
    fill(fed, STEPS * 16U, kind);
}

/* Which NaN comes out is not in the contract. */
static uint32_t comparable(float value) {
    uint32_t bits;
    (void)memcpy(&bits, &value, sizeof bits);
    return ((bits & 0x7FFFFFFFU) > 0x7F800000U) ? 0x7FC00000U : bits;
}

static void expect_same_bits(void) {
    for (uint32_t k = 0U; k < (sizeof ours / sizeof(float)); k++) {
        float one;
        float other;
        (void)memcpy(&one, (const uint8_t *)&portable + (k * sizeof one), sizeof one);
        (void)memcpy(&other, (const uint8_t *)&ours + (k * sizeof other), sizeof other);
        TEST_ASSERT_EQUAL_HEX32(comparable(one), comparable(other));
    }
}

static void test_ways_through_a_level_have_the_portable_bits(void) {
    for (uint32_t i = 0U; i < CASES; i++) {
        begin(i);
        elmopp_trainer_kernel_release(ours.gate, cell, back, ours.cell_slope);
        portable_trainer_release(portable.gate, cell, back, portable.cell_slope);
        expect_same_bits();
        elmopp_trainer_kernel_advance(ours.gate, cell, back, ours.hidden_slope, ours.cell_slope);
        portable_trainer_advance(portable.gate, cell, back, portable.hidden_slope, portable.cell_slope);
        expect_same_bits();
        /* As in the innermost level: one slope for all three. */
        elmopp_trainer_kernel_advance(ours.gate, cell, ours.cell_slope, ours.cell_slope, ours.cell_slope);
        portable_trainer_advance(portable.gate, cell, portable.cell_slope, portable.cell_slope, portable.cell_slope);
        expect_same_bits();
    }
}

static void test_ways_through_head_and_sums_have_the_portable_bits(void) {
    for (uint32_t i = 0U; i < CASES; i++) {
        begin(i);
        elmopp_trainer_kernel_answer((const float (*)[4])row, back, cell, ours.hidden_slope,
                                     (float (*)[4])ours.row_slope);
        portable_trainer_answer((const float (*)[4])row, back, cell, portable.hidden_slope,
                                (float (*)[4])portable.row_slope);
        const uint32_t count = i % (ROWS + 1U);
        elmopp_trainer_kernel_project(rows, count, gates[0], ours.fed_slope);
        portable_trainer_project(rows, count, gates[0], portable.fed_slope);
        expect_same_bits();
    }
}

static void test_gathered_rows_have_the_portable_bits_for_every_stride_and_length(void) {
    static const uint32_t strides[] = {0U, 4U, 16U};
    for (uint32_t i = 0U; i < CASES; i++) {
        begin(i);
        const uint32_t stride = strides[i % 3U];
        const uint32_t steps = (i / 3U) % (STEPS + 1U);
        elmopp_trainer_kernel_gather(fed, stride, slopes, steps, ours.row_slope);
        portable_trainer_gather(fed, stride, slopes, steps, portable.row_slope);
        expect_same_bits();
    }
}

static void test_descents_have_the_portable_bits(void) {
    for (uint32_t i = 0U; i < CASES; i++) {
        begin(i);
        const uint32_t count = 4U * (i % 17U);
        const elmopp_trainer_descent_t by = {size_of(value_of(3U)), 0.1F, 0.001F, value_of(2U), 1.0e-16F};
        const float sum = size_of(value_of(i));
        TEST_ASSERT_EQUAL_HEX32(comparable(portable_trainer_squares(portable.slope, count, sum)),
                                comparable(elmopp_trainer_kernel_squares(ours.slope, count, sum)));
        elmopp_trainer_kernel_descend(&by, ours.weight, ours.slope, ours.mean, ours.square, count);
        portable_trainer_descend(&by, portable.weight, portable.slope, portable.mean, portable.square, count);
        expect_same_bits();
    }
}

/* A function with up to six arguments, and what the registers that it must keep hold before and after it. */
typedef struct {
    uintptr_t function;
    uintptr_t argument[6];
} call_t;

void call_six_and_record(const call_t *call, const uint32_t before[KEPT], uint32_t after[KEPT]);
__asm__(".thumb_func\ncall_six_and_record:\n\t"
        "push {r4-r11, lr}\n\tvpush {s16-s31}\n\tpush {r1-r3}\n\t"
        "vldmia r1!, {s16-s31}\n\tldm r1, {r4-r11}\n\t"
        "ldr r12, [r0, #24]\n\tldr r3, [r0, #20]\n\tpush {r3, r12}\n\tldr r12, [r0]\n\t"
        "ldr r1, [r0, #8]\n\tldr r2, [r0, #12]\n\tldr r3, [r0, #16]\n\tldr r0, [r0, #4]\n\tblx r12\n\t"
        "add sp, #8\n\tpop {r1-r3}\n\tvstmia r2!, {s16-s31}\n\tstmia r2, {r4-r11}\n\t"
        "vpop {s16-s31}\n\tpop {r4-r11, pc}");

static void expect_registers_kept(uintptr_t function, const uintptr_t argument[6]) {
    uint32_t before[KEPT];
    uint32_t after[KEPT] = {0U};
    call_t call = {.function = function};
    (void)memcpy(call.argument, argument, sizeof call.argument);
    for (uint32_t i = 0U; i < KEPT; i++) {
        before[i] = 0x3F000000U + (i * 0x01010101U);
    }
    call_six_and_record(&call, before, after);
    TEST_ASSERT_EQUAL_HEX32_ARRAY(before, after, KEPT);
}

static void test_the_callers_registers_are_kept(void) {
    static const elmopp_trainer_descent_t by = {0.5F, 0.1F, 0.001F, 1.0e-3F, 1.0e-16F};
    begin(3U);
    const uintptr_t gate = (uintptr_t)ours.gate;
    const uintptr_t at_cell = (uintptr_t)cell;
    const uintptr_t at_back = (uintptr_t)back;
    const uintptr_t release[6] = {gate, at_cell, at_back, (uintptr_t)ours.cell_slope, 0U, 0U};
    const uintptr_t advance[6] = {gate, at_cell, at_back, at_back, (uintptr_t)ours.cell_slope, 0U};
    const uintptr_t answer[6] = {
        (uintptr_t)row, at_back, at_cell, (uintptr_t)ours.hidden_slope, (uintptr_t)ours.row_slope, 0U};
    const uintptr_t project[6] = {(uintptr_t)row, ROWS, (uintptr_t)gates, (uintptr_t)ours.fed_slope, 0U, 0U};
    const uintptr_t gather[6] = {(uintptr_t)fed, 16U, (uintptr_t)gates, STEPS, (uintptr_t)ours.row_slope, 0U};
    const uintptr_t squares[6] = {(uintptr_t)ours.slope, COUNT, 0U, 0U, 0U, 0U};
    const uintptr_t descend[6] = {(uintptr_t)&by,       (uintptr_t)ours.weight, (uintptr_t)ours.slope,
                                  (uintptr_t)ours.mean, (uintptr_t)ours.square, COUNT};
    expect_registers_kept((uintptr_t)&elmopp_trainer_kernel_release, release);
    expect_registers_kept((uintptr_t)&elmopp_trainer_kernel_advance, advance);
    expect_registers_kept((uintptr_t)&elmopp_trainer_kernel_answer, answer);
    expect_registers_kept((uintptr_t)&elmopp_trainer_kernel_project, project);
    expect_registers_kept((uintptr_t)&elmopp_trainer_kernel_gather, gather);
    expect_registers_kept((uintptr_t)&elmopp_trainer_kernel_squares, squares);
    expect_registers_kept((uintptr_t)&elmopp_trainer_kernel_descend, descend);
}

static void test_two_kernels_are_compared(void) {
    TEST_ASSERT_TRUE((uintptr_t)&elmopp_trainer_kernel_gather != (uintptr_t)&portable_trainer_gather);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_two_kernels_are_compared);
    RUN_TEST(test_ways_through_a_level_have_the_portable_bits);
    RUN_TEST(test_ways_through_head_and_sums_have_the_portable_bits);
    RUN_TEST(test_gathered_rows_have_the_portable_bits_for_every_stride_and_length);
    RUN_TEST(test_descents_have_the_portable_bits);
    RUN_TEST(test_the_callers_registers_are_kept);
    return UNITY_END();
}
