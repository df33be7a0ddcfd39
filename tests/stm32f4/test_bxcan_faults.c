/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// A fault of the CAN hardware or of its bus at every register access of a run in turn. Each run begins with the start,
/// sends and receives as a controller does, goes through bus-off, and returns from it.
///
/// Whatever breaks, and wherever: no call touches more than a bounded number of registers and no state outlasts its
/// limit (the bench holds every call to that), what is broken for good ends where it must, and what is broken for a
/// while runs again by itself.

#include "bxcan_bench.h"
#include "unity.h"

#include <stdio.h>

#define TICK_MS 100U
#define RUN_MS 350U /* start, three ticks, bus-off in the second of them, return */
#define BUS_OFF_AT_MS 112U
#ifndef STRIDE
#define STRIDE 1U /* from one access to the next one that is tried */
#endif
#define FAULT_ACCESSES 60U   /* of a fault that passes: some 20 ms */
#define LONG_ENOUGH_MS 5000U /* for ten tries of a tenth of a second, and 3 s of pauses */

#define LAMP_COMMAND 0x080U
#define FEEDBACK 0x090U
#define STATUS 0x180U
#define FORECAST 0x190U

void setUp(void) {}
void tearDown(void) {}

typedef struct {
    const char *name;
    bxcan_fault_t fault;
    elmopp_bxcan_state_t ends;      /* if it stays */
    elmopp_bxcan_trouble_t trouble; /* ... that is named last; WELL: any */
} case_t;

static const case_t cases[] = {
    {"no hardware", BXCAN_FAULT_DEAD, ELMOPP_BXCAN_FAILED, ELMOPP_BXCAN_NO_INIT},
    {"all ones", BXCAN_FAULT_ONES, ELMOPP_BXCAN_FAILED, ELMOPP_BXCAN_NO_RESET},
    {"no end of the reset", BXCAN_FAULT_NO_RESET | BXCAN_FAULT_FALLS_ASLEEP, ELMOPP_BXCAN_FAILED,
     ELMOPP_BXCAN_NO_RESET},
    {"never initialises", BXCAN_FAULT_NO_INIT | BXCAN_FAULT_DESTROYED, ELMOPP_BXCAN_FAILED, ELMOPP_BXCAN_NO_INIT},
    {"never leaves it", BXCAN_FAULT_NO_LEAVE | BXCAN_FAULT_DESTROYED, ELMOPP_BXCAN_FAILED, ELMOPP_BXCAN_WELL},
    {"forgets the timing", BXCAN_FAULT_NO_TIMING | BXCAN_FAULT_MAILBOX, ELMOPP_BXCAN_FAILED, ELMOPP_BXCAN_NO_TIMING},
    {"no mailbox empties", BXCAN_FAULT_MAILBOX, ELMOPP_BXCAN_FAILED, ELMOPP_BXCAN_NO_MAILBOX},
    {"no frame is released", BXCAN_FAULT_RELEASE, ELMOPP_BXCAN_FAILED, ELMOPP_BXCAN_NO_RELEASE},
    {"everything destroyed", BXCAN_FAULT_DESTROYED, ELMOPP_BXCAN_FAILED, ELMOPP_BXCAN_BUS_OFF},
    {"falls asleep", BXCAN_FAULT_FALLS_ASLEEP, ELMOPP_BXCAN_FAILED, ELMOPP_BXCAN_WELL},
    {"nobody there", BXCAN_FAULT_ALONE, ELMOPP_BXCAN_RUNNING, ELMOPP_BXCAN_WELL},
    {"others arrive spoilt", BXCAN_FAULT_SPOILT, ELMOPP_BXCAN_RUNNING, ELMOPP_BXCAN_WELL},
    {"no interrupt", BXCAN_FAULT_NO_INTERRUPT, ELMOPP_BXCAN_RUNNING, ELMOPP_BXCAN_WELL},
    {"flood", BXCAN_FAULT_FLOOD, ELMOPP_BXCAN_RUNNING, ELMOPP_BXCAN_WELL},
    /* What is on a bus that is stuck goes nowhere, but nothing is broken: whoever runs then goes on trying. */
    {"stuck bus", BXCAN_FAULT_DOMINANT, ELMOPP_BXCAN_OFF, ELMOPP_BXCAN_WELL},
};

static void tick(uint32_t number) {
    (void)bench_send(LAMP_COMMAND, (uint8_t)(number & 0x7FU));
    (void)bench_send(STATUS, 1U);
    (void)bench_send(FORECAST, 2U);
    const elmopp_frame_t frame = bench_frame(FEEDBACK, 3U);
    bxcan_model_hear(&frame);
    bxcan_model_hear(&frame);
}

