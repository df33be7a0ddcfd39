// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Foresight: what the core's networks say about one trajectory, second by second, worked out once.
///
/// A network sees arrivals in units of their demand scale, so what it says depends neither on the chooser nor on the
/// number of vehicles. The core's own pilot runs once over the trajectory, fall-back and all, with a chooser that
/// only writes down what it is shown; the trials then get these rows as they would get an oracle's. `host_sim run`
/// does not use this: there the network runs inside the trial.

#pragma once

#include "core.hpp"
#include "inflow.hpp"

#include <string>
#include <vector>

namespace elmopp {

/// Rows of one network on one trajectory, for one vehicle an approach in the simulated seconds.
struct Foresight {
    std::uint16_t steps = 0;
    std::size_t approaches = 0;
    std::vector<float> unit_veh;  ///< [second][approach][step]
    std::size_t distrusted_s = 0; ///< seconds in which the pilot fell back to the mean

    [[nodiscard]] const float *row(std::size_t second, std::size_t approach) const {
        return &unit_veh[(second * approaches + approach) * steps];
    }
};

/// What a foresight is of.
struct Foreseen {
    std::string forecast; ///< a network, by its name
    const elmopp_weights_t &weights;
    const Series &unit; ///< as of unit_inflow(), [approach][point], one approach each of the paper's junction
    std::uint16_t steps;
    std::size_t seconds;
    std::size_t known_s = ELMOPP_FORECAST_MEAN_WINDOW_S; ///< before second 0 that it has seen
};

Foresight foresee(const Foreseen &asked);

} // namespace elmopp
