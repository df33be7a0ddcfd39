// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Lane files, `elmopp-lanes/1`: where the lanes lie in the picture of one camera. Geometry only; every other setting
/// is the same for all cameras.
///
/// Reads a file and checks it: wrong types, unknown keys, lines that are points, zones without area, points outside of
/// the picture, names that come twice. Never guesses: what is wrong is refused with the key and what would be right.

#pragma once

#include <opencv2/core.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace elmopp {

/// Where vehicles drive in the picture; across the line of the lane.
enum class Direction { up, down, left, right };

using Polygon = std::vector<cv::Point2d>;

struct Lane {
    std::string name;
    cv::Point2d from_px; ///< the line, from its left or upper end
    cv::Point2d to_px;
    Direction direction = Direction::down;
    Polygon zone_px;              ///< where vehicles present are counted; empty: nowhere
    std::vector<Polygon> mask_px; ///< parts of the picture that never count
    std::optional<int> approach;  ///< on the bus, 0 to 7; none: not sent
    std::optional<int> movement;  ///< on the bus, 0 to 2
};

struct LaneFile {
    int width_px = 0;
    int height_px = 0;
    std::vector<Lane> lanes;
    Polygon junction_px;             ///< the box inside of the junction; empty: none
    std::filesystem::path reference; ///< picture of the empty road; empty: none
    std::filesystem::path model;     ///< ONNX detector; empty: none
};

/// Throws BadRequest naming the file and the key. Files that it names are relative to its folder.
LaneFile read_lane_file(const std::filesystem::path &file);

/// The same from text; `name` is what messages call it.
LaneFile parse_lane_file(const std::string &text, const std::string &name, const std::filesystem::path &folder);

/// What is allowed and yet will hardly work: a line at the border of the picture, a lane of a few pixels. One text
/// each.
std::vector<std::string> lane_file_warnings(const LaneFile &file);

} // namespace elmopp
