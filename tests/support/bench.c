/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "bench.h"

#include "elmopp_can.h"
#include "sites.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

#define STAGES_IN_TURN 255U
#define TURN_S 8U
#define NEVER (-1000000LL)

static bool has(uint32_t mask, uint32_t i) {
    return ((mask >> i) & 1U) != 0U;
}

/* --- the street's own eyes --- */

static void complain(bench_t *self, const char *what, uint32_t g, uint32_t h) {
    if (self->complaint[0] == '\0') {
        (void)snprintf(self->complaint, sizeof self->complaint, "%s [%u, %u] at tick %u, mode %u", what, (unsigned)g,
                       (unsigned)h, (unsigned)self->ticks, (unsigned)self->controller.mode);
    }
}

static bool is_free(elmopp_aspect_t aspect) {
    return (aspect != ELMOPP_ASPECT_RED) && (aspect != ELMOPP_ASPECT_RED_AMBER) && (aspect != ELMOPP_ASPECT_AMBER);
}

static bool is_off_red(elmopp_aspect_t aspect) {
    return (aspect == ELMOPP_ASPECT_GREEN) || (aspect == ELMOPP_ASPECT_AMBER) || (aspect == ELMOPP_ASPECT_RED_AMBER);
}

/* Fail-safe flashing may begin out of anything; everything else has its order and times. */
static bool may_follow(elmopp_aspect_t before, elmopp_aspect_t after, bool fail_safe) {
    static const elmopp_aspect_t right[ELMOPP_ASPECT_COUNT] = {[ELMOPP_ASPECT_RED_AMBER] = ELMOPP_ASPECT_RED,
                                                               [ELMOPP_ASPECT_GREEN] = ELMOPP_ASPECT_RED_AMBER,
                                                               [ELMOPP_ASPECT_AMBER] = ELMOPP_ASPECT_GREEN};
    if (is_off_red(after)) {
        return before == right[after];
    }
    if (after == ELMOPP_ASPECT_RED) {
        return (before != ELMOPP_ASPECT_GREEN) && (before != ELMOPP_ASPECT_RED_AMBER);
    }
    return fail_safe || (!is_off_red(before));
}

static long long least_ticks(const elmopp_group_t *site, elmopp_aspect_t aspect) {
    long long ticks = (aspect == ELMOPP_ASPECT_GREEN) ? site->min_green_ds : 0;
    ticks = (aspect == ELMOPP_ASPECT_AMBER) ? site->amber_ds : ticks;
    return (aspect == ELMOPP_ASPECT_RED_AMBER) ? site->red_amber_ds : ticks;
}

static void watch_group(bench_t *self, uint32_t g, elmopp_aspect_t aspect, bool fail_safe) {
    const long long now = self->ticks;
    const elmopp_aspect_t before = self->seen[g].aspect;
    if (aspect != before) {
        if (!may_follow(before, aspect, fail_safe)) {
            complain(self, "wrong order", g, (uint32_t)before);
        }
        if ((!fail_safe) && ((now - self->seen[g].since) < least_ticks(&self->junction.group[g], before))) {
            complain(self, "too short", g, (uint32_t)before);
        }
        self->seen[g].since = now;
    }
    if (is_free(before) && (!is_free(aspect))) {
        self->seen[g].ended = now;
    }
    self->seen[g].aspect = aspect;
}

static void watch_pair(bench_t *self, uint32_t g, uint32_t h) {
    const bool starts =
        (self->seen[g].aspect == ELMOPP_ASPECT_GREEN) && (self->seen[g].since == (long long)self->ticks);
    if (is_off_red(self->seen[g].aspect) && is_off_red(self->seen[h].aspect)) {
        complain(self, "conflict", g, h);
    }
    if (starts && (((long long)self->ticks - self->seen[h].ended) < self->junction.intergreen_ds[h][g])) {
        complain(self, "short intergreen", h, g);
    }
}

static void watch(bench_t *self) {
    const bool fail_safe = self->controller.mode == ELMOPP_MODE_FAIL_SAFE;
    for (uint32_t g = 0U; g < self->junction.group_count; g++) {
        watch_group(self, g, elmopp_lamps_aspect(&self->shown, g), fail_safe);
    }
    for (uint32_t g = 0U; g < self->junction.group_count; g++) {
        for (uint32_t h = 0U; h < self->junction.group_count; h++) {
            if (has(self->junction.conflict[g], h)) {
                watch_pair(self, g, h);
            }
        }
    }
}

/* --- set-up --- */

elmopp_junction_t bench_cross(uint32_t count) {
    elmopp_junction_t junction = test_cross(count);
    junction.start_flash_ds = 20U;
    junction.start_red_ds = 10U;
    junction.red_bound_ds = 1200U;
    return junction;
}

