// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "lyapunov.hpp"

#include "jobs.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <functional>

namespace elmopp {
namespace {

using Matrix = Eigen::Matrix4d;

/// Jacobian of derivative().
Matrix jacobian(const State &s) {
    using namespace parameters;
    const double x = s[0], y = s[1], z = s[2];
    Matrix j;
    j << -a, a, 0.0, -e, //
        z, -h, x, 0.0,   //
        -y, -x, -c, 0.0, //
        0.0, k, 0.0, -d;
    return j;
}

/// Derivative of advance() with respect to the state: the same stages, differentiated.
Matrix tangent(Integrator integrator, const State &s) {
    const Matrix one = Matrix::Identity();
    const Matrix d1 = jacobian(s);
    if (integrator == Integrator::euler) {
        return one + time_step * d1;
    }
    const State k1 = derivative(s);
    const State s2 = along(s, k1, time_step / 2);
    const Matrix d2 = jacobian(s2) * (one + time_step / 2 * d1);
    const State k2 = derivative(s2);
    const State s3 = along(s, k2, time_step / 2);
    const Matrix d3 = jacobian(s3) * (one + time_step / 2 * d2);
    const State k3 = derivative(s3);
    const Matrix d4 = jacobian(along(s, k3, time_step)) * (one + time_step * d3);
    return one + time_step / 6 * (d1 + 2 * d2 + 2 * d3 + d4);
}

} // namespace

std::array<double, 4> lyapunov_exponents(Integrator integrator, std::size_t steps) {
    State state{0.5, 0.5, 0.5, 0.5};
    for (std::size_t i = 0; i < steps / 10; ++i) {
        state = advance(integrator, state);
    }
    Matrix frame = Matrix::Identity();
    std::array<double, 4> sum{};
    for (std::size_t i = 0; i < steps; ++i) {
        check_interrupt();
        const Eigen::HouseholderQR<Matrix> qr(tangent(integrator, state) * frame);
        frame = qr.householderQ();
        for (Eigen::Index k = 0; k < 4; ++k) {
            sum[static_cast<std::size_t>(k)] += std::log(std::abs(qr.matrixQR()(k, k)));
        }
        state = advance(integrator, state);
    }
    for (double &exponent : sum) {
        exponent /= static_cast<double>(steps) * time_step;
    }
    std::sort(sum.begin(), sum.end(), std::greater<>());
    return sum;
}

} // namespace elmopp
