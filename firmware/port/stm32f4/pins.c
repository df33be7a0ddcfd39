/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "pins.h"

#define SERIAL_TRANSMIT 6U
#define CAN_RECEIVE 8U
#define CAN_TRANSMIT 9U
#define KEY 4U

#define FUNCTION_USART1 7U
#define FUNCTION_CAN1 9U

#define MODE_ALTERNATE 2U
#define PULL_UP 1U
#define FIELD_OF_TWO 3U /* mode, pull: two bits a pin */
#define BITS_OF_TWO 2U
#define FIELD_OF_FOUR 15U /* alternate function: four bits a pin, eight pins a register */
#define BITS_OF_FOUR 4U
#define PINS_OF_AFR 8U

static void set_field(elmopp_register_t *place, uint32_t field, uint32_t at, uint32_t value) {
    const uint32_t kept = elmopp_register_read(place) & ~(field << at);
    elmopp_register_write(place, kept | (value << at));
}

static void give_to(elmopp_gpio_registers_t *gpio, uint32_t pin, uint32_t function) {
    set_field(&gpio->afr[pin / PINS_OF_AFR], FIELD_OF_FOUR, BITS_OF_FOUR * (pin % PINS_OF_AFR), function);
    set_field(&gpio->moder, FIELD_OF_TWO, BITS_OF_TWO * pin, MODE_ALTERNATE);
}

static void pull_up(elmopp_gpio_registers_t *gpio, uint32_t pin) {
    set_field(&gpio->pupdr, FIELD_OF_TWO, BITS_OF_TWO * pin, PULL_UP);
}

static void let_clock_to(elmopp_register_t *place, uint32_t bits) {
    elmopp_register_write(place, elmopp_register_read(place) | bits);
    (void)elmopp_register_read(place); /* errata ES0182: the clock is there some cycles later */
}

void elmopp_pins_start(const elmopp_pins_registers_t *registers) {
    let_clock_to(&registers->rcc->ahb1enr, ELMOPP_RCC_AHB1ENR_GPIOB | ELMOPP_RCC_AHB1ENR_GPIOC);
    let_clock_to(&registers->rcc->apb1enr, ELMOPP_RCC_APB1ENR_CAN1);
    let_clock_to(&registers->rcc->apb2enr, ELMOPP_RCC_APB2ENR_USART1);
    pull_up(registers->b, CAN_RECEIVE);
    pull_up(registers->c, KEY);
    give_to(registers->b, SERIAL_TRANSMIT, FUNCTION_USART1);
    give_to(registers->b, CAN_RECEIVE, FUNCTION_CAN1);
    give_to(registers->b, CAN_TRANSMIT, FUNCTION_CAN1);
}

bool elmopp_pins_key_is_closed(const elmopp_gpio_registers_t *c) {
    return (elmopp_register_read(&c->idr) & ELMOPP_BIT(KEY)) == 0U;
}
