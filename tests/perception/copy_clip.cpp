// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Writes a changed copy of a clip, without loss: copy_clip VIDEO OUT.avi KIND [NUMBER]. Without arguments the kinds.
/// What a change does to the truth of a clip is in elmopp_tools/clip_copies.py.

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>
#include <string>
#include <vector>

namespace {

/// A frame and its number; an empty one is left out.
using Change = std::function<cv::Mat(const cv::Mat &, int)>;

cv::RNG &chance() {
    static cv::RNG random(7);
    return random;
}

cv::Mat noisy(const cv::Mat &frame, double deviation) {
    cv::Mat grain(frame.size(), CV_16SC3);
    chance().fill(grain, cv::RNG::NORMAL, 0, deviation);
    cv::Mat wide;
    frame.convertTo(wide, CV_16S);
    wide += grain;
    wide.convertTo(wide, CV_8U);
    return wide;
}

cv::Mat lit(const cv::Mat &frame, double factor, double plus = 0) {
    cv::Mat out;
    frame.convertTo(out, -1, factor, plus);
    return out;
}

cv::Mat moved(const cv::Mat &frame, double right_px, double down_px) {
    cv::Mat out;
    cv::warpAffine(frame, out, cv::Matx23d(1, 0, right_px, 0, 1, down_px), frame.size(), cv::INTER_LINEAR,
                   cv::BORDER_REFLECT);
    return out;
}

cv::Mat shaken(const cv::Mat &frame, int) {
    constexpr double most_px = 3;
    const double right_px = chance().uniform(-most_px, most_px);
    return moved(frame, right_px, chance().uniform(-most_px, most_px));
}

cv::Mat compressed(const cv::Mat &frame, int) {
    constexpr int quality = 15;
    std::vector<uchar> bytes;
    cv::imencode(".jpg", frame, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
    return cv::imdecode(bytes, cv::IMREAD_COLOR);
}

cv::Mat small(const cv::Mat &frame, int) {
    cv::Mat out;
    const cv::Size even(frame.cols / 4 * 2, frame.rows / 4 * 2); // as a video has it
    cv::resize(frame, out, even, 0, 0, cv::INTER_AREA);
    return out;
}

cv::Mat dusk(const cv::Mat &frame, int i) {
    constexpr double dark = 0.3;
    return noisy(lit(frame, std::max(dark, 1.0 - std::max(0, i - 150) / 100.0)), 2);
}

const std::map<std::string, Change> &changes() {
    static const std::map<std::string, Change> all{
        {"plain", [](const cv::Mat &frame, int) { return frame; }},
        {"noise", [](const cv::Mat &frame, int) { return noisy(frame, 10); }},
        {"light", [](const cv::Mat &frame, int i) { return lit(frame, 1 + 0.35 * std::sin(i * 2 * CV_PI / 250)); }},
        {"dark", [](const cv::Mat &frame, int) { return noisy(lit(frame, 0.15), 1); }},
        {"dusk", dusk},
        {"fog", [](const cv::Mat &frame, int) { return noisy(lit(frame, 0.4, 90), 1.5); }},
        {"blur",
         [](const cv::Mat &frame, int) {
             cv::Mat out;
             cv::GaussianBlur(frame, out, cv::Size(), 1.6);
             return out;
         }},
        {"shake", shaken},
        {"drift",
         [](const cv::Mat &frame, int i) { return moved(frame, std::min(45.0, 0.07 * i), -std::min(20.0, 0.03 * i)); }},
        {"compressed", compressed},
        {"half", [](const cv::Mat &frame, int i) { return i % 2 == 0 ? frame : cv::Mat(); }},
        {"third", [](const cv::Mat &frame, int i) { return i % 3 == 0 ? frame : cv::Mat(); }},
        {"mirrored",
         [](const cv::Mat &frame, int) {
             cv::Mat out;
             cv::flip(frame, out, 1);
             return out;
         }},
        {"turned",
         [](const cv::Mat &frame, int) {
             cv::Mat out;
             cv::transpose(frame, out);
             return out;
         }},
        {"small", small},
    };
    return all;
}

class Writer {
  public:
    Writer(std::string file, double rate) : file_(std::move(file)), rate_(rate) {}

    bool write(const cv::Mat &frame) {
        if (!video_.isOpened() &&
            !video_.open(file_, cv::VideoWriter::fourcc('F', 'F', 'V', '1'), rate_, frame.size())) {
            return false;
        }
        video_.write(frame);
        return true;
    }

  private:
    std::string file_;
    double rate_;
    cv::VideoWriter video_;
};

/// The whole clip backwards.
bool reverse(cv::VideoCapture &video, Writer &out) {
    std::vector<cv::Mat> frames;
    cv::Mat frame;
    while (video.read(frame)) {
        frames.push_back(frame.clone());
    }
    return std::all_of(frames.rbegin(), frames.rend(), [&out](const cv::Mat &one) { return out.write(one); });
}

/// At this frame everybody stops: the last four frames, back and forth, with the sensor's noise.
bool stop(cv::VideoCapture &video, Writer &out, int at) {
    constexpr int rocks = 4;
    constexpr int frames = 900;
    std::vector<cv::Mat> last;
    cv::Mat frame;
    bool good = true;
    for (int i = 0; video.read(frame) && good; ++i) {
        good = out.write(frame);
        if (i > at - rocks && i <= at) {
            last.push_back(frame.clone());
        }
        for (int k = 0; i == at && k < frames; ++k) {
            const int phase = k % (2 * rocks - 2);
            const int back = phase < rocks ? phase : 2 * rocks - 2 - phase;
            good = good && out.write(noisy(last[static_cast<std::size_t>(rocks - 1 - back)], 2));
        }
    }
    return good;
}

} // namespace

int main(int argc, char **argv) {
    if (argc == 1) {
        for (const auto &[name, change] : changes()) {
            std::cout << name << "\n";
        }
        std::cout << "reversed\nstopped\n";
        return 0;
    }
    cv::VideoCapture video(argc >= 4 ? argv[1] : "");
    const std::string kind = argc >= 4 ? argv[3] : "";
    if (!video.isOpened() || (changes().count(kind) == 0 && kind != "reversed" && kind != "stopped")) {
        std::cerr << "copy_clip: right would be VIDEO OUT.avi KIND [NUMBER]\n";
        return 2;
    }
    Writer out(argv[2], video.get(cv::CAP_PROP_FPS) / (kind == "half" ? 2 : kind == "third" ? 3 : 1));
    if (kind == "reversed") {
        return reverse(video, out) ? 0 : 1;
    }
    if (kind == "stopped") {
        return stop(video, out, argc == 5 ? std::atoi(argv[4]) : 0) ? 0 : 1;
    }
    cv::Mat frame;
    bool good = true;
    for (int i = 0; good && video.read(frame); ++i) {
        const cv::Mat changed = changes().at(kind)(frame, i);
        good = changed.empty() || out.write(changed);
    }
    return good ? 0 : 1;
}
