// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Bench: what a network's step and a forecast cost, how many simulated seconds a second per chooser, and what a second
/// core brings.

#pragma once

#include <filesystem>
#include <optional>

namespace elmopp {

/// Prints a table and, if asked, writes JSON: `lstm_step_ns`, `nlstm_step_ns`, `rollout60_us` (free run of `lstm` over
/// a minute), `lstm_digest` (over the bits of what both networks say in a fixed sequence: equal in every build), and
/// unless `forecast_only` `ticks_per_s.<chooser>` and `jobs2_speedup`. Medians of interleaved rounds.
void run_bench(const std::optional<std::filesystem::path> &json, bool forecast_only);

} // namespace elmopp
