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

elmopp_lamps_t plan_tick(elmopp_plan_t *plan, elmopp_stage_t wanted, uint16_t demand) {
    uint16_t red_ds[ELMOPP_MOVEMENT_MAX] = {0U};
    elmopp_waiting_t waiting = {.movements = 0U, .red_ds = red_ds};
    for (uint32_t j = 0U; j < plan->junction->movement_count; j++) {
        const uint32_t g = only_group(plan->junction->movement[j].groups);
        red_ds[j] = plan->group[g].since_green_ds;
        waiting.movements |= elmopp_mask_has(demand, g) ? ((uint32_t)1U << j) : 0U;
    }
    return elmopp_plan_step(plan, wanted, &waiting);
}
