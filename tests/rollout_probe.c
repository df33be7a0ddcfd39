/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The rollout of the core as a program, for tests/python/test_rollout_reference.py: rollout_probe < INPUT
///
/// Reads float32 numbers, little-endian: a junction with one signal group a movement, the options that vary, and second
/// after second what a view holds. Writes the answer, the scores of all stages and the red clocks of all movements
/// after the last one. The order is that of the functions below.
///
/// rollout_probe gaps < INPUT: reads a count and so many opposing flows, writes what gaps in each let through.
///
/// Exit status 1: the input ends too early, or holds more than a junction may have.

#include "elmopp/gaps.h"
#include "elmopp/rollout.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static elmopp_junction_t junction;
static elmopp_rollout_options_t options;
static elmopp_rollout_t rollout;
static uint32_t seconds;
static uint16_t steps;

static float queue_veh[ELMOPP_MOVEMENT_MAX];
static float arrivals_veh[ELMOPP_MOVEMENT_MAX];
static float share[ELMOPP_MOVEMENT_MAX];
static uint16_t red_ds[ELMOPP_MOVEMENT_MAX];
static float row_veh[ELMOPP_APPROACH_MAX][ELMOPP_HORIZON_MAX];

static _Noreturn void give_up(const char *what) {
    (void)fprintf(stderr, "rollout_probe: %s\n", what);
    exit(1);
}

static float next(void) {
    float value = 0.0F;
    if (fread(&value, sizeof value, 1U, stdin) != 1U) {
        give_up("the input ends too early");
    }
    return value;
}

/* A whole number of at most `most`. */
static uint32_t next_whole(uint32_t most) {
    const float value = next();
    if (!((value >= 0.0F) && (value <= (float)most))) {
        give_up("a number is out of range");
    }
    return (uint32_t)value;
}

static void read_movement(uint32_t j) {
    elmopp_movement_t *movement = &junction.movement[j];
    movement->saturation_veh_per_s = next();
    movement->startup_ds = (uint16_t)next_whole(UINT16_MAX);
    movement->capacity_veh = next();
    movement->lanes = (uint8_t)next_whole(UINT8_MAX);
    movement->approach = (uint8_t)next_whole(ELMOPP_APPROACH_MAX - 1U);
    movement->groups = (uint16_t)(1U << j);
    junction.group[j].amber_ds = (uint16_t)next_whole(UINT16_MAX);
    for (uint32_t h = 0U; h < junction.group_count; h++) {
        junction.intergreen_ds[j][h] = (uint16_t)next_whole(UINT16_MAX);
    }
    junction.gives_way[j] = next_whole(UINT16_MAX);
    movement->gives_way_percent = (uint8_t)next_whole(100U);
}

static void read_junction(void) {
    junction.approach_count = (uint8_t)next_whole(ELMOPP_APPROACH_MAX);
    junction.movement_count = (uint8_t)next_whole(ELMOPP_GROUP_MAX);
    junction.group_count = junction.movement_count;
    junction.stage_count = (uint8_t)next_whole(ELMOPP_STAGE_MAX);
    junction.discharge = (uint8_t)next_whole(ELMOPP_DISCHARGE_NOLOCK);
    junction.free_flow_m_per_s = next();
    for (uint32_t j = 0U; j < junction.movement_count; j++) {
        read_movement(j);
    }
    for (uint32_t s = 0U; s < junction.stage_count; s++) {
        junction.stage_groups[s] = (uint16_t)next_whole(UINT16_MAX);
    }
}

static void read_options(void) {
    options = elmopp_rollout_defaults((uint16_t)next_whole(ELMOPP_SIGHT_TRAVEL_MAX_S));
    options.coming.horizon_s = (uint16_t)next_whole(ELMOPP_HORIZON_MAX);
    options.red_s = (uint16_t)next_whole(UINT16_MAX);
    options.coming.row_weight = next();
    options.coming.weigh_skill = next_whole(1U) != 0U;
    options.others_max = (uint8_t)next_whole(ELMOPP_STAGE_MAX);
    options.caution = next();
    seconds = next_whole(UINT16_MAX);
    steps = (uint16_t)next_whole(ELMOPP_HORIZON_MAX);
}

/* A stage's index, or ELMOPP_STAGE_NONE. */
static elmopp_stage_t next_stage(void) {
    return (elmopp_stage_t)next_whole(ELMOPP_STAGE_NONE);
}

static elmopp_view_t read_second(void) {
    elmopp_view_t view = {.junction = &junction,
                          .queue_veh = queue_veh,
                          .arrivals_veh = arrivals_veh,
                          .share = share,
                          .red_ds = red_ds,
                          .foreseen_steps = steps};
    view.stage = next_stage();
    view.target = next_stage();
    view.elapsed_ds = (uint16_t)next_whole(UINT16_MAX);
    const bool shown = view.stage < junction.stage_count;
    view.going = shown ? elmopp_junction_served(&junction, junction.stage_groups[view.stage]) : 0U;
    for (uint32_t j = 0U; j < junction.movement_count; j++) {
        queue_veh[j] = next();
        arrivals_veh[j] = next();
        share[j] = next();
    }
    for (uint32_t i = 0U; i < junction.approach_count; i++) {
        view.foreseen_veh[i] = (steps > 0U) ? row_veh[i] : NULL;
        for (uint32_t t = 0U; t < steps; t++) {
            row_veh[i][t] = next();
        }
    }
    return view;
}

static void put(float value) {
    if (fwrite(&value, sizeof value, 1U, stdout) != 1U) {
        give_up("nothing can be written");
    }
}

static void put_decision(void) {
    read_junction();
    read_options();
    const elmopp_chooser_t chooser = elmopp_rollout_init(&rollout, &options);
    float score[ELMOPP_STAGE_MAX] = {0.0F};
    elmopp_stage_t answer = ELMOPP_STAGE_NONE;
    for (uint32_t t = 0U; t < seconds; t++) {
        const elmopp_view_t view = read_second();
        answer = chooser.choose(chooser.state, &view, score);
    }
    put((float)answer);
    for (uint32_t s = 0U; s < junction.stage_count; s++) {
        put(score[s]);
    }
    for (uint32_t j = 0U; j < junction.movement_count; j++) {
        put((float)rollout.sight.red_s[j]);
    }
}

static void put_gaps(void) {
    const uint32_t count = next_whole(UINT16_MAX);
    for (uint32_t i = 0U; i < count; i++) {
        put(elmopp_gaps_flow(next()));
    }
}

int main(int count, char **words) {
    if ((count > 1) && (strcmp(words[1], "gaps") == 0)) {
        put_gaps();
    } else {
        put_decision();
    }
    if (fflush(stdout) != 0) {
        give_up("nothing can be written");
    }
    return 0;
}
