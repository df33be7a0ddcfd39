/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// What an STM32F405 does before and beside CAN: clocks, watchdog, reset cause, brown-out, pins, key switch, serial
/// line. The hardware answers late or never; every wait ends.

#include "clock_plan.h"
#include "clocks.h"
#include "debounce.h"
#include "pins.h"
#include "register_bank.h"
#include "reset_cause.h"
#include "serial.h"
#include "unity.h"
#include "watchdog.h"

#include <string.h>

static elmopp_rcc_registers_t rcc;
static elmopp_flash_registers_t flash;
static elmopp_pwr_registers_t pwr;
static elmopp_iwdg_registers_t iwdg;
static elmopp_gpio_registers_t gpio_b;
static elmopp_gpio_registers_t gpio_c;
static elmopp_usart_registers_t usart;
static const elmopp_clocks_registers_t of_clocks = {.rcc = &rcc, .flash = &flash, .pwr = &pwr};

/* What does not answer, and how many looks an answer takes. */
static bool no_crystal;
static bool no_flash;
static bool no_pll;
static bool no_switch;
static uint32_t looks;
static uint32_t looked;

static uint32_t late(uint32_t stored, uint32_t asked, uint32_t answer) {
    looked = ((stored & asked) != 0U) ? (looked + 1U) : 0U;
    return (looked > looks) ? (stored | answer) : stored;
}

static uint32_t clock_hardware(const elmopp_register_t *place, uint32_t stored) {
    uint32_t shown = stored;
    if (place == &rcc.cr) {
        const bool pll = (stored & ELMOPP_RCC_CR_PLLON) != 0U;
        if (pll) {
            shown = no_pll ? stored : late(stored, ELMOPP_RCC_CR_PLLON, ELMOPP_RCC_CR_PLLRDY | ELMOPP_RCC_CR_HSERDY);
        } else {
            shown = no_crystal ? stored : late(stored, ELMOPP_RCC_CR_HSEON, ELMOPP_RCC_CR_HSERDY);
        }
    } else if (place == &rcc.cfgr) {
        shown = stored | (no_switch ? 0U : ((stored & ELMOPP_RCC_CFGR_SW) << ELMOPP_RCC_CFGR_SWS_AT));
    } else if (place == &flash.acr) {
        shown = no_flash ? 0U : stored;
    } else {
        /* memory */
    }
    return shown;
}

void setUp(void) {
    memset(&rcc, 0, sizeof rcc);
    memset(&flash, 0, sizeof flash);
    memset(&pwr, 0, sizeof pwr);
    memset(&iwdg, 0, sizeof iwdg);
    memset(&gpio_b, 0, sizeof gpio_b);
    memset(&gpio_c, 0, sizeof gpio_c);
    memset(&usart, 0, sizeof usart);
    no_crystal = false;
    no_flash = false;
    no_pll = false;
    no_switch = false;
    looks = 3U;
    looked = 0U;
    register_bank_use(NULL);
}

void tearDown(void) {}

/* --- clocks --- */

static void test_from_the_crystal_it_runs_at_168_megahertz(void) {
    register_bank_use(clock_hardware);
    const elmopp_clocks_t clocks = elmopp_clocks_start(&of_clocks);
    TEST_ASSERT_EQUAL_INT(ELMOPP_CLOCKS_WELL, clocks.trouble);
    TEST_ASSERT_EQUAL_UINT32(168000000U, clocks.processor_hz);
    TEST_ASSERT_EQUAL_UINT32(42000000U, clocks.pclk1_hz);
    TEST_ASSERT_EQUAL_UINT32(84000000U, clocks.pclk2_hz);
    const uint32_t m = rcc.pllcfgr & 63U;
    const uint32_t n = (rcc.pllcfgr >> 6U) & 511U;
    const uint32_t p = 2U * (((rcc.pllcfgr >> 16U) & 3U) + 1U);
    TEST_ASSERT_EQUAL_UINT32(168000000U, ((ELMOPP_STM32F4_HSE_HZ / m) * n) / p);
    TEST_ASSERT_EQUAL_HEX32(ELMOPP_BIT(22U), rcc.pllcfgr & ELMOPP_BIT(22U)); /* from the crystal */
    TEST_ASSERT_EQUAL_UINT32(5U, flash.acr & 7U);
    TEST_ASSERT_EQUAL_UINT32(2U, rcc.cfgr & 3U);
    TEST_ASSERT_TRUE((rcc.cr & ELMOPP_RCC_CR_CSSON) != 0U); /* watched */
    TEST_ASSERT_TRUE((pwr.cr & ELMOPP_PWR_CR_VOS) != 0U);
}

