/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// What tools/bench-cortex-m4 counts: each piece of work between two marks, and its key on a line of standard output.
/// The n-th line belongs to the n-th pair of marks. A key comes once for every input that is tried. With the argument
/// `stack` it says instead how many bytes of stack elmopp_controller_tick() has used at most, by what it has
/// overwritten.
///
/// - nothing: two marks, one after the other.
/// - thousand: a thousand instructions of one cycle.
/// - lstm_f32_step: a step of the plain LSTM, over weights, inputs and states from zero to 1e30 and subnormal ones.
/// - nlstm3_f32_step: the same of three nested levels.
/// - lstm_q15_step, nlstm3_q15_step: the same in whole numbers, weights of any that a row may have.
/// - train_w30: a sample of 30 steps, 10 of them fed, and an update (elmopp/trainer.h), one level, weights, inputs and
///   states as above; nlstm3_train_w30: the same of three.
/// - learner_see, learner_work: a second of elmopp_learner_see() and elmopp_learner_work() on traffic that the network
///   does not know, one group: whatever its turn is.
/// - keeper_save: elmopp_keeper_tick() in which what was learnt begins to be stored, in a medium as the STM32F405's.
/// - keeper_store: 64 words of it, as a board carries them out in a tick; the last ones are followed by a look at all.
/// - rollout60_f32, rollout60_q15: elmopp_forecast_look() over 60 s, kinds lstm and lstm-q15, one group of four
///   approaches.
/// - quantize, quantize3: elmopp_lstm_quantize() of one level and of three.
/// - tick_worst.C[:F]: elmopp_pilot_step() and a lamp tick, chooser C with forecast F at its own horizon (where nothing
///   is said, lstm for cumulative and rollout; the others look at none), eight stages, twelve movements (the paper's
///   junction with a constant saturation flow), somebody everywhere; lstm-learn: lstm and a learner, which works in
///   another tick.
/// - tick_worst_rest.rollout[:F]: elmopp_pilot_look_on() and the next lamp tick: the rest of the minute, where C looks
///   less far.
/// - tick_two_groups.C[:F], tick_two_groups_rest.C[:F]: both at site five_way: two groups of approaches, eleven stages,
///   eleven movements.
/// - tick.lamp: elmopp_controller_tick() without a decision: site four_way, frames of every camera and node.
/// - tick.rest: the one after a decision; tick.decision: the one with it: chooser rollout, forecast lstm, 17 stages.
/// - tick.lamp:F, tick.rest:F, tick.decision:F: the same with another forecast; learn: of a site that learns on.

#include "bench.h"
#include "count_marks.h"
#include "elmopp/keeper.h"
#include "elmopp/learner.h"
#include "elmopp/pressure.h"
#include "elmopp/priced.h"
#include "elmopp/rollout.h"
#include "elmopp/station.h"
#include "elmopp/urgency.h"
#include "elmopp_weights.h"
#include "random.h"
#include "sites.h"

#include <stdio.h>
#include <string.h>

#define STEP_CASES 200U
#define TRAIN_CASES 9U
#define LEARNER_S 150U
#define FREE_RUNS 20U
#define WARM_S 70U    ///< a forecast is warm, its account and the chooser's have something in them
#define LOAD_S 25U    ///< so long there are few, some or many
#define DECISIONS 90U ///< of each chooser
#define TICKS_SEED 7U ///< every chooser with every forecast decides on the same counts
#define STREET_S 175U
#define STREETS 4U

typedef enum {
    VALUES_ZERO,
    VALUES_ORDINARY,   ///< below 4 in size
    VALUES_SATURATING, ///< below 128
    VALUES_LARGE,      ///< up to 1e30
    VALUES_TINY,       ///< subnormal
    VALUES_COUNT
} values_t;

static uint64_t seed = 1U;
static elmopp_lstm_f32_weights_t weights;
static elmopp_lstm_f32_state_t state;
static elmopp_lstm_q15_weights_t whole_weights;
static elmopp_lstm_q15_state_t whole_state;
static float input[ELMOPP_LSTM_INPUTS];

/* --- numbers --- */

static float within(float size) {
    return ((float)random_below(&seed, 1U << 24U) - 8388608.0F) * (size / 8388608.0F);
}

