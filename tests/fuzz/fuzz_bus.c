/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Any frames at any time, from somebody who can seal them, against the whole controller on its bench.
///
/// First byte: the site. Then one step after the other, the first byte of which says what: a frame as it comes; a frame
/// with the right checksum and the counter that is next; ticks of the bench, with cameras and lamp nodes that answer or
/// are silent; a stuck or broken lamp; a power cut; the reset key. Nothing crashes, no assert breaks, and the bench's
/// own eyes see no conflict, no short interval and no wrong order on the street.

#include "bench.h"
#include "elmopp_can.h"
#include "fuzz_input.h"
#include "sites.h"

#define TICKS_MAX 2000U

static bench_t bench;

/* From these choices on; apart, so that the corpus keeps its other ids. */
#define JUNCTION_CAMERA 250U
#define NEIGHBOUR 244U

static elmopp_junction_t any_site(uint8_t choice) {
    elmopp_junction_t junction = bench_cross(2U + (choice % 3U));
    junction.junction_wait_ds = ((choice % 4U) == 3U) ? (uint16_t)50U : (uint16_t)0U;
    if ((choice >= 128U) && (test_sites[choice % TEST_SITE_COUNT]->simulation_only == 0U)) {
        junction = *test_sites[choice % TEST_SITE_COUNT];
    }
    return junction;
}

static uint16_t any_id(fuzz_input_t *input) {
    static const uint16_t ids[] = {ELMOPP_CAN_COMMAND_FRAME_ID,
                                   0x100U,
                                   0x101U,
                                   0x102U,
                                   0x103U,
                                   0x104U,
                                   0x107U,
                                   0x080U,
                                   0x090U,
                                   0x091U,
                                   0x180U,
                                   0x190U,
                                   0x097U};
    const uint8_t choice = fuzz_byte(input);
    uint16_t id = ids[choice % (sizeof ids / sizeof ids[0])];
    if (choice >= JUNCTION_CAMERA) {
        id = 0x110U;
    } else if (choice >= NEIGHBOUR) {
        id = (uint16_t)(0x1A0U + (choice - NEIGHBOUR));
    } else {
        /* as it is */
    }
    return id;
}

static void fill(fuzz_input_t *input, elmopp_frame_t *frame) {
    for (uint32_t i = 0U; i < ELMOPP_LINK_BYTES; i++) {
        frame->data[i] = fuzz_byte(input);
    }
}

/* The counter that the controller takes next from whoever sends this id. */
static uint8_t *counter_of(uint16_t id) {
    static uint8_t nobodys;
    uint8_t *counter = &nobodys;
    if (id == ELMOPP_CAN_COMMAND_FRAME_ID) {
        counter = &bench.command_counter;
    } else if ((id & 0x7F8U) == 0x100U) {
        counter = &bench.camera_counter[id & 7U];
    } else if ((id & 0x7F8U) == 0x1A0U) {
        counter = &bench.neighbour_counter[id & 7U];
    } else if (id == 0x110U) {
        counter = &bench.occupancy_counter;
    } else if ((id & 0x7F8U) == 0x090U) {
        counter = &bench.node_counter[id & 7U];
    } else {
        /* one of the controller's own, or nobody's */
    }
    return counter;
}

static void offer_raw(fuzz_input_t *input) {
    elmopp_frame_t frame = {.id = fuzz_two_bytes(input), .length = fuzz_byte(input)};
    fill(input, &frame);
    (void)elmopp_controller_take(&bench.controller, &frame);
}

static void offer_sealed(fuzz_input_t *input) {
    elmopp_frame_t frame = {.id = any_id(input)};
    fill(input, &frame);
    elmopp_link_seal(&frame, counter_of(frame.id));
    (void)elmopp_controller_take(&bench.controller, &frame);
}

/* The two commands that matter most are hard to hit. */
static void offer_command(fuzz_input_t *input) {
    const elmopp_request_t request = (elmopp_request_t)(fuzz_byte(input) % 10U);
    const uint32_t argument = fuzz_byte(input);
    (void)bench_command(&bench, request, (argument == 255U) ? (uint32_t)bench.controller.fault : argument);
}

static void break_lamps(fuzz_input_t *input) {
    bench.stuck_on.green = (uint16_t)(1U << (fuzz_byte(input) % 32U));
    bench.broken.red = (uint16_t)(1U << (fuzz_byte(input) % 32U));
    bench.own_fail_safe = (fuzz_byte(input) % 8U) == 1U;
}

/* The clock goes forward by so many milliseconds; the last values of all stand for a power cut. */
static void jump(uint16_t by_ms) {
    if (by_ms < 0xFF00U) {
        bench.now_ms += by_ms;
    } else {
        bench_power_cut(&bench);
    }
}

static void step(fuzz_input_t *input) {
    const uint8_t what = fuzz_byte(input);
    switch (what % 10U) {
    case 0U:
        offer_raw(input);
        break;
    case 1U:
        offer_sealed(input);
        break;
    case 2U:
        offer_command(input);
        break;
    case 3U:
        break_lamps(input);
        break;
    case 4U:
        bench.cameras_silent = fuzz_byte(input);
        bench.cameras_blind = fuzz_byte(input);
        break;
    case 5U:
        bench.nodes_silent = (uint8_t)((fuzz_byte(input) % 4U) & 1U);
        break;
    case 6U:
        elmopp_controller_hold_reset(&bench.controller, (fuzz_byte(input) & 1U) != 0U);
        break;
    case 7U:
        jump(fuzz_two_bytes(input));
        break;
    case 8U:
        bench.present_veh[fuzz_byte(input) % ELMOPP_MOVEMENT_MAX] = fuzz_byte(input) % 64U;
        break;
    default:
        bench_ticks(&bench, 1U + fuzz_byte(input));
        break;
    }
}

void fuzz_try(fuzz_input_t *input) {
    const elmopp_junction_t junction = any_site(fuzz_byte(input));
    bench_start(&bench, &junction);
    while ((input->left > 0U) && (bench.ticks < TICKS_MAX)) {
        step(input);
    }
    bench_expect_good_street(&bench);
}
