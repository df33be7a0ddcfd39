// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "film.hpp"

#include "turns.hpp"
#include "whole_file.hpp"

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace elmopp {
namespace {

const cv::Size picture_px(640, 360);
constexpr double behind_m = 24.0; ///< the mast, before the edge of the reach
constexpr double mast_m = 10.0;
constexpr double line_inside_m = 6.0; ///< of the reach
constexpr double junction_m = 22.0;
constexpr double turned_away = 1.5; ///< radians, in the side street: behind houses

RoadShape shape_of(const elmopp_junction_t &site, std::size_t lanes) {
    return {static_cast<int>(lanes), behind_m + static_cast<double>(site.reach_m), 0.0, junction_m};
}

/// Beside the road, with an arm that reaches over its right lanes.
RoadMast mast_of(std::size_t lanes) {
    const double wide_m = static_cast<double>(lanes) * road_lane_m;
    return {mast_m, 0.75 * wide_m + 1.0, 49.0, wide_m / 2};
}

/// What a vehicle looks like follows from its number alone.
struct Looks {
    double length_m;
    double width_m;
    double height_m;
    double wander_m; ///< from the middle of its lane
    cv::Scalar paint;
    bool boxy;
};

Looks looks_of(std::uint64_t id) {
    SplitMix64 draw(id);
    const double kind = draw.uniform();
    const double size = draw.uniform();
    const double grey = draw.uniform();
    const double tint = draw.uniform();
    Looks looks{3.7 + 1.3 * size, 1.72 + 0.14 * size, 1.42 + 0.2 * size, 0.5 * (draw.uniform() - 0.5), {}, false};
    constexpr double cars = 0.82;
    constexpr double vans = 0.94;
    if (kind >= cars) {
        looks = {5.0 + 0.9 * size, 1.95, 2.0 + 0.6 * size, looks.wander_m, {}, true};
    }
    if (kind >= vans) {
        looks = {6.2 + 0.5 * size, 2.3, 2.7 + 0.4 * size, looks.wander_m, {}, true};
    }
    if (tint < 0.15) { // the road's own grey
        const double road = 96 + 14 * grey;
        looks.paint = {road, road, road};
    } else if (tint < 0.62) { // black to white
        const double tone = 28 + 205 * grey;
        looks.paint = {tone, tone, tone};
    } else {
        looks.paint = {40 + 150 * draw.uniform(), 40 + 130 * draw.uniform(), 40 + 160 * draw.uniform()};
    }
    return looks;
}

RoadLamp lamp_of(const elmopp_junction_t &site, std::size_t movement, const elmopp_lamps_t &lamps) {
    const std::uint32_t groups = site.movement[movement].groups;
    const auto all = [groups](std::uint32_t mask) { return (groups & ~mask) == 0U; };
    const auto any = [groups](std::uint32_t mask) { return (groups & mask) != 0U; };
    if (all(lamps.green)) {
        return RoadLamp::green;
    }
    if (any(lamps.red)) {
        return any(lamps.amber) ? RoadLamp::red_amber : RoadLamp::red;
    }
    return any(lamps.amber) ? RoadLamp::amber : RoadLamp::dark;
}

std::size_t nearest_lane(double across, std::size_t lanes) {
    const double nearest = std::clamp(std::round(across), 0.0, static_cast<double>(lanes - 1));
    return static_cast<std::size_t>(nearest);
}

} // namespace

Film::Film(const elmopp_junction_t &site, std::size_t approach, const std::string &scene, std::uint64_t seed,
           const std::filesystem::path &lane_file)
    : site_(site), approach_(approach), line_m_(static_cast<double>(site.reach_m) - line_inside_m),
      view_(picture_px, shape_of(site, lanes_across(site, approach).size()),
            mast_of(lanes_across(site, approach).size()), RoadWeather::of(scene), seed) {
    for (const auto &[movement, lane] : lanes_across(site, approach)) {
        const elmopp_movement_t &served = site.movement[movement];
        const std::string number = served.lanes > 1 ? std::to_string(lane + 1) : "";
        pavement_.push_back({movement, std::string(std::begin(served.name)) + number});
    }
    crossed_.assign(pavement_.size(), 0);
    begun_counted_.assign(pavement_.size(), 0);
    write_lanes(lane_file);
    lanes_ = read_lane_file(lane_file);
    counter_ = std::make_unique<Counter>(lanes_);
    last_ = counter_->record();
}

void Film::write_lanes(const std::filesystem::path &file) const {
    const double stop = behind_m + static_cast<double>(site_.reach_m);
    const double line = stop - line_m_;
    const auto point = [this](double ahead, double aside) {
        const cv::Point2d at = view_.place(ahead, aside, 0);
        const auto tenth = [](double px) { return std::round(10 * px) / 10; };
        return nlohmann::ordered_json{tenth(at.x), tenth(at.y)};
    };
    // Seen from beside the road, lines across it slant. A zone's ends are drawn level: the counter cuts it row by row.
    const auto level = [&](double ahead, double aside, double y_px) {
        const cv::Point2d here = view_.place(ahead, aside, 0);
        const cv::Point2d there = view_.place(ahead + 0.5, aside, 0);
        const double x_px = here.x + (there.x - here.x) * (y_px - here.y) / (there.y - here.y);
        return nlohmann::ordered_json{std::round(10 * x_px) / 10, std::round(10 * y_px) / 10};
    };
    nlohmann::ordered_json lanes = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < pavement_.size(); ++k) {
        const double left = static_cast<double>(k) * road_lane_m;
        const double right = left + road_lane_m;
        const double far_px = view_.place(stop, (left + right) / 2, 0).y;
        const double near_px = view_.place(line, (left + right) / 2, 0).y;
        std::size_t first = pavement_[k].movement; // of its approach: movements count from there on the bus
        while (first > 0 && site_.movement[first - 1].approach == approach_) {
            --first;
        }
        lanes.push_back({{"name", pavement_[k].name},
                         {"line", {point(line, left), point(line, right)}},
                         {"direction", "up"},
                         {"zone",
                          {level(stop, left, far_px), level(stop, right, far_px), level(line, right, near_px),
                           level(line, left, near_px)}},
                         {"approach", approach_},
                         {"movement", pavement_[k].movement - first}});
    }
    WholeFile out("lane file", file);
    out.out()
        << nlohmann::ordered_json{{"width", picture_px.width}, {"height", picture_px.height}, {"lanes", lanes}}.dump(1)
        << "\n";
    out.commit();
}

