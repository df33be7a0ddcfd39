// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// AR(8) of one approach's inflow, fitted by least squares: the data of the core's forecast `ar8`.

#pragma once

#include "core.hpp"

#include <vector>

namespace elmopp {

/// Mean of the training points of one series (docs/algorithm.md, 1.7: the causal demand scale).
double training_mean(const std::vector<double> &series);

/// Intercept and eight lags over the training points, in units of their mean, with the clamp widened by a tenth of the
/// range.
elmopp_ar8_t fit_ar8(const std::vector<double> &series);

} // namespace elmopp
