/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "fuzz_input.h"

#include "unity.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
void setUp(void);
void tearDown(void);

/* Unity asks for these. */
void setUp(void) {}
void tearDown(void) {}

/* An assert of the core and the bench's own complaints arrive as a failed test of Unity's. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_input_t input = {data, size};
    Unity.CurrentTestName = "fuzz";
    Unity.CurrentTestFailed = 0U;
    if (TEST_PROTECT()) {
        fuzz_try(&input);
    }
    FUZZ_CHECK(Unity.CurrentTestFailed == 0U);
    return 0;
}
