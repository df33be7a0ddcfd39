/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// A bench for the whole controller: cameras, lamp nodes and a clock around it, each of which can be made to fail.
///
/// A tick: the cameras and the gateway to the neighbours send (every tenth; that of the junction, if there is one,
/// every second), the nodes report the lamps of the last command that they believed, the controller moves, and
/// everything that it shows goes to an observer of its own (street_watch), which knows the site's rules by timestamps
/// and shares no code with plan and monitor.

#ifndef ELMOPP_TEST_BENCH_H
#define ELMOPP_TEST_BENCH_H

#include "elmopp/controller.h"

#define BENCH_FRAMES_MAX 64U

/// What to do with a frame on its way to the controller.
typedef enum { BENCH_PASS, BENCH_LOSE, BENCH_REPEAT, BENCH_DELAY, BENCH_CORRUPT } bench_fate_t;

typedef struct {
    elmopp_junction_t junction;
    elmopp_controller_t controller;
    elmopp_chooser_t chooser;
    elmopp_forecast_config_t forecast; ///< from the next power cut on; none at first
    elmopp_stage_t answer;             ///< of the chooser, every second; 255: stages in turn
    uint32_t calls;                    ///< of the chooser
    elmopp_ms_t now_ms;
    uint32_t ticks;
    elmopp_lamps_t shown;   ///< by the last LampCommand
    elmopp_status_t status; ///< the last
    uint32_t status_frames;
    uint32_t forecast_frames;
    uint32_t lamp_frames;
    /* what can fail */
    uint8_t cameras_silent;  ///< mask
    uint8_t cameras_blind;   ///< mask: frames say that nothing is valid
    uint8_t nodes_silent;    ///< mask
    elmopp_lamps_t stuck_on; ///< these lamps burn whatever is commanded
    elmopp_lamps_t broken;   ///< these never do
    bool lamp_fault;
    bool own_fail_safe;
    bool junction_seen;                            ///< there is a junction camera
    elmopp_occupancy_t occupancy;                  ///< what it sends
    uint8_t neighbours;                            ///< mask of the approaches whose neighbour speaks
    elmopp_outflow_t outflow[ELMOPP_APPROACH_MAX]; ///< what it says
    uint16_t present_veh[ELMOPP_MOVEMENT_MAX];
    uint32_t arrived_veh[ELMOPP_MOVEMENT_MAX];                      ///< running
    bench_fate_t (*fate)(void *state, const elmopp_frame_t *frame); ///< null: every frame passes
    void *fate_state;
    void (*heard)(const elmopp_frame_t *frame); ///< sees every frame of the controller's; null: nobody
    /* its own counters */
    uint8_t camera_counter[ELMOPP_APPROACH_MAX];
    uint8_t node_counter[ELMOPP_NODE_MAX];
    uint8_t occupancy_counter;
    uint8_t neighbour_counter[ELMOPP_APPROACH_MAX];
    uint8_t command_counter;
    elmopp_frame_t late[BENCH_FRAMES_MAX];
    uint32_t late_count;
    /* what the street has seen, by timestamps */
    struct {
        elmopp_aspect_t aspect;
        long long since; ///< tick in which the aspect began
        long long ended; ///< tick in which it was last free to go: green, flashing, dark
    } seen[ELMOPP_GROUP_MAX];
    char complaint[120]; ///< empty as long as no rule of the site was broken on the street
} bench_t;

/// A street with `count` groups in conflict, a camera an approach, a programme, and start times of 2 s and 1 s.
elmopp_junction_t bench_cross(uint32_t count);

void bench_start(bench_t *self, const elmopp_junction_t *junction);
/// The controller loses its power and is started again; everything outside goes on.
void bench_power_cut(bench_t *self);
void bench_tick(bench_t *self);
void bench_ticks(bench_t *self, uint32_t count);
/// Ticks until the mode is there, at most `limit`; false if it does not come.
bool bench_until(bench_t *self, elmopp_mode_t mode, uint32_t limit);
/// Sends a Command; true if the controller obeyed.
bool bench_command(bench_t *self, elmopp_request_t request, uint32_t argument);
/// Everybody is counted as waiting.
void bench_fill(bench_t *self);
/// Fails the test with the complaint of the street, if there is one.
void bench_expect_good_street(const bench_t *self);

#endif
