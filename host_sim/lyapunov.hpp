// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Lyapunov exponents of the inflow system as it is integrated: the check of the paper's word "hyperchaotic".

#pragma once

#include "inflow.hpp"

namespace elmopp {

/// The four exponents per unit of time, largest first, by QR of the discrete map's tangent (Benettin et al. 1980) over
/// `steps` steps of time_step after a transient of a tenth of that, from (.5, .5, .5, .5).
std::array<double, 4> lyapunov_exponents(Integrator integrator, std::size_t steps);

} // namespace elmopp
