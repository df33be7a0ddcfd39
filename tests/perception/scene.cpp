// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "scene.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace elmopp {
namespace {

constexpr double lane_m = 3.4;
constexpr double car_m = 1.8;
constexpr double nearest_m = 5.0;

using Corners = std::vector<cv::Point2d>;

void fill(cv::Mat &picture, const Corners &corners, const cv::Scalar &colour) {
    constexpr int shift = 4;
    std::vector<cv::Point> fine;
    for (const cv::Point2d &corner : corners) {
        fine.emplace_back(cvRound(corner.x * (1 << shift)), cvRound(corner.y * (1 << shift)));
    }
    cv::fillConvexPoly(picture, fine, colour, cv::LINE_AA, shift);
}

} // namespace

Scene::Scene(cv::Size picture, int lanes, unsigned seed) : size_(picture), lanes_(lanes), random_(seed) {}

double Scene::middle_m(int lane) const {
    return (lane + 0.5 - lanes_ / 2.0) * lane_m;
}

cv::Point2d Scene::place(double aside_m, double away_m, double up_m) const {
    const double focal_px = 1.15 * size_.width;
    const double away = std::max(away_m, nearest_m);
    return {size_.width / 2.0 + focal_px * aside_m / away,
            horizon_share * size_.height + focal_px * (camera_m - up_m) / away};
}

void Scene::draw_road() {
    road_ = cv::Mat(size_, CV_8UC3, cv::Scalar(95, 120, 105));
    for (int i = 0; i < 500; ++i) { // what grows and stands beside the road
        const cv::Point at(random_.uniform(0, size_.width), random_.uniform(0, size_.height));
        const cv::Scalar colour(random_.uniform(40, 140), random_.uniform(60, 190), random_.uniform(40, 150));
        cv::rectangle(road_, {at, cv::Size(random_.uniform(3, 14), random_.uniform(3, 14))}, colour, cv::FILLED);
    }
    const double side_m = lanes_ * lane_m / 2 + 0.6;
    fill(road_,
         {place(-side_m, 300, 0), place(side_m, 300, 0), place(side_m, nearest_m, 0), place(-side_m, nearest_m, 0)},
         cv::Scalar(112, 110, 108));
    for (int edge = 0; edge <= lanes_; ++edge) {
        const double aside = (edge - lanes_ / 2.0) * lane_m;
        for (double away = nearest_m; away < 120; away += 6) {
            fill(road_,
                 {place(aside - 0.07, away + 3, 0), place(aside + 0.07, away + 3, 0), place(aside + 0.07, away, 0),
                  place(aside - 0.07, away, 0)},
                 cv::Scalar(190, 190, 190));
        }
    }
    cv::Mat grain(size_, CV_16SC3);
    random_.fill(grain, cv::RNG::NORMAL, 0, 4);
    cv::GaussianBlur(grain, grain, cv::Size(3, 3), 0);
    cv::Mat wide;
    road_.convertTo(wide, CV_16S);
    wide += grain;
    wide.convertTo(road_, CV_8U);
}

void Scene::draw_car(cv::Mat &picture, const SceneCar &car) const {
    const double aside = middle_m(car.lane) + car.aside_m;
    const double left = aside - car_m / 2;
    const double right = aside + car_m / 2;
    const double near = car.at_m;
    const double far = car.at_m + car.length_m;
    const auto box = [&](double from_m, double to_m, double low, double high) {
        return Corners{place(from_m, near, low), place(to_m, near, low), place(to_m, near, high),
                       place(from_m, near, high)};
    };
    if (shadows) {
        fill(picture,
             {place(right, near, 0), place(right + 1.6, near + 0.4, 0), place(right + 1.6, far + 0.4, 0),
              place(right, far, 0)},
             cv::Scalar(52, 50, 48));
    }
    const double seen = aside > 0 ? left : right; // the side that the camera sees
    fill(picture,
         {place(seen, near, 0), place(seen, far, 0), place(seen, far, car.height_m), place(seen, near, car.height_m)},
         car.paint * 0.7);
    fill(picture,
         {place(left, near, car.height_m), place(right, near, car.height_m), place(right, far, car.height_m),
          place(left, far, car.height_m)},
         car.paint * 1.15);
    fill(picture,
         {place(left + 0.2, near + 1.0, car.height_m), place(right - 0.2, near + 1.0, car.height_m),
          place(right - 0.2, near + 1.8, car.height_m), place(left + 0.2, near + 1.8, car.height_m)},
         cv::Scalar(45, 40, 35));
    fill(picture, box(left, right, 0, car.height_m), car.paint);
    fill(picture, box(left, right, 0, 0.3), cv::Scalar(25, 25, 25));
    fill(picture, box(left + 0.15, right - 0.15, 0.6 * car.height_m, 0.95 * car.height_m), cv::Scalar(50, 45, 40));
    fill(picture, box(left + 0.5, right - 0.5, 0.35, 0.55), cv::Scalar(210, 210, 210));
}

