/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Port: what a board without an operating system gives to the one main of all of them (cortex_m/board_main.c).
///
/// Chosen by linking: a board is a folder beside this file that defines these functions, all of them; none is weak, so
/// that a missing one is a link error. A port carries frames and time. It decides nothing about lamps.
///
/// All are called by the main, one at a time, never by an interrupt; elmopp_port_fail() alone may come from anywhere.
/// Interrupts are the port's own matter. Nothing allocates, nothing waits but elmopp_port_sleep_until().

#ifndef ELMOPP_PORT_H
#define ELMOPP_PORT_H

#include "elmopp/controller.h"
#include "elmopp/learner.h"
#include "elmopp/store.h"
#include "elmopp/transfer.h"

/// A place of the board's memory where somebody may have stored an image (image.h) that replaces what is compiled in.
typedef struct {
    const uint8_t *bytes; ///< null: the board has no such place
    uint32_t size;        ///< an image is at most so long
} elmopp_port_slot_t;

/// Once, with the C environment made: clocks, wire, timer, watchdog, interrupts.
void elmopp_port_init(void);

/// Milliseconds since the start; wraps. Only goes forward.
elmopp_ms_t elmopp_port_now_ms(void);

/// The next frame that has come, without waiting. False if there is none. The work of one call is bounded, whatever
/// comes over the wire: what is no frame may end a call with false before everything has been looked at.
bool elmopp_port_receive(elmopp_frame_t *frame);

/// How much that was no frame has come since the last call, or was lost for want of room: lines or frames.
uint32_t elmopp_port_dropped(void);

/// Sends without waiting. False if there is no room or no bus: a late lamp command is worthless, it is not kept.
bool elmopp_port_send(const elmopp_frame_t *frame);

/// Waits, saving power. Returns at this time, when something has come, or sooner.
void elmopp_port_sleep_until(elmopp_ms_t until_ms);

/// A lamp tick is complete, or one that somebody else's clock decides is waited for. A board that is not told so for
/// its watchdog's time starts anew.
void elmopp_port_kick_watchdog(void);

/// The local reset input, a key switch: held or not.
bool elmopp_port_reset_is_held(void);

/// What is wrong with the board now, asked in every tick: ELMOPP_FAULT_OSCILLATOR, ELMOPP_FAULT_CAN_CONTROLLER,
/// ELMOPP_FAULT_BROWN_OUT, or ELMOPP_FAULT_NONE. No command clears what is still there.
elmopp_fault_t elmopp_port_fault(void);

/// Where a person with a debugger may have stored images: what stands there is in force, whatever has come over the
/// bus.
elmopp_port_slot_t elmopp_port_site_slot(void);
elmopp_port_slot_t elmopp_port_weights_slot(void);

/// Where what comes over the bus is kept (store.h), weights or a site. A medium without bytes: the board keeps nothing.
elmopp_store_medium_t elmopp_port_medium(elmopp_transfer_kind_t kind);

/// Carries out one order to such a medium, without waiting for longer than a word takes; an erase, which takes longer,
/// only comes before the first lamp tick.
elmopp_store_answer_t elmopp_port_store(elmopp_transfer_kind_t kind, const elmopp_store_order_t *order);

/// The least time between two stores of what was learnt, and before the first, by what the medium endures. Seconds.
uint32_t elmopp_port_save_min_s(void);

/// Room for learning on with a network of one level, 46 kB that nobody else uses; null: the board has none, and a site
/// that asks for it runs with the weights as they are.
elmopp_learning_t *elmopp_port_learning(void);

/// A line for people, if the board has somewhere to say it: at most what fits at once, the rest is lost.
void elmopp_port_say(const char *text);

/// A fault handler or a broken promise ends here: `what` for people, if they can be told. Lets go of everything that
/// the board drives by itself and starts anew. The lamp nodes flash meanwhile; the next start finds the note (note.h)
/// and tells it as ELMOPP_FAULT_PROCESSOR.
_Noreturn void elmopp_port_fail(const char *what);

#endif
