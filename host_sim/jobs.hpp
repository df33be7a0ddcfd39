// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Jobs: independent work on several cores with results in fixed places, so that the number of cores changes no byte.

#pragma once

#include <cstddef>
#include <functional>

namespace elmopp {

/// Calls work(0) .. work(count - 1), each once, on at most `jobs` threads. The first exception stops the rest and is
/// thrown again. `done` (may be empty) is told how many are finished, from one thread at a time.
void run_jobs(std::size_t count, unsigned jobs, const std::function<void(std::size_t)> &work,
              const std::function<void(std::size_t)> &done);

/// From now on an interrupt (Ctrl-C) or a request to end lets check_interrupt() throw, so that drafts are cleaned up.
void catch_interrupts();

/// Throws Failure if an interrupt has come. Called between jobs and once a simulated second.
void check_interrupt();

/// True if one has come: for a program that ends by it.
bool interrupt_has_come();

} // namespace elmopp