static void expect_internal(elmopp_clocks_trouble_t trouble) {
    register_bank_use(clock_hardware);
    const elmopp_clocks_t clocks = elmopp_clocks_start(&of_clocks);
    TEST_ASSERT_EQUAL_INT(trouble, clocks.trouble);
    TEST_ASSERT_EQUAL_UINT32(16000000U, clocks.processor_hz);
    TEST_ASSERT_EQUAL_UINT32(16000000U, clocks.pclk1_hz);
    TEST_ASSERT_EQUAL_UINT32(16000000U, clocks.pclk2_hz);
    TEST_ASSERT_EQUAL_UINT32(0U, rcc.cfgr);
    TEST_ASSERT_EQUAL_UINT32(0U, rcc.cr & (ELMOPP_RCC_CR_PLLON | ELMOPP_RCC_CR_HSEON | ELMOPP_RCC_CR_CSSON));
    TEST_ASSERT_TRUE(register_bank_accesses() < (ELMOPP_CLOCKS_CRYSTAL_LOOKS + ELMOPP_CLOCKS_LOOKS));
}

static void test_without_a_crystal_it_stays_on_the_internal_oscillator_and_says_so(void) {
    no_crystal = true;
    expect_internal(ELMOPP_CLOCKS_NO_CRYSTAL);
    TEST_ASSERT_EQUAL_STRING("the crystal does not swing", elmopp_clocks_trouble_name(ELMOPP_CLOCKS_NO_CRYSTAL));
}

static void test_a_crystal_that_comes_one_look_too_late_has_not_come(void) {
    looks = ELMOPP_CLOCKS_CRYSTAL_LOOKS - 1U;
    register_bank_use(clock_hardware);
    TEST_ASSERT_EQUAL_INT(ELMOPP_CLOCKS_WELL, elmopp_clocks_start(&of_clocks).trouble);
    setUp();
    looks = ELMOPP_CLOCKS_CRYSTAL_LOOKS;
    expect_internal(ELMOPP_CLOCKS_NO_CRYSTAL);
}

static void test_flash_pll_or_switch_that_do_not_answer_are_named(void) {
    no_flash = true;
    expect_internal(ELMOPP_CLOCKS_NO_FLASH);
    setUp();
    no_pll = true;
    expect_internal(ELMOPP_CLOCKS_NO_PLL);
    setUp();
    no_switch = true;
    expect_internal(ELMOPP_CLOCKS_NO_SWITCH);
    for (uint32_t i = 0U; i <= (uint32_t)ELMOPP_CLOCKS_NO_SWITCH; i++) {
        TEST_ASSERT_TRUE(strcmp(elmopp_clocks_trouble_name((elmopp_clocks_trouble_t)i), "unknown") != 0);
    }
    TEST_ASSERT_EQUAL_STRING("unknown", elmopp_clocks_trouble_name((elmopp_clocks_trouble_t)99));
}

/* --- watchdog --- */

static uint32_t busy_watchdog(const elmopp_register_t *place, uint32_t stored) {
    return (place == &iwdg.sr) ? 3U : stored;
}

static void test_the_watchdog_starts_long_and_tightens_with_the_first_tick(void) {
    elmopp_watchdog_t watchdog;
    elmopp_watchdog_start(&watchdog, &iwdg);
    TEST_ASSERT_EQUAL_HEX32(0xCCCCU, register_bank_written(&iwdg.kr, 0U));
    TEST_ASSERT_EQUAL_UINT32(4000U, (1000U * iwdg.rlr * (4U << iwdg.pr)) / 32000U);
    elmopp_watchdog_kick(&watchdog);
    TEST_ASSERT_EQUAL_UINT32(375U, (1000U * iwdg.rlr * (4U << iwdg.pr)) / 32000U);
    TEST_ASSERT_EQUAL_HEX32(0xAAAAU, iwdg.kr);
}

static void test_a_kick_is_one_write(void) {
    elmopp_watchdog_t watchdog;
    elmopp_watchdog_start(&watchdog, &iwdg);
    elmopp_watchdog_kick(&watchdog);
    register_bank_use(NULL);
    elmopp_watchdog_kick(&watchdog);
    TEST_ASSERT_EQUAL_UINT32(1U, register_bank_accesses());
    TEST_ASSERT_EQUAL_HEX32(0xAAAAU, register_bank_written(&iwdg.kr, 0U));
}

static void test_the_long_time_begins_anew_only_until_the_first_tick(void) {
    elmopp_watchdog_t watchdog;
    elmopp_watchdog_start(&watchdog, &iwdg);
    register_bank_use(NULL);
    TEST_ASSERT_TRUE(elmopp_watchdog_begin_anew(&watchdog));
    TEST_ASSERT_EQUAL_HEX32(0xAAAAU, register_bank_written(&iwdg.kr, 0U));
    TEST_ASSERT_EQUAL_UINT32(1U, register_bank_accesses());
    elmopp_watchdog_kick(&watchdog);
    register_bank_use(NULL);
    TEST_ASSERT_FALSE(elmopp_watchdog_begin_anew(&watchdog));
    TEST_ASSERT_EQUAL_UINT32(0U, register_bank_accesses());
}

