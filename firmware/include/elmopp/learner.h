/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Learner: has a recurrent network learn from the traffic that it sees, and says whether what it learnt is any good.
///
/// Once a second it sees what every group of approaches brought, in units of the demand scale and in the clamp, as the
/// network sees it (forecast.h). It keeps stretches of ELMOPP_TRAINER_WINDOW seconds with the network's state before
/// each, the last ELMOPP_LEARNER_STRETCHES of them. Whenever it is told to work, once a second and not in the moment in
/// which a decision is due, it trains on them (trainer.h) by turns:
///
///   in a cycle of ELMOPP_LEARNER_CYCLE_S seconds, one sample in each of the first ELMOPP_LEARNER_BATCH, the newest
///   stretch first, then any of those that are kept; one step of Adam in the next; in the last, a comparison of what
///   shipped and learnt weights say ELMOPP_LEARNER_AHEAD_S seconds ahead.
///
/// So no second has more to do than one sample or one comparison: three small things in place of a large one keep the
/// worst tick of the controller where it is. A cycle has one group's comparison, by turns.
///
/// The guard. What either said is held against what came. The learnt weights are used while their running error is the
/// lesser one, after ELMOPP_LEARNER_JUDGED_MIN comparisons; if it is more than ELMOPP_LEARNER_GIVE_UP times that of the
/// shipped ones, or a slope is no finite number, learning begins anew from the shipped weights. So the worst that
/// learning can do to a forecast is bounded by what the guard sees late.
///
/// The paper's own way (course ELMOPP_LEARNER_LITERAL) is one step with rate 1e-3 on the newest second, every second,
/// and no guard: it ruins the forecast (docs/measurements.md), and is here to show that.
///
/// What is learnt is lost with the memory, which is the caller's: who keeps or re-quantises it takes
/// elmopp_learner_copy(), and keeps it if elmopp_learner_is_worth_keeping() (keeper.h). Who has kept it goes on with it
/// by elmopp_learner_resume(): it is used from the beginning, as it was the better one, and the shipped weights are
/// what the guard falls back to.
///
/// Owner: the forecast's caller, who alone pays for it: 46 kB with the trainer's memory for one level
/// (elmopp_learning_t). One owner, not thread-safe, no allocation.

#ifndef ELMOPP_LEARNER_H
#define ELMOPP_LEARNER_H

#include "elmopp/bounds.h"
#include "elmopp/trainer.h"
#include "elmopp/weights.h"

#include <stdbool.h>
#include <stdint.h>

/// Stretches that are kept to be learnt from again.
#ifndef ELMOPP_LEARNER_STRETCHES
#define ELMOPP_LEARNER_STRETCHES 10U
#endif

#define ELMOPP_LEARNER_BATCH 10U ///< samples of an update
#define ELMOPP_LEARNER_CYCLE_S (ELMOPP_LEARNER_BATCH + 2U)

/// A stretch's first seconds are fed as they came, the rest is the network's own; errors count after a few.
#define ELMOPP_LEARNER_FED_S 10U
#define ELMOPP_LEARNER_UNSCORED_S 5U

#define ELMOPP_LEARNER_RATE 1.0e-4F         ///< of Adam
#define ELMOPP_LEARNER_LITERAL_RATE 1.0e-3F ///< the paper's

#define ELMOPP_LEARNER_AHEAD_S 30U       ///< what is compared is so far ahead
#define ELMOPP_LEARNER_JUDGED_WINDOW 40U ///< comparisons that the running errors remember
#define ELMOPP_LEARNER_JUDGED_MIN 15U
#define ELMOPP_LEARNER_GIVE_UP 1.5F

/// Learnt weights are worth keeping if their running error, full of comparisons, is at most this share of that of the
/// shipped ones: what is no better is not worth the wear.
#define ELMOPP_LEARNER_WORTH 0.95F

/// Groups of approaches with a state each, as the forecast deals them.
#define ELMOPP_LEARNER_GROUPS_MAX (ELMOPP_APPROACH_MAX / ELMOPP_LSTM_INPUTS)

typedef enum {
    ELMOPP_LEARNER_CAREFUL = 0, ///< batches of stretches that are kept, a guard
    ELMOPP_LEARNER_LITERAL      ///< the paper's: every second one step on the newest, whatever comes of it
} elmopp_learner_course_t;

