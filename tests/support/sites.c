/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "sites.h"

const elmopp_junction_t *const test_sites[TEST_SITE_COUNT] = {
    &elmopp_site_paper,   &elmopp_site_four_way,   &elmopp_site_three_way,   &elmopp_site_five_way,
    &elmopp_site_one_way, &elmopp_site_left_lanes, &elmopp_site_shared_lanes};

static elmopp_movement_t movement(uint32_t index) {
    return (elmopp_movement_t){.name = "movement",
                               .capacity_veh = 10.0F,
                               .saturation_veh_per_s = 0.5F,
                               .startup_ds = 20U,
                               .groups = (uint16_t)(1U << index),
                               .approach = (uint8_t)(index % ELMOPP_APPROACH_MAX),
                               .lanes = 1U};
}

static elmopp_group_t group(void) {
    return (elmopp_group_t){.name = "group",
                            .amber_ds = CROSS_AMBER_DS,
                            .red_amber_ds = CROSS_RED_AMBER_DS,
                            .min_green_ds = CROSS_MIN_GREEN_DS,
                            .max_green_ds = CROSS_MAX_GREEN_DS};
}

elmopp_junction_t test_cross(uint32_t count) {
    const uint32_t approaches = (count < ELMOPP_APPROACH_MAX) ? count : ELMOPP_APPROACH_MAX;
    const uint16_t all = (uint16_t)((1U << count) - 1U);
    elmopp_junction_t cross = {.name = "cross",
                               .approach_count = (uint8_t)approaches,
                               .movement_count = (uint8_t)count,
                               .group_count = (uint8_t)count,
                               .stage_count = (uint8_t)count,
                               .hold_min_s = 10U,
                               .hold_max_s = 60U,
                               .red_bound_ds = CROSS_RED_BOUND_DS,
                               .cameras = (uint8_t)((1U << approaches) - 1U),
                               .program_count = 1U,
                               .reach_m = 100.0F};
    for (uint32_t i = 0U; i < approaches; i++) {
        cross.approach_name[i][0] = 'A';
    }
    cross.program[0].step_count = (uint8_t)count;
    for (uint32_t i = 0U; i < count; i++) {
        cross.rescue_stage[i] = (uint8_t)i;
        cross.program[0].step[i] = (elmopp_step_t){.green_ds = CROSS_PROGRAM_GREEN_DS, .stage = (uint8_t)i};
        cross.movement[i] = movement(i);
        cross.group[i] = group();
        cross.stage_groups[i] = (uint16_t)(1U << i);
        cross.conflict[i] = (uint16_t)(all & ~(1U << i));
        for (uint32_t h = 0U; h < count; h++) {
            cross.intergreen_ds[i][h] = (i == h) ? 0U : (uint16_t)CROSS_INTERGREEN_DS;
        }
    }
    return cross;
}

void test_rescue_program(elmopp_junction_t *junction, uint16_t green_ds) {
    elmopp_program_t *program = &junction->program[0];
    uint32_t stages = 0U;
    junction->program_count = 1U;
    program->step_count = 0U;
    for (uint32_t j = 0U; j < junction->movement_count; j++) {
        const uint8_t stage = junction->rescue_stage[j];
        if (!elmopp_mask_has(stages, stage)) {
            stages |= 1U << stage;
            program->step[program->step_count] = (elmopp_step_t){.green_ds = green_ds, .stage = stage};
            program->step_count++;
        }
    }
}
