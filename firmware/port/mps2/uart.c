/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "uart.h"

#include "processor.h"

#define STATE_SENDING 1U /* the device's one place for a character to send is taken */
#define STATE_RECEIVED 2U
#define STATE_OVERRUN 8U
#define CONTROL_SEND 1U
#define CONTROL_RECEIVE 2U
#define CONTROL_SEND_INTERRUPT 4U
#define CONTROL_RECEIVE_INTERRUPT 8U
#define CONTROL_ALWAYS (CONTROL_SEND | CONTROL_RECEIVE)
#define INTERRUPT_SEND 1U
#define INTERRUPT_RECEIVE 2U
#define DIVIDER_MIN 16U

typedef struct {
    volatile uint32_t data;
    volatile uint32_t state; /* written: ones clear the overruns */
    volatile uint32_t control;
    volatile uint32_t interrupt; /* written: ones clear */
    volatile uint32_t divider;
} device_t;

static device_t *device_of(const elmopp_uart_t *self) {
    return self->registers;
}

void elmopp_uart_init(elmopp_uart_t *self, void *registers, uint32_t clock_hz, uint32_t baud) {
    self->registers = registers;
    self->received = 0U;
    self->read = 0U;
    self->sent = 0U;
    self->written = 0U;
    self->rests = false;
    self->overrun = 0U;
    self->interrupts = CONTROL_RECEIVE_INTERRUPT;
    device_t *device = device_of(self);
    const uint32_t divider = clock_hz / baud;
    device->divider = (divider < DIVIDER_MIN) ? DIVIDER_MIN : divider;
    device->control = CONTROL_ALWAYS | self->interrupts;
}

/* --- with interrupts off, or in the handler --- */

/* Interrupts only for what is wanted: the device looks at both after every character. */
static void ask_for_interrupts(elmopp_uart_t *self) {
    const uint32_t receive = self->rests ? 0U : CONTROL_RECEIVE_INTERRUPT;
    const uint32_t send = (self->sent != self->written) ? CONTROL_SEND_INTERRUPT : 0U;
    if ((receive | send) != self->interrupts) {
        self->interrupts = receive | send;
        device_of(self)->control = CONTROL_ALWAYS | receive | send;
    }
}

/* The device has room for one character, and so has a call. */
static void pull(elmopp_uart_t *self) {
    device_t *device = device_of(self);
    const uint32_t state = device->state;
    if ((state & STATE_OVERRUN) != 0U) {
        device->state = STATE_OVERRUN;
        self->overrun++;
    }
    if (((state & STATE_RECEIVED) != 0U) && ((self->received - self->read) < ELMOPP_UART_RECEIVE_SIZE)) {
        self->receive_ring[self->received % ELMOPP_UART_RECEIVE_SIZE] = (uint8_t)device->data;
        self->received++;
    }
    self->rests = (self->received - self->read) >= ELMOPP_UART_RECEIVE_SIZE;
}

static void push(elmopp_uart_t *self) {
    device_t *device = device_of(self);
    while ((self->sent != self->written) && ((device->state & STATE_SENDING) == 0U)) {
        device->data = self->send_ring[self->sent % ELMOPP_UART_SEND_SIZE];
        self->sent++;
    }
}

void elmopp_uart_interrupt(elmopp_uart_t *self) {
    device_of(self)->interrupt = INTERRUPT_SEND | INTERRUPT_RECEIVE;
    pull(self);
    push(self);
    ask_for_interrupts(self);
}

/* --- for the main --- */

bool elmopp_uart_has(const elmopp_uart_t *self) {
    return self->received != self->read;
}

bool elmopp_uart_read(elmopp_uart_t *self, char *character) {
    if (!elmopp_uart_has(self)) {
        return false;
    }
    *character = (char)self->receive_ring[self->read % ELMOPP_UART_RECEIVE_SIZE];
    self->read++;
    if (self->rests && ((self->received - self->read) <= (ELMOPP_UART_RECEIVE_SIZE / 2U))) {
        elmopp_interrupts_off();
        self->rests = false;
        ask_for_interrupts(self); /* first: what comes from now on interrupts */
        pull(self);
        elmopp_interrupts_on();
    }
    return true;
}

bool elmopp_uart_write(elmopp_uart_t *self, const char *text, uint32_t length) {
    if ((ELMOPP_UART_SEND_SIZE - (self->written - self->sent)) < length) {
        return false;
    }
    for (uint32_t k = 0U; k < length; k++) {
        self->send_ring[(self->written + k) % ELMOPP_UART_SEND_SIZE] = (uint8_t)text[k];
    }
    self->written += length;
    elmopp_interrupts_off();
    push(self);
    ask_for_interrupts(self);
    elmopp_interrupts_on();
    return true;
}
