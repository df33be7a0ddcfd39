// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "overlay.hpp"

#include "error.hpp"

#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace elmopp {
namespace {

std::string ending_of(const std::string &file) {
    return std::filesystem::path(file).extension().string();
}

} // namespace

Overlay::Overlay(std::string file) : file_(std::move(file)) {
    const std::string ending = ending_of(file_);
    video_ = ending == ".avi" || ending == ".mp4";
    if (!video_ && ending != ".png" && ending != ".jpg") {
        throw BadRequest("--overlay " + file_ + ": right would be a file that ends with .avi, .mp4, .png or .jpg");
    }
    const std::filesystem::path folder = std::filesystem::absolute(file_).parent_path();
    if (!std::filesystem::is_directory(folder)) {
        throw BadRequest("--overlay " + file_ + ": its folder is not there");
    }
}

bool Overlay::wants(double t_s) {
    constexpr double apart_s = 1.0 / 16.0;
    constexpr double rounding_s = 1e-3;
    if (video_ && wanted_s_ && t_s - *wanted_s_ < apart_s - rounding_s) {
        return false;
    }
    wanted_s_ = t_s;
    return true;
}

void Overlay::add(const cv::Mat &bgr, double t_s) {
    if (!video_) {
        last_ = bgr;
        return;
    }
    if (!writer_.isOpened()) {
        if (last_.empty()) { // the rate is known with the second frame
            last_ = bgr;
            before_s_ = t_s;
            return;
        }
        constexpr double slowest = 1.0;
        constexpr double fastest = 120.0;
        const double rate = std::clamp(1.0 / std::max(1e-3, t_s - before_s_), slowest, fastest);
        constexpr double quality = 75; // of 100; the usual 95 takes twice the time and is no clearer to a person
        const bool avi = ending_of(file_) == ".avi";
        const int code =
            avi ? cv::VideoWriter::fourcc('M', 'J', 'P', 'G') : cv::VideoWriter::fourcc('m', 'p', '4', 'v');
        if (!writer_.open(file_, avi ? cv::CAP_OPENCV_MJPEG : cv::CAP_ANY, code, rate, bgr.size())) {
            throw Failure("--overlay " + file_ + ": cannot be written");
        }
        writer_.set(cv::VIDEOWRITER_PROP_QUALITY, quality);
        writer_.write(last_);
    }
    writer_.write(bgr);
}

void Overlay::finish() {
    writer_.release();
    if (!video_ && !last_.empty() && !cv::imwrite(file_, last_)) {
        throw Failure("--overlay " + file_ + ": cannot be written");
    }
}

} // namespace elmopp
