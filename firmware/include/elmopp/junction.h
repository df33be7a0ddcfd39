/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Junction: the shape of one site as constant data, and the few questions that everybody asks of it.
///
/// Says which movements, signal groups and stages there are, what conflicts with what, how long a clearance takes and
/// how a queue leaves on green. It decides nothing, keeps no state and checks nothing: elmopp_site_check() (site.h)
/// says whether the data make a junction, and every other room may rely on a junction that passed it.
///
/// Words. An *approach* is a road that leads in (paper: inroad). A *movement* is a lane group: the lanes of one
/// approach that are served by the same groups in every stage (paper: subedge). A *signal group* is a set of lamps that
/// always show the same. A *stage* is a set of groups that are green together, in a street a maximal one of those that
/// may be (paper: configuration).
///
/// The struct is also the body of a site image (site.h), so its layout is fixed: fixed-width members, no implicit
/// padding, little-endian. Unused rows are zero. Owner: the site file; everybody else holds a const pointer.

#ifndef ELMOPP_JUNCTION_H
#define ELMOPP_JUNCTION_H

#include "elmopp/bounds.h"

#include <assert.h>
#include <stdbool.h>
#include <stdint.h>

/// How a green queue leaves: the flow q in vehicles per second. Load k = Q / C, k_j = 1 (paper, appendix).
enum {
    ELMOPP_DISCHARGE_SATURATION = 0,   ///< q = saturation_veh_per_s of the movement: every street
    ELMOPP_DISCHARGE_GREENSHIELDS = 1, ///< q = k v_f (1 - k / k_j): a full lane stands for ever
    ELMOPP_DISCHARGE_NOLOCK = 2        ///< the same with k at most 1/2: a full lane leaves at the top rate
};

/// The choosers that a site may name.
enum {
    ELMOPP_CHOOSER_NAIVE = 0,      ///< urgency.h, loads as they are
    ELMOPP_CHOOSER_CUMULATIVE = 1, ///< urgency.h, loads summed over the forecast
    ELMOPP_CHOOSER_PRESSURE = 2,   ///< pressure.h
    ELMOPP_CHOOSER_PRICED = 3,     ///< priced.h
    ELMOPP_CHOOSER_ROLLOUT = 4,    ///< rollout.h, with the forecast
    ELMOPP_CHOOSER_COUNT = 5
};

/// The forecasts that a site may name (forecast.h).
enum {
    ELMOPP_FORECAST_NONE = 0,        ///< no further inflow
    ELMOPP_FORECAST_MEAN = 1,        ///< the long-run mean
    ELMOPP_FORECAST_PERSISTENCE = 2, ///< the last second, again and again
    ELMOPP_FORECAST_EWMA = 3,        ///< an exponentially weighted mean of the last minutes
    ELMOPP_FORECAST_AR8 = 4,         ///< linear autoregression over eight seconds, iterated
    ELMOPP_FORECAST_LSTM = 5,        ///< a network of one level
    ELMOPP_FORECAST_NLSTM = 6,       ///< a nested network
    ELMOPP_FORECAST_ANN = 7,         ///< a plain feed-forward network over the last seconds
    ELMOPP_FORECAST_GCN = 8,         ///< a graph convolutional network over the approaches
    ELMOPP_FORECAST_LSTM_Q15 = 9,    ///< that of one level in whole numbers
    ELMOPP_FORECAST_NLSTM_Q15 = 10,  ///< the nested one in whole numbers
    ELMOPP_FORECAST_COUNT = 11
};

/// How a group flashes when the junction flashes.
enum {
    ELMOPP_FLASH_AMBER = 0, ///< go with care
    ELMOPP_FLASH_RED = 1,   ///< stop, then go with care (pedestrians: don't walk)
    ELMOPP_FLASH_DARK = 2   ///< shows nothing
};

/// The speed limit of an approach whose site does not say: that of a street in a town.
#define ELMOPP_JUNCTION_LIMIT_KM_PER_H 50U

/// What a line of the schedule may start instead of a programme.
enum {
    ELMOPP_SCHEDULE_FLASH = 255 ///< night flash
};

