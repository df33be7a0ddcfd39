/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/detector.h"

#include "elmopp/assert.h"
#include "elmopp/elementary.h"

#define SECONDS_PER_MINUTE 60U
#define DS_PER_S 10.0F

static uint16_t later(uint16_t time_s) {
    return (time_s < UINT16_MAX) ? (uint16_t)(time_s + 1U) : time_s;
}

static uint16_t plus(uint16_t sum_veh, uint16_t more_veh) {
    const uint32_t all_veh = (uint32_t)sum_veh + more_veh;
    return (all_veh < UINT16_MAX) ? (uint16_t)all_veh : (uint16_t)UINT16_MAX;
}

void elmopp_detector_init(elmopp_detector_t *self, const elmopp_junction_t *junction) {
    *self = (elmopp_detector_t){.junction = junction};
    for (uint32_t j = 0U; j < ELMOPP_MOVEMENT_MAX; j++) {
        self->lane[j].age_s = UINT16_MAX;
        self->lane[j].reason = (uint8_t)ELMOPP_REASON_STALE;
    }
}

/* --- a frame --- */

/* Arrivals since the last frame; marks a jump that no traffic makes, and counts nothing for it. */
static uint16_t new_arrivals(elmopp_detector_lane_t *lane, uint32_t lanes, uint8_t arrivals) {
    const uint32_t step_veh = (arrivals + ELMOPP_DETECTOR_MODULO - lane->arrivals) % ELMOPP_DETECTOR_MODULO;
    const uint32_t most_veh = ELMOPP_DETECTOR_RATE_VEH * lanes * (1U + lane->age_s);
    uint16_t counted = 0U;
    if ((!lane->started) || (lane->age_s > ELMOPP_DETECTOR_GAP_S)) {
        lane->started = true;
    } else if (step_veh > most_veh) {
        lane->jumped = true;
    } else {
        counted = (uint16_t)step_veh;
    }
    lane->arrivals = arrivals;
    return counted;
}

static void take_lane(elmopp_detector_lane_t *lane, uint32_t lanes, const elmopp_detector_report_t *report,
                      uint8_t reason) {
    lane->valid = report->valid && (report->present_veh < ELMOPP_DETECTOR_UNKNOWN);
    lane->reason = reason;
    if (lane->valid) {
        lane->present_veh = report->present_veh;
        const uint8_t arrivals = (uint8_t)(report->arrivals % ELMOPP_DETECTOR_MODULO);
        lane->arrived_veh = plus(lane->arrived_veh, new_arrivals(lane, lanes, arrivals));
    } else {
        lane->started = false;
    }
    lane->age_s = 0U;
}

void elmopp_detector_take(elmopp_detector_t *self, uint32_t approach,
                          const elmopp_detector_report_t report[ELMOPP_APPROACH_MOVEMENT_MAX], uint8_t reason) {
    ELMOPP_ASSERT(reason < (uint8_t)ELMOPP_REASON_COUNT);
    uint32_t slot = 0U;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const elmopp_movement_t *movement = &self->junction->movement[j];
        if ((movement->approach == approach) && (slot < ELMOPP_APPROACH_MOVEMENT_MAX)) {
            take_lane(&self->lane[j], movement->lanes, &report[slot], reason);
            slot++;
        }
    }
}

/* --- a second --- */

static bool is_over(uint16_t time_s, uint8_t limit_min) {
    return (limit_min != 0U) && (time_s >= ((uint32_t)limit_min * SECONDS_PER_MINUTE));
}

static bool is_over_count(uint16_t counted_veh, uint8_t limit_per_min) {
    return (limit_per_min != 0U) && (counted_veh > limit_per_min);
}

