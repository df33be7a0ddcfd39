// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Experiment: the paper's evaluation, every chooser on the same trials, with a table, figures and a verdict on every
/// claim.

#pragma once

#include "choosers.hpp"
#include "inflow.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace elmopp {

struct ExperimentRequest {
    std::vector<std::string> profiles{"paper", "saturation"};
    std::vector<ChooserSpec> choosers;                        ///< empty: of each profile the usual ones
    std::vector<unsigned> vehicles{200, 400, 600, 800, 1000}; ///< empty: a random number each trial
    std::uint64_t trials = 30;
    std::uint64_t seed = 1;
    unsigned jobs = 1;
    std::filesystem::path out{"out/experiment"};
    std::optional<std::filesystem::path> count_scores;
    std::vector<double> split; ///< shares of left, middle, right; empty: equal
    Mapping mapping = Mapping::abs;
    std::optional<Integrator> integrator; ///< the profile's unless given
    bool beside = true;                   ///< the sweeps and the further profiles that the claims and figures need
    bool figures = true;
};

/// Runs it and writes the folder `out`, all of it or nothing. Says on stdout where to look.
void run_experiment(const ExperimentRequest &request);

} // namespace elmopp
