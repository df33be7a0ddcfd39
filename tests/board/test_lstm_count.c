/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// A step of the LSTM in float and in whole numbers, quantising it, and one of each network that sees windows, takes
/// the same number of instructions, whatever the numbers are.
///
/// run_qemu.sh makes one instruction last 64 ns, and the board's SysTick counts at 25 MHz: 8 ticks are exactly 5
/// instructions. The counter is cleared before each run, so equal instructions are equal ticks, and one more or less
/// always shows; the first tests hold the method to that.

#include "elmopp/ann_f32.h"
#include "elmopp/gcn_f32.h"
#include "elmopp/lstm_f32.h"
#include "elmopp/lstm_q15.h"
#include "elmopp/lstm_quantize.h"
#include "random.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

#define SYSTICK_CONTROL (*(volatile uint32_t *)0xE000E010U)
#define SYSTICK_RELOAD (*(volatile uint32_t *)0xE000E014U)
#define SYSTICK_VALUE (*(volatile uint32_t *)0xE000E018U)
#define SYSTICK_ON_PROCESSOR_CLOCK 5U
#define SYSTICK_MASK 0x00FFFFFFU ///< it counts down through 24 bits

#define CASES 200U

typedef enum {
    VALUES_ZERO,
    VALUES_ORDINARY,   ///< below 4 in size
    VALUES_SATURATING, ///< below 128: most gates are shut or open
    VALUES_AT_CLAMP,   ///< about where elmopp_tanh() begins to clamp
    VALUES_LARGE,      ///< up to 1e30
    VALUES_TINY,       ///< subnormal
    VALUES_MIXED,      ///< each value of another kind
    VALUES_COUNT
} values_t;

static elmopp_lstm_f32_weights_t weights;
static elmopp_lstm_f32_state_t state;
static float input[ELMOPP_LSTM_INPUTS];
static elmopp_lstm_q15_weights_t whole_weights;
static elmopp_lstm_q15_state_t whole_state;
static elmopp_ann_f32_weights_t ann;
static elmopp_gcn_f32_weights_t gcn;
static elmopp_gcn_f32_graph_t graph;
static float past[ELMOPP_GCN_NODES_MAX][ELMOPP_GCN_WINDOW_S];
static const float *const window[ELMOPP_GCN_NODES_MAX] = {past[0], past[1], past[2], past[3],
                                                          past[4], past[5], past[6], past[7]};
static float next[ELMOPP_GCN_NODES_MAX];
static volatile int32_t condition;
static uint64_t seed;

void setUp(void) {
    SYSTICK_RELOAD = SYSTICK_MASK;
    SYSTICK_CONTROL = SYSTICK_ON_PROCESSOR_CLOCK;
    seed = 1U;
}
void tearDown(void) {}

static void nothing(void) {}

/* From clearing the counter to reading it. One copy for all, or else the instructions around `work` would differ. */
__attribute__((noinline, noclone)) static uint32_t instructions_with_call(void (*work)(void)) {
    SYSTICK_VALUE = 0U; /* any write clears it */
    work();
    const uint32_t ticks = (0U - SYSTICK_VALUE) & SYSTICK_MASK;
    return ((ticks + 1U) * 5U) / 8U; /* the tick that the last instruction begins is not yet counted */
}

/* Instructions of `work` without its return. */
static uint32_t instructions(void (*work)(void)) {
    return instructions_with_call(work) - instructions_with_call(nothing);
}

static void one_nop(void) {
    __asm__ volatile("nop");
}

static void two_nops(void) {
    __asm__ volatile("nop\n\tnop");
}

static void three_nops(void) {
    __asm__ volatile("nop\n\tnop\n\tnop");
}

static void four_nops(void) {
    __asm__ volatile("nop\n\tnop\n\tnop\n\tnop");
}

static void thousand_nops(void) {
    __asm__ volatile(".rept 1000\n\tnop\n\t.endr");
}