static void test_a_watchdog_that_is_always_busy_is_started_and_kicked_all_the_same(void) {
    elmopp_watchdog_t watchdog;
    register_bank_use(busy_watchdog);
    elmopp_watchdog_start(&watchdog, &iwdg);
    elmopp_watchdog_kick(&watchdog);
    TEST_ASSERT_TRUE(register_bank_accesses() < (3U * ELMOPP_WATCHDOG_LOOKS));
    TEST_ASSERT_EQUAL_HEX32(0xCCCCU, register_bank_written(&iwdg.kr, 0U));
    TEST_ASSERT_EQUAL_HEX32(0xAAAAU, iwdg.kr);
}

/* --- reset cause, brown-out --- */

static void expect_cause(uint32_t flags, elmopp_reset_cause_t cause, const char *name) {
    rcc.csr = flags;
    TEST_ASSERT_EQUAL_INT(cause, elmopp_reset_cause_take(&rcc));
    TEST_ASSERT_EQUAL_STRING(name, elmopp_reset_cause_name(cause));
    TEST_ASSERT_TRUE((rcc.csr & ELMOPP_RCC_CSR_RMVF) != 0U);
}

static void test_of_several_reset_flags_the_one_that_says_most_is_named(void) {
    const uint32_t pin = ELMOPP_RCC_CSR_PINRSTF;
    expect_cause(0U, ELMOPP_RESET_UNKNOWN, "unknown");
    expect_cause(pin, ELMOPP_RESET_PIN, "reset pin");
    expect_cause(pin | ELMOPP_RCC_CSR_PORRSTF | ELMOPP_RCC_CSR_BORRSTF, ELMOPP_RESET_POWER, "power");
    expect_cause(pin | ELMOPP_RCC_CSR_BORRSTF, ELMOPP_RESET_BROWN_OUT, "brown-out");
    expect_cause(pin | ELMOPP_RCC_CSR_SFTRSTF, ELMOPP_RESET_SOFTWARE, "software");
    expect_cause(pin | ELMOPP_RCC_CSR_IWDGRSTF, ELMOPP_RESET_WATCHDOG, "watchdog");
    expect_cause(pin | ELMOPP_RCC_CSR_WWDGRSTF, ELMOPP_RESET_WATCHDOG, "watchdog");
    expect_cause(pin | ELMOPP_RCC_CSR_LPWRRSTF, ELMOPP_RESET_LOW_POWER, "low-power mode");
}

static void test_only_the_highest_brown_out_level_will_do_and_none_is_programmed(void) {
    for (uint32_t level = 0U; level < 4U; level++) {
        flash.optcr = 0x0FFFAAE1U | (level << 2U);
        TEST_ASSERT_EQUAL_INT(level == 0U, elmopp_brown_out_is_set(&flash)); /* 0: level 3, 3: off */
    }
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, register_bank_written(&flash.optcr, 0U));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, register_bank_written(&flash.optkeyr, 0U));
}

/* --- pins, key --- */

static uint32_t field(uint32_t word, uint32_t pin, uint32_t bits) {
    return (word >> (bits * pin)) & ((1U << bits) - 1U);
}

static void test_pins_are_given_to_can_and_the_serial_line_and_no_others(void) {
    const elmopp_pins_registers_t of_pins = {.rcc = &rcc, .b = &gpio_b, .c = &gpio_c};
    gpio_b.moder = 0x00000280U; /* as the reset leaves them: the debugger's */
    elmopp_pins_start(&of_pins);
    TEST_ASSERT_EQUAL_HEX32(0x280U | (2U << 12U) | (2U << 16U) | (2U << 18U), gpio_b.moder);
    TEST_ASSERT_EQUAL_UINT32(7U, field(gpio_b.afr[0], 6U, 4U));
    TEST_ASSERT_EQUAL_UINT32(9U, field(gpio_b.afr[1], 0U, 4U));
    TEST_ASSERT_EQUAL_UINT32(9U, field(gpio_b.afr[1], 1U, 4U));
    TEST_ASSERT_EQUAL_UINT32(1U, field(gpio_b.pupdr, 8U, 2U)); /* an idle bus without a transceiver */
    TEST_ASSERT_EQUAL_UINT32(1U, field(gpio_c.pupdr, 4U, 2U)); /* a key that is let go without a wire */
    TEST_ASSERT_EQUAL_HEX32(0U, gpio_c.moder);
    TEST_ASSERT_EQUAL_HEX32(ELMOPP_RCC_APB1ENR_CAN1, rcc.apb1enr);
    TEST_ASSERT_EQUAL_HEX32(ELMOPP_RCC_APB2ENR_USART1, rcc.apb2enr);
}

