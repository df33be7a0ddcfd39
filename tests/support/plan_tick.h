/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// A plan's tick with demand by signal group, for junctions whose movements have one group each.

#ifndef ELMOPP_TEST_PLAN_TICK_H
#define ELMOPP_TEST_PLAN_TICK_H

#include "elmopp/plan.h"

/// Every movement of a group in `demand` waits, red as long as its group.
elmopp_lamps_t plan_tick(elmopp_plan_t *plan, elmopp_stage_t wanted, uint16_t demand);

#endif
