// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Road view: one approach of a junction as a fixed camera on a mast sees it, drawn picture by picture.
///
/// An ordinary pinhole camera over a flat road: lanes side by side with their markings, a stop line, the junction
/// behind it, kerbs, grass, trees and houses beside it. Vehicles are boxes with a cabin, windows, wheels and lamps;
/// they hide one another and throw shadows. Weather is light, noise, sun, lamps, rain. It is plain, and it is not made
/// to be easy: paint may have the grey of the road.
///
/// It knows bodies on a road and nothing of who moves them, and it shares no code with the counter that looks at its
/// pictures. The same seed and the same calls draw the same pictures. Owner: whoever films. Not thread-safe.
///
/// Coordinates of the road: `ahead_m` along the lanes from the point below the camera, in the direction in which
/// vehicles drive; `aside_m` to the right of the left edge of the leftmost lane; `up_m` above the road.

#pragma once

#include <opencv2/core.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace elmopp {

/// A vehicle on the road.
struct RoadBody {
    double ahead_m; ///< of the middle of its front
    double aside_m;
    double yaw_rad; ///< 0: along the lanes; positive: to the right
    double length_m;
    double width_m;
    double height_m;
    cv::Scalar paint; ///< BGR, by day
    bool boxy;        ///< a van or lorry: no bonnet
    bool braking;
};

/// What a lamp at the stop line shows.
enum class RoadLamp { dark, red, red_amber, green, amber };

struct RoadShape {
    int lanes;
    double stop_m;   ///< ahead_m of the stop line
    double begin_m;  ///< ... of the first marking; may be negative
    double across_m; ///< width of the junction behind the stop line
};

struct RoadMast {
    double height_m;
    double aside_m;
    double look_ahead_m; ///< where the middle of the picture is on the road
    double look_aside_m;
};

/// Names: day, shadows, dusk, headlights, noise, rain. See RoadWeather::of().
struct RoadWeather {
    double light = 1.0; ///< of the whole picture
    double noise = 2.0; ///< standard deviation, grey values
    bool sun = false;   ///< hard shadows
    bool lamps = false; ///< of vehicles: head, tail, the light on the road
    bool rain = false;
    double dusk_s = 0.0; ///< light falls from day to `light` in so many seconds; 0: it is as it is

    /// Throws std::out_of_range for a name that there is not.
    static RoadWeather of(const std::string &name);
    static std::vector<std::string> names();
};

constexpr double road_lane_m = 3.4;

class RoadView {
  public:
    RoadView(cv::Size picture, const RoadShape &shape, const RoadMast &mast, const RoadWeather &weather,
             std::uint64_t seed);

    /// The picture at `t_s`; `lamps`: one a lane.
    cv::Mat draw(const std::vector<RoadBody> &bodies, const std::vector<RoadLamp> &lamps, double t_s);

    /// Where a point is in the picture.
    [[nodiscard]] cv::Point2d place(double ahead_m, double aside_m, double up_m) const;

    /// True if a point of the road is in front of the camera, near enough to be drawn.
    [[nodiscard]] bool is_before(double ahead_m, double aside_m, double up_m) const;

  private:
    using Corner = cv::Point3d; ///< ahead, aside, up

    void draw_land();
    void draw_road();
    void draw_houses();
    void make_grain();
    void fill(cv::Mat &picture, const std::vector<Corner> &corners, const cv::Scalar &colour) const;
    void draw_shadow(cv::Mat &mask, const RoadBody &body, double reach) const;
    void draw_body(cv::Mat &picture, const RoadBody &body) const;
    void draw_tail(cv::Mat &picture, const RoadBody &body) const;
    void draw_beam(cv::Mat &picture, const RoadBody &body, double strength) const;
    void draw_lamps(cv::Mat &picture, const std::vector<RoadLamp> &lamps) const;
    void add_grain(cv::Mat &picture);
    [[nodiscard]] Corner camera_frame(const Corner &point) const;

    cv::Size size_;
    RoadShape shape_;
    RoadMast mast_;
    RoadWeather weather_;
    cv::RNG random_;
    double focal_px_;
    Corner right_;
    Corner down_;
    Corner front_;
    cv::Mat road_;
    cv::Mat dark_;               ///< the same in the shade
    std::vector<cv::Mat> grain_; ///< pairs: what is added, what is taken
};

} // namespace elmopp
