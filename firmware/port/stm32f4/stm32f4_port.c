/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The port to a board with an STM32F405RG: CAN1 with a transceiver, a key switch, a serial line for people.
///
/// It drives no lamp: fail-safe of this board is silence on the bus, or a LampCommand that says flash; lamp nodes flash
/// by themselves after 300 ms of silence. Without its crystal it stays on the internal oscillator, tries its CAN
/// controller out and does not join the bus (bit_timing.h says why).
///
/// Turning the key is also how a CAN controller that has given up is started anew.

#include "bit_timing.h"
#include "board.h"
#include "bxcan.h"
#include "clocks.h"
#include "debounce.h"
#include "elmopp_can.h"
#include "flash_writer.h"
#include "note.h"
#include "pins.h"
#include "port.h"
#include "processor.h"
#include "reset_cause.h"
#include "serial.h"
#include "stack_guard.h"
#include "systick.h"
#include "watchdog.h"

#define INTERRUPTS 82U /* RM0090 section 12.2 */

typedef void (*handler_t)(void);

extern const uint8_t elmopp_site_slot[]; /* from the linker script */
extern const uint8_t elmopp_site_slot_end[];
extern const uint8_t elmopp_weights_slot[];
extern const uint8_t elmopp_weights_slot_end[];
extern elmopp_register_t elmopp_store_area[];

/* What comes over the bus is kept in two sectors a kind. */
#define STORE_SECTORS 2U
#define STORE_BYTES (STORE_SECTORS * ELMOPP_FLASH_WRITER_SECTOR_BYTES)
#define STORE_SECTOR_SLOTS 3U
#define STORE_SLOT_BYTES 0xA000U
static_assert((2U * STORE_BYTES) == ELMOPP_FLASH_WRITER_BYTES, "weights, then a site");

/* A sector endures 10,000 erases (DS8626, flash memory endurance) and takes three images between two of them: at one a
   day both sectors last for 10,000 x 3 x 2 days, 164 years; 27 if every image cost an erase of its own. */
#define SAVE_MIN_S 86400U

/* In the core-coupled memory, which nothing else uses: no DMA reaches it and no code runs there (RM0090 section 2.3.1).
   Nothing here has either. */
static elmopp_learning_t learning __attribute__((section(".bss.aside")));

/* Whatever a controller listens to, at any site; SimTime is not among them. */
#define FEEDBACK(node) (ELMOPP_CAN_LAMP_FEEDBACK_FRAME_ID + (node))
#define CAMERA(approach) (ELMOPP_CAN_DETECTOR_COUNTS_FRAME_ID + (approach))
#define NEIGHBOUR(approach) (ELMOPP_CAN_NEIGHBOUR_OUTFLOW_FRAME_ID + (approach))
static const uint16_t wanted_ids[] = {
    ELMOPP_CAN_LAMP_COMMAND_FRAME_ID, /* of a second controller, as the next one */
    ELMOPP_CAN_CONTROLLER_STATUS_FRAME_ID,
    ELMOPP_CAN_COMMAND_FRAME_ID,
    ELMOPP_CAN_TRANSFER_FRAME_ID,
    ELMOPP_CAN_JUNCTION_OCCUPIED_FRAME_ID,
    FEEDBACK(0U),
    FEEDBACK(1U),
    FEEDBACK(2U),
    FEEDBACK(3U),
    FEEDBACK(4U),
    FEEDBACK(5U),
    FEEDBACK(6U),
    FEEDBACK(7U),
    CAMERA(0U),
    CAMERA(1U),
    CAMERA(2U),
    CAMERA(3U),
    CAMERA(4U),
    CAMERA(5U),
    CAMERA(6U),
    CAMERA(7U),
    NEIGHBOUR(0U),
    NEIGHBOUR(1U),
    NEIGHBOUR(2U),
    NEIGHBOUR(3U),
    NEIGHBOUR(4U),
    NEIGHBOUR(5U),
    NEIGHBOUR(6U),
    NEIGHBOUR(7U),
};
static_assert((ELMOPP_NODE_MAX == 8U) && (ELMOPP_APPROACH_MAX == 8U), "wanted_ids has every node and approach");

static elmopp_bxcan_t can;
static elmopp_serial_t serial;
static elmopp_watchdog_t watchdog;
static elmopp_debounce_t key;
static elmopp_clocks_t clocks;
static bool brown_out_is_set;
static elmopp_flash_writer_trouble_t flash_trouble;
static uint32_t told_dropped;
static elmopp_bxcan_state_t told_state;
static uint32_t told_passives;

/* --- interrupts --- */

static void can_handler(void) {
    elmopp_bxcan_interrupt(&can);
}

#define NOBODY elmopp_unexpected_handler
#define NOBODY_10 NOBODY, NOBODY, NOBODY, NOBODY, NOBODY, NOBODY, NOBODY, NOBODY, NOBODY, NOBODY

__attribute__((section(".vectors.device"), used)) static const handler_t device_vectors[INTERRUPTS] = {
    NOBODY_10, NOBODY_10, can_handler, NOBODY_10, NOBODY_10, NOBODY_10, NOBODY_10, NOBODY_10, NOBODY_10, NOBODY};
