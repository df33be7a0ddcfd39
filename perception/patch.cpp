// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "patch.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace elmopp {
namespace {

bool is_vertical(Direction direction) {
    return direction == Direction::up || direction == Direction::down;
}

/// The way of travel, at right angles to the line.
cv::Point2d travel_of(const Lane &lane, const cv::Point2d &along) {
    cv::Point2d travel(-along.y, along.x);
    const cv::Point2d meant = lane.direction == Direction::up     ? cv::Point2d(0, -1)
                              : lane.direction == Direction::down ? cv::Point2d(0, 1)
                              : lane.direction == Direction::left ? cv::Point2d(-1, 0)
                                                                  : cv::Point2d(1, 0);
    return travel.dot(meant) < 0 ? -travel : travel;
}

/// Where a row of a zone begins and ends, across the travel; false: the polygon is not there.
bool cut(const Polygon &zone, bool vertical, double at, double &low, double &high) {
    bool found = false;
    for (std::size_t i = 0; i < zone.size(); ++i) {
        cv::Point2d a = zone[i];
        cv::Point2d b = zone[(i + 1) % zone.size()];
        if (!vertical) {
            std::swap(a.x, a.y);
            std::swap(b.x, b.y);
        }
        if ((a.y <= at) == (b.y <= at)) {
            continue;
        }
        const double x = a.x + (b.x - a.x) * (at - a.y) / (b.y - a.y);
        low = found ? std::min(low, x) : x;
        high = found ? std::max(high, x) : x;
        found = true;
    }
    return found;
}

/// The part of a zone, along its axis, that is as wide as its sides say: where an end is slanted the zone runs out into
/// a corner, whose width says nothing about how far away it is.
std::pair<double, double> full_part(const Polygon &zone, bool vertical, double first, double last) {
    constexpr double least_share = 0.6;
    std::vector<cv::Vec2d> widths; // position, width
    const int rows = static_cast<int>(std::ceil(last - first - 0.5));
    for (int row = 0; row < rows; ++row) {
        const double at = first + 0.5 + row;
        double low = 0;
        double high = 0;
        if (cut(zone, vertical, at, low, high)) {
            widths.emplace_back(at, high - low);
        }
    }
    if (widths.size() < 4) {
        return {first, last};
    }
    std::vector<cv::Point2f> middle; // the half between the ends
    for (std::size_t i = widths.size() / 4; i <= widths.size() * 3 / 4; ++i) {
        middle.emplace_back(static_cast<float>(widths[i][0]), static_cast<float>(widths[i][1]));
    }
    cv::Vec4f line;
    cv::fitLine(middle, line, cv::DIST_L2, 0, 0.01, 0.01);
    const double slope = std::abs(line[0]) > 1e-6F ? static_cast<double>(line[1]) / static_cast<double>(line[0]) : 0.0;
    const auto full = [&](const cv::Vec2d &row) {
        const double wanted = static_cast<double>(line[3]) + slope * (row[0] - static_cast<double>(line[2]));
        return row[1] >= least_share * wanted;
    };
    const auto begin = std::find_if(widths.begin(), widths.end(), full);
    const auto end = std::find_if(widths.rbegin(), widths.rend(), full);
    return begin == widths.end() ? std::pair(first, last) : std::pair((*begin)[0] - 0.5, (*end)[0] + 0.5);
}

} // namespace

