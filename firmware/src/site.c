/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/site.h"

#include <string.h>

#define AMBER_MIN_DS 30U
#define AMBER_MAX_DS 60U
#define STREET_GREEN_MIN_DS 50U
#define VEHICLES_MAX 1.0e6F
#define REACH_MAX_M 1.0e5F
#define MINUTES_PER_DAY 1440U
#define ALL_WEEKDAYS 0x7FU
#define SUNDAY 6U
#define PERCENT_MAX 100U

const char *elmopp_site_fault_name(elmopp_site_fault_t fault) {
    static const char *const name[ELMOPP_SITE_FAULT_COUNT] = {
        [ELMOPP_SITE_OK] = "good",
        [ELMOPP_SITE_COUNTS] = "a count, a code or a length is out of bounds",
        [ELMOPP_SITE_NAME] = "a name is empty or has no end",
        [ELMOPP_SITE_HOLD] = "the hold window is none",
        [ELMOPP_SITE_START] = "first stage, cameras or start-up times are out of bounds",
        [ELMOPP_SITE_WAIT] = "the wait for an occupied junction is too long",
        [ELMOPP_SITE_APPROACH] = "an approach has too many movements",
        [ELMOPP_SITE_MOVEMENT] = "a movement is none",
        [ELMOPP_SITE_RESCUE] = "a rescue stage does not serve its movement",
        [ELMOPP_SITE_GIVES_WAY] = "a movement gives way to one that never goes with it",
        [ELMOPP_SITE_GROUP] = "a group breaks a rule about times, or has no lamp node",
        [ELMOPP_SITE_CONFLICT] = "two groups conflict one-sidedly",
        [ELMOPP_SITE_INTERGREEN] = "an intergreen is too short, or has no conflict",
        [ELMOPP_SITE_STAGE] = "a stage is empty or repeated",
        [ELMOPP_SITE_STAGE_CONFLICT] = "two groups conflict inside a stage",
        [ELMOPP_SITE_STAGE_NOT_MAXIMAL] = "a further group fits into a stage",
        [ELMOPP_SITE_RED_BOUND] = "the bound on red cannot be kept",
        [ELMOPP_SITE_PROGRAM] = "a programme has no good steps, or leaves out a movement",
        [ELMOPP_SITE_SCHEDULE] = "a line of the schedule is none",
        [ELMOPP_SITE_SPECIAL_DAY] = "a special day names no weekday",
        [ELMOPP_SITE_IMAGE_MAGIC] = "not an ELMS image",
        [ELMOPP_SITE_IMAGE_VERSION] = "an ELMS image of another version",
        [ELMOPP_SITE_IMAGE_LENGTH] = "an ELMS image of another length",
        [ELMOPP_SITE_IMAGE_CRC] = "an ELMS image whose checksum does not fit"};
    return (fault < ELMOPP_SITE_FAULT_COUNT) ? name[fault] : "an unknown fault";
}

static const elmopp_site_verdict_t ok = {ELMOPP_SITE_OK, 0U, 0U};

static elmopp_site_verdict_t fault(elmopp_site_fault_t what, uint32_t first, uint32_t second) {
    return (elmopp_site_verdict_t){what, (uint8_t)first, (uint8_t)second};
}

static elmopp_site_verdict_t verdict_of(bool good, elmopp_site_fault_t what, uint32_t first, uint32_t second) {
    return good ? ok : fault(what, first, second);
}

static bool ends_with_zero(const char *name, uint32_t size) {
    return (name[0] != '\0') && (name[size - 1U] == '\0');
}

/* False for a NaN too. */
static bool between(float value, float low, float high) {
    return (value >= low) && (value <= high);
}

static bool names_end(const elmopp_junction_t *junction) {
    bool good = ends_with_zero(junction->name, ELMOPP_SITE_NAME_SIZE);
    for (uint32_t i = 0U; i < junction->approach_count; i++) {
        good = good && ends_with_zero(junction->approach_name[i], ELMOPP_NAME_SIZE);
    }
    for (uint32_t j = 0U; j < junction->movement_count; j++) {
        good = good && ends_with_zero(junction->movement[j].name, ELMOPP_NAME_SIZE);
    }
    for (uint32_t g = 0U; g < junction->group_count; g++) {
        good = good && ends_with_zero(junction->group[g].name, ELMOPP_NAME_SIZE);
    }
    return good;
}

