/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Mode: what the junction is doing as a whole, and how it gets from one to the other.
///
/// One pure function of the mode before and what is known now; no state of its own, no clock, no lamp. It never leads
/// from flashing or dark to a green but through all red, never from a fault anywhere but to Starting, and it reaches
/// whatever is asked for in bounded time (proved: tests/proof). docs/design.md draws it.
///
///   Starting -> start flash -> start red -> first stage -> automatic, fixed time or manual
///   automatic, fixed time, manual, first stage -> all red -> flashing or dark, or the first stage again
///   flashing -> start red;  dark -> Starting;  any fault -> fail-safe, latched -> Starting

#ifndef ELMOPP_MODE_H
#define ELMOPP_MODE_H

#include <stdbool.h>
#include <stdint.h>

/// The numbers are those of ControllerStatus. Zero is safe.
typedef enum {
    ELMOPP_MODE_STARTING = 0,    ///< flashes; self-test
    ELMOPP_MODE_START_FLASH = 1, ///< flashes for the site's time
    ELMOPP_MODE_START_RED = 2,   ///< all red for the site's time
    ELMOPP_MODE_FIRST_STAGE = 3, ///< brings up the site's first stage
    ELMOPP_MODE_AUTOMATIC = 4,   ///< the chooser wishes
    ELMOPP_MODE_FIXED_TIME = 5,  ///< the programme of the hour wishes
    ELMOPP_MODE_MANUAL = 6,      ///< a person wishes
    ELMOPP_MODE_ALL_RED = 7,
    ELMOPP_MODE_FLASHING = 8,   ///< by schedule or by command
    ELMOPP_MODE_DARK = 9,       ///< by command
    ELMOPP_MODE_FAIL_SAFE = 10, ///< flashes; latched
    ELMOPP_MODE_COUNT = 11
} elmopp_mode_t;

/// What the junction ought to do when nothing is wrong.
typedef enum {
    ELMOPP_WISH_RUN = 0, ///< automatic, or fixed time where no camera can be trusted, or flashing when scheduled
    ELMOPP_WISH_FIXED_TIME,
    ELMOPP_WISH_MANUAL,
    ELMOPP_WISH_ALL_RED,
    ELMOPP_WISH_FLASHING,
    ELMOPP_WISH_DARK
} elmopp_wish_t;

/// What is known in this lamp tick.
typedef struct {
    elmopp_wish_t wish;
    bool fault;        ///< latched
    bool cleared;      ///< the latch was just opened, with the local reset held and both commands given
    bool tested;       ///< the self-test has passed
    bool sighted;      ///< at least one camera can be trusted
    bool night;        ///< the schedule says flash
    bool all_red;      ///< the plan shows red everywhere
    bool settled;      ///< the plan shows the stage that it was asked for
    uint16_t age_ds;   ///< of the mode
    uint16_t flash_ds; ///< the site's start_flash_ds
    uint16_t red_ds;   ///< the site's start_red_ds
} elmopp_mode_input_t;

/// The mode of the next lamp tick. Any number may come in as `before`; one that is no mode leads to fail-safe.
elmopp_mode_t elmopp_mode_next(elmopp_mode_t before, const elmopp_mode_input_t *input);

/// True in the modes whose lamps are the plan's.
bool elmopp_mode_is_steady(elmopp_mode_t mode);

#endif
