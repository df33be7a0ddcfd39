/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The port to Arm's board MPS2 with a Cortex-M4 (AN386), as QEMU emulates it (mps2-an386). CAN is SLCAN on UART 0.
///
/// UART 1 is for people: it says lines, and stands for the key switch: the character h holds the local reset, l lets it
/// go. Images may be stored in the upper part of the first memory (QEMU: -device loader,file=FILE,addr=ADDRESS,
/// force-raw=on with the addresses of mps2.ld).

#include "board.h"
#include "port.h"
#include "processor.h"
#include "slcan.h"
#include "systick.h"
#include "uart.h"

#include <stddef.h>

#define CLOCK_HZ 25000000U
#define BAUD                                                                                                           \
    1000000U /* 45,000 characters a second would do for what a bus of 500 kbit/s carries; QEMU does not care           \
              */
#define BUS_UART ((void *)0x40004000U)
#define PEOPLE_UART ((void *)0x40005000U)
#define INTERRUPTS 32U
#define CHARACTERS_MAX 512U /* of one call */

/* As large as the STM32F405's, so that the same happens. */
#define SECTORS 2U
#define SECTOR_BYTES 0x20000U
#define SECTOR_SLOTS 3U
#define SLOT_BYTES 0xA000U
#define ONES 0xFFFFFFFFU
#define SAVE_MIN_S 600U /* memory does not wear out; as long as it takes to say that something was learnt */

/* The first time that the watchdog runs out it is a non-maskable interrupt, which ends the run as a fault does; the
   second time it resets (Arm DDI 0479D, 4.5). Lamp nodes flash long before. */
#define WATCHDOG_LOAD (*(volatile uint32_t *)0x40008000U)
#define WATCHDOG_CONTROL (*(volatile uint32_t *)0x40008008U)
#define WATCHDOG_CLEAR (*(volatile uint32_t *)0x4000800CU)
#define WATCHDOG_ON 3U
#define WATCHDOG_S 4U

typedef void (*handler_t)(void);

extern const uint8_t elmopp_site_slot[]; /* from the linker script */
extern const uint8_t elmopp_site_slot_end[];
extern const uint8_t elmopp_weights_slot[];
extern const uint8_t elmopp_weights_slot_end[];
extern uint32_t elmopp_weights_store[];
extern uint32_t elmopp_site_store[];

static elmopp_uart_t bus_uart;
static elmopp_uart_t people_uart;
static elmopp_slcan_t adaptor;
static uint32_t told_dropped;
static bool reset_held;
static elmopp_learning_t learning;

/* --- interrupts --- */

static void bus_handler(void) {
    elmopp_uart_interrupt(&bus_uart);
}

static void people_handler(void) {
    elmopp_uart_interrupt(&people_uart);
}

#define NOBODY elmopp_unexpected_handler

__attribute__((section(".vectors.device"), used)) static const handler_t device_vectors[INTERRUPTS] = {
    bus_handler, bus_handler, people_handler, people_handler, NOBODY, NOBODY, NOBODY, NOBODY, NOBODY, NOBODY, NOBODY,
    NOBODY,      NOBODY,      NOBODY,         NOBODY,         NOBODY, NOBODY, NOBODY, NOBODY, NOBODY, NOBODY, NOBODY,
    NOBODY,      NOBODY,      NOBODY,         NOBODY,         NOBODY, NOBODY, NOBODY, NOBODY, NOBODY, NOBODY};

/* --- the port --- */

void elmopp_port_init(void) {
    elmopp_slcan_init(&adaptor);
    elmopp_uart_init(&bus_uart, BUS_UART, CLOCK_HZ, BAUD);
    elmopp_uart_init(&people_uart, PEOPLE_UART, CLOCK_HZ, BAUD);
    for (uint32_t number = 0U; number < 4U; number++) {
        elmopp_enable_interrupt(number);
    }
    elmopp_systick_start(CLOCK_HZ);
    WATCHDOG_LOAD = WATCHDOG_S * CLOCK_HZ;
    WATCHDOG_CONTROL = WATCHDOG_ON;
    elmopp_interrupts_on();
    elmopp_port_say("elmopp-mps2 starts");
}

elmopp_ms_t elmopp_port_now_ms(void) {
    return elmopp_systick_ms();
}

static uint32_t lost_so_far(void) {
    return adaptor.dropped + bus_uart.overrun;
}

uint32_t elmopp_port_dropped(void) {
    const uint32_t now = lost_so_far();
    const uint32_t since = now - told_dropped;
    told_dropped = now;
    if (since > 0U) {
        elmopp_slcan_flag(&adaptor, (uint8_t)ELMOPP_SLCAN_OVERRUN);
    }
    return since;
}

