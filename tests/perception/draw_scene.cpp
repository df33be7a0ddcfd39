// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Writes a drawn video, its truth and its first picture, for tests of the programs: draw_scene FOLDER ROAD SECONDS
/// [SEED], the seed of the traffic.
/// Without arguments the names of the roads.

#include "roads.hpp"

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>

namespace {

using Json = nlohmann::ordered_json;
using elmopp::Direction;
using elmopp::Road;

const char *word_of(Direction direction) {
    switch (direction) {
    case Direction::up:
        return "up";
    case Direction::down:
        return "down";
    case Direction::left:
        return "left";
    case Direction::right:
        break;
    }
    return "right";
}

Json truth_of(const Road &road, const std::string &name, double seconds, cv::Size size) {
    // Who creeps over the line has no sharp moment in which his middle is there.
    const double tolerance_s = std::max(0.56, 4.0 / road.flow.speed_m_s);
    constexpr double look_s = 2.0;
    const auto frame_of = [&road](double t_s) { return std::lround(t_s * road.rate); };
    const elmopp::LaneFile file = road.lanes();
    Json truth{{"format", "lane-count-truth/1"},
               {"video", name + ".avi"},
               {"width", size.width},
               {"height", size.height},
               {"fps", road.rate},
               {"frames", frame_of(seconds)},
               {"count_from", 0},
               {"count_to", frame_of(seconds) - 1},
               {"uncertain", Json::array()},
               {"frame_tolerance", std::max(3L, frame_of(tolerance_s))}};
    std::vector<int> totals(file.lanes.size(), 0);
    truth["crossings"] = Json::array();
    for (const auto &car : road.flow.cars) {
        const double t_s = road.seen_crossing_s(car);
        if (t_s < seconds - 1) {
            const auto lane = static_cast<std::size_t>(car.car.lane);
            ++totals[lane];
            truth["crossings"].push_back({{"frame", frame_of(t_s)}, {"lane", file.lanes[lane].name}});
        }
    }
    std::stable_sort(truth["crossings"].begin(), truth["crossings"].end(),
                     [](const Json &one, const Json &other) { return one["frame"] < other["frame"]; });
    truth["lanes"] = Json::array();
    truth["totals"] = Json::object();
    truth["total"] = truth["crossings"].size();
    for (std::size_t i = 0; i < file.lanes.size(); ++i) {
        const elmopp::Lane &lane = file.lanes[i];
        Json one{{"name", lane.name},
                 {"direction", word_of(lane.direction)},
                 {"line", {{lane.from_px.x, lane.from_px.y}, {lane.to_px.x, lane.to_px.y}}}};
        for (const cv::Point2d &corner : lane.zone_px) {
            one["zone"].push_back({corner.x, corner.y});
        }
        truth["lanes"].push_back(one);
        truth["totals"][lane.name] = totals[i];
    }
    for (double t_s = 5; road.zone_m > 0 && t_s < seconds; t_s += look_s) {
        Json row{{"frame", frame_of(t_s)}};
        for (std::size_t i = 0; i < file.lanes.size(); ++i) {
            row[file.lanes[i].name] = road.present(static_cast<int>(i), t_s);
        }
        truth["present"].push_back(row);
    }
    return truth;
}

} // namespace

int main(int argc, char **argv) {
    if (argc == 1) {
        for (const std::string &name : elmopp::road_names()) {
            std::cout << name << "\n";
        }
        return 0;
    }
    const double seconds = argc == 4 || argc == 5 ? std::atof(argv[3]) : 0.0;
    const int seed = argc == 5 ? std::atoi(argv[4]) : static_cast<int>(elmopp::usual_seed);
    if (seconds <= 0 || seed <= 0) {
        std::cerr << "draw_scene: right would be FOLDER ROAD SECONDS [SEED]\n";
        return 2;
    }
    const std::string name = argv[2];
    const std::string base = std::string(argv[1]) + "/" + name;
    try {
        Road road = elmopp::road_named(name, seconds, static_cast<unsigned>(seed));
        const cv::Size size = road.picture(0).size();
        cv::VideoWriter video(base + ".avi", cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), road.rate, size);
        constexpr double good = 95;
        video.set(cv::VIDEOWRITER_PROP_QUALITY, good);
        for (int i = 0; i < static_cast<int>(seconds * road.rate); ++i) {
            const cv::Mat picture = road.picture(i / road.rate);
            video.write(picture);
            if (i == 0 && !cv::imwrite(base + ".png", picture)) {
                std::cerr << "draw_scene: " << base << ".png could not be written\n";
                return 1;
            }
        }
        std::ofstream truth(base + ".json");
        truth << truth_of(road, name, seconds, size).dump(1) << "\n";
        return truth ? 0 : 1;
    } catch (const std::out_of_range &) {
        std::cerr << "draw_scene: there is no road " << name << "\n";
        return 2;
    }
}
