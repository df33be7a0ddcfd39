/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The words of a proof. One file a claim, named after it, with one function harness(); tools/prove hands it to CBMC.
///
/// A value is arbitrary if it comes from a function nondet_*() without a body. ASSUME narrows what is looked at, CLAIM
/// must then hold of all of it. REACHABLE() ends the harness: built with VACUITY it must be refuted, or else the
/// assumptions contradict each other and the proof says nothing.

#ifndef ELMOPP_PROOF_CLAIMS_H
#define ELMOPP_PROOF_CLAIMS_H

#include <stdbool.h>
#include <stdint.h>

void __CPROVER_assume(_Bool condition);
void __CPROVER_assert(_Bool condition, const char *text);

#define ASSUME(condition) __CPROVER_assume(condition)

#ifdef VACUITY
#define CLAIM(condition, text) ((void)(condition))
#define REACHABLE() __CPROVER_assert(0, "the end of the harness is reached")
#else
#define CLAIM(condition, text) __CPROVER_assert((condition), (text))
#define REACHABLE() ((void)0)
#endif

bool nondet_bool(void);
uint8_t nondet_u8(void);
uint16_t nondet_u16(void);
uint32_t nondet_u32(void);

void harness(void);

/// A broken ELMOPP_ASSERT of the core refutes whatever is being proved.
_Noreturn void elmopp_assert_failed(const char *file, int line);
inline _Noreturn void elmopp_assert_failed(const char *file, int line) {
    (void)file;
    (void)line;
    __CPROVER_assert(0, "an assert of the core holds");
    __CPROVER_assume(0);
    for (;;) {
    }
}

#endif
