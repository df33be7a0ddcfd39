// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "presence.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace elmopp {
namespace {

constexpr double lane_m = 3.2;
constexpr double vehicle_m = 4.5;
constexpr double height_m = 1.3;
constexpr double pitch_m = 7.0;
constexpr double focal_widths = 1.15; ///< focal length of an ordinary camera, in widths of its picture
constexpr float texture_limit = 0.10F;
constexpr double texture_share = 0.20;

int odd(double lane_widths) {
    return 2 * (static_cast<int>(std::lround(lane_widths * patch_unit)) / 2) + 1;
}

/// Where the middle of the line lies along the zone's travel.
double place_of_line(const Lane &lane) {
    const bool vertical = lane.direction == Direction::up || lane.direction == Direction::down;
    const bool turned = lane.direction == Direction::up || lane.direction == Direction::left;
    const cv::Point2d middle = (lane.from_px + lane.to_px) / 2;
    double low = 1e9;
    double high = -1e9;
    for (const cv::Point2d &corner : lane.zone_px) {
        low = std::min(low, vertical ? corner.y : corner.x);
        high = std::max(high, vertical ? corner.y : corner.x);
    }
    const double at = ((vertical ? middle.y : middle.x) - low) / std::max(1.0, high - low);
    return turned ? 1 - at : at;
}

} // namespace

Presence::Presence(const Lane &lane, cv::Size picture, const Settings &settings)
    : patch_(Patch::along(lane, picture)), background_(patch_.valid(), settings), line_at_(place_of_line(lane)) {
    constexpr double lowest_m = 4.0;
    constexpr double highest_m = 25.0;
    focal_px_ = focal_widths * picture.width;
    const double growth_at_all = std::max(1e-4, std::abs(patch_.convergence()));
    camera_m_ = std::clamp(lane_m / growth_at_all, lowest_m, highest_m);
    near_is_last_ = patch_.convergence() >= 0;
    constexpr double least_angle = 12.0 * CV_PI / 180;
    constexpr double least_lanes = 0.6;
    const auto rows = static_cast<std::size_t>(patch_.size().height);
    const double focal_px = focal_widths * picture.width;
    for (std::size_t row = 0; row < rows; ++row) {
        const double growth = std::max(1e-4, std::abs(patch_.convergence()));
        const double angle =
            std::clamp(std::atan(patch_.width_px(static_cast<int>(row)) / (growth * focal_px)), least_angle, CV_PI / 2);
        vehicle_rows_.push_back(
            patch_unit * std::max(least_lanes, (vehicle_m * std::sin(angle) + height_m * std::cos(angle)) / lane_m));
    }
    covered_.assign(rows, 0);
    unknown_.assign(rows, 0);
    quiet_s_.assign(rows, -1.0);
}

/// Share of the middle of a row that is full of edges.
double Presence::textured(const cv::Mat &texture, int row) const {
    const int from = patch_unit / 6;
    const int to = patch_unit - from;
    int many = 0;
    for (int c = from; c < to; ++c) {
        many += texture.at<float>(row, c) > texture_limit ? 1 : 0;
    }
    return static_cast<double>(many) / (to - from);
}

void Presence::find_unknown() {
    const cv::Mat texture = background_.road_texture();
    const int rows = patch_.size().height;
    std::vector<double> share(static_cast<std::size_t>(rows));
    for (int r = 0; r < rows; ++r) {
        share[static_cast<std::size_t>(r)] = textured(texture, r);
    }
    // Of single rows the windows of a car are smooth: the mean of half a vehicle decides.
    std::fill(unknown_.begin(), unknown_.end(), 0);
    for (int r = 0; r < rows; ++r) {
        const int half = static_cast<int>(vehicle_rows_[static_cast<std::size_t>(r)] / 4);
        double sum = 0;
        int many = 0;
        for (int k = std::max(0, r - half); k <= std::min(rows - 1, r + half); ++k) {
            sum += share[static_cast<std::size_t>(k)];
            ++many;
        }
        unknown_[static_cast<std::size_t>(r)] = sum / many > texture_share ? 1 : 0;
    }
    for (int r = 0; r < rows;) {
        int end = r;
        while (end < rows && unknown_[static_cast<std::size_t>(end)] == unknown_[static_cast<std::size_t>(r)]) {
            ++end;
        }
        if (unknown_[static_cast<std::size_t>(r)] != 0 && end - r < vehicle_rows_[static_cast<std::size_t>(r)] / 2) {
            std::fill(unknown_.begin() + r, unknown_.begin() + end, 0);
        }
        r = end;
    }
    std::fill(quiet_s_.begin(), quiet_s_.end(), -1.0);
}

