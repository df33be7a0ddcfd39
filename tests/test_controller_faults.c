/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// One fault at every step of a run in turn, and a bus full of rubbish: the street stays safe, and the run goes on
/// where the fault is one that a bus is allowed to have.

#include "bench.h"
#include "elmopp_can.h"
#include "random.h"
#include "unity.h"

#include <stdio.h>

#ifndef STEPS /* fewer on the emulated board */
#define STEPS 900U
#define RUBBISH_TICKS 6000U
#endif
#define GROUPS 3U

static bench_t bench;

void setUp(void) {
    const elmopp_junction_t junction = bench_cross(GROUPS);
    bench_start(&bench, &junction);
    bench_fill(&bench);
    bench.neighbours = 0x1U;
    bench.outflow[0] = (elmopp_outflow_t){.next10_veh = 2.0F, .next30_veh = 3.0F, .next60_veh = 3.0F, .ahead_s = 14U};
}
void tearDown(void) {}

/* --- one frame in turn --- */

typedef struct {
    uint32_t at;   ///< which frame of the run
    uint32_t seen; ///< so far
    bench_fate_t what;
} one_fault_t;

static one_fault_t one;

static bench_fate_t strike(void *state, const elmopp_frame_t *frame) {
    one_fault_t *self = state;
    (void)frame;
    self->seen++;
    return (self->seen == self->at) ? self->what : BENCH_PASS;
}

/* A single frame may be lost, late, twice or spoilt at any moment: nothing but its own news is missing. */
static void check_single(bench_fate_t what) {
    for (uint32_t at = 1U; at < STEPS; at++) {
        setUp();
        one = (one_fault_t){.at = at, .what = what};
        bench.fate = strike;
        bench.fate_state = &one;
        TEST_ASSERT_TRUE(bench_until(&bench, ELMOPP_MODE_AUTOMATIC, 400U));
        bench_ticks(&bench, 250U);
        bench_expect_good_street(&bench);
        TEST_ASSERT_EQUAL_STRING("none", elmopp_fault_name(bench.controller.fault));
        TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_AUTOMATIC, bench.controller.mode);
    }
}

static void test_any_single_frame_may_be_lost(void) {
    check_single(BENCH_LOSE);
}

static void test_any_single_frame_may_come_twice(void) {
    check_single(BENCH_REPEAT);
}

static void test_any_single_frame_may_be_late_and_out_of_order(void) {
    check_single(BENCH_DELAY);
}

static void test_any_single_frame_may_be_spoilt(void) {
    check_single(BENCH_CORRUPT);
}

/* --- silence from every step on --- */

static bench_fate_t lose_from(void *state, const elmopp_frame_t *frame) {
    one_fault_t *self = state;
    (void)frame;
    self->seen++;
    return (self->seen >= self->at) ? BENCH_LOSE : BENCH_PASS;
}

static void test_silence_from_any_step_on_ends_in_flashing(void) {
    for (uint32_t at = 1U; at < STEPS; at++) {
        setUp();
        one = (one_fault_t){.at = at};
        bench.fate = lose_from;
        bench.fate_state = &one;
        bench_ticks(&bench, 1000U);
        bench_expect_good_street(&bench);
        TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_FAIL_SAFE, bench.controller.mode);
        TEST_ASSERT_EQUAL_HEX16(0x0007U, bench.shown.flash);
    }
}

/* --- a tenth of everything --- */

static uint64_t seed;

static bench_fate_t mistreat(void *state, const elmopp_frame_t *frame) {
    static const bench_fate_t fates[4] = {BENCH_LOSE, BENCH_REPEAT, BENCH_DELAY, BENCH_CORRUPT};
    (void)state;
    (void)frame;
    return (random_below(&seed, 10U) == 0U) ? fates[random_below(&seed, 4U)] : BENCH_PASS;
}

