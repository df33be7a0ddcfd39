// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

// What the port to Linux decides without a socket: what somebody who looks on is told, and what a node breaks.

#include "breakage.hpp"
#include "can_socket.hpp"
#include "error.hpp"
#include "junction_view.hpp"
#include "overheard.hpp"

extern "C" {
#include "elmopp_can.h"
}

#include <algorithm>
#include <cstring>

void setUp(void) {}
void tearDown(void) {}

namespace {

using elmopp::Breakage;
using elmopp::Broken;
using elmopp::JunctionView;

elmopp_junction_t three_groups() {
    elmopp_junction_t site = bench_cross(3);
    for (unsigned g = 0; g < site.group_count; ++g) {
        std::strcpy(site.group[g].name, ("G" + std::to_string(g)).c_str());
    }
    return site;
}

bool has(const std::vector<std::string> &lines, const std::string &words) {
    return std::any_of(lines.begin(), lines.end(),
                       [&words](const std::string &line) { return line.find(words) != std::string::npos; });
}

void expect(const JunctionView &view, std::uint32_t now_ms, const std::vector<std::string> &words) {
    const auto lines = view.lines(now_ms);
    std::string all;
    for (const auto &line : lines) {
        all += line + "\n";
    }
    for (const auto &word : words) {
        TEST_ASSERT_TRUE_MESSAGE(has(lines, word), (word + " is not in\n" + all).c_str());
    }
}

void start(const elmopp_junction_t &site, JunctionView &view) {
    start_overheard(site, [&view](const elmopp_frame_t &frame, std::uint32_t now_ms) { view.hear(frame, now_ms); }, 40);
}

void test_nobody_on_the_bus_is_silence() {
    const elmopp_junction_t site = three_groups();
    const JunctionView view(site);
    expect(view, 5000, {"controller  silent", "nobody commands", "camera silent", "no forecast"});
}

void test_a_running_junction_reads_as_english() {
    const elmopp_junction_t site = three_groups();
    JunctionView view(site);
    start(site, view);
    expect(view, bench.now_ms,
           {"controller  automatic, between stages", "G0 ", "GREEN", "G1 ", "red", "none 0.0 0.0 0.0"});
    const std::string waiting = std::to_string(bench.present_veh[1]);
    expect(view, bench.now_ms, {std::string(site.movement[1].name) + " " + waiting});
    TEST_ASSERT_FALSE(has(view.lines(bench.now_ms), "silent"));
    TEST_ASSERT_FALSE(has(view.lines(bench.now_ms), "(shows"));
    TEST_ASSERT_FALSE(has(view.lines(bench.now_ms), "spoilt"));
    expect(view, bench.now_ms + 3000, {"controller  silent", "nobody commands", "camera silent", "no forecast"});
}

void test_what_is_wrong_is_said() {
    const elmopp_junction_t site = three_groups();
    JunctionView view(site);
    start(site, view);
    bench.cameras_blind = 1;
    bench.broken.red = 0x7;
    bench_ticks(&bench, 12);
    expect(view, bench.now_ms, {"fail-safe, FAULT feedback differs at G", "camera black", "?"});
    bench.nodes_silent = 0xFF;
    bench_ticks(&bench, 10);
    expect(view, bench.now_ms, {"fail-safe", "flashing amber", "(node silent)"});
    bench.nodes_silent = 0;
    bench.own_fail_safe = true;
    bench_ticks(&bench, 2);
    expect(view, bench.now_ms, {"(node flashes by itself)"});
}

/// A lamp tick of a node that has been told this; true if the view says that it differs.
bool differs_after(JunctionView &view, const elmopp_lamps_t &told, const elmopp_lamps_t &shown) {
    static std::uint8_t counter = 0;
    static std::uint32_t now_ms = 0;
    now_ms += 100;
    const auto say = [&view](elmopp_frame_t frame) {
        elmopp_link_seal(&frame, &counter);
        view.hear(frame, now_ms);
    };
    say(elmopp_frames_lamp_command(&told, false, false));
    const elmopp_feedback_t feedback{shown, false, false};
    say(elmopp_frames_make_feedback(0, &feedback));
    return !view.seen(now_ms).differs[0].empty();
}

void test_lamps_differ_when_two_reports_in_a_row_say_so_and_flashing_ones_may_be_dark() {
    const elmopp_junction_t site = three_groups();
    JunctionView view(site);
    const elmopp_lamps_t red{0x7, 0, 0, 0};
    const elmopp_lamps_t green{0x6, 0, 0x1, 0};
    const elmopp_lamps_t flashing{0, 0x7, 0, 0x7};
    TEST_ASSERT_FALSE(differs_after(view, red, red));
    TEST_ASSERT_FALSE(differs_after(view, green, red)); // crossed on the bus
    TEST_ASSERT_TRUE(differs_after(view, green, red));
    TEST_ASSERT_FALSE(differs_after(view, green, green));
    for (const elmopp_lamps_t &shown : {elmopp_lamps_t{0, 0x7, 0, 0}, elmopp_lamps_t{}, elmopp_lamps_t{}}) {
        TEST_ASSERT_FALSE(differs_after(view, flashing, shown));
    }
    TEST_ASSERT_FALSE(differs_after(view, flashing, red));
    TEST_ASSERT_TRUE(differs_after(view, flashing, red));
}

void test_the_junction_camera_is_told_of_where_somebody_listens() {
    elmopp_junction_t site = three_groups();
    JunctionView deaf(site);
    start(site, deaf);
    TEST_ASSERT_FALSE(has(deaf.lines(bench.now_ms), "junction "));
    site.junction_wait_ds = 50;
    site.red_bound_ds = 2000;
    JunctionView view(site);
    start(site, view);
    expect(view, bench.now_ms, {"junction    camera silent"});
    bench.junction_seen = true;
    bench.occupancy = {true, true, 0};
    bench_ticks(&bench, 4);
    expect(view, bench.now_ms, {"junction    occupied"});
    bench.occupancy = {false, true, 0};
    bench_ticks(&bench, 4);
    expect(view, bench.now_ms, {"junction    clear"});
    bench.occupancy = {true, false, 6};
    bench_ticks(&bench, 4);
    expect(view, bench.now_ms, {"junction    camera covered"});
}

void test_what_a_neighbour_announces_is_told_until_it_falls_silent() {
    const elmopp_junction_t site = three_groups();
    JunctionView view(site);
    start(site, view);
    TEST_ASSERT_FALSE(has(view.lines(bench.now_ms), "neighbour"));
    const elmopp_outflow_t said{2.0F, 3.5F, 12.0F, 14, 0};
    elmopp_frame_t frame = elmopp_frames_make_outflow(0, &said);
    std::uint8_t counter = 0;
    elmopp_link_seal(&frame, &counter);
    view.hear(frame, bench.now_ms);
    expect(view, bench.now_ms, {", neighbour 2.0 3.5 12.0 of 14 s"});
    expect(view, bench.now_ms + 2999, {", neighbour 2.0 3.5 12.0 of 14 s"});
    expect(view, bench.now_ms + 3000, {", neighbour silent"});
}

void test_spoilt_frames_are_counted_and_change_nothing() {
    const elmopp_junction_t site = three_groups();
    JunctionView view(site);
    start(site, view);
    const auto before = view.lines(bench.now_ms);
    elmopp_frame_t frame{ELMOPP_CAN_LAMP_COMMAND_FRAME_ID, 8, {}};
    view.hear(frame, bench.now_ms);
    frame.id = 0x7FF;
    view.hear(frame, bench.now_ms);
    auto after = view.lines(bench.now_ms);
    TEST_ASSERT_EQUAL_STRING("spoilt frames: 1", after.back().c_str());
    after.pop_back();
    TEST_ASSERT_TRUE(before == after);
}

void refuse(const char *text) {
    const elmopp_junction_t site = three_groups();
    try {
        (void)elmopp::parse_breakage(text, site);
    } catch (const elmopp::BadRequest &error) {
        TEST_ASSERT_NOT_NULL(std::strstr(error.what(), "right would be"));
        return;
    }
    TEST_FAIL_MESSAGE(text);
}

/// A bus on which so many frames have come, their ids in order.
struct Came {
    unsigned left;
    std::uint16_t next = 0;

