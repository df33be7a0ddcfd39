/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Frames: what the controller's frames mean, as the core's own types.
///
/// Translates between the generated codec (firmware/can/elmopp_can.h, made from elmopp.dbc) and what the rooms speak.
/// It believes nothing and seals nothing: whether a frame may be believed is the link's to say, when it is sent the
/// controller's. Pure; no state.

#ifndef ELMOPP_FRAMES_H
#define ELMOPP_FRAMES_H

#include "elmopp/detector.h"
#include "elmopp/fault.h"
#include "elmopp/lamps.h"
#include "elmopp/link.h"
#include "elmopp/mode.h"
#include "elmopp/outflow.h"

/// What a Command may ask for. The numbers are those of the bus.
typedef enum {
    ELMOPP_REQUEST_NONE = 0,
    ELMOPP_REQUEST_SET_WALL_TIME = 1, ///< argument: local seconds since 2000-01-01
    ELMOPP_REQUEST_RUN = 2,
    ELMOPP_REQUEST_FIXED_TIME = 3,
    ELMOPP_REQUEST_MANUAL = 4, ///< argument: the stage
    ELMOPP_REQUEST_ALL_RED = 5,
    ELMOPP_REQUEST_FLASHING = 6,
    ELMOPP_REQUEST_DARK = 7,
    ELMOPP_REQUEST_CLEAR_FAULT_PREPARE = 8, ///< argument: the code of the fault
    ELMOPP_REQUEST_CLEAR_FAULT_CONFIRM = 9  ///< the same
} elmopp_request_t;

/// LampFeedback of one node.
typedef struct {
    elmopp_lamps_t lamps; ///< measured; `flash` is 0
    bool lamp_fault;
    bool own_fail_safe;
} elmopp_feedback_t;

/// JunctionOccupied.
typedef struct {
    bool occupied;  ///< a vehicle stands inside the junction
    bool valid;     ///< the camera knows
    uint8_t reason; ///< ... or why not, as of DetectorCounts
} elmopp_occupancy_t;

/// ControllerStatus.
typedef struct {
    elmopp_mode_t mode;
    uint8_t stage;       ///< ELMOPP_STAGE_NONE: none
    uint16_t elapsed_ds; ///< 4095: as long or longer
    elmopp_fault_t fault;
    uint8_t fault_group;
    uint16_t weights_id;
    uint8_t refused; ///< frames and commands, modulo 256
} elmopp_status_t;

/// Forecast of one approach.
typedef struct {
    uint8_t model;    ///< ELMOPP_FORECAST_*, or one of the following
    float next10_veh; ///< in the next 10 seconds
    float next30_veh;
    float next60_veh;
    float error; ///< mean square of the recent error, (vehicles a second) squared
} elmopp_outlook_t;

/// Models beyond the forecasts of a site: the site's network by weights that it has learnt itself, and where rows come
/// from that are not the forecast's own.
enum {
    ELMOPP_MODEL_LEARNT = 11,
    ELMOPP_MODEL_GIVEN = 12,
    ELMOPP_MODEL_COLD = 13,
    ELMOPP_MODEL_UNARMED = 14,
    ELMOPP_MODEL_DISTRUSTED = 15
};

/// The frames to send, not yet sealed: counter and CRC are 0.
elmopp_frame_t elmopp_frames_lamp_command(const elmopp_lamps_t *lamps, bool fail_safe, bool dark);
elmopp_frame_t elmopp_frames_status(const elmopp_status_t *status);
elmopp_frame_t elmopp_frames_forecast(uint32_t approach, const elmopp_outlook_t *outlook);

/// What a received frame says. The frame has passed the link.
uint8_t elmopp_frames_counts(const elmopp_frame_t *frame,
                             elmopp_detector_report_t report[ELMOPP_APPROACH_MOVEMENT_MAX]);
elmopp_feedback_t elmopp_frames_feedback(const elmopp_frame_t *frame);
elmopp_occupancy_t elmopp_frames_occupancy(const elmopp_frame_t *frame);
elmopp_outflow_t elmopp_frames_outflow(const elmopp_frame_t *frame); ///< of age 0; `ahead_s` in whole seconds, down
elmopp_request_t elmopp_frames_command(const elmopp_frame_t *frame, uint32_t *argument);

/// The other side of the bus, for simulators and lamp nodes: frames not yet sealed, and the lamps of a LampCommand.
/// False if the frame is none, or shows an aspect that does not exist; `lamps` is then unchanged.
elmopp_frame_t elmopp_frames_make_counts(uint32_t approach,
                                         const elmopp_detector_report_t report[ELMOPP_APPROACH_MOVEMENT_MAX],
                                         uint8_t reason);
elmopp_frame_t elmopp_frames_make_feedback(uint32_t node, const elmopp_feedback_t *feedback);
elmopp_frame_t elmopp_frames_make_occupancy(const elmopp_occupancy_t *occupancy);
elmopp_frame_t elmopp_frames_make_outflow(uint32_t approach, const elmopp_outflow_t *outflow);
bool elmopp_frames_lamps(const elmopp_frame_t *frame, elmopp_lamps_t *lamps);

#endif
