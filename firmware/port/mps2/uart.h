/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// UART: a CMSDK APB UART (Arm DDI 0479D, 4.3) with a ring each way.
///
/// Characters come by interrupt until the ring is full; the interrupt then rests until somebody has read, so that a
/// flood costs no more than what the reader takes. What the device loses meanwhile is counted. What is sent waits in a
/// ring: nothing ever waits for the wire.

#ifndef ELMOPP_UART_H
#define ELMOPP_UART_H

#include <stdbool.h>
#include <stdint.h>

#define ELMOPP_UART_RECEIVE_SIZE 1024U ///< powers of two
#define ELMOPP_UART_SEND_SIZE 8192U    ///< a decision in full is 90 lines of 22

typedef struct {
    void *registers;
    volatile uint32_t received; ///< characters ever put into the ring; wraps, as do all four
    volatile uint32_t read;
    volatile uint32_t sent; ///< ... ever given to the device
    volatile uint32_t written;
    volatile bool rests;          ///< the ring is full, nothing is received
    volatile uint32_t interrupts; ///< those that the device has been asked for
    volatile uint32_t overrun;    ///< times that the device lost characters
    uint8_t receive_ring[ELMOPP_UART_RECEIVE_SIZE];
    uint8_t send_ring[ELMOPP_UART_SEND_SIZE];
} elmopp_uart_t;

/// Starts the device whose registers begin here. Its interrupts are enabled by the caller.
void elmopp_uart_init(elmopp_uart_t *self, void *registers, uint32_t clock_hz, uint32_t baud);

/// The next character. False if there is none.
bool elmopp_uart_read(elmopp_uart_t *self, char *character);

/// True if there is one.
bool elmopp_uart_has(const elmopp_uart_t *self);

/// All or nothing: false if there is no room for all.
bool elmopp_uart_write(elmopp_uart_t *self, const char *text, uint32_t length);

/// The handler of both of the device's interrupts.
void elmopp_uart_interrupt(elmopp_uart_t *self);

#endif
