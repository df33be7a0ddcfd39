// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// How much of the usual contrast the whole picture has: fog, rain on the lens and a weak lens take it from vehicles,
/// road and everything else alike, so that what tells a vehicle from the road must be less, too.
///
/// Judged about once a second from the fine structure of the whole picture and from how dark its dark is, and averaged:
/// vehicles come and go. Owner: the counter. Not thread-safe.

#pragma once

#include <opencv2/core.hpp>

namespace elmopp {

class Haze {
  public:
    /// The next frame, BGR. Returns the share of the usual contrast that is left, from 0.3 to 1.
    double follow(const cv::Mat &bgr, double dt_s);

  private:
    double clear_ = 1.0;
    double since_s_ = 0.0;
    bool known_ = false;
};

} // namespace elmopp
