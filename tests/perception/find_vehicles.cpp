// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Prints what a detector finds in a picture, for its test: find_vehicles MODEL PICTURE gives a line "x y width height"
/// a box.

#include "detector.hpp"
#include "error.hpp"

#include <opencv2/imgcodecs.hpp>

#include <iostream>

int main(int argc, char **argv) {
    if (argc != 3) {
        std::cerr << "find_vehicles: right would be MODEL PICTURE\n";
        return 2;
    }
    try {
        elmopp::Detector detector(argv[1]);
        for (const cv::Rect2d &box : detector.find(cv::imread(argv[2]))) {
            std::cout << box.x << " " << box.y << " " << box.width << " " << box.height << "\n";
        }
        return 0;
    } catch (const elmopp::BadRequest &error) {
        std::cerr << error.what() << "\n";
        return 2;
    }
}
