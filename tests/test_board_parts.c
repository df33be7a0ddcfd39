/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// What of a board's main needs no board: the grid of lamp ticks.

#include "grid.h"

#include "unity.h"

static elmopp_grid_t grid;

void setUp(void) {}
void tearDown(void) {}

static void test_ticks_keep_to_the_grid_however_late_they_are_done(void) {
    elmopp_grid_init(&grid, 7U);
    TEST_ASSERT_TRUE(elmopp_grid_due(&grid, 7U));
    for (uint32_t k = 1U; k < 1000U; k++) {
        const uint32_t due_ms = 7U + (k * 100U);
        TEST_ASSERT_FALSE(elmopp_grid_due(&grid, due_ms - 1U));
        TEST_ASSERT_TRUE(elmopp_grid_due(&grid, due_ms + (k % 100U)));
    }
    TEST_ASSERT_EQUAL_UINT32(0U, grid.missed);
}

static void test_missed_ticks_are_left_out_and_counted(void) {
    elmopp_grid_init(&grid, 0U);
    TEST_ASSERT_TRUE(elmopp_grid_due(&grid, 0U));
    TEST_ASSERT_TRUE(elmopp_grid_due(&grid, 399U)); /* 100, 200 and 300 */
    TEST_ASSERT_EQUAL_UINT32(2U, grid.missed);
    TEST_ASSERT_FALSE(elmopp_grid_due(&grid, 399U));
    TEST_ASSERT_TRUE(elmopp_grid_due(&grid, 400U));
    TEST_ASSERT_EQUAL_UINT32(2U, grid.missed);
}

static void test_the_clock_may_wrap(void) {
    elmopp_grid_init(&grid, UINT32_MAX - 49U);
    TEST_ASSERT_TRUE(elmopp_grid_due(&grid, UINT32_MAX - 49U));
    TEST_ASSERT_FALSE(elmopp_grid_due(&grid, UINT32_MAX));
    TEST_ASSERT_FALSE(elmopp_grid_due(&grid, 49U));
    TEST_ASSERT_TRUE(elmopp_grid_due(&grid, 50U));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_ticks_keep_to_the_grid_however_late_they_are_done);
    RUN_TEST(test_missed_ticks_are_left_out_and_counted);
    RUN_TEST(test_the_clock_may_wrap);
    return UNITY_END();
}