static void branch_over_two_nops(void) {
    __asm__ volatile("cmp %0, #0\n\tbne 1f\n\tnop\n\tnop\n1:" : : "r"(condition) : "cc");
}

static void two_conditional_moves(void) {
    __asm__ volatile("cmp %0, #0\n\titt eq\n\tmoveq r3, #1\n\tmoveq r3, #2" : : "r"(condition) : "cc", "r3");
}

static void test_one_instruction_more_is_one_more(void) {
    TEST_ASSERT_EQUAL_UINT32(0U, instructions(nothing));
    TEST_ASSERT_EQUAL_UINT32(1U, instructions(one_nop));
    TEST_ASSERT_EQUAL_UINT32(2U, instructions(two_nops));
    TEST_ASSERT_EQUAL_UINT32(3U, instructions(three_nops));
    TEST_ASSERT_EQUAL_UINT32(4U, instructions(four_nops));
    TEST_ASSERT_EQUAL_UINT32(1000U, instructions(thousand_nops));
}

static void test_a_branch_on_data_is_seen(void) {
    condition = 0;
    const uint32_t not_taken = instructions(branch_over_two_nops);
    condition = 1;
    TEST_ASSERT_EQUAL_UINT32(not_taken - 2U, instructions(branch_over_two_nops));
}

static void test_a_conditional_instruction_counts_whether_it_acts_or_not(void) {
    condition = 0;
    const uint32_t acting = instructions(two_conditional_moves);
    condition = 1;
    TEST_ASSERT_EQUAL_UINT32(acting, instructions(two_conditional_moves));
}

static float within(float size) {
    return ((float)random_below(&seed, 1U << 24U) - 8388608.0F) * (size / 8388608.0F);
}

static float subnormal(void) {
    const uint32_t bits = random_below(&seed, 1U << 23U) | (random_below(&seed, 2U) << 31U);
    float value;
    (void)memcpy(&value, &bits, sizeof value);
    return value;
}

static float value_of(values_t kind) {
    switch (kind) {
    case VALUES_ORDINARY:
        return within(4.0F);
    case VALUES_SATURATING:
        return within(128.0F);
    case VALUES_AT_CLAMP:
        return ((random_below(&seed, 2U) == 0U) ? 7.9F : -7.9F) + within(0.01F);
    case VALUES_LARGE:
        return within(1.0e30F);
    case VALUES_TINY:
        return subnormal();
    case VALUES_MIXED:
        return value_of((values_t)random_below(&seed, VALUES_MIXED));
    case VALUES_ZERO:
    case VALUES_COUNT:
    default:
        return 0.0F;
    }
}

static void fill(float *values, uint32_t count, values_t kind) {
    for (uint32_t i = 0U; i < count; i++) {
        values[i] = value_of(kind);
    }
}

static void make_weights(uint32_t levels, values_t kind) {
    weights.levels = levels;
    fill(weights.outer.bias, ELMOPP_LSTM_GATES, kind);
    fill(weights.outer.row[0], ELMOPP_LSTM_OUTER_ROWS * ELMOPP_LSTM_GATES, kind);
    for (uint32_t i = 0U; i < (ELMOPP_LSTM_LEVELS_MAX - 1U); i++) {
        fill(weights.inner[i].bias, ELMOPP_LSTM_GATES, kind);
        fill(weights.inner[i].row[0], ELMOPP_LSTM_INNER_ROWS * ELMOPP_LSTM_GATES, kind);
    }
}

static void step(void) {
    elmopp_lstm_f32_step(&weights, &state, input);
}

/* Weights, inputs and state are of one kind each; the kinds are combined in turn. */
static uint32_t count_case(uint32_t levels, uint32_t number) {
    const uint32_t kinds = VALUES_COUNT;
    make_weights(levels, ((number % 4U) == 3U) ? VALUES_SATURATING : VALUES_ORDINARY);
    fill(input, ELMOPP_LSTM_INPUTS, (values_t)(number % kinds));
    fill(state.hidden, ELMOPP_LSTM_UNITS, (values_t)((number / kinds) % kinds));
    fill(state.cell[0], ELMOPP_LSTM_LEVELS_MAX * ELMOPP_LSTM_UNITS, (values_t)((number / kinds) % kinds));
    return instructions(step);
}