static elmopp_stage_t choose(void *state, const elmopp_view_t *view, float score[ELMOPP_STAGE_MAX]) {
    bench_t *self = state;
    for (uint32_t s = 0U; s < ELMOPP_STAGE_MAX; s++) {
        score[s] = 0.0F;
    }
    self->calls++;
    const uint32_t in_turn = (self->calls / TURN_S) % view->junction->stage_count;
    return (elmopp_stage_t)((self->answer == STAGES_IN_TURN) ? in_turn : self->answer);
}

static void power_up(bench_t *self) {
    const elmopp_controller_config_t config = {.junction = &self->junction,
                                               .chooser = {.choose = choose, .state = self, .horizon_s = 0U},
                                               .forecast = self->forecast};
    elmopp_controller_init(&self->controller, &config);
}

void bench_start(bench_t *self, const elmopp_junction_t *junction) {
    const elmopp_junction_t own = *junction; /* may lie in the bench itself */
    (void)memset(self, 0, sizeof *self);
    self->junction = own;
    self->answer = STAGES_IN_TURN;
    for (uint32_t g = 0U; g < ELMOPP_GROUP_MAX; g++) {
        self->seen[g].aspect = ELMOPP_ASPECT_DARK;
        self->seen[g].since = NEVER;
        self->seen[g].ended = 0;
    }
    power_up(self);
}

void bench_power_cut(bench_t *self) {
    /* The lamp nodes flash by themselves as soon as nobody commands them. */
    for (uint32_t g = 0U; g < ELMOPP_GROUP_MAX; g++) {
        self->seen[g].aspect = ELMOPP_ASPECT_DARK;
        self->seen[g].since = self->ticks;
        self->seen[g].ended = self->ticks;
    }
    self->shown = (elmopp_lamps_t){0U, 0U, 0U, 0U};
    power_up(self);
}

/* --- frames to the controller --- */

static void deliver(bench_t *self, elmopp_frame_t frame) {
    const bench_fate_t fate = (self->fate == NULL) ? BENCH_PASS : self->fate(self->fate_state, &frame);
    if (fate == BENCH_LOSE) {
        return;
    }
    if ((fate == BENCH_DELAY) && (self->late_count < BENCH_FRAMES_MAX)) {
        self->late[self->late_count++] = frame;
        return;
    }
    if (fate == BENCH_CORRUPT) {
        frame.data[2] ^= 0x10U;
    }
    (void)elmopp_controller_take(&self->controller, &frame);
    if (fate == BENCH_REPEAT) {
        (void)elmopp_controller_take(&self->controller, &frame);
    }
}

static void deliver_late(bench_t *self) {
    const uint32_t count = self->late_count;
    self->late_count = 0U;
    for (uint32_t i = 0U; i < count; i++) {
        (void)elmopp_controller_take(&self->controller, &self->late[i]);
    }
}

static elmopp_frame_t counts_of(const bench_t *self, uint32_t approach) {
    elmopp_detector_report_t report[ELMOPP_APPROACH_MOVEMENT_MAX] = {{0U, 0U, false}, {0U, 0U, false}, {0U, 0U, false}};
    const bool blind = has(self->cameras_blind, approach);
    uint32_t slot = 0U;
    for (uint32_t j = 0U; j < self->junction.movement_count; j++) {
        if ((self->junction.movement[j].approach == approach) && (slot < ELMOPP_APPROACH_MOVEMENT_MAX)) {
            report[slot].present_veh = self->present_veh[j];
            report[slot].arrivals = (uint8_t)(self->arrived_veh[j] % ELMOPP_DETECTOR_MODULO);
            report[slot].valid = !blind;
            slot++;
        }
    }
    return elmopp_frames_make_counts(approach, report, blind ? 2U : 0U);
}

static void send_counts(bench_t *self) {
    for (uint32_t i = 0U; i < self->junction.approach_count; i++) {
        if (has(self->junction.cameras, i) && (!has(self->cameras_silent, i))) {
            elmopp_frame_t frame = counts_of(self, i);
            elmopp_link_seal(&frame, &self->camera_counter[i]);
            deliver(self, frame);
        }
    }
}

static void send_outflow(bench_t *self) {
    for (uint32_t i = 0U; i < ELMOPP_APPROACH_MAX; i++) {
        if (has(self->neighbours, i)) {
            elmopp_frame_t frame = elmopp_frames_make_outflow(i, &self->outflow[i]);
            elmopp_link_seal(&frame, &self->neighbour_counter[i]);
            deliver(self, frame);
        }
    }
}

static void send_occupancy(bench_t *self) {
    if (self->junction_seen) {
        elmopp_frame_t frame = elmopp_frames_make_occupancy(&self->occupancy);
        elmopp_link_seal(&frame, &self->occupancy_counter);
        deliver(self, frame);
    }
}

