/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/sight.h"

#include "elmopp/assert.h"
#include "elmopp/elementary.h"
#include "elmopp/gaps.h"

#define MEAN_WINDOW_S 120U
#define BLOCK_S 8U
#define PRIOR_S 30.0F
#define FORGET_PER_S (1.0F / 600.0F)

#define FULL_SHARE 0.85F      /* of the capacity: the reach hides who stands behind it */
#define LEAST_FLOW_SHARE 0.1F /* of the site's saturation flow, whatever is learnt */
#define MOST_FLOW_SHARE 1.4F
#define STANDING_VEH_PER_LANE 2.0F /* a queue so long leaves at saturation flow */
#define QUEUED_VEH 1.0F            /* somebody is queued */
#define SOMEBODY_VEH 0.5F          /* somebody is there: a count may be part of a vehicle */
#define LEFT_VEH 0.01F             /* somebody has left: less may be rounding */
#define TOP_SHARE 0.25F            /* the parabola k (1 - k) at its highest */
#define PERCENT 100.0F
#define SETTLE_DS 10U /* after the start-up, until departures tell of the saturation flow */

uint16_t elmopp_sight_travel_s(const elmopp_junction_t *junction, uint32_t movement) {
    const float limit_km_per_h = (float)elmopp_junction_limit_km_per_h(junction, movement);
    const float free_s = junction->reach_m / (limit_km_per_h * ELMOPP_SIGHT_FREE_FLOW_M_PER_S_PER_KM_PER_H);
    const float rounded_s = elmopp_within(free_s, 0.0F, (float)ELMOPP_SIGHT_TRAVEL_MAX_S) + 0.5F;
    return (uint16_t)rounded_s;
}

elmopp_sight_options_t elmopp_sight_defaults(uint16_t travel_s) {
    elmopp_sight_options_t options = {.mean_window_s = MEAN_WINDOW_S,
                                      .block_s = BLOCK_S,
                                      .prior_s = PRIOR_S,
                                      .forget_per_s = FORGET_PER_S,
                                      .gives_way = true};
    for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
        options.travel_s[j] = travel_s;
    }
    return options;
}

elmopp_sight_options_t elmopp_sight_of_site(const elmopp_junction_t *junction) {
    elmopp_sight_options_t options;
    options = elmopp_sight_defaults((uint16_t)ELMOPP_SIGHT_TRAVEL_MAX_S);
    for (uint32_t j = 0U; j < junction->movement_count; j++) {
        options.travel_s[j] = elmopp_sight_travel_s(junction, j);
    }
    return options;
}

static bool learns(const elmopp_junction_t *junction) {
    return junction->discharge == (uint8_t)ELMOPP_DISCHARGE_SATURATION;
}

static float site_flow(const elmopp_junction_t *junction, uint32_t movement) {
    return learns(junction) ? junction->movement[movement].saturation_veh_per_s
                            : (junction->free_flow_m_per_s * TOP_SHARE);
}

/* --- who gives way --- */

uint32_t elmopp_sight_foes(const elmopp_sight_t *self, uint32_t stage, uint32_t movement) {
    return self->junction->gives_way[movement] & self->serves[stage];
}

float elmopp_sight_yielding_share(const elmopp_sight_t *self, uint32_t movement) {
    return (float)self->junction->movement[movement].gives_way_percent / PERCENT;
}

float elmopp_sight_first_share(const elmopp_sight_t *self, uint32_t stage, uint32_t movement) {
    return elmopp_mask_has(self->yields[stage], movement) ? (1.0F - elmopp_sight_yielding_share(self, movement)) : 1.0F;
}

float elmopp_sight_through(const elmopp_sight_t *self, uint32_t movement, float flow_veh_per_s,
                           float opposing_veh_per_s) {
    const float lanes = (float)self->junction->movement[movement].lanes;
    const float through = lanes * elmopp_gaps_flow(opposing_veh_per_s);
    return elmopp_gaps_shared(flow_veh_per_s, through, elmopp_sight_yielding_share(self, movement));
}

static void find_who_yields(elmopp_sight_t *self, uint32_t stage) {
    for (uint32_t j = 0U; self->options.gives_way && (j < self->junction->movement_count); j++) {
        const bool goes = elmopp_mask_has(self->serves[stage], j);
        self->yields[stage] |= (goes && (elmopp_sight_foes(self, stage, j) != 0U)) ? ((uint32_t)1U << j) : 0U;
    }
}

/* The mean arrivals of those who go first. */
static float opposing_mean(const elmopp_sight_t *self, uint32_t stage, uint32_t movement) {
    const uint32_t foes = elmopp_sight_foes(self, stage, movement);
    float sum = 0.0F;
    for (uint32_t f = 0U; f < self->junction->movement_count; f++) {
        if (elmopp_mask_has(foes, f)) {
            sum += elmopp_sight_first_share(self, stage, f) * self->mean_veh_per_s[f];
        }
    }
    return sum;
}

