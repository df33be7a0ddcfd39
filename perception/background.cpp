// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "background.hpp"

#include "patch.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace elmopp {
namespace {

constexpr float log_offset = 16.0F;
constexpr float colour_limit = 0.15F;
constexpr float bright_limit = 0.16F;
constexpr float dark_limit = -1.3F;

constexpr float normal_median = 0.6745F * 1.414F; ///< of the difference of two pictures, in deviations of one
constexpr float least_noise = 0.004F;
constexpr float most_noise = 0.05F;
constexpr float unknown_noise = 0.015F;
constexpr double noise_tau_s = 5.0;
constexpr double noise_quantile = 0.35;
constexpr float normal_quantile = 0.4538F * 1.414F;
constexpr double grain_pace = 2.5; ///< near its quantile a pixel's noise then follows in about noise_tau_s

int lengths(double lane_widths) {
    return std::max(1, static_cast<int>(std::lround(lane_widths * patch_unit)));
}

int odd(double lane_widths) {
    return 2 * (lengths(lane_widths) / 2) + 1;
}

/// The logarithm of a grey value in the light of the road as it was learnt.
cv::Mat log_table(double gain) {
    const double brighter = std::exp(-gain);
    cv::Mat filled(1, 256, CV_32F);
    for (int i = 0; i < 256; ++i) {
        filled.at<float>(i) = static_cast<float>(std::log(i * brighter + static_cast<double>(log_offset)));
    }
    return filled;
}

cv::Mat box(const cv::Mat &of, int size) {
    cv::Mat mean;
    cv::blur(of, mean, cv::Size(size, size));
    return mean;
}

cv::Mat high_pass(const cv::Mat &of, int size) {
    return cv::abs(of - box(of, size));
}

float quantile(const cv::Mat &of, const cv::Mat &where, double share) {
    std::vector<float> values;
    values.reserve(of.total());
    for (int r = 0; r < of.rows; ++r) {
        const float *value = of.ptr<float>(r);
        const uchar *counts = where.empty() ? nullptr : where.ptr<uchar>(r);
        for (int c = 0; c < of.cols; ++c) {
            if (counts == nullptr || counts[c] != 0) {
                values.push_back(value[c]);
            }
        }
    }
    if (values.empty()) {
        return 0.0F;
    }
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// Of each pixel over several pictures.
cv::Mat median_over(const std::vector<cv::Mat> &pictures) {
    cv::Mat median(pictures.front().size(), CV_32F);
    std::vector<float> values(pictures.size());
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    for (int r = 0; r < median.rows; ++r) {
        for (int c = 0; c < median.cols; ++c) {
            std::transform(pictures.begin(), pictures.end(), values.begin(),
                           [r, c](const cv::Mat &picture) { return picture.at<float>(r, c); });
            std::nth_element(values.begin(), middle, values.end());
            median.at<float>(r, c) = *middle;
        }
    }
    return median;
}

/// What a vehicle's outline encloses is the vehicle: a roof without edges.
void fill_holes(cv::Mat &mask) {
    constexpr double largest = 0.6; // lane widths squared
    const cv::Mat outside_in = ~mask;
    cv::Mat labels;
    cv::Mat stats;
    cv::Mat middles;
    const int many = cv::connectedComponentsWithStats(outside_in, labels, stats, middles, 4, CV_32S);
    for (int i = 1; i < many; ++i) {
        const cv::Rect box(stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
                           stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT));
        const bool inside = box.x > 0 && box.y > 0 && box.br().x < mask.cols && box.br().y < mask.rows;
        if (inside && stats.at<int>(i, cv::CC_STAT_AREA) < largest * patch_unit * patch_unit) {
            mask.setTo(255, labels == i);
        }
    }
}

/// Mean of the shortest stretch of sorted values that holds `share` of them, and where it begins.
std::pair<std::size_t, std::size_t> densest(const std::vector<std::pair<float, std::size_t>> &sorted, double share) {
    const auto many = std::max<std::size_t>(1, static_cast<std::size_t>(share * static_cast<double>(sorted.size())));
    std::size_t best = 0;
    float narrow = 1e9F;
    for (std::size_t i = 0; i + many <= sorted.size(); ++i) {
        const float width = sorted[i + many - 1].first - sorted[i].first;
        if (width < narrow) {
            narrow = width;
            best = i;
        }
    }
    return {best, many};
}

} // namespace

Background::Background(cv::Mat valid, const Settings &settings) : valid_(std::move(valid)), settings_(settings) {
    still_s_ = cv::Mat::zeros(valid_.size(), CV_32F);
    grain_ = cv::Mat(valid_.size(), CV_32F, cv::Scalar(noise_));
}

