/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "elmopp/controller.h"

#include "elmopp/assert.h"
#include "elmopp/site.h"

#include <stddef.h>

#define DS_PER_S 10U
#define FORETELL_DS                                                                                                    \
    1U /* so long after a decision the rest of the minute is foreseen, and told: a tick that has the time */
#define EARLIEST_MS 50U /* between two ticks */
#define WEIGHTS_ID_MASK 0x0FFFU
#define FORESIGHTS 5U

/* --- continuous diagnosis --- */

static void raise_fault(elmopp_controller_t *self, elmopp_fault_t fault, uint32_t group) {
    if (self->fault == ELMOPP_FAULT_NONE) {
        self->fault = fault;
        self->fault_group = (uint8_t)group;
    }
}

static void diagnose(elmopp_controller_t *self) {
    if (!elmopp_watch_is_unchanged(&self->site_watch)) {
        raise_fault(self, ELMOPP_FAULT_SITE_CHANGED, ELMOPP_FAULT_NO_GROUP);
    }
    if (!elmopp_watch_is_unchanged(&self->weights_watch)) {
        raise_fault(self, ELMOPP_FAULT_WEIGHTS_CHANGED, ELMOPP_FAULT_NO_GROUP);
    }
}

/* --- set-up --- */

static void watch_weights(elmopp_controller_t *self, const elmopp_weights_t *weights) {
    self->weights_watch = elmopp_watch_over((const uint8_t *)weights, (uint32_t)sizeof *weights);
    self->weights_id = (uint16_t)(self->weights_watch.expected & WEIGHTS_ID_MASK);
}

void elmopp_controller_init(elmopp_controller_t *self, const elmopp_controller_config_t *config) {
    const elmopp_junction_t *junction = config->junction;
    ELMOPP_ASSERT(elmopp_site_check(junction).fault == ELMOPP_SITE_OK);
    *self = (elmopp_controller_t){.junction = junction, .mode = ELMOPP_MODE_STARTING, .wish = ELMOPP_WISH_RUN};
    elmopp_forecast_config_t forecast = config->forecast;
    forecast.whole = true; /* frames carry whole vehicles */
    elmopp_pilot_init(&self->pilot, junction, &config->chooser, &forecast);
    elmopp_monitor_init(&self->monitor, junction);
    elmopp_detector_init(&self->detector, junction);
    elmopp_bus_init(&self->bus, junction);
    self->site_watch = elmopp_watch_over((const uint8_t *)junction, (uint32_t)sizeof *junction);
    watch_weights(self, config->forecast.weights);
    self->told_ds = UINT8_MAX;
}

void elmopp_controller_use_weights(elmopp_controller_t *self, const elmopp_weights_t *weights) {
    elmopp_forecast_t *forecast = &self->pilot.forecast;
    if (elmopp_forecast_is_network(forecast->config.kind)) {
        const uint32_t before = self->weights_watch.expected;
        watch_weights(self, weights);
        elmopp_forecast_rearm(forecast, weights, self->weights_watch.expected != before);
    }
}

void elmopp_controller_report(elmopp_controller_t *self, elmopp_fault_t fault) {
    raise_fault(self, fault, ELMOPP_FAULT_NO_GROUP);
}

void elmopp_controller_refuse(elmopp_controller_t *self, uint32_t count) {
    elmopp_bus_refuse(&self->bus, count);
}

void elmopp_controller_stop(elmopp_controller_t *self) {
    self->wish = ELMOPP_WISH_ALL_RED;
}

bool elmopp_controller_has_stopped(const elmopp_controller_t *self) {
    const elmopp_lamps_t *lamps = &self->lamps;
    return ((lamps->green | lamps->amber) == 0U) || (!elmopp_mode_is_steady(self->mode));
}

void elmopp_controller_hold_reset(elmopp_controller_t *self, bool held) {
    self->reset_held = held;
    self->clear_ds = held ? self->clear_ds : 0U;
}

/* --- commands --- */

/* Never back to where it was: whatever was asked for before has to be asked for again. */
static void clear_fault(elmopp_controller_t *self) {
    self->fault = ELMOPP_FAULT_NONE;
    self->fault_group = ELMOPP_FAULT_NO_GROUP;
    self->clear_ds = 0U;
    self->cleared = true;
    self->wish = ELMOPP_WISH_RUN;
    elmopp_monitor_init(&self->monitor, self->junction);
}

