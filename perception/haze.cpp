// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "haze.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace elmopp {
namespace {

constexpr int small_width_px = 320;
constexpr double judged_after_s = 1.0;
constexpr double tau_s = 10.0;
constexpr double offset = 16.0; ///< grey values, of the logarithm
constexpr double usual = 0.2;   ///< high-pass of the logarithm that three in a hundred pixels of a clear picture exceed
constexpr double edges = 0.97;
constexpr double usual_depth = 0.55; ///< how far below its middle the dark of a clear picture lies, of the middle
constexpr double darkest = 0.02;
constexpr double least = 0.3;

double share_of(std::vector<float> values, double share) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return static_cast<double>(*at);
}

/// The dark of a picture, in its darkest colour: a light thing of one colour lacks another.
double dark_of(const cv::Mat &bgr, double scale) {
    cv::Mat few;
    cv::resize(bgr, few, cv::Size(), scale, scale, cv::INTER_AREA);
    const cv::Mat pixels = few.reshape(1, static_cast<int>(few.total()));
    cv::Mat least_colour;
    cv::reduce(pixels, least_colour, 1, cv::REDUCE_MIN);
    return offset + share_of({least_colour.begin<uchar>(), least_colour.end<uchar>()}, darkest);
}

/// Two signs of haze, each as a share of what is usual; the picture is as clear as the lesser. Edges are weak: the
/// high-pass of the logarithm, 7 x 7, that all but few pixels stay below. And nothing is dark: between the eye and
/// everything there is light.
double clearness_of(const cv::Mat &bgr) {
    cv::Mat grey;
    cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
    const double scale = std::min(1.0, static_cast<double>(small_width_px) / grey.cols);
    cv::resize(grey, grey, cv::Size(), scale, scale, cv::INTER_AREA);
    cv::Mat light;
    grey.convertTo(light, CV_32F, 1.0, offset);
    const double middle = share_of({light.begin<float>(), light.end<float>()}, 0.5);
    const double depth = (middle - dark_of(bgr, scale)) / middle;
    cv::log(light, light);
    cv::Mat smooth;
    cv::blur(light, smooth, cv::Size(7, 7));
    const cv::Mat rest = cv::abs(light - smooth);
    const double structure = share_of({rest.begin<float>(), rest.end<float>()}, edges);
    return std::min(structure / usual, depth / usual_depth);
}

} // namespace

double Haze::follow(const cv::Mat &bgr, double dt_s) {
    since_s_ += dt_s;
    if (known_ && since_s_ < judged_after_s) {
        return clear_;
    }
    const double now = std::clamp(clearness_of(bgr), least, 1.0);
    clear_ = known_ ? clear_ + (1 - std::exp(-since_s_ / tau_s)) * (now - clear_) : now;
    since_s_ = 0;
    known_ = true;
    return clear_;
}

} // namespace elmopp
