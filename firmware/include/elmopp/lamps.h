/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Lamps: what a signal group can show, in the codes of the bus, and which lamps burn for it.
///
/// Types and translations. It judges nothing: which aspects may be shown together is the monitor's to say, which
/// are shown is the plan's. Neither of the two calls anything here.

#ifndef ELMOPP_LAMPS_H
#define ELMOPP_LAMPS_H

#include "elmopp/junction.h"

#include <stdint.h>

/// What a signal group shows. The numbers are those of LampCommand (firmware/can/elmopp.dbc); zero is safe.
typedef enum {
    ELMOPP_ASPECT_DARK = 0,
    ELMOPP_ASPECT_RED = 1, ///< don't walk
    ELMOPP_ASPECT_RED_AMBER = 2,
    ELMOPP_ASPECT_GREEN = 3, ///< walk
    ELMOPP_ASPECT_AMBER = 4,
    ELMOPP_ASPECT_FLASH_AMBER = 5,
    ELMOPP_ASPECT_FLASH_RED = 6,
    ELMOPP_ASPECT_COUNT = 7
} elmopp_aspect_t;

/// Masks of the signal groups whose lamps burn. Red and amber of one group together are red-amber.
typedef struct {
    uint16_t red;
    uint16_t amber;
    uint16_t green;
    uint16_t flash; ///< the group's lamps go on and off
} elmopp_lamps_t;

/// The lamps of group g as one number, in the bits of LampFeedback: red 1, amber 2, green 4; and going on and off 8.
uint32_t elmopp_lamps_bits(const elmopp_lamps_t *lamps, uint32_t g);

/// Lets exactly these lamps of group g burn.
void elmopp_lamps_light(elmopp_lamps_t *lamps, uint32_t g, uint32_t bits);

/// The aspect that group g shows; ELMOPP_ASPECT_COUNT if its lamps make none.
elmopp_aspect_t elmopp_lamps_aspect(const elmopp_lamps_t *lamps, uint32_t g);

/// Lets group g show an aspect. An aspect that does not exist is shown as dark.
void elmopp_lamps_show(elmopp_lamps_t *lamps, uint32_t g, elmopp_aspect_t aspect);

/// These groups flash, or are dark, as the site says; all others are dark. Data that have changed in memory, found soon
/// but not before they are read here, flash amber.
elmopp_lamps_t elmopp_lamps_flashing(const elmopp_junction_t *junction, uint16_t groups);

#endif
