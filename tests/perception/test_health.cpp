// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Faults of a camera: said in time, with their name, over in time, and never without cause.

#include "counter.hpp"
#include "scene.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <unity.h>

#include <functional>
#include <string>
#include <vector>

namespace {

using elmopp::Counter;
using elmopp::Direction;
using elmopp::Reason;
using elmopp::Scene;
using elmopp::SceneFlow;

const cv::Size picture(352, 264);
constexpr double rate = 25.0;
constexpr double from_s = 8.0;
constexpr double to_s = 16.0;
constexpr double end_s = 24.0;

using Fault = std::function<void(cv::Mat &)>;

cv::Mat turned(const cv::Mat &frame, double degrees, double zoom, double right_px) {
    cv::Mat move = cv::getRotationMatrix2D({static_cast<float>(frame.cols) / 2, static_cast<float>(frame.rows) / 2},
                                           degrees, zoom);
    move.at<double>(0, 2) += right_px;
    cv::Mat moved;
    cv::warpAffine(frame, moved, move, frame.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
    return moved;
}

/// Films traffic with a fault in the middle. The fault must have its name by `within_s`, and be over 5 s after its end;
/// nothing is said before it.
void expect_fault(Reason reason, double within_s, const Fault &fault, bool night = false) {
    Scene scene(picture, 3, 1);
    scene.night = night;
    const SceneFlow flow = SceneFlow::random(3, end_s, 1.6, 11);
    Counter counter(scene.lanes(14, 0, Direction::down));
    std::int64_t before = 0;
    for (int i = 0; i < static_cast<int>(end_s * rate); ++i) {
        const double t_s = i / rate;
        cv::Mat frame = scene.draw(flow.at(t_s));
        const bool broken = t_s >= from_s && t_s < to_s;
        if (broken) {
            fault(frame);
        }
        if (frame.empty()) {
            counter.miss(t_s);
        } else {
            counter.feed(frame, t_s);
        }
        const auto now = counter.glance().lanes[0];
        const std::string text = "at " + std::to_string(t_s) + " s: " + elmopp::reason_name(now.reason);
        if (t_s > 4 && t_s < from_s) {
            TEST_ASSERT_TRUE_MESSAGE(now.valid, text.c_str());
            before = now.arrived_total;
        }
        if (broken && t_s > from_s + within_s) {
            TEST_ASSERT_EQUAL_INT_MESSAGE(static_cast<int>(reason), static_cast<int>(now.reason), text.c_str());
            TEST_ASSERT_FALSE(now.valid);
        }
        if (t_s > to_s + 5) {
            TEST_ASSERT_TRUE_MESSAGE(now.valid, text.c_str());
        }
    }
    counter.finish();
    TEST_ASSERT_GREATER_OR_EQUAL_INT64(before, counter.record().lanes[0].arrived_total);
}

constexpr double soon_s = 2.0;
constexpr double moved_s = 5.0;

void black_is_said() {
    expect_fault(Reason::black, soon_s, [](cv::Mat &frame) { frame.setTo(0); });
}

void white_is_said() {
    cv::RNG random(1);
    expect_fault(Reason::white, soon_s, [&random](cv::Mat &frame) { random.fill(frame, cv::RNG::NORMAL, 250, 2); });
}

void a_frame_that_is_repeated_is_said() {
    cv::Mat kept;
    expect_fault(Reason::frozen, soon_s, [&kept](cv::Mat &frame) {
        kept = kept.empty() ? frame.clone() : kept;
        frame = kept.clone();
    });
}

void a_frame_that_is_repeated_and_encoded_again_is_said() {
    cv::Mat kept;
    expect_fault(Reason::frozen, soon_s, [&kept](cv::Mat &frame) {
        kept = kept.empty() ? frame.clone() : kept;
        std::vector<uchar> bytes;
        cv::imencode(".jpg", kept, bytes);
        frame = cv::imdecode(bytes, cv::IMREAD_COLOR);
    });
}

void blur_is_said() {
    expect_fault(Reason::blurred, soon_s, [](cv::Mat &frame) { cv::GaussianBlur(frame, frame, cv::Size(), 12); });
}

void half_a_cover_is_said() {
    expect_fault(Reason::covered, soon_s,
                 [](cv::Mat &frame) { frame.colRange(0, frame.cols / 2).setTo(cv::Scalar(30, 30, 30)); });
}

void a_step_of_twenty_pixels_is_said() {
    expect_fault(Reason::moved, moved_s, [](cv::Mat &frame) { frame = turned(frame, 0, 1, 20); });
}

void a_turn_of_three_degrees_is_said() {
    expect_fault(Reason::moved, moved_s, [](cv::Mat &frame) { frame = turned(frame, 3, 1, 0); });
}

void a_zoom_of_a_tenth_is_said() {
    expect_fault(Reason::moved, moved_s, [](cv::Mat &frame) { frame = turned(frame, 0, 1.1, 0); });
}

/// Shifted for good: moved, and after a minute learnt anew and right again, with the lanes where the road is now.
void a_camera_that_is_shifted_for_good_is_right_again_after_a_minute() {
    constexpr double slow_rate = 12.5;
    constexpr double shifted_s = 8;
    constexpr double long_s = 100;
    Scene scene(picture, 3, 1);
    const SceneFlow flow = SceneFlow::random(3, long_s, 1.6, 11);
    Counter counter(scene.lanes(14, 0, Direction::down));
    std::int64_t before = 0;
    bool learnt = false;
    for (int i = 0; i < static_cast<int>(long_s * slow_rate); ++i) {
        const double t_s = i / slow_rate;
        cv::Mat frame = scene.draw(flow.at(t_s));
        counter.feed(t_s < shifted_s ? frame : turned(frame, 0, 1, 20), t_s);
        const auto now = counter.glance().lanes[1];
        const std::string text = "at " + std::to_string(t_s) + " s: " + elmopp::reason_name(now.reason);
        if (t_s > shifted_s + moved_s && t_s < shifted_s + 58) {
            TEST_ASSERT_EQUAL_INT_MESSAGE(static_cast<int>(Reason::moved), static_cast<int>(now.reason), text.c_str());
        }
        learnt = learnt || (t_s > shifted_s + 58 && now.reason == Reason::learning);
        if (t_s > shifted_s + 72) {
            TEST_ASSERT_TRUE_MESSAGE(now.valid, text.c_str());
        }
        if (t_s < shifted_s + 72) {
            before = now.arrived_total;
        }
    }
    TEST_ASSERT_TRUE(learnt);
    counter.finish();
    const int truth = flow.crossed(1, long_s) - flow.crossed(1, shifted_s + 72);
    TEST_ASSERT_INT_WITHIN(1, truth, static_cast<int>(counter.record().lanes[1].arrived_total - before));
}

void a_source_that_is_gone_is_said() {
    expect_fault(Reason::lost, soon_s, [](cv::Mat &frame) { frame.release(); });
}

/// Runs a good scene; nothing may be said after the learning.
void expect_no_fault(const std::function<cv::Mat(int)> &film, double seconds, const std::function<double(int)> &time) {
    Scene scene(picture, 3, 1);
    Counter counter(scene.lanes(14, 0, Direction::down));
    for (int i = 0; i < static_cast<int>(seconds * rate); ++i) {
        counter.feed(film(i), time(i));
        const auto now = counter.glance().lanes[0];
        if (i > 4 * rate) {
            TEST_ASSERT_TRUE_MESSAGE(now.valid, elmopp::reason_name(now.reason));
        }
    }
}

void an_empty_street_at_night_is_not_frozen() {
    Scene scene(picture, 3, 1);
    scene.night = true;
    scene.noise = 1.0;
    expect_no_fault([&scene](int) { return scene.draw({}); }, 20, [](int i) { return i / rate; });
}

void time_stamps_may_jump() {
    Scene scene(picture, 3, 1);
    const SceneFlow flow = SceneFlow::random(3, 20, 1.6, 11);
    expect_no_fault([&](int i) { return scene.draw(flow.at(i / rate)); }, 16,
                    [](int i) { return i / rate + (i > 150 ? 10.0 : 0.0) - (i > 250 ? 1.0 : 0.0); });
}

void a_frame_of_another_size_is_no_frame() {
    Scene scene(picture, 3, 1);
    Counter counter(scene.lanes(14, 0, Direction::down));
    for (int i = 0; i < 60; ++i) {
        counter.feed(cv::Mat(100, 100, CV_8UC3, cv::Scalar(0, 0, 0)), i / rate);
        counter.feed(cv::Mat(), i / rate);
    }
    const auto record = counter.record();
    TEST_ASSERT_FALSE(record.lanes[0].valid);
    TEST_ASSERT_EQUAL_INT(static_cast<int>(Reason::lost), static_cast<int>(record.lanes[0].reason));
    TEST_ASSERT_EQUAL_INT64(-1, record.frame);
}

} // namespace

void setUp() {
    cv::setNumThreads(1);
}

void tearDown() {}

int main() {
    UNITY_BEGIN();
    RUN_TEST(black_is_said);
    RUN_TEST(white_is_said);
    RUN_TEST(a_frame_that_is_repeated_is_said);
    RUN_TEST(a_frame_that_is_repeated_and_encoded_again_is_said);
    RUN_TEST(blur_is_said);
    RUN_TEST(half_a_cover_is_said);
    RUN_TEST(a_step_of_twenty_pixels_is_said);
    RUN_TEST(a_turn_of_three_degrees_is_said);
    RUN_TEST(a_zoom_of_a_tenth_is_said);
    RUN_TEST(a_camera_that_is_shifted_for_good_is_right_again_after_a_minute);
    RUN_TEST(a_source_that_is_gone_is_said);
    RUN_TEST(an_empty_street_at_night_is_not_frozen);
    RUN_TEST(time_stamps_may_jump);
    RUN_TEST(a_frame_of_another_size_is_no_frame);
    return UNITY_END();
}
