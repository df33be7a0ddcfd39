// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "detector.hpp"

#include "error.hpp"
#include "onnx_input.hpp"

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

namespace elmopp {
namespace {

constexpr float least_score = 0.25F;
constexpr float most_overlap = 0.45F;
constexpr int most_side_px = 4096;
constexpr int coco_kinds = 80;
constexpr int ssd_numbers = 7;

enum class Layout { yolo8, yolo5, ssd };

struct Found {
    std::vector<cv::Rect2d> boxes; ///< in pixels of the input
    std::vector<float> scores;
};

std::string shape_text(const cv::dnn::MatShape &shape) {
    std::string text = "[";
    for (const int side : shape) {
        text += (text.size() > 1 ? ", " : "") + std::to_string(side);
    }
    return text + "]";
}

bool counts_of_coco(int kind) {
    static const std::set<int> vehicles{2, 3, 5, 7};
    return vehicles.count(kind) != 0;
}

/// The best kind of one that counts, and its score.
template <class ScoreOf> float best_score(int kinds, const ScoreOf &score_of) {
    float best = 0.0F;
    int best_kind = 0;
    for (int kind = 0; kind < kinds; ++kind) {
        if (score_of(kind) > best) {
            best = score_of(kind);
            best_kind = kind;
        }
    }
    return kinds != coco_kinds || counts_of_coco(best_kind) ? best : 0.0F;
}

/// `rows`: a box each, middle, size, then scores; `sure`: the first of these says whether there is anything.
Found boxes_of_yolo(const cv::Mat &rows, bool sure) {
    const int before = sure ? 5 : 4;
    Found found;
    for (int i = 0; i < rows.rows; ++i) {
        const float *row = rows.ptr<float>(i);
        const auto kinds = best_score(rows.cols - before, [&](int kind) { return row[before + kind]; });
        const float score = sure ? row[4] * kinds : kinds;
        if (score >= least_score) {
            found.boxes.emplace_back(static_cast<double>(row[0] - row[2] / 2), static_cast<double>(row[1] - row[3] / 2),
                                     static_cast<double>(row[2]), static_cast<double>(row[3]));
            found.scores.push_back(score);
        }
    }
    return found;
}

Found boxes_of_ssd(const cv::Mat &rows, cv::Size input) {
    static const std::set<int> vehicles{3, 4, 6, 8}; // COCO's own numbers
    Found found;
    for (int i = 0; i < rows.rows; ++i) {
        const float *row = rows.ptr<float>(i);
        if (row[2] >= least_score && vehicles.count(cvRound(row[1])) != 0) {
            found.boxes.emplace_back(
                cv::Point2d(static_cast<double>(row[3]) * input.width, static_cast<double>(row[4]) * input.height),
                cv::Point2d(static_cast<double>(row[5]) * input.width, static_cast<double>(row[6]) * input.height));
            found.scores.push_back(row[2]);
        }
    }
    return found;
}

} // namespace

struct Detector::Impl {
    explicit Impl(std::string file_name) : name(std::move(file_name)) {}

    void load();
    void read_input();
    void read_layout(const cv::Mat &output);
    cv::Mat run(const cv::Mat &bgr);
    [[noreturn]] void refuse(const std::string &why) const {
        throw BadRequest("model " + name + ": " + why);
    }

