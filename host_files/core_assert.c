/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/assert.h"

#include <stdio.h>
#include <stdlib.h>

/* The core's assert on a computer: a bug ends the process at once, with its place. */
void elmopp_assert_failed(const char *file, int line) {
    (void)fprintf(stderr, "elmopp: a promise of the core is broken at %s:%d; this is a bug\n", file, line);
    abort();
}
