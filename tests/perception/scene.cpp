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
constexpr double nearest_m = 5.0; ///< the road of a camera above it begins there
constexpr double clip_m = 1.5;    ///< nothing nearer than this is drawn
constexpr double farthest_m = 150.0;

/// Blurs what is drawn on a black layer, and no more of it; returns where the layer is not black any longer.
cv::Rect blur_drawn(cv::Mat &layer, double sigma_px) {
    cv::Mat one;
    cv::transform(layer, one, cv::Matx13f(1, 1, 1));
    const cv::Rect drawn = cv::boundingRect(one);
    const int reach = static_cast<int>(std::ceil(3 * sigma_px)) + 2; // of the kernel
    const cv::Rect around =
        cv::Rect(drawn.x - reach, drawn.y - reach, drawn.width + 2 * reach, drawn.height + 2 * reach) &
        cv::Rect(cv::Point(0, 0), layer.size());
    if (drawn.empty()) {
        return {};
    }
    cv::Mat part = layer(around);
    cv::GaussianBlur(part.clone(), part, cv::Size(), sigma_px);
    return around;
}

} // namespace

void add_grain(cv::Mat &picture, cv::RNG &random, double grey_values) {
    cv::Mat grain(picture.size(), CV_16SC3);
    random.fill(grain, cv::RNG::NORMAL, 0, grey_values);
    cv::Mat wide;
    picture.convertTo(wide, CV_16S);
    wide += grain;
    wide.convertTo(picture, CV_8U);
}

Scene::Scene(cv::Size picture, int lanes, unsigned seed) : size_(picture), lanes_(lanes), random_(seed) {}

double Scene::middle_m(int lane) const {
    return (lane + 0.5 - lanes_ / 2.0) * lane_m;
}

/// Aside of the camera, away from it, as it looks.
cv::Point2d Scene::turned(double aside, double away) const {
    const double angle = yaw_deg * CV_PI / 180;
    const double right = aside - aside_m;
    return {right * std::cos(angle) - away * std::sin(angle), right * std::sin(angle) + away * std::cos(angle)};
}

cv::Point2d Scene::place(double aside, double away, double up) const {
    const double focal_px = focal_widths * size_.width;
    const cv::Point2d seen = turned(aside, away);
    const double depth = std::max(seen.y, clip_m);
    return {size_.width / 2.0 + focal_px * seen.x / depth,
            horizon_share * size_.height + focal_px * (camera_m - up) / depth};
}

cv::Rect2d Scene::box_of(const SceneCar &car) const {
    const double aside = middle_m(car.lane) + car.aside_m;
    std::vector<cv::Point2f> corners;
    for (const double side : {-car.width_m / 2, car.width_m / 2}) {
        for (const double along : {0.0, car.length_m}) {
            corners.emplace_back(place(aside + side, car.at_m + along, 0));
            corners.emplace_back(place(aside + side, car.at_m + along, car.height_m));
        }
    }
    return cv::Rect2d(cv::boundingRect(corners));
}

/// A flat piece of the world, cut off where it comes too near to the camera.
void Scene::fill(cv::Mat &picture, const std::vector<Spot> &corners, const cv::Scalar &colour) const {
    constexpr int shift = 4;
    std::vector<cv::Point> fine;
    const auto add = [&](const Spot &spot) {
        const cv::Point2d at = place(spot.aside_m, spot.away_m, spot.up_m);
        fine.emplace_back(cvRound(at.x * (1 << shift)), cvRound(at.y * (1 << shift)));
    };
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Spot &a = corners[i];
        const Spot &b = corners[(i + 1) % corners.size()];
        const double depth_a = turned(a.aside_m, a.away_m).y - clip_m;
        const double depth_b = turned(b.aside_m, b.away_m).y - clip_m;
        if (depth_a >= 0) {
            add(a);
        }
        if ((depth_a >= 0) != (depth_b >= 0)) {
            const double share = depth_a / (depth_a - depth_b);
            add({a.aside_m + share * (b.aside_m - a.aside_m), a.away_m + share * (b.away_m - a.away_m),
                 a.up_m + share * (b.up_m - a.up_m)});
        }
    }
    if (fine.size() > 2) {
        cv::fillConvexPoly(picture, fine, colour, cv::LINE_AA, shift);
    }
}

