/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// In whatever state the monitor is, corrupted memory included, and whatever lamps it is shown: if it passes, no two
/// conflicting groups of a steady mode are both off red; and what it has once found it says for ever.

#include "invariant.h"

elmopp_monitor_t nondet_monitor(void);
elmopp_monitor_input_t nondet_input(void);

static bool is_steady(elmopp_mode_t mode) {
    return (mode == ELMOPP_MODE_START_RED) || (mode == ELMOPP_MODE_FIRST_STAGE) || (mode == ELMOPP_MODE_AUTOMATIC) ||
           (mode == ELMOPP_MODE_FIXED_TIME) || (mode == ELMOPP_MODE_MANUAL) || (mode == ELMOPP_MODE_ALL_RED);
}

void harness(void) {
    const elmopp_junction_t junction = any_junction();
    uint32_t g;
    uint32_t h;
    any_conflict(&junction, &g, &h);
    elmopp_monitor_t monitor = nondet_monitor();
    monitor.junction = &junction;
    const elmopp_monitor_input_t input = nondet_input();
    const elmopp_fault_t earlier = monitor.first;

    const elmopp_fault_t verdict = elmopp_monitor_check(&monitor, &input);
    const uint32_t off_red = (uint32_t)input.command.green | input.command.amber;
    const bool flashing = has(input.command.flash, g) || has(input.command.flash, h);
    const bool both = has(off_red, g) && has(off_red, h);
    if (verdict == ELMOPP_FAULT_NONE) {
        CLAIM((!both) || (flashing && (!is_steady(input.mode))), "what passes shows no conflict");
        CLAIM((!(has(input.command.green, g) && has(input.command.green, h))), "two greens pass in no mode");
    }
    CLAIM((earlier == ELMOPP_FAULT_NONE) || (verdict == earlier), "the first fault latches");
    CLAIM(monitor.first == verdict, "the verdict is kept");
    REACHABLE();
}
