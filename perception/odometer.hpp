// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// How far the vehicles of one lane have moved from frame to frame, along the patch: the pictures of the objects,
/// shifted until they fit best. Forwards and backwards, so that rocking comes to nothing. The picture that the others
/// are held against is kept until something has moved away from it, or for a quarter of a second: who creeps moves by
/// less than a row a frame, the less the more frames there are.
///
/// It is sure, or it is not: then a lane is taken to move at its usual speed, which it learns, and forwards, unless the
/// shift that fits best is backwards and fits clearly better than most. So a vehicle whose steps are too short to be
/// sure of, and who rocks by many of them, comes to nothing too. Owner: a section.

#pragma once

#include <opencv2/core.hpp>

#include <deque>

namespace elmopp {

class Odometer {
  public:
    struct Step {
        double progress = 1.0; ///< speed as a share of the usual one; 1 if it is not known, -1 if only that it is back
        double rows = 0.0;     ///< moved, forwards positive
        bool sure = false;     ///< `rows` was measured
        double net = 1.0;      ///< progress, averaged: near 0 for who stands or rocks
        bool still = false;    ///< there is an object, and it has not moved for a while
    };

    /// `change`: of a lane's columns, 0 where no object is; `object`: 255 where one is. `noise`: of the change.
    Step feed(const cv::Mat &change, const cv::Mat &object, float noise, double dt_s);

    /// Nothing is known of the last picture.
    void forget();

    [[nodiscard]] const Step &last() const {
        return step_;
    }

    /// Rows a second; 0: not known yet.
    [[nodiscard]] double usual_rows_per_s() const {
        return usual_;
    }

  private:
    bool measure(const cv::Mat &few, const cv::Mat &few_mask, float noise, double dt_s);
    void learn_speed(double rows);

    cv::Mat before_; ///< what is held against
    cv::Mat before_mask_;
    double age_s_ = 0.0; ///< of `before_`
    double told_ = 0.0;  ///< rows since then that have been told
    Step step_;
    std::deque<double> speeds_;
    double usual_ = 0.0;
    double still_s_ = 0.0;
    double net_ = 1.0;
};

} // namespace elmopp
