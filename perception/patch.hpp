// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// A piece of the road, drawn as if it were a rectangle: columns across the lanes, rows along the travel, row 0 where
/// vehicles come from. Every lane is `patch_unit` columns wide and every row is 1 / patch_unit of a lane's width long,
/// so that a vehicle has the same size near and far and the work does not depend on the size of the picture.
///
/// Sampling is bilinear; where a step is longer than 1.5 pixels the picture is averaged first. Pure but for the frame
/// that it is given.

#pragma once

#include "lanes.hpp"

#include <opencv2/core.hpp>

#include <vector>

namespace elmopp {

constexpr int patch_unit = 32;       ///< columns of a lane, and rows of one lane's width
constexpr int patch_margin = 10;     ///< columns beyond the outer lanes of a section
constexpr double patch_reach = 0.75; ///< of a section before and behind the line, in lane widths

class Patch {
  public:
    /// The line of neighbouring lanes, from the first to the last as they lie side by side.
    static Patch across(const std::vector<Lane> &lanes, cv::Size picture);

    /// The zone of one lane, along its travel.
    static Patch along(const Lane &lane, cv::Size picture);

    /// The box about a polygon, in steps of `lane_px` / patch_unit; only the polygon counts. At most 4 lane widths are
    /// drawn in full; a larger box gets longer steps.
    static Patch over(const Polygon &polygon, double lane_px, cv::Size picture);

    /// The piece of this picture (BGR, or a mask), whose content is moved by `shift_px` from where the lane file has
    /// it.
    [[nodiscard]] cv::Mat sample(const cv::Mat &frame, const cv::Point2d &shift_px) const;

    [[nodiscard]] cv::Size size() const {
        return map_x_.size();
    }

    /// 255 where a pixel counts: inside of the picture and of no mask.
    [[nodiscard]] const cv::Mat &valid() const {
        return valid_;
    }

    /// Pixels of the picture in one lane's width, at the line or in the mean of a zone.
    [[nodiscard]] double lane_width_px() const {
        return lane_width_px_;
    }

    /// Of a zone: how fast its width grows along the travel, in pixels a pixel; 0: not at all.
    [[nodiscard]] double convergence() const {
        return convergence_;
    }

    /// Width of the zone in pixels at this row.
    [[nodiscard]] double width_px(int row) const {
        return widths_px_[static_cast<std::size_t>(row)];
    }

  private:
    void finish(const std::vector<Lane> &lanes, cv::Size picture, double step_px);

    cv::Mat map_x_;
    cv::Mat map_y_;
    cv::Mat valid_;
    std::vector<double> widths_px_;
    double lane_width_px_ = 0.0;
    double convergence_ = 0.0;
    int average_px_ = 1;
    cv::Rect needed_;
};

} // namespace elmopp