static void expect_constant_count(uint32_t levels) {
    uint32_t least = UINT32_MAX;
    uint32_t most = 0U;
    for (uint32_t i = 0U; i < CASES; i++) {
        const uint32_t count = count_case(levels, i);
        least = (count < least) ? count : least;
        most = (count > most) ? count : most;
    }
    (void)printf("levels %u: %u to %u instructions a step\n", (unsigned)levels, (unsigned)least, (unsigned)most);
    TEST_ASSERT_EQUAL_UINT32(least, most);
}

static void test_a_step_of_the_plain_lstm_takes_the_same_for_all(void) {
    expect_constant_count(1U);
}

static void test_a_step_of_two_levels_takes_the_same_for_all(void) {
    expect_constant_count(2U);
}

static void test_a_step_of_three_levels_takes_the_same_for_all(void) {
    expect_constant_count(3U);
}

static void whole_step(void) {
    elmopp_lstm_q15_step(&whole_weights, &whole_state, input);
}

static void quantize(void) {
    static const float low[ELMOPP_LSTM_INPUTS] = {-4.0F, -4.0F, -4.0F, -4.0F};
    static const float high[ELMOPP_LSTM_INPUTS] = {4.0F, 4.0F, 4.0F, 4.0F};
    (void)elmopp_lstm_quantize(&weights, low, high, &whole_weights);
}

/* Weights that pass; inputs to beyond their range, cells to the ends of their words. */
static void expect_constant_whole_count(uint32_t levels) {
    uint32_t least[2] = {UINT32_MAX, UINT32_MAX};
    uint32_t most[2] = {0U, 0U};
    for (uint32_t i = 0U; i < CASES; i++) {
        static const values_t kinds[] = {VALUES_ORDINARY, VALUES_ZERO, VALUES_TINY};
        make_weights(levels, kinds[i % 3U]);
        const uint32_t quantizing = instructions(quantize);
        TEST_ASSERT_EQUAL_UINT32(levels, whole_weights.levels);
        fill(input, ELMOPP_LSTM_INPUTS, (values_t)(i % (uint32_t)VALUES_COUNT));
        for (uint32_t k = 0U; k < (ELMOPP_LSTM_LEVELS_MAX * ELMOPP_LSTM_UNITS); k++) {
            const uint32_t bits = 1U + random_below(&seed, 31U);
            const int32_t size = (int32_t)random_below(&seed, ((uint32_t)1U << bits) - 1U);
            whole_state.cell[k / ELMOPP_LSTM_UNITS][k % ELMOPP_LSTM_UNITS] = ((k % 2U) == 0U) ? size : -size;
        }
        const uint32_t stepping = instructions(whole_step);
        least[0] = (quantizing < least[0]) ? quantizing : least[0];
        most[0] = (quantizing > most[0]) ? quantizing : most[0];
        least[1] = (stepping < least[1]) ? stepping : least[1];
        most[1] = (stepping > most[1]) ? stepping : most[1];
    }
    (void)printf("levels %u in whole numbers: %u to %u a step, %u to %u to quantise\n", (unsigned)levels,
                 (unsigned)least[1], (unsigned)most[1], (unsigned)least[0], (unsigned)most[0]);
    TEST_ASSERT_EQUAL_UINT32(least[0], most[0]);
    TEST_ASSERT_EQUAL_UINT32(least[1], most[1]);
}

static void test_whole_numbers_take_the_same_for_all(void) {
    for (uint32_t levels = 1U; levels <= ELMOPP_LSTM_LEVELS_MAX; levels++) {
        expect_constant_whole_count(levels);
    }
}

static void ann_second(void) {
    elmopp_ann_f32_next(&ann, window, next);
}

static void gcn_second(void) {
    elmopp_gcn_f32_next(&gcn, &graph, window, next);
}