static bool names_the_fault(const elmopp_controller_t *self, uint32_t argument) {
    return self->reset_held && (self->fault != ELMOPP_FAULT_NONE) && (argument == (uint32_t)self->fault);
}

static bool wish_for(elmopp_controller_t *self, elmopp_wish_t wish) {
    self->wish = wish;
    return true;
}

static bool obey(elmopp_controller_t *self, elmopp_request_t request, uint32_t argument) {
    bool obeyed = false;
    switch (request) {
    case ELMOPP_REQUEST_SET_WALL_TIME:
        self->wall_s = argument;
        self->wall_ds = 0U;
        self->wall_known = true;
        obeyed = true;
        break;
    case ELMOPP_REQUEST_RUN:
        obeyed = wish_for(self, ELMOPP_WISH_RUN);
        break;
    case ELMOPP_REQUEST_FIXED_TIME:
        obeyed = wish_for(self, ELMOPP_WISH_FIXED_TIME);
        break;
    case ELMOPP_REQUEST_MANUAL:
        if (argument < self->junction->stage_count) {
            self->manual_stage = (elmopp_stage_t)argument;
            obeyed = wish_for(self, ELMOPP_WISH_MANUAL);
        }
        break;
    case ELMOPP_REQUEST_ALL_RED:
        obeyed = wish_for(self, ELMOPP_WISH_ALL_RED);
        break;
    case ELMOPP_REQUEST_FLASHING:
        obeyed = wish_for(self, ELMOPP_WISH_FLASHING);
        break;
    case ELMOPP_REQUEST_DARK:
        obeyed = wish_for(self, ELMOPP_WISH_DARK);
        break;
    case ELMOPP_REQUEST_CLEAR_FAULT_PREPARE:
        obeyed = names_the_fault(self, argument);
        self->clear_ds = obeyed ? (uint16_t)ELMOPP_CONTROLLER_CLEAR_DS : (uint16_t)0U;
        break;
    case ELMOPP_REQUEST_CLEAR_FAULT_CONFIRM:
        obeyed = names_the_fault(self, argument) && (self->clear_ds > 0U);
        if (obeyed) {
            clear_fault(self);
        }
        break;
    case ELMOPP_REQUEST_NONE:
    default:
        obeyed = false;
        break;
    }
    return obeyed;
}

/* --- frames in --- */

static void take_counts(elmopp_controller_t *self, uint32_t approach, const elmopp_frame_t *frame) {
    elmopp_detector_report_t report[ELMOPP_APPROACH_MOVEMENT_MAX];
    const uint8_t reason = elmopp_frames_counts(frame, report);
    elmopp_detector_take(&self->detector, approach, report, reason);
}

static bool take_command(elmopp_controller_t *self, const elmopp_frame_t *frame) {
    uint32_t argument = 0U;
    const elmopp_request_t request = elmopp_frames_command(frame, &argument);
    const bool obeyed = obey(self, request, argument);
    if (!obeyed) {
        elmopp_bus_refuse(&self->bus, 1U);
    }
    return obeyed;
}

bool elmopp_controller_take(elmopp_controller_t *self, const elmopp_frame_t *frame) {
    const elmopp_news_t news = elmopp_bus_hear(&self->bus, frame);
    bool taken = true;
    switch (news.kind) {
    case ELMOPP_NEWS_COUNTS:
        take_counts(self, news.approach, frame);
        break;
    case ELMOPP_NEWS_COMMAND:
        taken = take_command(self, frame);
        break;
    case ELMOPP_NEWS_SECOND:
        raise_fault(self, ELMOPP_FAULT_SECOND_CONTROLLER, ELMOPP_FAULT_NO_GROUP);
        break;
    case ELMOPP_NEWS_KEPT:
        break;
    case ELMOPP_NEWS_NOT_OURS:
    case ELMOPP_NEWS_REFUSED:
    default:
        taken = false;
        break;
    }
    return taken;
}

/* --- time --- */

