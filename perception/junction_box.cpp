// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "junction_box.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>

namespace elmopp {

JunctionBox::JunctionBox(const Polygon &polygon, double lane_px, cv::Size picture)
    : patch_(Patch::over(polygon, lane_px, picture)), background_(patch_.valid()) {
    constexpr double least_side = 0.4; // a vehicle is at least so large, in lane widths
    const std::vector<cv::Point2f> corners(polygon.begin(), polygon.end());
    const double pixels_a_px = cv::countNonZero(patch_.valid()) / std::max(1.0, std::abs(cv::contourArea(corners)));
    vehicle_pixels_ = least_side * least_side * lane_px * lane_px * pixels_a_px;
}

void JunctionBox::feed(const Background::Sample &sample, double dt_s) {
    constexpr double said_after_s = 0.15;
    constexpr double clear_after_s = 0.4;
    constexpr double ghost_s = 2.0;
    const Background::Seen seen = background_.look(sample);
    background_.renew(seen, dt_s, cv::Mat(), ghost_s);
    cv::Mat labels;
    cv::Mat sizes;
    cv::Mat middles;
    const int many = cv::connectedComponentsWithStats(seen.object, labels, sizes, middles);
    int largest = 0;
    for (int i = 1; i < many; ++i) {
        largest = std::max(largest, sizes.at<int>(i, cv::CC_STAT_AREA));
    }
    const bool now = largest > vehicle_pixels_;
    on_s_ = now ? on_s_ + dt_s : 0.0;
    off_s_ = now ? 0.0 : off_s_ + dt_s;
    if (on_s_ > said_after_s) {
        occupied_ = true;
    } else if (off_s_ > clear_after_s) {
        occupied_ = false;
    }
}

} // namespace elmopp
