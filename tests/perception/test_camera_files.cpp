// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// What is around the counter: lane files, lines of JSON, frames of the bus, the place for the newest frame, splitting.

#include "camera_bus.hpp"
#include "error.hpp"
#include "lanes.hpp"
#include "record_json.hpp"
#include "source.hpp"
#include "split.hpp"

extern "C" {
#include "elmopp/frames.h"
}

#include <opencv2/imgproc.hpp>
#include <unity.h>

#include <array>
#include <chrono>
#include <string>
#include <thread>

namespace {

using namespace elmopp;

const std::string good = R"({"width": 320, "height": 240, "lanes": [
  {"name": "a", "line": [[50, 150], [100, 150]], "direction": "down", "approach": 1, "movement": 0,
   "zone": [[60, 50], [90, 50], [100, 150], [50, 150]], "mask": [[[60, 60], [70, 60], [70, 80]]]},
  {"name": "b", "line": [[100, 150], [150, 150]], "direction": "down", "approach": 1, "movement": 0},
  {"name": "c", "line": [[150, 150], [200, 150]], "direction": "up"}],
  "junction": [[10, 200], [300, 200], [300, 230]]})";

LaneFile parsed(const std::string &text) {
    return parse_lane_file(text, "x.json", "");
}

std::string replaced(std::string text, const std::string &what, const std::string &with) {
    const std::size_t at = text.find(what);
    TEST_ASSERT_TRUE_MESSAGE(at != std::string::npos, what.c_str());
    return text.replace(at, what.size(), with);
}

void a_lane_file_is_read_as_it_says() {
    const LaneFile file = parsed(good);
    TEST_ASSERT_EQUAL_INT(320, file.width_px);
    TEST_ASSERT_EQUAL_UINT(3, file.lanes.size());
    TEST_ASSERT_EQUAL_STRING("a", file.lanes[0].name.c_str());
    TEST_ASSERT_EQUAL_DOUBLE(100, file.lanes[0].to_px.x);
    TEST_ASSERT_EQUAL_UINT(4, file.lanes[0].zone_px.size());
    TEST_ASSERT_EQUAL_UINT(1, file.lanes[0].mask_px.size());
    TEST_ASSERT_EQUAL_INT(1, *file.lanes[1].approach);
    TEST_ASSERT_FALSE(file.lanes[2].approach.has_value());
    TEST_ASSERT_TRUE(file.lanes[2].direction == Direction::up);
    TEST_ASSERT_EQUAL_UINT(3, file.junction_px.size());
    TEST_ASSERT_EQUAL_UINT(0, lane_file_warnings(file).size());
}

/// Changed in one place, the file is refused, and the message names the key and the file.
void expect_refused(const std::string &what, const std::string &with, const std::string &key) {
    try {
        (void)parsed(replaced(good, what, with));
    } catch (const BadRequest &error) {
        const std::string text = error.what();
        TEST_ASSERT_TRUE_MESSAGE(text.find(key) != std::string::npos, text.c_str());
        TEST_ASSERT_TRUE_MESSAGE(text.find("x.json") == 0, text.c_str());
        TEST_ASSERT_TRUE_MESSAGE(text.find('\n') == std::string::npos, text.c_str());
        return;
    }
    TEST_FAIL_MESSAGE(("not refused: " + with).c_str());
}

void a_wrong_lane_file_is_refused_by_its_key() {
    expect_refused("\"width\": 320", "\"width\": 0", "width");
    expect_refused("\"width\": 320, ", "", "width");
    expect_refused("\"height\": 240", "\"height\": \"x\"", "height");
    expect_refused("[50, 150], [100, 150]]", "[50, 150], [50, 151]]", "lanes[0].line");
    expect_refused("[50, 150], [100, 150]]", "[50, 150], [400, 150]]", "lanes[0].line[1]");
    expect_refused("[50, 150], [100, 150]]", "[50, 150]]", "lanes[0].line");
    expect_refused("\"down\"", "\"left\"", "lanes[0].direction");
    expect_refused("\"down\"", "\"sideways\"", "lanes[0].direction");
    expect_refused("\"name\": \"b\"", "\"name\": \"a\"", "lanes[1].name");
    expect_refused("\"name\": \"b\"", "\"naem\": \"b\"", "lanes[1].naem");
    expect_refused("\"approach\": 1", "\"approach\": 8", "lanes[0].approach");
    expect_refused(", \"movement\": 0", "", "lanes[0]");
    expect_refused("[[60, 60], [70, 60], [70, 80]]", "[[60, 60], [70, 60]]", "lanes[0].mask[0]");
    expect_refused("[[10, 200], [300, 200], [300, 230]]", "[[10, 200], [300, 200], [20, 200]]", "junction");
    expect_refused("{\"width\"", "{\"speed\": 3, \"width\"", "speed");
    expect_refused("{\"width\"", "{\"format\": \"elmopp-lanes/2\", \"width\"", "format");
    expect_refused("{\"width\"", "{{\"width\"", "JSON");
}