static_assert(ELMOPP_CAN1_RX0_INTERRUPT == 20U, "the place of can_handler");

/* --- the start --- */

static void tell_start(elmopp_reset_cause_t cause) {
    elmopp_port_say("elmopp-stm32f4 starts; last reset:");
    elmopp_port_say(elmopp_reset_cause_name(cause));
    if (clocks.trouble != ELMOPP_CLOCKS_WELL) {
        elmopp_port_say("oscillator: internal, 16 MHz, so that CAN is tried and stays silent:");
        elmopp_port_say(elmopp_clocks_trouble_name(clocks.trouble));
    }
    if (!brown_out_is_set) {
        elmopp_port_say("brown-out reset: not at level 3; right would be option bytes with BOR_LEV 00");
    }
}

static void start_can(void) {
    const elmopp_bxcan_config_t config = {.bit_timing = ELMOPP_CAN_BTR,
                                          .ids = wanted_ids,
                                          .id_count = (uint32_t)(sizeof wanted_ids / sizeof wanted_ids[0]),
                                          .may_join = clocks.trouble == ELMOPP_CLOCKS_WELL};
    elmopp_bxcan_init(&can, ELMOPP_CAN1, &config);
    elmopp_bxcan_start(&can, elmopp_port_now_ms());
    told_state = can.state;
    told_passives = 0U;
}

/* The watchdog's own reset leaves no note; a run that it had to end is one that a fault has ended. */
void elmopp_port_init(void) {
    static const elmopp_clocks_registers_t of_clocks = {.rcc = ELMOPP_RCC, .flash = ELMOPP_FLASH, .pwr = ELMOPP_PWR};
    static const elmopp_pins_registers_t of_pins = {.rcc = ELMOPP_RCC, .b = ELMOPP_GPIOB, .c = ELMOPP_GPIOC};
    elmopp_watchdog_start(&watchdog, ELMOPP_IWDG);
    elmopp_stack_guard_start();
    const elmopp_reset_cause_t cause = elmopp_reset_cause_take(ELMOPP_RCC);
    if (cause == ELMOPP_RESET_WATCHDOG) {
        elmopp_note_fault();
    }
    clocks = elmopp_clocks_start(&of_clocks);
    brown_out_is_set = elmopp_brown_out_is_set(ELMOPP_FLASH);
    elmopp_pins_start(&of_pins);
    elmopp_serial_start(&serial, ELMOPP_USART1, clocks.pclk2_hz);
    elmopp_systick_start(clocks.processor_hz);
    elmopp_enable_interrupt(ELMOPP_CAN1_RX0_INTERRUPT);
    elmopp_interrupts_on();
    elmopp_debounce_init(&key, elmopp_port_now_ms());
    tell_start(cause);
    start_can();
}

/* --- what goes on beside the frames, every millisecond --- */

static void tell_can(void) {
    if (can.passives != told_passives) {
        told_passives = can.passives;
        elmopp_port_say("CAN: error-passive; is anybody else there, and is the bus terminated?");
    }
    if (can.state == told_state) {
        return;
    }
    told_state = can.state;
    if (can.state == ELMOPP_BXCAN_RUNNING) {
        elmopp_port_say("CAN: on the bus");
    } else if (can.state == ELMOPP_BXCAN_HELD) {
        elmopp_port_say("CAN: it answers, and stays silent");
    } else if (can.state == ELMOPP_BXCAN_PAUSING) {
        elmopp_port_say("CAN: another try follows:");
        elmopp_port_say(elmopp_bxcan_trouble_name(can.trouble));
    } else if (can.state == ELMOPP_BXCAN_FAILED) {
        elmopp_port_say("CAN: given up; turning the key begins anew:");
        elmopp_port_say(elmopp_bxcan_trouble_name(can.trouble));
    } else {
        /* on its way */
    }
}

static void look_at_key(elmopp_ms_t now_ms) {
    const bool was_held = key.held;
    const bool turned = elmopp_debounce_look(&key, elmopp_pins_key_is_closed(ELMOPP_GPIOC), now_ms) && (!was_held);
    if (turned && (can.state == ELMOPP_BXCAN_FAILED)) {
        elmopp_bxcan_start(&can, now_ms);
    }
}

static void look_around(void) {
    const elmopp_ms_t now_ms = elmopp_port_now_ms();
    elmopp_bxcan_step(&can, now_ms);
    tell_can();
    look_at_key(now_ms);
    elmopp_serial_look(&serial);
}

/* --- the port --- */

elmopp_ms_t elmopp_port_now_ms(void) {
    return elmopp_systick_ms();
}

bool elmopp_port_receive(elmopp_frame_t *frame) {
    look_around();
    return elmopp_bxcan_receive(&can, frame);
}

uint32_t elmopp_port_dropped(void) {
    const uint32_t now = elmopp_bxcan_overruns(&can);
    const uint32_t since = now - told_dropped;
    told_dropped = now;
    return since;
}