static bool count_fits(uint8_t count, uint32_t bound) {
    return (count >= 1U) && (count <= bound);
}

static bool time_fits(uint16_t time_ds) {
    return time_ds <= ELMOPP_SITE_TIME_MAX_DS;
}

static bool counts_fit(const elmopp_junction_t *junction) {
    return count_fits(junction->approach_count, ELMOPP_APPROACH_MAX) &&
           count_fits(junction->movement_count, ELMOPP_MOVEMENT_MAX) &&
           count_fits(junction->group_count, ELMOPP_GROUP_MAX) && count_fits(junction->stage_count, ELMOPP_STAGE_MAX) &&
           (junction->program_count <= ELMOPP_PROGRAM_MAX) && (junction->schedule_count <= ELMOPP_SCHEDULE_MAX) &&
           (junction->special_day_count <= ELMOPP_SPECIAL_DAY_MAX);
}

static bool start_fits(const elmopp_junction_t *junction) {
    const uint32_t approaches = ((uint32_t)1U << junction->approach_count) - 1U;
    return (junction->first_stage < junction->stage_count) && ((junction->cameras & approaches) == junction->cameras) &&
           time_fits(junction->start_flash_ds) && time_fits(junction->start_red_ds);
}

/* A promise that nobody could keep is none. */
static bool learning_fits(const elmopp_junction_t *junction) {
    const bool can_learn =
        (junction->forecast == (uint8_t)ELMOPP_FORECAST_LSTM) || (junction->forecast == (uint8_t)ELMOPP_FORECAST_NLSTM);
    return (junction->learning == 0U) ||
           ((junction->learning == 1U) && can_learn && elmopp_junction_looks_ahead(junction));
}

elmopp_site_verdict_t elmopp_site_check_counts(const elmopp_junction_t *junction) {
    const bool codes = (junction->simulation_only <= 1U) && (junction->discharge <= (uint8_t)ELMOPP_DISCHARGE_NOLOCK) &&
                       (junction->chooser < (uint8_t)ELMOPP_CHOOSER_COUNT) &&
                       (junction->forecast < (uint8_t)ELMOPP_FORECAST_COUNT) && learning_fits(junction);
    const bool flow = (junction->discharge == (uint8_t)ELMOPP_DISCHARGE_SATURATION) ||
                      (between(junction->free_flow_m_per_s, 0.0F, 100.0F) && (junction->free_flow_m_per_s > 0.0F));
    const bool street =
        (junction->simulation_only == 1U) || (junction->discharge == (uint8_t)ELMOPP_DISCHARGE_SATURATION);
    const bool reach = between(junction->reach_m, 0.0F, REACH_MAX_M);
    if ((!counts_fit(junction)) || (!codes) || (!flow) || (!street) || (!reach)) {
        return fault(ELMOPP_SITE_COUNTS, 0U, 0U);
    }
    if (!names_end(junction)) {
        return fault(ELMOPP_SITE_NAME, 0U, 0U);
    }
    const bool hold = (junction->hold_min_s >= 1U) && (junction->hold_min_s <= junction->hold_max_s) &&
                      (junction->hold_max_s <= ELMOPP_HORIZON_MAX);
    if (!hold) {
        return fault(ELMOPP_SITE_HOLD, 0U, 0U);
    }
    if (!start_fits(junction)) {
        return fault(ELMOPP_SITE_START, 0U, 0U);
    }
    return verdict_of(junction->junction_wait_ds <= ELMOPP_SITE_JUNCTION_WAIT_MAX_DS, ELMOPP_SITE_WAIT, 0U, 0U);
}

elmopp_site_verdict_t elmopp_site_check_approach(const elmopp_junction_t *junction, uint32_t approach) {
    uint32_t movements = 0U;
    for (uint32_t j = 0U; j < junction->movement_count; j++) {
        movements += (junction->movement[j].approach == approach) ? 1U : 0U;
    }
    return verdict_of(movements <= ELMOPP_APPROACH_MOVEMENT_MAX, ELMOPP_SITE_APPROACH, approach, 0U);
}

