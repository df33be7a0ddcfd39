/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Bus clock: the time comes over the bus, and what was decided goes out in full. For comparing logs.
///
/// One SimTime is one lamp tick, answered by LampCommand; SimTime 0 is none and begins anew. Before the answer to the
/// tick after a decision, with the Forecast frames, come DecisionTrace frames with the floats of the decision log.
/// Never part of an image that drives a street: a frame could stop its clock.
///
/// Pure translations; no state but the sender's counter.

#ifndef ELMOPP_BUS_CLOCK_H
#define ELMOPP_BUS_CLOCK_H

#include "elmopp/controller.h"

/// What a DecisionTrace holds one value of. The numbers are those of the bus.
typedef enum {
    ELMOPP_TRACE_SCORE = 0,    ///< of a stage
    ELMOPP_TRACE_FORECAST = 1, ///< of an approach, the next 60 seconds
    ELMOPP_TRACE_PRESENT = 2,  ///< on a movement
    ELMOPP_TRACE_ARRIVED = 3   ///< on a movement, in the last second
} elmopp_trace_kind_t;

/// Frames that one decision takes at most.
#define ELMOPP_TRACE_MAX (ELMOPP_STAGE_MAX + ELMOPP_APPROACH_MAX + (2U * ELMOPP_MOVEMENT_MAX))

typedef struct {
    uint8_t kind; ///< ELMOPP_TRACE_*, or something unknown
    uint8_t index;
    float value;
} elmopp_trace_t;

/// SimTime, not yet sealed, and what a received one says.
elmopp_frame_t elmopp_bus_clock_make_time(elmopp_ms_t now_ms);
elmopp_ms_t elmopp_bus_clock_time(const elmopp_frame_t *frame);

/// True if these frames of a tick say what the controller has decided: Forecast is among them.
bool elmopp_bus_clock_decided(const elmopp_frame_t *frames, uint32_t count);

/// The last decision as DecisionTrace frames, sealed. Returns how many.
uint32_t elmopp_bus_clock_trace(const elmopp_controller_t *controller, uint8_t *counter,
                                elmopp_frame_t out[ELMOPP_TRACE_MAX]);

/// What a received DecisionTrace says.
elmopp_trace_t elmopp_bus_clock_read(const elmopp_frame_t *frame);

#endif
