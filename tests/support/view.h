/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// A chooser's view with arrays of its own, for tests of choosers.

#ifndef ELMOPP_TEST_VIEW_H
#define ELMOPP_TEST_VIEW_H

#include "elmopp/chooser.h"

typedef struct {
    elmopp_view_t view;
    float queue_veh[ELMOPP_MOVEMENT_MAX];
    float arrivals_veh[ELMOPP_MOVEMENT_MAX];
    float share[ELMOPP_MOVEMENT_MAX];
    uint16_t red_ds[ELMOPP_MOVEMENT_MAX];
    float score[ELMOPP_STAGE_MAX];
    float beyond_score; ///< must stay as it is
} test_view_t;

/// Before the first decision: no vehicle, no forecast, no stage. Every share is 1.
void test_view_init(test_view_t *self, const elmopp_junction_t *junction);

/// Shows `stage` (not ELMOPP_STAGE_NONE) for so long; its movements are green.
void test_view_show(test_view_t *self, elmopp_stage_t stage, uint32_t elapsed_ds);

/// In the intergreen to `target`: nothing is green.
void test_view_clear_to(test_view_t *self, elmopp_stage_t target);

/// Any stage for up to 90 s, or in one of eight cases an intergreen to it.
void test_view_show_any(test_view_t *self, uint64_t *random);

/// A count of vehicles: mostly what a street has, in one of four cases up to a million.
float test_view_any_count(uint64_t *random);

/// Asks the chooser with every score preset to garbage. Fails if it names no stage that exists, or writes beyond the
/// scores.
elmopp_stage_t test_view_ask(test_view_t *self, const elmopp_chooser_t *chooser);

/// Asks both. Fails if their stages differ, or a bit of their scores.
elmopp_stage_t test_view_ask_both(test_view_t *self, const elmopp_chooser_t *one, const elmopp_chooser_t *other);

#endif
