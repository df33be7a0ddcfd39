// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// A junction on the bench that somebody overhears from both sides: one a test program, as the bench has no state for
/// who listens.

#pragma once

extern "C" {
#include "bench.h"
#include "unity.h"
}

#include <cstdint>
#include <functional>
#include <utility>

using onlooker_t = std::function<void(const elmopp_frame_t &frame, std::uint32_t now_ms)>;

inline bench_t bench;
inline onlooker_t onlooker;

/// In automatic mode, and so many ticks further.
inline void start_overheard(const elmopp_junction_t &site, onlooker_t hears, std::uint32_t ticks) {
    onlooker = std::move(hears);
    bench_start(&bench, &site);
    bench.heard = [](const elmopp_frame_t *frame) { onlooker(*frame, bench.now_ms); };
    bench.fate = [](void * /*state*/, const elmopp_frame_t *frame) {
        onlooker(*frame, bench.now_ms);
        return BENCH_PASS;
    };
    bench_fill(&bench);
    TEST_ASSERT_TRUE(bench_until(&bench, ELMOPP_MODE_AUTOMATIC, 600));
    bench_ticks(&bench, ticks);
}
