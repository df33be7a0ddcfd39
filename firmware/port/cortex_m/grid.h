/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Grid: absolute lamp ticks, so that what a tick takes delays no other. Ticks that were missed are left out.
///
/// Pure; one owner. Milliseconds wrap; look at it at least once in 24 days.

#ifndef ELMOPP_GRID_H
#define ELMOPP_GRID_H

#include "elmopp/controller.h"

typedef struct {
    elmopp_ms_t next_ms; ///< of the next tick
    uint32_t missed;     ///< ticks that were left out so far; wraps
} elmopp_grid_t;

/// The first tick is due at once.
void elmopp_grid_init(elmopp_grid_t *self, elmopp_ms_t now_ms);

/// True if a tick is due; the next one is then the first of the grid that lies ahead.
bool elmopp_grid_due(elmopp_grid_t *self, elmopp_ms_t now_ms);

#endif
