/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The driver of the CAN controller at its model, with a clock: what a main loop and an interrupt would do.
///
/// It also holds every call to its bound: none may touch more than BXCAN_BENCH_ACCESSES registers, whatever the
/// hardware does, and each state is left in time.

#ifndef ELMOPP_TESTS_BXCAN_BENCH_H
#define ELMOPP_TESTS_BXCAN_BENCH_H

#include "bxcan.h"
#include "bxcan_model.h"

#define BXCAN_BENCH_ACCESSES 64U

extern elmopp_bxcan_t bench_can;
extern uint32_t bench_now_ms;

/// Where the driver finds the model.
elmopp_bxcan_registers_t *bench_registers(void);

/// A model after power-on, a driver that has been told to start.
void bench_start(bool may_join);

/// So many milliseconds: the bus goes on, interrupts come, the main loop steps once a millisecond.
void bench_pass_ms(uint32_t duration_ms);

/// The same without interrupts or steps: the processor is busy elsewhere.
void bench_sleep_ms(uint32_t duration_ms);

/// Until it is in this state, at most so long; fails the test otherwise.
void bench_reach(elmopp_bxcan_state_t state, uint32_t within_ms);

/// A frame with its id's low byte and a number in it.
elmopp_frame_t bench_frame(uint32_t id, uint8_t number);

/// Gives the driver a frame; what it answers.
bool bench_send(uint32_t id, uint8_t number);

/// Takes everything that has been received; returns how many.
uint32_t bench_drain(void);

#endif