void Presence::assume(const Background::Sample &sample) {
    background_.assume(sample);
    find_unknown();
    std::copy(unknown_.begin(), unknown_.end(), covered_.begin());
    balance(0);
}

void Presence::learn(const std::vector<Background::Sample> &samples) {
    begin(samples);
    int all = std::numeric_limits<int>::max();
    learn_more(all);
}

void Presence::begin(const std::vector<Background::Sample> &samples) {
    lesson_ = samples;
    background_.begin(samples);
}

bool Presence::learn_more(int &pixels) {
    if (!background_.learn_more(pixels)) {
        return false;
    }
    if (!lesson_.empty()) {
        before_.release();
        find_unknown();
        clear_moved(lesson_);
        started_ = true;
        lesson_.clear();
    }
    return true;
}

/// What moved while it was learnt was no queue.
void Presence::clear_moved(const std::vector<Background::Sample> &samples) {
    const std::size_t step = std::max<std::size_t>(1, samples.size() / 12);
    Background::Seen one;
    Background::Seen two;
    std::vector<double> moved(unknown_.size(), 0.0);
    int many = 0;
    for (std::size_t i = step; i < samples.size(); i += step) {
        Background::logarithms(samples[i - step], one);
        Background::logarithms(samples[i], two);
        const cv::Mat change = cv::abs(two.light - one.light) > std::max(0.08F, 4 * background_.noise());
        for (int r = 0; r < change.rows; ++r) {
            moved[static_cast<std::size_t>(r)] += cv::countNonZero(change.row(r)) > patch_unit / 4 ? 1 : 0;
        }
        ++many;
    }
    for (std::size_t r = 0; r < unknown_.size(); ++r) {
        if (many > 0 && moved[r] > 0.35 * many) {
            unknown_[r] = 0;
        }
    }
}

void Presence::known() {
    std::fill(unknown_.begin(), unknown_.end(), 0);
    std::fill(covered_.begin(), covered_.end(), 0);
    count_ = 0;
}

/// Rows on which a vehicle moves, by its length: somebody who walks in front of a queue moves on few.
std::vector<char> Presence::rows_passed(const cv::Mat &moving) const {
    constexpr double half_of = 0.5;
    std::vector<int> before(1, 0); // [row] rows that move, up to there
    for (int r = 0; r < moving.rows; ++r) {
        before.push_back(before.back() + (cv::countNonZero(moving.row(r)) > patch_unit / 4 ? 1 : 0));
    }
    std::vector<char> passed(static_cast<std::size_t>(moving.rows), 0);
    for (int r = 0; r < moving.rows; ++r) {
        const double vehicle = vehicle_rows_[static_cast<std::size_t>(r)];
        const int from = std::max(0, r - static_cast<int>(vehicle * half_of));
        const int to = std::min(moving.rows, r + static_cast<int>(vehicle * half_of) + 1);
        const int many = before[static_cast<std::size_t>(to)] - before[static_cast<std::size_t>(from)];
        passed[static_cast<std::size_t>(r)] = many > half_of * vehicle ? 1 : 0;
    }
    return passed;
}

