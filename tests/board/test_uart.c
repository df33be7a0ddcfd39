/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The serial driver of the emulated board against registers that a test sets: what an emulator is too quick to show.

#include "uart.h"

#include "unity.h"

#define FULL 1U
#define RECEIVED 2U
#define OVERRUN 8U
#define RECEIVE_INTERRUPT 8U
#define SEND_INTERRUPT 4U

/* Plain memory: what a device does by itself, the tests do. */
static struct {
    uint32_t data;
    uint32_t state;
    uint32_t control;
    uint32_t interrupt;
    uint32_t divider;
} device;

static elmopp_uart_t uart;

void setUp(void) {
    device.data = 0U;
    device.state = 0U;
    elmopp_uart_init(&uart, &device, 25000000U, 115200U);
}
void tearDown(void) {}

static void arrives(char character) {
    device.data = (uint32_t)(uint8_t)character;
    device.state |= RECEIVED;
    elmopp_uart_interrupt(&uart);
    device.state &= ~RECEIVED;
}

static char pattern(uint32_t k) {
    return (char)(uint8_t)('a' + (k % 26U));
}

static void fill(void) {
    for (uint32_t k = 0U; k < ELMOPP_UART_RECEIVE_SIZE; k++) {
        TEST_ASSERT_BITS_HIGH(RECEIVE_INTERRUPT, device.control);
        arrives(pattern(k));
    }
}

static void read_some(uint32_t from, uint32_t count) {
    for (uint32_t k = from; k < (from + count); k++) {
        char character = '\0';
        TEST_ASSERT_TRUE(elmopp_uart_read(&uart, &character));
        TEST_ASSERT_EQUAL_CHAR(pattern(k), character);
    }
}

static void test_the_speed_is_what_was_asked_for(void) {
    TEST_ASSERT_EQUAL_UINT32(217U, device.divider);
    elmopp_uart_init(&uart, &device, 25000000U, 25000000U);
    TEST_ASSERT_EQUAL_UINT32(16U, device.divider); /* the least that the device takes */
}

static void test_a_ring_that_is_full_rests_until_half_of_it_is_read_and_loses_nothing(void) {
    const uint32_t half = ELMOPP_UART_RECEIVE_SIZE / 2U;
    fill();
    TEST_ASSERT_BITS_LOW(RECEIVE_INTERRUPT, device.control);
    device.data = (uint32_t)(uint8_t)pattern(ELMOPP_UART_RECEIVE_SIZE); /* waits in the device */
    device.state = RECEIVED;
    read_some(0U, half - 1U);
    TEST_ASSERT_BITS_LOW(RECEIVE_INTERRUPT, device.control);
    read_some(half - 1U, 1U);
    TEST_ASSERT_BITS_HIGH(RECEIVE_INTERRUPT, device.control);
    device.state = 0U;
    read_some(half, half + 1U);
    TEST_ASSERT_FALSE(elmopp_uart_has(&uart));
    TEST_ASSERT_EQUAL_UINT32(0U, uart.overrun);
}

static void test_what_the_device_lost_is_counted(void) {
    device.state = OVERRUN;
    elmopp_uart_interrupt(&uart);
    TEST_ASSERT_EQUAL_UINT32(1U, uart.overrun);
    TEST_ASSERT_EQUAL_UINT32(OVERRUN, device.state); /* written: ones clear */
    device.state = 0U;
    elmopp_uart_interrupt(&uart);
    TEST_ASSERT_EQUAL_UINT32(1U, uart.overrun);
}

static void test_what_is_sent_waits_for_the_device_and_is_all_or_nothing(void) {
    device.state = FULL;
    for (uint32_t k = 0U; k < (ELMOPP_UART_SEND_SIZE / 8U); k++) {
        TEST_ASSERT_TRUE(elmopp_uart_write(&uart, "12345678", 8U));
    }
    TEST_ASSERT_BITS_HIGH(SEND_INTERRUPT, device.control);
    TEST_ASSERT_FALSE(elmopp_uart_write(&uart, "x", 1U));
    TEST_ASSERT_EQUAL_UINT32(0U, uart.sent);
    device.state = 0U;
    elmopp_uart_interrupt(&uart);
    TEST_ASSERT_EQUAL_UINT32(ELMOPP_UART_SEND_SIZE, uart.sent);
    TEST_ASSERT_EQUAL_UINT32('8', device.data);
    TEST_ASSERT_BITS_LOW(SEND_INTERRUPT, device.control);
    TEST_ASSERT_TRUE(elmopp_uart_write(&uart, "x", 1U));
    TEST_ASSERT_EQUAL_UINT32('x', device.data);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_speed_is_what_was_asked_for);
    RUN_TEST(test_a_ring_that_is_full_rests_until_half_of_it_is_read_and_loses_nothing);
    RUN_TEST(test_what_the_device_lost_is_counted);
    RUN_TEST(test_what_is_sent_waits_for_the_device_and_is_all_or_nothing);
    return UNITY_END();
}