elmopp_site_verdict_t elmopp_site_check_movement(const elmopp_junction_t *junction, uint32_t movement) {
    const elmopp_movement_t *lane = &junction->movement[movement];
    const bool numbers = between(lane->capacity_veh, 0.0F, VEHICLES_MAX) &&
                         between(lane->saturation_veh_per_s, 0.0F, VEHICLES_MAX) && (lane->saturation_veh_per_s > 0.0F);
    const bool places = (lane->approach < junction->approach_count) && (lane->lanes >= 1U) && (lane->groups != 0U) &&
                        ((lane->groups & elmopp_junction_groups(junction)) == lane->groups);
    const uint32_t limit_km_per_h = elmopp_junction_limit_km_per_h(junction, movement);
    const bool speed =
        (limit_km_per_h >= ELMOPP_SITE_LIMIT_MIN_KM_PER_H) && (limit_km_per_h <= ELMOPP_SITE_LIMIT_MAX_KM_PER_H);
    bool served = false;
    for (uint32_t s = 0U; s < junction->stage_count; s++) {
        served = served || elmopp_junction_goes(junction, movement, junction->stage_groups[s]);
    }
    return verdict_of(numbers && places && speed && served, ELMOPP_SITE_MOVEMENT, movement, 0U);
}

elmopp_site_verdict_t elmopp_site_check_rescue(const elmopp_junction_t *junction, uint32_t movement) {
    const uint32_t stage = junction->rescue_stage[movement];
    const bool serves =
        (stage < junction->stage_count) && elmopp_junction_goes(junction, movement, junction->stage_groups[stage]);
    return verdict_of(serves, ELMOPP_SITE_RESCUE, movement, 0U);
}

/* The first movement of the mask that a movement cannot give way to; the count of movements if there is none. */
static uint32_t wrong_foe(const elmopp_junction_t *junction, uint32_t movement) {
    const uint32_t foes = junction->gives_way[movement];
    uint32_t together = 0U;
    for (uint32_t s = 0U; s < junction->stage_count; s++) {
        const uint32_t served = elmopp_junction_served(junction, junction->stage_groups[s]);
        together |= elmopp_mask_has(served, movement) ? served : 0U;
    }
    uint32_t found = junction->movement_count;
    for (uint32_t j = junction->movement_count; j > 0U; j--) {
        const uint32_t foe = j - 1U;
        const bool possible = (foe != movement) && elmopp_mask_has(together, foe);
        found = (elmopp_mask_has(foes, foe) && (!possible)) ? foe : found;
    }
    return found;
}

elmopp_site_verdict_t elmopp_site_check_gives_way(const elmopp_junction_t *junction, uint32_t movement) {
    const uint32_t foes = junction->gives_way[movement];
    const uint32_t percent = junction->movement[movement].gives_way_percent;
    const bool exist = (foes >> junction->movement_count) == 0U;
    const bool nobody = (foes == 0U) && (percent == 0U);
    const bool somebody = (foes != 0U) && (percent >= 1U) && (percent <= PERCENT_MAX);
    const bool known = (foes == 0U) || (junction->discharge == (uint8_t)ELMOPP_DISCHARGE_SATURATION);
    if ((!exist) || (!(nobody || somebody)) || (!known)) {
        return fault(ELMOPP_SITE_GIVES_WAY, movement, movement);
    }
    const uint32_t wrong = wrong_foe(junction, movement);
    return verdict_of(wrong == junction->movement_count, ELMOPP_SITE_GIVES_WAY, movement, wrong);
}

static bool group_times_fit(const elmopp_group_t *times) {
    return time_fits(times->amber_ds) && time_fits(times->red_amber_ds) && time_fits(times->min_green_ds) &&
           time_fits(times->max_green_ds);
}