static float subnormal(void) {
    const uint32_t bits = random_below(&seed, 1U << 23U);
    float value;
    (void)memcpy(&value, &bits, sizeof value);
    return value;
}

static float value_of(values_t kind) {
    static const float size[VALUES_COUNT] = {0.0F, 4.0F, 128.0F, 1.0e30F, 0.0F};
    return (kind == VALUES_TINY) ? subnormal() : within(size[kind]);
}

static void fill(float *values, uint32_t count, values_t kind) {
    for (uint32_t i = 0U; i < count; i++) {
        values[i] = value_of(kind);
    }
}

/* --- the network --- */

static void make_weights(uint32_t levels, values_t kind) {
    weights.levels = levels;
    fill(weights.outer.bias, ELMOPP_LSTM_GATES, kind);
    fill(weights.outer.row[0], ELMOPP_LSTM_OUTER_ROWS * ELMOPP_LSTM_GATES, kind);
    for (uint32_t i = 0U; i < (ELMOPP_LSTM_LEVELS_MAX - 1U); i++) {
        fill(weights.inner[i].bias, ELMOPP_LSTM_GATES, kind);
        fill(weights.inner[i].row[0], ELMOPP_LSTM_INNER_ROWS * ELMOPP_LSTM_GATES, kind);
    }
}

static void count_steps(const char *key, uint32_t levels) {
    for (uint32_t i = 0U; i < STEP_CASES; i++) {
        make_weights(levels, ((i % 4U) == 3U) ? VALUES_SATURATING : VALUES_ORDINARY);
        fill(input, ELMOPP_LSTM_INPUTS, (values_t)(i % VALUES_COUNT));
        fill(state.hidden, ELMOPP_LSTM_UNITS, (values_t)((i / VALUES_COUNT) % VALUES_COUNT));
        fill(state.cell[0], ELMOPP_LSTM_LEVELS_MAX * ELMOPP_LSTM_UNITS, (values_t)((i / VALUES_COUNT) % VALUES_COUNT));
        COUNT_BEGIN();
        elmopp_lstm_f32_step(&weights, &state, input);
        COUNT_END();
        (void)puts(key);
    }
}

/* Any weight of 16 bits, any scale and bias that a row may have. */
static void make_whole_weights(uint32_t levels) {
    static const float low[ELMOPP_LSTM_INPUTS] = {-4.0F, -4.0F, -4.0F, -4.0F};
    static const float high[ELMOPP_LSTM_INPUTS] = {4.0F, 4.0F, 4.0F, 4.0F};
    (void)elmopp_lstm_quantize(&weights, low, high, &whole_weights);
    whole_weights.levels = levels;
}

static void fill_whole(int32_t *values, uint32_t count, values_t kind) {
    static const uint32_t size_bits[VALUES_COUNT] = {1U, 22U, 27U, 31U, 4U};
    for (uint32_t i = 0U; i < count; i++) {
        const int32_t size = (int32_t)random_below(&seed, (uint32_t)1U << size_bits[kind]);
        values[i] = (random_below(&seed, 2U) == 0U) ? size : -size;
    }
}

static void count_whole_steps(const char *key, uint32_t levels) {
    for (uint32_t i = 0U; i < STEP_CASES; i++) {
        const values_t kind = (values_t)((i / VALUES_COUNT) % VALUES_COUNT);
        make_weights(levels, ((i % 4U) == 3U) ? VALUES_ZERO : VALUES_ORDINARY);
        make_whole_weights(levels);
        fill(input, ELMOPP_LSTM_INPUTS, (values_t)(i % VALUES_COUNT));
        fill_whole(whole_state.cell[0], ELMOPP_LSTM_LEVELS_MAX * ELMOPP_LSTM_UNITS, kind);
        for (uint32_t r = 0U; r < ELMOPP_LSTM_UNITS; r++) {
            whole_state.hidden[r] = (int16_t)(random_below(&seed, 65535U) - 32767);
        }
        COUNT_BEGIN();
        elmopp_lstm_q15_step(&whole_weights, &whole_state, input);
        COUNT_END();
        (void)puts(key);
    }
}

