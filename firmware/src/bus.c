/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/bus.h"

#include "elmopp/frames.h"

#include "elmopp_can.h"

#define MS_PER_DS 100U
#define DS_PER_S 10U

/* Time-outs are multiples of the DBC's cycle times. Feedback comes with every tick, is a tick old when it is looked at,
   and may be missing for as long as it takes to lose three. */
#define CYCLES_LOST 3U
#define CAMERA_TIMEOUT_DS ((CYCLES_LOST * ELMOPP_CAN_DETECTOR_COUNTS_CYCLE_TIME_MS) / MS_PER_DS)
#define FEEDBACK_TIMEOUT_DS (((CYCLES_LOST * ELMOPP_CAN_LAMP_FEEDBACK_CYCLE_TIME_MS) / MS_PER_DS) + 2U)
#define JUNCTION_TIMEOUT_DS ((CYCLES_LOST * ELMOPP_CAN_JUNCTION_OCCUPIED_CYCLE_TIME_MS) / MS_PER_DS)
#define NEIGHBOUR_TIMEOUT_DS ((CYCLES_LOST * ELMOPP_CAN_NEIGHBOUR_OUTFLOW_CYCLE_TIME_MS) / MS_PER_DS)
#define COMMAND_TIMEOUT_DS 100U /* a person; after a pause any counter is good */

void elmopp_bus_init(elmopp_bus_t *self, const elmopp_junction_t *junction) {
    *self = (elmopp_bus_t){.junction = junction, .used_nodes = elmopp_junction_nodes(junction)};
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        elmopp_link_init(&self->camera[i]);
        elmopp_link_init(&self->neighbour[i]);
    }
    for (uint32_t n = 0U; n < ELMOPP_NODE_MAX; n++) {
        elmopp_link_init(&self->node[n]);
    }
    elmopp_link_init(&self->junction_camera);
    elmopp_link_init(&self->command);
}

void elmopp_bus_refuse(elmopp_bus_t *self, uint32_t count) {
    self->refused = (uint8_t)((self->refused + count) & UINT8_MAX);
}

/* --- frames in --- */

/* What becomes of a frame for us: `news` if it is believed. */
static elmopp_news_kind_t believed(elmopp_bus_t *self, elmopp_link_t *link, const elmopp_frame_t *frame,
                                   uint16_t timeout_ds, elmopp_news_kind_t news) {
    if (elmopp_link_take(link, frame, frame->id, timeout_ds) != ELMOPP_LINK_OK) {
        elmopp_bus_refuse(self, 1U);
        return ELMOPP_NEWS_REFUSED;
    }
    return news;
}

static void keep_feedback(elmopp_bus_t *self, uint32_t node, const elmopp_frame_t *frame) {
    const elmopp_feedback_t feedback = elmopp_frames_feedback(frame);
    for (uint32_t g = 0U; g < self->junction->group_count; g++) {
        if (self->junction->group[g].node == node) {
            elmopp_lamps_light(&self->measured, g, elmopp_lamps_bits(&feedback.lamps, g));
        }
    }
    const bool unwell = feedback.lamp_fault || feedback.own_fail_safe;
    const uint32_t bit = (uint32_t)1U << node;
    const uint32_t others = self->unwell_nodes & ~bit;
    self->unwell_nodes = (uint8_t)(others | (unwell ? bit : 0U));
}

static void keep_occupancy(elmopp_bus_t *self, const elmopp_frame_t *frame) {
    const elmopp_occupancy_t occupancy = elmopp_frames_occupancy(frame);
    self->occupied = occupancy.valid && occupancy.occupied;
}

/* A controller's own words, whole and made for this bus. What counter they carry is no matter. */
static bool is_second_controller(const elmopp_frame_t *frame) {
    const bool own =
        (frame->id == ELMOPP_CAN_LAMP_COMMAND_FRAME_ID) || (frame->id == ELMOPP_CAN_CONTROLLER_STATUS_FRAME_ID);
    return own && elmopp_link_is_whole(frame);
}