/// Rows that something has moved on are known as soon as they rest: road that is there again, or another vehicle.
void Presence::clear_unknown(const Background::Seen &seen, double dt_s) {
    constexpr double rest_s = 0.8;
    constexpr double alike = 0.06;
    if (before_.empty()) {
        before_ = seen.light;
        return;
    }
    const cv::Mat moving = cv::abs(seen.light - before_) > std::max(0.08F, 4 * background_.noise());
    before_ = seen.light;
    cv::Mat texture;
    cv::blur(seen.light, texture, cv::Size(7, 7));
    texture = cv::abs(seen.light - texture);
    const std::vector<char> passed = rows_passed(moving);
    for (int r = 0; r < seen.light.rows; ++r) {
        const auto row = static_cast<std::size_t>(r);
        if (unknown_[row] == 0) {
            continue;
        }
        if (passed[row] != 0) {
            quiet_s_[row] = 0;
            continue;
        }
        const bool bare = textured(texture, r) < 0.3 * texture_share;
        if (quiet_s_[row] >= 0) {
            quiet_s_[row] += dt_s;
        }
        if (quiet_s_[row] < rest_s) {
            continue;
        }
        const double apart = cv::mean(cv::abs(seen.change.row(r)))[0];
        if (bare || apart < alike) {
            unknown_[row] = 0;
        }
    }
}

void Presence::find_covered(const Background::Seen &seen) {
    constexpr double on = 0.40;
    constexpr double off = 0.20;
    const cv::Mat close = cv::getStructuringElement(cv::MORPH_RECT, cv::Size(odd(0.3), odd(0.3)));
    cv::Mat solid;
    cv::morphologyEx(seen.object, solid, cv::MORPH_CLOSE, close);
    cv::Mat near;
    cv::dilate(solid, near, cv::getStructuringElement(cv::MORPH_RECT, cv::Size(odd(0.7), odd(0.7))));
    solid |= seen.candidate & near;
    const int from = patch_unit / 8;
    for (int r = 0; r < solid.rows; ++r) {
        const auto row = static_cast<std::size_t>(r);
        const double share = cv::countNonZero(solid.row(r).colRange(from, patch_unit - from)) /
                             static_cast<double>(patch_unit - 2 * from);
        covered_[row] = share > (covered_[row] != 0 ? off : on) ? 1 : 0;
        if (unknown_[row] != 0) {
            covered_[row] = 1;
        }
    }
}

std::vector<Presence::Stretch> Presence::stretches() const {
    const int gap = patch_unit / 5;
    const int least = patch_unit * 35 / 100;
    std::vector<Stretch> found;
    for (int r = 0; r < static_cast<int>(covered_.size()); ++r) {
        if (covered_[static_cast<std::size_t>(r)] == 0) {
            continue;
        }
        if (!found.empty() && r - found.back().last <= gap) {
            found.back().last = r;
        } else {
            found.push_back({r, r});
        }
    }
    const auto is_short = [least](const Stretch &one) { return one.last - one.first + 1 < least; };
    found.erase(std::remove_if(found.begin(), found.end(), is_short), found.end());
    return found;
}

/// Metres of road that the vehicles of a stretch stand on, from the near end of the first to the far end of the last.
/// What is seen of the last one is its roof, which covers road behind it.
double Presence::length_m(const Stretch &stretch) const {
    constexpr double clipped = 0.5; // a roof at the end of the zone is seen in part
    const int rows = patch_.size().height;
    const double near_m = away_m(near_is_last_ ? stretch.last : stretch.first);
    const int far_row = near_is_last_ ? stretch.first : stretch.last;
    const double roof_m = away_m(far_row);
    const bool at_end = near_is_last_ ? far_row <= 1 : far_row >= rows - 2;
    const double shrink = std::min(0.5, height_m / camera_m_) * (at_end ? clipped : 1.0);
    return std::max(0.1, roof_m * (1 - shrink) - near_m);
}

/// How far from the camera a row of the zone is.
double Presence::away_m(int row) const {
    return focal_px_ * lane_m / patch_.width_px(row);
}

/// One vehicle, and one more for each pitch that the stretch is longer.
double Presence::vehicles_in(const Stretch &stretch) const {
    return std::max(1.0, 1 + (length_m(stretch) / scale_ - vehicle_m) / pitch_m);
}

