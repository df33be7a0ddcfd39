/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/pressure.h"

#include "elmopp/assert.h"

static float stage_pressure(const elmopp_view_t *view, uint32_t stage) {
    const uint16_t groups = view->junction->stage_groups[stage];
    float sum = 0.0F;
    for (uint32_t j = 0U; j < view->junction->movement_count; j++) {
        if (elmopp_junction_goes(view->junction, j, groups)) {
            const float queue_veh = view->queue_veh[j];
            sum += queue_veh * elmopp_junction_discharge(view->junction, j, queue_veh);
        }
    }
    return sum;
}

static elmopp_stage_t choose_by_pressure(void *state, const elmopp_view_t *view, float score[ELMOPP_STAGE_MAX]) {
    const elmopp_pressure_t *self = state;
    elmopp_stage_t best = 0U;
    for (uint32_t s = 0U; s < ELMOPP_STAGE_MAX; s++) {
        score[s] = (s < view->junction->stage_count) ? stage_pressure(view, s) : 0.0F;
        if (score[s] > score[best]) {
            best = (elmopp_stage_t)s;
        }
    }
    if (view->stage == ELMOPP_STAGE_NONE) {
        return (view->target == ELMOPP_STAGE_NONE) ? best : view->target;
    }
    const uint32_t elapsed_s = (uint32_t)view->elapsed_ds / ELMOPP_LAMP_TICKS_PER_S;
    if (elapsed_s < self->min_s) {
        return view->stage;
    }
    const bool leave = (elapsed_s >= self->max_s) || (score[best] > (self->ratio * score[view->stage]));
    return leave ? best : view->stage;
}

elmopp_chooser_t elmopp_pressure_init(elmopp_pressure_t *self) {
    ELMOPP_ASSERT((self->min_s <= self->max_s) && (self->ratio >= 1.0F));
    return (elmopp_chooser_t){.choose = choose_by_pressure, .state = self, .horizon_s = 0U};
}