static void count_quantizing(const char *key, uint32_t levels) {
    static const float low[ELMOPP_LSTM_INPUTS] = {0.0F, 0.0F, 0.0F, 0.0F};
    static const float high[ELMOPP_LSTM_INPUTS] = {4.0F, 4.0F, 4.0F, 4.0F};
    for (uint32_t i = 0U; i < FREE_RUNS; i++) {
        make_weights(levels, ((i % 4U) == 3U) ? VALUES_ZERO : VALUES_ORDINARY);
        COUNT_BEGIN();
        (void)elmopp_lstm_quantize(&weights, low, high, &whole_weights);
        COUNT_END();
        (void)puts(key);
    }
}

/* --- training --- */

static void count_training(const char *key, uint32_t levels) {
    static elmopp_trainer_memory_t memory;
    static elmopp_trainer_inner_memory_t inner;
    static float seen[ELMOPP_TRAINER_WINDOW + 1U][ELMOPP_LSTM_INPUTS];
    static const float low[ELMOPP_LSTM_INPUTS] = {0.0F, 0.0F, 0.0F, 0.0F};
    static const float high[ELMOPP_LSTM_INPUTS] = {4.0F, 4.0F, 4.0F, 4.0F};
    const elmopp_trainer_sample_t sample = {.before = &state,
                                            .seen = (const float (*)[ELMOPP_LSTM_INPUTS])seen,
                                            .steps = ELMOPP_TRAINER_WINDOW,
                                            .fed = 10U,
                                            .unscored = 5U,
                                            .inputs = ELMOPP_LSTM_INPUTS,
                                            .low = low,
                                            .high = high};
    elmopp_trainer_t trainer;
    for (uint32_t i = 0U; i < TRAIN_CASES; i++) {
        const values_t kind = (values_t)(i % VALUES_LARGE); /* slopes that are no numbers are thrown away */
        make_weights(levels, (i < VALUES_LARGE) ? VALUES_ORDINARY : kind);
        fill(seen[0], (ELMOPP_TRAINER_WINDOW + 1U) * ELMOPP_LSTM_INPUTS, (i == 0U) ? VALUES_TINY : kind);
        fill(state.hidden, ELMOPP_LSTM_UNITS, kind);
        fill(state.cell[0], ELMOPP_LSTM_LEVELS_MAX * ELMOPP_LSTM_UNITS, kind);
        elmopp_trainer_init(&trainer, &memory, &inner, &weights);
        COUNT_BEGIN();
        (void)elmopp_trainer_take(&trainer, &sample);
        (void)elmopp_trainer_update(&trainer, 1.0e-4F);
        COUNT_END();
        (void)puts(key);
    }
}

static elmopp_learning_t learning;

/* Traffic that goes up and down as the shipped network has never seen it. */
static void count_learner(void) {
    elmopp_learner_t *learner = &learning.learner;
    static elmopp_lstm_f32_state_t shipped[ELMOPP_LEARNER_GROUPS_MAX];
    elmopp_learner_second_t second;
    (void)memset(&second, 0, sizeof second);
    elmopp_learner_init(learner, &learning.trainer, NULL, &elmopp_weights_lstm, ELMOPP_LEARNER_CAREFUL,
                        ELMOPP_LSTM_INPUTS);
    for (uint32_t t = 0U; t < LEARNER_S; t++) {
        for (uint32_t k = 0U; k < ELMOPP_LSTM_INPUTS; k++) {
            second.input[0][k] = 0.1F * (float)((t * (k + 1U)) % 20U);
            second.came[0][k] = second.input[0][k];
        }
        elmopp_lstm_f32_step(&elmopp_weights_lstm.lstm, &shipped[0], second.input[0]);
        const bool is_counted = t > ELMOPP_TRAINER_WINDOW;
        if (is_counted) {
            COUNT_BEGIN();
            elmopp_learner_see(learner, &second);
            COUNT_END();
            (void)puts("learner_see");
            COUNT_BEGIN();
            elmopp_learner_work(learner, shipped);
            COUNT_END();
            (void)puts("learner_work");
        } else {
            elmopp_learner_see(learner, &second);
            elmopp_learner_work(learner, shipped);
        }
    }
}

/* Arrivals of a second: some of few, some of many, never the same. */
static void arrive(float *arrived_veh, uint32_t movements) {
    for (uint32_t j = 0U; j < movements; j++) {
        arrived_veh[j] = (float)random_below(&seed, 1000U) / 1000.0F;
    }
}

