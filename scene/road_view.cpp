// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "road_view.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>

namespace elmopp {
namespace {

constexpr double focal_widths = 1.15; ///< an ordinary lens
constexpr double nearest_m = 2.0;
constexpr double kerb_m = 0.5;
constexpr double pavement_m = 2.5;
constexpr double far_m = 400.0;
constexpr double shade = 0.55;
constexpr int grain_pictures = 6;
const cv::Scalar asphalt(104, 102, 100);

const std::map<std::string, RoadWeather> &weathers() {
    static const std::map<std::string, RoadWeather> all{
        {"day", {1.0, 2.0, false, false, false, 0.0}},    {"shadows", {1.1, 2.0, true, false, false, 0.0}},
        {"dusk", {0.30, 3.5, false, true, false, 240.0}}, {"headlights", {0.20, 4.0, false, true, false, 0.0}},
        {"noise", {0.9, 8.0, false, false, false, 0.0}},  {"rain", {0.62, 4.0, false, true, true, 0.0}},
    };
    return all;
}

cv::Point3d unit(const cv::Point3d &v) {
    return v / std::sqrt(v.dot(v));
}

cv::Scalar bright(const cv::Scalar &colour, double factor) {
    return {colour[0] * factor, colour[1] * factor, colour[2] * factor};
}

/// A box on the road, turned by its body's yaw. Corners: front, rear x left, right x low, high.
class Block {
  public:
    Block(const RoadBody &body, double from_m, double to_m, double inset_m, double low_m, double high_m)
        : front_(from_m), rear_(to_m), half_(body.width_m / 2 - inset_m), low_(low_m), high_(high_m), body_(body) {}

    /// `back_m` behind the front, `side_m` right of the middle.
    [[nodiscard]] cv::Point3d at(double back_m, double side_m, double up_m) const {
        const double c = std::cos(body_.yaw_rad);
        const double s = std::sin(body_.yaw_rad);
        return {body_.ahead_m - back_m * c - side_m * s, body_.aside_m - back_m * s + side_m * c, up_m};
    }

    using Face = std::vector<cv::Point3d>;
    [[nodiscard]] Face front() const {
        return {at(front_, -half_, low_), at(front_, half_, low_), at(front_, half_, high_), at(front_, -half_, high_)};
    }
    [[nodiscard]] Face rear() const {
        return {at(rear_, half_, low_), at(rear_, -half_, low_), at(rear_, -half_, high_), at(rear_, half_, high_)};
    }
    [[nodiscard]] Face left() const {
        return {at(rear_, -half_, low_), at(front_, -half_, low_), at(front_, -half_, high_), at(rear_, -half_, high_)};
    }
    [[nodiscard]] Face right() const {
        return {at(front_, half_, low_), at(rear_, half_, low_), at(rear_, half_, high_), at(front_, half_, high_)};
    }
    [[nodiscard]] Face top() const {
        return {at(front_, -half_, high_), at(front_, half_, high_), at(rear_, half_, high_), at(rear_, -half_, high_)};
    }

