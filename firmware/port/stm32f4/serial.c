/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "serial.h"

#include <stdbool.h>
#include <stddef.h>

#define BAUD 115200U

void elmopp_serial_start(elmopp_serial_t *self, elmopp_usart_registers_t *registers, uint32_t clock_hz) {
    self->registers = registers;
    self->put = 0U;
    self->out = 0U;
    elmopp_register_write(&registers->brr, (clock_hz + (BAUD / 2U)) / BAUD); /* sixteen samples a bit, 30.3.4 */
    elmopp_register_write(&registers->cr1, ELMOPP_USART_CR1_UE | ELMOPP_USART_CR1_TE);
}

static void put(elmopp_serial_t *self, char character) {
    if ((self->put - self->out) < ELMOPP_SERIAL_RING) {
        self->ring[self->put % ELMOPP_SERIAL_RING] = character;
        self->put++;
    }
}

void elmopp_serial_say(elmopp_serial_t *self, const char *text) {
    for (uint32_t k = 0U; (k < ELMOPP_SERIAL_RING) && (text[k] != '\0'); k++) {
        put(self, text[k]);
    }
    put(self, '\r');
    put(self, '\n');
}

/* False if there is nothing to say, or no room. */
static bool give_one(elmopp_serial_t *self) {
    const bool more = self->out != self->put;
    const bool room = more && ((elmopp_register_read(&self->registers->sr) & ELMOPP_USART_SR_TXE) != 0U);
    if (room) {
        elmopp_register_write(&self->registers->dr, (uint8_t)self->ring[self->out % ELMOPP_SERIAL_RING]);
        self->out++;
    }
    return room;
}

void elmopp_serial_look(elmopp_serial_t *self) {
    bool goes_on = true;
    for (uint32_t k = 0U; (k < ELMOPP_SERIAL_BURST) && goes_on; k++) {
        goes_on = give_one(self);
    }
}

void elmopp_serial_flush(elmopp_serial_t *self) {
    bool goes_on = self->registers != NULL; /* it may end before it has begun */
    for (uint32_t k = 0U; (k < ELMOPP_SERIAL_RING) && goes_on; k++) {
        goes_on = false;
        for (uint32_t looks = 0U; (looks < ELMOPP_SERIAL_LOOKS) && (!goes_on) && (self->out != self->put); looks++) {
            goes_on = give_one(self);
        }
    }
}
