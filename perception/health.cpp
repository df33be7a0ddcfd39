// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "health.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace elmopp {
namespace {

constexpr int small_width_px = 160;
constexpr int cell_columns = 8;
constexpr int cell_rows = 6;
constexpr double said_after_s = 0.8; ///< a fault that lasts is said
constexpr double moved_after_s = 2.0;
constexpr double clear_after_s = 1.0; ///< ... and over when it has been good for so long

} // namespace

Health::Health(const cv::Mat &traffic) {
    cv::resize(traffic, cells_traffic_, cv::Size(cell_columns, cell_rows), 0, 0, cv::INTER_AREA);
}

bool Health::is_frozen(const cv::Mat &grey, double dt_s) {
    constexpr std::size_t memory = 500;
    constexpr double frozen_after_s = 0.6;
    constexpr double repeats_s = 5.0;
    if (before_.empty()) {
        before_ = grey;
        return false;
    }
    const double difference = cv::norm(grey, before_, cv::NORM_L1) / static_cast<double>(grey.total());
    before_ = grey;
    double usual = 0;
    if (noise_.size() > 20) {
        std::vector<double> sorted(noise_.begin(), noise_.end());
        const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 10);
        std::nth_element(sorted.begin(), at, sorted.end());
        usual = *at;
    }
    const bool same = usual > 0 ? difference < 0.15 * usual : difference <= 0;
    if (same) {
        same_s_ += dt_s;
    } else {
        if (fault_ == Reason::ok) {
            longest_same_s_ = std::max(longest_same_s_, same_s_);
        }
        same_s_ = 0;
    }
    const double limit_s =
        usual > 0 ? std::max(frozen_after_s, 2 * longest_same_s_) : std::max(repeats_s, 4 * longest_same_s_);
    const bool frozen = same_s_ > limit_s;
    if (fault_ == Reason::ok && !frozen) {
        noise_.push_back(difference);
        if (noise_.size() > memory) {
            noise_.pop_front();
        }
    }
    return frozen;
}

/// Texture of the parts of the picture beside what is usual there: all gone is blurred, some gone is covered.
Reason Health::judge_texture(const cv::Mat &grey, double dt_s) {
    constexpr float gone = 0.35F;
    constexpr float least = 0.012F;
    constexpr double most_gone = 0.8;
    constexpr double some_gone = 0.33;
    constexpr double memory_s = 60.0;
    constexpr double first_s = 2.0;
    cv::Mat light;
    grey.convertTo(light, CV_32F, 1.0, 16.0);
    cv::log(light, light);
    cv::Mat smooth;
    cv::blur(light, smooth, cv::Size(3, 3));
    cv::Mat texture = cv::abs(light - smooth);
    cv::resize(texture, texture, cv::Size(cell_columns, cell_rows), 0, 0, cv::INTER_AREA);
    if (usual_texture_.empty()) {
        usual_texture_ = texture.clone();
        return Reason::ok;
    }
    int judged = 0;
    int missing = 0;
    for (int r = 0; r < cell_rows; ++r) {
        for (int c = 0; c < cell_columns; ++c) {
            const float usual = usual_texture_.at<float>(r, c);
            if (usual < least || cells_traffic_.at<uchar>(r, c) > 160) {
                continue;
            }
            ++judged;
            missing += texture.at<float>(r, c) < gone * usual ? 1 : 0;
        }
    }
    const double share = judged < 4 ? 0.0 : static_cast<double>(missing) / judged;
    if (share > some_gone) {
        return share > most_gone ? Reason::blurred : Reason::covered;
    }
    if (share < 0.1) {
        const double rate = 1 - std::exp(-dt_s / (good_total_s_ < first_s ? first_s : memory_s));
        usual_texture_ += rate * (texture - usual_texture_);
    }
    return Reason::ok;
}

Reason Health::judge(const cv::Mat &grey, double dt_s) {
    constexpr double black_grey = 14.0;
    constexpr double white_grey = 225.0;
    constexpr double flat = 12.0;
    constexpr double without_anything = 0.6; // a dark street has its lamps and their light
    cv::Scalar mean;
    cv::Scalar deviation;
    cv::meanStdDev(grey, mean, deviation);
    const bool frozen = is_frozen(grey, dt_s);
    if (mean[0] < black_grey) {
        cv::Mat coarse; // without the sensor's noise
        cv::resize(grey, coarse, cv::Size(cell_columns * 5, cell_rows * 5), 0, 0, cv::INTER_AREA);
        cv::Scalar unused;
        cv::Scalar structure;
        cv::meanStdDev(coarse, unused, structure);
        if (structure[0] < without_anything) {
            return Reason::black;
        }
    }
    if (mean[0] > white_grey && deviation[0] < flat) {
        return Reason::white;
    }
    const Reason texture = judge_texture(grey, dt_s);
    if (texture != Reason::ok) {
        return texture;
    }
    return frozen ? Reason::frozen : Reason::ok;
}

void Health::settle(Reason seen, double dt_s) {
    if (seen == Reason::ok) {
        good_total_s_ += dt_s;
        candidate_ = Reason::ok;
        candidate_s_ = 0;
        good_s_ += dt_s;
        if (good_s_ >= clear_after_s && fault_ != Reason::moved) {
            fault_ = Reason::ok;
        }
        return;
    }
    good_s_ = 0;
    candidate_s_ = candidate_ == seen ? candidate_s_ + dt_s : 0.0;
    candidate_ = seen;
    if (candidate_s_ >= said_after_s || fault_ != Reason::ok) {
        fault_ = seen;
    }
}

bool Health::look(const cv::Mat &bgr, double dt_s) {
    cv::Mat grey;
    const double scale = std::min(1.0, static_cast<double>(small_width_px) / bgr.cols);
    cv::resize(bgr, grey, cv::Size(), scale, scale, cv::INTER_AREA);
    cv::cvtColor(grey, grey, cv::COLOR_BGR2GRAY);
    const Reason seen = judge(grey, dt_s);
    settle(seen, dt_s);
    return seen == Reason::ok;
}

void Health::placed(double shift_px, bool sure, double dt_s) {
    const bool wrong = !sure || shift_px > moved_px;
    astray_s_ = wrong == placed_wrong_ ? astray_s_ + dt_s : 0.0;
    placed_wrong_ = wrong;
    if (wrong && astray_s_ > moved_after_s && fault_ == Reason::ok) {
        fault_ = Reason::moved;
    }
    if (!wrong && astray_s_ > clear_after_s && fault_ == Reason::moved) {
        fault_ = Reason::ok;
    }
}

void Health::nothing(double for_s) {
    constexpr double lost_after_s = 1.0;
    if (for_s > lost_after_s) {
        fault_ = Reason::lost;
        good_s_ = 0;
        candidate_ = Reason::ok;
    }
}

} // namespace elmopp
