/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Age: how much more a vehicle counts the longer its movement has not been green (the paper's exponential of T).
///
/// One function, no state, nothing decided. It is a room of its own because two choosers weigh by it, urgency.h and
/// priced.h, and choosers do not know each other.

#ifndef ELMOPP_AGE_H
#define ELMOPP_AGE_H

#include <stdint.h>

/// The exponent T/t_max - 1 is taken as this at most, so that no sum can overflow: e^64 is 6e27.
#define ELMOPP_AGE_EXPONENT_MAX 64.0F

/// e^(T/t_max - 1): e^-1 on green, 1 after t_max of red (the paper's equation U_t with the sign that its text means;
/// docs/algorithm.md). red_ds is T in tenths of a second, max_s is t_max in seconds and at least 1. No unit; never 0.
float elmopp_age_factor(uint16_t red_ds, uint16_t max_s);

#endif