void Background::logarithms(const Sample &sample, Seen &seen) {
    const cv::Mat table = log_table(sample.gain);
    cv::Mat grey;
    cv::cvtColor(sample.patch, grey, cv::COLOR_BGR2GRAY);
    cv::LUT(grey, table, seen.light);
    seen.gain = sample.gain;
    cv::Mat all;
    cv::LUT(sample.patch, table, all);
    std::array<cv::Mat, 3> planes;
    cv::split(all, planes.data());
    seen.red = planes[2] - planes[1];
    seen.blue = planes[0] - planes[1];
}

void Background::assume(const Sample &sample) {
    Seen seen;
    logarithms(sample, seen);
    light_ = seen.light;
    red_ = seen.red;
    blue_ = seen.blue;
    before_ = seen.light.clone();
    judge_road();
}

void Background::learn(const std::vector<Sample> &samples) {
    begin(samples);
    int all = std::numeric_limits<int>::max();
    learn_more(all);
}

void Background::begin(const std::vector<Sample> &samples) {
    constexpr std::size_t most = 36;
    Lesson lesson;
    lesson.samples = samples;
    lesson.views.resize(std::min(most, samples.size()));
    for (cv::Mat *plane : {&lesson.light, &lesson.red, &lesson.blue}) {
        plane->create(valid_.size(), CV_32F);
    }
    lesson_ = std::move(lesson);
}

bool Background::learn_more(int &pixels) {
    while (lesson_ && pixels > 0) {
        if (lesson_->row < valid_.rows) {
            learn_row(*lesson_);
            pixels -= valid_.cols;
            continue;
        }
        light_ = lesson_->light;
        red_ = lesson_->red;
        blue_ = lesson_->blue;
        gain_ = lesson_->samples.back().gain;
        learn_noise(lesson_->samples);
        before_.release();
        crept_.release();
        still_s_.setTo(0);
        judge_road();
        learnt_ = true;
        lesson_.reset();
    }
    return !lesson_;
}

/// The mode of each pixel of the next row.
void Background::learn_row(Lesson &lesson) const {
    constexpr double mode_share = 0.4;
    const std::vector<Sample> &samples = lesson.samples;
    std::vector<Seen> &views = lesson.views;
    const std::size_t many = views.size();
    for (std::size_t i = 0; i < many && lesson.row == 0; ++i) {
        logarithms(samples[i * (samples.size() - 1) / std::max<std::size_t>(1, many - 1)], views[i]);
    }
    std::vector<std::pair<float, std::size_t>> sorted(many);
    const int r = lesson.row++;
    for (int c = 0; c < valid_.cols; ++c) {
        for (std::size_t i = 0; i < many; ++i) {
            sorted[i] = {views[i].light.at<float>(r, c), i};
        }
        std::sort(sorted.begin(), sorted.end());
        const auto [first, count] = densest(sorted, mode_share);
        cv::Vec3f sum(0, 0, 0);
        for (std::size_t i = first; i < first + count; ++i) {
            const Seen &view = views[sorted[i].second];
            sum += cv::Vec3f(view.light.at<float>(r, c), view.red.at<float>(r, c), view.blue.at<float>(r, c));
        }
        sum /= static_cast<float>(count);
        lesson.light.at<float>(r, c) = sum[0];
        lesson.red.at<float>(r, c) = sum[1];
        lesson.blue.at<float>(r, c) = sum[2];
    }
}

/// From frames that follow one another: what moves is in the minority.
void Background::learn_noise(const std::vector<Sample> &samples) {
    constexpr std::size_t pairs = 10;
    std::vector<cv::Mat> steps;
    std::vector<float> usual;
    Seen one;
    Seen two;
    for (std::size_t i = 1; i < samples.size(); i += std::max<std::size_t>(1, samples.size() / pairs)) {
        logarithms(samples[i - 1], one);
        logarithms(samples[i], two);
        steps.push_back(cv::abs(two.light - one.light));
        usual.push_back(quantile(steps.back(), valid_, 0.5));
    }
    std::sort(usual.begin(), usual.end());
    const float typical = usual.empty() ? unknown_noise * normal_median : usual[usual.size() / 2];
    noise_ = std::clamp(typical / normal_median, least_noise, most_noise);
    grain_.setTo(noise_);
    if (!steps.empty()) {
        grain_ = box(median_over(steps) / normal_median, 3); // few pairs, but neighbours are alike
        cv::max(grain_, least_noise, grain_);
        cv::min(grain_, most_noise, grain_);
    }
}

