/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Any lane at the end of a second: it is trusted after five good seconds and not before, and a second without a frame
/// for more than three seconds, with a jump, or of a movement that the camera marks, is not good.

#include "detector.c"

#include "arbitrary.h"

#define STALE_S 3U
#define RECOVER_S 5U

elmopp_detector_lane_t nondet_lane(void);

void harness(void) {
    const elmopp_junction_t junction = nondet_junction();
    const elmopp_detector_lane_t before = nondet_lane();
    elmopp_detector_lane_t lane = before;
    close_lane(&junction, &lane, nondet_bool());

    const bool bad = (before.age_s > STALE_S) || before.jumped || (!before.valid);
    const uint32_t more_s = (before.good_s < UINT16_MAX) ? (before.good_s + 1U) : before.good_s;
    CLAIM((!bad) || (lane.good_s == 0U), "a bad second starts anew");
    CLAIM((lane.good_s == 0U) || (lane.good_s == more_s), "a second is one second");
    CLAIM(is_trusted(&lane) == (lane.good_s >= RECOVER_S), "five good seconds are trusted");
    REACHABLE();
}
