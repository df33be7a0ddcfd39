/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/frames.h"

#include "elmopp/assert.h"

#include "elmopp_can.h"

#define BYTES 8U

#define MEASURED 0x7U /* the lamps of a group that LampFeedback has room for: not whether they go on and off */

#define TENTHS 10.0F
#define DS_PER_S 10U
#define THOUSANDTHS 1000.0F
#define FIELD_MAX 4095U /* of the 12-bit signals */

static elmopp_frame_t empty(uint32_t id) {
    return (elmopp_frame_t){.id = (uint16_t)id, .length = (uint8_t)BYTES, .data = {0U}};
}

/* The codec's status: eight bytes written, or nothing wrong with eight bytes read. Anything else would be a bug. */
static void check_written(int bytes) {
    ELMOPP_ASSERT(bytes == (int)BYTES);
}

static void check_read(int status) {
    ELMOPP_ASSERT(status == 0);
}

static uint8_t digit(bool on) {
    return on ? (uint8_t)1U : (uint8_t)0U;
}

/* A number of 12 bits, saturating; false comparisons send a NaN to 0. */
static uint16_t scaled(float value, float per_unit) {
    const float number = value * per_unit;
    uint16_t field = 0U;
    if (number >= (float)FIELD_MAX) {
        field = (uint16_t)FIELD_MAX;
    } else if (number > 0.0F) {
        field = (uint16_t)(number + 0.5F);
    } else {
        /* nothing */
    }
    return field;
}

/* --- the controller's own --- */

elmopp_frame_t elmopp_frames_lamp_command(const elmopp_lamps_t *lamps, bool fail_safe, bool dark) {
    uint8_t aspect[ELMOPP_GROUP_MAX];
    for (uint32_t g = 0U; g < ELMOPP_GROUP_MAX; g++) {
        aspect[g] = (uint8_t)elmopp_lamps_aspect(lamps, g);
    }
    const struct elmopp_can_lamp_command_t signals = {
        .fail_safe = digit(fail_safe),
        .dark = digit(dark),
        .aspect0 = aspect[0],
        .aspect1 = aspect[1],
        .aspect2 = aspect[2],
        .aspect3 = aspect[3],
        .aspect4 = aspect[4],
        .aspect5 = aspect[5],
        .aspect6 = aspect[6],
        .aspect7 = aspect[7],
        .aspect8 = aspect[8],
        .aspect9 = aspect[9],
        .aspect10 = aspect[10],
        .aspect11 = aspect[11],
        .aspect12 = aspect[12],
        .aspect13 = aspect[13],
        .aspect14 = aspect[14],
        .aspect15 = aspect[15],
    };
    elmopp_frame_t frame = empty(ELMOPP_CAN_LAMP_COMMAND_FRAME_ID);
    check_written(elmopp_can_lamp_command_pack(frame.data, &signals, sizeof frame.data));
    return frame;
}

elmopp_frame_t elmopp_frames_status(const elmopp_status_t *status) {
    const struct elmopp_can_controller_status_t signals = {
        .mode = (uint8_t)status->mode,
        .stage = status->stage,
        .elapsed_ds = (status->elapsed_ds < FIELD_MAX) ? status->elapsed_ds : (uint16_t)FIELD_MAX,
        .first_fault = (uint8_t)status->fault,
        .fault_group = status->fault_group,
        .weights_id = status->weights_id,
        .refused = status->refused,
    };
    elmopp_frame_t frame = empty(ELMOPP_CAN_CONTROLLER_STATUS_FRAME_ID);
    check_written(elmopp_can_controller_status_pack(frame.data, &signals, sizeof frame.data));
    return frame;
}

elmopp_frame_t elmopp_frames_forecast(uint32_t approach, const elmopp_outlook_t *outlook) {
    const struct elmopp_can_forecast_t signals = {
        .model = outlook->model,
        .next10 = scaled(outlook->next10_veh, TENTHS),
        .next30 = scaled(outlook->next30_veh, TENTHS),
        .next60 = scaled(outlook->next60_veh, TENTHS),
        .error = scaled(outlook->error, THOUSANDTHS),
    };
    elmopp_frame_t frame = empty(ELMOPP_CAN_FORECAST_FRAME_ID + approach);
    check_written(elmopp_can_forecast_pack(frame.data, &signals, sizeof frame.data));
    return frame;
}

