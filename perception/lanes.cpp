// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "lanes.hpp"

#include "error.hpp"

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

namespace elmopp {
namespace {

using Json = nlohmann::json;

constexpr int most_pixels = 16384;
constexpr double least_line_px = 4.0;
constexpr double least_area_px = 16.0;

/// Reads one file: every complaint names it.
class LaneReader {
  public:
    LaneReader(std::string name, std::filesystem::path folder) : name_(std::move(name)), folder_(std::move(folder)) {}

    LaneFile read(const Json &json);

  private:
    [[noreturn]] void refuse(const std::string &key, const std::string &wanted) const {
        throw BadRequest(name_ + ": " + key + " " + wanted);
    }

    void keys(const Json &json, const std::string &key, const std::set<std::string> &allowed) const {
        if (!json.is_object()) {
            refuse(key, "must be an object");
        }
        for (const auto &[found, unused] : json.items()) {
            if (allowed.count(found) == 0) {
                const std::string unknown = "is unknown; a lane file is geometry only, its keys are in docs/camera.md";
                std::string where = key;
                where += "." + found;
                refuse(where, unknown);
            }
        }
    }

    const Json &need(const Json &json, const std::string &key, const std::string &child) const {
        if (!json.contains(child)) {
            refuse(key + "." + child, "is missing");
        }
        return json.at(child);
    }

    int whole(const Json &json, const std::string &key, int least, int most) const {
        const double value = json.is_number_integer() ? json.get<double>() : -1.0;
        if (!json.is_number_integer() || value < least || value > most) {
            refuse(key, "is " + json.dump() + "; right would be a whole number from " + std::to_string(least) + " to " +
                            std::to_string(most));
        }
        return json.get<int>();
    }

    std::string text(const Json &json, const std::string &key) const {
        if (!json.is_string() || json.get<std::string>().empty()) {
            refuse(key, "is " + json.dump() + "; right would be a text");
        }
        return json.get<std::string>();
    }

    cv::Point2d point(const Json &json, const std::string &key) const {
        if (!json.is_array() || json.size() != 2 || !json[0].is_number() || !json[1].is_number()) {
            refuse(key, "is " + json.dump() + "; right would be a point [x, y] in pixels");
        }
        const cv::Point2d at(json[0].get<double>(), json[1].get<double>());
        if (!(at.x >= 0.0 && at.y >= 0.0 && at.x <= width_ && at.y <= height_)) {
            refuse(key, "is " + json.dump() + ", outside of the picture of " + std::to_string(width_) + " x " +
                            std::to_string(height_));
        }
        return at;
    }

    Polygon polygon(const Json &json, const std::string &key) const {
        if (!json.is_array() || json.size() < 3) {
            refuse(key, "must be a polygon of three points or more");
        }
        Polygon corners;
        std::vector<cv::Point2f> single;
        for (std::size_t i = 0; i < json.size(); ++i) {
            corners.push_back(point(json[i], key + "[" + std::to_string(i) + "]"));
            single.emplace_back(corners.back());
        }
        if (cv::contourArea(single) < least_area_px) {
            refuse(key, "has no area");
        }
        return corners;
    }

    Direction direction(const Json &json, const std::string &key) const;
    Lane lane(const Json &json, const std::string &key) const;
    void across(const Lane &lane, const std::string &key) const;

