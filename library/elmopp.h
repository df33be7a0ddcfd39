/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// ELMOPP as a shared library: one junction behind an opaque handle. Counts in, stage and aspects out.
///
/// For simulators and studies, from any language that can call C. It runs the code that the controller runs between its
/// cameras and its lamps: forecast, chooser, plan, and the conflict monitor behind them; and it knows the rivals too.
/// It knows no bus, no mode and no clock: the caller's seconds are its time. It drives no lamps of a street.
///
/// The order of a second: elmopp_count() once with what was counted, then elmopp_tick() ten times, each for the next
/// 100 ms.
///
///     elmopp_options_t options = {.size = sizeof options, .site = image, .site_bytes = length, .chooser = "naive"};
///     char message[ELMOPP_MESSAGE_BYTES];
///     elmopp_t *junction = elmopp_open(&options, message, sizeof message);
///     if (junction == NULL) { fputs(message, stderr); ... }
///
/// The interface is stable: within one ELMOPP_ABI_VERSION functions and members are only added, and a caller's structs
/// say by their first member how long they are. The library has no global state: handles are independent of each other,
/// and one handle belongs to one thread at a time. No pointer that is handed in is kept. It ends the process for
/// nothing but a bug of its own.

#ifndef ELMOPP_LIBRARY_H
#define ELMOPP_LIBRARY_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Of this header. A library of another number must not be used with it.
#define ELMOPP_ABI_VERSION 1U
uint32_t elmopp_abi_version(void);

#define ELMOPP_TRAVEL_OF_SITE 0xFFFFFFFFU ///< elmopp_options_t.travel_s: the caller does not say
#define ELMOPP_NO_STAGE (-1)              ///< no stage is shown, or no wish
#define ELMOPP_ASPECT_BYTES 17     ///< an aspect a signal group as a digit, unused groups 0, and a terminating zero
#define ELMOPP_MESSAGE_BYTES 256   ///< enough for every message
#define ELMOPP_FORESEEN_MAX_S 150U ///< no chooser looks further ahead

/// What a call answers.
enum {
    ELMOPP_DONE = 0,
    ELMOPP_REFUSED = 1, ///< the arguments are wrong: nothing has changed; elmopp_count() says more
    ELMOPP_FAULT = 2    ///< the conflict monitor has found a fault; it stays, see elmopp_fault()
};

/// One junction.
typedef struct elmopp_handle elmopp_t;

/// What a junction is made of. Unset members are zero.
typedef struct {
    uint32_t size;             ///< sizeof(elmopp_options_t)
    uint32_t site_bytes;       ///< length of the image
    const unsigned char *site; ///< an image as tools/site --image makes it
    const char *chooser; ///< NAME[@OPTION=VALUE][:FORECAST] as host_sim list names them; null: what the site names.
                         ///< With forecast oracle the caller foresees: elmopp_second_t.foreseen_veh
    const unsigned char *weights; ///< an image as tools/weights --image makes it; null: the networks that are built in
    uint32_t weights_bytes;
    uint32_t travel_s; ///< from the edge of the counted reach to the stop line on an empty road, 0: counted when there,
                       ///< ELMOPP_TRAVEL_OF_SITE: as the site's reach and speed limits have it
    uint64_t seed;     ///< of a chooser that draws
} elmopp_options_t;

/// What the neighbouring junction of an approach says of those who have left it towards here, as NeighbourOutflow has
/// it. All zero: it says nothing.
typedef struct {
    float next10_veh; ///< vehicles that come to the edge of the reach in the next 10 seconds
    float next30_veh; ///< ... in the next 30, those among them
    float next60_veh;
    float ahead_s; ///< for so long nobody else can come: the time that the road to that edge takes
} elmopp_announced_t;

/// What was counted in the last second. Arrays of elmopp_shape_t.movements values, finite and >= 0.
typedef struct {
    uint32_t size;                       ///< sizeof(elmopp_second_t)
    uint32_t recall;                     ///< mask of the movements whose counts are not to be believed
    const float *present_veh;            ///< vehicles inside the reach
    const float *arrived_veh;            ///< vehicles that came into it in the last second
    const float *downstream_veh;         ///< vehicles on the road that the movement leads to; null: nobody knows
    uint32_t occupied;                   ///< 1: a vehicle stands inside the junction; 0: none does, or nobody knows
    const elmopp_announced_t *announced; ///< elmopp_shape_t.approaches values; null: no neighbour speaks
    const float *foreseen_veh; ///< [approach][foreseen_s] vehicles that will come into the reach in each of the next
                               ///< seconds, one row after another: for forecast oracle, null for any other
    uint32_t foreseen_s;       ///< 1 to ELMOPP_FORESEEN_MAX_S, 0 without rows
} elmopp_second_t;

/// How many there are of everything, in the order of the site.
typedef struct {
    uint32_t size; ///< sizeof(elmopp_shape_t)
    uint32_t approaches;
    uint32_t movements;
    uint32_t groups;
    uint32_t stages;
} elmopp_shape_t;

/// A junction with all lamps red and every intergreen running, or null and one line that says what is wrong and what
/// would be right. The message is always terminated.
elmopp_t *elmopp_open(const elmopp_options_t *options, char *message, uint32_t message_bytes);

/// Frees it. Null is nothing.
void elmopp_close(elmopp_t *self);

/// Fills `out` as far as its size says; ELMOPP_REFUSED for a size that it never had.
int elmopp_shape(const elmopp_t *self, elmopp_shape_t *out);

/// Takes a second's counts and asks the chooser. `occupied` holds until the next call: a change of stage waits for it
/// as long as the site says (junction_wait_ds), whoever chooses. ELMOPP_REFUSED for a value of any of the five arrays
/// that is negative, not finite or beyond a million, and for a second without rows where the forecast is oracle, or
/// with rows where it is not: nothing is learnt, the wish stays, everybody on red counts as waiting, and the junction
/// as empty.
int elmopp_count(elmopp_t *self, const elmopp_second_t *second);

/// Moves the lamps by 100 ms and writes what they show, one digit a group: 0 dark, 1 red, 2 red-amber, 3 green, 4
/// amber, 5 flashing amber, 6 flashing red. `wish`: the stage that the caller wants instead of the chooser, or
/// ELMOPP_NO_STAGE. Whatever is wished, minimum and maximum green, amber and intergreens are kept.
int elmopp_tick(elmopp_t *self, int32_t wish, char aspects[ELMOPP_ASPECT_BYTES]);

/// The stage that is shown, the one shown or being brought up, and the one that the chooser wishes; or ELMOPP_NO_STAGE.
int32_t elmopp_stage(const elmopp_t *self);
int32_t elmopp_target(const elmopp_t *self);
int32_t elmopp_wish(const elmopp_t *self);

/// Mask of the groups that are green in a stage, and mask of the movements that go when exactly these groups are green.
/// 0 for a stage that does not exist.
uint32_t elmopp_stage_groups(const elmopp_t *self, uint32_t stage);
uint32_t elmopp_served(const elmopp_t *self, uint32_t groups);

/// The chooser's score of a stage in the last second, and the vehicles that the forecast has an approach get in the
/// next 60 s. 0 where there is none.
float elmopp_score(const elmopp_t *self, uint32_t stage);
float elmopp_foreseen_veh(const elmopp_t *self, uint32_t approach);

/// The monitor's first fault in words, or null.
const char *elmopp_fault(const elmopp_t *self);

#ifdef __cplusplus
}
#endif

#endif
