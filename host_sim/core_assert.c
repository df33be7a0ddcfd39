/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/assert.h"

#include <stdio.h>
#include <stdlib.h>

/* host_sim's port of the core's assert: a bug ends the process at once, with its place. */
void elmopp_assert_failed(const char *file, int line) {
    (void)fprintf(stderr, "host_sim: a promise of the core is broken at %s:%d; this is a bug\n", file, line);
    abort();
}