/// One movement. Counts of it arrive once a second as real-valued vehicles.
typedef struct {
    char name[ELMOPP_NAME_SIZE]; ///< zero-terminated
    float capacity_veh;          ///< storage C inside the counted reach; 0: no storage, its load is 0
    float saturation_veh_per_s;  ///< saturation flow of all its lanes together
    uint16_t startup_ds;         ///< green time lost until the queue moves
    uint16_t groups;             ///< mask of the signal groups that must all be green for it to go
    uint8_t approach;            ///< index of its approach
    uint8_t lanes;               ///< pavement lanes
    uint8_t limit_km_per_h;      ///< speed limit of its approach; 0: nobody says, ELMOPP_JUNCTION_LIMIT_KM_PER_H
    uint8_t gives_way_percent;   ///< of its vehicles, those that give way where it gives way; 0: it never does
} elmopp_movement_t;

/// One signal group with its times in tenths of a second.
typedef struct {
    char name[ELMOPP_NAME_SIZE]; ///< zero-terminated
    uint16_t amber_ds;           ///< amber after green
    uint16_t red_amber_ds;       ///< red with amber before green; 0: none
    uint16_t min_green_ds;       ///< a green is never shorter
    uint16_t max_green_ds;       ///< counted from the first conflicting demand; 0: no bound
    uint8_t node;                ///< the lamp node that drives it, and whose feedback tells of it
    uint8_t flash;               ///< ELMOPP_FLASH_*
} elmopp_group_t;

/// One step of a fixed-time programme: a stage and how long it is shown.
typedef struct {
    uint16_t green_ds; ///< at least the minimum green of all its groups
    uint8_t stage;
    uint8_t reserved;
} elmopp_step_t;

/// One fixed-time programme, run round and round. It serves every movement.
typedef struct {
    elmopp_step_t step[ELMOPP_STEP_MAX];
    uint8_t step_count;
    uint8_t reserved[3];
} elmopp_program_t;

/// One line of the weekly schedule: it holds from this minute until the next line's, over midnight and weekends too.
typedef struct {
    uint16_t from_min; ///< minute of the day, local time
    uint8_t weekdays;  ///< mask, bit 0 Monday to bit 6 Sunday
    uint8_t program;   ///< index, or ELMOPP_SCHEDULE_FLASH
} elmopp_schedule_t;

/// One date that follows another weekday's lines.
typedef struct {
    uint16_t day;    ///< days since 2000-01-01
    uint8_t weekday; ///< 0 Monday to 6 Sunday
    uint8_t reserved;
} elmopp_special_day_t;

/// One junction.
typedef struct {
    char name[ELMOPP_SITE_NAME_SIZE]; ///< zero-terminated
    uint8_t approach_count;
    uint8_t movement_count;
    uint8_t group_count;
    uint8_t stage_count;
    uint8_t simulation_only;  ///< 1: may have zero clearance, never drives real lamps; 0: a street
    uint8_t discharge;        ///< ELMOPP_DISCHARGE_*
    uint8_t chooser;          ///< ELMOPP_CHOOSER_*
    uint8_t forecast;         ///< ELMOPP_FORECAST_*
    uint16_t hold_min_s;      ///< the chooser's window: a stage is never left before
    uint16_t hold_max_s;      ///< ... and always left at
    uint16_t red_bound_ds;    ///< a movement with demand never waits longer for green; 0: no bound (simulation only)
    uint16_t start_flash_ds;  ///< flashing after the self-test
    uint16_t start_red_ds;    ///< all red before the first green, and before flashing
    uint8_t first_stage;      ///< the stage that comes first
    uint8_t cameras;          ///< mask of the approaches that a camera counts; the others are always on recall
    uint8_t no_activity_min;  ///< a counter that sees no arrival for so long is not believed; 0: it may be silent
    uint8_t max_presence_min; ///< ... nor one that always sees a vehicle; 0: it may
    uint8_t erratic_per_min;  ///< ... nor one that sees more arrivals in a minute; 0: it may
    uint8_t program_count;    ///< at least one in a street
    uint8_t schedule_count;   ///< 0: always programme 0
    uint8_t special_day_count;
    uint16_t junction_wait_ds; ///< a change waits so long for an occupied junction (plan.h); 0: it does not
    float reach_m;             ///< how far before the stop line vehicles are counted
    float free_flow_m_per_s;   ///< v_f of the Greenshields laws; 0 with saturation
    char approach_name[ELMOPP_APPROACH_MAX][ELMOPP_NAME_SIZE]; ///< zero-terminated
    elmopp_movement_t movement[ELMOPP_MOVEMENT_MAX];
    elmopp_group_t group[ELMOPP_GROUP_MAX];
    uint16_t conflict[ELMOPP_GROUP_MAX];     ///< mask of the groups that must never be green with this one; symmetric
    uint16_t stage_groups[ELMOPP_STAGE_MAX]; ///< mask of the groups that are green in this stage
    uint16_t intergreen_ds[ELMOPP_GROUP_MAX][ELMOPP_GROUP_MAX]; ///< [ending][starting]: end of green to start of green
    uint8_t rescue_stage[ELMOPP_MOVEMENT_MAX]; ///< the stage that serves this movement when its bound on red is near
    elmopp_program_t program[ELMOPP_PROGRAM_MAX];
    elmopp_schedule_t schedule[ELMOPP_SCHEDULE_MAX];
    elmopp_special_day_t special_day[ELMOPP_SPECIAL_DAY_MAX];
    uint32_t gives_way[ELMOPP_MOVEMENT_MAX]; ///< mask of the movements that go first where both have green
    uint8_t learning; ///< 1: the forecast learns on, which is an LSTM, plain or nested, in float; 0: it does not
    uint8_t reserved[3];
} elmopp_junction_t;

