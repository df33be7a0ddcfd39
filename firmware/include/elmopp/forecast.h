/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Forecast: the vehicles that each approach will bring in the coming seconds, and how they split over its movements.
///
/// Absorbs one observation a second, looks ahead as far as the chooser asks and keeps account of its own error. It
/// decides nothing: whether a forecast is good enough to be used is the pilot's to say. `oracle` is not here: a
/// simulator that knows the future hands its rows to elmopp_pilot_step() itself.
///
/// - none: no row; the chooser sees no further inflow.
/// - mean: the given long-run mean, or the running mean of the last 15 minutes, in every step.
/// - persistence: the last second in every step.
/// - ewma: an exponentially weighted mean, time constant 120 s, in every step.
/// - ar8: a regression over the last eight seconds (ar8.h). The mean until eight seconds have been seen.
/// - lstm, nlstm: a network (lstm_f32.h) of one level, or of more, that sees every second and runs on its own output,
///   from a copy of its state.
/// - lstm-q15, nlstm-q15: the same networks in whole numbers (lstm_q15.h), made of the same weights.
/// - ann: a plain network (ann_f32.h) that sees the last 16 seconds and runs on its own output.
/// - gcn: a network over the graph of the approaches (gcn_f32.h), which sees the last 32 seconds of each and runs on
///   its own output. Two approaches are joined if they meet in the junction: a movement of one conflicts with one of
///   the other.
///
/// All networks say the mean until 60 seconds have been seen, or if their weights are refused. They see arrivals /
/// demand scale, at most and at least what the weights say, and what they say is held in the same range. All but gcn
/// have four inputs: approaches go in groups of four in site order, each group for itself, the same weights; an input
/// without approach is 0 and what is said about it is ignored. For gcn each approach is a node, whatever their number.
///
/// Whole vehicles are no flow: of 0.3 vehicles/s a camera sees 0, 0, 1, 0. A network that is fed so sees a second of 3
/// to 10 times the mean between seconds of none, and is worse than the mean. So where arrivals are `whole` a network is
/// its own observer: what it is fed is what it would have said of this second, corrected by a tenth (a twentieth for
/// windows) of what the count says more or less, in the first seconds by one over their number. The account compares
/// with the counts themselves, whose noise is the same in the network's error and in the mean's.
///
/// lstm and nlstm may learn on (learner.h): then every second goes to the learner too, and the rows are by the learnt
/// weights whenever its guard has them in use. Who does not hand a learner in pays nothing for it but a pointer. The
/// work of learning is put off until elmopp_forecast_learn(): a decision does not wait for it.
///
/// The demand scale is the given mean or the running one: causal either way. Running means weigh the n-th observation
/// by 1 / min(n, window), exact averages until the window is full and exponential ones after it: no ring of 900 values.
///
/// What it says is entered in an account of its error (account.h). What neighbours announce (outflow.h) is laid over
/// the beginning of rows afterwards.
///
/// Owner: the pilot. Not thread-safe; bounded by ELMOPP_APPROACH_MAX times the steps asked for.

#ifndef ELMOPP_FORECAST_H
#define ELMOPP_FORECAST_H

#include "elmopp/account.h"
#include "elmopp/ar8.h"
#include "elmopp/junction.h"
#include "elmopp/learner.h"
#include "elmopp/lstm_q15.h"
#include "elmopp/lstm_quantize.h"
#include "elmopp/outflow.h"
#include "elmopp/weights.h"

#define ELMOPP_FORECAST_MEAN_WINDOW_S 900U ///< running mean and shares
#define ELMOPP_FORECAST_EWMA_WINDOW_S 120U
#define ELMOPP_FORECAST_SHARE_MIN_S 60U ///< shares are equal until so many seconds have been seen
#define ELMOPP_FORECAST_COLD_S 60U      ///< a network says the mean until so many seconds have been seen

/// Share of a count's surprise that a network is fed, where vehicles are counted whole.
#define ELMOPP_FORECAST_GAIN 0.1F
#define ELMOPP_FORECAST_WINDOW_GAIN 0.05F ///< of ann and gcn, which see every second as often as their window is long