elmopp_site_verdict_t elmopp_site_check_group(const elmopp_junction_t *junction, uint32_t group) {
    const elmopp_group_t *times = &junction->group[group];
    const bool street = junction->simulation_only == 0U;
    const bool amber = (!street) || ((times->amber_ds >= AMBER_MIN_DS) && (times->amber_ds <= AMBER_MAX_DS));
    const uint16_t shortest_ds = street ? (uint16_t)STREET_GREEN_MIN_DS : (uint16_t)ELMOPP_LAMP_TICKS_PER_S;
    const bool unbounded = (times->max_green_ds == 0U) && (!street);
    const bool green =
        (times->min_green_ds >= shortest_ds) && (unbounded || (times->max_green_ds >= times->min_green_ds));
    const bool lamps = (times->node < ELMOPP_NODE_MAX) && (times->flash <= (uint8_t)ELMOPP_FLASH_DARK);
    return verdict_of(amber && green && lamps && group_times_fit(times), ELMOPP_SITE_GROUP, group, 0U);
}

elmopp_site_verdict_t elmopp_site_check_pair(const elmopp_junction_t *junction, uint32_t ending, uint32_t starting) {
    const bool conflict = elmopp_mask_has(junction->conflict[ending], starting);
    const bool mirrored = elmopp_mask_has(junction->conflict[starting], ending);
    const bool exists = (junction->conflict[ending] & elmopp_junction_groups(junction)) == junction->conflict[ending];
    if ((conflict != mirrored) || (conflict && (ending == starting)) || (!exists)) {
        return fault(ELMOPP_SITE_CONFLICT, ending, starting);
    }
    const uint32_t intergreen_ds = junction->intergreen_ds[ending][starting];
    const uint32_t lamps_ds = (uint32_t)junction->group[ending].amber_ds + junction->group[starting].red_amber_ds;
    const bool apart = (intergreen_ds >= lamps_ds) && (intergreen_ds <= ELMOPP_SITE_TIME_MAX_DS);
    const bool none = intergreen_ds == 0U;
    const bool good = conflict ? apart : none;
    return verdict_of(good, ELMOPP_SITE_INTERGREEN, ending, starting);
}

/* Compatible groups, and in a street no further one that would fit. */
elmopp_site_verdict_t elmopp_site_check_stage(const elmopp_junction_t *junction, uint32_t stage) {
    const uint16_t groups = junction->stage_groups[stage];
    if ((groups == 0U) || ((groups & elmopp_junction_groups(junction)) != groups)) {
        return fault(ELMOPP_SITE_STAGE, stage, 0U);
    }
    for (uint32_t s = 0U; s < stage; s++) {
        if (junction->stage_groups[s] == groups) {
            return fault(ELMOPP_SITE_STAGE, stage, s);
        }
    }
    for (uint32_t g = 0U; g < junction->group_count; g++) {
        const uint16_t clash = (uint16_t)(junction->conflict[g] & groups);
        for (uint32_t h = 0U; h < junction->group_count; h++) {
            if (elmopp_mask_has(groups, g) && elmopp_mask_has(clash, h)) {
                return fault(ELMOPP_SITE_STAGE_CONFLICT, g, h);
            }
        }
        if ((junction->simulation_only == 0U) && (!elmopp_mask_has(groups, g)) && (clash == 0U)) {
            return fault(ELMOPP_SITE_STAGE_NOT_MAXIMAL, stage, g);
        }
    }
    return ok;
}

static elmopp_site_verdict_t check_served(const elmopp_junction_t *junction, uint32_t group) {
    bool served = false;
    for (uint32_t s = 0U; s < junction->stage_count; s++) {
        served = served || elmopp_mask_has(junction->stage_groups[s], group);
    }
    return verdict_of(served, ELMOPP_SITE_STAGE, group, 0U);
}

static elmopp_site_verdict_t check_pairs(const elmopp_junction_t *junction) {
    for (uint32_t g = 0U; g < junction->group_count; g++) {
        for (uint32_t h = 0U; h < junction->group_count; h++) {
            const elmopp_site_verdict_t verdict = elmopp_site_check_pair(junction, g, h);
            if (verdict.fault != ELMOPP_SITE_OK) {
                return verdict;
            }
        }
    }
    return ok;
}

typedef elmopp_site_verdict_t (*check_fn_t)(const elmopp_junction_t *junction, uint32_t index);

static elmopp_site_verdict_t check_each(const elmopp_junction_t *junction, uint32_t count, check_fn_t check) {
    elmopp_site_verdict_t verdict = ok;
    for (uint32_t i = 0U; (i < count) && (verdict.fault == ELMOPP_SITE_OK); i++) {
        verdict = check(junction, i);
    }
    return verdict;
}