void Scene::draw_road() {
    road_ = cv::Mat(size_, CV_8UC3, cv::Scalar(95, 120, 105));
    for (int i = 0; i < 500; ++i) { // what grows and stands beside the road
        const cv::Point at(random_.uniform(0, size_.width), random_.uniform(0, size_.height));
        const cv::Scalar colour(random_.uniform(40, 140), random_.uniform(60, 190), random_.uniform(40, 150));
        cv::rectangle(road_, {at, cv::Size(random_.uniform(3, 14), random_.uniform(3, 14))}, colour, cv::FILLED);
    }
    const double side_m = lanes_ * lane_m / 2 + 0.6;
    const double begin_m = yaw_deg > 0 ? -farthest_m : nearest_m;
    constexpr double piece_m = 6; // markings and gaps
    fill(road_,
         {{-side_m, 2 * farthest_m, 0}, {side_m, 2 * farthest_m, 0}, {side_m, begin_m, 0}, {-side_m, begin_m, 0}},
         cv::Scalar(112, 110, 108));
    for (int edge = 0; edge <= lanes_; ++edge) {
        const double aside = (edge - lanes_ / 2.0) * lane_m;
        for (double away = begin_m; away < 120; away += piece_m) {
            fill(road_,
                 {{aside - 0.07, away + 3, 0},
                  {aside + 0.07, away + 3, 0},
                  {aside + 0.07, away, 0},
                  {aside - 0.07, away, 0}},
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

/// A box, its far sides first; windows, bumper and plate on the end that is seen.
void Scene::draw_car(cv::Mat &picture, const SceneCar &car) const {
    const double aside = middle_m(car.lane) + car.aside_m;
    const double left = aside - car.width_m / 2;
    const double right = aside + car.width_m / 2;
    const double near = car.at_m;
    const double far = car.at_m + car.length_m;
    const double top = car.height_m;
    const double shrink = car.width_m / 1.8;
    const auto across = [&](double from_m, double to_m, double low, double high) {
        const double away = near > 0 ? near : far;
        return std::vector<Spot>{{from_m, away, low}, {to_m, away, low}, {to_m, away, high}, {from_m, away, high}};
    };
    const auto along = [&](double at, double from_m, double to_m, double low, double high) {
        return std::vector<Spot>{{at, from_m, low}, {at, to_m, low}, {at, to_m, high}, {at, from_m, high}};
    };
    const auto glass = [&car](const cv::Scalar &colour) { return colour * car.glass + car.paint * (1 - car.glass); };
    if (shadows) {
        fill(picture,
             {{right, near, 0}, {right + shadow_m, near + 0.4, 0}, {right + shadow_m, far + 0.4, 0}, {right, far, 0}},
             cv::Scalar(52, 50, 48));
    }
    const bool from_left = aside_m < left;
    if (from_left || aside_m > right) {
        const double seen = from_left ? left : right;
        fill(picture, along(seen, near, far, 0, top), car.paint * 0.7);
        fill(picture, along(seen, near + 0.25 * car.length_m, far - 0.2 * car.length_m, 0.6 * top, 0.93 * top),
             glass(cv::Scalar(40, 35, 30)));
        fill(picture, along(seen, near, far, 0, 0.25), cv::Scalar(30, 30, 30));
    }
    fill(picture, {{left, near, top}, {right, near, top}, {right, far, top}, {left, far, top}}, car.paint * 1.15);
    if (car.length_m < 7) {
        fill(picture,
             {{left + 0.2 * shrink, near + 1.0, top},
              {right - 0.2 * shrink, near + 1.0, top},
              {right - 0.2 * shrink, near + 1.8, top},
              {left + 0.2 * shrink, near + 1.8, top}},
             glass(cv::Scalar(45, 40, 35)));
    }
    fill(picture, across(left, right, 0, top), car.paint);
    fill(picture, across(left, right, 0, 0.3), cv::Scalar(25, 25, 25));
    fill(picture, across(left + 0.15 * shrink, right - 0.15 * shrink, 0.6 * top, 0.95 * top),
         glass(cv::Scalar(50, 45, 40)));
    fill(picture, across(left + 0.5 * shrink, right - 0.5 * shrink, 0.35, 0.55), cv::Scalar(210, 210, 210));
}

void Scene::draw_light(cv::Mat &picture, const SceneCar &car) const {
    const double aside = middle_m(car.lane) + car.aside_m;
    cv::Mat cone = cv::Mat::zeros(size_, CV_8UC3);
    const double front = car.away ? car.at_m + car.length_m : car.at_m;
    const double reach = car.away ? 9.0 : -9.0;
    fill(cone,
         {{aside - 0.8, front, 0},
          {aside + 0.8, front, 0},
          {aside + 1.6, front + reach, 0},
          {aside - 1.6, front + reach, 0}},
         cv::Scalar(60, 75, 80));
    const cv::Rect reached = blur_drawn(cone, 0.02 * size_.width);
    // The road sends back more of the same: its markings stay as bright beside it as they were.
    constexpr double lamp_of = 1.0 / 24;
    if (!reached.empty()) {
        cv::Mat lit;
        cv::multiply(picture(reached), cone(reached), lit, lamp_of, CV_8U);
        picture(reached) += lit;
    }
    const double depth = turned(aside, car.at_m).y;
    cv::Mat lamps = cv::Mat::zeros(size_, CV_8UC3);
    for (const double side : {-0.36, 0.36}) {
        if (depth > clip_m) {
            const cv::Point2d lamp = place(aside + side * car.width_m, car.at_m, 0.65);
            const double radius = std::max(1.5, (car.away ? 0.1 : 0.16) * focal_widths * size_.width / depth);
            const cv::Scalar colour = car.away ? cv::Scalar(60, 60, 250) : cv::Scalar(235, 250, 255);
            cv::circle(picture, lamp, cvRound(radius), colour, cv::FILLED, cv::LINE_AA);
            cv::circle(lamps, lamp, cvRound(2 * radius), colour * 0.7, cv::FILLED, cv::LINE_AA);
        }
    }
    if (glare) {
        const cv::Rect bloom = blur_drawn(lamps, 0.012 * size_.width);
        if (!bloom.empty()) {
            picture(bloom) += lamps(bloom);
        }
    }
}

cv::Mat Scene::draw(std::vector<SceneCar> cars) {
    if (road_.empty()) {
        draw_road();
    }
    cv::Mat picture = road_.clone();
    const auto depth = [this](const SceneCar &car) {
        return turned(middle_m(car.lane) + car.aside_m, car.at_m + car.length_m / 2).y;
    };
    const auto gone = [&](const SceneCar &car) {
        return (yaw_deg > 0 ? depth(car) : car.at_m + car.length_m) < nearest_m || depth(car) > farthest_m;
    };
    cars.erase(std::remove_if(cars.begin(), cars.end(), gone), cars.end());
    std::sort(cars.begin(), cars.end(), [&](const SceneCar &a, const SceneCar &b) { return depth(a) > depth(b); });
    for (const SceneCar &car : cars) {
        draw_car(picture, car);
    }
    if (fog > 0) {
        picture = picture * (1 - fog) + cv::Scalar::all(150 * fog);
    }
    picture.convertTo(picture, CV_8U, night ? night_light * light : light);
    if (night) {
        for (const SceneCar &car : cars) {
            draw_light(picture, car);
        }
    }
    if (noise > 0) {
        add_grain(picture, random_, noise);
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
        const double way_m = speed_m_s * one.crosses_s - driven_m(t_s);
        car.at_m = line_m + (car.away ? -way_m : way_m);
        here.push_back(car);
    }
    return here;
}

int SceneFlow::crossed(int lane, double t_s) const {
    return static_cast<int>(std::count_if(cars.begin(), cars.end(), [this, lane, t_s](const Car &one) {
        return one.car.lane == lane && speed_m_s * one.crosses_s <= driven_m(t_s);
    }));
}

double SceneFlow::driven_m(double t_s) const {
    return speed_m_s * (t_s - std::clamp(t_s - stops_s, 0.0, goes_s - stops_s));
}

} // namespace elmopp
