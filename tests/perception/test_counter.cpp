// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// What the counter makes of drawn traffic, whose truth is known.

#include "counter.hpp"
#include "odometer.hpp"
#include "scene.hpp"

#include <opencv2/imgproc.hpp>
#include <unity.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

namespace {

using elmopp::Counter;
using elmopp::Direction;
using elmopp::Reason;
using elmopp::Record;
using elmopp::Scene;
using elmopp::SceneCar;
using elmopp::SceneFlow;

const cv::Size picture(352, 264);
constexpr double rate = 25.0;
constexpr double line_m = 14.0;
constexpr int lane_count = 3;

using Change = std::function<void(cv::Mat &, int)>;

constexpr int learnt_s = 4; ///< from there on a good camera is believed

/// Counts of a flow, filmed in this scene, changed frame by frame; frames for which `skip` is true never come. Once it
/// has learnt, the camera must be believed in each second: all that is drawn here is a good one.
std::vector<int> counts_of(Scene &scene, const SceneFlow &flow, double seconds, const Change &change = nullptr,
                           const std::function<bool(int)> &skip = nullptr, Direction direction = Direction::down) {
    Counter counter(scene.lanes(line_m, 0, direction));
    for (int i = 0; i < static_cast<int>(seconds * rate); ++i) {
        cv::Mat frame = scene.draw(flow.at(i / rate));
        if (change) {
            change(frame, i);
        }
        if (!skip || !skip(i)) {
            counter.feed(frame, i / rate);
        }
        constexpr int second = static_cast<int>(rate);
        if (i % second == 0 && i >= learnt_s * second) {
            for (const auto &lane : counter.record().lanes) {
                TEST_ASSERT_TRUE_MESSAGE(lane.valid, elmopp::reason_name(lane.reason));
            }
        }
    }
    counter.finish();
    std::vector<int> totals;
    for (const auto &lane : counter.record().lanes) {
        totals.push_back(static_cast<int>(lane.arrived_total));
    }
    return totals;
}

/// At most `wrong` vehicles too many or too few in all lanes together.
void expect_counts(const SceneFlow &flow, double seconds, const std::vector<int> &counted, int wrong,
                   const char *what) {
    int difference = 0;
    std::string text = what;
    for (int lane = 0; lane < lane_count; ++lane) {
        const int truth = flow.crossed(lane, seconds);
        difference += std::abs(truth - counted[static_cast<std::size_t>(lane)]);
        text += " " + std::to_string(counted[static_cast<std::size_t>(lane)]) + "/" + std::to_string(truth);
    }
    TEST_ASSERT_TRUE_MESSAGE(difference <= wrong, text.c_str());
}

constexpr double flow_s = 24.0;

SceneFlow some_flow() {
    return SceneFlow::random(lane_count, flow_s, 1.4, 7);
}

void each_vehicle_is_counted_once_in_its_lane() {
    Scene scene(picture, lane_count, 1);
    const SceneFlow flow = some_flow();
    expect_counts(flow, flow_s, counts_of(scene, flow, flow_s), 1, "day");
}

void hard_shadows_do_not_count() {
    Scene scene(picture, lane_count, 1);
    scene.shadows = true;
    const SceneFlow flow = some_flow();
    expect_counts(flow, flow_s, counts_of(scene, flow, flow_s), 2, "shadows");
}

void headlights_and_their_cones_are_no_vehicles_of_their_own() {
    Scene scene(picture, lane_count, 1);
    scene.night = true;
    scene.noise = 3;
    const SceneFlow flow = some_flow();
    expect_counts(flow, flow_s, counts_of(scene, flow, flow_s), 3, "night");
}

void shaking_by_three_pixels_changes_nothing() {
    Scene scene(picture, lane_count, 1);
    const SceneFlow flow = some_flow();
    cv::RNG random(3);
    const auto shake = [&random](cv::Mat &frame, int) {
        const cv::Matx23d move(1, 0, random.uniform(-3.0, 3.0), 0, 1, random.uniform(-3.0, 3.0));
        cv::warpAffine(frame, frame, move, frame.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    };
    expect_counts(flow, flow_s, counts_of(scene, flow, flow_s, shake), 2, "shaken");
}

void dusk_and_dawn_change_nothing() {
    Scene scene(picture, lane_count, 1);
    const SceneFlow flow = some_flow();
    const auto light = [](cv::Mat &frame, int i) { frame.convertTo(frame, -1, 0.65 - 0.35 * std::sin(i / 80.0)); };
    expect_counts(flow, flow_s, counts_of(scene, flow, flow_s, light), 2, "light");
}

void every_other_frame_is_enough() {
    Scene scene(picture, lane_count, 1);
    const SceneFlow flow = some_flow();
    expect_counts(flow, flow_s, counts_of(scene, flow, flow_s, nullptr, [](int i) { return i % 2 != 0; }), 2, "half");
}

void a_third_of_the_frames_may_be_lost() {
    Scene scene(picture, lane_count, 1);
    const SceneFlow flow = some_flow();
    cv::RNG random(5);
    const auto lost = [&random](int) { return random.uniform(0.0, 1.0) < 0.3; };
    expect_counts(flow, flow_s, counts_of(scene, flow, flow_s, nullptr, lost), 2, "drops");
}

int counted_against(const SceneFlow &flow, const std::function<bool(int)> &skip = nullptr) {
    Scene scene(picture, lane_count, 1);
    const std::vector<int> counted = counts_of(scene, flow, flow_s, nullptr, skip, Direction::up);
    return std::accumulate(counted.begin(), counted.end(), 0);
}

void vehicles_against_the_direction_do_not_count() {
    TEST_ASSERT_EQUAL_INT(0, counted_against(some_flow())); // of 30
}

/// They move by more between two frames than the odometer searches: the side that they come from tells.
void fast_vehicles_against_the_direction_do_not_count() {
    SceneFlow flow = some_flow();
    flow.speed_m_s = 18;
    TEST_ASSERT_EQUAL_INT(0, counted_against(flow, [](int i) { return i % 3 != 0; }));
}

/// One vehicle that stops on the line and rocks there by five pixels for 1000 frames.
void a_vehicle_that_rocks_on_the_line_is_one() {
    Scene scene(picture, lane_count, 1);
    Counter counter(scene.lanes(line_m, 0, Direction::down));
    for (int i = 0; i < 1300; ++i) {
        const double t_s = i / rate;
        SceneCar car;
        car.lane = 1;
        const double rock_m = i % 2 == 0 ? 0.0 : 0.25; // five pixels there
        car.at_m = t_s < 46 ? std::max(line_m - 2.0, line_m + 40 - 8 * (t_s - 1)) + (t_s > 7 ? rock_m : 0.0)
                            : line_m - 2.0 - 8 * (t_s - 46);
        counter.feed(scene.draw({car}), t_s);
    }
    counter.finish();
    const Record record = counter.record();
    TEST_ASSERT_LESS_OR_EQUAL_INT64(1, record.lanes[1].arrived_total);
    TEST_ASSERT_EQUAL_INT64(0, record.lanes[0].arrived_total);
    TEST_ASSERT_EQUAL_INT64(0, record.lanes[2].arrived_total);
}

/// A vehicle seen from beside goes through its lane's patch slantwise: no shift along the patch fits it well, and of
/// steps as short as these none is sure. Three forth and three back, for 36 s.
void a_vehicle_that_rocks_slantwise_in_short_steps_makes_no_progress() {
    constexpr float noise = 0.01F;
    constexpr int patch_rows = 49;
    constexpr int patch_columns = 32;
    constexpr int steps = 3;
    constexpr int frames = 150 * 2 * steps;
    cv::RNG random(7);
    cv::Mat paint(patch_rows, patch_columns, CV_32F, cv::Scalar(0));
    cv::Mat shape(patch_rows, patch_columns, CV_8U, cv::Scalar(0));
    const cv::Rect body(5, 8, 18, 26);
    random.fill(paint(body), cv::RNG::NORMAL, 0, 1);
    cv::GaussianBlur(paint, paint, cv::Size(), 2.5);
    shape(body).setTo(255);
    elmopp::Odometer odometer;
    const auto at = [&](double rows, double aside) {
        const cv::Matx23d move(1, 0, aside, 0, 1, rows);
        cv::Mat change;
        cv::Mat object;
        cv::warpAffine(paint, change, move, paint.size());
        cv::warpAffine(shape, object, move, shape.size(), cv::INTER_NEAREST);
        return odometer.feed(change, object, noise, 1 / rate);
    };
    for (int i = 0; i < 8; ++i) { // what drives straight through is sure, and gives the usual speed
        at(2.0 * i - 6, 0);
    }
    double progress = 0;
    int unsure = 0;
    for (int i = 0; i < frames; ++i) {
        const int phase = i % (2 * steps);
        const int forth = phase < steps ? phase : 2 * steps - phase;
        const elmopp::Odometer::Step step = at(1.3 * forth, 2.5 * forth);
        progress += step.progress;
        unsure += step.sure ? 0 : 1;
    }
    TEST_ASSERT_GREATER_THAN_INT(frames / 2, unsure); // or it is not this that is tried here
    TEST_ASSERT_TRUE_MESSAGE(std::abs(progress) < 0.02 * frames, std::to_string(progress).c_str());
}

std::vector<SceneCar> queue(const std::vector<int> &lengths) {
    std::vector<SceneCar> cars;
    for (std::size_t lane = 0; lane < lengths.size(); ++lane) {
        for (int k = 0; k < lengths[lane]; ++k) {
            SceneCar car;
            car.lane = static_cast<int>(lane);
            car.at_m = line_m + 0.5 + 7.0 * k;
            car.paint = cv::Scalar((40 + 70 * k) % 255, (90 + 50 * static_cast<int>(lane)) % 255, (180 + 33 * k) % 255);
            cars.push_back(car);
        }
    }
    return cars;
}

void a_queue_that_builds_up_is_kept_for_90_seconds() {
    Scene scene(picture, lane_count, 1);
    Counter counter(scene.lanes(line_m, 45, Direction::down));
    const std::vector<SceneCar> standing = queue({4, 3, 2});
    constexpr double slow_rate = 10.0;
    double wrong = 0;
    int looks = 0;
    for (int i = 0; i < 120 * static_cast<int>(slow_rate); ++i) {
        const double t_s = i / slow_rate;
        std::vector<SceneCar> cars = standing;
        for (SceneCar &car : cars) { // arrives at 9 m/s and stops where it stands
            const double there_s = 5 + 0.8 * (car.at_m - line_m) + car.lane;
            car.at_m += std::max(0.0, 9.0 * (there_s - t_s));
        }
        counter.feed(scene.draw(cars), t_s);
        if (i % 10 == 9 && t_s > 28) {
            const Record record = counter.record();
            const int present = *record.lanes[0].present + *record.lanes[1].present + *record.lanes[2].present;
            wrong += std::abs(present - 9);
            ++looks;
            TEST_ASSERT_GREATER_OR_EQUAL_INT(9, present); // nine tenths and more, all the time
            TEST_ASSERT_TRUE(record.lanes[0].valid);
        }
    }
    TEST_ASSERT_TRUE_MESSAGE(wrong / looks <= 1.5, std::to_string(wrong / looks).c_str());
    TEST_ASSERT_EQUAL_INT64(0, counter.record().lanes[0].arrived_total);
}

enum class Blind { black, frozen, turned, gone };

/// A camera that learns an empty road, sees a fault for so long, and has a queue on line and zone of two lanes when it
/// sees again: believed 5 s later and from then on, and right about who is there. What is seen has `light` by then.
void expect_recovery(Blind blind, double blind_s, double light, const char *what) {
    constexpr double slow_rate = 5.0;
    constexpr double from_s = 8.0;
    constexpr double within_s = 5.0;
    Scene scene(picture, lane_count, 1);
    Counter counter(scene.lanes(line_m, 45, Direction::down));
    std::vector<SceneCar> standing = queue({4, 4, 0});
    for (SceneCar &car : standing) {
        car.at_m -= 2.5; // the first of each lane is on the line
    }
    cv::Mat last;
    const int end = static_cast<int>((from_s + blind_s + 2 * within_s) * slow_rate);
    for (int i = 0; i < end; ++i) {
        const double t_s = i / slow_rate;
        const double seeing_s = t_s - from_s - blind_s;
        const std::string text = std::string(what) + ", " + std::to_string(seeing_s) + " s: ";
        if (seeing_s < 0 && t_s >= from_s) {
            if (blind == Blind::gone) {
                counter.miss(t_s);
            } else if (blind == Blind::turned) {
                cv::Mat elsewhere;
                cv::flip(scene.draw({}), elsewhere, -1);
                counter.feed(elsewhere, t_s);
            } else {
                counter.feed(blind == Blind::black ? cv::Mat::zeros(picture, CV_8UC3) : last, t_s);
            }
        } else {
            scene.light = t_s < from_s ? 1.0 : light;
            last = scene.draw(t_s < from_s ? std::vector<SceneCar>{} : standing);
            counter.feed(last, t_s);
        }
        const Record now = counter.glance();
        for (std::size_t lane = 0; lane < now.lanes.size(); ++lane) {
            const auto &one = now.lanes[lane];
            const std::string said = text + elmopp::reason_name(one.reason) + " " + std::to_string(*one.present);
            TEST_ASSERT_FALSE_MESSAGE(one.valid && t_s > from_s + within_s && seeing_s < 0, said.c_str());
            TEST_ASSERT_TRUE_MESSAGE(one.valid || seeing_s < within_s, said.c_str());
            if (seeing_s >= within_s) {
                TEST_ASSERT_INT_WITHIN_MESSAGE(lane < 2 ? 1 : 0, lane < 2 ? 4 : 0, *one.present, said.c_str());
                TEST_ASSERT_EQUAL_INT64_MESSAGE(0, one.arrived_total, said.c_str());
            }
        }
    }
}

void a_camera_that_sees_again_is_believed_while_a_queue_stands() {
    for (const double blind_s : {20.0, 90.0}) {
        expect_recovery(Blind::black, blind_s, 1.0, "black");
        expect_recovery(Blind::frozen, blind_s, 1.0, "frozen");
        expect_recovery(Blind::turned, blind_s, 1.0, "turned");
        expect_recovery(Blind::gone, blind_s, 1.0, "gone");
    }
}

void what_was_learnt_is_believed_in_other_brightness_too() {
    expect_recovery(Blind::black, 20, 0.6, "black, darker");
    expect_recovery(Blind::turned, 90, 0.6, "turned, darker");
    expect_recovery(Blind::gone, 90, 1.5, "gone, lighter");
}

/// An empty road, no picture for `gone_s`, then the road changed by `change`: what is said in the first 5 s and at
/// their end.
struct Return {
    bool ever_learning = false;
    bool ever_valid = false;
    Reason at_end = Reason::ok;
};

Return after_a_pause(double gone_s, const Change &change) {
    constexpr double slow_rate = 10.0;
    constexpr int seen = 80; // pictures
    constexpr int looks = 55;
    Scene scene(picture, lane_count, 1);
    Counter counter(scene.lanes(line_m, 45, Direction::down));
    for (int i = 0; i < seen; ++i) {
        counter.feed(scene.draw({}), i / slow_rate);
    }
    const double back_s = seen / slow_rate + gone_s;
    counter.miss(back_s - 1 / slow_rate);
    Return said;
    for (int i = 0; i < looks; ++i) {
        cv::Mat frame = scene.draw({});
        change(frame, i);
        counter.feed(frame, back_s + i / slow_rate);
        const auto now = counter.glance().lanes[0];
        said.ever_learning = said.ever_learning || now.reason == Reason::learning;
        said.ever_valid = said.ever_valid || now.valid;
        said.at_end = now.reason;
    }
    return said;
}

void after_ten_minutes_or_in_another_light_the_road_is_learnt_anew() {
    const auto same = [](cv::Mat &, int) {};
    const auto half_in_shade = [](cv::Mat &frame, int) {
        cv::Mat left = frame.colRange(0, frame.cols / 2);
        left.convertTo(left, -1, 0.5);
    };
    TEST_ASSERT_FALSE(after_a_pause(540, same).ever_learning);
    TEST_ASSERT_TRUE(after_a_pause(660, same).ever_learning);
    TEST_ASSERT_FALSE(after_a_pause(90, same).ever_learning);
    const Return shaded = after_a_pause(90, half_in_shade);
    TEST_ASSERT_TRUE(shaded.ever_learning);
    TEST_ASSERT_EQUAL_INT(static_cast<int>(Reason::ok), static_cast<int>(shaded.at_end));
}

void a_camera_that_was_moved_while_it_was_blind_is_not_believed_on_the_old_road() {
    const auto move_by = [](double right_px) {
        return [right_px](cv::Mat &frame, int) {
            const cv::Matx23d move(1, 0, right_px, 0, 1, 0);
            cv::warpAffine(frame.clone(), frame, move, frame.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
        };
    };
    const auto turn = [](cv::Mat &frame, int) { cv::flip(frame.clone(), frame, -1); };
    const Return shifted = after_a_pause(90, move_by(25));
    TEST_ASSERT_FALSE(shifted.ever_valid);
    TEST_ASSERT_EQUAL_INT(static_cast<int>(Reason::moved), static_cast<int>(shifted.at_end));
    TEST_ASSERT_FALSE(after_a_pause(90, move_by(90)).ever_valid);
    TEST_ASSERT_FALSE(after_a_pause(90, turn).ever_valid);
}

void a_start_with_a_queue_is_said_and_counted_all_the_same() {
    Scene scene(picture, lane_count, 1);
    Counter counter(scene.lanes(line_m, 45, Direction::down));
    for (int i = 0; i < 150; ++i) {
        counter.feed(scene.draw(queue({3, 2, 0})), i / rate);
    }
    const Record record = counter.record();
    TEST_ASSERT_FALSE(record.lanes[0].valid);
    TEST_ASSERT_EQUAL_INT(static_cast<int>(elmopp::Reason::learning), static_cast<int>(record.lanes[0].reason));
    TEST_ASSERT_GREATER_OR_EQUAL_INT(4, *record.lanes[0].present + *record.lanes[1].present);
    TEST_ASSERT_EQUAL_INT(0, *record.lanes[2].present);
}

void an_empty_road_is_empty_and_valid() {
    Scene scene(picture, lane_count, 1);
    Counter counter(scene.lanes(line_m, 45, Direction::down));
    for (int i = 0; i < 150; ++i) {
        counter.feed(scene.draw({}), i / rate);
    }
    for (const auto &lane : counter.record().lanes) {
        TEST_ASSERT_TRUE(lane.valid);
        TEST_ASSERT_EQUAL_INT(0, *lane.present);
        TEST_ASSERT_EQUAL_INT64(0, lane.arrived_total);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, lane.occupancy);
    }
}

void a_reference_picture_spares_the_learning() {
    Scene scene(picture, lane_count, 1);
    Counter counter(scene.lanes(line_m, 45, Direction::down));
    counter.reference(scene.draw({}));
    for (int i = 0; i < 50; ++i) {
        counter.feed(scene.draw(queue({3, 2, 0})), i / rate);
    }
    const Record record = counter.record();
    TEST_ASSERT_TRUE(record.lanes[0].valid);
    TEST_ASSERT_INT_WITHIN(1, 5, *record.lanes[0].present + *record.lanes[1].present + *record.lanes[2].present);
}

/// A detector of the user's in place of the road's picture: boxes as the drawn scene has them, all of them right.
void what_a_finder_finds_is_counted_by_the_same_lines_and_zones() {
    Scene scene(picture, lane_count, 1);
    const SceneFlow flow = some_flow();
    Counter counter(scene.lanes(line_m, 40, Direction::down));
    std::vector<SceneCar> here;
    counter.find_with([&](const cv::Mat &) {
        std::vector<cv::Rect2d> boxes;
        for (const SceneCar &car : here) {
            if (car.at_m > 6 && car.at_m < 80) {
                boxes.push_back(scene.box_of(car));
            }
        }
        return boxes;
    });
    double wrong = 0;
    int looks = 0;
    for (int i = 0; i < static_cast<int>(flow_s * rate); ++i) {
        here = flow.at(i / rate);
        counter.feed(scene.draw(here), i / rate);
        if (i % 25 == 24 && i > 100) {
            const Record record = counter.record();
            const auto in_zone = [&](int lane) {
                return std::count_if(here.begin(), here.end(), [lane](const SceneCar &car) {
                    return car.lane == lane && car.at_m > line_m && car.at_m < 40;
                });
            };
            for (int lane = 0; lane < lane_count; ++lane) {
                wrong += std::abs(static_cast<double>(*record.lanes[static_cast<std::size_t>(lane)].present) -
                                  static_cast<double>(in_zone(lane)));
                ++looks;
                TEST_ASSERT_TRUE(record.lanes[static_cast<std::size_t>(lane)].valid);
            }
        }
    }
    counter.finish();
    std::vector<int> counted;
    for (const auto &lane : counter.record().lanes) {
        counted.push_back(static_cast<int>(lane.arrived_total));
    }
    expect_counts(flow, flow_s, counted, 1, "finder");
    TEST_ASSERT_TRUE_MESSAGE(wrong / looks < 0.6, std::to_string(wrong / looks).c_str());
}

/// A zone whose far end is slanted runs out into a corner: that is no place far away, full of vehicles.
void a_zone_with_slanted_ends_holds_no_more_vehicles_than_a_straight_one() {
    Scene scene(picture, lane_count, 1);
    elmopp::LaneFile file = scene.lanes(line_m, 45, Direction::down);
    for (elmopp::Lane &lane : file.lanes) {
        lane.zone_px[0].y -= 3; // the far end
        lane.zone_px[2].y += 6; // the near one
    }
    Counter counter(file);
    for (int i = 0; i < 200; ++i) {
        counter.feed(scene.draw(i < 100 ? std::vector<SceneCar>{} : queue({3, 2, 1})), i / rate);
    }
    const Record record = counter.record();
    const int present = *record.lanes[0].present + *record.lanes[1].present + *record.lanes[2].present;
    TEST_ASSERT_INT_WITHIN(1, 6, present);
}

void a_vehicle_inside_the_junction_is_said_and_nothing_else_is() {
    Scene scene(picture, lane_count, 1);
    elmopp::LaneFile file = scene.lanes(30, 0, Direction::down);
    file.junction_px = {scene.place(-5, 18, 0), scene.place(5, 18, 0), scene.place(5, 12, 0), scene.place(-5, 12, 0)};
    Counter counter(file);
    const auto film = [&](double from_s, double to_s, const std::vector<SceneCar> &cars) {
        for (int i = static_cast<int>(from_s * rate); i < static_cast<int>(to_s * rate); ++i) {
            counter.feed(scene.draw(cars), i / rate);
        }
        return *counter.record().junction;
    };
    TEST_ASSERT_FALSE(film(0, 1, {}).valid);
    const auto free = film(1, 5, {});
    TEST_ASSERT_TRUE(free.valid);
    TEST_ASSERT_FALSE(free.occupied);
    SceneCar car;
    car.lane = 1;
    car.at_m = 13;
    TEST_ASSERT_TRUE(film(5, 6, {car}).occupied);
    TEST_ASSERT_TRUE(film(6, 40, {car}).occupied);
    TEST_ASSERT_FALSE(film(40, 42, {}).occupied);
}

/// The end of a video is no fault of the camera: what was believed in its last second still is, and what was not is
/// not.
void the_last_record_is_as_things_were_in_the_last_second() {
    Scene scene(picture, lane_count, 1);
    const SceneFlow flow = some_flow();
    for (const int frames : {50, 150}) {
        Counter counter(scene.lanes(line_m, 0, Direction::down));
        for (int i = 0; i < frames; ++i) {
            counter.feed(scene.draw(flow.at(i / rate)), i / rate);
        }
        const Record before = counter.record();
        counter.finish();
        const Record last = counter.record();
        for (std::size_t lane = 0; lane < lane_count; ++lane) {
            TEST_ASSERT_EQUAL(frames == 150, last.lanes[lane].valid);
            TEST_ASSERT_EQUAL_INT(static_cast<int>(before.lanes[lane].reason),
                                  static_cast<int>(last.lanes[lane].reason));
            TEST_ASSERT_EQUAL_DOUBLE(before.lanes[lane].confidence, last.lanes[lane].confidence);
        }
        TEST_ASSERT_GREATER_OR_EQUAL_INT64(before.lanes[1].arrived_total, last.lanes[1].arrived_total);
    }
}

void totals_are_the_sum_of_inflows_and_never_decrease() {
    Scene scene(picture, lane_count, 1);
    const SceneFlow flow = some_flow();
    Counter counter(scene.lanes(line_m, 0, Direction::down));
    std::vector<std::int64_t> sums(lane_count, 0);
    for (int i = 0; i < static_cast<int>(flow_s * rate); ++i) {
        counter.feed(scene.draw(flow.at(i / rate)), i / rate);
        if (i % 25 == 24) {
            const Record record = counter.record();
            for (std::size_t lane = 0; lane < lane_count; ++lane) {
                TEST_ASSERT_GREATER_OR_EQUAL_INT64(0, record.lanes[lane].inflow);
                sums[lane] += record.lanes[lane].inflow;
                TEST_ASSERT_EQUAL_INT64(sums[lane], record.lanes[lane].arrived_total);
            }
        }
    }
    TEST_ASSERT_GREATER_THAN_INT64(0, sums[0]);
}

} // namespace

void setUp() {
    cv::setNumThreads(1);
}

void tearDown() {}

int main() {
    UNITY_BEGIN();
    RUN_TEST(each_vehicle_is_counted_once_in_its_lane);
    RUN_TEST(hard_shadows_do_not_count);
    RUN_TEST(headlights_and_their_cones_are_no_vehicles_of_their_own);
    RUN_TEST(shaking_by_three_pixels_changes_nothing);
    RUN_TEST(dusk_and_dawn_change_nothing);
    RUN_TEST(every_other_frame_is_enough);
    RUN_TEST(a_third_of_the_frames_may_be_lost);
    RUN_TEST(vehicles_against_the_direction_do_not_count);
    RUN_TEST(fast_vehicles_against_the_direction_do_not_count);
    RUN_TEST(a_vehicle_that_rocks_on_the_line_is_one);
    RUN_TEST(a_vehicle_that_rocks_slantwise_in_short_steps_makes_no_progress);
    RUN_TEST(a_queue_that_builds_up_is_kept_for_90_seconds);
    RUN_TEST(a_camera_that_sees_again_is_believed_while_a_queue_stands);
    RUN_TEST(what_was_learnt_is_believed_in_other_brightness_too);
    RUN_TEST(after_ten_minutes_or_in_another_light_the_road_is_learnt_anew);
    RUN_TEST(a_camera_that_was_moved_while_it_was_blind_is_not_believed_on_the_old_road);
    RUN_TEST(a_start_with_a_queue_is_said_and_counted_all_the_same);
    RUN_TEST(an_empty_road_is_empty_and_valid);
    RUN_TEST(a_reference_picture_spares_the_learning);
    RUN_TEST(what_a_finder_finds_is_counted_by_the_same_lines_and_zones);
    RUN_TEST(a_zone_with_slanted_ends_holds_no_more_vehicles_than_a_straight_one);
    RUN_TEST(a_vehicle_inside_the_junction_is_said_and_nothing_else_is);
    RUN_TEST(the_last_record_is_as_things_were_in_the_last_second);
    RUN_TEST(totals_are_the_sum_of_inflows_and_never_decrease);
    return UNITY_END();
}
