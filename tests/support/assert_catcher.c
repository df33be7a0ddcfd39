/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "assert_catcher.h"

#include <stdio.h>
#include <stdlib.h>

jmp_buf assert_catcher_place;

static int is_expected;

void assert_catcher_arm(int expected) {
    is_expected = expected;
}

void elmopp_assert_failed(const char *file, int line) {
    if (is_expected != 0) {
        is_expected = 0;
        longjmp(assert_catcher_place, 1);
    }
    char message[200];
    (void)snprintf(message, sizeof message, "assert of the core at %s:%d", file, line);
    TEST_FAIL_MESSAGE(message);
    abort();
}
