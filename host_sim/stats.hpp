// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Statistics of trials: means, paired differences, Welch's test.

#pragma once

#include <cstddef>
#include <vector>

namespace elmopp {

/// In their order, so that the same values give the same bits.
double sum(const std::vector<double> &values);

struct Summary {
    double mean = 0.0;
    double sd = 0.0; ///< of the sample, n - 1; 0 for a single value
    std::size_t n = 0;
};

Summary summarize(const std::vector<double> &values);

struct Interval {
    double low = 0.0;
    double high = 0.0;
};

/// 95 % interval of the mean of a - b, paired by position (Student, n - 1); a point for fewer than two pairs.
Interval paired_interval(const std::vector<double> &a, const std::vector<double> &b);

struct Welch {
    double t = 0.0;
    double df = 0.0;
    double p_one_sided = 1.0; ///< alternative: the mean of a is greater
};

/// Welch (1947) with the Welch-Satterthwaite degrees of freedom. Without any spread: p = 0 or 1 by the sign, 0.5 for
/// equal means.
Welch welch(const std::vector<double> &a, const std::vector<double> &b);

} // namespace elmopp
