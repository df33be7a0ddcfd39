// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// A road as a fixed camera sees it, drawn for tests: lanes towards the camera, vehicles as boxes in perspective, sun,
/// night, noise. Everything follows from the seed, so that what is true is known without counting by eye.

#pragma once

#include "lanes.hpp"

#include <opencv2/core.hpp>

#include <vector>

namespace elmopp {

struct SceneCar {
    int lane = 0;
    double at_m = 0.0; ///< along the road, of the end nearer to the camera
    double length_m = 4.5;
    double height_m = 1.5;
    cv::Scalar paint = cv::Scalar(60, 60, 160);
    double aside_m = 0.0; ///< from the middle of its lane
    double width_m = 1.8;
    double glass = 1.0; ///< how dark its windows are, 0 to 1
    bool away = false;  ///< it drives away from the camera: its lamps are red
};

/// Noise of a sensor, of so many grey values, on a colour picture.
void add_grain(cv::Mat &picture, cv::RNG &random, double grey_values);

class Scene {
  public:
    Scene(cv::Size picture, int lanes, unsigned seed);

    double horizon_share = 0.08; ///< of the picture's height
    double camera_m = 7.0;       ///< above the road
    double light = 1.0;          ///< of the whole picture
    double focal_widths = 1.15;  ///< focal length, in widths of the picture
    double yaw_deg = 0.0;        ///< of the camera, to the right of the road: at 90 the road runs across the picture
    double aside_m = 0.0;        ///< of the camera, to the right of the road's middle
    double fog = 0.0;            ///< share of the picture that is grey
    double night_light = 0.22;   ///< what a night leaves of the day
    bool glare = false;          ///< lamps bloom in the lens
    double shadow_m = 1.6;       ///< how wide a shadow is
    double noise = 2.0;          ///< grey values
    bool night = false;          ///< headlights and their cones
    bool shadows = false;        ///< hard ones, to the right

    /// The picture with these cars, whatever their order.
    cv::Mat draw(std::vector<SceneCar> cars);

    /// The lanes, with lines at `line_m` and, if `zone_m` is not 0, zones from there to `zone_m` away.
    [[nodiscard]] LaneFile lanes(double line_m, double zone_m, Direction direction) const;

    /// Where a point of the road is in the picture.
    [[nodiscard]] cv::Point2d place(double aside_m, double away_m, double up_m) const;

    /// The box about a car in the picture.
    [[nodiscard]] cv::Rect2d box_of(const SceneCar &car) const;

  private:
    struct Spot {
        double aside_m;
        double away_m;
        double up_m;
    };
    void fill(cv::Mat &picture, const std::vector<Spot> &corners, const cv::Scalar &colour) const;
    void draw_road();
    void draw_car(cv::Mat &picture, const SceneCar &car) const;
    void draw_light(cv::Mat &picture, const SceneCar &car) const;
    [[nodiscard]] double middle_m(int lane) const;
    [[nodiscard]] cv::Point2d turned(double aside_m, double away_m) const;

    cv::Size size_;
    int lanes_;
    cv::RNG random_;
    cv::Mat road_;
};

/// Cars that follow one another at a steady speed: where they are at a time, and when they cross.
struct SceneFlow {
    struct Car {
        SceneCar car;
        double crosses_s; ///< its near end reaches line_m, if nobody ever stood
    };
    double line_m = 14.0;
    double speed_m_s = 9.0;
    double stops_s = 0.0; ///< if not 0: all stand from here ...
    double goes_s = 0.0;  ///< ... to here
    std::vector<Car> cars;

    /// `seconds` of traffic, at least `gap_s` between two cars of a lane.
    static SceneFlow random(int lanes, double seconds, double gap_s, unsigned seed);

    [[nodiscard]] std::vector<SceneCar> at(double t_s) const;
    [[nodiscard]] int crossed(int lane, double t_s) const;

    /// How far everybody has driven at a time.
    [[nodiscard]] double driven_m(double t_s) const;
};

} // namespace elmopp