bool elmopp_port_send(const elmopp_frame_t *frame) {
    return elmopp_bxcan_send(&can, frame, elmopp_port_now_ms());
}

/* The clock interrupts every millisecond, so that nothing is slept over for longer. */
void elmopp_port_sleep_until(elmopp_ms_t until_ms) {
    look_around(); /* what has just been given to send */
    if ((until_ms - elmopp_systick_ms() - 1U) < INT32_MAX) {
        elmopp_wait_for_interrupt();
    }
}

void elmopp_port_kick_watchdog(void) {
    elmopp_watchdog_kick(&watchdog);
}

bool elmopp_port_reset_is_held(void) {
    return key.held;
}

elmopp_fault_t elmopp_port_fault(void) {
    elmopp_fault_t fault = ELMOPP_FAULT_NONE;
    if (clocks.trouble != ELMOPP_CLOCKS_WELL) {
        fault = ELMOPP_FAULT_OSCILLATOR;
    } else if (can.state == ELMOPP_BXCAN_FAILED) {
        fault = ELMOPP_FAULT_CAN_CONTROLLER;
    } else if (!brown_out_is_set) {
        fault = ELMOPP_FAULT_BROWN_OUT;
    } else {
        /* nothing is wrong with the board */
    }
    return fault;
}

elmopp_port_slot_t elmopp_port_site_slot(void) {
    return (elmopp_port_slot_t){elmopp_site_slot, (uint32_t)(elmopp_site_slot_end - elmopp_site_slot)};
}

elmopp_port_slot_t elmopp_port_weights_slot(void) {
    return (elmopp_port_slot_t){elmopp_weights_slot, (uint32_t)(elmopp_weights_slot_end - elmopp_weights_slot)};
}

static uint32_t store_at(elmopp_transfer_kind_t kind) {
    return (kind == ELMOPP_TRANSFER_SITE) ? STORE_BYTES : 0U;
}

elmopp_store_medium_t elmopp_port_medium(elmopp_transfer_kind_t kind) {
    const volatile void *area = elmopp_store_area;
    return (elmopp_store_medium_t){.bytes = &((const uint8_t *)area)[store_at(kind)],
                                   .sectors = STORE_SECTORS,
                                   .sector_bytes = ELMOPP_FLASH_WRITER_SECTOR_BYTES,
                                   .sector_slots = STORE_SECTOR_SLOTS,
                                   .slot_bytes = STORE_SLOT_BYTES,
                                   .erases_any_time = false};
}

/* A supply that may be too low for 32 bits at a time, or a clock that is not what was reckoned with, writes nothing. An
   erase would stop the lamps and bite the watchdog: never after the first lamp tick. */
static elmopp_flash_writer_trouble_t write_flash(uint32_t at, const elmopp_store_order_t *order) {
    const elmopp_flash_writer_t writer = {
        .registers = ELMOPP_FLASH, .memory = elmopp_store_area, .erase_looks = ELMOPP_FLASH_WRITER_ERASE_LOOKS};
    elmopp_flash_writer_trouble_t trouble = ELMOPP_FLASH_WRITER_PLACE;
    if (order->action != ELMOPP_STORE_ERASE) {
        trouble = elmopp_flash_writer_program(&writer, at, order->word);
    } else if (elmopp_watchdog_begin_anew(&watchdog)) {
        trouble = elmopp_flash_writer_erase(&writer, at);
        (void)elmopp_watchdog_begin_anew(&watchdog);
    } else {
        /* too late */
    }
    return trouble;
}

elmopp_store_answer_t elmopp_port_store(elmopp_transfer_kind_t kind, const elmopp_store_order_t *order) {
    if ((!brown_out_is_set) || (clocks.trouble != ELMOPP_CLOCKS_WELL)) {
        return ELMOPP_STORE_FAILED;
    }
    const elmopp_flash_writer_trouble_t trouble = write_flash(store_at(kind) + order->at, order);
    if ((trouble != ELMOPP_FLASH_WRITER_WELL) && (trouble != flash_trouble)) {
        elmopp_port_say("flash: nothing was written:");
        elmopp_port_say(elmopp_flash_writer_trouble_name(trouble));
    }
    flash_trouble = trouble;
    return (trouble == ELMOPP_FLASH_WRITER_WELL) ? ELMOPP_STORE_DONE : ELMOPP_STORE_FAILED;
}

uint32_t elmopp_port_save_min_s(void) {
    return SAVE_MIN_S;
}

elmopp_learning_t *elmopp_port_learning(void) {
    return &learning;
}

void elmopp_port_say(const char *text) {
    elmopp_serial_say(&serial, text);
}

/* First of all CAN is taken off the bus: after a failure of the crystal it would speak at a wrong rate. Whoever hears
   no command flashes. */
void elmopp_port_fail(const char *what) {
    elmopp_interrupts_off();
    elmopp_register_write(&ELMOPP_CAN1->mcr, ELMOPP_BXCAN_MCR_RESET);
    elmopp_port_say("stopped, begins anew:");
    elmopp_port_say(what);
    elmopp_serial_flush(&serial);
    elmopp_processor_reset();
}
