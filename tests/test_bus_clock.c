/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "bus_clock.h"

#include "bench.h"

#include "elmopp_can.h"

#include "unity.h"

#include <string.h>

static bench_t bench;
static elmopp_frame_t out[ELMOPP_TRACE_MAX];

void setUp(void) {
    const elmopp_junction_t site = bench_cross(3U);
    bench_start(&bench, &site);
}

void tearDown(void) {}

static void test_every_time_comes_back(void) {
    const elmopp_ms_t times[] = {0U, 1U, 100U, 0x12345678U, UINT32_MAX};
    for (uint32_t i = 0U; i < 5U; i++) {
        const elmopp_frame_t frame = elmopp_bus_clock_make_time(times[i]);
        TEST_ASSERT_EQUAL_HEX16(ELMOPP_CAN_SIM_TIME_FRAME_ID, frame.id);
        TEST_ASSERT_EQUAL_UINT32(times[i], elmopp_bus_clock_time(&frame));
    }
}

static void test_a_tick_has_decided_if_it_brings_a_forecast(void) {
    elmopp_frame_t frames[3] = {{.id = (uint16_t)ELMOPP_CAN_LAMP_COMMAND_FRAME_ID},
                                {.id = (uint16_t)ELMOPP_CAN_CONTROLLER_STATUS_FRAME_ID},
                                {.id = (uint16_t)ELMOPP_CAN_FORECAST_FRAME_ID}};
    TEST_ASSERT_FALSE(elmopp_bus_clock_decided(frames, 0U));
    TEST_ASSERT_FALSE(elmopp_bus_clock_decided(frames, 2U));
    TEST_ASSERT_TRUE(elmopp_bus_clock_decided(frames, 3U));
}

/* To the bit, and every one exactly once. */
static void test_the_trace_is_the_decision(void) {
    elmopp_controller_t *controller = &bench.controller;
    const elmopp_junction_t *site = controller->junction;
    controller->pilot.score[0] = 1.0F / 3.0F;
    controller->pilot.score[site->stage_count - 1U] = -3.0e38F;
    controller->pilot.foreseen_sum_veh[1] = 1.0e-40F;
    controller->present_veh[2] = 17.0F;
    controller->arrived_veh[0] = 0.1F;
    uint8_t counter = 13U;
    const uint32_t count = elmopp_bus_clock_trace(controller, &counter, out);
    const uint32_t lengths[] = {site->stage_count, site->approach_count, site->movement_count, site->movement_count};
    const float *const values[] = {controller->pilot.score, controller->pilot.foreseen_sum_veh, controller->present_veh,
                                   controller->arrived_veh};
    uint32_t k = 0U;
    for (uint32_t kind = 0U; kind < 4U; kind++) {
        for (uint32_t i = 0U; i < lengths[kind]; i++) {
            const elmopp_trace_t trace = elmopp_bus_clock_read(&out[k]);
            TEST_ASSERT_EQUAL_UINT8(kind, trace.kind);
            TEST_ASSERT_EQUAL_UINT8(i, trace.index);
            TEST_ASSERT_EQUAL_INT(0, memcmp(&values[kind][i], &trace.value, sizeof trace.value));
            TEST_ASSERT_EQUAL_UINT8((13U + k) % ELMOPP_LINK_COUNTERS, out[k].data[0] & 0xFU);
            k++;
        }
    }
    TEST_ASSERT_EQUAL_UINT32(k, count);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_every_time_comes_back);
    RUN_TEST(test_a_tick_has_decided_if_it_brings_a_forecast);
    RUN_TEST(test_the_trace_is_the_decision);
    return UNITY_END();
}