/* --- received --- */

uint8_t elmopp_frames_counts(const elmopp_frame_t *frame,
                             elmopp_detector_report_t report[ELMOPP_APPROACH_MOVEMENT_MAX]) {
    struct elmopp_can_detector_counts_t signals;
    check_read(elmopp_can_detector_counts_unpack(&signals, frame->data, sizeof frame->data));
    report[0] = (elmopp_detector_report_t){signals.present0, signals.arrivals0, signals.valid0 != 0U};
    report[1] = (elmopp_detector_report_t){signals.present1, signals.arrivals1, signals.valid1 != 0U};
    report[2] = (elmopp_detector_report_t){signals.present2, signals.arrivals2, signals.valid2 != 0U};
    return signals.reason;
}

elmopp_feedback_t elmopp_frames_feedback(const elmopp_frame_t *frame) {
    struct elmopp_can_lamp_feedback_t signals;
    check_read(elmopp_can_lamp_feedback_unpack(&signals, frame->data, sizeof frame->data));
    const uint8_t measured[ELMOPP_GROUP_MAX] = {signals.lamps0,  signals.lamps1,  signals.lamps2,  signals.lamps3,
                                                signals.lamps4,  signals.lamps5,  signals.lamps6,  signals.lamps7,
                                                signals.lamps8,  signals.lamps9,  signals.lamps10, signals.lamps11,
                                                signals.lamps12, signals.lamps13, signals.lamps14, signals.lamps15};
    elmopp_feedback_t feedback = {.lamps = {0U, 0U, 0U, 0U},
                                  .lamp_fault = signals.lamp_fault != 0U,
                                  .own_fail_safe = signals.own_fail_safe != 0U};
    for (uint32_t g = 0U; g < ELMOPP_GROUP_MAX; g++) {
        elmopp_lamps_light(&feedback.lamps, g, measured[g]);
    }
    return feedback;
}

elmopp_occupancy_t elmopp_frames_occupancy(const elmopp_frame_t *frame) {
    struct elmopp_can_junction_occupied_t signals;
    check_read(elmopp_can_junction_occupied_unpack(&signals, frame->data, sizeof frame->data));
    return (elmopp_occupancy_t){
        .occupied = signals.occupied != 0U, .valid = signals.valid != 0U, .reason = signals.reason};
}

elmopp_outflow_t elmopp_frames_outflow(const elmopp_frame_t *frame) {
    struct elmopp_can_neighbour_outflow_t signals;
    check_read(elmopp_can_neighbour_outflow_unpack(&signals, frame->data, sizeof frame->data));
    return (elmopp_outflow_t){.next10_veh = (float)signals.next10 / TENTHS,
                              .next30_veh = (float)signals.next30 / TENTHS,
                              .next60_veh = (float)signals.next60 / TENTHS,
                              .ahead_s = (uint16_t)(signals.ahead / DS_PER_S),
                              .age_s = 0U};
}

elmopp_request_t elmopp_frames_command(const elmopp_frame_t *frame, uint32_t *argument) {
    struct elmopp_can_command_t signals;
    check_read(elmopp_can_command_unpack(&signals, frame->data, sizeof frame->data));
    *argument = signals.argument;
    return (elmopp_request_t)signals.request;
}

/* --- the other side of the bus --- */

elmopp_frame_t elmopp_frames_make_counts(uint32_t approach,
                                         const elmopp_detector_report_t report[ELMOPP_APPROACH_MOVEMENT_MAX],
                                         uint8_t reason) {
    const struct elmopp_can_detector_counts_t signals = {
        .reason = reason,
        .present0 = report[0].present_veh,
        .present1 = report[1].present_veh,
        .present2 = report[2].present_veh,
        .arrivals0 = report[0].arrivals,
        .arrivals1 = report[1].arrivals,
        .arrivals2 = report[2].arrivals,
        .valid0 = digit(report[0].valid),
        .valid1 = digit(report[1].valid),
        .valid2 = digit(report[2].valid),
    };
    elmopp_frame_t frame = empty(ELMOPP_CAN_DETECTOR_COUNTS_FRAME_ID + approach);
    check_written(elmopp_can_detector_counts_pack(frame.data, &signals, sizeof frame.data));
    return frame;
}

