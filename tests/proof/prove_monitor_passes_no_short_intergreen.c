/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Over unbounded time, whatever lamps the monitor is shown: a green that it passes begins no earlier than the
/// intergreen after the end of every conflicting green. The ghost clock is the proof's own; the invariant ties the
/// monitor's to it.

#include "invariant.h"

elmopp_monitor_t nondet_monitor(void);
elmopp_monitor_input_t nondet_input(void);

/// Free to go as a driver sees it: green, flashing or dark.
static bool is_free(const elmopp_lamps_t *lamps, uint32_t g) {
    const uint32_t lit = (uint32_t)lamps->red | lamps->amber | lamps->green | lamps->flash;
    return has(lamps->green, g) || has(lamps->flash, g) || (!has(lit, g));
}

/* Ticks since h was last free, saturating like the monitor's own. */
static bool is_tied(const elmopp_monitor_t *monitor, uint32_t h, uint32_t ghost_ds) {
    const uint32_t held_ds = (ghost_ds < UINT16_MAX) ? ghost_ds : UINT16_MAX;
    return (monitor->since_green_ds[h] == held_ds) && (is_free(&monitor->last, h) == (ghost_ds == 0U));
}

void harness(void) {
    const elmopp_junction_t junction = any_junction();
    uint32_t g;
    uint32_t h;
    any_conflict(&junction, &g, &h);

    elmopp_monitor_t monitor;
    elmopp_monitor_init(&monitor, &junction);
    CLAIM(is_tied(&monitor, h, 0U), "the start counts as free");

    monitor = nondet_monitor();
    monitor.junction = &junction;
    const elmopp_monitor_input_t input = nondet_input();
    const uint32_t ghost_ds = nondet_u32();
    ASSUME(ghost_ds < UINT32_MAX);
    ASSUME(is_tied(&monitor, h, ghost_ds));

    const bool starts = has(input.command.green, g) && (!has(monitor.last.green, g));
    const elmopp_fault_t verdict = elmopp_monitor_judge_group(&monitor, &input, g);
    if (starts && (verdict == ELMOPP_FAULT_NONE)) {
        CLAIM(ghost_ds >= junction.intergreen_ds[h][g], "a green that passes has its intergreen");
    }
    elmopp_monitor_remember_group(&monitor, &input, h);
    monitor.last = input.command;
    CLAIM(is_tied(&monitor, h, is_free(&input.command, h) ? 0U : (ghost_ds + 1U)),
          "the monitor's clock is the ghost's");
    REACHABLE();
}
