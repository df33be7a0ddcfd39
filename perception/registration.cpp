// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "registration.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace elmopp {
namespace {

constexpr int small_width_px = 320;
constexpr int piece_px = 15;
constexpr int search_px = 8;
constexpr int wide_search_px = 28;
constexpr int columns = 7;
constexpr int rows = 5;
constexpr double alike = 0.6;
constexpr double together_px = 0.8;
constexpr double dead_band_px = 0.35;
constexpr double farthest = 0.2; ///< a picture that has moved by more of its width is another one
constexpr double half_agree = 0.5;
constexpr std::size_t least_pieces = 6;
constexpr int light_columns = 32;
constexpr int light_rows = 24;

float median_of(std::vector<float> values) {
    if (values.empty()) {
        return 0.0F;
    }
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// The top of a parabola through three neighbours, as an offset from the middle one.
double top_of(double left, double middle, double right) {
    const double bend = left - 2 * middle + right;
    return bend < -1e-9 ? std::clamp(0.5 * (left - right) / bend, -0.5, 0.5) : 0.0;
}

} // namespace

Registration::Registration(const cv::Mat &traffic) {
    scale_ = std::min(1.0, static_cast<double>(small_width_px) / traffic.cols);
    cv::resize(traffic, traffic_, cv::Size(), scale_, scale_, cv::INTER_NEAREST);
    cv::resize(traffic, beside_, cv::Size(light_columns, light_rows), 0, 0, cv::INTER_AREA);
    beside_ = beside_ == 0;
}

void Registration::capture(const cv::Mat &grey) {
    pieces_.clear();
    tried_ = 0;
    found_ = 0;
    base_ = last_;
    cv::Mat strength;
    cv::cornerMinEigenVal(grey, strength, 5);
    const cv::Point moved(static_cast<int>(std::lround(last_.x)), static_cast<int>(std::lround(last_.y)));
    const int border = piece_px / 2 + search_px;
    for (int r = 0; r < rows; ++r) {
        for (int c = 0; c < columns; ++c) {
            const int x0 = border + c * (grey.cols - 2 * border) / columns;
            const int x1 = border + (c + 1) * (grey.cols - 2 * border) / columns;
            const int y0 = border + r * (grey.rows - 2 * border) / rows;
            const int y1 = border + (r + 1) * (grey.rows - 2 * border) / rows;
            float best = 1e-5F;
            cv::Point where(-1, -1);
            for (int y = y0; y < y1; ++y) {
                for (int x = x0; x < x1; ++x) {
                    const cv::Point home(x - moved.x, y - moved.y);
                    const bool away =
                        !cv::Rect(cv::Point(0, 0), traffic_.size()).contains(home) || traffic_.at<uchar>(home) == 0;
                    if (away && strength.at<float>(y, x) > best) {
                        best = strength.at<float>(y, x);
                        where = {x, y};
                    }
                }
            }
            if (where.x >= 0) {
                const cv::Rect square(where - cv::Point(piece_px / 2, piece_px / 2), cv::Size(piece_px, piece_px));
                pieces_.push_back({where, grey(square).clone()});
            }
        }
    }
}

bool Registration::vote(const cv::Mat &grey, int reach, Result &result) {
    const cv::Point guess(static_cast<int>(std::lround(last_.x - base_.x)),
                          static_cast<int>(std::lround(last_.y - base_.y)));
    std::vector<cv::Point2d> votes;
    for (const Piece &piece : pieces_) {
        const int half = piece_px / 2 + reach;
        const cv::Rect whole(piece.at + guess - cv::Point(half, half), cv::Size(2 * half + 1, 2 * half + 1));
        const cv::Rect part = whole & cv::Rect(cv::Point(0, 0), grey.size());
        if (part.width < piece_px + 2 || part.height < piece_px + 2) {
            continue;
        }
        cv::Mat score;
        cv::matchTemplate(grey(part), piece.look, score, cv::TM_CCOEFF_NORMED);
        double best = 0;
        cv::Point at;
        cv::minMaxLoc(score, nullptr, &best, nullptr, &at);
        if (best < alike || at.x == 0 || at.y == 0 || at.x == score.cols - 1 || at.y == score.rows - 1) {
            continue;
        }
        const cv::Point2d fine(top_of(score.at<float>(at.y, at.x - 1), best, score.at<float>(at.y, at.x + 1)),
                               top_of(score.at<float>(at.y - 1, at.x), best, score.at<float>(at.y + 1, at.x)));
        votes.push_back(cv::Point2d(part.tl() + at + cv::Point(piece_px / 2, piece_px / 2) - piece.at) + fine);
    }
    std::size_t most = 0;
    cv::Point2d centre;
    for (const cv::Point2d &candidate : votes) {
        cv::Point2d sum;
        std::size_t near = 0;
        for (const cv::Point2d &other : votes) {
            if (cv::norm(other - candidate) < together_px) {
                sum += other;
                ++near;
            }
        }
        if (near > most) {
            most = near;
            centre = sum / static_cast<double>(near);
        }
    }
    result.agreement = pieces_.empty() ? 0.0 : static_cast<double>(most) / static_cast<double>(pieces_.size());
    if (static_cast<double>(most) < std::max(4.0, 0.35 * static_cast<double>(pieces_.size()))) {
        return false;
    }
    const cv::Point2d found = base_ + centre;
    if (cv::norm(found - last_) > dead_band_px) {
        last_ = found;
    }
    return true;
}

/// Most pieces have gone, with the light of the day or over the border: new ones, from where they are now.
void Registration::renew_pieces(const cv::Mat &grey, const Result &result) {
    constexpr int patience = 8;
    few_ = result.sure && result.agreement < half_agree ? few_ + 1 : 0;
    if (few_ > patience && cv::norm(last_) < farthest * grey.cols) {
        capture(grey);
        few_ = 0;
    }
}

/// Pieces that are hardly ever found again, in the noise of a dark night or on passing lamps, never were any.
void Registration::prove_pieces(bool sure) {
    constexpr int proof = 25;
    tried_ += 1;
    found_ += sure ? 1 : 0;
    if (tried_ == proof && 2 * found_ < proof) {
        pieces_.clear();
        astray_ = 1;
    }
}

void Registration::follow_gain(const cv::Mat &grey, Result &result) {
    const cv::Matx23d back(1, 0, -last_.x, 0, 1, -last_.y);
    cv::Mat placed;
    cv::warpAffine(grey, placed, back, grey.size(), cv::INTER_NEAREST, cv::BORDER_REPLICATE);
    placed.convertTo(placed, CV_32F); // rounded means of a dark picture would drift
    cv::Mat few;
    cv::resize(placed, few, cv::Size(light_columns, light_rows), 0, 0, cv::INTER_AREA);
    cv::Mat light;
    cv::log(few + 16.0, light);
    // The factor of the brightness; dark values would hide it behind the offset that keeps their noise small.
    cv::Mat factor;
    cv::log(few + 2.0, factor);
    if (!light_.bright.empty()) {
        const cv::Mat change = light - light_.bright;
        const float common = median_of({change.begin<float>(), change.end<float>()});
        const cv::Mat step = factor - light_.factor;
        const auto gain = static_cast<double>(median_of({step.begin<float>(), step.end<float>()}));
        const cv::Mat rest = cv::abs(change - common);
        result.gain_step = gain;
        result.change = 100 * cv::mean(rest)[0];
        light_.gain += gain;
    }
    light_.bright = std::move(light);
    light_.factor = std::move(factor);
    result.gain = light_.gain;
}

void Registration::hold() {
    held_ = true;
}

bool Registration::followed() const {
    return pieces_.size() >= least_pieces;
}

bool Registration::fits() const {
    constexpr float other_light = 0.16F; // from there on brightness alone makes a vehicle of road
    constexpr double most_other = 0.25;  // of the cells: somebody walks there, or leaves move
    if (!followed() || agreement_ < half_agree || known_.light.bright.empty()) {
        return false;
    }
    const cv::Mat change = light_.bright - known_.light.bright;
    std::vector<float> beside;
    for (int r = 0; r < change.rows; ++r) {
        for (int c = 0; c < change.cols; ++c) {
            if (beside_.at<uchar>(r, c) != 0) {
                beside.push_back(change.at<float>(r, c));
            }
        }
    }
    const float common = median_of(beside);
    const auto other = std::count_if(beside.begin(), beside.end(),
                                     [common](float cell) { return std::abs(cell - common) > other_light; });
    return static_cast<double>(other) <= most_other * static_cast<double>(beside.size());
}

double Registration::recover() {
    const cv::Mat step = light_.factor - known_.light.factor;
    light_.gain = known_.light.gain + static_cast<double>(median_of({step.begin<float>(), step.end<float>()}));
    held_ = false;
    return light_.gain;
}

void Registration::release() {
    held_ = false;
    light_.gain = 0;
}

Registration::Result Registration::follow(const cv::Mat &bgr) {
    constexpr int patience = 4;
    constexpr int again = 100;
    Result result;
    if (!held_) {
        known_ = {light_, last_};
    }
    cv::Mat grey;
    cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
    if (scale_ < 1.0) {
        cv::Mat shrunk;
        cv::resize(grey, shrunk, traffic_.size(), 0, 0, cv::INTER_AREA);
        grey = std::move(shrunk);
    }
    if (!followed()) {
        // A picture without corners cannot be followed; it is looked at again now and then.
        if (astray_++ % again == 0) {
            capture(grey);
        }
        result.sure = true;
        result.agreement = 1.0;
    } else {
        result.sure = vote(grey, search_px, result);
        astray_ += result.sure ? 0 : 1;
        if (!result.sure && astray_ > patience && astray_ % 4 == 0) {
            result.sure = vote(grey, wide_search_px, result);
        }
        if (!result.sure && held_) { // wherever a foreign picture has led to
            const cv::Point2d led = last_;
            last_ = known_.at;
            result.sure = vote(grey, search_px, result);
            last_ = result.sure ? last_ : led;
        }
        if (result.sure) {
            astray_ = 0;
        }
        if (!held_) {
            prove_pieces(result.sure);
            renew_pieces(grey, result);
        }
    }
    agreement_ = result.sure ? result.agreement : 0.0;
    follow_gain(grey, result);
    result.shift_px = last_ / scale_;
    return result;
}

} // namespace elmopp
