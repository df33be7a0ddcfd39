/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/gaps.h"

#include "elmopp/elementary.h"

#include <stdint.h>

/* A table instead of two exponentials: a model asks in every second of every future that it plays. */
#define STEPS_PER_VEH_PER_S 32.0F
#define FLOWS 49U

float elmopp_gaps_flow(float opposing_veh_per_s) {
    static const float flow_veh_per_s[FLOWS] = {
        0.4F,           0.361278001F,   0.326138619F,   0.294267517F,   0.265376306F,   0.239200541F,   0.21549786F,
        0.194046266F,   0.174642523F,   0.157100682F,   0.141250702F,   0.126937184F,   0.11401819F,    0.102364158F,
        0.0918568928F,  0.0823886354F,  0.0738612005F,  0.0661851827F,  0.0592792217F,  0.0530693252F,  0.0474882442F,
        0.0424748966F,  0.0379738375F,  0.0339347708F,  0.0303120998F,  0.0270645147F,  0.0241546133F,  0.0215485525F,
        0.0192157292F,  0.0171284874F,  0.0152618503F,  0.013593274F,   0.012102424F,   0.0107709691F,  0.00958239463F,
        0.00852183097F, 0.00757589789F, 0.00673256236F, 0.00598100922F, 0.00531152349F, 0.00471538341F, 0.00418476327F,
        0.00371264525F, 0.0032927394F,  0.0029194112F,  0.00258761591F, 0.00229283918F, 0.00203104334F, 0.00179861889F};
    if (!(opposing_veh_per_s < ELMOPP_GAPS_OPPOSING_MAX_VEH_PER_S)) {
        return 0.0F;
    }
    const float place = elmopp_greater(opposing_veh_per_s, 0.0F) * STEPS_PER_VEH_PER_S;
    const uint32_t before = (uint32_t)place;
    const float beyond = place - (float)before;
    return flow_veh_per_s[before] + (beyond * (flow_veh_per_s[before + 1U] - flow_veh_per_s[before]));
}

float elmopp_gaps_shared(float saturation_veh_per_s, float through_veh_per_s, float share) {
    const float through = elmopp_within(through_veh_per_s, 0.0F, saturation_veh_per_s);
    const float weighed = (share * saturation_veh_per_s) + ((1.0F - share) * through);
    return (weighed > 0.0F) ? ((saturation_veh_per_s * through) / weighed) : 0.0F;
}
