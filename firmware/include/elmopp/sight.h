/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Sight: what a chooser makes of the counts of each second, movement by movement.
///
/// It answers seven questions and decides nothing:
///
///   - who is queued, and who is counted but still drives: whoever came less than travel_s ago, in the order of
///   arrival.
///     If fewer are there than drive, the oldest have left early. Without a reach (travel_s 0) everybody is queued.
///   - how many come a second: the mean of all seconds, after mean_window_s an exponential one. A reach that is full
///     shows no arrivals, so it cannot lower the mean.
///   - how many stand behind a reach that is full (0.85 of the capacity): those that should have come and were not
///   seen.
///     Never more than the capacity; nobody without a reach, or as soon as it is not full.
///   - how long nobody has been let go: the chooser's own clock on red. It starts when somebody is there and restarts
///   when
///     somebody leaves on green, or when nobody is there on green; a green on which nobody moves does not count. The
///     lamps' T stays in the view.
///   - how fast each stage really lets a movement go: mean departures of a standing queue, with the site's saturation
///     flow as prior_s seconds of it, never outside 0.1 to 1.4 of the site's. A second counts for one vehicle a lane at
///     most, so one wild count cannot spoil it. With a discharge law that depends on the queue nothing is learnt.
///   - how much of that is left in the mean where it gives way: what the gaps in the mean arrivals of those who go
///   first
///     let through (gaps.h). Who waits for a gap says nothing about the flow, nor about being blocked: seconds in which
///     somebody who goes first was there are left out of both. After a reset the site's flow holds again.
///   - which movements are blocked: green, queued, and nobody has left for block_s.
///
/// Call it once a second, also in the intergreen: it must see every arrival. Counts must be 0 to 1e6, as the pilot sees
/// to; then every value here is finite and not negative. It never reads what will come, a route or a lamp beyond the
/// view.
///
/// Owner: the chooser that contains it. No allocation; a second takes movements times (travel_s + a constant) steps.
/// Not thread-safe.

#ifndef ELMOPP_SIGHT_H
#define ELMOPP_SIGHT_H

#include "elmopp/chooser.h"

#define ELMOPP_SIGHT_TRAVEL_MAX_S 12U

/// What drivers reach of the limit on the way to a stop line, 0.864 of it: 12 m/s at 50 km/h.
#define ELMOPP_SIGHT_FREE_FLOW_M_PER_S_PER_KM_PER_H 0.24F

/// Below this share of the site's saturation flow a stage does not really serve a movement.
#define ELMOPP_SIGHT_SERVED_SHARE 0.25F

/// What can be varied. elmopp_sight_defaults() says what was measured to be good.
typedef struct {
    uint16_t travel_s[ELMOPP_MOVEMENT_MAX]; ///< edge of the reach to stop line at free flow; 0: no reach
    uint16_t mean_window_s;                 ///< memory of the mean arrivals, at least 1
    uint16_t block_s;                       ///< green with a queue and no departure for so long: blocked
    float prior_s;                          ///< seconds of departures that the site's saturation flow is worth
    float forget_per_s; ///< share of what was learnt that each further second of departures takes away
    bool gives_way;     ///< what the site says of who gives way to whom counts; otherwise nobody does
} elmopp_sight_options_t;