/* True if a tick is due; it is then done. Differences of unsigned milliseconds survive the wrap. */
static bool take_time(elmopp_controller_t *self, elmopp_ms_t now_ms) {
    const uint32_t since_ms = now_ms - self->last_ms;
    const uint32_t ahead_ms = self->due_ms - now_ms;
    const bool jumped = self->ticking && (since_ms > ELMOPP_CONTROLLER_LATE_MS);
    const bool early = (ahead_ms > EARLIEST_MS) && (ahead_ms <= ELMOPP_CONTROLLER_LATE_MS);
    if (jumped) {
        raise_fault(self, ELMOPP_FAULT_CLOCK, ELMOPP_FAULT_NO_GROUP);
    } else if (self->ticking && ((since_ms < EARLIEST_MS) || early)) {
        return false;
    } else {
        /* due */
    }
    const uint32_t late_ms = now_ms - self->due_ms;
    const bool on_grid = self->ticking && (!jumped);
    const bool lags = on_grid && (late_ms <= ELMOPP_CONTROLLER_LATE_MS);
    const uint32_t late_ticks = late_ms / ELMOPP_CONTROLLER_TICK_MS;
    const uint32_t lost = lags ? late_ticks : 0U;
    const uint32_t from_ms = on_grid ? self->due_ms : now_ms;
    self->due_ms = from_ms + ((lost + 1U) * ELMOPP_CONTROLLER_TICK_MS);
    self->last_ms = now_ms;
    self->ticking = true;
    return true;
}

static void age(elmopp_controller_t *self) {
    elmopp_bus_tick(&self->bus);
    self->clear_ds = (self->clear_ds > 0U) ? (uint16_t)(self->clear_ds - 1U) : (uint16_t)0U;
    self->mode_ds = (self->mode_ds < UINT16_MAX) ? (uint16_t)(self->mode_ds + 1U) : self->mode_ds;
    self->told_ds = (self->told_ds < UINT8_MAX) ? (uint8_t)(self->told_ds + 1U) : self->told_ds;
    self->wall_ds++;
    if (self->wall_ds >= DS_PER_S) {
        self->wall_ds = 0U;
        self->wall_s++;
    }
}

/* --- decisions, once a second --- */

static void every_second(elmopp_controller_t *self) {
    elmopp_bus_second(&self->bus);
    elmopp_detector_second(&self->detector);
    elmopp_detector_counts(&self->detector, self->pilot.red_ds, self->present_veh, self->arrived_veh);
    const elmopp_counts_t counts = {.present_veh = self->present_veh,
                                    .arrived_veh = self->arrived_veh,
                                    .recall = ~self->detector.trusted,
                                    .outflow = self->bus.outflow};
    (void)elmopp_pilot_step(&self->pilot, &counts, NULL);
    self->program = self->wall_known ? elmopp_timetable_program(self->junction, self->wall_s) : (uint8_t)0U;
}

/* --- modes --- */

/* Every node reports, is well, and shows nothing but what flashes. */
static bool lamps_read_back(const elmopp_controller_t *self) {
    const elmopp_lamps_t *shown = &self->bus.measured;
    const uint32_t strange = ((uint32_t)shown->red & ~(uint32_t)self->lamps.red) |
                             ((uint32_t)shown->amber & ~(uint32_t)self->lamps.amber) | shown->green;
    return (elmopp_bus_fresh_groups(&self->bus) == elmopp_junction_groups(self->junction)) &&
           (self->bus.unwell_nodes == 0U) && (strange == 0U);
}

static uint32_t group_of_nodes(const elmopp_junction_t *junction, uint8_t nodes) {
    uint32_t found = 0U;
    for (uint32_t g = junction->group_count; g > 0U; g--) {
        const uint32_t lower = g - 1U;
        found = elmopp_mask_has(nodes, junction->group[lower].node) ? lower : found;
    }
    return found;
}

static void test_lamps(elmopp_controller_t *self) {
    if (self->mode == ELMOPP_MODE_STARTING) {
        self->test_ds = lamps_read_back(self) ? (uint16_t)(self->test_ds + 1U) : (uint16_t)0U;
        if (self->mode_ds >= ELMOPP_CONTROLLER_SELF_TEST_DS) {
            raise_fault(self, ELMOPP_FAULT_SELF_TEST, ELMOPP_FAULT_NO_GROUP);
        }
    } else if ((self->mode != ELMOPP_MODE_FAIL_SAFE) && (self->bus.unwell_nodes != 0U)) {
        raise_fault(self, ELMOPP_FAULT_LAMP_NODE, group_of_nodes(self->junction, self->bus.unwell_nodes));
    } else {
        /* nothing to test */
    }
}

