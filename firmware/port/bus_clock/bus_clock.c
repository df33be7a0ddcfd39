/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "bus_clock.h"

#include "elmopp/assert.h"

#include "elmopp_can.h"

#define BYTES 8U

/* Where the next frame goes. */
typedef struct {
    elmopp_frame_t *out;
    uint32_t count;
    uint8_t *counter;
} writer_t;

elmopp_frame_t elmopp_bus_clock_make_time(elmopp_ms_t now_ms) {
    elmopp_frame_t frame = {.id = (uint16_t)ELMOPP_CAN_SIM_TIME_FRAME_ID, .length = (uint8_t)BYTES, .data = {0U}};
    const struct elmopp_can_sim_time_t signals = {.now_ms = now_ms};
    ELMOPP_ASSERT(elmopp_can_sim_time_pack(frame.data, &signals, BYTES) == (int)BYTES);
    return frame;
}

elmopp_ms_t elmopp_bus_clock_time(const elmopp_frame_t *frame) {
    struct elmopp_can_sim_time_t signals = {.now_ms = 0U};
    ELMOPP_ASSERT(elmopp_can_sim_time_unpack(&signals, frame->data, BYTES) == 0);
    return signals.now_ms;
}

bool elmopp_bus_clock_decided(const elmopp_frame_t *frames, uint32_t count) {
    bool decided = false;
    for (uint32_t k = 0U; k < count; k++) {
        decided = decided || (frames[k].id == ELMOPP_CAN_FORECAST_FRAME_ID); /* of approach 0: every site has one */
    }
    return decided;
}

static void write(writer_t *writer, elmopp_trace_kind_t kind, const float *values, uint32_t count) {
    for (uint32_t i = 0U; i < count; i++) {
        elmopp_frame_t *frame = &writer->out[writer->count];
        *frame = (elmopp_frame_t){
            .id = (uint16_t)ELMOPP_CAN_DECISION_TRACE_FRAME_ID, .length = (uint8_t)BYTES, .data = {0U}};
        const struct elmopp_can_decision_trace_t signals = {
            .kind = (uint8_t)kind, .index = (uint8_t)i, .value = values[i]};
        ELMOPP_ASSERT(elmopp_can_decision_trace_pack(frame->data, &signals, BYTES) == (int)BYTES);
        elmopp_link_seal(frame, writer->counter);
        writer->count++;
    }
}

uint32_t elmopp_bus_clock_trace(const elmopp_controller_t *controller, uint8_t *counter,
                                elmopp_frame_t out[ELMOPP_TRACE_MAX]) {
    const elmopp_junction_t *junction = controller->junction;
    writer_t writer = {.out = out, .count = 0U, .counter = counter};
    write(&writer, ELMOPP_TRACE_SCORE, controller->pilot.score, junction->stage_count);
    write(&writer, ELMOPP_TRACE_FORECAST, controller->pilot.foreseen_sum_veh, junction->approach_count);
    write(&writer, ELMOPP_TRACE_PRESENT, controller->present_veh, junction->movement_count);
    write(&writer, ELMOPP_TRACE_ARRIVED, controller->arrived_veh, junction->movement_count);
    return writer.count;
}

elmopp_trace_t elmopp_bus_clock_read(const elmopp_frame_t *frame) {
    struct elmopp_can_decision_trace_t signals = {.kind = 0U, .index = 0U, .value = 0.0F};
    ELMOPP_ASSERT(elmopp_can_decision_trace_unpack(&signals, frame->data, BYTES) == 0);
    return (elmopp_trace_t){.kind = signals.kind, .index = signals.index, .value = signals.value};
}