    std::optional<elmopp_frame_t> receive() {
        if (left == 0) {
            return std::nullopt;
        }
        --left;
        return elmopp_frame_t{next++, 8, {}};
    }
};

void expect_taken(Came &bus, unsigned expected) {
    std::uint16_t wanted = bus.next;
    unsigned taken = 0;
    elmopp::take_what_came(bus, [&](const elmopp_frame_t &frame) {
        TEST_ASSERT_EQUAL_UINT16(wanted++, frame.id);
        ++taken;
    });
    TEST_ASSERT_EQUAL_UINT(expected, taken);
}

void test_a_flood_is_taken_in_pieces_and_in_order() {
    Came quiet{0};
    expect_taken(quiet, 0);
    Came few{3};
    expect_taken(few, 3);
    expect_taken(few, 0);
    Came flood{64 + 64 + 1};
    expect_taken(flood, 64);
    expect_taken(flood, 64);
    expect_taken(flood, 1);
}

void test_breakages_are_read_and_others_refused() {
    const elmopp_junction_t site = three_groups();
    const Breakage stuck = elmopp::parse_breakage("stuck:2:green@1500", site);
    TEST_ASSERT_EQUAL_UINT32(2, stuck.group);
    TEST_ASSERT_EQUAL_INT(ELMOPP_ASPECT_GREEN, stuck.aspect);
    TEST_ASSERT_EQUAL_UINT32(1500, stuck.at_ms);
    const Breakage named = elmopp::parse_breakage(std::string("stuck:") + site.group[1].name + ":4@0", site);
    TEST_ASSERT_EQUAL_UINT32(1, named.group);
    TEST_ASSERT_EQUAL_INT(ELMOPP_ASPECT_AMBER, named.aspect);
    TEST_ASSERT_EQUAL_UINT32(7, elmopp::parse_breakage("lose:7@1", site).count);
    TEST_ASSERT_EQUAL_UINT32(40, elmopp::parse_breakage("late:40@1", site).delay_ms);
    for (const char *const text :
         {"", "@", "stuck@1", "stuck:0@1", "stuck:3:green@1", "stuck:0:blue@1", "stuck:0:7@1", "stuck:0:green",
          "lose:0@1", "lose:1.5@1", "lose:1@-1", "late:0@1", "late:1@x", "melt:1@1", "lose:1:2@1"}) {
        refuse(text);
    }
}

elmopp_frame_t numbered(std::uint8_t number) {
    return {0x90, 8, {number}};
}

void test_a_node_loses_and_delays_what_it_was_told_to() {
    Broken lossy({{Breakage::Kind::lose, 0, ELMOPP_ASPECT_DARK, 2, 0, 200}});
    TEST_ASSERT_EQUAL_size_t(1, lossy.pass_on(numbered(0), 199).size());
    TEST_ASSERT_EQUAL_size_t(0, lossy.pass_on(numbered(1), 200).size());
    TEST_ASSERT_EQUAL_size_t(0, lossy.pass_on(numbered(2), 300).size());
    TEST_ASSERT_EQUAL_size_t(1, lossy.pass_on(numbered(3), 400).size());
    Broken slow({{Breakage::Kind::late, 0, ELMOPP_ASPECT_DARK, 0, 150, 100}});
    TEST_ASSERT_EQUAL_size_t(1, slow.pass_on(numbered(0), 0).size());
    TEST_ASSERT_EQUAL_size_t(0, slow.pass_on(numbered(1), 100).size());
    TEST_ASSERT_EQUAL_size_t(0, slow.pass_on(numbered(2), 200).size());
    const auto late = slow.pass_on(numbered(3), 300);
    TEST_ASSERT_EQUAL_size_t(1, late.size());
    TEST_ASSERT_EQUAL_UINT8(1, late.front().data[0]);
}

void test_a_stuck_lamp_burns_from_its_time_on() {
    const Broken broken({{Breakage::Kind::stuck, 1, ELMOPP_ASPECT_GREEN, 0, 0, 500}});
    const elmopp_lamps_t red{0x3, 0, 0, 0};
    TEST_ASSERT_EQUAL_HEX16(0, broken.burning(red, 499).green);
    TEST_ASSERT_EQUAL_HEX16(0x2, broken.burning(red, 500).green);
    TEST_ASSERT_EQUAL_HEX16(0x1, broken.burning(red, 500).red);
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_nobody_on_the_bus_is_silence);
    RUN_TEST(test_a_running_junction_reads_as_english);
    RUN_TEST(test_what_is_wrong_is_said);
    RUN_TEST(test_lamps_differ_when_two_reports_in_a_row_say_so_and_flashing_ones_may_be_dark);
    RUN_TEST(test_the_junction_camera_is_told_of_where_somebody_listens);
    RUN_TEST(test_what_a_neighbour_announces_is_told_until_it_falls_silent);
    RUN_TEST(test_spoilt_frames_are_counted_and_change_nothing);
    RUN_TEST(test_a_flood_is_taken_in_pieces_and_in_order);
    RUN_TEST(test_breakages_are_read_and_others_refused);
    RUN_TEST(test_a_node_loses_and_delays_what_it_was_told_to);
    RUN_TEST(test_a_stuck_lamp_burns_from_its_time_on);
    return UNITY_END();
}