static bool is_rescue_stage(const elmopp_junction_t *junction, uint32_t stage) {
    bool found = false;
    for (uint32_t j = 0U; j < junction->movement_count; j++) {
        found = found || (junction->rescue_stage[j] == stage);
    }
    return found;
}

uint32_t elmopp_site_red_bound_min_ds(const elmopp_junction_t *junction) {
    uint32_t changes = 1U;
    for (uint32_t s = 0U; s < junction->stage_count; s++) {
        changes += is_rescue_stage(junction, s) ? 1U : 0U;
    }
    return changes * elmopp_junction_change_ds(junction);
}

elmopp_site_verdict_t elmopp_site_check_red_bound(const elmopp_junction_t *junction) {
    const bool none = (junction->red_bound_ds == 0U) && (junction->simulation_only == 1U);
    const bool kept =
        time_fits(junction->red_bound_ds) && (junction->red_bound_ds >= elmopp_site_red_bound_min_ds(junction));
    return verdict_of(none || kept, ELMOPP_SITE_RED_BOUND, 0U, 0U);
}

/* --- programmes and their hours --- */

static bool is_step(const elmopp_junction_t *junction, const elmopp_step_t *step) {
    bool good = (step->stage < junction->stage_count) && time_fits(step->green_ds);
    for (uint32_t g = 0U; good && (g < junction->group_count); g++) {
        const bool shown = elmopp_mask_has(junction->stage_groups[step->stage], g);
        good = (!shown) || (step->green_ds >= junction->group[g].min_green_ds);
    }
    return good;
}

static bool is_in_program(const elmopp_junction_t *junction, const elmopp_program_t *program, uint32_t movement) {
    bool served = false;
    for (uint32_t i = 0U; i < program->step_count; i++) {
        served = served || elmopp_junction_goes(junction, movement, junction->stage_groups[program->step[i].stage]);
    }
    return served;
}

elmopp_site_verdict_t elmopp_site_check_program(const elmopp_junction_t *junction, uint32_t program) {
    const elmopp_program_t *steps = &junction->program[program];
    if (!count_fits(steps->step_count, ELMOPP_STEP_MAX)) {
        return fault(ELMOPP_SITE_PROGRAM, program, ELMOPP_STEP_MAX);
    }
    for (uint32_t i = 0U; i < steps->step_count; i++) {
        if (!is_step(junction, &steps->step[i])) {
            return fault(ELMOPP_SITE_PROGRAM, program, i);
        }
    }
    for (uint32_t j = 0U; j < junction->movement_count; j++) {
        if (!is_in_program(junction, steps, j)) {
            return fault(ELMOPP_SITE_PROGRAM, program, ELMOPP_STEP_MAX + j);
        }
    }
    return ok;
}

elmopp_site_verdict_t elmopp_site_check_schedule(const elmopp_junction_t *junction, uint32_t line) {
    const elmopp_schedule_t *entry = &junction->schedule[line];
    const bool when =
        (entry->from_min < MINUTES_PER_DAY) && (entry->weekdays != 0U) && (entry->weekdays <= ALL_WEEKDAYS);
    const bool what = (entry->program < junction->program_count) || (entry->program == (uint8_t)ELMOPP_SCHEDULE_FLASH);
    return verdict_of(when && what, ELMOPP_SITE_SCHEDULE, line, 0U);
}

elmopp_site_verdict_t elmopp_site_check_special_day(const elmopp_junction_t *junction, uint32_t special_day) {
    return verdict_of(junction->special_day[special_day].weekday <= SUNDAY, ELMOPP_SITE_SPECIAL_DAY, special_day, 0U);
}

static elmopp_site_verdict_t check_program_count(const elmopp_junction_t *junction) {
    const bool enough = (junction->program_count > 0U) || (junction->simulation_only == 1U);
    return verdict_of(enough, ELMOPP_SITE_PROGRAM, 0U, ELMOPP_STEP_MAX);
}

/* --- everything --- */