static elmopp_mode_input_t mode_input(const elmopp_controller_t *self) {
    const elmopp_plan_t *plan = &self->pilot.plan;
    return (elmopp_mode_input_t){.wish = self->wish,
                                 .fault = self->fault != ELMOPP_FAULT_NONE,
                                 .cleared = self->cleared,
                                 .tested = self->test_ds >= ELMOPP_CONTROLLER_TEST_GOOD_DS,
                                 .sighted = self->detector.trusted != 0U,
                                 .night = self->wall_known && (self->program == (uint8_t)ELMOPP_SCHEDULE_FLASH),
                                 .all_red = plan->settled && (plan->target == ELMOPP_STAGE_NONE),
                                 .settled = plan->stage != ELMOPP_STAGE_NONE,
                                 .age_ds = self->mode_ds,
                                 .flash_ds = self->junction->start_flash_ds,
                                 .red_ds = self->junction->start_red_ds};
}

static void enter_mode(elmopp_controller_t *self, elmopp_mode_t mode) {
    self->mode = mode;
    self->mode_ds = 0U;
}

static void change_mode(elmopp_controller_t *self) {
    const elmopp_mode_input_t input = mode_input(self);
    const elmopp_mode_t next = elmopp_mode_next(self->mode, &input);
    self->cleared = false;
    if (next != self->mode) {
        enter_mode(self, next);
        if (next == ELMOPP_MODE_STARTING) {
            self->test_ds = 0U;
        }
        if (next == ELMOPP_MODE_START_RED) {
            elmopp_pilot_restart(&self->pilot);
        }
    }
}

/* --- lamps --- */

static elmopp_stage_t wanted_stage(elmopp_controller_t *self) {
    const elmopp_plan_t *plan = &self->pilot.plan;
    elmopp_stage_t wanted = ELMOPP_STAGE_RED;
    switch (self->mode) {
    case ELMOPP_MODE_FIRST_STAGE:
        wanted = self->junction->first_stage;
        break;
    case ELMOPP_MODE_AUTOMATIC:
        wanted = self->pilot.wanted;
        break;
    case ELMOPP_MODE_FIXED_TIME:
        wanted = elmopp_timetable_wish(&self->timetable, self->junction, self->program, plan->stage, plan->elapsed_ds);
        break;
    case ELMOPP_MODE_MANUAL:
        wanted = self->manual_stage;
        break;
    case ELMOPP_MODE_STARTING:
    case ELMOPP_MODE_START_FLASH:
    case ELMOPP_MODE_START_RED:
    case ELMOPP_MODE_ALL_RED:
    case ELMOPP_MODE_FLASHING:
    case ELMOPP_MODE_DARK:
    case ELMOPP_MODE_FAIL_SAFE:
    case ELMOPP_MODE_COUNT:
    default:
        wanted = ELMOPP_STAGE_RED;
        break;
    }
    return wanted;
}

static elmopp_lamps_t lamps_of_mode(elmopp_controller_t *self) {
    elmopp_lamps_t lamps = {0U, 0U, 0U, 0U};
    if (elmopp_mode_is_steady(self->mode)) {
        lamps = elmopp_pilot_lamp_tick(&self->pilot, wanted_stage(self), elmopp_bus_is_occupied(&self->bus));
    } else if (self->mode != ELMOPP_MODE_DARK) {
        lamps = elmopp_lamps_flashing(self->junction, elmopp_junction_groups(self->junction));
    } else {
        /* nothing burns */
    }
    return lamps;
}

/* What the monitor does not pass is never driven. */
static elmopp_lamps_t judged(elmopp_controller_t *self, const elmopp_lamps_t *lamps) {
    const elmopp_monitor_input_t input = {.command = *lamps,
                                          .measured = self->bus.measured,
                                          .fresh = elmopp_bus_fresh_groups(&self->bus),
                                          .mode = self->mode};
    if ((self->mode != ELMOPP_MODE_FAIL_SAFE) && (elmopp_monitor_check(&self->monitor, &input) != ELMOPP_FAULT_NONE)) {
        raise_fault(self, self->monitor.first, self->monitor.first_group);
        enter_mode(self, ELMOPP_MODE_FAIL_SAFE);
        return elmopp_lamps_flashing(self->junction, elmopp_junction_groups(self->junction));
    }
    return *lamps;
}

/* --- frames out --- */

