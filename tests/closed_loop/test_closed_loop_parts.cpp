// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// What the closed loop is made of, each by itself: the drawing, the witness of the lamps, the list of troubles.

#include "bus.hpp"
#include "error.hpp"
#include "road_view.hpp"
#include "sites.hpp"
#include "witness.hpp"

#include <opencv2/imgproc.hpp>
#include <unity.h>

#include <string>
#include <vector>

using namespace elmopp;

extern "C" void setUp(void) {
    cv::setNumThreads(1);
}
extern "C" void tearDown(void) {}

namespace {

const cv::Size picture(320, 180);
const RoadShape shape{3, 124.0, 0.0, 22.0};
const RoadMast mast{10.0, 8.0, 49.0, 5.1};

RoadBody a_car(double ahead_m, const cv::Scalar &paint) {
    return {ahead_m, 1.5 * road_lane_m, 0.0, 4.4, 1.8, 1.5, paint, false, false};
}

cv::Mat drawn(const std::string &weather, std::uint64_t seed, const std::vector<RoadBody> &bodies) {
    RoadView view(picture, shape, mast, RoadWeather::of(weather), seed);
    return view.draw(bodies, {RoadLamp::red, RoadLamp::green, RoadLamp::amber}, 1.0);
}

/// Pixels that differ by more than the noise of both.
cv::Mat changed(const cv::Mat &a, const cv::Mat &b) {
    cv::Mat apart;
    cv::absdiff(a, b, apart);
    cv::cvtColor(apart, apart, cv::COLOR_BGR2GRAY);
    return apart > 25;
}

void test_the_same_seed_draws_the_same_picture_in_every_weather() {
    for (const std::string &weather : RoadWeather::names()) {
        const std::vector<RoadBody> bodies{a_car(40, {30, 40, 200})};
        TEST_ASSERT_EQUAL_DOUBLE(0.0, cv::norm(drawn(weather, 5, bodies), drawn(weather, 5, bodies)));
        TEST_ASSERT_TRUE(cv::norm(drawn(weather, 5, bodies), drawn(weather, 6, bodies)) > 0.0);
    }
}

void test_a_vehicle_is_drawn_where_it_is_and_nowhere_else() {
    RoadView view(picture, shape, mast, RoadWeather::of("day"), 3);
    const cv::Mat mask = changed(drawn("day", 3, {}), drawn("day", 3, {a_car(50, {250, 250, 250})}));
    std::vector<cv::Point2f> corners;
    for (const double ahead : {50.2, 45.4}) {
        for (const double aside : {1.5 * road_lane_m - 1.1, 1.5 * road_lane_m + 1.1}) {
            for (const double up : {0.0, 1.6}) {
                corners.emplace_back(view.place(ahead, aside, up));
            }
        }
    }
    cv::Rect box = cv::boundingRect(corners);
    box = {box.x - 2, box.y - 2, box.width + 4, box.height + 4}; // a lens is soft
    TEST_ASSERT_GREATER_THAN_INT(box.area() / 4, cv::countNonZero(mask(box)));
    cv::Mat outside = mask.clone();
    outside(box).setTo(0);
    TEST_ASSERT_LESS_OR_EQUAL_INT(3, cv::countNonZero(outside));
}

void test_who_is_nearer_hides_who_is_farther() {
    const cv::Scalar white(250, 250, 250);
    const cv::Scalar black(15, 15, 15);
    RoadBody lorry = a_car(45, black);
    lorry.length_m = 6.5;
    lorry.height_m = 3.2;
    lorry.width_m = 2.4;
    lorry.boxy = true;
    const RoadBody hidden = a_car(52, white);
    // Behind a lorry a white car changes nothing but what looks over or past it.
    const int seen = cv::countNonZero(changed(drawn("day", 3, {lorry}), drawn("day", 3, {hidden, lorry})));
    const int alone = cv::countNonZero(changed(drawn("day", 3, {}), drawn("day", 3, {hidden})));
    TEST_ASSERT_LESS_THAN_INT(alone / 3, seen);
}

void test_headlights_light_the_road_before_a_vehicle() {
    RoadView view(picture, shape, mast, RoadWeather::of("headlights"), 3);
    const cv::Point2d before = view.place(56, 1.5 * road_lane_m, 0);
    const auto light_at = [&](const cv::Mat &seen) {
        return cv::mean(seen(cv::Rect(cv::Point(before) - cv::Point(2, 2), cv::Size(5, 5))))[1];
    };
    const double dark = light_at(drawn("headlights", 3, {}));
    TEST_ASSERT_TRUE(light_at(drawn("headlights", 3, {a_car(50, {90, 90, 90})})) > 1.5 * dark);
}

elmopp_lamps_t lamps_of(std::uint16_t red, std::uint16_t amber, std::uint16_t green) {
    return {red, amber, green, 0};
}

// four_way: group 0 N.L conflicts with 4 E.M (intergreen 5.0 s), not with 1 N.M.
constexpr std::uint16_t nl = 1U << 0U;
constexpr std::uint16_t nm = 1U << 1U;
constexpr std::uint16_t em = 1U << 4U;

void test_the_witness_sees_conflicting_groups_off_red() {
    Witness witness(elmopp_site_four_way);
    witness.see(lamps_of(em, 0, nl | nm));
    TEST_ASSERT_EQUAL_UINT64(0, witness.findings().conflicts);
    witness.see(lamps_of(0, em, nl)); // amber is off red
    TEST_ASSERT_EQUAL_UINT64(1, witness.findings().conflicts);
    witness.see(lamps_of(em, em, nl)); // red-amber is not
    TEST_ASSERT_EQUAL_UINT64(1, witness.findings().conflicts);
    witness.see(lamps_of(0, 0, nl | em));
    TEST_ASSERT_EQUAL_UINT64(2, witness.findings().conflicts);
    elmopp_lamps_t flashing = lamps_of(0, nl | em, 0);
    flashing.flash = nl | em;
    witness.see(flashing);
    TEST_ASSERT_EQUAL_UINT64(2, witness.findings().conflicts);
    TEST_ASSERT_EQUAL_UINT64(5, witness.findings().ticks);
}

std::uint64_t early_after(unsigned red_ds) {
    Witness witness(elmopp_site_four_way);
    witness.see(lamps_of(em, 0, nl));
    for (unsigned i = 0; i < red_ds; ++i) {
        witness.see(lamps_of(nl | em, 0, 0));
    }
    witness.see(lamps_of(nl, 0, em));
    return witness.findings().early_greens;
}

void test_the_witness_sees_a_green_before_its_intergreen_is_over() {
    TEST_ASSERT_EQUAL_UINT16(50, elmopp_site_four_way.intergreen_ds[0][4]);
    TEST_ASSERT_EQUAL_UINT64(0, early_after(50));
    TEST_ASSERT_EQUAL_UINT64(1, early_after(49));
    TEST_ASSERT_EQUAL_UINT64(1, early_after(0));
}

std::uint64_t short_ambers_after(unsigned amber_ds, const elmopp_lamps_t &then) {
    Witness witness(elmopp_site_four_way);
    witness.see(lamps_of(em, 0, nl));
    for (unsigned i = 0; i < amber_ds; ++i) {
        witness.see(lamps_of(em, nl, 0));
    }
    witness.see(then);
    witness.see(lamps_of(nl | em, 0, 0));
    return witness.findings().short_ambers;
}

void test_the_witness_sees_a_skipped_and_a_short_amber_and_asks_none_of_who_flashes() {
    TEST_ASSERT_EQUAL_UINT16(30, elmopp_site_four_way.group[0].amber_ds);
    const elmopp_lamps_t red = lamps_of(nl | em, 0, 0);
    TEST_ASSERT_EQUAL_UINT64(0, short_ambers_after(30, red));
    TEST_ASSERT_EQUAL_UINT64(1, short_ambers_after(29, red));
    TEST_ASSERT_EQUAL_UINT64(1, short_ambers_after(0, red));
    elmopp_lamps_t flashing = lamps_of(0, nl | em, 0);
    flashing.flash = nl | em;
    TEST_ASSERT_EQUAL_UINT64(0, short_ambers_after(0, flashing));
    TEST_ASSERT_EQUAL_UINT64(0, short_ambers_after(10, flashing));
}

void test_troubles_are_read_as_they_are_written() {
    const auto troubles = parse_troubles("black:N@60-90.5,lose:10@0-5,reset@200", elmopp_site_four_way);
    TEST_ASSERT_EQUAL_UINT(3, troubles.size());
    TEST_ASSERT_EQUAL_STRING("black", troubles[0].kind.c_str());
    TEST_ASSERT_EQUAL_STRING("N", troubles[0].who.c_str());
    TEST_ASSERT_EQUAL_DOUBLE(60.0, troubles[0].from_s);
    TEST_ASSERT_EQUAL_DOUBLE(90.5, troubles[0].to_s);
    TEST_ASSERT_EQUAL_STRING("10", troubles[1].who.c_str());
    TEST_ASSERT_EQUAL_DOUBLE(200.0, troubles[2].from_s);
    TEST_ASSERT_TRUE(parse_troubles("", elmopp_site_four_way).empty());
}

void test_a_wrong_trouble_is_refused_by_name() {
    for (const char *const wrong : {"black", "black:X@1-2", "black@1-2", "fog:N@1-2", "black:N@5-5", "black:N@-1",
                                    "lose:101@0-5", "lose@0-5", "reset:N@3", "black:N@x-3", "turn:all@3-x"}) {
        bool refused = false;
        try {
            (void)parse_troubles(wrong, elmopp_site_four_way);
        } catch (const BadRequest &request) {
            refused = std::string(request.what()).find(wrong) != std::string::npos;
        }
        TEST_ASSERT_TRUE_MESSAGE(refused, wrong);
    }
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_the_same_seed_draws_the_same_picture_in_every_weather);
    RUN_TEST(test_a_vehicle_is_drawn_where_it_is_and_nowhere_else);
    RUN_TEST(test_who_is_nearer_hides_who_is_farther);
    RUN_TEST(test_headlights_light_the_road_before_a_vehicle);
    RUN_TEST(test_the_witness_sees_conflicting_groups_off_red);
    RUN_TEST(test_the_witness_sees_a_green_before_its_intergreen_is_over);
    RUN_TEST(test_the_witness_sees_a_skipped_and_a_short_amber_and_asks_none_of_who_flashes);
    RUN_TEST(test_troubles_are_read_as_they_are_written);
    RUN_TEST(test_a_wrong_trouble_is_refused_by_name);
    return UNITY_END();
}
