// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Accuracy: how far the core's forecasts are from what comes, over the trials of the experiment.
///
/// Every forecast of the core absorbs every second of a trial as the controller would, and is asked in every simulated
/// second; errors are in units of the demand scale (the mean of the training points of its approach), pooled over
/// trials, approaches and seconds. It judges forecasts alone: no chooser, no fall-back.

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace elmopp {

struct AccuracyRequest {
    std::uint64_t trials = 30;
    std::uint64_t seed = 1;
    unsigned jobs = 1;
    std::vector<std::filesystem::path> weights; ///< ELMW images instead of the shipped weights of as many levels
    std::optional<std::filesystem::path> json;
};

/// Prints a table and, if asked, writes JSON: {trials, seed, signal_sd, rmse: {FORECAST: {SECONDS: value}},
/// distrusted_share: {NETWORK: share of seconds in which the controller would fall back}}.
void run_accuracy(const AccuracyRequest &request);

} // namespace elmopp