static uint8_t model_of(const elmopp_controller_t *self) {
    static const uint8_t models[FORESIGHTS] = {[ELMOPP_FORESIGHT_OWN] = 0U,
                                               [ELMOPP_FORESIGHT_GIVEN] = (uint8_t)ELMOPP_MODEL_GIVEN,
                                               [ELMOPP_FORESIGHT_COLD] = (uint8_t)ELMOPP_MODEL_COLD,
                                               [ELMOPP_FORESIGHT_UNARMED] = (uint8_t)ELMOPP_MODEL_UNARMED,
                                               [ELMOPP_FORESIGHT_DISTRUSTED] = (uint8_t)ELMOPP_MODEL_DISTRUSTED};
    const elmopp_forecast_t *forecast = &self->pilot.forecast;
    const uint8_t own = elmopp_forecast_is_learnt(forecast) ? (uint8_t)ELMOPP_MODEL_LEARNT : forecast->config.kind;
    return (self->pilot.foresight == ELMOPP_FORESIGHT_OWN) ? own : models[self->pilot.foresight];
}

static elmopp_outlook_t outlook_on(const elmopp_controller_t *self, uint32_t approach) {
    const elmopp_account_error_t error = elmopp_forecast_error(&self->pilot.forecast);
    return (elmopp_outlook_t){.model = model_of(self),
                              .next10_veh = self->pilot.soon_veh[0][approach],
                              .next30_veh = self->pilot.soon_veh[1][approach],
                              .next60_veh = self->pilot.foreseen_sum_veh[approach],
                              .error = error.forecast};
}

static elmopp_status_t status_of(const elmopp_controller_t *self) {
    return (elmopp_status_t){.mode = self->mode,
                             .stage = elmopp_mode_is_steady(self->mode) ? self->pilot.plan.stage
                                                                        : (elmopp_stage_t)ELMOPP_STAGE_NONE,
                             .elapsed_ds = self->pilot.plan.elapsed_ds,
                             .fault = self->fault,
                             .fault_group = self->fault_group,
                             .weights_id = self->weights_id,
                             .refused = self->bus.refused};
}

static bool is_news(const elmopp_controller_t *self, const elmopp_status_t *status) {
    const bool changed =
        (status->mode != self->told.mode) || (status->stage != self->told.stage) || (status->fault != self->told.fault);
    return changed || (self->told_ds >= DS_PER_S);
}

static uint32_t send(elmopp_controller_t *self, bool foretells, elmopp_frame_t out[ELMOPP_FRAMES_PER_TICK]) {
    uint32_t count = 0U;
    const bool fail_safe = self->mode == ELMOPP_MODE_FAIL_SAFE;
    out[count] = elmopp_frames_lamp_command(&self->lamps, fail_safe, self->mode == ELMOPP_MODE_DARK);
    elmopp_link_seal(&out[count], &self->lamp_counter);
    count++;
    const elmopp_status_t status = status_of(self);
    if (is_news(self, &status)) {
        out[count] = elmopp_frames_status(&status);
        elmopp_link_seal(&out[count], &self->status_counter);
        count++;
        self->told = status;
        self->told_ds = 0U;
    }
    for (uint32_t i = 0U; foretells && (i < self->junction->approach_count); i++) {
        const elmopp_outlook_t outlook = outlook_on(self, i);
        out[count] = elmopp_frames_forecast(i, &outlook);
        elmopp_link_seal(&out[count], &self->forecast_counter[i]);
        count++;
    }
    return count;
}

/* --- a tick --- */

uint32_t elmopp_controller_tick(elmopp_controller_t *self, elmopp_ms_t now_ms,
                                elmopp_frame_t out[ELMOPP_FRAMES_PER_TICK]) {
    if (!take_time(self, now_ms)) {
        return 0U;
    }
    const bool decides = self->second_ds == 0U;
    const bool foretells = self->second_ds == FORETELL_DS;
    self->second_ds = (uint8_t)((self->second_ds + 1U) % DS_PER_S);
    age(self);
    if (decides) {
        every_second(self);
    } else if (foretells) {
        elmopp_pilot_look_on(&self->pilot);
    } else {
        /* a tick for the lamps alone */
    }
    diagnose(self);
    test_lamps(self);
    change_mode(self);
    const elmopp_lamps_t lamps = lamps_of_mode(self);
    self->lamps = judged(self, &lamps);
    return send(self, foretells, out);
}
