/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// bxCAN: the CAN controller of the STM32F405, from its start to its return from bus-off.
///
/// One automaton. No call waits: each looks at the hardware once, does what can be done, and remembers since when it
/// has been waiting. Whatever the hardware does, or does not, elmopp_bxcan_step() touches a bounded number of registers
/// and every state but RUNNING, HELD and FAILED is left within its limit:
///
///   RESETTING -> ENTERING -> JOINING -> RUNNING        HELD instead of JOINING where nobody may join
///   RUNNING -> (bus-off) PAUSING -> LEAVING -> RETURNING -> RUNNING
///   any wait that takes too long -> PAUSING -> RESETTING, and after ELMOPP_BXCAN_TRIES of either in a row: FAILED
///
/// Bus-off is left by software (CAN_MCR.ABOM stays 0): after a pause, with nothing left to send, it enters and leaves
/// the initialisation mode, and the hardware counts its 128 times 11 recessive bits. The first pause is
/// ELMOPP_BXCAN_PAUSE_MS, so that one bus-off costs one lamp command, or two, and no lamp node flashes, which takes 300
/// ms; each further one in a row is twice as long, up to ELMOPP_BXCAN_PAUSE_MAX_MS. Whoever has run for
/// ELMOPP_BXCAN_STEADY_MS begins to count his tries anew. FAILED is silent, on a bus that works for others, and ends by
/// elmopp_bxcan_start() alone.
///
/// It decides nothing about what a frame means. Milliseconds come from the caller and wrap. The interrupt calls
/// elmopp_bxcan_interrupt(), the main loop everything else. Source: RM0090 sections 32.4 (modes), 32.7.6 (errors).

#ifndef ELMOPP_STM32F4_BXCAN_H
#define ELMOPP_STM32F4_BXCAN_H

#include "bxcan_fifo.h"
#include "bxcan_mailbox.h"

#define ELMOPP_BXCAN_ANSWER_MS 10U ///< for a reset, and to enter the initialisation mode: a frame lasts 0.3 ms
#define ELMOPP_BXCAN_JOIN_MS 100U  ///< to see 11 recessive bits, and 128 times 11: 35 ms on a bus that is full
#define ELMOPP_BXCAN_PAUSE_MS 30U  ///< before another try
#define ELMOPP_BXCAN_PAUSE_MAX_MS 500U
#define ELMOPP_BXCAN_TRIES 10U ///< in a row
#define ELMOPP_BXCAN_STEADY_MS 10000U

typedef enum {
    ELMOPP_BXCAN_OFF = 0,   ///< not started
    ELMOPP_BXCAN_RESETTING, ///< the master reset
    ELMOPP_BXCAN_ENTERING,  ///< the initialisation mode
    ELMOPP_BXCAN_JOINING,   ///< the bus: 11 recessive bits
    ELMOPP_BXCAN_HELD,      ///< in the initialisation mode, answers, and does not join
    ELMOPP_BXCAN_RUNNING,   ///< sends and receives
    ELMOPP_BXCAN_PAUSING,   ///< after a failure, or after bus-off
    ELMOPP_BXCAN_LEAVING,   ///< bus-off: back into the initialisation mode
    ELMOPP_BXCAN_RETURNING, ///< ... and out of it: 128 times 11 recessive bits
    ELMOPP_BXCAN_FAILED     ///< given up
} elmopp_bxcan_state_t;

/// What went wrong last.
typedef enum {
    ELMOPP_BXCAN_WELL = 0,
    ELMOPP_BXCAN_NO_RESET,   ///< the reset did not end
    ELMOPP_BXCAN_NO_INIT,    ///< the initialisation mode was not acknowledged: no such hardware, or no clock
    ELMOPP_BXCAN_NO_TIMING,  ///< the bit timing does not read back
    ELMOPP_BXCAN_NO_JOIN,    ///< no 11 recessive bits: somebody holds the bus, or RXD is stuck low
    ELMOPP_BXCAN_BUS_OFF,    ///< too many of its frames were destroyed
    ELMOPP_BXCAN_NO_RETURN,  ///< no 128 times 11 recessive bits
    ELMOPP_BXCAN_NO_MAILBOX, ///< a mailbox did not empty when it was to be taken back
    ELMOPP_BXCAN_NO_RELEASE, ///< the FIFO did not release a frame
    ELMOPP_BXCAN_LEFT,       ///< it was no longer in normal mode, and nobody had asked for that
    ELMOPP_BXCAN_TROUBLES
} elmopp_bxcan_trouble_t;

typedef struct {
    uint32_t bit_timing; ///< the word for CAN_BTR
    const uint16_t *ids; ///< to let through
    uint32_t id_count;
    bool may_join; ///< false: the clock is not good enough for the bus; the hardware is tried out and held
} elmopp_bxcan_config_t;

/// State. Set up by elmopp_bxcan_init(); read it, write nothing.
typedef struct {
    elmopp_bxcan_registers_t *registers;
    elmopp_bxcan_config_t config;
    elmopp_bxcan_fifo_t fifo;
    elmopp_bxcan_mailboxes_t mailboxes;
    elmopp_bxcan_state_t state;
    elmopp_bxcan_trouble_t trouble;        ///< the last one
    bool off_bus;                          ///< PAUSING is for bus-off
    bool passive;                          ///< error-passive
    uint32_t since_ms;                     ///< of the state
    uint32_t tries;                        ///< failures in a row
    uint32_t count[ELMOPP_BXCAN_TROUBLES]; ///< of each trouble; wraps
    uint32_t returned;                     ///< from bus-off; wraps
    uint32_t passives;                     ///< times it became error-passive; wraps
} elmopp_bxcan_t;

/// OFF. The ids must outlive it. Touches no register.
void elmopp_bxcan_init(elmopp_bxcan_t *self, elmopp_bxcan_registers_t *registers, const elmopp_bxcan_config_t *config);

/// Begins, or begins anew after FAILED, with all tries to come.
void elmopp_bxcan_start(elmopp_bxcan_t *self, uint32_t now_ms);

/// To be called often: each call moves a frame or two.
void elmopp_bxcan_step(elmopp_bxcan_t *self, uint32_t now_ms);

/// Takes a frame to send. False, and counted, if it is not running or has no room.
bool elmopp_bxcan_send(elmopp_bxcan_t *self, const elmopp_frame_t *frame, uint32_t now_ms);

/// The next received frame, or false.
bool elmopp_bxcan_receive(elmopp_bxcan_t *self, elmopp_frame_t *frame);

/// The interrupt CAN1_RX0.
void elmopp_bxcan_interrupt(elmopp_bxcan_t *self);

/// Frames lost in the hardware: times that it had no room. Wraps.
uint32_t elmopp_bxcan_overruns(const elmopp_bxcan_t *self);

/// What a trouble is called, for a status line. Never null.
const char *elmopp_bxcan_trouble_name(elmopp_bxcan_trouble_t trouble);

#endif