static void count_free_runs(const char *key, uint8_t kind) {
    static elmopp_forecast_t forecast;
    const elmopp_forecast_config_t config = {.kind = kind, .weights = &elmopp_weights_lstm};
    const float *rows[ELMOPP_APPROACH_MAX];
    float arrived_veh[ELMOPP_MOVEMENT_MAX];
    elmopp_forecast_init(&forecast, &elmopp_site_paper, &config);
    for (uint32_t t = 0U; t < (WARM_S + FREE_RUNS); t++) {
        arrive(arrived_veh, elmopp_site_paper.movement_count);
        elmopp_forecast_observe(&forecast, arrived_veh);
        if (t >= WARM_S) {
            COUNT_BEGIN();
            (void)elmopp_forecast_look(&forecast, ELMOPP_PILOT_TRACE_S, rows);
            COUNT_END();
            (void)puts(key);
        }
    }
}

/* Somebody is on every movement: by turns few, some and many. */
static float waiting(uint32_t second) {
    static const float least_veh[] = {0.2F, 3.0F, 10.0F};
    static const uint32_t hundredths[] = {300U, 2000U, 5000U};
    const uint32_t load = (second / LOAD_S) % 3U;
    return least_veh[load] + (0.01F * (float)random_below(&seed, hundredths[load]));
}

/* --- the choosers --- */

typedef elmopp_chooser_t (*make_fn_t)(void);

static elmopp_urgency_t urgency;

static elmopp_chooser_t make_urgency(bool cumulative) {
    const elmopp_urgency_options_t options = {.min_s = 10U, .max_s = 60U, .hysteresis = 1.0F, .cumulative = cumulative};
    return elmopp_urgency_init(&urgency, &options);
}

static elmopp_chooser_t make_naive(void) {
    return make_urgency(false);
}

static elmopp_chooser_t make_cumulative(void) {
    return make_urgency(true);
}

static elmopp_chooser_t make_pressure(void) {
    static elmopp_pressure_t pressure = {.ratio = ELMOPP_PRESSURE_RATIO, .min_s = 10U, .max_s = 60U};
    return elmopp_pressure_init(&pressure);
}

static elmopp_chooser_t make_priced(void) {
    static elmopp_priced_t priced;
    return elmopp_priced_init(&priced, 10U, 60U);
}

static elmopp_chooser_t make_rollout(void) {
    static elmopp_rollout_t rollout;
    const elmopp_rollout_options_t options = elmopp_rollout_defaults(0U);
    return elmopp_rollout_init(&rollout, &options);
}

/* The lamp tick after a decision. `key` is of the decision's: what comes before its point gets `_rest`. */
static void count_rest(const char *key, elmopp_pilot_t *pilot) {
    const int group = (int)strcspn(key, ".");
    COUNT_BEGIN();
    elmopp_pilot_look_on(pilot);
    (void)elmopp_pilot_lamp_tick(pilot, pilot->wanted, false);
    COUNT_END();
    (void)printf("%.*s_rest%s\n", group, key, &key[group]);
}

static void count_ticks_with(const char *key, make_fn_t make, uint8_t kind, const elmopp_junction_t *site,
                             elmopp_learner_t *learner) {
    static elmopp_junction_t junction;
    static elmopp_pilot_t pilot;
    const bool nested = elmopp_forecast_is_nested(kind);
    const elmopp_forecast_config_t forecast = {
        .kind = kind, .weights = nested ? &elmopp_weights_nlstm : &elmopp_weights_lstm, .learner = learner};
    float present_veh[ELMOPP_MOVEMENT_MAX];
    float arrived_veh[ELMOPP_MOVEMENT_MAX];
    const elmopp_counts_t counts = {.present_veh = present_veh, .arrived_veh = arrived_veh, .recall = 0U};
    seed = TICKS_SEED;
    junction = *site;
    junction.discharge = (uint8_t)ELMOPP_DISCHARGE_SATURATION;
    const elmopp_chooser_t chooser = make();
    elmopp_pilot_init(&pilot, &junction, &chooser, &forecast);
    for (uint32_t t = 0U; t < (WARM_S + DECISIONS); t++) {
        arrive(arrived_veh, junction.movement_count);
        for (uint32_t j = 0U; j < junction.movement_count; j++) {
            present_veh[j] = waiting(t);
        }
        const bool is_counted = t >= WARM_S;
        if (is_counted) {
            COUNT_BEGIN();
        }
        (void)elmopp_pilot_step(&pilot, &counts, NULL);
        (void)elmopp_pilot_lamp_tick(&pilot, pilot.wanted, false);
        if (is_counted) {
            COUNT_END();
            (void)puts(key);
        }
        if (is_counted && (chooser.horizon_s == ELMOPP_ACCOUNT_PROBE_S)) {
            count_rest(key, &pilot);
        } else {
            elmopp_pilot_look_on(&pilot);
            (void)elmopp_pilot_lamp_tick(&pilot, pilot.wanted, false);
        }
        for (uint32_t i = 2U; i < ELMOPP_LAMP_TICKS_PER_S; i++) {
            (void)elmopp_pilot_lamp_tick(&pilot, pilot.wanted, false);
        }
    }
}

