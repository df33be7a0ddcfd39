// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Learning trial: does it pay to learn on in the street? Forecast error and delay on demand that the shipped networks
/// were not trained on, with the shipped weights, with weights that learn on, and with an oracle's.
///
/// Every forecast runs over the same trial from its first point, 8,000 s before second 0, so that who learns has had
/// time to. Errors are of what the forecast itself says, in units of the demand scale, pooled over approaches and
/// seconds of a trial; delays are those of a chooser that is shown it, with the pilot's fall-back to the mean. All is
/// paired by trial. The oracle's weights were trained on other trajectories of the same demand; in `shift` they change
/// with it.

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace elmopp {

struct LearningRequest {
    std::uint64_t trials = 30;
    std::uint64_t seed = 1;
    unsigned vehicles = 600;
    unsigned jobs = 1;
    unsigned updates = 6000; ///< of an oracle's training
    std::string chooser = "rollout";
    std::optional<std::filesystem::path> json;
};

/// Prints the tables and, if asked, writes JSON: {trials, seed, vehicles, chooser, updates, demands: {NAME: {rmse:
/// {FORECAST: {SECONDS: mean over trials}}, delay_s: {FORECAST: mean}, in_use_share, given_up, paired: {MEASURE:
/// {FORECAST: {mean, low, high}}}}}}, the pairs being differences to the shipped weights.
void run_learning(const LearningRequest &request);

} // namespace elmopp
