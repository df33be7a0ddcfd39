/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "grid.h"
#include "pace.h"
#include "port.h"

static elmopp_grid_t grid;

void elmopp_pace_begin(void) {
    elmopp_grid_init(&grid, elmopp_port_now_ms());
}

bool elmopp_pace_take(const elmopp_frame_t *frame) {
    (void)frame;
    return false;
}

elmopp_pace_due_t elmopp_pace_due(elmopp_ms_t *now_ms) {
    *now_ms = elmopp_port_now_ms();
    return elmopp_grid_due(&grid, *now_ms) ? ELMOPP_PACE_TICK : ELMOPP_PACE_NOT_YET;
}

void elmopp_pace_send(const elmopp_controller_t *controller, const elmopp_frame_t *frames, uint32_t count) {
    (void)controller;
    for (uint32_t k = 0U; k < count; k++) {
        (void)elmopp_port_send(&frames[k]);
    }
}

void elmopp_pace_wait(void) {
    elmopp_port_sleep_until(grid.next_ms);
}
