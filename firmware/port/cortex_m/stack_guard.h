/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Stack guard: a stack that grows into the variables below it ends in the fault handler instead.
///
/// The lowest ELMOPP_STACK_GUARD_BYTES of what the linker left for the stack belong to nobody, by a region of the
/// memory protection unit (ARMv7-M ARM, B3.5). In the fault handler the unit is off, so that it can still call. Costs
/// nothing at run time.

#ifndef ELMOPP_STACK_GUARD_H
#define ELMOPP_STACK_GUARD_H

#define ELMOPP_STACK_GUARD_BYTES 256U

/// From here on. A processor without the unit goes on without.
void elmopp_stack_guard_start(void);

#endif
