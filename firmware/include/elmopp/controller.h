/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Controller: the junction as a whole. The outer seam between core and world: frames in, frames out.
///
/// Joins bus, detector, pilot, timetable, mode, monitor and watch. It decides when each of them is asked, and which
/// lamps are driven: the pilot's in the steady modes, flashing as the site says or darkness otherwise. Whatever the
/// pilot says, the monitor sees it first; its first fault, or one of the controller's own, ends in flashing.
///
/// A fault latches. It is cleared only with the local reset input held, by the two commands clear_fault_prepare and
/// clear_fault_confirm that both name it, within ELMOPP_CONTROLLER_CLEAR_DS of each other; anything less is refused and
/// counted. What follows is Starting, never what was before.
///
/// A site whose changes wait for an occupied junction listens to JunctionOccupied, too. A sign that is missing,
/// invalid, or older than 0.6 s is none (bus.h): a camera that fails costs nobody any time.
///
/// What neighbours have sent to an approach (NeighbourOutflow) becomes the beginning of the rows that the chooser sees,
/// for as long as the road takes and the frame is no older than 3 s. Silent, stale or spoilt: as if never announced. It
/// cannot move a lamp by itself, as a forecast cannot: what is chosen by it goes through plan and monitor like any
/// wish.
///
/// Diagnosis goes on all the time: the site's data and the weights are summed up again and again, a piece a tick, and
/// compared with what was checked at the start.
///
/// Two controllers on one bus would fight over the lamps. Whoever hears the other's LampCommand or ControllerStatus
/// goes to flashing, so that both do.
///
/// Time. A lamp tick is 100 ms. elmopp_controller_tick() may be called as often as one likes with a clock that only
/// goes forward, in milliseconds, and may wrap: it does something when a tick is due. Ticks keep to a grid, at least 50
/// ms apart, so that so many ticks never take less than so many tenths of a second but 50 ms. Ticks that could not be
/// done in time are left out, which makes every interval longer and none shorter. After more than
/// ELMOPP_CONTROLLER_LATE_MS the lamp nodes have begun to flash by themselves, so that it is a fault, as is a clock
/// that jumps.
///
/// It reads no clock, does no I/O, keeps no static state, allocates nothing. Not thread-safe; one owner, the port.

#ifndef ELMOPP_CONTROLLER_H
#define ELMOPP_CONTROLLER_H

#include "elmopp/bus.h"
#include "elmopp/detector.h"
#include "elmopp/fault.h"
#include "elmopp/frames.h"
#include "elmopp/mode.h"
#include "elmopp/monitor.h"
#include "elmopp/pilot.h"
#include "elmopp/timetable.h"
#include "elmopp/watch.h"

/// Frames that one tick writes at most: LampCommand, ControllerStatus and a Forecast an approach.
#define ELMOPP_FRAMES_PER_TICK (2U + ELMOPP_APPROACH_MAX)

#define ELMOPP_CONTROLLER_TICK_MS 100U
#define ELMOPP_CONTROLLER_LATE_MS 300U      ///< the lamp nodes' time-out
#define ELMOPP_CONTROLLER_SELF_TEST_DS 300U ///< the lamps must all read back within so long after the start
#define ELMOPP_CONTROLLER_TEST_GOOD_DS 10U  ///< ... for so long
#define ELMOPP_CONTROLLER_CLEAR_DS 100U     ///< between the two commands that clear a fault

/// What a controller is made of. All pointers must outlive it.
typedef struct {
    const elmopp_junction_t *junction; ///< has passed elmopp_site_check()
    elmopp_chooser_t chooser;
    elmopp_forecast_config_t forecast;
} elmopp_controller_config_t;

/// Milliseconds of a monotonic clock; wraps.
typedef uint32_t elmopp_ms_t;

