/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/lamp_node.h"

#include "elmopp/assert.h"
#include "elmopp/frames.h"

#include "elmopp_can.h"

#define LINK_TIMEOUT_DS 3U
#define MS_PER_DS 100U

static void flash(elmopp_lamp_node_t *self) {
    self->fail_safe = true;
    self->calm = false;
    self->calm_ms = 0U;
    self->lamps = elmopp_lamps_flashing(self->junction, self->groups);
}

void elmopp_lamp_node_init(elmopp_lamp_node_t *self, const elmopp_junction_t *junction, uint32_t node) {
    ELMOPP_ASSERT(node < ELMOPP_NODE_MAX);
    *self = (elmopp_lamp_node_t){.junction = junction, .node = (uint8_t)node, .silent_ms = ELMOPP_LAMP_NODE_TIMEOUT_MS};
    elmopp_link_init(&self->link);
    self->groups = elmopp_junction_groups_of_node(junction, node);
    flash(self);
}

/* Nobody is told to go, or that he soon may: what flashes or is red or dark. */
static bool is_calm(const elmopp_lamps_t *lamps) {
    const uint32_t steady_amber = (uint32_t)lamps->amber & ~(uint32_t)lamps->flash;
    return (lamps->green == 0U) && (steady_amber == 0U);
}

static elmopp_lamps_t own(const elmopp_lamp_node_t *self, const elmopp_lamps_t *lamps) {
    const uint32_t groups = self->groups;
    return (elmopp_lamps_t){.red = (uint16_t)(lamps->red & groups),
                            .amber = (uint16_t)(lamps->amber & groups),
                            .green = (uint16_t)(lamps->green & groups),
                            .flash = (uint16_t)(lamps->flash & groups)};
}

bool elmopp_lamp_node_take(elmopp_lamp_node_t *self, const elmopp_frame_t *frame) {
    if (frame->id != ELMOPP_CAN_LAMP_COMMAND_FRAME_ID) {
        return false;
    }
    elmopp_lamps_t lamps = {0U, 0U, 0U, 0U};
    elmopp_link_t link = self->link;
    const bool believed =
        elmopp_link_take(&link, frame, (uint16_t)ELMOPP_CAN_LAMP_COMMAND_FRAME_ID, LINK_TIMEOUT_DS) == ELMOPP_LINK_OK;
    if ((!believed) || (!elmopp_frames_lamps(frame, &lamps))) {
        self->refused = (self->refused < UINT32_MAX) ? (self->refused + 1U) : self->refused;
        return false;
    }
    self->link = link;
    self->silent_ms = 0U;
    const bool calm = is_calm(&lamps);
    self->calm_ms = (calm && self->calm) ? self->calm_ms : 0U;
    self->calm = calm;
    if ((!self->fail_safe) || (self->calm_ms >= ELMOPP_LAMP_NODE_RETURN_MS)) {
        self->fail_safe = false;
        self->lamps = own(self, &lamps);
    }
    return true;
}

void elmopp_lamp_node_pass(elmopp_lamp_node_t *self, uint32_t elapsed_ms) {
    const uint32_t step_ms = (elapsed_ms < ELMOPP_LAMP_NODE_TIMEOUT_MS) ? elapsed_ms : ELMOPP_LAMP_NODE_TIMEOUT_MS;
    self->rest_ms += step_ms;
    while (self->rest_ms >= MS_PER_DS) {
        self->rest_ms -= MS_PER_DS;
        elmopp_link_tick(&self->link);
    }
    if (self->silent_ms < ELMOPP_LAMP_NODE_TIMEOUT_MS) {
        self->silent_ms += step_ms;
        /* The second begins with the first calm command, not with the last other one. */
        self->calm_ms = (self->calm_ms < ELMOPP_LAMP_NODE_RETURN_MS) ? (self->calm_ms + step_ms) : self->calm_ms;
    }
    if (self->silent_ms >= ELMOPP_LAMP_NODE_TIMEOUT_MS) {
        flash(self);
    }
}

elmopp_frame_t elmopp_lamp_node_feedback(elmopp_lamp_node_t *self, const elmopp_lamps_t *measured, bool lamp_fault) {
    const elmopp_feedback_t feedback = {
        .lamps = own(self, measured), .lamp_fault = lamp_fault, .own_fail_safe = self->fail_safe};
    elmopp_frame_t frame = elmopp_frames_make_feedback(self->node, &feedback);
    elmopp_link_seal(&frame, &self->counter);
    return frame;
}