bool elmopp_port_receive(elmopp_frame_t *frame) {
    elmopp_slcan_event_t event;
    char character = '\0';
    for (uint32_t k = 0U; (k < CHARACTERS_MAX) && elmopp_uart_read(&bus_uart, &character); k++) {
        elmopp_slcan_take(&adaptor, character, &event);
        if ((event.answer_length > 0U) && (!elmopp_uart_write(&bus_uart, event.answer, event.answer_length))) {
            elmopp_slcan_flag(&adaptor, (uint8_t)ELMOPP_SLCAN_SEND_FULL);
        }
        if (event.has_frame) {
            *frame = event.frame;
            return true;
        }
    }
    return false;
}

bool elmopp_port_send(const elmopp_frame_t *frame) {
    char text[ELMOPP_SLCAN_TEXT_MAX];
    const uint32_t length = elmopp_slcan_say(&adaptor, frame, elmopp_systick_ms(), text);
    const bool sent = (length > 0U) && elmopp_uart_write(&bus_uart, text, length);
    if ((length > 0U) && (!sent)) {
        elmopp_slcan_flag(&adaptor, (uint8_t)ELMOPP_SLCAN_SEND_FULL);
    }
    return sent;
}

/* Interrupts are off between the look and the wait, so that none is slept over: a pending one ends the wait. */
void elmopp_port_sleep_until(elmopp_ms_t until_ms) {
    elmopp_interrupts_off();
    if ((!elmopp_uart_has(&bus_uart)) && ((until_ms - elmopp_systick_ms() - 1U) < INT32_MAX)) {
        elmopp_wait_for_interrupt();
    }
    elmopp_interrupts_on();
}

void elmopp_port_kick_watchdog(void) {
    WATCHDOG_CLEAR = 1U;
}

bool elmopp_port_reset_is_held(void) {
    char character = '\0';
    while (elmopp_uart_read(&people_uart, &character)) {
        reset_held = (character == 'h') || (reset_held && (character != 'l'));
    }
    return reset_held;
}

elmopp_fault_t elmopp_port_fault(void) {
    return ELMOPP_FAULT_NONE;
}

elmopp_port_slot_t elmopp_port_site_slot(void) {
    return (elmopp_port_slot_t){elmopp_site_slot, (uint32_t)(elmopp_site_slot_end - elmopp_site_slot)};
}

elmopp_port_slot_t elmopp_port_weights_slot(void) {
    return (elmopp_port_slot_t){elmopp_weights_slot, (uint32_t)(elmopp_weights_slot_end - elmopp_weights_slot)};
}

static uint32_t *store_of(elmopp_transfer_kind_t kind) {
    return (kind == ELMOPP_TRANSFER_SITE) ? elmopp_site_store : elmopp_weights_store;
}

elmopp_store_medium_t elmopp_port_medium(elmopp_transfer_kind_t kind) {
    return (elmopp_store_medium_t){.bytes = (const uint8_t *)store_of(kind),
                                   .sectors = SECTORS,
                                   .sector_bytes = SECTOR_BYTES,
                                   .sector_slots = SECTOR_SLOTS,
                                   .slot_bytes = SLOT_BYTES,
                                   .erases_any_time = false};
}

/* Memory that behaves as flash: programming clears bits and sets none. */
elmopp_store_answer_t elmopp_port_store(elmopp_transfer_kind_t kind, const elmopp_store_order_t *order) {
    volatile uint32_t *word = &store_of(kind)[order->at / sizeof(uint32_t)];
    if (order->action == ELMOPP_STORE_ERASE) {
        for (uint32_t k = 0U; k < (SECTOR_BYTES / sizeof(uint32_t)); k++) {
            word[k] = ONES;
        }
    } else {
        *word &= order->word;
    }
    return ELMOPP_STORE_DONE;
}

uint32_t elmopp_port_save_min_s(void) {
    return SAVE_MIN_S;
}

elmopp_learning_t *elmopp_port_learning(void) {
    return &learning;
}

void elmopp_port_say(const char *text) {
    uint32_t length = 0U;
    while (text[length] != '\0') {
        length++;
    }
    (void)elmopp_uart_write(&people_uart, text, length);
    (void)elmopp_uart_write(&people_uart, "\r\n", 2U);
}

/* The board drives nothing by itself: whoever hears no command flashes. */
void elmopp_port_fail(const char *what) {
    elmopp_port_say("stopped, begins anew:");
    elmopp_port_say(what);
    elmopp_processor_reset();
}
