/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/outflow.h"

#define SOON_S 10U
#define LATER_S 30U
#define LAST_S 60U

bool elmopp_outflow_is_known(const elmopp_outflow_t *self) {
    return self->ahead_s > self->age_s;
}

static uint32_t sooner(uint32_t one, uint32_t other) {
    return (one < other) ? one : other;
}

/* Seconds from_s to end_s after it was said, of which the row begins at age_s. */
static void spread(const elmopp_outflow_t *self, uint32_t from_s, uint32_t until_s, float vehicles, float *row_veh,
                   uint32_t steps) {
    const uint32_t end_s = sooner(until_s, self->ahead_s);
    const uint32_t seconds = end_s - sooner(from_s, end_s);
    const float each_veh = ((seconds > 0U) && (vehicles > 0.0F)) ? (vehicles / (float)seconds) : 0.0F;
    for (uint32_t k = 0U; k < seconds; k++) {
        const uint32_t at_s = from_s + k;
        if ((at_s >= self->age_s) && ((at_s - self->age_s) < steps)) {
            row_veh[at_s - self->age_s] = each_veh;
        }
    }
}

void elmopp_outflow_lay(const elmopp_outflow_t *self, float *row_veh, uint32_t steps) {
    spread(self, 0U, SOON_S, self->next10_veh, row_veh, steps);
    spread(self, SOON_S, LATER_S, self->next30_veh - self->next10_veh, row_veh, steps);
    spread(self, LATER_S, LAST_S, self->next60_veh - self->next30_veh, row_veh, steps);
}