/// A second, in units of the demand scale.
typedef struct {
    float input[ELMOPP_LEARNER_GROUPS_MAX][ELMOPP_LSTM_INPUTS]; ///< what each group's network is fed
    float came[ELMOPP_LEARNER_GROUPS_MAX][ELMOPP_LSTM_INPUTS];  ///< what really came, which errors are taken of: the
                                                                ///< same unless vehicles are counted whole (forecast.h)
} elmopp_learner_second_t;

/// A stretch of one group's seconds.
typedef struct {
    elmopp_lstm_f32_state_t before; ///< the network's, by the weights of then
    float seen[ELMOPP_TRAINER_WINDOW + 1U][ELMOPP_LSTM_INPUTS];
    uint32_t inputs; ///< approaches of the group
} elmopp_learner_stretch_t;

/// Running means of squared errors in units of the demand scale.
typedef struct {
    float shipped;
    float learnt;
    uint32_t judged; ///< comparisons; saturates at UINT32_MAX
} elmopp_learner_error_t;

/// What both said about one later second of a group.
typedef struct {
    float shipped[ELMOPP_LSTM_INPUTS];
    float learnt[ELMOPP_LSTM_INPUTS];
    uint32_t group;
    bool said;
} elmopp_learner_probe_t;

/// State. Set up by elmopp_learner_init(); nobody else writes it.
typedef struct {
    const elmopp_weights_t *shipped;
    elmopp_trainer_t trainer;
    elmopp_learner_course_t course;
    uint32_t groups;
    uint32_t inputs[ELMOPP_LEARNER_GROUPS_MAX];
    elmopp_lstm_f32_state_t memory[ELMOPP_LEARNER_GROUPS_MAX]; ///< by the learnt weights
    elmopp_learner_stretch_t growing[ELMOPP_LEARNER_GROUPS_MAX];
    uint32_t grown;                                          ///< seconds in each of them
    elmopp_learner_stretch_t kept[ELMOPP_LEARNER_STRETCHES]; ///< a ring
    uint32_t newest;
    uint32_t count;
    uint32_t second; ///< of the cycle
    uint32_t compared_group;
    uint32_t chance;                                      ///< of which stretch is next
    elmopp_learner_probe_t probe[ELMOPP_LEARNER_AHEAD_S]; ///< a ring
    uint32_t due;
    elmopp_learner_error_t error;
    uint32_t given_up; ///< how often learning began anew; saturates at UINT32_MAX
    bool in_use;       ///< the learnt weights are
} elmopp_learner_t;

/// All that learning takes with a network of one level: what a board that learns has to have room for.
typedef struct {
    elmopp_learner_t learner;
    elmopp_trainer_memory_t trainer;
} elmopp_learning_t;

/// Begins with the shipped weights, which must outlive it, for so many approaches.
void elmopp_learner_init(elmopp_learner_t *self, elmopp_trainer_memory_t *memory, elmopp_trainer_inner_memory_t *inner,
                         const elmopp_weights_t *shipped, elmopp_learner_course_t course, uint32_t approaches);

/// Begins anew with other shipped weights.
void elmopp_learner_begin(elmopp_learner_t *self, const elmopp_weights_t *shipped);

/// The shipped weights are the same and stand somewhere else from now on.
void elmopp_learner_move(elmopp_learner_t *self, const elmopp_weights_t *shipped);

/// Begins anew with what was learnt from the shipped weights before, which is copied. It is used from the beginning.
void elmopp_learner_resume(elmopp_learner_t *self, const elmopp_lstm_f32_weights_t *learnt);

/// One second: what each group's network is fed. A step of the learnt network a group.
void elmopp_learner_see(elmopp_learner_t *self, const elmopp_learner_second_t *second);

/// After that and before the next second, when there is time: one sample, one step or one comparison. What each group's
/// network remembers by the shipped weights. A second without it is seen and not learnt from.
void elmopp_learner_work(elmopp_learner_t *self, const elmopp_lstm_f32_state_t *shipped_memory);

/// Whether the learnt weights are to be used: then elmopp_trainer_net() of `trainer`, and `memory`.
bool elmopp_learner_is_in_use(const elmopp_learner_t *self);

/// Whether what was learnt is by its own account so much better than the shipped weights that it should outlive a
/// reset.
bool elmopp_learner_is_worth_keeping(const elmopp_learner_t *self);

/// The weights that are to be used now, copied out, for whoever keeps or re-quantises them.
void elmopp_learner_copy(const elmopp_learner_t *self, elmopp_lstm_f32_weights_t *out);

#endif