float elmopp_sight_usual(const elmopp_sight_t *self, uint32_t stage, uint32_t movement) {
    const float flow = self->flow_veh_per_s[stage][movement];
    const bool yields = elmopp_mask_has(self->yields[stage], movement);
    return yields ? elmopp_sight_through(self, movement, flow, opposing_mean(self, stage, movement)) : flow;
}

/* The movements that gave way in the last second to somebody who was there when it began. */
static uint32_t held_up(const elmopp_sight_t *self, uint32_t stage) {
    if (self->yields[stage] == 0U) {
        return 0U;
    }
    uint32_t there = 0U;
    uint32_t held = 0U;
    for (uint32_t f = 0U; f < self->junction->movement_count; f++) {
        there |= (self->present_veh[f] > 0.0F) ? ((uint32_t)1U << f) : 0U;
    }
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const bool foes = (elmopp_sight_foes(self, stage, j) & there) != 0U;
        held |= (foes && elmopp_mask_has(self->yields[stage], j)) ? ((uint32_t)1U << j) : 0U;
    }
    return held;
}

/* --- the counts --- */

void elmopp_sight_init(elmopp_sight_t *self, const elmopp_junction_t *junction, const elmopp_sight_options_t *options) {
    ELMOPP_ASSERT(options->mean_window_s >= 1U);
    ELMOPP_ASSERT((options->prior_s > 0.0F) && (options->forget_per_s >= 0.0F) && (options->forget_per_s <= 1.0F));
    *self = (elmopp_sight_t){.options = *options, .junction = junction, .stage = ELMOPP_STAGE_NONE};
    for (uint32_t j = 0U; j < junction->movement_count; j++) {
        ELMOPP_ASSERT(options->travel_s[j] <= ELMOPP_SIGHT_TRAVEL_MAX_S);
        self->site_veh_per_s[j] = site_flow(junction, j);
    }
    for (uint32_t s = 0U; s < junction->stage_count; s++) {
        self->serves[s] = elmopp_junction_served(junction, junction->stage_groups[s]);
        for (uint32_t j = 0U; j < junction->movement_count; j++) {
            self->flow_veh_per_s[s][j] = elmopp_mask_has(self->serves[s], j) ? self->site_veh_per_s[j] : 0.0F;
        }
        find_who_yields(self, s);
    }
}

/* Who is due first has left first, until no more drive than are there. Returns who still drive. */
static float drop_excess(float *due_veh, uint32_t travel_s, float present_veh) {
    float driving_veh = 0.0F;
    for (uint32_t t = 0U; t < travel_s; t++) {
        driving_veh += due_veh[t];
    }
    float excess_veh = driving_veh - present_veh;
    for (uint32_t t = 0U; t < travel_s; t++) {
        const float leaving_veh = (excess_veh > 0.0F) ? elmopp_lesser(excess_veh, due_veh[t]) : 0.0F;
        due_veh[t] -= leaving_veh;
        driving_veh -= leaving_veh;
        excess_veh -= leaving_veh;
    }
    return driving_veh;
}

static void drive_on(elmopp_sight_t *self, uint32_t movement, float arrived_veh, float present_veh) {
    float *due_veh = self->due_veh[movement];
    const uint32_t travel_s = self->options.travel_s[movement];
    for (uint32_t t = 1U; t < travel_s; t++) {
        due_veh[t - 1U] = due_veh[t];
    }
    if (travel_s > 0U) {
        due_veh[travel_s - 1U] = arrived_veh;
    }
    const float queued_veh = present_veh - drop_excess(due_veh, travel_s, present_veh);
    self->queued_veh[movement] = elmopp_greater(queued_veh, 0.0F);
    self->present_veh[movement] = present_veh;
}

/* The mean arrivals, and who should have come and was not seen because the reach is full. */
static void expect(elmopp_sight_t *self, uint32_t movement, float arrived_veh) {
    const float capacity_veh = self->junction->movement[movement].capacity_veh;
    const bool reach = (self->options.travel_s[movement] > 0U) && (capacity_veh > 0.0F);
    const bool full = reach && (self->present_veh[movement] >= (FULL_SHARE * capacity_veh));
    float *mean = &self->mean_veh_per_s[movement];
    const float missing_veh = *mean - arrived_veh;
    self->hidden_veh[movement] =
        full ? elmopp_within(self->hidden_veh[movement] + missing_veh, 0.0F, capacity_veh) : 0.0F;
    if ((!full) || (missing_veh < 0.0F)) {
        *mean -= missing_veh / (float)self->mean_s;
    }
}

