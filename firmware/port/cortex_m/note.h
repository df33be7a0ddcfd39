/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Note: how the last run ended, in a few words of RAM that nobody clears (linker symbol elmopp_note).
///
/// After the power has come they hold anything: a note is one only with its complement beside it.

#ifndef ELMOPP_NOTE_H
#define ELMOPP_NOTE_H

#include <stdbool.h>

/// The run ends by a fault: writes it down.
void elmopp_note_fault(void);

/// True if the last run ended by a fault. Wipes the note.
bool elmopp_note_take(void);

#endif
