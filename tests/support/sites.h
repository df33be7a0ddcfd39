/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The generated sites, and small made-up junctions for tests.

#ifndef ELMOPP_TEST_SITES_H
#define ELMOPP_TEST_SITES_H

#include "elmopp/junction.h"

extern const elmopp_junction_t elmopp_site_paper;
extern const elmopp_junction_t elmopp_site_four_way;
extern const elmopp_junction_t elmopp_site_shared_lanes;
extern const elmopp_junction_t elmopp_site_three_way;
extern const elmopp_junction_t elmopp_site_five_way;
extern const elmopp_junction_t elmopp_site_left_lanes;
extern const elmopp_junction_t elmopp_site_one_way;

#define TEST_SITE_COUNT 7U

/// All generated sites.
extern const elmopp_junction_t *const test_sites[TEST_SITE_COUNT];

/// Times that test_cross() gives to all of its groups, and its intergreens, in tenths of a second.
#define CROSS_AMBER_DS 30U
#define CROSS_RED_AMBER_DS 10U
#define CROSS_MIN_GREEN_DS 50U
#define CROSS_MAX_GREEN_DS 200U
#define CROSS_INTERGREEN_DS 55U
#define CROSS_RED_BOUND_DS 6000U
#define CROSS_PROGRAM_GREEN_DS 80U

/// A valid street of `count` (1..16) approaches with one movement and one group each. All groups conflict, so stage i
/// is group i. Capacity 10 vehicles, saturation flow 0.5 vehicles a second.
elmopp_junction_t test_cross(uint32_t count);

/// Gives a junction one programme: its rescue stages, each once, in the order of the movements.
void test_rescue_program(elmopp_junction_t *junction, uint16_t green_ds);

#endif