static void count_ticks(const char *key, make_fn_t make, uint8_t kind, const elmopp_junction_t *site) {
    count_ticks_with(key, make, kind, site, NULL);
}

static void count_ticks_learning(const char *key, make_fn_t make, const elmopp_junction_t *site) {
    elmopp_learner_init(&learning.learner, &learning.trainer, NULL, &elmopp_weights_lstm, ELMOPP_LEARNER_CAREFUL,
                        site->approach_count);
    count_ticks_with(key, make, ELMOPP_FORECAST_LSTM, site, &learning.learner);
}

/* --- the whole controller, on frames --- */

#define PAINT 0xDEADBEEFU
#define PAINTED_WORDS 2000U

static elmopp_station_t station;
static bool is_street_counted;
static const char *street_name;
static bool is_stack_wanted;
static uint32_t stack_words;

/* Below the stack pointer nothing is anybody's: no interrupt is enabled. Inline, so that it is the caller's pointer. */
__attribute__((always_inline)) static inline volatile uint32_t *paint(void) {
    volatile uint32_t *top;
    __asm__ volatile("mov %0, sp" : "=r"(top));
    for (uint32_t k = 1U; k <= PAINTED_WORDS; k++) {
        *(top - k) = PAINT;
    }
    return top;
}

static void look_at_paint(const volatile uint32_t *top) {
    for (uint32_t k = stack_words + 1U; k <= PAINTED_WORDS; k++) {
        stack_words = (*(top - k) != PAINT) ? k : stack_words;
    }
}

uint32_t __real_elmopp_controller_tick(elmopp_controller_t *self, elmopp_ms_t now_ms, elmopp_frame_t *out);
uint32_t __wrap_elmopp_controller_tick(elmopp_controller_t *self, elmopp_ms_t now_ms, elmopp_frame_t *out);

/* The linker puts this one in the place of the controller's, and calls that one __real (option --wrap). */
uint32_t __wrap_elmopp_controller_tick(elmopp_controller_t *self, elmopp_ms_t now_ms, elmopp_frame_t *out) {
    if (is_stack_wanted) {
        volatile uint32_t *top = paint();
        const uint32_t count = __real_elmopp_controller_tick(self, now_ms, out);
        look_at_paint(top);
        return count;
    }
    if (!is_street_counted) {
        return __real_elmopp_controller_tick(self, now_ms, out);
    }
    static const char *const keys[] = {"tick.decision", "tick.rest", "tick.lamp"};
    const uint32_t tick = self->second_ds;
    COUNT_BEGIN();
    const uint32_t frames = __real_elmopp_controller_tick(self, now_ms, out);
    COUNT_END();
    (void)printf("%s%s\n", keys[(tick < 2U) ? tick : 2U], street_name);
    return frames;
}

