// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Claims: what the paper says, what the results say, and whether the two agree.
///
/// A verdict is computed from result rows and facts alone, so that a test can feed it made-up ones. What has not been
/// run is said to be not run.

#pragma once

#include "results.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace elmopp {

/// How far networks of one and of three levels were from one-minute demand an hour ahead (weights/long_memory.json).
struct LongMemory {
    std::vector<double> rmse_1; ///< [seed] one level
    std::vector<double> rmse_3; ///< [seed] three levels, as many parameters
};

/// Measured apart from the trials.
struct Facts {
    std::array<double, 4> exponents_rk4{};
    std::array<double, 4> exponents_euler{};
    std::optional<double> count_error; ///< share of vehicles miscounted by the camera, pooled over clips
    std::optional<LongMemory> long_memory;
};

enum class Verdict { reproduced, not_reproduced, not_run };

struct Claim {
    std::string id;
    std::string claim; ///< the paper's, in a sentence
    std::string printed;
    std::string measured;
    Verdict verdict;
};

/// All claims, in the order of the documentation. `trials` and `beside` are the rows of the files of these names; every
/// rival plays with the parameter of its sweep that serves it best.
std::vector<Claim> judge(const std::vector<Row> &trials, const std::vector<Row> &beside, const Facts &facts);

std::string to_string(Verdict verdict);

/// claims.json.
void write_claims(const std::filesystem::path &file, const std::vector<Claim> &claims);

/// The camera's pooled count error from a file of tools/score-counter. Throws BadRequest if it is not there.
double read_count_error(const std::filesystem::path &file);

/// The errors an hour ahead from a file of tools/train. Throws BadRequest if they are not there.
LongMemory read_long_memory(const std::filesystem::path &file);

/// Of one chooser's sweep (`itlc`, `itlc@ready=60`, ...) the label with the best pooled mean, among those with as many
/// trials as the plain one. Empty if there is none.
std::string best_label(const std::vector<Row> &rows, const std::string &profile, const std::string &chooser,
                       const Metric &metric, bool highest);

} // namespace elmopp
