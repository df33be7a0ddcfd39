/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The account: what was said 30 seconds ago against what came. tests/test_forecast_network.c has it as the forecast
/// uses it.

#include "elmopp/account.h"
#include "unity.h"

#include <stddef.h>

#define PROBE ELMOPP_ACCOUNT_PROBE_S
#define APPROACHES 3U

static elmopp_account_t account;

void setUp(void) {
    account = (elmopp_account_t){.due = 0U};
}
void tearDown(void) {}

/* One second: what came, and then what is said about 30 seconds later. */
static void second(const float *came_veh, const float *said_veh) {
    elmopp_account_settle(&account, came_veh, APPROACHES);
    if (said_veh != NULL) {
        elmopp_account_probe_t *page = elmopp_account_page(&account, PROBE);
        for (uint32_t i = 0U; i < APPROACHES; i++) {
            page->forecast_veh[i] = said_veh[i];
            page->persistence_veh[i] = said_veh[i] + 1.0F;
            page->mean_veh[i] = 0.0F;
        }
        page->said = true;
    }
}

static const float nothing[APPROACHES] = {0.0F, 0.0F, 0.0F};

static void test_what_is_said_falls_due_in_exactly_30_seconds(void) {
    static const float said_veh[APPROACHES] = {1.0F, 2.0F, 3.0F};
    static const float came_veh[APPROACHES] = {1.0F, 0.0F, 6.0F};
    second(nothing, said_veh);
    for (uint32_t n = 1U; n < PROBE; n++) {
        second(nothing, NULL);
        TEST_ASSERT_EQUAL_UINT32(0U, account.error.compared_s);
    }
    second(came_veh, NULL);
    TEST_ASSERT_EQUAL_UINT32(1U, account.error.compared_s);
    TEST_ASSERT_EQUAL_FLOAT((0.0F + 4.0F + 9.0F) / 3.0F, account.error.forecast);
    TEST_ASSERT_EQUAL_FLOAT((1.0F + 9.0F + 4.0F) / 3.0F, account.error.persistence);
    TEST_ASSERT_EQUAL_FLOAT((1.0F + 0.0F + 36.0F) / 3.0F, account.error.mean);
    for (uint32_t n = 0U; n < (2U * PROBE); n++) {
        second(nothing, NULL);
    }
    TEST_ASSERT_EQUAL_UINT32(1U, account.error.compared_s);
}

/* An account that looks less far: due after `ahead_s` and never again. */
static void test_what_is_said_of_sooner_falls_due_sooner(void) {
    for (uint32_t ahead_s = 1U; ahead_s <= PROBE; ahead_s++) {
        account = (elmopp_account_t){.due = 7U};
        elmopp_account_settle(&account, nothing, APPROACHES);
        elmopp_account_page(&account, ahead_s)->said = true;
        for (uint32_t n = 1U; n <= (2U * PROBE); n++) {
            second(nothing, NULL);
            TEST_ASSERT_EQUAL_UINT32((n < ahead_s) ? 0U : 1U, account.error.compared_s);
        }
    }
}

/* Each second is told apart: a different number is said in each, and each comes as it was said. */
static void test_every_second_is_compared_with_its_own(void) {
    for (uint32_t n = 0U; n < (5U * PROBE); n++) {
        const float came = (n < PROBE) ? 0.0F : (float)(n - PROBE);
        const float came_veh[APPROACHES] = {came, came, came};
        const float said = (float)n;
        const float said_veh[APPROACHES] = {said, said, said};
        second(came_veh, said_veh);
    }
    TEST_ASSERT_EQUAL_UINT32(4U * PROBE, account.error.compared_s);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, account.error.forecast);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, account.error.persistence);
}

static void test_the_last_thing_said_in_a_second_counts(void) {
    static const float first_veh[APPROACHES] = {9.0F, 9.0F, 9.0F};
    second(nothing, first_veh);
    elmopp_account_page(&account, PROBE)->forecast_veh[1] = 3.0F;
    for (uint32_t n = 0U; n < PROBE; n++) {
        second(nothing, NULL);
    }
    TEST_ASSERT_EQUAL_FLOAT((81.0F + 9.0F + 81.0F) / 3.0F, account.error.forecast);
}

static void test_errors_are_averages_that_forget_with_the_window(void) {
    static const float one[APPROACHES] = {1.0F, 1.0F, 1.0F};
    for (uint32_t n = 0U; n < (PROBE + 200U); n++) {
        second(nothing, one);
    }
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6F, 1.0F, account.error.forecast);
    for (uint32_t n = 0U; n < 200U; n++) {
        second(one, one);
    }
    /* 200 wrong, then 200 right: exact until 300, exponential after. */
    float right = 200.0F / 300.0F;
    for (uint32_t n = 300U; n < 400U; n++) {
        right -= right / 300.0F;
    }
    TEST_ASSERT_FLOAT_WITHIN(1.0e-5F, right, account.error.forecast);
}

static void test_seconds_compared_saturate(void) {
    second(nothing, nothing);
    account.error.compared_s = UINT32_MAX - 1U;
    for (uint32_t n = 0U; n < PROBE; n++) {
        second(nothing, nothing);
    }
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, account.error.compared_s);
    second(nothing, nothing);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, account.error.compared_s);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_what_is_said_falls_due_in_exactly_30_seconds);
    RUN_TEST(test_what_is_said_of_sooner_falls_due_sooner);
    RUN_TEST(test_every_second_is_compared_with_its_own);
    RUN_TEST(test_the_last_thing_said_in_a_second_counts);
    RUN_TEST(test_errors_are_averages_that_forget_with_the_window);
    RUN_TEST(test_seconds_compared_saturate);
    return UNITY_END();
}
