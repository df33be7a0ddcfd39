// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "roads.hpp"

#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <functional>
#include <map>

namespace elmopp {
namespace {

constexpr int small_width = 352;
constexpr int small_height = 264;

/// Who drives there.
struct Traffic {
    double gap_s = 1.6; ///< from bumper to bumper at least; twice that on average
    double speed_m_s = 9.0;
    double long_share = 0.0; ///< lorries and buses
    double bike_share = 0.0; ///< motorcycles
    double contrast = 105;   ///< paint differs from the road by at most so many grey values
    double glass = 1.0;
};

struct Film {
    double seconds;
    unsigned seed; ///< of the traffic
};

SceneCar some_vehicle(const Traffic &traffic, cv::RNG &random) {
    constexpr double road_grey = 110;
    SceneCar car;
    for (int channel = 0; channel < 3; ++channel) {
        car.paint[channel] = road_grey + random.uniform(-traffic.contrast, traffic.contrast);
    }
    car.glass = traffic.glass;
    car.aside_m = random.uniform(-0.25, 0.25);
    car.length_m = random.uniform(3.9, 4.9);
    car.height_m = random.uniform(1.4, 1.7);
    const double kind = random.uniform(0.0, 1.0);
    if (kind < traffic.long_share) {
        car.length_m = random.uniform(8.0, 14.0);
        car.height_m = random.uniform(3.0, 3.8);
        car.width_m = 2.5;
        car.aside_m /= 2;
    } else if (kind < traffic.long_share + traffic.bike_share) {
        car.length_m = 2.1;
        car.height_m = 1.6;
        car.width_m = 0.75;
        car.aside_m *= 3;
    }
    return car;
}

void fill_lanes(Road &road, const Traffic &traffic, const Film &film) {
    cv::RNG random(film.seed);
    road.flow.speed_m_s = traffic.speed_m_s;
    for (int lane = 0; lane < static_cast<int>(road.directions.size()); ++lane) {
        double t_s = 4.5 + random.uniform(0.0, 1.0);
        while (t_s < film.seconds - 3) {
            SceneFlow::Car one{some_vehicle(traffic, random), t_s};
            one.car.lane = lane;
            one.car.away = road.directions[static_cast<std::size_t>(lane)] == Direction::up ||
                           road.directions[static_cast<std::size_t>(lane)] == Direction::left;
            road.flow.cars.push_back(one);
            t_s += one.car.length_m / traffic.speed_m_s + traffic.gap_s / 2 + random.uniform(0.0, 2 * traffic.gap_s);
        }
    }
}

Road a_road(cv::Size picture, int lanes, Direction direction = Direction::down) {
    Road road{Scene(picture, lanes, 1), {}, {}, 0.0, 25.0, 0};
    road.directions.assign(static_cast<std::size_t>(lanes), direction);
    return road;
}

Road usual() {
    return a_road({small_width, small_height}, 3);
}

using Maker = std::function<Road(const Film &)>;

Road with(Road road, const Traffic &traffic, const Film &film) {
    fill_lanes(road, traffic, film);
    return road;
}

Road across(double yaw_deg, double away_m) {
    Road road = a_road({640, 360}, 2, Direction::left);
    road.scene.yaw_deg = yaw_deg;
    road.scene.aside_m = -away_m;
    road.scene.camera_m = 6;
    road.scene.focal_widths = 0.9;
    road.scene.horizon_share = 0.1;
    road.flow.line_m = away_m * std::tan((90 - yaw_deg) * CV_PI / 180);
    return road;
}

Road at_night(double light, bool away) {
    Road road = away ? a_road({small_width, small_height}, 3, Direction::up) : usual();
    road.scene.night = true;
    road.scene.night_light = light;
    road.scene.glare = true;
    road.scene.noise = 4;
    return road;
}

Road red_light(Road road, const Traffic &traffic, const Film &film) {
    road.zone_m = 45;
    road.flow.stops_s = 0.25 * film.seconds;
    road.flow.goes_s = 0.75 * film.seconds;
    return with(std::move(road), traffic, film);
}

const std::map<std::string, Maker> &makers() {
    static const std::map<std::string, Maker> all{
        {"plain", [](const Film &s) { return with(usual(), {}, s); }},
        {"up", [](const Film &s) { return with(a_road({small_width, small_height}, 3, Direction::up), {}, s); }},
        {"two_ways",
         [](const Film &s) {
             Road road = a_road({small_width, small_height}, 4);
             road.flow.line_m = 20; // four lanes are wider than the picture nearer by
             road.directions[2] = road.directions[3] = Direction::up;
             return with(road, {}, s);
         }},
        {"tiny", [](const Film &s) { return with(a_road({160, 120}, 3), {}, s); }},
        {"large",
         [](const Film &s) {
             Road road = a_road({1280, 720}, 2);
             road.flow.line_m = 20; // nearer ones are below the picture
             return with(road, {}, s);
         }},
        {"high",
         [](const Film &s) {
             Road road = usual();
             road.scene.camera_m = 14;
             road.scene.horizon_share = -0.35;
             road.flow.line_m = 20;
             return with(road, {}, s);
         }},
        {"low",
         [](const Film &s) {
             Road road = usual();
             road.scene.camera_m = 4.2;
             road.scene.horizon_share = 0.25;
             return with(road, {}, s);
         }},
        {"tele",
         [](const Film &s) {
             Road road = usual();
             road.scene.focal_widths = 3;
             road.flow.line_m = 60;
             road.scene.camera_m = 9;
             return with(road, {}, s);
         }},
        {"wide",
         [](const Film &s) {
             Road road = a_road({640, 360}, 3);
             road.scene.focal_widths = 0.6;
             road.flow.line_m = 11;
             return with(road, {}, s);
         }},
        {"beside",
         [](const Film &s) {
             Road road = usual();
             road.scene.aside_m = -9;
             road.scene.yaw_deg = 25;
             road.flow.line_m = 16;
             return with(road, {}, s);
         }},
        {"across", [](const Film &s) { return with(across(80, 16), {}, s); }},
        {"diagonal", [](const Film &s) { return with(across(50, 13), {}, s); }},
        {"five_hz",
         [](const Film &s) {
             Road road = usual();
             road.rate = 5;
             return with(road, {}, s);
         }},
        {"ten_hz",
         [](const Film &s) {
             Road road = usual();
             road.rate = 10;
             return with(road, {}, s);
         }},
        {"sixty_hz",
         [](const Film &s) {
             Road road = usual();
             road.rate = 60;
             return with(road, {}, s);
         }},
        {"grey",
         [](const Film &s) {
             Traffic traffic;
             traffic.contrast = 12;
             traffic.glass = 0.35;
             return with(usual(), traffic, s);
         }},
        {"fog",
         [](const Film &s) {
             Road road = usual();
             road.scene.fog = 0.65;
             return with(road, {}, s);
         }},
        {"compressed",
         [](const Film &s) {
             Road road = usual();
             road.quality = 12;
             return with(road, {}, s);
         }},
        {"blocks", // white, on a road in the dark, far apart: for a detector that knows nothing but light
         [](const Film &s) {
             Road road = a_road({small_width, small_width}, 1);
             road.scene.light = 0.35;
             Traffic traffic;
             traffic.gap_s = 2.5;
             road = with(road, traffic, s);
             for (auto &car : road.flow.cars) {
                 car.car.paint = cv::Scalar::all(700);
                 car.car.glass = 0;
             }
             return road;
         }},
        {"lorries",
         [](const Film &s) {
             Traffic traffic;
             traffic.long_share = 0.35;
             return with(usual(), traffic, s);
         }},
        {"motorcycles",
         [](const Film &s) {
             Traffic traffic;
             traffic.bike_share = 0.4;
             return with(usual(), traffic, s);
         }},
        {"dense",
         [](const Film &s) {
             Traffic traffic;
             traffic.gap_s = 0.7;
             traffic.speed_m_s = 11;
             return with(usual(), traffic, s);
         }},
        {"fast",
         [](const Film &s) {
             Traffic traffic;
             traffic.speed_m_s = 28;
             return with(usual(), traffic, s);
         }},
        {"slow",
         [](const Film &s) {
             Traffic traffic;
             traffic.speed_m_s = 2.5;
             traffic.gap_s = 4;
             return with(usual(), traffic, s);
         }},
        {"shadows",
         [](const Film &s) {
             Road road = usual();
             road.scene.shadows = true;
             road.scene.shadow_m = 2.6;
             return with(road, {}, s);
         }},
        {"dusk", [](const Film &s) { return with(at_night(0.22, false), {}, s); }},
        {"night", [](const Film &s) { return with(at_night(0.11, false), {}, s); }},
        {"night_away", [](const Film &s) { return with(at_night(0.11, true), {}, s); }},
        {"red", [](const Film &s) { return red_light(usual(), {}, s); }},
        {"red_lorries",
         [](const Film &s) {
             Traffic traffic;
             traffic.long_share = 0.25;
             return red_light(usual(), traffic, s);
         }},
        {"red_away",
         [](const Film &s) { return red_light(a_road({small_width, small_height}, 3, Direction::up), {}, s); }},
        {"red_night", [](const Film &s) { return red_light(at_night(0.12, false), {}, s); }},
    };
    return all;
}

} // namespace

LaneFile Road::lanes() const {
    LaneFile file = scene.lanes(flow.line_m, zone_m, Direction::down);
    for (std::size_t i = 0; i < file.lanes.size(); ++i) {
        file.lanes[i].direction = directions[i];
    }
    return file;
}

cv::Mat Road::picture(double t_s) {
    cv::Mat bgr = scene.draw(flow.at(t_s));
    if (quality > 0) {
        std::vector<uchar> bytes;
        cv::imencode(".jpg", bgr, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
        bgr = cv::imdecode(bytes, cv::IMREAD_COLOR);
    }
    return bgr;
}

double Road::seen_crossing_s(const SceneFlow::Car &car) const {
    // The far end of the roof hides road behind the vehicle.
    const double far_m = flow.line_m + car.car.length_m;
    const double hides = scene.yaw_deg > 45 ? 1.0 : scene.camera_m / (scene.camera_m - std::min(car.car.height_m, 3.0));
    const double middle_m = (far_m * hides - flow.line_m) / 2;
    const double toward = car.car.away ? -middle_m : middle_m;
    // The time at which everybody has driven so far.
    const double wanted_m = flow.speed_m_s * car.crosses_s + toward;
    double low = car.crosses_s - 200;
    double high = car.crosses_s + 200;
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (flow.driven_m(middle) < wanted_m ? low : high) = middle;
    }
    return high;
}

int Road::present(int lane, double t_s) const {
    const auto cars = flow.at(t_s);
    return static_cast<int>(std::count_if(cars.begin(), cars.end(), [&](const SceneCar &car) {
        const double middle = car.at_m + car.length_m / 2;
        return car.lane == lane && middle > flow.line_m && middle < zone_m;
    }));
}

std::vector<std::string> road_names() {
    std::vector<std::string> names;
    for (const auto &[name, maker] : makers()) {
        names.push_back(name);
    }
    return names;
}

Road road_named(const std::string &name, double seconds, unsigned seed) {
    return makers().at(name)({seconds, seed});
}

} // namespace elmopp