/* A second in which a standing queue was let go by a stage that has settled. */
static void learn_flow(elmopp_sight_t *self, uint32_t stage, uint32_t movement, float left_veh) {
    const float site = self->site_veh_per_s[movement];
    const float lanes = (float)self->junction->movement[movement].lanes;
    const float most_veh = elmopp_greater(2.0F * site, lanes);
    const float kept = 1.0F - self->options.forget_per_s;
    float *veh = &self->learnt_veh[stage][movement];
    float *seconds = &self->learnt_s[stage][movement];
    *veh = (*veh * kept) + elmopp_within(left_veh, 0.0F, most_veh);
    *seconds = (*seconds * kept) + 1.0F;
    const float mean = ((site * self->options.prior_s) + *veh) / (self->options.prior_s + *seconds);
    self->flow_veh_per_s[stage][movement] = elmopp_within(mean, LEAST_FLOW_SHARE * site, MOST_FLOW_SHARE * site);
}

/* `queued_veh`: a second ago. */
static void watch_queue(elmopp_sight_t *self, uint32_t stage, uint32_t movement, float queued_veh, float left_veh) {
    if (queued_veh >= (STANDING_VEH_PER_LANE * (float)self->junction->movement[movement].lanes)) {
        learn_flow(self, stage, movement, left_veh);
    }
    uint16_t *idle_s = &self->idle_s[movement];
    if ((queued_veh < QUEUED_VEH) || (left_veh >= LEFT_VEH)) {
        *idle_s = 0U;
    } else if (*idle_s < UINT16_MAX) {
        (*idle_s)++;
    } else {
        /* saturated */
    }
}

static void run_clock(elmopp_sight_t *self, uint32_t movement, bool green, float left_veh) {
    const bool somebody = self->present_veh[movement] > 0.0F;
    const bool nobody = self->present_veh[movement] < SOMEBODY_VEH;
    uint16_t *red_s = &self->red_s[movement];
    if (green && ((left_veh >= LEFT_VEH) || nobody)) {
        *red_s = 0U;
    } else if ((somebody || (*red_s > 0U)) && (*red_s < UINT16_MAX)) {
        (*red_s)++;
    } else {
        /* nobody has waited yet, or saturated */
    }
}

/* True if the departures of the last second tell how fast a stage lets the movement go. */
static bool is_settled(const elmopp_sight_t *self, const elmopp_view_t *view, uint32_t movement) {
    const uint32_t startup_ds = self->junction->movement[movement].startup_ds;
    return learns(self->junction) && (view->stage < self->junction->stage_count) && (view->stage == self->stage) &&
           elmopp_mask_has(self->serves[view->stage], movement) && (view->elapsed_ds > (startup_ds + SETTLE_DS));
}

static void observe_movement(elmopp_sight_t *self, const elmopp_view_t *view, uint32_t movement, bool held) {
    const float arrived_veh = view->arrivals_veh[movement];
    const float present_veh = view->queue_veh[movement];
    const float left_veh = (self->present_veh[movement] + arrived_veh) - present_veh;
    const float queued_veh = self->queued_veh[movement];
    drive_on(self, movement, arrived_veh, present_veh);
    expect(self, movement, arrived_veh);
    const bool settled = is_settled(self, view, movement);
    if (settled && (!held)) {
        watch_queue(self, view->stage, movement, queued_veh, left_veh);
    } else if ((!settled) || (left_veh >= LEFT_VEH)) {
        self->idle_s[movement] = 0U;
    } else {
        /* who waits for a gap is not blocked, nor does he show that he is not */
    }
    run_clock(self, movement, elmopp_mask_has(self->going & view->going, movement), left_veh);
}

void elmopp_sight_observe(elmopp_sight_t *self, const elmopp_view_t *view) {
    if (self->mean_s < self->options.mean_window_s) {
        self->mean_s++;
    }
    const uint32_t held = (view->stage < self->junction->stage_count) ? held_up(self, view->stage) : 0U;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        observe_movement(self, view, j, elmopp_mask_has(held, j));
    }
    self->stage = view->stage;
    self->going = view->going;
}

bool elmopp_sight_is_served(const elmopp_sight_t *self, uint32_t stage, uint32_t movement) {
    return elmopp_mask_has(self->serves[stage], movement) &&
           (elmopp_sight_usual(self, stage, movement) >= (ELMOPP_SIGHT_SERVED_SHARE * self->site_veh_per_s[movement]));
}

bool elmopp_sight_is_blocked(const elmopp_sight_t *self, uint32_t movement) {
    return self->idle_s[movement] >= self->options.block_s;
}
