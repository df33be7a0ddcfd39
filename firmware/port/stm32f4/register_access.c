/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "register_access.h"

uint32_t elmopp_register_read(const elmopp_register_t *place) {
    return *place;
}

void elmopp_register_write(elmopp_register_t *place, uint32_t value) {
    *place = value;
}