  private:
    double front_;
    double rear_;
    double half_;
    double low_;
    double high_;
    const RoadBody &body_;
};

/// Shrinks a face towards its middle: a window in it.
std::vector<cv::Point3d> window(const std::vector<cv::Point3d> &face, double aside, double low, double high) {
    const auto mix = [&](double across, double up) {
        const cv::Point3d bottom = face[0] + (face[1] - face[0]) * across;
        const cv::Point3d top = face[3] + (face[2] - face[3]) * across;
        return bottom + (top - bottom) * up;
    };
    return {mix(aside, low), mix(1 - aside, low), mix(1 - aside, high), mix(aside, high)};
}

/// True if the camera sees the outside of a face whose corners run as Block has them.
bool faces(const std::vector<cv::Point3d> &face, const cv::Point3d &camera, const cv::Point3d &middle) {
    const cv::Point3d normal = (face[1] - face[0]).cross(face[3] - face[0]);
    const cv::Point3d out = normal.dot(face[0] - middle) >= 0 ? normal : -normal;
    return out.dot(camera - face[0]) > 0;
}

} // namespace

RoadWeather RoadWeather::of(const std::string &name) {
    return weathers().at(name);
}

std::vector<std::string> RoadWeather::names() {
    std::vector<std::string> names;
    for (const auto &[name, weather] : weathers()) {
        names.push_back(name);
    }
    return names;
}

RoadView::RoadView(cv::Size picture, const RoadShape &shape, const RoadMast &mast, const RoadWeather &weather,
                   std::uint64_t seed)
    : size_(picture), shape_(shape), mast_(mast), weather_(weather), random_(seed),
      focal_px_(focal_widths * picture.width) {
    front_ = unit({mast.look_ahead_m, mast.look_aside_m - mast.aside_m, -mast.height_m});
    right_ = unit({-front_.y, front_.x, 0.0});
    down_ = unit(front_.cross(right_)); // right-handed in (ahead, aside, up) seen from above
    if (down_.z > 0) {
        down_ = -down_;
    }
    draw_land();
    draw_road();
    draw_houses();
    make_grain();
}

RoadView::Corner RoadView::camera_frame(const Corner &point) const {
    const Corner from = point - Corner(0.0, mast_.aside_m, mast_.height_m);
    return {from.dot(right_), from.dot(down_), from.dot(front_)};
}

bool RoadView::is_before(double ahead_m, double aside_m, double up_m) const {
    return camera_frame({ahead_m, aside_m, up_m}).z > nearest_m;
}

cv::Point2d RoadView::place(double ahead_m, double aside_m, double up_m) const {
    const Corner seen = camera_frame({ahead_m, aside_m, up_m});
    const double depth = std::max(seen.z, nearest_m);
    return {size_.width / 2.0 + focal_px_ * seen.x / depth, size_.height / 2.0 + focal_px_ * seen.y / depth};
}

void RoadView::fill(cv::Mat &picture, const std::vector<Corner> &corners, const cv::Scalar &colour) const {
    constexpr int shift = 4; // bits of a pixel's fraction
    constexpr double scale = 16.0;
    constexpr double most_px = 30000.0; // of a point outside of the picture
    std::vector<cv::Point> fine;
    fine.reserve(corners.size());
    for (const Corner &corner : corners) {
        const cv::Point2d at = place(corner.x, corner.y, corner.z);
        fine.emplace_back(cvRound(std::clamp(at.x, -most_px, most_px) * scale),
                          cvRound(std::clamp(at.y, -most_px, most_px) * scale));
    }
    cv::fillConvexPoly(picture, fine, colour, cv::LINE_AA, shift);
}

/// Sky and grass, in patches that are the smaller the farther they are.
void RoadView::draw_land() {
    road_ = cv::Mat(size_, CV_8UC3, cv::Scalar(70, 105, 92));
    const int horizon = cvRound(std::clamp(place(far_m * 10, mast_.look_aside_m, 0).y, 0.0, 1.0 * size_.height));
    road_.rowRange(0, horizon).setTo(cv::Scalar(214, 203, 190));
    constexpr int tufts = 2600;
    for (int i = 0; i < tufts; ++i) {
        const double ahead = 4.0 / std::max(0.012, random_.uniform(0.0, 1.0));
        const double aside = random_.uniform(-1.0, 1.0) * (20 + 0.7 * ahead);
        const double wide = random_.uniform(0.2, 1.6);
        const double deep = random_.uniform(0.3, 2.5);
        if (!is_before(ahead, aside, 0)) {
            continue;
        }
        const double grey = random_.uniform(-28.0, 28.0);
        fill(road_,
             {{ahead, aside, 0}, {ahead, aside + wide, 0}, {ahead + deep, aside + wide, 0}, {ahead + deep, aside, 0}},
             cv::Scalar(62 + grey, 100 + grey * 1.2, 88 + grey));
    }
}

void RoadView::draw_road() {
    const double right = shape_.lanes * road_lane_m;
    const double other = -1.2 * road_lane_m - 2 * road_lane_m; // the opposite carriageway, beyond a reserve
    const double from = nearest_m + 4;
    const auto strip = [&](double a_m, double b_m, double left_m, double right_m, const cv::Scalar &colour) {
        fill(road_, {{b_m, left_m, 0}, {b_m, right_m, 0}, {a_m, right_m, 0}, {a_m, left_m, 0}}, colour);
    };
    const cv::Scalar stone(150, 152, 150);
    strip(from, far_m, other - pavement_m, right + pavement_m, cv::Scalar(132, 138, 142));
    strip(from, far_m, -kerb_m, right + kerb_m, stone);
    strip(from, far_m, 0, right, asphalt);
    strip(from, far_m, other, other + 2 * road_lane_m, bright(asphalt, 1.04));
    strip(shape_.stop_m + 2, shape_.stop_m + 2 + shape_.across_m, -90, 90, bright(asphalt, 0.97));
    constexpr int patches = 70; // mended, oily, worn
    for (int i = 0; i < patches; ++i) {
        const double ahead = from + 3 + random_.uniform(0.0, 1.0) * (shape_.stop_m + 20);
        const double left = random_.uniform(0.0, right - 0.8);
        strip(ahead, ahead + random_.uniform(0.6, 6.0), left, std::min(right, left + random_.uniform(0.3, 1.8)),
              bright(asphalt, random_.uniform(0.88, 1.09)));
    }
    const cv::Scalar paint(205, 206, 205);
    for (int edge = 0; edge <= shape_.lanes; ++edge) {
        const double at = edge * road_lane_m;
        const bool border = edge == 0 || edge == shape_.lanes;
        constexpr double pitch = 9.0;
        const int dashes = static_cast<int>(std::ceil((shape_.stop_m - from) / pitch));
        for (int dash = 0; dash < dashes; ++dash) {
            const double a = from + pitch * dash;
            strip(a, std::min(shape_.stop_m, a + (border ? pitch : 4.0)), at - 0.07, at + 0.07, paint);
        }
    }
    strip(shape_.stop_m, shape_.stop_m + 0.5, 0, right, paint);
    for (int bar = 0; bar + 0.5 < right; ++bar) { // a crossing for people on foot
        strip(shape_.stop_m + 1.5, shape_.stop_m + 4.5, bar + 0.5, bar + 1.0, paint);
    }
}

/// What stands upright beside and behind the road, far to near.
void RoadView::draw_houses() {
    const double right = shape_.lanes * road_lane_m + pavement_m + 3;
    const double left = -3.2 * road_lane_m - pavement_m - 3;
    constexpr double last_house_m = 160.0; // beyond the stop line
    constexpr double first_house_m = 30.0;
    double next = shape_.stop_m + last_house_m;
    while (next > first_house_m) {
        const double ahead = next;
        next -= random_.uniform(11.0, 19.0);
        if (ahead > shape_.stop_m - 4 && ahead < shape_.stop_m + shape_.across_m + 8) {
            continue; // the side street
        }
        for (const double edge : {left, right}) {
            const double away = edge < 0 ? edge - random_.uniform(0.0, 5.0) : edge + random_.uniform(0.0, 5.0);
            const double high = random_.uniform(5.0, 13.0);
            const double deep = random_.uniform(7.0, 10.0);
            const double out = edge < 0 ? -8.0 : 8.0;
            const double tone = random_.uniform(105.0, 185.0);
            const cv::Scalar wall(tone + random_.uniform(-28.0, 4.0), tone + random_.uniform(-10.0, 8.0),
                                  tone + random_.uniform(-6.0, 22.0));
            fill(road_, {{ahead, away, 0}, {ahead, away + out, 0}, {ahead, away + out, high}, {ahead, away, high}},
                 bright(wall, 0.9));
            fill(road_, {{ahead, away, 0}, {ahead + deep, away, 0}, {ahead + deep, away, high}, {ahead, away, high}},
                 wall);
            for (int floor = 0; 2.9 * floor + 2.7 < high; ++floor) {
                for (int column = 0; 2.4 * column + 2.2 < deep; ++column) {
                    const double up = 1.2 + 2.9 * floor;
                    const double a = ahead + 1 + 2.4 * column;
                    fill(road_, {{a, away, up}, {a + 1.1, away, up}, {a + 1.1, away, up + 1.4}, {a, away, up + 1.4}},
                         cv::Scalar(60, 55, 50));
                }
            }
            for (int leaf = 0; leaf < 60; ++leaf) { // a tree before it
                const double nearer = edge < 0 ? 2.2 : -2.2;
                const cv::Point2d at = place(ahead - 3 + random_.uniform(-1.5, 1.5),
                                             away + nearer + random_.uniform(-1.4, 1.4), random_.uniform(1.8, 5.0));
                const double green = random_.uniform(-20.0, 25.0);
                const double wide = focal_px_ * 0.45 / std::max(20.0, ahead);
                cv::circle(road_, at, std::max(1, cvRound(wide)), cv::Scalar(48 + green, 84 + green, 64 + green),
                           cv::FILLED, cv::LINE_AA);
            }
        }
    }
}

/// Pictures of noise once, used again shifted; and the road's own grain.
void RoadView::make_grain() {
    cv::Mat own(size_, CV_16SC3);
    random_.fill(own, cv::RNG::NORMAL, 0, 5);
    cv::GaussianBlur(own, own, cv::Size(3, 3), 0);
    cv::Mat wide;
    road_.convertTo(wide, CV_16S);
    wide += own;
    wide.convertTo(road_, CV_8U);
    road_.convertTo(dark_, CV_8U, shade);
    constexpr int spare = 64;
    for (int i = 0; i < grain_pictures; ++i) {
        cv::Mat noise(size_.height + spare, size_.width + spare, CV_16SC3);
        random_.fill(noise, cv::RNG::NORMAL, 0, weather_.noise);
        for (int drop = 0; weather_.rain && drop < 260; ++drop) {
            const cv::Point from(random_.uniform(0, noise.cols), random_.uniform(0, noise.rows));
            const int fall = random_.uniform(6, 22);
            cv::line(noise, from, from + cv::Point(fall / 6, fall), cv::Scalar::all(random_.uniform(12, 34)), 1);
        }
        cv::Mat more;
        cv::Mat less;
        noise.convertTo(more, CV_8U);
        noise.convertTo(less, CV_8U, -1.0);
        grain_.push_back(more);
        grain_.push_back(less);
    }
}

void RoadView::add_grain(cv::Mat &picture) {
    const auto which = static_cast<std::size_t>(random_.uniform(0, grain_pictures));
    const cv::Rect part(random_.uniform(0, grain_[0].cols - size_.width),
                        random_.uniform(0, grain_[0].rows - size_.height), size_.width, size_.height);
    picture += grain_[2 * which](part);
    picture -= grain_[2 * which + 1](part);
}

/// `reach`: how far the shadow goes, in heights; 0: below the body only.
void RoadView::draw_shadow(cv::Mat &mask, const RoadBody &body, double reach) const {
    const double wide = reach > 0 ? 0.0 : 0.12;
    const Block block(body, -wide, body.length_m + wide, -wide, 0, 0);
    fill(mask, block.top(), cv::Scalar(255));
    if (reach <= 0) {
        return;
    }
    const Corner away(-0.35 * reach * body.height_m, reach * body.height_m, 0); // the sun stands ahead, to the left
    std::vector<cv::Point2f> hull_of;
    for (const Corner &corner : block.top()) {
        for (const Corner &end : {corner, corner + away}) {
            hull_of.emplace_back(place(end.x, end.y, 0));
        }
    }
    std::vector<cv::Point2f> hull;
    cv::convexHull(hull_of, hull);
    std::vector<cv::Point> whole;
    whole.reserve(hull.size());
    for (const cv::Point2f &point : hull) {
        whole.emplace_back(cvRound(point.x), cvRound(point.y));
    }
    cv::fillConvexPoly(mask, whole, cv::Scalar(255), cv::LINE_8);
}

void RoadView::draw_body(cv::Mat &picture, const RoadBody &body) const {
    const double sill = 0.25;
    const double waist = body.boxy ? body.height_m : 0.58 * body.height_m;
    const Block hull(body, 0, body.length_m, 0, sill, waist);
    const Block cabin(body, 0.24 * body.length_m, 0.93 * body.length_m, 0.14, waist, body.height_m);
    const Corner camera(0, mast_.aside_m, mast_.height_m);
    const cv::Scalar glass(52, 46, 42);
    const auto draw = [&](const Block &block, bool glazed) {
        const Corner middle = block.at(body.length_m / 2, 0, body.height_m / 2);
        const std::array<std::pair<Block::Face, double>, 4> sides{
            {{block.front(), 0.95}, {block.rear(), 0.86}, {block.left(), 0.78}, {block.right(), 0.70}}};
        for (const auto &[face, light] : sides) {
            if (faces(face, camera, middle)) {
                fill(picture, face, bright(body.paint, light));
                if (glazed) {
                    fill(picture, window(face, 0.1, 0.12, 0.86), glass);
                }
            }
        }
        fill(picture, block.top(), bright(body.paint, 1.12));
    };
    // Below the sill: tyres and shade.
    fill(picture, Block(body, 0.1, body.length_m - 0.1, 0.08, 0, 0).top(), cv::Scalar(34, 33, 32));
    const Block under(body, 0.05, body.length_m - 0.05, 0.06, 0, sill);
    for (const auto &face : {under.front(), under.rear(), under.left(), under.right()}) {
        fill(picture, face, cv::Scalar(30, 29, 28));
    }
    draw(hull, false);
    if (body.boxy) {
        fill(picture, window(hull.rear(), 0.18, 0.55, 0.85), glass);
    } else {
        draw(cabin, true);
    }
    draw_tail(picture, body);
}

void RoadView::draw_tail(cv::Mat &picture, const RoadBody &body) const {
    const Block hull(body, 0, body.length_m, 0, 0, 0);
    const double on = body.braking ? 1.0 : weather_.lamps ? 0.75 : 0.35;
    for (const double side : {-0.40, 0.40}) {
        const double at = side * body.width_m;
        const double half = 0.12;
        fill(picture,
             {hull.at(body.length_m, at - half, 0.62), hull.at(body.length_m, at + half, 0.62),
              hull.at(body.length_m, at + half, 0.84), hull.at(body.length_m, at - half, 0.84)},
             cv::Scalar(30 * on, 28 * on, 120 + 130 * on));
    }
    fill(picture,
         {hull.at(body.length_m, -0.26, 0.40), hull.at(body.length_m, 0.26, 0.40), hull.at(body.length_m, 0.26, 0.52),
          hull.at(body.length_m, -0.26, 0.52)},
         cv::Scalar(200, 205, 205));
}

/// What headlights add to the road ahead of a vehicle: a share of what the road sends back by day.
void RoadView::draw_beam(cv::Mat &picture, const RoadBody &body, double strength) const {
    const Block hull(body, 0, body.length_m, 0, 0, 0);
    const std::vector<Corner> cone{hull.at(-0.5, -0.7, 0), hull.at(-0.5, 0.7, 0), hull.at(-14, 2.2, 0),
                                   hull.at(-14, -2.2, 0)};
    std::vector<cv::Point> outline;
    outline.reserve(cone.size());
    for (const Corner &corner : cone) {
        const cv::Point2d at = place(corner.x, corner.y, 0);
        outline.emplace_back(cvRound(at.x), cvRound(at.y));
    }
    constexpr int soft = 9;
    cv::Rect box = cv::boundingRect(outline);
    box = cv::Rect(box.x - soft, box.y - soft, box.width + 2 * soft, box.height + 2 * soft) & cv::Rect({0, 0}, size_);
    if (box.area() > 0) {
        for (cv::Point &point : outline) {
            point -= box.tl();
        }
        cv::Mat light = cv::Mat::zeros(box.size(), CV_8UC3);
        cv::fillConvexPoly(light, outline, cv::Scalar(205, 240, 255) * strength, cv::LINE_AA);
        cv::blur(light, light, cv::Size(2 * soft - 1, 2 * soft - 1));
        cv::Mat lit;
        cv::multiply(road_(box), light, lit, 1.0 / 255, CV_8U);
        picture(box) += lit;
    }
}

void RoadView::draw_lamps(cv::Mat &picture, const std::vector<RoadLamp> &lamps) const {
    for (std::size_t lane = 0; lane < lamps.size(); ++lane) {
        const double aside = (static_cast<double>(lane) + 0.5) * road_lane_m;
        const double ahead = shape_.stop_m + shape_.across_m; // on a gantry at the far side
        const cv::Point2d low = place(ahead, aside, 5.0);
        const cv::Point2d high = place(ahead, aside, 6.6);
        const double size = std::max(5.0, low.y - high.y);
        cv::rectangle(picture, cv::Rect2d(low.x - size / 4, low.y - size, size / 2, size), cv::Scalar(20, 20, 20),
                      cv::FILLED);
        const auto lit = [&](double share, const cv::Scalar &colour) {
            cv::circle(picture, cv::Point2d(low.x, low.y - size * share), std::max(1, cvRound(size / 6)), colour,
                       cv::FILLED, cv::LINE_AA);
        };
        const RoadLamp lamp = lamps[lane];
        if (lamp == RoadLamp::red || lamp == RoadLamp::red_amber) {
            lit(0.82, cv::Scalar(60, 50, 250));
        }
        if (lamp == RoadLamp::amber || lamp == RoadLamp::red_amber) {
            lit(0.5, cv::Scalar(40, 190, 255));
        }
        if (lamp == RoadLamp::green) {
            lit(0.18, cv::Scalar(120, 240, 60));
        }
    }
}

cv::Mat RoadView::draw(const std::vector<RoadBody> &bodies, const std::vector<RoadLamp> &lamps, double t_s) {
    std::vector<RoadBody> seen;
    for (const RoadBody &body : bodies) {
        if (is_before(body.ahead_m - body.length_m - 1, body.aside_m, 0)) {
            seen.push_back(body);
        }
    }
    const Corner camera(0, mast_.aside_m, mast_.height_m);
    std::sort(seen.begin(), seen.end(), [&](const RoadBody &a, const RoadBody &b) {
        const auto away = [&](const RoadBody &body) {
            return std::hypot(body.ahead_m - body.length_m / 2, body.aside_m - camera.y);
        };
        return away(a) > away(b);
    });
    cv::Mat picture = road_.clone();
    cv::Mat mask = cv::Mat::zeros(size_, CV_8U);
    constexpr double sun = 1.1;
    for (const RoadBody &body : seen) {
        draw_shadow(mask, body, weather_.sun ? sun : 0.0);
    }
    dark_.copyTo(picture, mask);
    for (const RoadBody &body : seen) {
        draw_body(picture, body);
    }
    const double fallen = weather_.dusk_s > 0 ? std::clamp(t_s / weather_.dusk_s, 0.0, 1.0) : 1.0;
    constexpr double clouds = 0.03;
    const double drift = 1.0 + clouds * std::sin(t_s / 17.0) + clouds * std::sin(t_s / 5.3);
    const double light = std::pow(weather_.light, fallen) * drift;
    picture.convertTo(picture, CV_8U, light);
    // The camera opens up as it gets dark: a beam is the brighter in the picture, the darker the street.
    constexpr double unseen_at = 0.75;
    constexpr double full_at = 0.25;
    constexpr double full = 0.35;
    const double strength = full * std::clamp((unseen_at - light) / (unseen_at - full_at), 0.0, 1.0);
    if (weather_.lamps && strength > 0) {
        for (const RoadBody &body : seen) {
            draw_beam(picture, body, strength);
        }
        for (const RoadBody &body : seen) {
            if (faces(Block(body, 0, body.length_m, 0, 0, 1).rear(), camera, {body.ahead_m, body.aside_m, 0})) {
                draw_tail(picture, body);
            }
        }
    }
    draw_lamps(picture, lamps);
    cv::GaussianBlur(picture, picture, cv::Size(3, 3), 0.6);
    add_grain(picture);
    return picture;
}

} // namespace elmopp
