/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "note.h"

#include <stdint.h>

#define FAULT 0x464C5421U

extern volatile uint32_t elmopp_note[2]; /* from the linker script: outside of everything that is cleared or tested */

void elmopp_note_fault(void) {
    elmopp_note[0] = FAULT;
    elmopp_note[1] = ~FAULT;
}

bool elmopp_note_take(void) {
    const bool noted = (elmopp_note[0] == FAULT) && (elmopp_note[1] == ~FAULT);
    elmopp_note[0] = 0U;
    elmopp_note[1] = 0U;
    return noted;
}