/* Weights, biases among them, and windows are of one kind each, all kinds in turn. */
static void expect_constant_windows(const char *name, void (*second)(void)) {
    uint32_t least = UINT32_MAX;
    uint32_t most = 0U;
    for (uint32_t i = 0U; i < CASES; i++) {
        const values_t kind = ((i % 4U) == 3U) ? VALUES_SATURATING : VALUES_ORDINARY;
        fill(ann.first_bias, (uint32_t)(sizeof ann.first_bias / sizeof(float)), kind);
        fill(ann.first_row[0], ELMOPP_ANN_INPUTS * ELMOPP_ANN_WINDOW_S * ELMOPP_ANN_UNITS, kind);
        fill(ann.second_row[0], ELMOPP_ANN_UNITS * ELMOPP_ANN_UNITS, kind);
        fill(ann.head_row[0], ELMOPP_ANN_UNITS * ELMOPP_ANN_INPUTS, kind);
        fill(gcn.first_own[0], ELMOPP_GCN_WINDOW_S * ELMOPP_GCN_UNITS, kind);
        fill(gcn.first_passed[0], ELMOPP_GCN_WINDOW_S * ELMOPP_GCN_UNITS, kind);
        fill(gcn.second_own[0], ELMOPP_GCN_UNITS * ELMOPP_GCN_UNITS, kind);
        fill(gcn.second_passed[0], ELMOPP_GCN_UNITS * ELMOPP_GCN_UNITS, kind);
        fill(gcn.head, ELMOPP_GCN_UNITS, kind);
        fill(past[0], ELMOPP_GCN_NODES_MAX * ELMOPP_GCN_WINDOW_S, (values_t)(i % (uint32_t)VALUES_COUNT));
        const uint32_t count = instructions(second);
        least = (count < least) ? count : least;
        most = (count > most) ? count : most;
    }
    (void)printf("%s: %u to %u instructions a second\n", name, (unsigned)least, (unsigned)most);
    TEST_ASSERT_EQUAL_UINT32(least, most);
}

static void test_a_second_of_the_plain_network_takes_the_same_for_all(void) {
    expect_constant_windows("ann", ann_second);
}

/* Complete graphs and one without an edge: only the number of nodes counts. */
static void test_a_second_of_the_graph_takes_the_same_for_all_graphs_of_a_size(void) {
    static const uint8_t all[ELMOPP_GCN_NODES_MAX] = {0xFFU, 0xFFU, 0xFFU, 0xFFU, 0xFFU, 0xFFU, 0xFFU, 0xFFU};
    static const uint8_t none[ELMOPP_GCN_NODES_MAX] = {0U, 0U, 0U, 0U, 0U, 0U, 0U, 0U};
    elmopp_gcn_f32_join(&graph, ELMOPP_GCN_NODES_MAX, all);
    expect_constant_windows("gcn of eight nodes", gcn_second);
    elmopp_gcn_f32_join(&graph, 4U, all);
    expect_constant_windows("gcn of four nodes", gcn_second);
    const uint32_t joined = instructions(gcn_second);
    elmopp_gcn_f32_join(&graph, 4U, none);
    TEST_ASSERT_EQUAL_UINT32(joined, instructions(gcn_second));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_one_instruction_more_is_one_more);
    RUN_TEST(test_a_branch_on_data_is_seen);
    RUN_TEST(test_a_conditional_instruction_counts_whether_it_acts_or_not);
    RUN_TEST(test_a_step_of_the_plain_lstm_takes_the_same_for_all);
    RUN_TEST(test_a_step_of_two_levels_takes_the_same_for_all);
    RUN_TEST(test_a_step_of_three_levels_takes_the_same_for_all);
    RUN_TEST(test_whole_numbers_take_the_same_for_all);
    RUN_TEST(test_a_second_of_the_plain_network_takes_the_same_for_all);
    RUN_TEST(test_a_second_of_the_graph_takes_the_same_for_all_graphs_of_a_size);
    return UNITY_END();
}