/// Of all pixels, not of the road's alone: noise that has grown makes road look like something else. `share`: of the
/// way to what the noise is now, taken with this step.
void Background::follow_noise(const cv::Mat &step, double share) {
    const float now = std::clamp(quantile(step, valid_, noise_quantile) / normal_quantile, least_noise, most_noise);
    noise_ += static_cast<float>(share) * (now - noise_);
    // Each pixel by itself: up and down by so much that both come to nothing at the quantile.
    const auto up = static_cast<float>(std::exp(grain_pace * share * noise_quantile));
    const auto down = static_cast<float>(std::exp(-grain_pace * share * (1 - noise_quantile)));
    for (int r = 0; r < grain_.rows; ++r) {
        auto *grain = grain_.ptr<float>(r);
        const auto *moved = step.ptr<float>(r);
        for (int c = 0; c < grain_.cols; ++c) {
            const float factor = moved[c] > normal_quantile * grain[c] ? up : down;
            grain[c] = std::clamp(grain[c] * factor, least_noise, most_noise);
        }
    }
}

void Background::rebase(double gain) {
    const float factor = static_cast<float>(std::exp(gain));
    for (int r = 0; r < light_.rows; ++r) {
        for (int c = 0; c < light_.cols; ++c) {
            const float grey = std::max(0.0F, std::exp(light_.at<float>(r, c)) - log_offset);
            light_.at<float>(r, c) = std::log(grey * factor + log_offset);
        }
    }
    before_.release();
    gain_ = 0;
}

void Background::judge_road() {
    constexpr double day_grey = 60.0;
    constexpr double light_grey = 75.0;
    const double learnt =
        std::exp(static_cast<double>(quantile(light_, valid_, 0.5))) - static_cast<double>(log_offset);
    grey_ = learnt * std::exp(gain_);
    day_ = grey_ > day_grey;
    const float sharp =
        quantile(high_pass(light_, 3), valid_, 0.9) / std::max(1e-6F, quantile(high_pass(light_, 7), valid_, 0.9));
    fine_ = sharp > 0.36F && noise_ < 0.018F && grey_ > light_grey ? 3 : 7;
}

cv::Mat Background::road_texture() const {
    return high_pass(light_, 7);
}

/// Edges of the dark: lamps, bumpers and windows are sharp somewhere, the rim of a cone of light is nowhere.
cv::Mat Background::beside_sharp(const cv::Mat &texture, const cv::Mat &change) const {
    constexpr float sharp_limit = 0.07F;
    constexpr int firm_share = 85; // of 255
    cv::Mat near = high_pass(change, 3) > std::max(sharp_limit, 3 * noise_);
    near &= valid_;
    // Noise has single ones.
    cv::Mat firm;
    cv::boxFilter(near, firm, CV_8U, cv::Size(3, 3));
    near = firm > firm_share;
    cv::dilate(near, near, cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(odd(0.5), odd(0.5))));
    return texture & near;
}

Background::Seen Background::look(const Sample &sample) {
    constexpr float plain_bright = 0.40F;
    Seen seen;
    logarithms(sample, seen);
    cv::Mat change = seen.light - light_;
    const float clear =
        day_ ? static_cast<float>(sample.clear) : 1.0F; // at night little is light, and all of it counts
    const cv::Mat texture_limit = cv::max(2.5 * grain_, settings_.texture * static_cast<double>(clear));
    cv::Mat texture = high_pass(change, fine_) > texture_limit;
    texture &= valid_;
    const cv::Mat plain = ~texture & valid_;
    const float common = cv::countNonZero(plain) > 20 ? quantile(change, plain, 0.5) : 0.0F;
    change -= common;
    seen.change = change;
    const cv::Mat red_change = cv::abs(seen.red - red_);
    const cv::Mat blue_change = cv::abs(seen.blue - blue_);
    const cv::Mat colour = cv::max(red_change, blue_change);
    cv::Mat may = texture | (colour > colour_limit * clear) | (change < dark_limit * clear);
    if (day_) {
        may |= change > bright_limit * clear;
    }
    cv::Mat density;
    (day_ ? texture : beside_sharp(texture, change)).convertTo(density, CV_32F, 1.0 / 255);
    cv::Mat sure = box(density, odd(0.28)) > settings_.density;
    if (day_) {
        sure |= change > plain_bright * clear;
        // A light or coloured roof that is smooth, beside what is sure to be a vehicle; a patch of sun has none at its
        // rim, and a shadow no colour of its own.
        cv::Mat near;
        cv::dilate(sure & may, near, cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(odd(0.6), odd(0.6))));
        sure |= near & ((change > bright_limit * clear) | (colour > colour_limit * clear));
    }
    seen.object = may & sure & valid_;
    const cv::Mat close = cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(odd(0.15), odd(0.15)));
    const cv::Mat open = cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(odd(0.20), odd(0.20)));
    cv::morphologyEx(seen.object, seen.object, cv::MORPH_CLOSE, close);
    cv::morphologyEx(seen.object, seen.object, cv::MORPH_OPEN, open);
    fill_holes(seen.object);
    if (!sample.objects.empty()) {
        seen.object = sample.objects & valid_;
    }
    seen.candidate =
        (texture | (cv::abs(change) > bright_limit * clear) | (colour > 0.10F * clear) | seen.object) & valid_;
    // Rows that a vehicle covers, also one between two lanes.
    cv::Mat width;
    seen.object.convertTo(width, CV_32F, 1.0 / 255);
    cv::Mat window;
    cv::boxFilter(width, window, CV_32F, cv::Size(patch_unit, 1), cv::Point(-1, -1), true, cv::BORDER_CONSTANT);
    cv::Mat widest;
    cv::reduce(window, widest, 1, cv::REDUCE_MAX);
    seen.covered = widest > 0.35F;
    return seen;
}

