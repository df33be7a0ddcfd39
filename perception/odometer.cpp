// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "odometer.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
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

} // namespace

void Odometer::forget() {
    before_.release();
    still_s_ = 0;
    net_ = 1.0;
}

Odometer::Step Odometer::feed(const cv::Mat &change, const cv::Mat &object, float noise, double dt_s) {
    constexpr double still_after_s = 0.3;
    constexpr double net_tau_s = 0.4;
    constexpr std::size_t memory = 61;
    cv::Mat mask;
    object.convertTo(mask, CV_32F, 1.0 / 255);
    cv::Mat picture = change.mul(mask);
    cv::Mat few;
    cv::Mat few_mask;
    cv::resize(picture, few, cv::Size(columns, picture.rows), 0, 0, cv::INTER_AREA);
    cv::resize(mask, few_mask, cv::Size(columns, picture.rows), 0, 0, cv::INTER_AREA);
    step_ = Step{};
    const double here = cv::mean(few_mask)[0];
    if (!before_.empty() && here > least_object) {
        std::vector<double> fits(2 * search_rows + 1, 1e9);
        const auto fit_at = [&fits](int shift) -> double & {
            const int index = shift + search_rows;
            return fits[static_cast<std::size_t>(index)];
        };
        double whole = 0;
        misfit(few, few_mask, before_, before_mask_, 0, whole);
        int best = 0;
        for (int shift = -search_rows; shift <= search_rows; ++shift) {
            double weight = 0;
            const double fit = misfit(few, few_mask, before_, before_mask_, shift, weight);
            if (weight > 0.35 * whole) {
                fit_at(shift) = fit;
                if (fit < fit_at(best)) {
                    best = shift;
                }
            }
        }
        const double at_rest = fits[search_rows];
        const double fitting = fit_at(best);
        std::vector<double> known;
        std::copy_if(fits.begin(), fits.end(), std::back_inserter(known), [](double fit) { return fit < 1e8; });
        std::nth_element(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2), known.end());
        const double usual_fit = known[known.size() / 2];
        const bool quiet = at_rest < std::max(0.02, 1.6 * static_cast<double>(noise)) && at_rest < 0.5 * usual_fit;
        if (quiet || best == 0) {
            step_.sure = at_rest < clear_minimum * usual_fit;
            step_.rows = 0;
        } else if (fitting < clear_minimum * at_rest && fitting < clear_minimum * usual_fit) {
            step_.sure = true;
            step_.rows = best;
            if (best > -search_rows && best < search_rows) {
                const double left = fit_at(best - 1);
                const double right = fit_at(best + 1);
                const double bend = left - 2 * fitting + right;
                if (left < 1e8 && right < 1e8 && bend > 1e-9) {
                    step_.rows += std::clamp(0.5 * (left - right) / bend, -0.5, 0.5);
                }
            }
        }
        if (step_.sure && std::abs(step_.rows) < 0.3) {
            still_s_ += dt_s;
        } else if (step_.sure || at_rest > 3 * std::max(0.02, 1.6 * static_cast<double>(noise))) {
            still_s_ = 0;
        }
        step_.still = still_s_ > still_after_s;
        if (step_.sure && step_.rows > 0.7) {
            speeds_.push_back(step_.rows / dt_s);
            if (speeds_.size() > memory) {
                speeds_.pop_front();
            }
            std::vector<double> sorted(speeds_.begin(), speeds_.end());
            std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                             sorted.end());
            usual_ = sorted.size() >= 5 ? sorted[sorted.size() / 2] : 0.0;
        }
        if (step_.sure && usual_ > 0) {
            step_.progress = std::clamp(step_.rows / (usual_ * dt_s), -1.5, 2.0);
        }
        if (step_.still) {
            step_.progress = 0;
        }
    } else {
        still_s_ = 0;
    }
    net_ += (1 - std::exp(-dt_s / net_tau_s)) * (step_.progress - net_);
    step_.net = net_;
    before_ = std::move(few);
    before_mask_ = std::move(few_mask);
    return step_;
}

} // namespace elmopp
