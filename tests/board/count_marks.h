/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The marks between which tools/cortex_m4/count_plugin.c counts: hints without a meaning, which a processor passes
/// over.

#ifndef ELMOPP_COUNT_MARKS_H
#define ELMOPP_COUNT_MARKS_H

#define COUNT_BEGIN() __asm__ volatile(".inst.w 0xF3AF8040" ::: "memory")
#define COUNT_END() __asm__ volatile(".inst.w 0xF3AF8041" ::: "memory")

#endif
