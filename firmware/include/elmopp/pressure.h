/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Pressure: a chooser that weighs each stage by sum of queue times flow (after Varaiya's max pressure without
/// downstream).
///
/// P(stage) = sum over its movements of Q q(Q), q from elmopp_junction_discharge(). After min_s it leaves for the stage
/// b with the highest P when P(b) > h P(active); at max_s it leaves if b is another stage. Ties go to the lowest index.
/// It needs no forecast and has no bound on red of its own: a quiet movement can wait long (docs/algorithm.md has the
/// figures).
///
/// State: its three parameters. Not thread-safe; one owner.

#ifndef ELMOPP_PRESSURE_H
#define ELMOPP_PRESSURE_H

#include "elmopp/chooser.h"

#define ELMOPP_PRESSURE_RATIO 3.0F ///< h of the specification
#define ELMOPP_PRESSURE_MIN_S 5U
#define ELMOPP_PRESSURE_MAX_S 120U

typedef struct {
    float ratio; ///< h >= 1
    uint16_t min_s;
    uint16_t max_s;
} elmopp_pressure_t;

/// Returns the chooser that uses `self`, whose members the caller has set. Asserts min_s <= max_s and ratio >= 1.
elmopp_chooser_t elmopp_pressure_init(elmopp_pressure_t *self);

#endif
