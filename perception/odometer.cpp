// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "odometer.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace elmopp {
namespace {

constexpr int columns = 8;
constexpr int search_rows = 26;
constexpr double least_object = 0.06; ///< of the patch, or there is nothing to follow
constexpr double clear_minimum = 0.75;

/// Mean difference of the two pictures, the later one moved back by `shift` rows, where either shows an object.
double misfit(const cv::Mat &now, const cv::Mat &now_mask, const cv::Mat &old, const cv::Mat &old_mask, int shift,
              double &weight) {
    double sum = 0;
    weight = 0;
    const int from = std::max(0, shift);
    const int to = std::min(now.rows, now.rows + shift);
    for (int r = from; r < to; ++r) {
        const float *a = now.ptr<float>(r);
        const float *b = old.ptr<float>(r - shift);
        const float *m = now_mask.ptr<float>(r);
        const float *n = old_mask.ptr<float>(r - shift);
        for (int c = 0; c < now.cols; ++c) {
            const auto w = static_cast<double>(std::max(m[c], n[c]));
            sum += w * static_cast<double>(std::abs(a[c] - b[c]));
            weight += w;
        }
    }
    return weight > 0 ? sum / weight : 0.0;
}

/// The shift that fits best, in fractions of a row; unknown if it is not much better than the others.
struct Fit {
    double rows = 0.0;
    double at_rest = 0.0; ///< misfit of no shift at all
    bool sure = false;
    bool back = false; ///< it fits best backwards, but not so that it is sure how far
};

Fit best_fit(const cv::Mat &now, const cv::Mat &now_mask, const cv::Mat &old, const cv::Mat &old_mask, double quiet) {
    constexpr double least_overlap = 0.35;
    constexpr double unknown = 1e9;
    std::array<double, 2 * search_rows + 1> fits{};
    fits.fill(unknown);
    const auto at = [&fits](int shift) -> double & {
        const int index = shift + search_rows;
        return fits[static_cast<std::size_t>(index)];
    };
    double whole = 0;
    misfit(now, now_mask, old, old_mask, 0, whole);
    int best = 0;
    std::vector<double> known;
    for (int shift = -search_rows; shift <= search_rows; ++shift) {
        double weight = 0;
        const double fit = misfit(now, now_mask, old, old_mask, shift, weight);
        if (weight > least_overlap * whole) {
            at(shift) = fit;
            known.push_back(fit);
            best = fit < at(best) ? shift : best;
        }
    }
    Fit result;
    if (known.empty()) {
        return result;
    }
    std::nth_element(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2), known.end());
    const double usual = known[known.size() / 2];
    result.at_rest = at(0);
    if (best == 0 || (at(0) < quiet && at(0) < 0.5 * usual)) {
        result.sure = at(0) < clear_minimum * usual;
    } else if (at(best) < clear_minimum * at(0) && at(best) < clear_minimum * usual) {
        result.sure = true;
        result.rows = best;
        if (best > -search_rows && best < search_rows) {
            const double bend = at(best - 1) - 2 * at(best) + at(best + 1);
            if (at(best - 1) < unknown && at(best + 1) < unknown && bend > 1e-9) {
                result.rows += std::clamp(0.5 * (at(best - 1) - at(best + 1)) / bend, -0.5, 0.5);
            }
        }
    }
    result.back = !result.sure && best < 0 && at(best) < clear_minimum * usual;
    return result;
}

} // namespace

void Odometer::forget() {
    before_.release();
    still_s_ = 0;
    net_ = 1.0;
}

/// What has moved by `rows` in the time since the last key is a speed.
void Odometer::learn_speed(double rows) {
    constexpr std::size_t memory = 61;
    constexpr std::size_t least = 5;
    constexpr double least_rows = 0.7;
    if (rows < least_rows) {
        return;
    }
    speeds_.push_back(rows / age_s_);
    if (speeds_.size() > memory) {
        speeds_.pop_front();
    }
    std::vector<double> sorted(speeds_.begin(), speeds_.end());
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
    usual_ = sorted.size() >= least ? sorted[sorted.size() / 2] : 0.0;
}

/// How far since the last frame; returns whether this picture is the next key.
bool Odometer::measure(const cv::Mat &few, const cv::Mat &few_mask, float noise, double dt_s) {
    constexpr double still_after_s = 0.3;
    constexpr double oldest_s = 0.25;
    constexpr double enough_rows = 1.5;
    constexpr double still_rows = 0.3;
    age_s_ += dt_s;
    const double quiet = std::max(0.02, 1.6 * static_cast<double>(noise));
    const Fit fit = best_fit(few, few_mask, before_, before_mask_, quiet);
    step_.sure = fit.sure;
    if (fit.sure) {
        step_.rows = fit.rows - told_;
        told_ = fit.rows;
    }
    if (fit.sure && std::abs(step_.rows) < still_rows) {
        still_s_ += dt_s;
    } else if (fit.sure || fit.at_rest > 3 * quiet) {
        still_s_ = 0;
    }
    step_.still = still_s_ > still_after_s;
    const bool next = !fit.sure || std::abs(fit.rows) > enough_rows || age_s_ + dt_s / 2 > oldest_s;
    if (fit.sure && next) {
        learn_speed(fit.rows);
    }
    if (fit.sure && usual_ > 0) {
        step_.progress = std::clamp(step_.rows / (usual_ * dt_s), -1.5, 2.0);
    }
    if (fit.back) {
        step_.progress = -1.0;
    }
    if (step_.still) {
        step_.progress = 0;
    }
    return next;
}

Odometer::Step Odometer::feed(const cv::Mat &change, const cv::Mat &object, float noise, double dt_s) {
    constexpr double net_tau_s = 0.4;
    cv::Mat mask;
    object.convertTo(mask, CV_32F, 1.0 / 255);
    const cv::Mat picture = change.mul(mask);
    cv::Mat few;
    cv::Mat few_mask;
    cv::resize(picture, few, cv::Size(columns, picture.rows), 0, 0, cv::INTER_AREA);
    cv::resize(mask, few_mask, cv::Size(columns, picture.rows), 0, 0, cv::INTER_AREA);
    step_ = Step{};
    bool next = true;
    if (!before_.empty() && cv::mean(few_mask)[0] > least_object) {
        next = measure(few, few_mask, noise, dt_s);
    } else {
        still_s_ = 0;
    }
    net_ += (1 - std::exp(-dt_s / net_tau_s)) * (step_.progress - net_);
    step_.net = net_;
    if (next) {
        before_ = std::move(few);
        before_mask_ = std::move(few_mask);
        age_s_ = 0;
        told_ = 0;
    }
    return step_;
}

} // namespace elmopp