/// State. Set up by elmopp_sight_init(); read it, write nothing.
typedef struct {
    elmopp_sight_options_t options;
    const elmopp_junction_t *junction;
    float present_veh[ELMOPP_MOVEMENT_MAX];    ///< all that are counted
    float queued_veh[ELMOPP_MOVEMENT_MAX];     ///< of them, those at the stop line
    float mean_veh_per_s[ELMOPP_MOVEMENT_MAX]; ///< arrivals
    float hidden_veh[ELMOPP_MOVEMENT_MAX];     ///< behind a full reach
    float site_veh_per_s[ELMOPP_MOVEMENT_MAX]; ///< the site's saturation flow, or the top of its discharge law
    float due_veh[ELMOPP_MOVEMENT_MAX][ELMOPP_SIGHT_TRAVEL_MAX_S]; ///< who reaches the queue in second [step] from now
    float flow_veh_per_s[ELMOPP_STAGE_MAX][ELMOPP_MOVEMENT_MAX];   ///< as learnt; 0 where a stage shows red
    float learnt_veh[ELMOPP_STAGE_MAX][ELMOPP_MOVEMENT_MAX];       ///< departures of standing queues ...
    float learnt_s[ELMOPP_STAGE_MAX][ELMOPP_MOVEMENT_MAX];         ///< ... and the seconds in which they left
    uint32_t serves[ELMOPP_STAGE_MAX];                             ///< mask of the movements that go in a stage
    uint32_t yields[ELMOPP_STAGE_MAX];    ///< mask of those of them that give way to another one that goes
    uint32_t going;                       ///< view->going of the last second
    uint16_t red_s[ELMOPP_MOVEMENT_MAX];  ///< the chooser's clock on red; saturates
    uint16_t idle_s[ELMOPP_MOVEMENT_MAX]; ///< green and queued, and nobody has left; saturates
    uint16_t mean_s;                      ///< seconds in the mean, at most mean_window_s
    elmopp_stage_t stage;                 ///< view->stage of the last second
} elmopp_sight_t;

/// Whole seconds through the site's reach to a movement's stop line at free flow, at most ELMOPP_SIGHT_TRAVEL_MAX_S.
uint16_t elmopp_sight_travel_s(const elmopp_junction_t *junction, uint32_t movement);

/// 120 s of arrivals, 30 s of prior, forgetting over 600 s, blocked after 8 s, the site's right of way; the same travel
/// time everywhere.
elmopp_sight_options_t elmopp_sight_defaults(uint16_t travel_s);

/// The same with the travel times of a site: its reach at the limits of its approaches.
elmopp_sight_options_t elmopp_sight_of_site(const elmopp_junction_t *junction);

/// Nobody has been seen. The junction must outlive the sight. Asserts travel_s <= ELMOPP_SIGHT_TRAVEL_MAX_S,
/// mean_window_s >= 1, prior_s > 0 and forget_per_s within 0 to 1.
void elmopp_sight_init(elmopp_sight_t *self, const elmopp_junction_t *junction, const elmopp_sight_options_t *options);

/// Looks at one second.
void elmopp_sight_observe(elmopp_sight_t *self, const elmopp_view_t *view);

/// The flow of a stage for a movement, less where it gives way in the mean. 0 where it shows red.
float elmopp_sight_usual(const elmopp_sight_t *self, uint32_t stage, uint32_t movement);

/// The movements that go first where a movement gives way in a stage. Mask.
uint32_t elmopp_sight_foes(const elmopp_sight_t *self, uint32_t stage, uint32_t movement);

/// What is left of a flow of a movement that gives way while so many vehicles a second come who go first.
float elmopp_sight_through(const elmopp_sight_t *self, uint32_t movement, float flow_veh_per_s,
                           float opposing_veh_per_s);

/// Of the vehicles of a movement, the share that gives way where it gives way.
float elmopp_sight_yielding_share(const elmopp_sight_t *self, uint32_t movement);

/// Of those who come on a movement, the share that others wait for in a stage: all, or those that do not give way.
float elmopp_sight_first_share(const elmopp_sight_t *self, uint32_t stage, uint32_t movement);

/// True if the stage lets the movement go with at least ELMOPP_SIGHT_SERVED_SHARE of its saturation flow.
bool elmopp_sight_is_served(const elmopp_sight_t *self, uint32_t stage, uint32_t movement);

/// True if nobody has left a green queue for block_s.
bool elmopp_sight_is_blocked(const elmopp_sight_t *self, uint32_t movement);

#endif