/* What this room finds; ELMOPP_REASON_OK if nothing. The camera's own reason stands where it has marked a movement. */
static uint8_t diagnosis(const elmopp_junction_t *junction, const elmopp_detector_lane_t *lane) {
    uint8_t found = (uint8_t)ELMOPP_REASON_OK;
    if (lane->age_s > ELMOPP_DETECTOR_STALE_S) {
        found = (uint8_t)ELMOPP_REASON_STALE;
    } else if (lane->jumped || lane->erratic) {
        found = (uint8_t)ELMOPP_REASON_ERRATIC;
    } else if (is_over(lane->busy_s, junction->max_presence_min)) {
        found = (uint8_t)ELMOPP_REASON_MAX_PRESENCE;
    } else if (is_over(lane->silent_s, junction->no_activity_min)) {
        found = (uint8_t)ELMOPP_REASON_NO_ACTIVITY;
    } else {
        /* nothing */
    }
    return found;
}

static void judge_minute(const elmopp_junction_t *junction, elmopp_detector_lane_t *lane, bool minute_over) {
    const bool too_many = is_over_count(lane->counted_veh, junction->erratic_per_min);
    lane->erratic = minute_over ? too_many : (lane->erratic || too_many);
    lane->counted_veh = minute_over ? (uint16_t)0U : lane->counted_veh;
}

static void close_lane(const elmopp_junction_t *junction, elmopp_detector_lane_t *lane, bool minute_over) {
    lane->silent_s = (lane->arrived_veh > 0U) ? (uint16_t)0U : later(lane->silent_s);
    lane->busy_s = (lane->present_veh == 0U) ? (uint16_t)0U : later(lane->busy_s);
    lane->counted_veh = plus(lane->counted_veh, lane->arrived_veh);
    judge_minute(junction, lane, minute_over);
    const uint8_t found = diagnosis(junction, lane);
    lane->reason = (found != (uint8_t)ELMOPP_REASON_OK) ? found : lane->reason;
    const bool good = lane->valid && (found == (uint8_t)ELMOPP_REASON_OK);
    lane->good_s = good ? later(lane->good_s) : (uint16_t)0U;
    lane->second_veh = (float)lane->arrived_veh;
    lane->arrived_veh = 0U;
    lane->jumped = false;
    lane->age_s = later(lane->age_s);
}

static bool is_trusted(const elmopp_detector_lane_t *lane) {
    return lane->good_s >= ELMOPP_DETECTOR_RECOVER_S;
}

static void learn(elmopp_detector_lane_t *lane) {
    lane->seen_s += (lane->seen_s < UINT32_MAX) ? 1U : 0U;
    elmopp_average(&lane->mean_veh_per_s, lane->second_veh, lane->seen_s, ELMOPP_DETECTOR_MEAN_S);
}

void elmopp_detector_second(elmopp_detector_t *self) {
    self->minute_s++;
    const bool minute_over = self->minute_s >= SECONDS_PER_MINUTE;
    self->minute_s = minute_over ? (uint8_t)0U : self->minute_s;
    self->trusted = 0U;
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        elmopp_detector_lane_t *lane = &self->lane[j];
        close_lane(self->junction, lane, minute_over);
        if (is_trusted(lane)) {
            self->trusted |= (uint32_t)1U << j;
            learn(lane);
        }
    }
}

/* --- what it comes to --- */

static float presumed_veh(const elmopp_detector_lane_t *lane, const elmopp_movement_t *movement, uint16_t red_ds) {
    const float come_veh = (lane->mean_veh_per_s * (float)red_ds) / DS_PER_S;
    const float most_veh = (come_veh < movement->capacity_veh) ? come_veh : movement->capacity_veh;
    return (most_veh > 1.0F) ? most_veh : 1.0F;
}

void elmopp_detector_counts(const elmopp_detector_t *self, const uint16_t *red_ds, float *present_veh,
                            float *arrived_veh) {
    for (uint32_t j = 0U; j < self->junction->movement_count; j++) {
        const elmopp_detector_lane_t *lane = &self->lane[j];
        const bool trusted = elmopp_mask_has(self->trusted, j);
        present_veh[j] =
            trusted ? (float)lane->present_veh : presumed_veh(lane, &self->junction->movement[j], red_ds[j]);
        arrived_veh[j] = trusted ? lane->second_veh : lane->mean_veh_per_s;
    }
}
