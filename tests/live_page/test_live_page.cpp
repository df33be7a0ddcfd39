// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

// What the live page is fed with: the stream for onlookers of every speed, and a bus as decision lines.

#include "bus_seconds.hpp"
#include "event_stream.hpp"
#include "junction_json.hpp"
#include "overheard.hpp"

extern "C" {
#include "elmopp_can.h"
}

#include <nlohmann/json.hpp>

#include <chrono>
#include <thread>

void setUp(void) {}
void tearDown(void) {}

namespace {

using elmopp::BusSeconds;
using elmopp::EventStream;
using Json = nlohmann::json;

void expect(const std::string &wanted, const std::string &text) {
    TEST_ASSERT_EQUAL_STRING(wanted.c_str(), text.c_str());
}

std::size_t count_of(const std::string &text, const std::string &words) {
    std::size_t count = 0;
    for (auto at = text.find(words); at != std::string::npos; at = text.find(words, at + words.size())) {
        ++count;
    }
    return count;
}

// --- the stream ---

void test_an_onlooker_is_told_each_event_once(void) {
    EventStream stream;
    std::uint64_t seen = 0;
    stream.begin("{\"a\":1}");
    expect("retry: 1000\nevent: run\ndata: {\"a\":1}\n\n", stream.after(seen));
    stream.second("{\"t_s\":0}");
    stream.controls("{\"paused\":true}");
    expect("event: second\ndata: {\"t_s\":0}\n\nevent: controls\ndata: {\"paused\":true}\n\n", stream.after(seen));
}

void test_who_comes_late_is_told_the_run_its_seconds_and_the_last_controls(void) {
    EventStream stream;
    stream.begin("{\"old\":1}");
    stream.second("{\"t_s\":99}");
    stream.begin("{\"run\":1}");
    stream.controls("{\"speed\":1}");
    stream.second("{\"t_s\":0}");
    stream.controls("{\"speed\":2}");
    std::uint64_t seen = 0;
    expect("retry: 1000\nevent: run\ndata: {\"run\":1}\n\nevent: second\ndata: {\"t_s\":0}\n\nevent: controls\ndata: "
           "{\"speed\":2}\n\n",
           stream.after(seen));
}

void test_who_falls_behind_is_told_what_is_kept_from_its_beginning(void) {
    EventStream stream;
    stream.begin("{}");
    std::uint64_t seen = 0;
    (void)stream.after(seen);
    for (std::size_t t = 0; t < elmopp::events_kept; ++t) {
        stream.second(std::to_string(t));
    }
    std::uint64_t in_time = seen;
    TEST_ASSERT_EQUAL(0U, count_of(stream.after(in_time), "event: run")); // the last moment to get every one
    stream.second("x");
    const std::string text = stream.after(seen);
    TEST_ASSERT_EQUAL(1U, count_of(text, "event: run"));
    TEST_ASSERT_EQUAL(elmopp::events_kept, count_of(text, "event: second"));
    TEST_ASSERT_EQUAL(0U, count_of(text, "data: 0\n"));
}

void test_nothing_new_is_a_comment_after_a_second(void) {
    EventStream stream;
    stream.begin("{}");
    std::uint64_t seen = 0;
    (void)stream.after(seen);
    const auto begun = std::chrono::steady_clock::now();
    expect(": still here\n\n", stream.after(seen));
    TEST_ASSERT_TRUE(std::chrono::steady_clock::now() - begun > std::chrono::milliseconds(900));
}

void test_closing_lets_those_go_who_wait(void) {
    EventStream stream;
    std::thread closing([&stream] { stream.close(); });
    std::uint64_t seen = 0;
    while (!stream.after(seen).empty()) {
    }
    closing.join();
    TEST_ASSERT_TRUE(stream.is_closed());
    stream.second("{}");
    expect("", stream.after(seen));
}

// --- a bus ---

void start(const elmopp_junction_t &site, BusSeconds &seconds) {
    start_overheard(
        site, [&seconds](const elmopp_frame_t &frame, std::uint32_t now_ms) { seconds.hear(frame, now_ms); }, 100);
}

void test_a_line_says_what_the_frames_said(void) {
    const elmopp_junction_t site = bench_cross(3);
    BusSeconds seconds(site);
    start(site, seconds);
    (void)seconds.line(bench.now_ms);
    bench_ticks(&bench, 10);
    const Json line = Json::parse(seconds.line(bench.now_ms));
    TEST_ASSERT_EQUAL(1, line["t_s"].get<int>());
    TEST_ASSERT_EQUAL(ELMOPP_MODE_AUTOMATIC, line["mode"].get<int>());
    TEST_ASSERT_EQUAL(0, line["fault"].get<int>());
    TEST_ASSERT_EQUAL(0U, line["uncounted"].size());
    TEST_ASSERT_EQUAL(0U, line["differs"].size());
    TEST_ASSERT_EQUAL(3U, line["present"].size());
    for (std::size_t j = 0; j < 3; ++j) {
        TEST_ASSERT_TRUE(line["present"][j].get<double>() > 0.0);
    }
    const std::string aspects = line["aspects"];
    std::size_t green = 0;
    for (std::uint32_t g = 0; g < site.group_count; ++g) {
        const auto wanted = static_cast<char>('0' + elmopp_lamps_aspect(&bench.shown, g));
        TEST_ASSERT_EQUAL_CHAR(wanted, aspects[g]);
        green += aspects[g] == '3' ? 1U : 0U;
    }
    TEST_ASSERT_EQUAL(1U, green);
    TEST_ASSERT_EQUAL(bench.status.stage, line["stage"].get<unsigned>());
}

void test_a_line_names_the_lamps_that_do_not_as_they_are_told(void) {
    const elmopp_junction_t site = bench_cross(3);
    BusSeconds seconds(site);
    start(site, seconds);
    bench.broken.red = 0x7;
    bench_ticks(&bench, 2); // the controller does not give up as soon as that
    const Json line = Json::parse(seconds.line(bench.now_ms));
    TEST_ASSERT_EQUAL(ELMOPP_MODE_AUTOMATIC, line["mode"].get<int>());
    const std::string aspects = line["aspects"];
    for (std::uint32_t g = 0; g < site.group_count; ++g) {
        const std::string said = line["differs"].value(std::to_string(g), "");
        expect(aspects[g] == '1' ? "shows dark" : aspects[g] == '2' ? "shows amber" : "", said);
    }
    bench.nodes_silent = 0xFF;
    bench_ticks(&bench, 10);
    TEST_ASSERT_EQUAL_STRING(R"({"0":"node silent","1":"node silent","2":"node silent"})",
                             Json::parse(seconds.line(bench.now_ms))["differs"].dump().c_str());
}

elmopp_frame_t counts(std::uint8_t arrivals, std::uint16_t present, bool valid, std::uint8_t *counter) {
    std::array<elmopp_detector_report_t, ELMOPP_APPROACH_MOVEMENT_MAX> report{};
    report[0] = {present, arrivals, valid};
    elmopp_frame_t frame = elmopp_frames_make_counts(1, report.data(), ELMOPP_REASON_OK);
    elmopp_link_seal(&frame, counter);
    return frame;
}

void test_arrivals_are_what_the_running_counter_has_grown_by(void) {
    const elmopp_junction_t site = bench_cross(3);
    BusSeconds seconds(site);
    std::uint8_t counter = 0;
    const auto arrived = [&](std::uint8_t total) {
        seconds.hear(counts(total, 4, true, &counter), 1000);
        return Json::parse(seconds.line(1000))["arrived"][1].get<int>();
    };
    TEST_ASSERT_EQUAL(0, arrived(60)); // nobody knows since when
    TEST_ASSERT_EQUAL(3, arrived(63));
    TEST_ASSERT_EQUAL(5, arrived(4)); // modulo 64
    TEST_ASSERT_EQUAL(0, arrived(4));
}

void test_who_is_silent_is_named_and_not_taken_for_zero(void) {
    const elmopp_junction_t site = bench_cross(3);
    BusSeconds seconds(site);
    const Json nobody = Json::parse(seconds.line(0));
    TEST_ASSERT_FALSE(nobody.contains("mode"));
    TEST_ASSERT_FALSE(nobody.contains("model"));
    TEST_ASSERT_EQUAL_STRING("[0,1,2]", nobody["uncounted"].dump().c_str());
    std::uint8_t counter = 0;
    seconds.hear(counts(1, 4, true, &counter), 0);
    TEST_ASSERT_EQUAL_STRING("[0,2]", Json::parse(seconds.line(500))["uncounted"].dump().c_str());
    TEST_ASSERT_EQUAL_STRING("[0,1,2]", Json::parse(seconds.line(9000))["uncounted"].dump().c_str());
    seconds.hear(counts(1, 4, false, &counter), 9000);
    TEST_ASSERT_EQUAL_STRING("[0,1,2]", Json::parse(seconds.line(9000))["uncounted"].dump().c_str());
}

// --- the junction ---

void test_a_junction_is_told_with_what_belongs_together(void) {
    const elmopp_junction_t site = bench_cross(3);
    const Json json = elmopp::junction_json(site);
    TEST_ASSERT_EQUAL(site.approach_count, json["approaches"].size());
    TEST_ASSERT_EQUAL(site.movement_count, json["movements"].size());
    TEST_ASSERT_EQUAL_STRING("[1,2]", json["groups"][0]["conflicts"].dump().c_str());
    for (std::uint32_t s = 0; s < site.stage_count; ++s) {
        TEST_ASSERT_EQUAL(1U, json["stages"][s]["movements"].size());
    }
    TEST_ASSERT_EQUAL(ELMOPP_MODE_COUNT, json["modes"].size());
    TEST_ASSERT_EQUAL(ELMOPP_FAULT_COUNT, json["faults"].size());
}

} // namespace

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_an_onlooker_is_told_each_event_once);
    RUN_TEST(test_who_comes_late_is_told_the_run_its_seconds_and_the_last_controls);
    RUN_TEST(test_who_falls_behind_is_told_what_is_kept_from_its_beginning);
    RUN_TEST(test_nothing_new_is_a_comment_after_a_second);
    RUN_TEST(test_closing_lets_those_go_who_wait);
    RUN_TEST(test_a_line_says_what_the_frames_said);
    RUN_TEST(test_a_line_names_the_lamps_that_do_not_as_they_are_told);
    RUN_TEST(test_arrivals_are_what_the_running_counter_has_grown_by);
    RUN_TEST(test_who_is_silent_is_named_and_not_taken_for_zero);
    RUN_TEST(test_a_junction_is_told_with_what_belongs_together);
    return UNITY_END();
}
