/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The generated codec and the whole bus, for tests/python/test_can.py.
///
///     can_probe repack    reads lines ID DATA (hexadecimal) and writes what unpacking and packing again makes of them
///     can_probe record    runs a controller on a bench for 30 s and writes all frames as candump -L does

#include "bench.h"
#include "elmopp_can.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BYTES 8U
#define INSTANCES 8U
#define RECORDED_TICKS 300U

#define REPACK(name, data)                                                                                             \
    do {                                                                                                               \
        struct elmopp_can_##name##_t signals;                                                                          \
        if (elmopp_can_##name##_unpack(&signals, (data), BYTES) != 0) {                                                \
            return false;                                                                                              \
        }                                                                                                              \
        return elmopp_can_##name##_pack((data), &signals, BYTES) == (int)BYTES;                                        \
    } while (false)

static bool is_of(uint32_t id, uint32_t base) {
    return (id - base) < INSTANCES;
}

static bool repack(uint32_t id, uint8_t data[BYTES]) {
    if (id == ELMOPP_CAN_LAMP_COMMAND_FRAME_ID) {
        REPACK(lamp_command, data);
    }
    if (is_of(id, ELMOPP_CAN_LAMP_FEEDBACK_FRAME_ID)) {
        REPACK(lamp_feedback, data);
    }
    if (is_of(id, ELMOPP_CAN_DETECTOR_COUNTS_FRAME_ID)) {
        REPACK(detector_counts, data);
    }
    if (id == ELMOPP_CAN_JUNCTION_OCCUPIED_FRAME_ID) {
        REPACK(junction_occupied, data);
    }
    if (id == ELMOPP_CAN_CONTROLLER_STATUS_FRAME_ID) {
        REPACK(controller_status, data);
    }
    if (is_of(id, ELMOPP_CAN_FORECAST_FRAME_ID)) {
        REPACK(forecast, data);
    }
    if (is_of(id, ELMOPP_CAN_NEIGHBOUR_OUTFLOW_FRAME_ID)) {
        REPACK(neighbour_outflow, data);
    }
    if (id == ELMOPP_CAN_COMMAND_FRAME_ID) {
        REPACK(command, data);
    }
    if (id == ELMOPP_CAN_TRANSFER_FRAME_ID) {
        REPACK(transfer, data);
    }
    if (id == ELMOPP_CAN_TRANSFER_ACK_FRAME_ID) {
        REPACK(transfer_ack, data);
    }
    if (id == ELMOPP_CAN_SIM_TIME_FRAME_ID) {
        REPACK(sim_time, data);
    }
    if (id == ELMOPP_CAN_DECISION_TRACE_FRAME_ID) {
        REPACK(decision_trace, data);
    }
    return false;
}

static int repack_lines(void) {
    char line[64];
    while (fgets(line, sizeof line, stdin) != NULL) {
        char *end = NULL;
        const uint32_t id = (uint32_t)strtoul(line, &end, 16);
        const unsigned long long bits = strtoull(end, NULL, 16);
        uint8_t data[BYTES];
        for (uint32_t i = 0U; i < BYTES; i++) {
            data[i] = (uint8_t)(bits >> (8U * (BYTES - 1U - i)));
        }
        if (!repack(id, data)) {
            return EXIT_FAILURE;
        }
        for (uint32_t i = 0U; i < BYTES; i++) {
            (void)printf("%02X", (unsigned)data[i]);
        }
        (void)printf("\n");
    }
    return EXIT_SUCCESS;
}

/* The bench's own checks are Unity's. */
void setUp(void);
void tearDown(void);
void setUp(void) {}
void tearDown(void) {}

static bench_t bench;

static void record(const elmopp_frame_t *frame) {
    (void)printf("(%u.%06u) can0 %03X#", (unsigned)(bench.now_ms / 1000U), (unsigned)((bench.now_ms % 1000U) * 1000U),
                 (unsigned)frame->id);
    for (uint32_t i = 0U; i < frame->length; i++) {
        (void)printf("%02X", (unsigned)frame->data[i]);
    }
    (void)printf("\n");
}

static bench_fate_t pass_and_record(void *state, const elmopp_frame_t *frame) {
    (void)state;
    record(frame);
    return BENCH_PASS;
}

static int record_bus(void) {
    const elmopp_junction_t junction = bench_cross(4U);
    bench_start(&bench, &junction);
    bench.fate = pass_and_record;
    bench.heard = record;
    bench_fill(&bench);
    for (uint32_t i = 0U; i < RECORDED_TICKS; i++) {
        bench.arrived_veh[i % 4U] += (i % 7U) / 6U;
        bench_tick(&bench);
    }
    return EXIT_SUCCESS;
}

int main(int argc, char **argv) {
    if ((argc == 2) && (strcmp(argv[1], "repack") == 0)) {
        return repack_lines();
    }
    if ((argc == 2) && (strcmp(argv[1], "record") == 0)) {
        return record_bus();
    }
    (void)fputs("can_probe: right would be repack or record\n", stderr);
    return 2;
}
