// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Drawn roads that differ in what real ones differ in: the camera's height, lens and angle, the size of the picture,
/// its rate and compression, the light, the vehicles. Each by name, with traffic and its truth; all of it follows from
/// the name and the seed of the traffic.

#pragma once

#include "scene.hpp"

#include <string>
#include <vector>

namespace elmopp {

struct Road {
    Scene scene;
    SceneFlow flow;
    std::vector<Direction> directions; ///< [lane]
    double zone_m = 0.0;               ///< 0: without zones
    double rate = 25.0;
    int quality = 0; ///< of JPEG, through which each picture goes; 0: through none

    [[nodiscard]] LaneFile lanes() const;

    /// The picture at a time, as the camera gives it.
    cv::Mat picture(double t_s);

    /// When the middle of the vehicle's image is on the line.
    [[nodiscard]] double seen_crossing_s(const SceneFlow::Car &car) const;

    /// Vehicles whose middle is in the zone of a lane.
    [[nodiscard]] int present(int lane, double t_s) const;
};

std::vector<std::string> road_names();

constexpr unsigned usual_seed = 7;

/// Throws std::out_of_range if there is none of that name. `seed`: of the traffic.
Road road_named(const std::string &name, double seconds, unsigned seed = usual_seed);

} // namespace elmopp
