/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Outflow: what a neighbouring junction has sent to an approach, as seconds of a forecast's row.
///
/// A neighbour, or the gateway that speaks for it, says how many vehicles that have left it will come to the edge of
/// the counted reach in the next 10, 30 and 60 seconds, and for how long nobody can come whom it does not know of: the
/// time that the road takes. As far as that, what it says is better than any forecast; beyond it, it says nothing.
///
/// It decides nothing, believes everything (whether a frame may be believed is the link's to say) and knows no road.
/// What comes of it are rows that a chooser may read: it moves no lamp and no bound. Pure; no state.

#ifndef ELMOPP_OUTFLOW_H
#define ELMOPP_OUTFLOW_H

#include "elmopp/bounds.h"

#include <stdbool.h>
#include <stdint.h>

/// Of one approach. All zero: nobody says anything.
typedef struct {
    float next10_veh; ///< vehicles in the first 10 seconds after it was said
    float next30_veh; ///< ... in the first 30, those among them
    float next60_veh;
    uint16_t ahead_s; ///< so many seconds after it was said nobody else can come; 0: nobody says anything
    uint16_t age_s;   ///< since it was said
} elmopp_outflow_t;

/// True if it says something about the seconds to come.
bool elmopp_outflow_is_known(const elmopp_outflow_t *self);

/// Writes it over the beginning of a row of `steps` seconds, as far as nobody else can come: the vehicles of each span
/// (up to 10, 30 and 60 s) evenly over its seconds. A span that holds fewer than the one before it is empty.
void elmopp_outflow_lay(const elmopp_outflow_t *self, float *row_veh, uint32_t steps);

#endif
