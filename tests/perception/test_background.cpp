// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The road of one patch in a noisy picture: each pixel is judged by its own noise.

#include "background.hpp"
#include "patch.hpp"
#include "scene.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <unity.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace {

using elmopp::Background;
using elmopp::Lane;
using elmopp::Patch;

const cv::Size picture(200, 120);
constexpr double rate = 25.0;
constexpr int learnt = 75; // pictures
constexpr int looked_at = 150;
constexpr int passes = 5;           // pictures with a vehicle
constexpr double clear_noise = 1.0; // grey values
constexpr double much_noise = 10.0;

/// Two lanes of a light road, the outer half of the first one in the dark of a kerb.
struct Film {
    explicit Film(double deviation) : noise(deviation) {
        for (const double from_px : {40.0, 79.0}) {
            Lane lane;
            lane.from_px = {from_px, 60};
            lane.to_px = {from_px + 39, 60};
            lanes.push_back(lane);
        }
    }

    /// With a vehicle on the lane's line, or the empty road (-1).
    Background::Sample next(const Patch &patch, int lane) {
        cv::Mat road(picture, CV_8UC3, cv::Scalar::all(160));
        road.colRange(0, 59).setTo(cv::Scalar::all(70));
        if (lane >= 0) {
            const int left_px = 46 + 39 * lane;
            cv::rectangle(road, cv::Rect(left_px, 46, 28, 30), cv::Scalar(110, 120, 230), cv::FILLED);
            cv::rectangle(road, cv::Rect(left_px + 4, 54, 20, 8), cv::Scalar::all(25), cv::FILLED);
        }
        elmopp::add_grain(road, random, noise);
        return {patch.sample(road, {0, 0}), 0.0, cv::Mat(), 1.0};
    }

    double noise;
    std::vector<Lane> lanes;
    cv::RNG random{5};
};

struct Found {
    double of_road = 0.0;                       ///< share of the empty road that was an object, in the worst picture
    std::array<double, 2> of_vehicle{1.0, 1.0}; ///< share of a vehicle on each line that was one, in the worst picture
};

/// Looks at the empty road that was learnt, and at two vehicles on it, one after the other.
Found film(double noise) {
    Film film(noise);
    const Patch patch = Patch::across(film.lanes, picture);
    Background background(patch.valid());
    std::vector<Background::Sample> samples;
    samples.reserve(learnt);
    for (int i = 0; i < learnt; ++i) {
        samples.push_back(film.next(patch, -1));
    }
    background.learn(samples);
    Found found;
    const auto look = [&](int lane) {
        const Background::Seen seen = background.look(film.next(patch, lane));
        background.renew(seen, 1 / rate, cv::Mat(), 0.4);
        return seen.object;
    };
    const auto share_of = [](const cv::Mat &mask) {
        return cv::countNonZero(mask) / static_cast<double>(mask.total());
    };
    for (int i = 0; i < looked_at; ++i) {
        found.of_road = std::max(found.of_road, share_of(look(-1)));
    }
    for (std::size_t i = 0; i < found.of_vehicle.size(); ++i) {
        const int lane = static_cast<int>(i);
        const int middle = elmopp::patch_margin + lane * elmopp::patch_unit + elmopp::patch_unit / 2;
        for (int k = 0; k < passes; ++k) {
            const cv::Mat inside = look(lane)(cv::Range(16, 33), cv::Range(middle - 8, middle + 8));
            found.of_vehicle[i] = std::min(found.of_vehicle[i], share_of(inside));
        }
    }
    return found;
}

void noise_of_the_dark_makes_no_vehicle_of_the_road() {
    const Found found = film(much_noise);
    TEST_ASSERT_TRUE_MESSAGE(found.of_road < 0.005, std::to_string(found.of_road).c_str());
}

void vehicles_in_the_dark_and_in_the_light_are_seen_in_noise_as_without() {
    for (const double noise : {clear_noise, much_noise}) {
        const Found found = film(noise);
        TEST_ASSERT_TRUE_MESSAGE(found.of_vehicle[0] > 0.9, std::to_string(found.of_vehicle[0]).c_str());
        TEST_ASSERT_TRUE_MESSAGE(found.of_vehicle[1] > 0.9, std::to_string(found.of_vehicle[1]).c_str());
    }
}

} // namespace

void setUp() {}
void tearDown() {}

int main() {
    UNITY_BEGIN();
    RUN_TEST(noise_of_the_dark_makes_no_vehicle_of_the_road);
    RUN_TEST(vehicles_in_the_dark_and_in_the_light_are_seen_in_noise_as_without);
    return UNITY_END();
}
