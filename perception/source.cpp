// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "source.hpp"

#include "error.hpp"
#include "pipeline.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <initializer_list>
#include <optional>

namespace elmopp {
namespace {

bool begins_with(const std::string &text, const std::string &with) {
    return text.compare(0, with.size(), with) == 0;
}

/// What comes after the first of these starts that it has; none: it has none of them.
std::optional<std::string> after(const std::string &text, std::initializer_list<const char *> starts) {
    for (const std::string start : starts) {
        if (begins_with(text, start)) {
            return text.substr(start.size());
        }
    }
    return std::nullopt;
}

/// The host of USER:PASSWORD@HOST:PORT/PATH.
std::string host_of(const std::string &place) {
    const std::string authority = place.substr(0, place.find_first_of("/?#"));
    const std::size_t at = authority.rfind('@');
    const std::string there = at == std::string::npos ? authority : authority.substr(at + 1);
    return there.substr(0, there.find(':', there.find(']') == std::string::npos ? 0 : there.find(']')));
}

/// What is wrong with a live source that no waiting mends, and what would be right; empty: it may come to life.
std::string why_never(const std::string &source) {
    if (const auto number = after(source, {"v4l2:", "/dev/video"})) {
        const bool whole = !number->empty() && std::all_of(number->begin(), number->end(),
                                                           [](unsigned char c) { return std::isdigit(c) != 0; });
        return whole ? "" : "is no device; right would be v4l2:N or /dev/videoN with a number, as v4l2:0";
    }
    if (const auto place = after(source, {"rtsp://", "rtsps://", "http://", "https://"})) {
        return host_of(*place).empty() ? "names no host; right would be as rtsp://camera/stream" : "";
    }
    if (const auto place = after(source, {"udp://"})) { // without a host it listens
        return place->find(':') == std::string::npos ? "names no port; right would be as udp://@:5000" : "";
    }
    if (const auto pipeline = after(source, {"gst:"})) {
        const std::string wrong = pipeline_fault(*pipeline);
        return wrong.empty() ? "" : wrong + "; right would be gst:PIPELINE ! appsink";
    }
    return "";
}

std::string possible(std::string source) {
    const std::string wrong = why_never(source);
    if (!wrong.empty()) {
        throw BadRequest("--source " + told_source(source) + ": " + wrong);
    }
    return source;
}

} // namespace

std::string told_source(const std::string &source) {
    const std::size_t place = source.find("://");
    const std::size_t end = source.find_first_of("/?#", place == std::string::npos ? place : place + 3);
    const std::size_t at = source.substr(0, end).rfind('@');
    const bool secret = is_live(source) && place != std::string::npos && at != std::string::npos && at > place + 3;
    return secret ? source.substr(0, place + 3) + "..." + source.substr(at) : source;
}

void NewestFrame::put(Frame frame) {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        dropped_ += there_ ? 1 : 0;
        frame_ = std::move(frame);
        there_ = true;
    }
    came_.notify_one();
}

bool NewestFrame::take(Frame &frame, std::chrono::steady_clock::time_point until) {
    std::unique_lock<std::mutex> lock(mutex_);
    if (!came_.wait_until(lock, until, [this] { return there_; })) {
        return false;
    }
    frame = std::move(frame_);
    there_ = false;
    return true;
}

bool is_live(const std::string &source) {
    for (const char *start : {"rtsp://", "rtsps://", "http://", "https://", "udp://", "gst:", "v4l2:", "/dev/video"}) {
        if (begins_with(source, start)) {
            return true;
        }
    }
    return false;
}

VideoFile::VideoFile(const std::string &file) {
    if (!std::filesystem::is_regular_file(file)) {
        throw BadRequest("--source " + file +
                         ": no such file; right would be a video file, rtsp://, gst:PIPELINE, v4l2:N or /dev/video0");
    }
    if (!capture_.open(file, cv::CAP_FFMPEG)) {
        throw BadRequest("--source " + file + ": is no video that FFmpeg can read");
    }
    rate_ = capture_.get(cv::CAP_PROP_FPS);
    promised_ = static_cast<std::int64_t>(capture_.get(cv::CAP_PROP_FRAME_COUNT));
}

bool VideoFile::next(Frame &frame) {
    constexpr double usual_rate = 25.0;
    const double rate = rate_ > 0 ? rate_ : usual_rate;
    if (!capture_.read(frame.bgr)) {
        return false;
    }
    double t_s = capture_.get(cv::CAP_PROP_POS_MSEC) / 1000.0;
    // Some containers have no times, or the same one twice.
    if (!(t_s > last_s_) || (read_ > 1 && t_s <= 0)) {
        t_s = last_s_ < 0 ? 0.0 : last_s_ + 1.0 / rate;
    }
    last_s_ = t_s;
    ++read_;
    frame.t_s = t_s;
    return true;
}

LiveSource::LiveSource(std::string source, cv::Size wanted)
    : source_(possible(std::move(source))), wanted_(wanted), start_(std::chrono::steady_clock::now()),
      thread_([this] { run(); }) {}

LiveSource::~LiveSource() {
    stop_ = true;
    thread_.join();
}

bool LiveSource::take(Frame &frame, double until_s) {
    using Clock = std::chrono::steady_clock;
    return newest_.take(frame,
                        start_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(until_s)));
}

double LiveSource::now_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

bool LiveSource::open(cv::VideoCapture &capture) const {
    constexpr int patience_ms = 3000;
    if (begins_with(source_, "gst:")) {
        return capture.open(source_.substr(4), cv::CAP_GSTREAMER);
    }
    if (begins_with(source_, "v4l2:") || begins_with(source_, "/dev/video")) {
        const std::string device = source_[0] == '/' ? source_ : "/dev/video" + source_.substr(5);
        if (!capture.open(device, cv::CAP_V4L2)) {
            return false;
        }
        // One that does not know this size takes another, which is refused with the first picture.
        capture.set(cv::CAP_PROP_FRAME_WIDTH, wanted_.width);
        capture.set(cv::CAP_PROP_FRAME_HEIGHT, wanted_.height);
        return capture.isOpened();
    }
    return capture.open(source_, cv::CAP_FFMPEG,
                        {cv::CAP_PROP_OPEN_TIMEOUT_MSEC, patience_ms, cv::CAP_PROP_READ_TIMEOUT_MSEC, patience_ms});
}

void LiveSource::run() {
    constexpr std::chrono::milliseconds first_wait(500);
    constexpr std::chrono::milliseconds longest_wait(4000);
    constexpr std::chrono::milliseconds slice(50);
    auto wait = first_wait;
    while (!stop_) {
        try {
            cv::VideoCapture capture;
            if (open(capture)) {
                ++opened_;
                Frame frame;
                while (!stop_ && capture.read(frame.bgr)) {
                    wait = first_wait;
                    newest_.put({frame.bgr.clone(), now_s()});
                }
            } else {
                ++shut_;
            }
        } catch (const cv::Exception &) {
            ++broken_; // a camera that answers nonsense is one that is not there
        }
        for (auto waited = slice; waited <= wait && !stop_; waited += slice) {
            std::this_thread::sleep_for(slice);
        }
        wait = std::min(2 * wait, longest_wait);
    }
}

} // namespace elmopp
