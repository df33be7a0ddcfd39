// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Writes a drawn video, its truth and its first picture, for tests of the programs: draw_scene FOLDER NAME SECONDS.

#include "scene.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>

int main(int argc, char **argv) {
    if (argc != 4) {
        std::cerr << "draw_scene: right would be FOLDER NAME SECONDS\n";
        return 2;
    }
    const std::string base = std::string(argv[1]) + "/" + argv[2];
    const double seconds = std::atof(argv[3]);
    constexpr double rate = 25.0;
    constexpr int lanes = 3;
    elmopp::Scene scene({352, 264}, lanes, 1);
    const elmopp::SceneFlow flow = elmopp::SceneFlow::random(lanes, seconds, 1.4, 7);
    cv::VideoWriter video(base + ".avi", cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), rate, {352, 264});
    const int frames = static_cast<int>(seconds * rate);
    for (int i = 0; i < frames; ++i) {
        const cv::Mat picture = scene.draw(flow.at(i / rate));
        video.write(picture);
        if (i == 0 && !cv::imwrite(base + ".png", picture)) {
            std::cerr << "draw_scene: " << base << ".png could not be written\n";
            return 1;
        }
    }
    const elmopp::LaneFile file = scene.lanes(flow.line_m, 40, elmopp::Direction::down);
    std::ofstream truth(base + ".json");
    truth << "{\"format\": \"lane-count-truth/1\", \"video\": \"" << argv[2]
          << ".avi\", \"width\": 352, \"height\": 264, "
          << "\"frames\": " << frames << ", \"fps\": 25.0, \"count_from\": 0, \"count_to\": " << frames - 1
          << ", \"frame_tolerance\": 14, \"uncertain\": [], \"lanes\": [";
    for (int lane = 0; lane < lanes; ++lane) {
        const elmopp::Lane &one = file.lanes[static_cast<std::size_t>(lane)];
        truth << (lane == 0 ? "" : ", ") << "{\"name\": \"" << one.name << "\", \"direction\": \"down\", \"line\": [["
              << one.from_px.x << ", " << one.from_px.y << "], [" << one.to_px.x << ", " << one.to_px.y << "]]}";
    }
    truth << "], \"crossings\": [";
    int total = 0;
    for (const auto &car : flow.cars) {
        truth << (total++ == 0 ? "" : ", ") << "{\"frame\": " << std::lround((car.crosses_s + 0.25) * rate)
              << ", \"lane\": \"lane" << car.car.lane << "\"}";
    }
    truth << "], \"total\": " << total << ", \"totals\": {";
    for (int lane = 0; lane < lanes; ++lane) {
        truth << (lane == 0 ? "" : ", ") << "\"lane" << lane << "\": " << flow.crossed(lane, seconds);
    }
    truth << "}}\n";
    return truth ? 0 : 1;
}