elmopp_news_t elmopp_bus_hear(elmopp_bus_t *self, const elmopp_frame_t *frame) {
    const uint32_t approach = (uint32_t)frame->id - ELMOPP_CAN_DETECTOR_COUNTS_FRAME_ID;
    const uint32_t node = (uint32_t)frame->id - ELMOPP_CAN_LAMP_FEEDBACK_FRAME_ID;
    const uint32_t neighbour = (uint32_t)frame->id - ELMOPP_CAN_NEIGHBOUR_OUTFLOW_FRAME_ID;
    elmopp_news_t news = {.kind = ELMOPP_NEWS_NOT_OURS, .approach = approach};
    if ((approach < ELMOPP_APPROACH_MAX) && elmopp_mask_has(self->junction->cameras, approach)) {
        news.kind = believed(self, &self->camera[approach], frame, CAMERA_TIMEOUT_DS, ELMOPP_NEWS_COUNTS);
    } else if ((node < ELMOPP_NODE_MAX) && elmopp_mask_has(self->used_nodes, node)) {
        news.kind = believed(self, &self->node[node], frame, FEEDBACK_TIMEOUT_DS, ELMOPP_NEWS_KEPT);
        if (news.kind == ELMOPP_NEWS_KEPT) {
            keep_feedback(self, node, frame);
        }
    } else if ((frame->id == ELMOPP_CAN_JUNCTION_OCCUPIED_FRAME_ID) && (self->junction->junction_wait_ds > 0U)) {
        news.kind = believed(self, &self->junction_camera, frame, JUNCTION_TIMEOUT_DS, ELMOPP_NEWS_KEPT);
        if (news.kind == ELMOPP_NEWS_KEPT) {
            keep_occupancy(self, frame);
        }
    } else if ((neighbour < ELMOPP_APPROACH_MAX) && (neighbour < self->junction->approach_count)) {
        news.kind = believed(self, &self->neighbour[neighbour], frame, NEIGHBOUR_TIMEOUT_DS, ELMOPP_NEWS_KEPT);
        if (news.kind == ELMOPP_NEWS_KEPT) {
            self->outflow[neighbour] = elmopp_frames_outflow(frame);
        }
    } else if (frame->id == ELMOPP_CAN_COMMAND_FRAME_ID) {
        news.kind = believed(self, &self->command, frame, COMMAND_TIMEOUT_DS, ELMOPP_NEWS_COMMAND);
    } else if (is_second_controller(frame)) {
        news.kind = ELMOPP_NEWS_SECOND;
    } else {
        /* somebody else's */
    }
    return news;
}

/* --- time --- */

void elmopp_bus_tick(elmopp_bus_t *self) {
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        elmopp_link_tick(&self->camera[i]);
        elmopp_link_tick(&self->neighbour[i]);
    }
    for (uint32_t n = 0U; n < ELMOPP_NODE_MAX; n++) {
        elmopp_link_tick(&self->node[n]);
    }
    elmopp_link_tick(&self->junction_camera);
    elmopp_link_tick(&self->command);
}

/* A neighbour that has fallen silent is as one that never spoke; between two frames what it said gets older. */
void elmopp_bus_second(elmopp_bus_t *self) {
    for (uint32_t i = 0U; i < self->junction->approach_count; i++) {
        if (elmopp_link_fresh(&self->neighbour[i], NEIGHBOUR_TIMEOUT_DS)) {
            self->outflow[i].age_s = (uint16_t)(self->neighbour[i].age_ds / DS_PER_S);
        } else {
            self->outflow[i].ahead_s = 0U;
        }
    }
}

/* --- what still counts --- */

uint16_t elmopp_bus_fresh_groups(const elmopp_bus_t *self) {
    uint16_t fresh = 0U;
    for (uint32_t g = 0U; g < self->junction->group_count; g++) {
        const uint32_t node = self->junction->group[g].node;
        if ((node < ELMOPP_NODE_MAX) && elmopp_link_fresh(&self->node[node], FEEDBACK_TIMEOUT_DS)) {
            fresh |= (uint16_t)((uint32_t)1U << g);
        }
    }
    return fresh;
}

bool elmopp_bus_is_occupied(const elmopp_bus_t *self) {
    return self->occupied && elmopp_link_fresh(&self->junction_camera, JUNCTION_TIMEOUT_DS);
}
