// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Whether the camera can be believed: black, white, frozen, blurred, covered, moved, lost.
///
/// Judges each frame by itself (`suspect`), so that nothing is counted in a bad one, and says a fault when it has
/// lasted, and that it is over when it has been good again for a while. What is normal, sharpness, noise, texture of
/// the parts of the picture, is learnt from good frames and follows the day slowly.
///
/// Frozen is judged by the sensor's noise, not by motion: an empty street at night is not frozen. A source that often
/// repeats frames exactly is given longer. Owner: the counter. Not thread-safe.

#pragma once

#include "record.hpp"

#include <opencv2/core.hpp>

#include <deque>
#include <vector>

namespace elmopp {

class Health {
  public:
    static constexpr double moved_px = 15.0; ///< a shift by more is a moved camera

    /// `traffic`: 255 where vehicles move, in the size of the picture.
    explicit Health(const cv::Mat &traffic);

    /// The next frame. Returns false if it must not be counted.
    bool look(const cv::Mat &bgr, double dt_s);

    /// What the registration made of a frame that was not suspect.
    void placed(double shift_px, bool sure, double dt_s);

    /// There has been no frame for this long.
    void nothing(double for_s);

    /// Reason::ok, or what is wrong.
    [[nodiscard]] Reason fault() const {
        return fault_;
    }

  private:
    Reason judge(const cv::Mat &grey, double dt_s);
    [[nodiscard]] bool is_frozen(const cv::Mat &grey, double dt_s);
    Reason judge_texture(const cv::Mat &grey, double dt_s);
    void settle(Reason seen, double dt_s);

    cv::Mat traffic_;
    cv::Mat cells_traffic_;
    cv::Mat before_;
    cv::Mat usual_texture_;    ///< [cells]
    std::deque<double> noise_; ///< differences of good frames
    double same_s_ = 0.0;
    double longest_same_s_ = 0.0;
    double good_total_s_ = 0.0;
    Reason candidate_ = Reason::ok;
    double candidate_s_ = 0.0;
    Reason fault_ = Reason::ok;
    double good_s_ = 0.0;
    double astray_s_ = 0.0;
    bool placed_wrong_ = false;
};

} // namespace elmopp