/// Seconds that are remembered one by one: the longest window of a network.
#define ELMOPP_FORECAST_PAST_S ELMOPP_GCN_WINDOW_S
static_assert(ELMOPP_FORECAST_PAST_S >= ELMOPP_ANN_WINDOW_S, "every window is remembered");
static_assert(ELMOPP_FORECAST_PAST_S >= ELMOPP_AR8_LAGS, "every lag is remembered");
static_assert(ELMOPP_FORECAST_COLD_S >= ELMOPP_FORECAST_PAST_S, "no window is read before it is full");

/// Approaches that one state of a network looks after, and how many states a junction needs at most.
#define ELMOPP_FORECAST_GROUP_SIZE ELMOPP_LSTM_INPUTS
#define ELMOPP_FORECAST_GROUP_MAX (ELMOPP_APPROACH_MAX / ELMOPP_FORECAST_GROUP_SIZE)
static_assert((ELMOPP_APPROACH_MAX % ELMOPP_FORECAST_GROUP_SIZE) == 0U, "every approach is in a group");
static_assert(ELMOPP_LEARNER_GROUPS_MAX == ELMOPP_FORECAST_GROUP_MAX, "the learner deals the same groups");
static_assert(ELMOPP_ANN_INPUTS == ELMOPP_FORECAST_GROUP_SIZE, "both kinds of network deal the same groups");

/// Which forecast, and its data. The pointers must outlive the forecast.
typedef struct {
    uint8_t kind;                    ///< ELMOPP_FORECAST_* (junction.h)
    const elmopp_ar8_t *ar8;         ///< [approach], for ar8 only
    const float *mean_veh_per_s;     ///< [approach] long-run means; null: running means
    const elmopp_weights_t *weights; ///< for the networks; null: none could be loaded
    elmopp_learner_t *learner;       ///< for lstm and nlstm: begun with these weights; null: nothing is learnt
    bool whole;                      ///< arrivals are counted one by one; false: they are rates, exact to the fraction
} elmopp_forecast_config_t;

/// Why the rows are what they are.
typedef enum {
    ELMOPP_FORECAST_READY = 0, ///< as the kind says
    ELMOPP_FORECAST_COLD,      ///< the mean: too little has been seen
    ELMOPP_FORECAST_UNARMED ///< the mean: there are no weights, or not such as the kind needs, or they fail their check
} elmopp_forecast_status_t;

/// A network on its own output, as far as it has run: it can run on.
typedef struct {
    elmopp_lstm_f32_state_t f32[ELMOPP_FORECAST_GROUP_MAX]; ///< copies of what a recurrent one remembers ...
    elmopp_lstm_q15_state_t q15[ELMOPP_FORECAST_GROUP_MAX];
    float said[ELMOPP_FORECAST_GROUP_MAX][ELMOPP_FORECAST_GROUP_SIZE]; ///< ... and what it is fed next
    float past[ELMOPP_APPROACH_MAX][ELMOPP_FORECAST_PAST_S];           ///< windows of those that see windows
} elmopp_forecast_run_t;

/// State. Set up by elmopp_forecast_init(); nobody else writes it.
typedef struct {
    elmopp_forecast_config_t config;
    const elmopp_junction_t *junction;
    bool armed;      ///< the weights can be used
    uint32_t seen_s; ///< observations so far; saturates at UINT32_MAX
    float mean_veh[ELMOPP_APPROACH_MAX];
    float ewma_veh[ELMOPP_APPROACH_MAX];
    float movement_mean_veh[ELMOPP_MOVEMENT_MAX];
    float share[ELMOPP_MOVEMENT_MAX];
    float last_veh[ELMOPP_APPROACH_MAX][ELMOPP_FORECAST_PAST_S]; ///< [0] is the newest second, as it is believed
    elmopp_lstm_q15_weights_t q15;                               ///< for lstm-q15 and nlstm-q15: made of the weights
    elmopp_lstm_f32_state_t memory[ELMOPP_FORECAST_GROUP_MAX];   ///< of a recurrent network ...
    elmopp_lstm_q15_state_t whole_memory[ELMOPP_FORECAST_GROUP_MAX]; ///< ... and of one in whole numbers
    elmopp_gcn_f32_graph_t graph;                                    ///< of the approaches
    elmopp_account_t account;
    elmopp_forecast_run_t run;
    uint16_t said_s; ///< steps of the rows that have been said since the last observation
    float row_veh[ELMOPP_APPROACH_MAX][ELMOPP_HORIZON_MAX];
} elmopp_forecast_t;

