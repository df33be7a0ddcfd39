/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// A plan's tick with demand by signal group, for junctions whose movements have one group each.

#ifndef ELMOPP_TEST_PLAN_TICK_H
#define ELMOPP_TEST_PLAN_TICK_H

#include "elmopp/plan.h"

/// Mask of the movements whose group is in the mask of groups.
uint32_t plan_movements(const elmopp_junction_t *junction, uint16_t demand);

/// Somebody asks for every group in `demand`; nobody stands in the junction.
elmopp_lamps_t plan_tick(elmopp_plan_t *plan, elmopp_stage_t wanted, uint16_t demand);

#endif