void a_line_at_the_border_is_warned_of() {
    const LaneFile file = parsed(replaced(good, "[150, 150], [200, 150]", "[150, 236], [200, 236]"));
    TEST_ASSERT_EQUAL_UINT(1, lane_file_warnings(file).size());
    TEST_ASSERT_TRUE(lane_file_warnings(file)[0].find("lane c") == 0);
}

Record some_record() {
    Record record;
    record.t_s = 12.0401;
    record.frame = 301;
    record.lanes = {{"a", 70, 2, 4, 0.25, true, Reason::ok, 1.0},
                    {"b", 5, 0, std::nullopt, 0.0, true, Reason::ok, 0.5},
                    {"c", 1, 0, std::nullopt, 0.0, false, Reason::frozen, 0.0}};
    record.junction = JunctionRecord{true, true, Reason::ok};
    return record;
}

void a_record_is_one_line_with_the_documented_keys() {
    TEST_ASSERT_EQUAL_STRING(
        "{\"t_s\":12.04,\"frame\":301,\"lanes\":{"
        "\"a\":{\"arrived_total\":70,\"inflow\":2,\"present\":4,\"occupancy\":0.25,\"valid\":true,\"reason\":\"ok\","
        "\"confidence\":1.0},"
        "\"b\":{\"arrived_total\":5,\"inflow\":0,\"present\":null,\"occupancy\":0.0,\"valid\":true,\"reason\":\"ok\","
        "\"confidence\":0.5},"
        "\"c\":{\"arrived_total\":1,\"inflow\":0,\"present\":null,\"occupancy\":0.0,\"valid\":false,\"reason\":"
        "\"frozen\","
        "\"confidence\":0.0}},"
        "\"junction\":{\"occupied\":true,\"valid\":true,\"reason\":\"ok\"},\"latency_ms\":3.5,\"dropped\":7}",
        record_line(some_record(), 3.5, 7).c_str());
    TEST_ASSERT_EQUAL_STRING("{\"frame\":12,\"lane\":\"b\"}", crossing_line({12, 1, 0.5, 1.0}, parsed(good)).c_str());
}

void lanes_of_a_movement_are_summed_on_the_bus() {
    LaneFile file = parsed(good);
    CameraBus bus(file);
    const auto frames = bus.counts(some_record());
    TEST_ASSERT_EQUAL_UINT(1, frames.size());
    TEST_ASSERT_EQUAL_UINT16(0x101, frames[0].id);
    TEST_ASSERT_TRUE(elmopp_link_is_whole(frames.data()));
    std::array<elmopp_detector_report_t, ELMOPP_APPROACH_MOVEMENT_MAX> reports{};
    TEST_ASSERT_EQUAL_UINT8(0, elmopp_frames_counts(frames.data(), reports.data()));
    TEST_ASSERT_EQUAL_UINT8(75 % 64, reports[0].arrivals);
    TEST_ASSERT_EQUAL_UINT16(ELMOPP_DETECTOR_UNKNOWN, reports[0].present_veh); // lane b has no zone
    TEST_ASSERT_TRUE(reports[0].valid);
    TEST_ASSERT_FALSE(reports[1].valid); // nobody looks at it
    TEST_ASSERT_EQUAL_UINT16(ELMOPP_DETECTOR_UNKNOWN, reports[1].present_veh);
    // The counter of the frames goes on.
    TEST_ASSERT_EQUAL_UINT8((frames[0].data[0] + 1) & 0x0F, bus.counts(some_record())[0].data[0] & 0x0F);
}