    std::string name;
    cv::dnn::Net net;
    cv::Size input;
    Layout layout = Layout::yolo8;
};

void Detector::Impl::load() {
    if (!std::filesystem::is_regular_file(name)) {
        refuse("cannot be read; right would be an ONNX file beside the lane file");
    }
    // What OpenCV thinks of a wrong file is several lines; ours is one.
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    cv::redirectError([](int, const char *, const char *, const char *, int, void *) { return 0; });
    try {
        net = cv::dnn::readNetFromONNX(name);
        net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
        net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
        read_input();
        const cv::Mat blank(input, CV_8UC3, cv::Scalar::all(0));
        read_layout(run(blank));
    } catch (const cv::Exception &) {
        refuse("is no ONNX model that OpenCV " CV_VERSION " can run; right would be one exported for opset 12");
    }
}

void Detector::Impl::read_input() {
    std::ifstream stream(name, std::ios::binary);
    std::stringstream bytes;
    bytes << stream.rdbuf();
    const cv::dnn::MatShape shape = onnx_input_shape(bytes.str()).value_or(cv::dnn::MatShape());
    const auto is_side = [](int side) { return side > 0 && side <= most_side_px; };
    if (shape.size() != 4 || shape[0] != 1 || shape[1] != 3 || !is_side(shape[2]) || !is_side(shape[3])) {
        refuse("its input is " + shape_text(shape) + "; right would be [1, 3, height, width] of a fixed size");
    }
    input = cv::Size(shape[3], shape[2]);
}

void Detector::Impl::read_layout(const cv::Mat &output) {
    const cv::dnn::MatShape shape(output.size.p, output.size.p + output.dims);
    constexpr int least_numbers = 5;
    if (shape.size() == 4 && shape[0] == 1 && shape[1] == 1 && shape[3] == ssd_numbers) {
        layout = Layout::ssd;
    } else if (shape.size() == 3 && shape[0] == 1 && shape[1] >= least_numbers && shape[1] < shape[2]) {
        layout = Layout::yolo8;
    } else if (shape.size() == 3 && shape[0] == 1 && shape[2] > least_numbers && shape[2] < shape[1]) {
        layout = Layout::yolo5;
    } else {
        refuse("its output is " + shape_text(shape) +
               "; right would be [1, 4 + C, N], [1, N, 5 + C] or [1, 1, N, 7] (docs/camera.md)");
    }
}

/// The first output for a picture that is already as large as the input.
cv::Mat Detector::Impl::run(const cv::Mat &bgr) {
    const bool ssd = layout == Layout::ssd;
    const double middle = ssd ? 127.5 : 0.0;
    net.setInput(
        cv::dnn::blobFromImage(bgr, ssd ? 1 / middle : 1 / 255.0, input, cv::Scalar::all(middle), true, false));
    std::vector<cv::Mat> outputs;
    net.forward(outputs, net.getUnconnectedOutLayersNames());
    if (outputs.empty() || outputs.front().type() != CV_32F) {
        refuse("gives no numbers");
    }
    return outputs.front();
}

Detector::Detector(const std::filesystem::path &model) : impl_(std::make_unique<Impl>(model.string())) {
    impl_->load();
}

Detector::~Detector() = default;

std::vector<cv::Rect2d> Detector::find(const cv::Mat &bgr) {
    Impl &my = *impl_;
    const cv::Point2d stretch(static_cast<double>(my.input.width) / bgr.cols,
                              static_cast<double>(my.input.height) / bgr.rows);
    const double kept = std::min(stretch.x, stretch.y);
    const cv::Point2d scale = my.layout == Layout::ssd ? stretch : cv::Point2d(kept, kept);
    const cv::Size inner(std::min(my.input.width, cvRound(bgr.cols * scale.x)),
                         std::min(my.input.height, cvRound(bgr.rows * scale.y)));
    constexpr double beside = 114; // what YOLO was trained with
    cv::Mat picture(my.input, CV_8UC3, cv::Scalar::all(beside));
    const cv::Rect place((my.input - inner).width / 2, (my.input - inner).height / 2, inner.width, inner.height);
    cv::resize(bgr, picture(place), inner, 0, 0, cv::INTER_LINEAR);
    const cv::Mat output = my.run(picture);
    cv::Mat rows;
    Found found;
    if (my.layout == Layout::ssd) {
        rows = cv::Mat(output.size[2], ssd_numbers, CV_32F, output.data);
        found = boxes_of_ssd(rows, my.input);
    } else {
        rows = cv::Mat(output.size[1], output.size[2], CV_32F, output.data);
        found = boxes_of_yolo(my.layout == Layout::yolo8 ? cv::Mat(rows.t()) : rows, my.layout == Layout::yolo5);
    }
    std::vector<int> kept_boxes;
    cv::dnn::NMSBoxes(found.boxes, found.scores, least_score, most_overlap, kept_boxes);
    std::vector<cv::Rect2d> boxes;
    for (const int i : kept_boxes) {
        const cv::Rect2d &box = found.boxes[static_cast<std::size_t>(i)];
        const cv::Rect2d there((box.x - place.x) / scale.x, (box.y - place.y) / scale.y, box.width / scale.x,
                               box.height / scale.y);
        const cv::Rect2d inside = there & cv::Rect2d(0, 0, bgr.cols, bgr.rows);
        if (inside.area() > 0) {
            boxes.push_back(inside);
        }
    }
    return boxes;
}

} // namespace elmopp