static void count_street(const char *name, uint8_t forecast, bool learns) {
    static bench_t bench;
    static elmopp_junction_t junction;
    static const elmopp_ar8_t no_regression;
    const elmopp_weights_t *base = elmopp_forecast_is_nested(forecast) ? &elmopp_weights_nlstm : &elmopp_weights_lstm;
    const elmopp_station_weights_t shipped = {.base = base, .learnt = NULL};
    const elmopp_station_room_t room = {.learning = &learning, .inner = NULL};
    is_street_counted = false;
    street_name = name;
    junction = elmopp_site_four_way;
    junction.chooser = (uint8_t)ELMOPP_CHOOSER_ROLLOUT;
    junction.forecast = forecast;
    junction.learning = learns ? 1U : 0U;
    bench_start(&bench, &junction);
    /* The bench's controller asks the bench; here it is one as a board has it. */
    elmopp_station_init(&station, &junction, &no_regression, &shipped, &room);
    bench.controller = station.controller;
    (void)bench_until(&bench, ELMOPP_MODE_AUTOMATIC, 1000U);
    for (uint32_t t = 0U; t < STREET_S; t++) {
        is_street_counted = t >= WARM_S;
        for (uint32_t j = 0U; j < junction.movement_count; j++) {
            bench.present_veh[j] = (uint16_t)(1.0F + waiting(t));
            bench.arrived_veh[j] += random_below(&seed, 2U);
        }
        bench_ticks(&bench, ELMOPP_LAMP_TICKS_PER_S);
    }
}

/* Each time with other vehicles: how many stages are looked at depends on them. */
static void count_streets(const char *name, uint8_t forecast, bool learns) {
    for (uint32_t k = 0U; k < STREETS; k++) {
        count_street(name, forecast, learns);
    }
}

/* --- what was learnt, on its way into the flash --- */

#define SECTOR_BYTES 0x20000U
#define ORDERS_A_TICK 64U

static uint32_t flash[(2U * SECTOR_BYTES) / sizeof(uint32_t)];
static elmopp_keeper_t keeper;

static void program(const elmopp_store_order_t *order) {
    uint32_t *word = &flash[order->at / sizeof(uint32_t)];
    if (order->action == ELMOPP_STORE_ERASE) {
        (void)memset(word, 0xFF, SECTOR_BYTES);
    } else {
        *word &= order->word;
    }
}

static bool store_some(uint32_t orders) {
    elmopp_transfer_kind_t kind;
    elmopp_store_order_t order;
    bool something = false;
    for (uint32_t k = 0U; (k < orders) && elmopp_keeper_next(&keeper, &kind, &order); k++) {
        program(&order);
        elmopp_keeper_answer(&keeper, kind, ELMOPP_STORE_DONE);
        something = true;
    }
    return something;
}

/* After a street that has learnt: its learner is said to be better. */
static void count_keeping(void) {
    const elmopp_keeper_config_t config = {.weights = {(const uint8_t *)flash, 2U, SECTOR_BYTES, 3U, 0xA000U, false},
                                           .save_min_s = 0U};
    elmopp_frame_t out[ELMOPP_KEEPER_FRAMES];
    uint32_t count = 0U;
    elmopp_controller_t *controller = &station.controller;
    elmopp_learner_t *learner = controller->pilot.forecast.config.learner;
    elmopp_keeper_init(&keeper, &config);
    (void)store_some(ELMOPP_KEEPER_TIDY_ORDERS_MAX);
    learner->in_use = true;
    learner->error = (elmopp_learner_error_t){.shipped = 1.0F, .learnt = 0.5F, .judged = ELMOPP_LEARNER_JUDGED_WINDOW};
    controller->pilot.foresight = ELMOPP_FORESIGHT_OWN;
    controller->second_ds = (uint8_t)ELMOPP_KEEPER_SAVE_DS;
    COUNT_BEGIN();
    (void)elmopp_keeper_tick(&keeper, controller, out, &count);
    COUNT_END();
    (void)puts("keeper_save");
    while (keeper.store[0].phase != ELMOPP_STORE_IDLE) {
        COUNT_BEGIN();
        (void)store_some(ORDERS_A_TICK);
        COUNT_END();
        (void)puts("keeper_store");
    }
}

