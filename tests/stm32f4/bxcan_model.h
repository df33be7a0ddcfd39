/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// A model of the STM32F405's CAN controller on a bus with others. Written from RM0090
/// chapter 32, not from the driver that it tries.
///
/// Modelled: master reset, sleep and the initialisation handshake (ends with the frame on the wire; left after 11
/// recessive bits), three mailboxes with priority by id, arbitration and abort, one FIFO of three with overrun, filters
/// as lists of 16-bit ids, both error counters, error-passive, bus-off and the 128 times 11 recessive bits. Frames have
/// no stuff bits. Time is bits of the bus and passes only when a test lets it.
///
/// What a program must not do (bit timing outside of the initialisation mode, filters while they work, a mailbox that
/// is not empty) has no effect and is counted in `violations`. Faults can begin and end at a given register access.

#ifndef ELMOPP_TESTS_BXCAN_MODEL_H
#define ELMOPP_TESTS_BXCAN_MODEL_H

#include "elmopp/link.h"
#include "registers.h"

#define BXCAN_MODEL_BITS_OF_MS 500U
#define BXCAN_MODEL_LOG 512U

/// What the hardware, or the bus, does wrong; a mask.
typedef enum {
    BXCAN_FAULT_NONE = 0,
    BXCAN_FAULT_DEAD = 1 << 0,          ///< reads as 0, takes nothing: no such hardware, or no clock
    BXCAN_FAULT_ONES = 1 << 1,          ///< reads as ones, takes nothing
    BXCAN_FAULT_NO_RESET = 1 << 2,      ///< the master reset does not end
    BXCAN_FAULT_NO_INIT = 1 << 3,       ///< the initialisation mode is not acknowledged
    BXCAN_FAULT_NO_LEAVE = 1 << 4,      ///< ... and not left
    BXCAN_FAULT_NO_TIMING = 1 << 5,     ///< the bit timing is forgotten
    BXCAN_FAULT_MAILBOX = 1 << 6,       ///< no mailbox empties, whatever is sent or taken back
    BXCAN_FAULT_RELEASE = 1 << 7,       ///< the FIFO releases nothing
    BXCAN_FAULT_DOMINANT = 1 << 8,      ///< the bus is stuck
    BXCAN_FAULT_ALONE = 1 << 9,         ///< nobody acknowledges
    BXCAN_FAULT_DESTROYED = 1 << 10,    ///< what it sends is destroyed
    BXCAN_FAULT_SPOILT = 1 << 11,       ///< what others send arrives with errors
    BXCAN_FAULT_FALLS_ASLEEP = 1 << 12, ///< leaves normal mode by itself
    BXCAN_FAULT_NO_INTERRUPT = 1 << 13, ///< the interrupt does not come
    BXCAN_FAULT_FLOOD = 1 << 14 ///< somebody sends without a gap, with the highest priority of the ids let through
} bxcan_fault_t;

/// Controller as after power-on, bus idle, no fault.
void bxcan_model_reset(void);

/// One access to the register at this offset.
uint32_t bxcan_model_read(uint32_t offset);
void bxcan_model_write(uint32_t offset, uint32_t value);

void bxcan_model_pass_bits(uint32_t bits);

/// Another node wants to send this.
void bxcan_model_hear(const elmopp_frame_t *frame);

/// What the controller has sent and others have acknowledged, in order: how many, and one of them.
uint32_t bxcan_model_sent(void);
elmopp_frame_t bxcan_model_sent_frame(uint32_t index);

/// Takes the oldest of them out; false if there is none.
bool bxcan_model_take_sent(elmopp_frame_t *frame);

/// True if the interrupt CAN1_RX0 is asked for.
bool bxcan_model_interrupt(void);

/// These faults hold from that access of a register on, and before the other one.
void bxcan_model_break(uint32_t faults, uint32_t from_access, uint32_t until_access);

/// Accesses since bxcan_model_reset().
uint32_t bxcan_model_accesses(void);
uint32_t bxcan_model_violations(void);

uint32_t bxcan_model_transmit_errors(void);

/// Above 255 it is bus-off.
void bxcan_model_set_transmit_errors(uint32_t count);

#endif
