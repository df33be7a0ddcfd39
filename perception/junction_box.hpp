// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Whether a vehicle is inside the junction: a polygon of the lane file, watched like a zone, moving or standing.
/// Owner: the counter. Not thread-safe.

#pragma once

#include "background.hpp"
#include "patch.hpp"

#include <vector>

namespace elmopp {

class JunctionBox {
  public:
    /// `lane_px`: width of a lane in pixels, for the size of a vehicle.
    JunctionBox(const Polygon &polygon, double lane_px, cv::Size picture);

    [[nodiscard]] const Patch &patch() const {
        return patch_;
    }

    [[nodiscard]] Background &background() {
        return background_;
    }

    void feed(const Background::Sample &sample, double dt_s);

    [[nodiscard]] bool occupied() const {
        return occupied_;
    }

  private:
    Patch patch_;
    Background background_;
    double on_s_ = 0.0;
    double off_s_ = 0.0;
    double vehicle_pixels_;
    bool occupied_ = false;
};

} // namespace elmopp
