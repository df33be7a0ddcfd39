/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Board: the main of every board without an operating system.
///
/// Tests the program's checksum, takes the stored site and weights if they are good and what is compiled in otherwise,
/// and then carries frames and time to the station (station.h) for ever. It decides nothing about lamps.
///
/// What it finds at the start is told in ControllerStatus and ends in flashing: broken memory or a changed program
/// (ELMOPP_FAULT_MEMORY, told again in every tick: no command clears it), a run that ended by a fault handler or a
/// broken promise (ELMOPP_FAULT_PROCESSOR), a stored site or stored weights that are not what a tool once wrote or do
/// not fit (ELMOPP_FAULT_SITE_CHANGED, ELMOPP_FAULT_WEIGHTS_CHANGED). The last good ones, those compiled in, then stay.
/// A slot that begins with a word of zeros or of ones is empty.
///
/// In force is what a person has stored by hand; otherwise what came over the bus and was kept (keeper.h); otherwise
/// what is compiled in. What is kept is tidied up before the first lamp tick, when an erase may hold everything up, and
/// written ELMOPP_BOARD_ORDERS_MAX words a tick, but for the tick of a decision: 1 ms of flash mostly, 6.4 at most.
/// A site that learns on (learner.h) goes on with what was learnt and kept before, in the memory that the port has for
/// it; without such memory one line says so, and the site runs with the weights as they are. If what was kept last has
/// been damaged where it lay, that is one more trouble of the start: ELMOPP_FAULT_SITE_CHANGED or
/// ELMOPP_FAULT_WEIGHTS_CHANGED.
///
/// Between two looks at the clock it takes ELMOPP_BOARD_FRAMES_MAX frames at most, 1.4 ms of SLCAN text on the emulated
/// board: a flood does not keep lamps waiting.

#ifndef ELMOPP_BOARD_H
#define ELMOPP_BOARD_H

#include "elmopp/junction.h"

#include <stdbool.h>

#define ELMOPP_BOARD_FRAMES_MAX 16U
#define ELMOPP_BOARD_ORDERS_MAX 64U

/// The site that is compiled in. Defined by the image's site (CMake option ELMOPP_BOARD_SITE).
extern const elmopp_junction_t *const elmopp_board_site;

/// Never returns. `memory_is_good`: what the memory test at the start has said.
_Noreturn void elmopp_board_run(bool memory_is_good);

/// Handler of device interrupts that nobody uses.
void elmopp_unexpected_handler(void);

#endif
