// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// What a program of a port waits for: a grid of lamp ticks, signals, frames.
///
/// The grid is of CLOCK_MONOTONIC and absolute, so that ticks do not drift; ticks that were missed are told, not made
/// up for. Signals come in order between frames, never in the middle of anything.

#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>

namespace elmopp {

/// Milliseconds of CLOCK_MONOTONIC; wraps.
std::uint32_t monotonic_ms();

class Wakeups {
  public:
    /// `period_ms` 0: no ticks. The signals are blocked from now on and come through here.
    Wakeups(std::uint32_t period_ms, std::initializer_list<int> signals);
    ~Wakeups();
    Wakeups(const Wakeups &) = delete;
    Wakeups &operator=(const Wakeups &) = delete;
    Wakeups(Wakeups &&) = delete;
    Wakeups &operator=(Wakeups &&) = delete;

    /// Waits for a tick, a signal or something on `descriptor` (-1: nothing there), at most a second.
    void wait(int descriptor) const;

    /// Ticks that have become due since the last call; more than 1: some were missed.
    std::uint64_t ticks();

    /// The next signal that has come.
    std::optional<int> signal();

  private:
    int timer_ = -1;
    int signals_ = -1;
};

} // namespace elmopp
