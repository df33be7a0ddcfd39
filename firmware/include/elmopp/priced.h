/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Priced: ELMOPP's urgency in which a change of stage costs what it takes.
///
/// The paper's rule leaves a stage as soon as another one is more urgent, however little there is to gain and however
/// long nobody moves meanwhile. Here urgency becomes a rate. Of the stage shown, the urgency that leaves in the next
/// window_s seconds, for each second; of another one, the urgency that leaves in the best green it could have, for each
/// second of that green and of the price. The price is the time in which the change lets nobody go: the site's
/// intergreen and start-up less the amber that is still driven. It is paid `changes` times, as who is left behind needs
/// a change back. It is worked out from the site's table, never set.
///
/// A vehicle counts e^(T/t_max - 1) on red (age.h), T the lamps' as in the paper, and 1 on green: who is left behind
/// now waits a red of about t_max.
/// Movements that go in both stages are on neither side.
///
/// Between min_s and max_s it leaves for the stage with the greatest lead above 0; from max_s on for the best other one
/// on which somebody is, whatever the lead. Ties go to the lowest index. The score of a stage is its lead, 0 for the
/// one shown; before the first stage it is the urgency itself.
///
/// It reads no forecast, learns nothing, knows no lamp and has no bound on red of its own (plan.h has). Its work is
/// bounded by stages times the square of the movements. State: parameters and a table of prices that is filled at the
/// first view; the junction is that of the views, always the same. Not thread-safe; one owner.

#ifndef ELMOPP_PRICED_H
#define ELMOPP_PRICED_H

#include "elmopp/chooser.h"

#define ELMOPP_PRICED_WINDOW_S 4.0F       ///< seconds over which the present rate looks
#define ELMOPP_PRICED_CHANGES 2.0F        ///< there and back
#define ELMOPP_PRICED_AMBER_DRIVEN_DS 10U ///< of an amber: the first second is driven like green

typedef struct {
    const elmopp_junction_t *junction; ///< of the first view; null before
    uint16_t min_s;                    ///< a stage is never left before; at least 1
    uint16_t max_s;                    ///< ... and left at if somebody is elsewhere; also t_max of the exponential
    uint32_t serves[ELMOPP_STAGE_MAX]; ///< mask of the movements that go in a stage
    float price_s[ELMOPP_STAGE_MAX][ELMOPP_STAGE_MAX]; ///< [from][to]
} elmopp_priced_t;

/// Prepares the state and returns the chooser that uses it. Asserts 1 <= min_s <= max_s.
elmopp_chooser_t elmopp_priced_init(elmopp_priced_t *self, uint16_t min_s, uint16_t max_s);

#endif
