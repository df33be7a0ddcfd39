// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "split.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

namespace elmopp {
namespace {

constexpr int most_rounds = 3;

/// Hills that grow together as the water falls.
class Hills {
  public:
    Hills(const cv::Mat &height, double neck)
        : height_(height), neck_(static_cast<float>(neck)), label_(height.size(), CV_32S, cv::Scalar(0)) {
        top_.push_back(0.0F);
        above_.push_back(0);
    }

    void flood(float least) {
        std::vector<std::pair<float, int>> order;
        for (int r = 0; r < height_.rows; ++r) {
            for (int c = 0; c < height_.cols; ++c) {
                const float value = height_.at<float>(r, c);
                if (value > 0) {
                    order.emplace_back(-value, r * height_.cols + c);
                }
            }
        }
        std::sort(order.begin(), order.end()); // from the top; equal ones as they lie
        for (const auto &[value, index] : order) {
            place(index / height_.cols, index % height_.cols, -value, least);
        }
    }

    /// Labels 1, 2, ...; returns how many.
    int finish(cv::Mat &labels) {
        std::vector<int> number(top_.size(), 0);
        int many = 0;
        labels.create(label_.size(), CV_32S);
        for (int r = 0; r < label_.rows; ++r) {
            for (int c = 0; c < label_.cols; ++c) {
                const int hill = root(label_.at<int>(r, c));
                if (hill != 0 && number[static_cast<std::size_t>(hill)] == 0) {
                    number[static_cast<std::size_t>(hill)] = ++many;
                }
                labels.at<int>(r, c) = hill == 0 ? 0 : number[static_cast<std::size_t>(hill)];
            }
        }
        return many;
    }

  private:
    int root(int hill) const {
        while (hill != above_[static_cast<std::size_t>(hill)]) {
            hill = above_[static_cast<std::size_t>(hill)];
        }
        return hill;
    }

    void place(int r, int c, float value, float least) {
        std::array<int, 8> around{};
        std::size_t many = 0;
        int uphill = 0; // the hill of the highest neighbour: a rim belongs to whom it leans on
        float highest_near = -1.0F;
        for (int y = std::max(0, r - 1); y <= std::min(height_.rows - 1, r + 1); ++y) {
            for (int x = std::max(0, c - 1); x <= std::min(height_.cols - 1, c + 1); ++x) {
                const int hill = root(label_.at<int>(y, x));
                const auto end = around.begin() + static_cast<std::ptrdiff_t>(many);
                if (hill != 0 && height_.at<float>(y, x) > highest_near) {
                    highest_near = height_.at<float>(y, x);
                    uphill = hill;
                }
                if (hill != 0 && std::find(around.begin(), end, hill) == end) {
                    around[many++] = hill;
                }
            }
        }
        if (many == 0) {
            top_.push_back(value);
            above_.push_back(static_cast<int>(above_.size()));
            label_.at<int>(r, c) = static_cast<int>(above_.size()) - 1;
            return;
        }
        int highest = around[0];
        for (std::size_t i = 1; i < many; ++i) {
            highest = top(around[i]) > top(highest) ? around[i] : highest;
        }
        for (std::size_t i = 0; i < many; ++i) {
            if (around[i] == highest) {
                continue;
            }
            const float lower = top(around[i]);
            if (lower < least || value >= neck_ * lower) {
                above_[static_cast<std::size_t>(around[i])] = highest;
            }
        }
        label_.at<int>(r, c) = uphill;
    }

    [[nodiscard]] float top(int hill) const {
        return top_[static_cast<std::size_t>(hill)];
    }

    const cv::Mat &height_;
    float neck_;
    cv::Mat label_;
    std::vector<float> top_;
    std::vector<int> above_;
};

cv::Mat distance_inside(const cv::Mat &shape) {
    cv::Mat framed;
    cv::copyMakeBorder(shape, framed, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
    cv::Mat distance;
    cv::distanceTransform(framed, distance, cv::DIST_L2, cv::DIST_MASK_5, CV_32F);
    return distance(cv::Rect(cv::Point(1, 1), shape.size()));
}

} // namespace

int split_shape(const cv::Mat &shape, double least_px, double neck, cv::Mat &labels) {
    labels = cv::Mat::zeros(shape.size(), CV_32S);
    int many = 0;
    std::vector<std::pair<cv::Mat, int>> parts{{shape, 0}};
    while (!parts.empty()) {
        const auto [part, round] = parts.back();
        parts.pop_back();
        const cv::Mat height = distance_inside(part).clone();
        Hills hills(height, neck);
        hills.flood(static_cast<float>(least_px));
        cv::Mat found;
        const int count = hills.finish(found);
        for (int i = 1; i <= count; ++i) {
            const cv::Mat one = found == i;
            if (count > 1 && round + 1 < most_rounds) {
                parts.emplace_back(one, round + 1);
            } else {
                labels.setTo(++many, one);
            }
        }
    }
    return many;
}

} // namespace elmopp
