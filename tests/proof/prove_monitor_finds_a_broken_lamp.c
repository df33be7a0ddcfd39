/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Any state, any steady lamps: a group whose lamps have differed from its last command for 300 ms and differ still is
/// a fault in every mode that has feedback, and so is one whose feedback is missing. Whatever is said of the command:
/// its verdict is replaced by any.

#include "monitor.c"

#include "claims.h"

#define LONGEST_DS 3U

elmopp_monitor_t nondet_monitor(void);
elmopp_monitor_input_t nondet_input(void);
elmopp_fault_t nondet_fault(void);

elmopp_fault_t any_verdict(const elmopp_monitor_t *self, const elmopp_monitor_input_t *input, uint32_t g);

elmopp_fault_t any_verdict(const elmopp_monitor_t *self, const elmopp_monitor_input_t *input, uint32_t g) {
    (void)self;
    (void)input;
    (void)g;
    return nondet_fault();
}

static bool has(uint32_t mask, uint32_t index) {
    return ((mask >> index) & 1U) != 0U;
}

static bool differs(const elmopp_lamps_t *one, const elmopp_lamps_t *other, uint32_t g) {
    return (has(one->red, g) != has(other->red, g)) || (has(one->amber, g) != has(other->amber, g)) ||
           (has(one->green, g) != has(other->green, g));
}

void harness(void) {
    const elmopp_monitor_t monitor = nondet_monitor(); /* of any site: nothing of it is asked for */
    const elmopp_monitor_input_t input = nondet_input();
    const uint32_t g = nondet_u8();
    ASSUME(g < ELMOPP_GROUP_MAX);
    ASSUME(input.mode != ELMOPP_MODE_STARTING);
    ASSUME(!has(monitor.last.flash, g));

    const bool broken = differs(&monitor.last, &input.measured, g) && (monitor.differs_ds[g] >= LONGEST_DS);
    const bool lost = !has(input.fresh, g);
    const elmopp_fault_t fault = elmopp_monitor_judge_group(&monitor, &input, g);
    CLAIM((!(broken || lost)) || (fault != ELMOPP_FAULT_NONE), "a broken lamp is a fault");
    REACHABLE();
}
