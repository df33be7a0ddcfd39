/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "seal.h"

#include "elmopp/image.h"

#include <stdint.h>

extern const uint8_t elmopp_image_start[]; /* from the linker script */
extern const uint8_t elmopp_seal[];

/* Filled in after linking; volatile, so that nobody compiles the zero in. */
__attribute__((section(".seal"), used)) static const volatile uint32_t sealed_sum = 0U;

bool elmopp_seal_is_whole(void) {
    const uint32_t length = (uint32_t)((uintptr_t)elmopp_seal - (uintptr_t)elmopp_image_start);
    return ~elmopp_image_sum(ELMOPP_IMAGE_SUM_START, elmopp_image_start, length) == sealed_sum;
}