static elmopp_site_verdict_t check_shape(const elmopp_junction_t *junction) {
    elmopp_site_verdict_t verdict = elmopp_site_check_counts(junction);
    if (verdict.fault == ELMOPP_SITE_OK) {
        verdict = check_each(junction, junction->approach_count, elmopp_site_check_approach);
    }
    if (verdict.fault == ELMOPP_SITE_OK) {
        verdict = check_each(junction, junction->movement_count, elmopp_site_check_movement);
    }
    if (verdict.fault == ELMOPP_SITE_OK) {
        verdict = check_each(junction, junction->movement_count, elmopp_site_check_rescue);
    }
    if (verdict.fault == ELMOPP_SITE_OK) {
        verdict = check_each(junction, junction->movement_count, elmopp_site_check_gives_way);
    }
    return verdict;
}

static elmopp_site_verdict_t check_signals(const elmopp_junction_t *junction) {
    elmopp_site_verdict_t verdict = check_each(junction, junction->group_count, elmopp_site_check_group);
    if (verdict.fault == ELMOPP_SITE_OK) {
        verdict = check_pairs(junction);
    }
    if (verdict.fault == ELMOPP_SITE_OK) {
        verdict = check_each(junction, junction->stage_count, elmopp_site_check_stage);
    }
    if (verdict.fault == ELMOPP_SITE_OK) {
        verdict = check_each(junction, junction->group_count, check_served);
    }
    if (verdict.fault == ELMOPP_SITE_OK) {
        verdict = elmopp_site_check_red_bound(junction);
    }
    return verdict;
}

static elmopp_site_verdict_t check_hours(const elmopp_junction_t *junction) {
    elmopp_site_verdict_t verdict = check_program_count(junction);
    if (verdict.fault == ELMOPP_SITE_OK) {
        verdict = check_each(junction, junction->program_count, elmopp_site_check_program);
    }
    if (verdict.fault == ELMOPP_SITE_OK) {
        verdict = check_each(junction, junction->schedule_count, elmopp_site_check_schedule);
    }
    if (verdict.fault == ELMOPP_SITE_OK) {
        verdict = check_each(junction, junction->special_day_count, elmopp_site_check_special_day);
    }
    return verdict;
}

elmopp_site_verdict_t elmopp_site_check(const elmopp_junction_t *junction) {
    elmopp_site_verdict_t verdict = check_shape(junction);
    if (verdict.fault == ELMOPP_SITE_OK) {
        verdict = check_signals(junction);
    }
    if (verdict.fault == ELMOPP_SITE_OK) {
        verdict = check_hours(junction);
    }
    return verdict;
}

#define IMAGE_VERDICTS 5U /* elmopp_image_verdict_t */

const elmopp_image_kind_t *elmopp_site_kind(void) {
    static const elmopp_image_kind_t kind = {
        {0x45U, 0x4CU, 0x4DU, 0x53U}, ELMOPP_SITE_IMAGE_VERSION_NOW, (uint32_t)sizeof(elmopp_junction_t)}; /* "ELMS" */
    return &kind;
}

static elmopp_site_verdict_t check_envelope(const uint8_t *image, uint32_t length) {
    static const elmopp_site_fault_t named[IMAGE_VERDICTS] = {[ELMOPP_IMAGE_OK] = ELMOPP_SITE_OK,
                                                              [ELMOPP_IMAGE_MAGIC] = ELMOPP_SITE_IMAGE_MAGIC,
                                                              [ELMOPP_IMAGE_VERSION] = ELMOPP_SITE_IMAGE_VERSION,
                                                              [ELMOPP_IMAGE_LENGTH] = ELMOPP_SITE_IMAGE_LENGTH,
                                                              [ELMOPP_IMAGE_CRC] = ELMOPP_SITE_IMAGE_CRC};
    return fault(named[elmopp_image_check(elmopp_site_kind(), image, length)], 0U, 0U);
}

elmopp_site_verdict_t elmopp_site_load(const uint8_t *image, uint32_t length, elmopp_junction_t *out) {
    elmopp_site_verdict_t verdict = check_envelope(image, length);
    if (verdict.fault == ELMOPP_SITE_OK) {
        elmopp_junction_t loaded;
        (void)memcpy(&loaded, &image[ELMOPP_IMAGE_HEADER], sizeof loaded);
        verdict = elmopp_site_check(&loaded);
        if (verdict.fault == ELMOPP_SITE_OK) {
            *out = loaded;
        }
    }
    return verdict;
}
