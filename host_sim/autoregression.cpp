// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "autoregression.hpp"

#include "inflow.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <numeric>

namespace elmopp {
namespace {

constexpr double clamp_widening = 0.1;

} // namespace

double training_mean(const std::vector<double> &series) {
    const auto end = series.begin() + static_cast<std::ptrdiff_t>(training_points);
    return std::accumulate(series.begin(), end, 0.0) / static_cast<double>(training_points);
}

elmopp_ar8_t fit_ar8(const std::vector<double> &series) {
    const double mean = training_mean(series);
    constexpr Eigen::Index lags = ELMOPP_AR8_LAGS;
    constexpr auto rows = static_cast<Eigen::Index>(training_points) - lags;
    Eigen::Matrix<double, Eigen::Dynamic, lags + 1> design(rows, lags + 1);
    Eigen::VectorXd target(rows);
    for (Eigen::Index row = 0; row < rows; ++row) {
        design(row, 0) = 1.0;
        for (Eigen::Index lag = 0; lag < lags; ++lag) {
            design(row, lag + 1) = series[static_cast<std::size_t>(row + lags - 1 - lag)] / mean;
        }
        target(row) = series[static_cast<std::size_t>(row + lags)] / mean;
    }
    // The lags of a smooth flow are nearly collinear: a rank-revealing QR, not the normal equations.
    const Eigen::VectorXd solution = design.colPivHouseholderQr().solve(target);
    elmopp_ar8_t model{};
    model.intercept = static_cast<float>(solution(0));
    for (Eigen::Index lag = 0; lag < lags; ++lag) {
        model.lag[lag] = static_cast<float>(solution(lag + 1));
    }
    const auto [low, high] =
        std::minmax_element(series.begin(), series.begin() + static_cast<std::ptrdiff_t>(training_points));
    const double widening = clamp_widening * (*high - *low);
    model.low = static_cast<float>(std::max(0.0, (*low - widening) / mean));
    model.high = static_cast<float>((*high + widening) / mean);
    return model;
}

} // namespace elmopp