static void test_a_key_without_a_wire_is_let_go(void) {
    gpio_c.idr = 0xFFFFU;
    TEST_ASSERT_FALSE(elmopp_pins_key_is_closed(&gpio_c));
    gpio_c.idr = 0xFFEFU;
    TEST_ASSERT_TRUE(elmopp_pins_key_is_closed(&gpio_c));
}

static void test_a_key_counts_after_fifty_milliseconds_without_a_break(void) {
    elmopp_debounce_t key;
    uint32_t now_ms = UINT32_MAX - 20U; /* wraps meanwhile */
    elmopp_debounce_init(&key, now_ms);
    for (uint32_t k = 0U; k < 40U; k++) {
        TEST_ASSERT_FALSE(elmopp_debounce_look(&key, (k % 2U) == 0U, now_ms + k)); /* bounces */
    }
    now_ms += 39U;
    TEST_ASSERT_FALSE(elmopp_debounce_look(&key, true, now_ms + ELMOPP_DEBOUNCE_MS - 1U));
    TEST_ASSERT_TRUE(elmopp_debounce_look(&key, true, now_ms + ELMOPP_DEBOUNCE_MS));
    now_ms += ELMOPP_DEBOUNCE_MS;
    TEST_ASSERT_TRUE(elmopp_debounce_look(&key, false, now_ms + ELMOPP_DEBOUNCE_MS - 1U));
    TEST_ASSERT_FALSE(elmopp_debounce_look(&key, false, now_ms + ELMOPP_DEBOUNCE_MS));
}

/* --- serial line --- */

static uint32_t ready_serial(const elmopp_register_t *place, uint32_t stored) {
    return (place == &usart.sr) ? ELMOPP_USART_SR_TXE : stored;
}

static void test_a_line_goes_out_as_it_is_with_its_end(void) {
    static elmopp_serial_t serial;
    const char *const wanted = "oscillator\r\n";
    register_bank_use(ready_serial);
    elmopp_serial_start(&serial, &usart, 84000000U);
    TEST_ASSERT_EQUAL_UINT32(729U, usart.brr); /* 115,226 baud */
    elmopp_serial_say(&serial, "oscillator");
    elmopp_serial_look(&serial);
    for (uint32_t k = 0U; wanted[k] != '\0'; k++) {
        TEST_ASSERT_EQUAL_UINT32((uint8_t)wanted[k], register_bank_written(&usart.dr, k));
    }
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, register_bank_written(&usart.dr, 12U));
}

static void test_a_serial_line_that_takes_nothing_holds_nobody_up(void) {
    static elmopp_serial_t serial;
    elmopp_serial_start(&serial, &usart, 16000000U);
    for (uint32_t k = 0U; k < 200U; k++) {
        elmopp_serial_say(&serial, "a line for which there is no room at last");
    }
    register_bank_use(NULL);
    elmopp_serial_look(&serial);
    TEST_ASSERT_EQUAL_UINT32(1U, register_bank_accesses());
    elmopp_serial_flush(&serial);
    TEST_ASSERT_TRUE(register_bank_accesses() < (2U * ELMOPP_SERIAL_LOOKS));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_from_the_crystal_it_runs_at_168_megahertz);
    RUN_TEST(test_without_a_crystal_it_stays_on_the_internal_oscillator_and_says_so);
    RUN_TEST(test_a_crystal_that_comes_one_look_too_late_has_not_come);
    RUN_TEST(test_flash_pll_or_switch_that_do_not_answer_are_named);
    RUN_TEST(test_the_watchdog_starts_long_and_tightens_with_the_first_tick);
    RUN_TEST(test_the_long_time_begins_anew_only_until_the_first_tick);
    RUN_TEST(test_a_kick_is_one_write);
    RUN_TEST(test_a_watchdog_that_is_always_busy_is_started_and_kicked_all_the_same);
    RUN_TEST(test_of_several_reset_flags_the_one_that_says_most_is_named);
    RUN_TEST(test_only_the_highest_brown_out_level_will_do_and_none_is_programmed);
    RUN_TEST(test_pins_are_given_to_can_and_the_serial_line_and_no_others);
    RUN_TEST(test_a_key_without_a_wire_is_let_go);
    RUN_TEST(test_a_key_counts_after_fifty_milliseconds_without_a_break);
    RUN_TEST(test_a_line_goes_out_as_it_is_with_its_end);
    RUN_TEST(test_a_serial_line_that_takes_nothing_holds_nobody_up);
    return UNITY_END();
}