void a_fault_goes_over_the_bus_with_its_reason() {
    LaneFile file = parsed(good);
    CameraBus bus(file);
    Record record = some_record();
    record.lanes[1].valid = false;
    record.lanes[1].reason = Reason::moved;
    record.lanes[1].present = 3;
    const auto frames = bus.counts(record);
    std::array<elmopp_detector_report_t, ELMOPP_APPROACH_MOVEMENT_MAX> reports{};
    TEST_ASSERT_EQUAL_UINT8(7, elmopp_frames_counts(frames.data(), reports.data()));
    TEST_ASSERT_FALSE(reports[0].valid);
    TEST_ASSERT_EQUAL_UINT16(7, reports[0].present_veh);
    const auto junction = bus.junction(record);
    TEST_ASSERT_TRUE(junction.has_value());
    TEST_ASSERT_EQUAL_UINT16(0x110, junction->id);
    const elmopp_occupancy_t occupancy = elmopp_frames_occupancy(&*junction);
    TEST_ASSERT_TRUE(occupancy.occupied && occupancy.valid);
    record.junction.reset();
    TEST_ASSERT_FALSE(bus.junction(record).has_value());
}

void the_newest_frame_is_given_and_the_others_are_counted() {
    NewestFrame place;
    const auto soon = [] { return std::chrono::steady_clock::now() + std::chrono::milliseconds(20); };
    Frame frame;
    TEST_ASSERT_FALSE(place.take(frame, soon()));
    for (int i = 0; i < 10; ++i) {
        place.put({cv::Mat(), i * 1.0});
    }
    TEST_ASSERT_TRUE(place.take(frame, soon()));
    TEST_ASSERT_EQUAL_DOUBLE(9.0, frame.t_s);
    TEST_ASSERT_EQUAL_UINT64(9, place.dropped());
    TEST_ASSERT_FALSE(place.take(frame, soon()));
}

/// A camera at twice the speed of whoever reads it.
void whoever_is_slow_gets_no_old_frame() {
    NewestFrame place;
    constexpr int frames = 100;
    const auto start = std::chrono::steady_clock::now();
    const auto now_s = [start] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    std::thread camera([&] {
        for (int i = 0; i < frames; ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            place.put({cv::Mat(), now_s()});
        }
    });
    std::uint64_t taken = 0;
    double oldest_s = 0;
    Frame frame;
    while (place.take(frame, std::chrono::steady_clock::now() + std::chrono::milliseconds(500))) {
        oldest_s = std::max(oldest_s, now_s() - frame.t_s);
        ++taken;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    camera.join();
    TEST_ASSERT_EQUAL_UINT64(frames, taken + place.dropped());
    TEST_ASSERT_GREATER_THAN_UINT64(10, place.dropped());
    TEST_ASSERT_TRUE(oldest_s < 0.2);
}

void what_is_live_is_told_from_a_file() {
    for (const char *source : {"rtsp://x/y", "gst:videotestsrc ! appsink", "v4l2:0", "/dev/video1", "http://x"}) {
        TEST_ASSERT_TRUE_MESSAGE(is_live(source), source);
    }
    TEST_ASSERT_FALSE(is_live("clips/a.mp4"));
}

void two_discs_with_a_neck_are_two_and_a_bar_is_one() {
    cv::Mat shape = cv::Mat::zeros(60, 120, CV_8U);
    cv::circle(shape, {30, 30}, 20, cv::Scalar(255), cv::FILLED);
    cv::circle(shape, {66, 30}, 20, cv::Scalar(255), cv::FILLED);
    cv::Mat labels;
    TEST_ASSERT_EQUAL_INT(2, split_shape(shape, 5, 0.74, labels));
    TEST_ASSERT_NOT_EQUAL_INT(labels.at<int>(30, 20), labels.at<int>(30, 76));
    TEST_ASSERT_EQUAL_INT(0, labels.at<int>(0, 0));
    shape.setTo(0);
    cv::rectangle(shape, {10, 10, 90, 30}, cv::Scalar(255), cv::FILLED);
    TEST_ASSERT_EQUAL_INT(1, split_shape(shape, 5, 0.74, labels));
}

} // namespace

void setUp() {}

void tearDown() {}

int main() {
    UNITY_BEGIN();
    RUN_TEST(a_lane_file_is_read_as_it_says);
    RUN_TEST(a_wrong_lane_file_is_refused_by_its_key);
    RUN_TEST(a_line_at_the_border_is_warned_of);
    RUN_TEST(a_record_is_one_line_with_the_documented_keys);
    RUN_TEST(lanes_of_a_movement_are_summed_on_the_bus);
    RUN_TEST(a_fault_goes_over_the_bus_with_its_reason);
    RUN_TEST(the_newest_frame_is_given_and_the_others_are_counted);
    RUN_TEST(whoever_is_slow_gets_no_old_frame);
    RUN_TEST(what_is_live_is_told_from_a_file);
    RUN_TEST(two_discs_with_a_neck_are_two_and_a_bar_is_one);
    return UNITY_END();
}