/// Learns from single vehicles that drive through how long one is here: neither the camera's lens is known nor how
/// carefully the zone was drawn.
void Presence::calibrate(const std::vector<Stretch> &found) {
    constexpr std::size_t memory = 80;
    constexpr std::size_t enough = 25;
    constexpr double typical = 0.4;
    constexpr double least_scale = 0.7;
    constexpr double most_scale = 1.5;
    constexpr int moved_rows = 2;
    const int rows = patch_.size().height;
    const bool single = found.size() == 1 && found[0].first > 2 && found[0].last < rows - 3;
    const int middle = single ? (found[0].first + found[0].last) / 2 : -1;
    if (single && last_middle_ >= 0 && std::abs(middle - last_middle_) >= moved_rows) {
        lengths_m_.push_back(length_m(found[0]));
        if (lengths_m_.size() > memory) {
            lengths_m_.pop_front();
        }
    }
    last_middle_ = middle;
    if (lengths_m_.size() >= enough) {
        std::vector<double> sorted(lengths_m_.begin(), lengths_m_.end());
        std::sort(sorted.begin(), sorted.end());
        const double usual_m = sorted[static_cast<std::size_t>(typical * static_cast<double>(sorted.size()))];
        scale_ = std::clamp(usual_m / vehicle_m, least_scale, most_scale);
    }
}

void Presence::crossed(int vehicles) {
    constexpr double near_end = 0.4;
    if (line_at_ < near_end) {
        count_ += vehicles;
    } else if (line_at_ > 1 - near_end) {
        count_ -= vehicles;
        left_ += vehicles;
        left_s_ = 0;
    }
}

/// The count stays within what the covered length allows.
void Presence::balance(double dt_s) {
    constexpr double patience_s = 0.5;
    constexpr double empty_after_s = 1.0;
    constexpr double leaving_s = 2.0; // who has just left still hides the end of the zone
    const std::vector<Stretch> found = stretches();
    calibrate(found);
    double guess = 0;
    for (const Stretch &stretch : found) {
        guess += std::round(vehicles_in(stretch));
    }
    left_s_ += dt_s;
    if (left_s_ > leaving_s) {
        left_ = 0;
    }
    const double slack = guess < 3 ? 0.0 : 0.15 * guess;
    const double low = std::max(0.0, std::ceil(guess - slack) - std::min(left_, 1));
    const double high = std::floor(guess + slack);
    const bool outside = count_ < low || count_ > high;
    outside_s_ = outside ? outside_s_ + dt_s : 0.0;
    if (dt_s <= 0 || outside_s_ > patience_s) {
        count_ = std::clamp(count_, low, std::max(low, high));
        outside_s_ = 0;
    }
    empty_s_ = covered_share() < 0.03 ? empty_s_ + dt_s : 0.0;
    if (empty_s_ > empty_after_s) {
        count_ = 0;
    }
}

void Presence::feed(const Background::Sample &sample, double dt_s) {
    constexpr double ghost_s = 2.0;
    Background::Seen seen = background_.look(sample);
    clear_unknown(seen, dt_s);
    find_covered(seen);
    cv::Mat held(seen.light.rows, 1, CV_8U);
    for (int r = 0; r < held.rows; ++r) {
        held.at<uchar>(r) = covered_[static_cast<std::size_t>(r)] != 0 ? 255 : 0;
    }
    background_.renew(seen, dt_s, held, ghost_s);
    balance(dt_s);
}

int Presence::present() const {
    return static_cast<int>(std::lround(std::max(0.0, count_)));
}

bool Presence::unknown() const {
    return !started_ || std::any_of(unknown_.begin(), unknown_.end(), [](char row) { return row != 0; });
}

double Presence::covered_share() const {
    const auto many = std::count_if(covered_.begin(), covered_.end(), [](char row) { return row != 0; });
    return covered_.empty() ? 0.0 : static_cast<double>(many) / static_cast<double>(covered_.size());
}

} // namespace elmopp