/* Four reports in a row are missing every few minutes then: flashing is right, a conflict never. */
static void test_a_bus_that_mistreats_a_tenth_of_its_frames_is_never_unsafe(void) {
    for (uint32_t run = 0U; run < 8U; run++) {
        setUp();
        seed = run;
        bench.fate = mistreat;
        bench_ticks(&bench, RUBBISH_TICKS);
        bench_expect_good_street(&bench);
    }
}

/* --- frames from anyone --- */

static elmopp_frame_t random_frame(void) {
    static const uint16_t ids[] = {0x080U, 0x090U, 0x091U, 0x100U, 0x101U, 0x102U, 0x107U,
                                   0x110U, 0x180U, 0x190U, 0x1A0U, 0x200U, 0x300U, 0x7E0U};
    elmopp_frame_t frame = {.id = ids[random_below(&seed, 14U)], .length = 8U};
    const uint64_t payload = random_next(&seed) & random_next(&seed);
    for (uint32_t i = 0U; i < 8U; i++) {
        frame.data[i] = (uint8_t)(payload >> (8U * i));
    }
    if (random_below(&seed, 8U) == 0U) {
        frame.id = (uint16_t)random_next(&seed);
        frame.length = (uint8_t)random_next(&seed);
    }
    return frame;
}

/* Every other one is well sealed, as an attacker's would be, and with the counter that is next. */
static void offer_rubbish(void) {
    elmopp_frame_t frame = random_frame();
    if ((random_below(&seed, 2U) == 0U) && (frame.length == 8U)) {
        const uint8_t length = frame.length;
        uint8_t counter = (uint8_t)random_below(&seed, 15U);
        elmopp_link_seal(&frame, &counter);
        frame.length = length;
    }
    (void)elmopp_controller_take(&bench.controller, &frame);
}

static void test_frames_from_anyone_at_any_time_never_make_the_street_unsafe(void) {
    for (uint32_t run = 0U; run < 6U; run++) {
        setUp();
        bench.junction.junction_wait_ds = ((run % 2U) == 1U) ? (uint16_t)100U : (uint16_t)0U;
        bench_start(&bench, &bench.junction);
        seed = 100U + run;
        for (uint32_t i = 0U; i < RUBBISH_TICKS; i++) {
            const uint32_t frames =
                random_below(&seed, (run < 3U) ? 3U : 400U); /* the last: a flood of 4,000 a second */
            for (uint32_t k = 0U; k < frames; k++) {
                offer_rubbish();
            }
            bench_tick(&bench);
        }
        bench_expect_good_street(&bench);
    }
}

static void test_nobody_on_the_bus_can_clear_a_fault(void) {
    TEST_ASSERT_TRUE(bench_until(&bench, ELMOPP_MODE_AUTOMATIC, 400U));
    bench.stuck_on.green = 0x0002U;
    bench_ticks(&bench, 10U);
    const elmopp_fault_t fault = bench.controller.fault;
    TEST_ASSERT_TRUE(fault != ELMOPP_FAULT_NONE);
    seed = 7U;
    for (uint32_t i = 0U; i < 20000U; i++) {
        (void)bench_command(&bench, (elmopp_request_t)random_below(&seed, 16U), random_below(&seed, 64U));
        bench_tick(&bench);
        TEST_ASSERT_EQUAL_INT(fault, bench.controller.fault);
        TEST_ASSERT_EQUAL_INT(ELMOPP_MODE_FAIL_SAFE, bench.controller.mode);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_any_single_frame_may_be_lost);
    RUN_TEST(test_any_single_frame_may_come_twice);
    RUN_TEST(test_any_single_frame_may_be_late_and_out_of_order);
    RUN_TEST(test_any_single_frame_may_be_spoilt);
    RUN_TEST(test_silence_from_any_step_on_ends_in_flashing);
    RUN_TEST(test_a_bus_that_mistreats_a_tenth_of_its_frames_is_never_unsafe);
    RUN_TEST(test_frames_from_anyone_at_any_time_never_make_the_street_unsafe);
    RUN_TEST(test_nobody_on_the_bus_can_clear_a_fault);
    return UNITY_END();
}