RoadBody Film::body_of(const Place &place) const {
    const Looks looks = looks_of(place.id);
    const double stop = behind_m + static_cast<double>(site_.reach_m);
    RoadBody body{stop - place.front_m,
                  (place.across + 0.5) * road_lane_m + looks.wander_m,
                  0.0,
                  looks.length_m,
                  looks.width_m,
                  looks.height_m,
                  looks.paint,
                  looks.boxy,
                  place.braking};
    const auto turns = turns_of(site_, place.movement);
    if (turns.size() != 1 || turns[0] == Turn::straight) {
        return body;
    }
    const bool left = turns[0] == Turn::left;
    const double begin_m = left ? 6.0 : 4.0;
    const double radius_m = left ? 10.0 : 7.0;
    const double arc_m = -place.front_m - begin_m;
    if (arc_m > 0) {
        const double angle = std::min(arc_m / radius_m, CV_PI / 2);
        const double on_m = arc_m - angle * radius_m;
        const double side = left ? -1.0 : 1.0;
        body.ahead_m = stop + begin_m + radius_m * std::sin(angle);
        body.aside_m += side * (radius_m * (1 - std::cos(angle)) + on_m);
        body.yaw_rad = side * angle;
    }
    return body;
}

void Film::see_crossings(const std::vector<Place> &places) {
    for (const Place &place : places) {
        if (place.approach != approach_) {
            continue;
        }
        const auto before = before_m_.find(place.id);
        if (place.front_m > line_m_) {
            before_m_[place.id] = place.front_m;
        } else if (before != before_m_.end()) {
            ++crossed_[nearest_lane(place.across, pavement_.size())];
            before_m_.erase(before);
        }
    }
}

void Film::look(const std::vector<Place> &places, const elmopp_lamps_t &lamps, CameraTrouble trouble, double t_s) {
    see_crossings(places);
    if (trouble == CameraTrouble::gone) {
        counter_->miss(t_s);
        return;
    }
    if (trouble != CameraTrouble::freeze || picture_.empty()) {
        std::vector<RoadBody> bodies;
        for (const Place &place : places) {
            const RoadBody body = body_of(place);
            if (place.approach == approach_ && std::abs(body.yaw_rad) < turned_away) {
                bodies.push_back(body);
            }
        }
        std::vector<RoadLamp> shown;
        shown.reserve(pavement_.size());
        for (const PavementLane &lane : pavement_) {
            shown.push_back(lamp_of(site_, lane.movement, lamps));
        }
        picture_ = view_.draw(bodies, shown, t_s);
    }
    if (trouble == CameraTrouble::black) {
        picture_.setTo(cv::Scalar::all(0));
    } else if (trouble == CameraTrouble::turn) {
        const cv::Matx23d turned(1, 0, 130, 0, 1, 70);
        cv::warpAffine(picture_.clone(), picture_, turned, picture_.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
    }
    counter_->feed(picture_, t_s);
    (void)counter_->take_crossings();
}

Record Film::record() {
    last_ = counter_->record();
    return last_;
}

void Film::finish() {
    counter_->finish();
    last_ = counter_->record();
}

void Film::begin() {
    const Record now = counter_->glance();
    for (std::size_t k = 0; k < pavement_.size(); ++k) {
        begun_counted_[k] = now.lanes[k].arrived_total;
        crossed_[k] = 0;
    }
}

std::vector<LaneTally> Film::tally() const {
    std::vector<LaneTally> tally;
    tally.reserve(pavement_.size());
    for (std::size_t k = 0; k < pavement_.size(); ++k) {
        tally.push_back(
            {pavement_[k].name, pavement_[k].movement, crossed_[k], last_.lanes[k].arrived_total - begun_counted_[k]});
    }
    return tally;
}

std::vector<int> Film::present(const std::vector<Place> &places) const {
    std::vector<int> there(site_.movement_count);
    for (const Place &place : places) {
        if (place.approach == approach_ && place.front_m <= line_m_ && place.front_m > 0) {
            ++there[pavement_[nearest_lane(place.across, pavement_.size())].movement];
        }
    }
    return there;
}

cv::Mat Film::drawn() const {
    cv::Mat picture = picture_.clone();
    counter_->draw(picture, last_);
    return picture;
}

} // namespace elmopp