    std::string name_;
    std::filesystem::path folder_;
    int width_ = 0;
    int height_ = 0;
};

Direction LaneReader::direction(const Json &json, const std::string &key) const {
    const std::string word = json.is_string() ? json.get<std::string>() : "";
    if (word == "up") {
        return Direction::up;
    }
    if (word == "down") {
        return Direction::down;
    }
    if (word == "left") {
        return Direction::left;
    }
    if (word != "right") {
        refuse(key, "is " + json.dump() + "; right would be up, down, left or right");
    }
    return Direction::right;
}

/// Vehicles drive across a line, not along it.
void LaneReader::across(const Lane &lane, const std::string &key) const {
    const cv::Point2d along = lane.to_px - lane.from_px;
    const bool vertical = lane.direction == Direction::up || lane.direction == Direction::down;
    const double wanted = vertical ? std::abs(along.x) : std::abs(along.y);
    if (cv::norm(along) < least_line_px) {
        refuse(key + ".line", "is shorter than four pixels");
    }
    if (wanted < 0.3 * cv::norm(along)) {
        refuse(key + ".direction", "runs along the line of the lane; right would be the way that vehicles cross it");
    }
}

Lane LaneReader::lane(const Json &json, const std::string &key) const {
    keys(json, key, {"name", "line", "direction", "zone", "mask", "approach", "movement"});
    Lane lane;
    lane.name = text(need(json, key, "name"), key + ".name");
    const Json &line = need(json, key, "line");
    if (!line.is_array() || line.size() != 2) {
        refuse(key + ".line", "must be two points");
    }
    lane.from_px = point(line[0], key + ".line[0]");
    lane.to_px = point(line[1], key + ".line[1]");
    lane.direction = direction(need(json, key, "direction"), key + ".direction");
    across(lane, key);
    if (json.contains("zone")) {
        lane.zone_px = polygon(json["zone"], key + ".zone");
    }
    if (json.contains("mask")) {
        if (!json["mask"].is_array()) {
            refuse(key + ".mask", "must be a list of polygons");
        }
        for (std::size_t i = 0; i < json["mask"].size(); ++i) {
            lane.mask_px.push_back(polygon(json["mask"][i], key + ".mask[" + std::to_string(i) + "]"));
        }
    }
    if (json.contains("approach") != json.contains("movement")) {
        refuse(key, "has one of approach and movement; right would be both or none");
    }
    if (json.contains("approach")) {
        lane.approach = whole(json["approach"], key + ".approach", 0, 7);
        lane.movement = whole(json["movement"], key + ".movement", 0, 2);
    }
    return lane;
}

LaneFile LaneReader::read(const Json &json) {
    keys(json, "the file", {"format", "width", "height", "lanes", "junction", "reference", "model"});
    if (json.contains("format") && json["format"] != "elmopp-lanes/1") {
        refuse("format", "is " + json["format"].dump() + "; right would be \"elmopp-lanes/1\"");
    }
    LaneFile file;
    file.width_px = width_ = whole(need(json, "the file", "width"), "width", 16, most_pixels);
    file.height_px = height_ = whole(need(json, "the file", "height"), "height", 16, most_pixels);
    const Json &lanes = need(json, "the file", "lanes");
    if (!lanes.is_array() || lanes.empty()) {
        refuse("lanes", "must be a list of one lane or more");
    }
    std::set<std::string> names;
    for (std::size_t i = 0; i < lanes.size(); ++i) {
        file.lanes.push_back(lane(lanes[i], "lanes[" + std::to_string(i) + "]"));
        if (!names.insert(file.lanes.back().name).second) {
            refuse("lanes[" + std::to_string(i) + "].name", "\"" + file.lanes.back().name + "\" comes twice");
        }
    }
    if (json.contains("junction")) {
        file.junction_px = polygon(json["junction"], "junction");
    }
    if (json.contains("reference")) {
        file.reference = folder_ / text(json["reference"], "reference");
    }
    if (json.contains("model")) {
        file.model = folder_ / text(json["model"], "model");
    }
    return file;
}

double border_distance_px(const cv::Point2d &at, const LaneFile &file) {
    return std::min({at.x, at.y, file.width_px - 1 - at.x, file.height_px - 1 - at.y});
}

} // namespace

LaneFile parse_lane_file(const std::string &text, const std::string &name, const std::filesystem::path &folder) {
    try {
        return LaneReader(name, folder).read(Json::parse(text));
    } catch (const Json::exception &error) {
        throw BadRequest(name + ": " + said_by(error) + "; right would be a lane file in JSON (docs/camera.md)");
    }
}

LaneFile read_lane_file(const std::filesystem::path &file) {
    std::ifstream stream(file);
    std::stringstream text;
    if (!stream || !std::filesystem::is_regular_file(file)) {
        throw BadRequest(file.string() + ": cannot be read; right would be a lane file (docs/camera.md)");
    }
    text << stream.rdbuf();
    return parse_lane_file(text.str(), file.string(), file.parent_path());
}

std::vector<std::string> lane_file_warnings(const LaneFile &file) {
    constexpr double narrow_px = 12.0;
    std::vector<std::string> warnings;
    for (const Lane &lane : file.lanes) {
        const double width_px = cv::norm(lane.to_px - lane.from_px);
        if (width_px < narrow_px) {
            warnings.push_back("lane " + lane.name + ": its line is short, vehicles of a few pixels are missed");
        }
        const cv::Point2d middle = (lane.from_px + lane.to_px) / 2;
        if (border_distance_px(middle, file) < width_px / 3) {
            warnings.push_back("lane " + lane.name +
                               ": its line lies at the border of the picture, vehicles are seen on one side only");
        }
    }
    return warnings;
}

} // namespace elmopp
