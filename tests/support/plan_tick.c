/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "plan_tick.h"

#include "unity.h"

static uint32_t only_group(uint16_t groups) {
    uint32_t g = 0U;
    while ((g < ELMOPP_GROUP_MAX) && (groups != (uint16_t)(1U << g))) {
        g++;
    }
    TEST_ASSERT_LESS_THAN_MESSAGE(ELMOPP_GROUP_MAX, g, "the movement has no or several groups");
    return g;
}

uint32_t plan_movements(const elmopp_junction_t *junction, uint16_t demand) {
    uint32_t movements = 0U;
    for (uint32_t j = 0U; j < junction->movement_count; j++) {
        movements |= elmopp_mask_has(demand, only_group(junction->movement[j].groups)) ? ((uint32_t)1U << j) : 0U;
    }
    return movements;
}

elmopp_lamps_t plan_tick(elmopp_plan_t *plan, elmopp_stage_t wanted, uint16_t demand) {
    return elmopp_plan_step(plan, wanted, plan_movements(plan->junction, demand), false);
}
