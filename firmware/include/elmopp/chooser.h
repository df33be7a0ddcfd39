/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Chooser: the one exchangeable part. Types only.
///
/// A chooser looks at a const view once a second and names the stage it wants. ELMOPP's own choosers (urgency.h,
/// pressure.h) and every rival (choosers/) plug in here, above the plan, so that none can win by skipping an amber. It
/// never touches a lamp: the plan (plan.h) decides when the wanted stage may come.

#ifndef ELMOPP_CHOOSER_H
#define ELMOPP_CHOOSER_H

#include "elmopp/junction.h"

/// Index of a stage, or ELMOPP_STAGE_NONE.
typedef uint8_t elmopp_stage_t;

/// What a chooser sees. Everything is owned by the pilot and valid during the call only.
typedef struct {
    const elmopp_junction_t *junction;
    const float *queue_veh;    ///< [movement] vehicles inside the counted reach
    const float *arrivals_veh; ///< [movement] vehicles that came in the last second
    const float *share;        ///< [movement] its share of its approach's arrivals; sums to 1 over an approach
    const uint16_t *red_ds;    ///< [movement] T: time since all its groups were last green, 0 while they are and before
                               ///< the first decision; saturates
    uint32_t going;            ///< mask of the movements that are green now
    const float
        *foreseen_veh[ELMOPP_APPROACH_MAX]; ///< [approach][step] vehicles that will come in second step + 1 from now
    uint16_t foreseen_steps; ///< steps in each row that there is; a null one: nothing is foreseen of its approach; 0:
                             ///< of none, and all are null
    uint16_t elapsed_ds;     ///< how long the stage has been shown; 0 if none is
    elmopp_stage_t stage; ///< the stage that is shown; ELMOPP_STAGE_NONE before the first decision and in an intergreen
    elmopp_stage_t target; ///< the stage shown or being brought up; ELMOPP_STAGE_NONE before the first decision
} elmopp_view_t;

/// Names the wanted stage and writes one score a stage (0 where it has none), for the decision log. Called every
/// second, also in the intergreen (it must see every arrival); what it returns there is not used. `state` is the
/// chooser's own.
typedef elmopp_stage_t (*elmopp_choose_fn_t)(void *state, const elmopp_view_t *view, float score[ELMOPP_STAGE_MAX]);

/// A chooser: a function, its state (owned by the caller, alive as long as the pilot) and the forecast it asks
/// for.
typedef struct {
    elmopp_choose_fn_t choose;
    void *state;
    uint16_t horizon_s; ///< steps of forecast that it reads, at most ELMOPP_HORIZON_MAX
} elmopp_chooser_t;

#endif