/// State. Set up by elmopp_controller_init(); read it for a log, write nothing.
typedef struct {
    const elmopp_junction_t *junction;
    elmopp_pilot_t pilot;
    elmopp_monitor_t monitor;
    elmopp_detector_t detector;
    elmopp_timetable_t timetable;
    elmopp_bus_t bus;
    elmopp_watch_t site_watch;
    elmopp_watch_t weights_watch;
    float present_veh[ELMOPP_MOVEMENT_MAX]; ///< as the pilot saw them in the last second
    float arrived_veh[ELMOPP_MOVEMENT_MAX];
    elmopp_lamps_t lamps; ///< driven now
    elmopp_mode_t mode;
    elmopp_wish_t wish;
    elmopp_fault_t fault; ///< the first since the last Starting
    uint8_t fault_group;
    elmopp_stage_t manual_stage;
    uint8_t program;     ///< of the hour, or ELMOPP_SCHEDULE_FLASH
    uint16_t mode_ds;    ///< age of the mode; saturates
    uint16_t test_ds;    ///< the lamps have read back for so long
    uint16_t clear_ds;   ///< time left to confirm; 0: nothing is prepared
    uint16_t weights_id; ///< low 12 bits of the weights' checksum; 0: none
    uint8_t second_ds;   ///< ticks since the last decision
    bool reset_held;
    bool cleared; ///< the fault has just been cleared
    bool wall_known;
    uint8_t wall_ds;
    uint32_t wall_s; ///< local seconds since 2000-01-01
    bool ticking;
    elmopp_ms_t last_ms;  ///< of the last tick
    elmopp_ms_t due_ms;   ///< of the next
    elmopp_status_t told; ///< the last ControllerStatus
    uint8_t told_ds;      ///< its age
    uint8_t lamp_counter; ///< of the frames to send
    uint8_t status_counter;
    uint8_t forecast_counter[ELMOPP_APPROACH_MAX];
} elmopp_controller_t;

/// Mode Starting. Asserts a junction that passes elmopp_site_check(): whoever has none drives no lamp, and the lamp
/// nodes flash by themselves.
void elmopp_controller_init(elmopp_controller_t *self, const elmopp_controller_config_t *config);

/// Goes on with other weights that the site's forecast can use (elmopp_forecast_fits()); a site whose forecast is no
/// network is left alone. Between two ticks. They are watched from now on, and must outlive the controller or the next
/// call. Weights of the same content at another place change nothing that anybody can see. A forecast that learns
/// begins anew with others.
void elmopp_controller_use_weights(elmopp_controller_t *self, const elmopp_weights_t *weights);

/// The port's own findings: ELMOPP_FAULT_MEMORY to ELMOPP_FAULT_BROWN_OUT.
void elmopp_controller_report(elmopp_controller_t *self, elmopp_fault_t fault);

/// The port has received so much that was no frame, or had no room for it: counted with the frames that are refused.
void elmopp_controller_refuse(elmopp_controller_t *self, uint32_t count);

/// The port is about to stop: all red, from now on and as soon as the plan allows.
void elmopp_controller_stop(elmopp_controller_t *self);

/// True while nobody is on the move: all red, or flashing or dark anyway. The port may stop; the lamp nodes then flash.
bool elmopp_controller_has_stopped(const elmopp_controller_t *self);

/// The local reset input, a key switch: held or not.
void elmopp_controller_hold_reset(elmopp_controller_t *self, bool held);

/// Offers one received frame. False if it is not for us, or is repeated, out of order, corrupt or a command that is
/// refused; what it would have changed is then unchanged.
bool elmopp_controller_take(elmopp_controller_t *self, const elmopp_frame_t *frame);

/// Advances by one lamp tick if one is due: decides if a decision is due, moves the plan, has the monitor judge it, and
/// writes the frames to send. Returns how many; 0 if no tick was due.
uint32_t elmopp_controller_tick(elmopp_controller_t *self, elmopp_ms_t now_ms,
                                elmopp_frame_t out[ELMOPP_FRAMES_PER_TICK]);

#endif
