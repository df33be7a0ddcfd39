/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "bus_clock.h"
#include "grid.h"
#include "pace.h"
#include "port.h"

#include "elmopp_can.h"

#define LAMP_COMMAND 0U /* first of a tick's frames */
#define ROOM_MS 1000U   /* so long it waits for room to send: in lockstep nothing may be lost */
#define LOOK_MS 1000U

static elmopp_grid_t grid;
static elmopp_link_t time_link;
static elmopp_ms_t time_ms;
static elmopp_pace_due_t pending;
static uint8_t trace_counter;
static bool simulated;

void elmopp_pace_begin(void) {
    elmopp_grid_init(&grid, elmopp_port_now_ms());
    elmopp_link_init(&time_link);
    pending = ELMOPP_PACE_NOT_YET;
    trace_counter = 0U;
    simulated = false;
}

/* SimTime 0 begins anew, whatever counter it carries; from then on the board's clock is of no matter. */
static void take_time(const elmopp_frame_t *frame) {
    const elmopp_ms_t told_ms = elmopp_bus_clock_time(frame);
    const bool anew = told_ms == 0U;
    elmopp_link_t link = time_link;
    if (anew) {
        elmopp_link_init(&link);
    }
    const bool believed = elmopp_link_take(&link, frame, (uint16_t)ELMOPP_CAN_SIM_TIME_FRAME_ID, 0U) == ELMOPP_LINK_OK;
    if (believed && (anew || simulated)) {
        time_link = link;
        time_ms = told_ms;
        pending = anew ? ELMOPP_PACE_ANEW : ELMOPP_PACE_TICK;
        simulated = true;
    }
}

bool elmopp_pace_take(const elmopp_frame_t *frame) {
    const bool own = (frame->id == (uint16_t)ELMOPP_CAN_SIM_TIME_FRAME_ID) && (frame->length == ELMOPP_LINK_BYTES);
    if (own) {
        take_time(frame);
    }
    return own;
}

elmopp_pace_due_t elmopp_pace_due(elmopp_ms_t *now_ms) {
    if (!simulated) {
        *now_ms = elmopp_port_now_ms();
        return elmopp_grid_due(&grid, *now_ms) ? ELMOPP_PACE_TICK : ELMOPP_PACE_NOT_YET;
    }
    const elmopp_pace_due_t due = pending;
    pending = ELMOPP_PACE_NOT_YET;
    trace_counter = (due == ELMOPP_PACE_ANEW) ? (uint8_t)0U : trace_counter;
    *now_ms = time_ms;
    return due;
}

static void send_surely(const elmopp_frame_t *frame) {
    const elmopp_ms_t begun_ms = elmopp_port_now_ms();
    while ((!elmopp_port_send(frame)) && ((elmopp_port_now_ms() - begun_ms) < ROOM_MS)) {
        elmopp_port_kick_watchdog();
    }
}

/* The LampCommand goes last: whoever waits for it has then heard everything, the exact values after the rounded ones of
   Forecast. */
static void answer(const elmopp_controller_t *controller, const elmopp_frame_t *frames, uint32_t count) {
    static elmopp_frame_t trace[ELMOPP_TRACE_MAX];
    const bool decided = elmopp_bus_clock_decided(frames, count);
    const uint32_t values = decided ? elmopp_bus_clock_trace(controller, &trace_counter, trace) : 0U;
    for (uint32_t k = 1U; k < count; k++) {
        send_surely(&frames[k]);
    }
    for (uint32_t k = 0U; k < values; k++) {
        send_surely(&trace[k]);
    }
    if (count > 0U) {
        send_surely(&frames[LAMP_COMMAND]);
    }
}

void elmopp_pace_send(const elmopp_controller_t *controller, const elmopp_frame_t *frames, uint32_t count) {
    if (simulated) {
        answer(controller, frames, count);
    } else {
        for (uint32_t k = 0U; k < count; k++) {
            (void)elmopp_port_send(&frames[k]);
        }
    }
}

void elmopp_pace_wait(void) {
    if (simulated) {
        elmopp_port_kick_watchdog(); /* a simulator may take its time */
    }
    elmopp_port_sleep_until(simulated ? (elmopp_port_now_ms() + LOOK_MS) : grid.next_ms);
}