elmopp_frame_t elmopp_frames_make_feedback(uint32_t node, const elmopp_feedback_t *feedback) {
    uint8_t measured[ELMOPP_GROUP_MAX];
    for (uint32_t g = 0U; g < ELMOPP_GROUP_MAX; g++) {
        measured[g] = (uint8_t)(elmopp_lamps_bits(&feedback->lamps, g) & MEASURED);
    }
    const struct elmopp_can_lamp_feedback_t signals = {
        .lamp_fault = digit(feedback->lamp_fault),
        .own_fail_safe = digit(feedback->own_fail_safe),
        .lamps0 = measured[0],
        .lamps1 = measured[1],
        .lamps2 = measured[2],
        .lamps3 = measured[3],
        .lamps4 = measured[4],
        .lamps5 = measured[5],
        .lamps6 = measured[6],
        .lamps7 = measured[7],
        .lamps8 = measured[8],
        .lamps9 = measured[9],
        .lamps10 = measured[10],
        .lamps11 = measured[11],
        .lamps12 = measured[12],
        .lamps13 = measured[13],
        .lamps14 = measured[14],
        .lamps15 = measured[15],
    };
    elmopp_frame_t frame = empty(ELMOPP_CAN_LAMP_FEEDBACK_FRAME_ID + node);
    check_written(elmopp_can_lamp_feedback_pack(frame.data, &signals, sizeof frame.data));
    return frame;
}

elmopp_frame_t elmopp_frames_make_occupancy(const elmopp_occupancy_t *occupancy) {
    const struct elmopp_can_junction_occupied_t signals = {
        .occupied = digit(occupancy->occupied), .valid = digit(occupancy->valid), .reason = occupancy->reason};
    elmopp_frame_t frame = empty(ELMOPP_CAN_JUNCTION_OCCUPIED_FRAME_ID);
    check_written(elmopp_can_junction_occupied_pack(frame.data, &signals, sizeof frame.data));
    return frame;
}

elmopp_frame_t elmopp_frames_make_outflow(uint32_t approach, const elmopp_outflow_t *outflow) {
    const struct elmopp_can_neighbour_outflow_t signals = {
        .next10 = scaled(outflow->next10_veh, TENTHS),
        .next30 = scaled(outflow->next30_veh, TENTHS),
        .next60 = scaled(outflow->next60_veh, TENTHS),
        .ahead = scaled((float)outflow->ahead_s, TENTHS),
    };
    elmopp_frame_t frame = empty(ELMOPP_CAN_NEIGHBOUR_OUTFLOW_FRAME_ID + approach);
    check_written(elmopp_can_neighbour_outflow_pack(frame.data, &signals, sizeof frame.data));
    return frame;
}

bool elmopp_frames_lamps(const elmopp_frame_t *frame, elmopp_lamps_t *lamps) {
    if (frame->id != ELMOPP_CAN_LAMP_COMMAND_FRAME_ID) {
        return false;
    }
    struct elmopp_can_lamp_command_t signals;
    check_read(elmopp_can_lamp_command_unpack(&signals, frame->data, sizeof frame->data));
    const uint8_t aspect[ELMOPP_GROUP_MAX] = {signals.aspect0,  signals.aspect1,  signals.aspect2,  signals.aspect3,
                                              signals.aspect4,  signals.aspect5,  signals.aspect6,  signals.aspect7,
                                              signals.aspect8,  signals.aspect9,  signals.aspect10, signals.aspect11,
                                              signals.aspect12, signals.aspect13, signals.aspect14, signals.aspect15};
    elmopp_lamps_t shown = {0U, 0U, 0U, 0U};
    for (uint32_t g = 0U; g < ELMOPP_GROUP_MAX; g++) {
        if (aspect[g] >= (uint8_t)ELMOPP_ASPECT_COUNT) {
            return false;
        }
        elmopp_lamps_show(&shown, g, (elmopp_aspect_t)aspect[g]);
    }
    *lamps = shown;
    return true;
}
