// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Bench: how many simulated seconds a second, per chooser, and what a second core brings.

#pragma once

#include <filesystem>
#include <optional>

namespace elmopp {

/// Prints a table and, if asked, writes JSON: `ticks_per_s.<chooser>`, `jobs2_speedup`. Medians of interleaved rounds.
void run_bench(const std::optional<std::filesystem::path> &json);

} // namespace elmopp