static_assert(sizeof(float) == 4U, "the image needs IEEE 754 single precision");
static_assert(sizeof(elmopp_movement_t) == 28U, "a movement must have no implicit padding");
static_assert(sizeof(elmopp_group_t) == 22U, "a group must have no implicit padding");
static_assert(sizeof(elmopp_junction_t) == 2312U, "a junction must have no implicit padding");

/// True if the chooser looks at the forecast: cumulative and rollout do. Nobody else has one made.
bool elmopp_junction_looks_ahead(const elmopp_junction_t *junction);

/// Load L = Q / C of one movement (paper: the Hadamard quotient of Q and C), 0 where the capacity is 0. Shape: scalar.
float elmopp_junction_load(const elmopp_junction_t *junction, uint32_t movement, float queue_veh);

/// Flow in vehicles per second with which a queue leaves on full green, never more than the queue itself in one second.
float elmopp_junction_discharge(const elmopp_junction_t *junction, uint32_t movement, float queue_veh);

/// Speed limit on the approach of a movement. Kilometres per hour.
uint32_t elmopp_junction_limit_km_per_h(const elmopp_junction_t *junction, uint32_t movement);

/// True if bit `index` of a mask of groups, movements or stages is set.
bool elmopp_mask_has(uint32_t mask, uint32_t index);

/// Mask of the lamp nodes that a group of the site hangs on, and mask of the groups that hang on one of them.
uint8_t elmopp_junction_nodes(const elmopp_junction_t *junction);
uint16_t elmopp_junction_groups_of_node(const elmopp_junction_t *junction, uint32_t node);

/// True if all of the movement's signal groups are in the mask.
bool elmopp_junction_goes(const elmopp_junction_t *junction, uint32_t movement, uint16_t groups);

/// Longest time from the moment at which a shown stage may be left until any other one is shown: the longest minimum
/// green, the longest intergreen, or amber and red-amber, and the whole wait for an occupied junction. Tenths of a
/// second. The bound on red is worked out with it.
uint32_t elmopp_junction_change_ds(const elmopp_junction_t *junction);

/// From the end of the green of one set of groups to the beginning of another one's: the longest of the ambers and
/// intergreens of the groups that end and of the red-ambers of those that start. 0 if they are the same. Tenths of a
/// second.
uint32_t elmopp_junction_clearing_ds(const elmopp_junction_t *junction, uint16_t before, uint16_t after);

/// The longest start-up of the movements that go with `after` and not with `before`. Tenths of a second.
uint32_t elmopp_junction_starting_ds(const elmopp_junction_t *junction, uint16_t before, uint16_t after);

/// Mask of all signal groups.
uint16_t elmopp_junction_groups(const elmopp_junction_t *junction);

/// Mask of the movements that go when exactly these signal groups are green.
uint32_t elmopp_junction_served(const elmopp_junction_t *junction, uint16_t groups);

#endif