void Scene::draw_light(cv::Mat &picture, const SceneCar &car) const {
    const double aside = middle_m(car.lane) + car.aside_m;
    cv::Mat cone = cv::Mat::zeros(size_, CV_8UC3);
    fill(cone,
         {place(aside - 0.8, car.at_m, 0), place(aside + 0.8, car.at_m, 0), place(aside + 1.6, car.at_m - 9, 0),
          place(aside - 1.6, car.at_m - 9, 0)},
         cv::Scalar(60, 75, 80));
    cv::GaussianBlur(cone, cone, cv::Size(), 0.02 * size_.width);
    // The road sends back more of the same: its markings stay as bright beside it as they were.
    constexpr double lamp_of = 1.0 / 24;
    cv::Mat lit;
    cv::multiply(picture, cone, lit, lamp_of, CV_8U);
    picture += lit;
    for (const double side : {-0.65, 0.65}) {
        const cv::Point2d lamp = place(aside + side, car.at_m, 0.65);
        const double radius = std::max(1.5, 0.16 * 1.15 * size_.width / car.at_m);
        cv::circle(picture, lamp, cvRound(radius), cv::Scalar(235, 250, 255), cv::FILLED, cv::LINE_AA);
    }
}

cv::Mat Scene::draw(std::vector<SceneCar> cars) {
    if (road_.empty()) {
        draw_road();
    }
    cv::Mat picture = road_.clone();
    const auto gone = [](const SceneCar &car) { return car.at_m < nearest_m || car.at_m > 150; };
    cars.erase(std::remove_if(cars.begin(), cars.end(), gone), cars.end());
    std::sort(cars.begin(), cars.end(), [](const SceneCar &a, const SceneCar &b) { return a.at_m > b.at_m; });
    for (const SceneCar &car : cars) {
        draw_car(picture, car);
    }
    constexpr double night_light = 0.22;
    picture.convertTo(picture, CV_8U, night ? night_light * light : light);
    if (night) {
        for (const SceneCar &car : cars) {
            draw_light(picture, car);
        }
    }
    if (noise > 0) {
        cv::Mat grain(size_, CV_16SC3);
        random_.fill(grain, cv::RNG::NORMAL, 0, noise);
        cv::Mat wide;
        picture.convertTo(wide, CV_16S);
        wide += grain;
        wide.convertTo(picture, CV_8U);
    }
    return picture;
}

LaneFile Scene::lanes(double line_m, double zone_m, Direction direction) const {
    LaneFile file;
    file.width_px = size_.width;
    file.height_px = size_.height;
    for (int i = 0; i < lanes_; ++i) {
        Lane lane;
        lane.name = "lane" + std::to_string(i);
        const double left = middle_m(i) - lane_m / 2;
        const double right = middle_m(i) + lane_m / 2;
        lane.from_px = place(left, line_m, 0);
        lane.to_px = place(right, line_m, 0);
        lane.direction = direction;
        if (zone_m > 0) {
            lane.zone_px = {place(left, zone_m, 0), place(right, zone_m, 0), place(right, line_m, 0),
                            place(left, line_m, 0)};
        }
        lane.approach = 0;
        lane.movement = std::min(i, 2);
        file.lanes.push_back(lane);
    }
    return file;
}

SceneFlow SceneFlow::random(int lanes, double seconds, double gap_s, unsigned seed) {
    SceneFlow flow;
    cv::RNG random(seed);
    for (int lane = 0; lane < lanes; ++lane) {
        for (double t_s = 4.5 + random.uniform(0.0, 1.0); t_s < seconds - 2;
             t_s += gap_s + random.uniform(0.0, 2 * gap_s)) {
            Car one;
            one.car.lane = lane;
            one.car.paint = cv::Scalar(random.uniform(20, 230), random.uniform(20, 230), random.uniform(20, 230));
            one.car.aside_m = random.uniform(-0.25, 0.25);
            one.crosses_s = t_s;
            flow.cars.push_back(one);
        }
    }
    return flow;
}

std::vector<SceneCar> SceneFlow::at(double t_s) const {
    std::vector<SceneCar> here;
    for (const Car &one : cars) {
        SceneCar car = one.car;
        car.at_m = line_m + speed_m_s * (one.crosses_s - t_s);
        here.push_back(car);
    }
    return here;
}

int SceneFlow::crossed(int lane, double t_s) const {
    return static_cast<int>(std::count_if(cars.begin(), cars.end(), [lane, t_s](const Car &one) {
        return one.car.lane == lane && one.crosses_s <= t_s;
    }));
}

} // namespace elmopp
