/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "debounce.h"

void elmopp_debounce_init(elmopp_debounce_t *self, uint32_t now_ms) {
    *self = (elmopp_debounce_t){.held = false, .since_ms = now_ms};
}

bool elmopp_debounce_look(elmopp_debounce_t *self, bool closed, uint32_t now_ms) {
    if (closed == self->held) {
        self->since_ms = now_ms;
    } else if ((now_ms - self->since_ms) >= ELMOPP_DEBOUNCE_MS) {
        self->held = closed;
        self->since_ms = now_ms;
    } else {
        /* perhaps it bounces */
    }
    return self->held;
}
