/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// An image of any length and any bytes, for a body of any size up to sixteen bytes: nothing beyond its end is read,
/// and what passes is as long as its kind says, so that a loader may copy the body. The loop over the body does not
/// know its bound; a site's 2,212 bytes are tried by the fuzzer.

#include "claims.h"

#include "elmopp/image.h"

#include <stdlib.h>

#define BODY_MAX 16U

elmopp_image_kind_t nondet_kind(void);

void harness(void) {
    const elmopp_image_kind_t kind = nondet_kind();
    ASSUME(kind.body_bytes <= BODY_MAX);
    const uint32_t length = nondet_u32();
    ASSUME(length <= (ELMOPP_IMAGE_HEADER + BODY_MAX + 1U));
    const uint8_t *image = malloc(length);
    ASSUME(image != NULL);
    const bool passed = elmopp_image_check(&kind, image, length) == ELMOPP_IMAGE_OK;
    CLAIM((!passed) || (length == (ELMOPP_IMAGE_HEADER + kind.body_bytes)), "what passes has its kind's length");
    if (passed) {
        REACHABLE();
    }
}
