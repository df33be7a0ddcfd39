/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Supplies elmopp_assert_failed() to the tests: an expected assert is caught, any other fails the running test.

#ifndef ELMOPP_TEST_ASSERT_CATCHER_H
#define ELMOPP_TEST_ASSERT_CATCHER_H

#include "elmopp/assert.h"
#include "unity.h"

#include <setjmp.h>

/// Where to go on after the next assert. Use through TEST_EXPECT_ASSERT only.
extern jmp_buf assert_catcher_place;

/// Says whether the next assert is expected.
void assert_catcher_arm(int expected);

/// Fails the running test unless the statement ends in an assert of the core.
#define TEST_EXPECT_ASSERT(statement)                                                                                  \
    do {                                                                                                               \
        if (setjmp(assert_catcher_place) == 0) {                                                                       \
            assert_catcher_arm(1);                                                                                     \
            statement;                                                                                                 \
            assert_catcher_arm(0);                                                                                     \
            TEST_FAIL_MESSAGE("no assert: " #statement);                                                               \
        }                                                                                                              \
    } while (0)

#endif
