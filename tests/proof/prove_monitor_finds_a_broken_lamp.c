/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Any state, any steady lamps: a group whose lamps have differed from its last command for 300 ms and differ still is
/// a fault in every mode that has feedback, and so is one whose feedback is missing.

#include "arbitrary.h"

#include "elmopp/monitor.h"

#define LONGEST_DS 3U

elmopp_monitor_t nondet_monitor(void);
elmopp_monitor_input_t nondet_input(void);

static bool differs(const elmopp_lamps_t *one, const elmopp_lamps_t *other, uint32_t g) {
    return (has(one->red, g) != has(other->red, g)) || (has(one->amber, g) != has(other->amber, g)) ||
           (has(one->green, g) != has(other->green, g));
}

void harness(void) {
    const elmopp_junction_t junction = any_junction();
    elmopp_monitor_t monitor = nondet_monitor();
    monitor.junction = &junction;
    const elmopp_monitor_input_t input = nondet_input();
    const uint32_t g = any_group(&junction);
    ASSUME(input.mode != ELMOPP_MODE_STARTING);
    ASSUME(!has(monitor.last.flash, g));

    const bool broken = differs(&monitor.last, &input.measured, g) && (monitor.differs_ds[g] >= LONGEST_DS);
    const bool lost = !has(input.fresh, g);
    const elmopp_fault_t fault = elmopp_monitor_judge_group(&monitor, &input, g);
    CLAIM((!(broken || lost)) || (fault != ELMOPP_FAULT_NONE), "a broken lamp is a fault");
    REACHABLE();
}