cv::Mat Background::ghosts(const Seen &seen, double ghost_s) const {
    const int area = odd(0.5);
    const cv::Mat here = box(high_pass(seen.light, 3), area);
    const cv::Mat road = box(high_pass(light_, 3), area);
    cv::Mat ghost = (seen.object != 0) & (still_s_ >= ghost_s) & (here < 0.7 * road);
    return ghost;
}

/// What became an object while nothing moved there is no vehicle: light that has crept on.
void Background::follow_crept(const Seen &seen) {
    constexpr double still_s = 0.5;
    if (crept_.empty()) {
        crept_ = cv::Mat::zeros(valid_.size(), CV_8U);
        object_before_ = seen.object.clone();
    }
    const cv::Mat still = still_s_ > still_s;
    crept_ |= seen.object & ~object_before_ & still;
    crept_ &= seen.object & still;
    object_before_ = seen.object.clone();
}

void Background::renew(const Seen &seen, double dt_s, const cv::Mat &held, double ghost_s) {
    constexpr double quiet_tau_s = 1.5;
    constexpr double shade_tau_s = 8.0;
    constexpr double speck_tau_s = 0.5;
    constexpr double speck_s = 0.3;
    constexpr double ghost_rate = 0.25;
    constexpr double crept_tau_s = 1.0;
    constexpr int most_firm = 76; // of 255
    const auto rate = [dt_s](double tau_s) { return 1.0 - std::exp(-dt_s / tau_s); };
    if (!before_.empty()) {
        const cv::Mat step = cv::abs(seen.light - before_);
        const cv::Mat quiet = step < cv::max(3 * grain_, 0.03);
        follow_noise(step, rate(noise_tau_s));
        still_s_ += dt_s;
        still_s_.setTo(0, ~quiet);
    }
    before_ = seen.light;
    cv::Mat rates(valid_.size(), CV_32F, cv::Scalar(rate(quiet_tau_s)));
    rates.setTo(rate(shade_tau_s), seen.candidate);
    cv::Mat near;
    const cv::Mat around = cv::getStructuringElement(cv::MORPH_RECT, cv::Size(odd(0.4), odd(0.4)));
    cv::dilate(seen.object, near, around);
    rates.setTo(0, near);
    follow_crept(seen);
    const cv::Mat specks = (seen.object != 0) & (still_s_ >= speck_s);
    rates.setTo(rate(speck_tau_s), specks);
    for (int r = 0; r < rates.rows; ++r) {
        if (seen.covered.at<uchar>(r) != 0 || (!held.empty() && held.at<uchar>(r) != 0)) {
            rates.row(r).setTo(0);
        }
    }
    cv::Mat firm;
    cv::boxFilter(seen.object & ~crept_, firm, CV_8U, cv::Size(odd(0.4), odd(0.4)));
    rates.setTo(rate(crept_tau_s), crept_ & (firm < most_firm));
    rates.setTo(ghost_rate, ghosts(seen, ghost_s));
    rates.setTo(0, ~valid_);
    // Towards the picture without its gain; `light` still holds what is common to all of the patch, and must.
    judged_s_ += dt_s;
    if (judged_s_ > 1.0) {
        judged_s_ = 0;
        gain_ = seen.gain;
        judge_road();
    }
    light_ += rates.mul(seen.light - light_);
    red_ += rates.mul(seen.red - red_);
    blue_ += rates.mul(seen.blue - blue_);
}

} // namespace elmopp