Patch Patch::across(const std::vector<Lane> &lanes, cv::Size picture) {
    Patch patch;
    const cv::Point2d whole = lanes.back().to_px - lanes.front().from_px;
    const cv::Point2d along = whole / cv::norm(whole);
    const cv::Point2d travel = travel_of(lanes.front(), along);
    const double width_px = cv::norm(whole) / static_cast<double>(lanes.size());
    const double step_px = width_px / patch_unit;
    std::vector<cv::Point2d> columns;
    for (int i = patch_margin; i > 0; --i) {
        columns.push_back(lanes.front().from_px - along * (step_px * (i - 0.5)));
    }
    for (const Lane &lane : lanes) {
        for (int i = 0; i < patch_unit; ++i) {
            columns.push_back(lane.from_px + (lane.to_px - lane.from_px) * ((i + 0.5) / patch_unit));
        }
    }
    for (int i = 1; i <= patch_margin; ++i) {
        columns.push_back(lanes.back().to_px + along * (step_px * (i - 0.5)));
    }
    const int half = static_cast<int>(patch_reach * patch_unit);
    const cv::Size size(static_cast<int>(columns.size()), 2 * half + 1);
    patch.map_x_.create(size, CV_32F);
    patch.map_y_.create(size, CV_32F);
    for (int row = 0; row < size.height; ++row) {
        for (int column = 0; column < size.width; ++column) {
            const cv::Point2d at = columns[static_cast<std::size_t>(column)] + travel * (step_px * (row - half));
            patch.map_x_.at<float>(row, column) = static_cast<float>(at.x);
            patch.map_y_.at<float>(row, column) = static_cast<float>(at.y);
        }
    }
    patch.widths_px_.assign(static_cast<std::size_t>(size.height), width_px);
    patch.lane_width_px_ = width_px;
    patch.finish(lanes, picture, step_px);
    return patch;
}

Patch Patch::along(const Lane &lane, cv::Size picture) {
    constexpr double least_width_px = 4.0;
    const bool vertical = is_vertical(lane.direction);
    const bool ascending = lane.direction == Direction::down || lane.direction == Direction::right;
    double first = vertical ? lane.zone_px[0].y : lane.zone_px[0].x;
    double last = first;
    for (const cv::Point2d &corner : lane.zone_px) {
        first = std::min(first, vertical ? corner.y : corner.x);
        last = std::max(last, vertical ? corner.y : corner.x);
    }
    std::tie(first, last) = full_part(lane.zone_px, vertical, first, last);
    // Rows from the near end of the axis to its far end; turned round at the end if vehicles come from there.
    std::vector<cv::Vec3d> rows; // position, low end, high end
    double at = first + 0.5;
    while (at < last) {
        double low = 0;
        double high = 0;
        if (!cut(lane.zone_px, vertical, at, low, high)) {
            break;
        }
        const double width_px = std::max(high - low, least_width_px);
        rows.emplace_back(at, (low + high - width_px) / 2, (low + high + width_px) / 2);
        at += width_px / patch_unit;
    }
    if (rows.empty()) {
        rows.emplace_back(first, 0.0, least_width_px);
    }
    if (!ascending) {
        std::reverse(rows.begin(), rows.end());
    }
    Patch patch;
    const cv::Size size(patch_unit, static_cast<int>(rows.size()));
    patch.map_x_.create(size, CV_32F);
    patch.map_y_.create(size, CV_32F);
    double sum_px = 0;
    for (int row = 0; row < size.height; ++row) {
        const cv::Vec3d &where = rows[static_cast<std::size_t>(row)];
        const double width_px = where[2] - where[1];
        patch.widths_px_.push_back(width_px);
        sum_px += width_px;
        for (int column = 0; column < size.width; ++column) {
            const double side = where[1] + width_px * (column + 0.5) / patch_unit;
            patch.map_x_.at<float>(row, column) = static_cast<float>(vertical ? side : where[0]);
            patch.map_y_.at<float>(row, column) = static_cast<float>(vertical ? where[0] : side);
        }
    }
    patch.lane_width_px_ = sum_px / size.height;
    const double length_px = std::max(1.0, std::abs(rows.back()[0] - rows.front()[0]));
    patch.convergence_ = (patch.widths_px_.back() - patch.widths_px_.front()) / length_px;
    patch.finish({lane}, picture, patch.lane_width_px_ / patch_unit);
    return patch;
}