static uint16_t measured(uint16_t commanded, uint16_t stuck_on, uint16_t broken, uint16_t groups) {
    return (uint16_t)(((commanded | stuck_on) & (uint16_t)~broken) & groups);
}

static void send_feedback(bench_t *self) {
    for (uint32_t n = 0U; n < ELMOPP_NODE_MAX; n++) {
        uint32_t driven = 0U;
        for (uint32_t g = 0U; g < self->junction.group_count; g++) {
            driven |= (self->junction.group[g].node == n) ? (1U << g) : 0U;
        }
        const uint16_t groups = (uint16_t)driven;
        if ((groups != 0U) && (!has(self->nodes_silent, n))) {
            const elmopp_feedback_t feedback = {
                .lamps = {.red = measured(self->shown.red, self->stuck_on.red, self->broken.red, groups),
                          .amber = measured(self->shown.amber, self->stuck_on.amber, self->broken.amber, groups),
                          .green = measured(self->shown.green, self->stuck_on.green, self->broken.green, groups)},
                .lamp_fault = self->lamp_fault,
                .own_fail_safe = self->own_fail_safe};
            elmopp_frame_t frame = elmopp_frames_make_feedback(n, &feedback);
            elmopp_link_seal(&frame, &self->node_counter[n]);
            deliver(self, frame);
        }
    }
}

bool bench_command(bench_t *self, elmopp_request_t request, uint32_t argument) {
    const struct elmopp_can_command_t signals = {.request = (uint8_t)request, .argument = argument};
    elmopp_frame_t frame = {.id = ELMOPP_CAN_COMMAND_FRAME_ID};
    (void)elmopp_can_command_pack(frame.data, &signals, sizeof frame.data);
    elmopp_link_seal(&frame, &self->command_counter);
    return elmopp_controller_take(&self->controller, &frame);
}

/* --- frames from the controller --- */

static elmopp_status_t status_in(const elmopp_frame_t *frame) {
    struct elmopp_can_controller_status_t signals;
    TEST_ASSERT_EQUAL_INT(0, elmopp_can_controller_status_unpack(&signals, frame->data, sizeof frame->data));
    return (elmopp_status_t){.mode = (elmopp_mode_t)signals.mode,
                             .stage = signals.stage,
                             .elapsed_ds = signals.elapsed_ds,
                             .fault = (elmopp_fault_t)signals.first_fault,
                             .fault_group = signals.fault_group,
                             .weights_id = signals.weights_id,
                             .refused = signals.refused};
}

static void receive(bench_t *self, const elmopp_frame_t *frame) {
    if (self->heard != NULL) {
        self->heard(frame);
    }
    TEST_ASSERT_EQUAL_UINT8(8U, frame->length);
    TEST_ASSERT_EQUAL_HEX8(elmopp_link_crc(frame->id, frame->data), frame->data[7]);
    if (frame->id == ELMOPP_CAN_LAMP_COMMAND_FRAME_ID) {
        TEST_ASSERT_TRUE(elmopp_frames_lamps(frame, &self->shown));
        self->lamp_frames++;
    } else if (frame->id == ELMOPP_CAN_CONTROLLER_STATUS_FRAME_ID) {
        self->status = status_in(frame);
        self->status_frames++;
    } else {
        TEST_ASSERT_EQUAL_HEX16(ELMOPP_CAN_FORECAST_FRAME_ID, frame->id & 0x7F8U);
        self->forecast_frames++;
    }
}

void bench_tick(bench_t *self) {
    deliver_late(self);
    if ((self->ticks % 10U) == 0U) {
        send_counts(self);
        send_outflow(self);
    }
    if ((self->ticks % 2U) == 0U) {
        send_occupancy(self);
    }
    send_feedback(self);
    elmopp_frame_t out[ELMOPP_FRAMES_PER_TICK];
    self->now_ms += ELMOPP_CONTROLLER_TICK_MS;
    const uint32_t count = elmopp_controller_tick(&self->controller, self->now_ms, out);
    for (uint32_t i = 0U; i < count; i++) {
        receive(self, &out[i]);
    }
    self->ticks++;
    watch(self);
}

void bench_ticks(bench_t *self, uint32_t count) {
    for (uint32_t i = 0U; i < count; i++) {
        bench_tick(self);
    }
}

bool bench_until(bench_t *self, elmopp_mode_t mode, uint32_t limit) {
    for (uint32_t i = 0U; (i < limit) && (self->controller.mode != mode); i++) {
        bench_tick(self);
    }
    return self->controller.mode == mode;
}

void bench_fill(bench_t *self) {
    for (uint32_t j = 0U; j < self->junction.movement_count; j++) {
        self->present_veh[j] = 5U;
    }
}

void bench_expect_good_street(const bench_t *self) {
    if (self->complaint[0] != '\0') {
        TEST_FAIL_MESSAGE(self->complaint);
    }
}
