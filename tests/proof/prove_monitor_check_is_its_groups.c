/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// One check is the verdict on every group, the first of them latched with its group, and every group remembered: the
/// loops add nothing.

#include "invariant.h"

elmopp_monitor_t nondet_monitor(void);
elmopp_monitor_input_t nondet_input(void);

void harness(void) {
    const elmopp_junction_t junction = any_junction();
    elmopp_monitor_t monitor = nondet_monitor();
    monitor.junction = &junction;
    const elmopp_monitor_input_t input = nondet_input();
    const uint32_t g = nondet_u8();
    ASSUME(g < junction.group_count);
    const elmopp_monitor_t before = monitor;

    const elmopp_fault_t on_g = elmopp_monitor_judge_group(&before, &input, g);
    const elmopp_fault_t verdict = elmopp_monitor_check(&monitor, &input);
    CLAIM((on_g == ELMOPP_FAULT_NONE) || (verdict != ELMOPP_FAULT_NONE), "no group's fault is passed over");
    if ((before.first == ELMOPP_FAULT_NONE) && (verdict != ELMOPP_FAULT_NONE) &&
        (verdict != ELMOPP_FAULT_UNKNOWN_GROUP)) {
        const elmopp_fault_t named = elmopp_monitor_judge_group(&before, &input, monitor.first_group);
        CLAIM(named == verdict, "the fault is the named group's");
    }
    elmopp_monitor_t remembered = before;
    elmopp_monitor_remember_group(&remembered, &input, g);
    CLAIM((monitor.age_ds[g] == remembered.age_ds[g]) && (monitor.differs_ds[g] == remembered.differs_ds[g]) &&
              (monitor.since_green_ds[g] == remembered.since_green_ds[g]),
          "every group is remembered");
    CLAIM((monitor.last.red == input.command.red) && (monitor.last.green == input.command.green) &&
              (monitor.last.amber == input.command.amber) && (monitor.last.flash == input.command.flash),
          "the command is remembered");
    REACHABLE();
}
