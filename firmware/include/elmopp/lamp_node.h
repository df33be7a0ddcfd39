/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Lamp node: a device of its own at the end of the bus. Holds the lamps of its groups as the controller commands.
///
/// A LampCommand that link does not believe is ignored and counted. When no good one has come for
/// ELMOPP_LAMP_NODE_TIMEOUT_MS, the node flashes by itself as the site says, and says so in its LampFeedback. It leaves
/// that only after ELMOPP_LAMP_NODE_RETURN_MS of good commands none of which shows green, red-amber or amber to
/// anybody: flashing, dark or all red. It starts in that state.
///
/// It decides nothing else, knows no conflict and no time of day. It reads no clock, does no I/O, allocates nothing.
/// Not thread-safe; one owner, its port.

#ifndef ELMOPP_LAMP_NODE_H
#define ELMOPP_LAMP_NODE_H

#include "elmopp/lamps.h"
#include "elmopp/link.h"

#define ELMOPP_LAMP_NODE_TIMEOUT_MS 300U
#define ELMOPP_LAMP_NODE_RETURN_MS 1000U
#define ELMOPP_LAMP_NODE_FEEDBACK_MS 100U ///< how often LampFeedback is to be sent

/// State. Set up by elmopp_lamp_node_init(); read it, write nothing.
typedef struct {
    const elmopp_junction_t *junction;
    elmopp_link_t link;
    elmopp_lamps_t lamps; ///< that burn now, of the own groups; `flash` go on and off
    uint16_t groups;      ///< the own ones
    uint8_t node;
    uint8_t counter;    ///< of the next LampFeedback
    uint32_t silent_ms; ///< since the last good command; saturates at the time-out
    uint32_t calm_ms;   ///< of good commands without movement; saturates
    uint32_t rest_ms;   ///< of a lamp tick, for the link
    uint32_t refused;   ///< commands that were not believed; saturates
    bool calm;          ///< the last good command was
    bool fail_safe;     ///< flashes by itself
} elmopp_lamp_node_t;

/// Flashes. The junction must have passed elmopp_site_check() and outlive the node. Asserts a node that there can be.
void elmopp_lamp_node_init(elmopp_lamp_node_t *self, const elmopp_junction_t *junction, uint32_t node);

/// Offers one received frame. False if it is no LampCommand or is not believed; the lamps are then unchanged.
bool elmopp_lamp_node_take(elmopp_lamp_node_t *self, const elmopp_frame_t *frame);

/// So many milliseconds have passed. Call it at least every 20 ms: so much later than its time-out it may flash.
void elmopp_lamp_node_pass(elmopp_lamp_node_t *self, uint32_t elapsed_ms);

/// The next LampFeedback: what burns, as measured by the port. `lamp_fault`: a lamp is broken.
elmopp_frame_t elmopp_lamp_node_feedback(elmopp_lamp_node_t *self, const elmopp_lamps_t *measured, bool lamp_fault);

#endif