int main(int argc, char **argv) {
    is_stack_wanted = (argc == 2) && (strcmp(argv[1], "stack") == 0);
    if (is_stack_wanted) {
        count_street("", (uint8_t)ELMOPP_FORECAST_GCN, false); /* the way to this network is the deepest */
        (void)printf("%u\n", (unsigned)(stack_words * sizeof(uint32_t)));
        return 0;
    }
    COUNT_BEGIN();
    COUNT_END();
    (void)puts("nothing");
    COUNT_BEGIN();
    __asm__ volatile(".rept 1000\n\tnop\n\t.endr");
    COUNT_END();
    (void)puts("thousand");
    count_steps("lstm_f32_step", 1U);
    count_steps("nlstm3_f32_step", ELMOPP_LSTM_LEVELS_MAX);
    count_whole_steps("lstm_q15_step", 1U);
    count_whole_steps("nlstm3_q15_step", ELMOPP_LSTM_LEVELS_MAX);
    count_quantizing("quantize", 1U);
    count_quantizing("quantize3", ELMOPP_LSTM_LEVELS_MAX);
    count_training("train_w30", 1U);
    count_training("nlstm3_train_w30", ELMOPP_LSTM_LEVELS_MAX);
    count_learner();
    count_free_runs("rollout60_f32", ELMOPP_FORECAST_LSTM);
    count_free_runs("rollout60_q15", ELMOPP_FORECAST_LSTM_Q15);
    count_ticks("tick_worst.naive", make_naive, ELMOPP_FORECAST_NONE, &elmopp_site_paper);
    count_ticks("tick_worst.cumulative", make_cumulative, ELMOPP_FORECAST_LSTM, &elmopp_site_paper);
    count_ticks("tick_worst.cumulative:nlstm", make_cumulative, ELMOPP_FORECAST_NLSTM, &elmopp_site_paper);
    count_ticks("tick_worst.cumulative:nlstm-q15", make_cumulative, ELMOPP_FORECAST_NLSTM_Q15, &elmopp_site_paper);
    count_ticks("tick_worst.cumulative:gcn", make_cumulative, ELMOPP_FORECAST_GCN, &elmopp_site_paper);
    count_ticks("tick_worst.pressure", make_pressure, ELMOPP_FORECAST_NONE, &elmopp_site_paper);
    count_ticks("tick_worst.priced", make_priced, ELMOPP_FORECAST_NONE, &elmopp_site_paper);
    count_ticks("tick_worst.rollout", make_rollout, ELMOPP_FORECAST_LSTM, &elmopp_site_paper);
    count_ticks("tick_worst.rollout:nlstm", make_rollout, ELMOPP_FORECAST_NLSTM, &elmopp_site_paper);
    count_ticks_learning("tick_worst.cumulative:lstm-learn", make_cumulative, &elmopp_site_paper);
    count_ticks_learning("tick_worst.rollout:lstm-learn", make_rollout, &elmopp_site_paper);
    count_ticks("tick_worst.rollout:lstm-q15", make_rollout, ELMOPP_FORECAST_LSTM_Q15, &elmopp_site_paper);
    count_ticks("tick_worst.rollout:nlstm-q15", make_rollout, ELMOPP_FORECAST_NLSTM_Q15, &elmopp_site_paper);
    count_ticks("tick_worst.rollout:gcn", make_rollout, ELMOPP_FORECAST_GCN, &elmopp_site_paper);
    count_ticks("tick_two_groups.cumulative", make_cumulative, ELMOPP_FORECAST_LSTM, &elmopp_site_five_way);
    count_ticks("tick_two_groups.rollout", make_rollout, ELMOPP_FORECAST_LSTM, &elmopp_site_five_way);
    count_ticks("tick_two_groups.cumulative:nlstm", make_cumulative, ELMOPP_FORECAST_NLSTM, &elmopp_site_five_way);
    count_ticks("tick_two_groups.cumulative:nlstm-q15", make_cumulative, ELMOPP_FORECAST_NLSTM_Q15,
                &elmopp_site_five_way);
    count_ticks("tick_two_groups.cumulative:gcn", make_cumulative, ELMOPP_FORECAST_GCN, &elmopp_site_five_way);
    count_ticks("tick_two_groups.rollout:nlstm", make_rollout, ELMOPP_FORECAST_NLSTM, &elmopp_site_five_way);
    count_ticks("tick_two_groups.rollout:gcn", make_rollout, ELMOPP_FORECAST_GCN, &elmopp_site_five_way);
    count_ticks_learning("tick_two_groups.rollout:lstm-learn", make_rollout, &elmopp_site_five_way);
    count_streets("", (uint8_t)ELMOPP_FORECAST_LSTM, false);
    count_streets(":nlstm", (uint8_t)ELMOPP_FORECAST_NLSTM, false);
    count_streets(":gcn", (uint8_t)ELMOPP_FORECAST_GCN, false);
    count_streets(":learn", (uint8_t)ELMOPP_FORECAST_LSTM, true);
    count_keeping();
    return 0;
}
