// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// A detector that the user brings, as an ONNX file, for OpenCV's dnn module: vehicles of one picture as boxes.
///
/// What it gives is told from the shape of its output, tried once on an empty picture:
///   [1, 4 + C, N]  YOLOv8 and its like: middle, size, a score for each of C kinds
///   [1, N, 5 + C]  YOLOv5 and its like: middle, size, whether there is anything, a score for each kind
///   [1, 1, N, 7]   SSD: picture, kind, score, left, top, right, bottom as shares of the picture
/// with N larger than the other. Anything else is refused, and so is an input that is not [1, 3, H, W] with H and W
/// fixed. Pictures go in as RGB: to YOLO from 0 to 1 with their shape kept and grey beside them, to SSD from -1 to 1
/// and stretched. Of 80 kinds (COCO) cars, motorcycles, buses and lorries count, of SSD's kinds those with COCO's
/// numbers for them; of any other number of kinds all do. Boxes below a score of 0.25 and those that overlap a better
/// one are left out.
///
/// Owner: the program. Not thread-safe. Takes as long as the model takes, on one core.

#pragma once

#include <opencv2/core.hpp>

#include <filesystem>
#include <memory>
#include <vector>

namespace elmopp {

class Detector {
  public:
    /// Throws BadRequest naming the file and what is wrong with it.
    explicit Detector(const std::filesystem::path &model);
    ~Detector();
    Detector(const Detector &) = delete;
    Detector &operator=(const Detector &) = delete;
    Detector(Detector &&) = delete;
    Detector &operator=(Detector &&) = delete;

    /// Vehicles in a BGR picture, in its pixels.
    std::vector<cv::Rect2d> find(const cv::Mat &bgr);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace elmopp
