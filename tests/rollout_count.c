/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// One decision of the rollout at its dearest, in a function of its own, so that a profiler can count it:
///
///     valgrind --tool=callgrind --toggle-collect=decide_once --callgrind-out-file=/dev/null FILE
///
/// Eight stages and twelve movements (the paper's junction) with a constant saturation flow; somebody waits everywhere,
/// no two queues are the same, rows are foreseen for the whole horizon, and the stage shown may be kept or left.

#include "elmopp/rollout.h"

#include <stdio.h>

#define ROW_VEH 0.3F
#define SECONDS 60U /* of traffic before it, so that means and flows are learnt */

extern const elmopp_junction_t elmopp_site_paper;

/* The function that is counted: never inlined, as its address goes through a volatile pointer. */
static elmopp_stage_t decide_once(const elmopp_chooser_t *chooser, const elmopp_view_t *view, float *score) {
    return chooser->choose(chooser->state, view, score);
}

int main(void) {
    static elmopp_junction_t junction;
    static elmopp_rollout_t rollout;
    static float row_veh[ELMOPP_HORIZON_MAX];
    float queue_veh[ELMOPP_MOVEMENT_MAX] = {0.0F};
    float arrivals_veh[ELMOPP_MOVEMENT_MAX] = {0.0F};
    float share[ELMOPP_MOVEMENT_MAX] = {0.0F};
    float score[ELMOPP_STAGE_MAX];
    uint16_t red_ds[ELMOPP_MOVEMENT_MAX] = {0U};
    elmopp_stage_t (*volatile counted)(const elmopp_chooser_t *, const elmopp_view_t *, float *) = decide_once;

    junction = elmopp_site_paper;
    junction.discharge = (uint8_t)ELMOPP_DISCHARGE_SATURATION;
    const elmopp_rollout_options_t options = elmopp_rollout_defaults(0U);
    const elmopp_chooser_t chooser = elmopp_rollout_init(&rollout, &options);
    elmopp_view_t view = {.junction = &junction,
                          .queue_veh = queue_veh,
                          .arrivals_veh = arrivals_veh,
                          .share = share,
                          .red_ds = red_ds,
                          .foreseen_steps = chooser.horizon_s,
                          .stage = 0U,
                          .target = 0U};
    for (uint32_t k = 0U; k < ELMOPP_HORIZON_MAX; k++) {
        row_veh[k] = ROW_VEH;
    }
    for (uint32_t j = 0U; j < junction.movement_count; j++) {
        queue_veh[j] = 3.0F + (1.3F * (float)j);
        arrivals_veh[j] = 0.1F;
        share[j] = 1.0F / 3.0F;
        view.foreseen_veh[junction.movement[j].approach] = row_veh;
    }
    view.going = elmopp_junction_served(&junction, junction.stage_groups[0]);
    for (uint32_t t = 0U; t < SECONDS; t++) {
        (void)chooser.choose(chooser.state, &view, score);
    }
    view.elapsed_ds = 100U;
    const elmopp_stage_t wanted = counted(&chooser, &view, score);
    (void)printf("stage %u\n", (unsigned)wanted);
    return 0;
}
