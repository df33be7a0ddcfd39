// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Pictures with lanes, counts and flags drawn on them: a video, or the last one as a picture. By the file's ending.

#pragma once

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include <optional>
#include <string>

namespace elmopp {

class Overlay {
  public:
    /// Throws BadRequest on an ending that is neither .avi, .mp4, .png nor .jpg, or a folder that is not there.
    explicit Overlay(std::string file);

    /// Whether the frame of this second of a source should be drawn and added: a video shows 16 a second at most, as
    /// more would cost the counter a third of its frames and show a person nothing.
    [[nodiscard]] bool wants(double t_s);

    void add(const cv::Mat &bgr, double t_s);

    /// Throws Failure if it could not be written.
    void finish();

  private:
    std::string file_;
    bool video_;
    cv::VideoWriter writer_;
    cv::Mat last_;
    double before_s_ = 0.0;
    std::optional<double> wanted_s_; ///< of the last frame that was wanted
};

} // namespace elmopp
