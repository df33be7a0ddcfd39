/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "grid.h"

#define HALF_RANGE_MS 0x80000000U /* what lies further ahead has passed */

void elmopp_grid_init(elmopp_grid_t *self, elmopp_ms_t now_ms) {
    *self = (elmopp_grid_t){.next_ms = now_ms, .missed = 0U};
}

bool elmopp_grid_due(elmopp_grid_t *self, elmopp_ms_t now_ms) {
    const uint32_t late_ms = now_ms - self->next_ms;
    if (late_ms >= HALF_RANGE_MS) {
        return false;
    }
    const uint32_t missed = late_ms / ELMOPP_CONTROLLER_TICK_MS;
    self->missed += missed;
    self->next_ms += (missed + 1U) * ELMOPP_CONTROLLER_TICK_MS;
    return true;
}