/// Starts cold. Asserts a known kind, and coefficients for ar8. Weights that cannot be used are no bug: see the status.
void elmopp_forecast_init(elmopp_forecast_t *self, const elmopp_junction_t *junction,
                          const elmopp_forecast_config_t *config);

/// Goes on with other weights, or with those that it has and that are others now. What was seen stays; what a network
/// remembers of it goes if `anew`, as it was another network's, and a learner begins anew with them. The weights that
/// were used before are no longer looked at.
void elmopp_forecast_rearm(elmopp_forecast_t *self, const elmopp_weights_t *weights, bool anew);

/// Absorbs the vehicles per movement of one second: finite, >= 0.
void elmopp_forecast_observe(elmopp_forecast_t *self, const float *arrivals_veh);

/// Learns from the second that was observed last, if there is a learner: at most once between two observations, when
/// there is time. Who never calls it learns nothing.
void elmopp_forecast_learn(elmopp_forecast_t *self);

/// Fills `rows[approach]` with pointers to `steps` (at most ELMOPP_HORIZON_MAX) values each, valid until the next call,
/// and returns the steps; with `none` the rows are null and it returns 0. Call it once after each observation: what it
/// says is entered in the account.
uint16_t elmopp_forecast_look(elmopp_forecast_t *self, uint16_t steps, const float *rows[ELMOPP_APPROACH_MAX]);

/// Says more of the same rows, until `steps`, any time before the next observation; rows are as there. What has been
/// said already may have been written over; it stays so.
uint16_t elmopp_forecast_look_on(elmopp_forecast_t *self, uint16_t steps, const float *rows[ELMOPP_APPROACH_MAX]);

/// Fills the rows with the mean instead, whatever the kind (but `none`): what a caller falls back to.
uint16_t elmopp_forecast_fall_back(elmopp_forecast_t *self, uint16_t steps, const float *rows[ELMOPP_APPROACH_MAX]);

/// Lays what neighbours say ([approach]) over rows that are there, of `steps` seconds; where there are none (0) over
/// rows of nobody of `asked` seconds, and the row of an approach whose neighbour is silent is null: nothing is known of
/// it. Returns the steps of the rows, which are then the forecast's own memory. If no neighbour says anything, rows and
/// steps stay as they are. The account knows nothing of it: it is of the forecast.
uint16_t elmopp_forecast_hear(elmopp_forecast_t *self, const elmopp_outflow_t outflow[ELMOPP_APPROACH_MAX],
                              uint16_t asked, uint16_t steps, const float *rows[ELMOPP_APPROACH_MAX]);

/// True for the kinds that need weights, which are those that can be distrusted: lstm and nlstm in either arithmetic,
/// ann and gcn.
bool elmopp_forecast_is_network(uint8_t kind);

/// True for the kinds whose recurrent network has more than one level: nlstm in either arithmetic.
bool elmopp_forecast_is_nested(uint8_t kind);

/// Whether this kind can use such weights: they pass their check, and the recurrent network in them has one level for
/// lstm, more for nlstm; in whole numbers no row of it can overflow, which elmopp_forecast_quantized() says. False for
/// null, and for a kind that needs none.
bool elmopp_forecast_fits(uint8_t kind, const elmopp_weights_t *weights);

/// What elmopp_lstm_quantize_check() (lstm_quantize.h) says of weights that have passed their check, fed as they are
/// here: with 0 to their clamp's upper end.
elmopp_lstm_quantized_t elmopp_forecast_quantized(const elmopp_weights_t *weights);

/// Whether a learner's guard has what was learnt in use.
bool elmopp_forecast_is_learnt(const elmopp_forecast_t *self);

/// Why the rows of elmopp_forecast_look() are what they are.
elmopp_forecast_status_t elmopp_forecast_status(const elmopp_forecast_t *self);

/// The account so far.
elmopp_account_error_t elmopp_forecast_error(const elmopp_forecast_t *self);

/// Share of each movement in its approach's arrivals: [movement], sums to 1 over an approach.
const float *elmopp_forecast_share(const elmopp_forecast_t *self);

#endif