/* A controller's life for so long. */
static void live(uint32_t duration_ms, bool with_bus_off) {
    for (uint32_t t = 0U; t < duration_ms; t++) {
        if ((t % TICK_MS) == 10U) {
            tick(t / TICK_MS);
        }
        if (with_bus_off && (t == BUS_OFF_AT_MS) && (bench_can.state == ELMOPP_BXCAN_RUNNING)) {
            bxcan_model_set_transmit_errors(256U);
        }
        bench_pass_ms(1U);
        if ((t % 10U) == 0U) {
            (void)bench_drain();
        }
    }
}

/* Until it has ended, or runs, or for long enough. */
static void live_until(elmopp_bxcan_state_t state, uint32_t access) {
    for (uint32_t t = 0U; t < LONG_ENOUGH_MS; t += TICK_MS) {
        if ((bench_can.state == state) && (bxcan_model_accesses() >= access)) {
            break;
        }
        live(TICK_MS, false);
    }
    live(2U * TICK_MS, false); /* and it stays so */
}

static void run_once(uint32_t faults, uint32_t from, uint32_t until) {
    bench_start(true);
    bxcan_model_break(faults, from, until);
    live(RUN_MS, true);
}

static uint32_t accesses_of_a_run(void) {
    run_once(BXCAN_FAULT_NONE, 0U, 0U);
    TEST_ASSERT_EQUAL_INT(ELMOPP_BXCAN_RUNNING, bench_can.state);
    TEST_ASSERT_EQUAL_UINT32(1U, bench_can.count[ELMOPP_BXCAN_BUS_OFF]);
    TEST_ASSERT_EQUAL_UINT32(1U, bench_can.returned);
    return bxcan_model_accesses();
}

static void say(char *text, size_t size, const case_t *fault, uint32_t from) {
    (void)snprintf(text, size, "%s from access %u on: %s", fault->name, (unsigned)from,
                   elmopp_bxcan_trouble_name(bench_can.trouble));
}

static void test_a_run_without_a_fault_sends_everything_but_what_bus_off_costs(void) {
    (void)accesses_of_a_run();
    TEST_ASSERT_EQUAL_UINT32(0U, bxcan_model_violations());
    TEST_ASSERT_TRUE(bxcan_model_sent() >= 6U);
}

static void test_a_fault_that_stays_ends_where_it_must_wherever_it_begins(void) {
    const uint32_t accesses = accesses_of_a_run();
    char text[120];
    for (size_t i = 0U; i < (sizeof cases / sizeof cases[0]); i++) {
        for (uint32_t from = 0U; from < accesses; from += STRIDE) {
            run_once((uint32_t)cases[i].fault, from, UINT32_MAX);
            live_until((cases[i].ends == ELMOPP_BXCAN_RUNNING) ? ELMOPP_BXCAN_RUNNING : ELMOPP_BXCAN_FAILED, from);
            say(text, sizeof text, &cases[i], from);
            if (cases[i].ends != ELMOPP_BXCAN_OFF) {
                TEST_ASSERT_EQUAL_INT_MESSAGE(cases[i].ends, bench_can.state, text);
            }
            if (cases[i].trouble != ELMOPP_BXCAN_WELL) {
                TEST_ASSERT_EQUAL_INT_MESSAGE(cases[i].trouble, bench_can.trouble, text);
            }
        }
    }
    (void)printf("%u faults at each of %u register accesses\n", (unsigned)(sizeof cases / sizeof cases[0]),
                 (unsigned)accesses);
}

static void test_a_fault_that_passes_is_survived_wherever_it_begins(void) {
    const uint32_t accesses = accesses_of_a_run();
    char text[120];
    for (size_t i = 0U; i < (sizeof cases / sizeof cases[0]); i++) {
        for (uint32_t from = 0U; from < accesses; from += STRIDE) {
            run_once((uint32_t)cases[i].fault, from, from + FAULT_ACCESSES);
            live_until(ELMOPP_BXCAN_RUNNING, from + FAULT_ACCESSES);
            const uint32_t sent = bench_can.mailboxes.sent;
            live(3U * TICK_MS, false);
            say(text, sizeof text, &cases[i], from);
            TEST_ASSERT_EQUAL_INT_MESSAGE(ELMOPP_BXCAN_RUNNING, bench_can.state, text);
            TEST_ASSERT_EQUAL_UINT32_MESSAGE(9U, bench_can.mailboxes.sent - sent, text);
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_run_without_a_fault_sends_everything_but_what_bus_off_costs);
    RUN_TEST(test_a_fault_that_stays_ends_where_it_must_wherever_it_begins);
    RUN_TEST(test_a_fault_that_passes_is_survived_wherever_it_begins);
    return UNITY_END();
}
