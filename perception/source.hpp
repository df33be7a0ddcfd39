// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Where frames come from: a file, frame by frame, or a live camera, newest frame first.
///
/// A file gives every frame with the time that its container says. A live source (RTSP, V4L2, a GStreamer pipeline) is
/// read by a thread of its own into a place for one frame: whoever is slower than the camera gets the newest frame, and
/// what was overwritten is counted. A camera that says nothing, or is not there, is opened again after a growing wait;
/// the one who takes frames never waits for it. Times of live frames are those of their arrival, in seconds since the
/// start. A V4L2 device, which has a size of its own choice otherwise, is asked for pictures of the size that is
/// wanted.

#pragma once

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

namespace elmopp {

struct Frame {
    cv::Mat bgr;
    double t_s = 0.0;
};

/// The place for the newest frame. Any thread.
class NewestFrame {
  public:
    /// Puts a frame there; one that nobody has taken is dropped and counted.
    void put(Frame frame);

    /// Takes the frame there, waiting for one at most until `until`. False: there is none.
    bool take(Frame &frame, std::chrono::steady_clock::time_point until);

    [[nodiscard]] std::uint64_t dropped() const {
        return dropped_;
    }

  private:
    std::mutex mutex_;
    std::condition_variable came_;
    Frame frame_;
    bool there_ = false;
    std::atomic<std::uint64_t> dropped_ = 0;
};

/// True for rtsp://, http(s)://, udp://, gst:PIPELINE, v4l2:N and /dev/video*: a source without an end.
bool is_live(const std::string &source);

/// The source to be told to people: without the name and password of rtsp://NAME:PASSWORD@HOST.
std::string told_source(const std::string &source);

class VideoFile {
  public:
    /// Throws BadRequest if there is nothing to read.
    explicit VideoFile(const std::string &file);

    /// The next frame; false at the end.
    bool next(Frame &frame);

    /// What the container promises; 0: nothing.
    [[nodiscard]] std::int64_t promised() const {
        return promised_;
    }

  private:
    cv::VideoCapture capture_;
    double rate_;
    double last_s_ = -1.0;
    std::int64_t promised_;
    std::int64_t read_ = 0;
};

class LiveSource {
  public:
    /// Throws BadRequest if such a source can never run: no number, no host, no pipeline.
    LiveSource(std::string source, cv::Size wanted);
    ~LiveSource();
    LiveSource(const LiveSource &) = delete;
    LiveSource &operator=(const LiveSource &) = delete;
    LiveSource(LiveSource &&) = delete;
    LiveSource &operator=(LiveSource &&) = delete;

    /// As NewestFrame::take, until so many seconds after the start.
    bool take(Frame &frame, double until_s);

    [[nodiscard]] std::uint64_t dropped() const {
        return newest_.dropped();
    }

    /// Seconds since the start.
    [[nodiscard]] double now_s() const;

    [[nodiscard]] std::uint64_t opened() const {
        return opened_;
    }

    /// Times that the camera did not open.
    [[nodiscard]] std::uint64_t shut() const {
        return shut_;
    }

  private:
    void run();
    bool open(cv::VideoCapture &capture) const;

    std::string source_;
    cv::Size wanted_;
    std::chrono::steady_clock::time_point start_;
    NewestFrame newest_;
    std::atomic<bool> stop_ = false;
    std::atomic<std::uint64_t> opened_ = 0;
    std::atomic<std::uint64_t> shut_ = 0;
    std::atomic<std::uint64_t> broken_ = 0; ///< times that a camera made the library fail
    std::thread thread_;
};

} // namespace elmopp
