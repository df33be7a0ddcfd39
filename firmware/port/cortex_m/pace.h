/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Pace: who says when a lamp tick is due. Chosen by linking, so that an image for a street cannot be told the time.
///
///   cortex_m/own_pace.c   the board's clock, a grid of 100 ms that does not drift: every street
///   mps2/sim_pace.c       the same, until a simulator's SimTime comes: from then on one SimTime is one lamp tick
///
/// Owner: the main. One pace a program; it keeps its state to itself.

#ifndef ELMOPP_PACE_H
#define ELMOPP_PACE_H

#include "elmopp/controller.h"

typedef enum {
    ELMOPP_PACE_NOT_YET = 0,
    ELMOPP_PACE_TICK, ///< a lamp tick is due, at the time that is told
    ELMOPP_PACE_ANEW  ///< begin anew, as after the power has come: never on a street
} elmopp_pace_due_t;

/// The grid begins now.
void elmopp_pace_begin(void);

/// Offers a received frame. True if it was the pace's own: look what is due before the next frame.
bool elmopp_pace_take(const elmopp_frame_t *frame);

/// What is due. Call it until it says no.
elmopp_pace_due_t elmopp_pace_due(elmopp_ms_t *now_ms);

/// Sends the frames of a tick.
void elmopp_pace_send(const elmopp_controller_t *controller, const elmopp_frame_t *frames, uint32_t count);

/// Waits until something may be due or has come.
void elmopp_pace_wait(void);

#endif
