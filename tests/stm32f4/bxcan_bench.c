/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "bxcan_bench.h"

#include "bit_timing.h"
#include "unity.h"

#include <stdio.h>

#define SLICES 5U /* of a millisecond, an interrupt each: a frame takes longer */
#define INTERRUPTS_IN_A_ROW 8U

elmopp_bxcan_t bench_can;
uint32_t bench_now_ms;

static const uint16_t ids[] = {0x080U, 0x090U, 0x091U, 0x100U, 0x101U, 0x200U};

static elmopp_bxcan_registers_t place; /* never read: its addresses are the registers' names */

elmopp_bxcan_registers_t *bench_registers(void) {
    return &place;
}

static uint32_t offset_of(const elmopp_register_t *of) {
    const uintptr_t offset = (uintptr_t)of - (uintptr_t)&place;
    TEST_ASSERT_TRUE_MESSAGE(offset < sizeof place, "a register that is none of the CAN controller's");
    return (uint32_t)offset;
}

uint32_t elmopp_register_read(const elmopp_register_t *of) {
    return bxcan_model_read(offset_of(of));
}

void elmopp_register_write(elmopp_register_t *of, uint32_t value) {
    bxcan_model_write(offset_of(of), value);
}

static void expect_bounded(uint32_t before, const char *what) {
    const uint32_t used = bxcan_model_accesses() - before;
    if (used > BXCAN_BENCH_ACCESSES) {
        char text[96];
        (void)snprintf(text, sizeof text, "%s touched %u registers in state %d", what, (unsigned)used,
                       (int)bench_can.state);
        TEST_FAIL_MESSAGE(text);
    }
}

void bench_start(bool may_join) {
    const elmopp_bxcan_config_t config = {
        .bit_timing = ELMOPP_CAN_BTR, .ids = ids, .id_count = sizeof ids / sizeof ids[0], .may_join = may_join};
    bxcan_model_reset();
    bxcan_model_break(BXCAN_FAULT_NONE, 0U, UINT32_MAX);
    bench_now_ms = UINT32_MAX - 1000U; /* the clock wraps in every test that lasts longer than a second */
    elmopp_bxcan_init(&bench_can, bench_registers(), &config);
    elmopp_bxcan_start(&bench_can, bench_now_ms);
}

static void interrupts(void) {
    for (uint32_t k = 0U; (k < INTERRUPTS_IN_A_ROW) && bxcan_model_interrupt(); k++) {
        const uint32_t before = bxcan_model_accesses();
        elmopp_bxcan_interrupt(&bench_can);
        expect_bounded(before, "the interrupt");
    }
}

static uint32_t limit_of(elmopp_bxcan_state_t state) {
    switch (state) {
    case ELMOPP_BXCAN_RESETTING:
    case ELMOPP_BXCAN_ENTERING:
    case ELMOPP_BXCAN_LEAVING:
        return ELMOPP_BXCAN_ANSWER_MS;
    case ELMOPP_BXCAN_JOINING:
    case ELMOPP_BXCAN_RETURNING:
        return ELMOPP_BXCAN_JOIN_MS;
    case ELMOPP_BXCAN_PAUSING:
        return ELMOPP_BXCAN_PAUSE_MAX_MS;
    case ELMOPP_BXCAN_OFF:
    case ELMOPP_BXCAN_HELD:
    case ELMOPP_BXCAN_RUNNING:
    case ELMOPP_BXCAN_FAILED:
    default:
        return UINT32_MAX;
    }
}

static void step(void) {
    const uint32_t before = bxcan_model_accesses();
    elmopp_bxcan_step(&bench_can, bench_now_ms);
    expect_bounded(before, "a step");
    TEST_ASSERT_TRUE((bench_now_ms - bench_can.since_ms) <= limit_of(bench_can.state));
}

void bench_pass_ms(uint32_t duration_ms) {
    for (uint32_t t = 0U; t < duration_ms; t++) {
        const uint32_t slices = (bench_can.state == ELMOPP_BXCAN_RUNNING) ? SLICES : 1U; /* else it hears nothing */
        for (uint32_t k = 0U; k < slices; k++) {
            bxcan_model_pass_bits(BXCAN_MODEL_BITS_OF_MS / slices);
            interrupts();
        }
        bench_now_ms++;
        step();
    }
}

void bench_sleep_ms(uint32_t duration_ms) {
    bxcan_model_pass_bits(BXCAN_MODEL_BITS_OF_MS * duration_ms);
    bench_now_ms += duration_ms;
}

void bench_reach(elmopp_bxcan_state_t state, uint32_t within_ms) {
    for (uint32_t t = 0U; (t < within_ms) && (bench_can.state != state); t++) {
        bench_pass_ms(1U);
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(state, bench_can.state, elmopp_bxcan_trouble_name(bench_can.trouble));
}

elmopp_frame_t bench_frame(uint32_t id, uint8_t number) {
    elmopp_frame_t frame = {.id = (uint16_t)id, .length = 8U};
    for (uint32_t i = 0U; i < ELMOPP_LINK_BYTES; i++) {
        frame.data[i] = (uint8_t)(((16U * i) + id) & 0xFFU);
    }
    frame.data[0] = number;
    return frame;
}

bool bench_send(uint32_t id, uint8_t number) {
    const elmopp_frame_t frame = bench_frame(id, number);
    return elmopp_bxcan_send(&bench_can, &frame, bench_now_ms);
}

uint32_t bench_drain(void) {
    uint32_t count = 0U;
    elmopp_frame_t frame;
    while (elmopp_bxcan_receive(&bench_can, &frame)) {
        count++;
    }
    return count;
}
