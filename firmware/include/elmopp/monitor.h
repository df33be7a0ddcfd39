/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Conflict monitor: the last check between a signal plan and the lamps.
///
/// Judges the lamps about to be driven and what the lamps report, never the plan that produced them: a wrong plan, a
/// corrupted state and a wrong forecast all end here. It shares no code with the plan, and it knows no forecast, no
/// queue and no CAN. The first fault latches, with its group, until elmopp_monitor_init(); while it does, the caller
/// drives the flashing that the site asks for.
///
/// In the steady modes (first stage, automatic, fixed time, manual, all red, start red):
///
///   - no two conflicting groups show anything but red;
///   - a green begins only when every conflicting group's intergreen has run out, counted from the end of its green,
///     of its flashing or of its darkness;
///   - red, red-amber, green, amber, red, in this order, each for its time; no other colours, no darkness, no flashing.
///
/// In the flashing modes every group flashes as the site says, in mode dark every group is dark, and either begins from
/// red everywhere. The mode is an input, and the controller's mode table the only one to set it.
///
/// Lamps report with delay: feedback may differ from the command for ELMOPP_MONITOR_FEEDBACK_DS, counted anew from
/// every change of that group; feedback that is not fresh is a fault at once (what fresh means is the link's time-out).
/// Only mode starting does without.
///
/// Shaped for proof: a verdict is a pure function of one group; ages are lamp ticks and saturate, so that a clock that
/// wraps cannot deceive it. Not thread-safe; one owner, the controller. The cost of a call is bounded by
/// ELMOPP_GROUP_MAX squared.
///
/// Sources: EN 12675 4.3-4.4 (self-monitoring and failure mode); the 300 ms are those of NEMA TS 2 conflict monitors.

#ifndef ELMOPP_MONITOR_H
#define ELMOPP_MONITOR_H

#include "elmopp/fault.h"
#include "elmopp/junction.h"
#include "elmopp/lamps.h"
#include "elmopp/mode.h"

/// How long the lamps may show something else than commanded.
#define ELMOPP_MONITOR_FEEDBACK_DS 3U

/// What it judges in one lamp tick.
typedef struct {
    elmopp_lamps_t command;  ///< about to be driven
    elmopp_lamps_t measured; ///< reported by the lamp nodes since the last tick; `flash` is not read
    uint16_t fresh;          ///< mask of the groups whose report is no older than its time-out
    elmopp_mode_t mode;
} elmopp_monitor_input_t;

/// State. Set up by elmopp_monitor_init(); nobody else writes it.
typedef struct {
    const elmopp_junction_t *junction;
    elmopp_lamps_t last;                       ///< the command of the last tick
    uint16_t age_ds[ELMOPP_GROUP_MAX];         ///< how long each group has shown its last aspect; saturates
    uint16_t since_green_ds[ELMOPP_GROUP_MAX]; ///< how long ago green, flashing or darkness ended; saturates
    uint8_t differs_ds[ELMOPP_GROUP_MAX];      ///< how long the report has differed; saturates
    elmopp_fault_t first;                      ///< ELMOPP_FAULT_NONE as long as all is well
    uint8_t first_group;                       ///< the group of the first fault
} elmopp_monitor_t;

/// No fault; all groups flash. The junction must have passed elmopp_site_check() and outlive the monitor.
void elmopp_monitor_init(elmopp_monitor_t *self, const elmopp_junction_t *junction);

/// Call once per lamp tick, before the lamps are driven. Returns the first fault since init; on any value but
/// ELMOPP_FAULT_NONE the caller drives the fail-safe aspects instead.
elmopp_fault_t elmopp_monitor_check(elmopp_monitor_t *self, const elmopp_monitor_input_t *input);

/// The verdict on one group: pure. For tests and proofs.
elmopp_fault_t elmopp_monitor_judge_group(const elmopp_monitor_t *self, const elmopp_monitor_input_t *input,
                                          uint32_t g);

/// Takes one group of this tick's command into the history. For tests and proofs.
void elmopp_monitor_remember_group(elmopp_monitor_t *self, const elmopp_monitor_input_t *input, uint32_t g);

#endif
