/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/age.h"

#include "elmopp/assert.h"
#include "elmopp/elementary.h"

#define DS_PER_S 10.0F

float elmopp_age_factor(uint16_t red_ds, uint16_t max_s) {
    ELMOPP_ASSERT(max_s >= 1U);
    const float exponent = ((float)red_ds / (DS_PER_S * (float)max_s)) - 1.0F;
    return elmopp_exp((exponent < ELMOPP_AGE_EXPONENT_MAX) ? exponent : ELMOPP_AGE_EXPONENT_MAX);
}
