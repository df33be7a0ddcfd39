// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Splits what crossed a line, drawn in columns and progress, into vehicles: two hills of the distance to the border
/// that meet at a neck, a saddle below this share of the lower one, are two. Pure.

#pragma once

#include <opencv2/core.hpp>

namespace elmopp {

/// `shape`: 255 inside. Returns labels 1, 2, ... (CV_32S, 0 outside) and how many. Hills lower than `least_px` belong
/// to their neighbour. Tries the parts again, because a part may have a neck of its own.
int split_shape(const cv::Mat &shape, double least_px, double neck, cv::Mat &labels);

} // namespace elmopp