Patch Patch::over(const Polygon &polygon, double lane_px, cv::Size picture) {
    constexpr int most_rows = 4 * patch_unit;
    const std::vector<cv::Point2f> corners(polygon.begin(), polygon.end());
    const cv::Rect box = cv::boundingRect(corners);
    const double step_px =
        std::max(lane_px / patch_unit, static_cast<double>(std::max(box.width, box.height)) / most_rows);
    Patch patch;
    const cv::Size size(std::max(1, static_cast<int>(box.width / step_px)),
                        std::max(1, static_cast<int>(box.height / step_px)));
    patch.map_x_.create(size, CV_32F);
    patch.map_y_.create(size, CV_32F);
    for (int row = 0; row < size.height; ++row) {
        for (int column = 0; column < size.width; ++column) {
            patch.map_x_.at<float>(row, column) = static_cast<float>(box.x + (column + 0.5) * step_px);
            patch.map_y_.at<float>(row, column) = static_cast<float>(box.y + (row + 0.5) * step_px);
        }
    }
    patch.widths_px_.assign(static_cast<std::size_t>(size.height), lane_px);
    patch.lane_width_px_ = lane_px;
    patch.finish({}, picture, step_px);
    for (int row = 0; row < size.height; ++row) {
        for (int column = 0; column < size.width; ++column) {
            const cv::Point2f at(patch.map_x_.at<float>(row, column), patch.map_y_.at<float>(row, column));
            if (cv::pointPolygonTest(corners, at, false) < 0) {
                patch.valid_.at<uchar>(row, column) = 0;
            }
        }
    }
    return patch;
}

void Patch::finish(const std::vector<Lane> &lanes, cv::Size picture, double step_px) {
    constexpr double coarse_px = 1.5;
    average_px_ = step_px >= coarse_px ? 2 * (static_cast<int>(std::lround(step_px)) / 2) + 1 : 1;
    valid_.create(size(), CV_8U);
    cv::Point2f low(1e6F, 1e6F);
    cv::Point2f high(-1e6F, -1e6F);
    for (int row = 0; row < size().height; ++row) {
        for (int column = 0; column < size().width; ++column) {
            const cv::Point2f at(map_x_.at<float>(row, column), map_y_.at<float>(row, column));
            low = {std::min(low.x, at.x), std::min(low.y, at.y)};
            high = {std::max(high.x, at.x), std::max(high.y, at.y)};
            bool counts = at.x >= 0 && at.y >= 0 && at.x <= static_cast<float>(picture.width - 1) &&
                          at.y <= static_cast<float>(picture.height - 1);
            for (const Lane &lane : lanes) {
                for (const Polygon &mask : lane.mask_px) {
                    const std::vector<cv::Point2f> corners(mask.begin(), mask.end());
                    counts = counts && cv::pointPolygonTest(corners, at, false) < 0;
                }
            }
            valid_.at<uchar>(row, column) = counts ? 255 : 0;
        }
    }
    const cv::Point from(static_cast<int>(std::floor(low.x)), static_cast<int>(std::floor(low.y)));
    const cv::Point to(static_cast<int>(std::ceil(high.x)) + 2, static_cast<int>(std::ceil(high.y)) + 2);
    needed_ = cv::Rect(from, to);
}

cv::Mat Patch::sample(const cv::Mat &frame, const cv::Point2d &shift_px) const {
    const cv::Point moved(static_cast<int>(std::floor(shift_px.x)), static_cast<int>(std::floor(shift_px.y)));
    const cv::Rect wanted(needed_.tl() + moved - cv::Point(average_px_, average_px_),
                          needed_.br() + moved + cv::Point(average_px_, average_px_));
    const cv::Rect part = wanted & cv::Rect(cv::Point(0, 0), frame.size());
    if (part.area() == 0) {
        return cv::Mat::zeros(size(), frame.type());
    }
    cv::Mat source = frame(part);
    if (average_px_ > 1) {
        cv::Mat smooth;
        cv::blur(source, smooth, cv::Size(average_px_, average_px_));
        source = std::move(smooth);
    }
    const cv::Mat x = map_x_ + (shift_px.x - part.x);
    const cv::Mat y = map_y_ + (shift_px.y - part.y);
    cv::Mat piece;
    cv::remap(source, piece, x, y, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    return piece;
}

} // namespace elmopp
