/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Fault: what ends in fail-safe flashing, and what a technician reads about it.
///
/// The codes of ControllerStatus (firmware/can/elmopp.dbc holds the same table). The monitor finds the first ones, the
/// controller and its port the rest. It decides nothing.

#ifndef ELMOPP_FAULT_H
#define ELMOPP_FAULT_H

/// No other group than these is named with a fault.
#define ELMOPP_FAULT_NO_GROUP 0U

typedef enum {
    ELMOPP_FAULT_NONE = 0,
    /* found by the monitor */
    ELMOPP_FAULT_CONFLICT = 1,         ///< two conflicting groups are not both red
    ELMOPP_FAULT_SHORT_INTERGREEN = 2, ///< a green begins before a conflicting group's intergreen has run out
    ELMOPP_FAULT_SHORT_AMBER = 3,
    ELMOPP_FAULT_SHORT_RED_AMBER = 4,
    ELMOPP_FAULT_SHORT_GREEN = 5,
    ELMOPP_FAULT_SEQUENCE = 6,          ///< not red, red-amber, green, amber, red
    ELMOPP_FAULT_TWO_COLOURS = 7,       ///< a group shows colours that are no aspect
    ELMOPP_FAULT_DARK = 8,              ///< a group shows nothing
    ELMOPP_FAULT_FLASHING = 9,          ///< a group flashes, or does not, against the mode
    ELMOPP_FAULT_UNKNOWN_GROUP = 10,    ///< a lamp burns for a group that the site does not have
    ELMOPP_FAULT_FEEDBACK_DIFFERS = 11, ///< the lamps show for too long what was not commanded
    ELMOPP_FAULT_FEEDBACK_LOST = 12,
    /* found by the controller */
    ELMOPP_FAULT_LAMP_NODE = 16,         ///< a lamp node reports a broken lamp or flashes by itself
    ELMOPP_FAULT_SELF_TEST = 17,         ///< the lamps did not all read back in time after the start
    ELMOPP_FAULT_SITE_CHANGED = 18,      ///< the site's data are no longer what was checked at the start
    ELMOPP_FAULT_WEIGHTS_CHANGED = 19,   ///< the same of the network's weights
    ELMOPP_FAULT_CLOCK = 20,             ///< a lamp tick came too late, or the clock jumped
    ELMOPP_FAULT_SECOND_CONTROLLER = 21, ///< somebody else commands lamps on this bus
    /* found by the port */
    ELMOPP_FAULT_MEMORY = 24,         ///< the memory test at the start
    ELMOPP_FAULT_PROCESSOR = 25,      ///< a fault handler, an assert or the watchdog ended the last run
    ELMOPP_FAULT_OSCILLATOR = 26,     ///< the board runs without its crystal: no clock that CAN could use
    ELMOPP_FAULT_CAN_CONTROLLER = 27, ///< the CAN controller does not answer, or has been given up
    ELMOPP_FAULT_BROWN_OUT = 28,      ///< the board is not set to stop when its supply is too low
    ELMOPP_FAULT_COUNT = 32
} elmopp_fault_t;

/// What a fault is called, for a status line. Never null, whatever the number.
const char *elmopp_fault_name(elmopp_fault_t fault);

#endif
