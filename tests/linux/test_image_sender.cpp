// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

// The sending end against the receiving one of the firmware, and against one that is not there, refuses, falls silent
// or is busy: what it sends, how fast, and what it says.

#include "image_sender.hpp"
#include "transfer_words.hpp"

extern "C" {
#include "elmopp/transfer.h"
#include "segments.h"
#include "unity.h"
}

#include <cstring>
#include <string>
#include <vector>

void setUp(void) {}
void tearDown(void) {}

namespace {

using elmopp::ImageSender;
using State = elmopp::ImageSender::State;

constexpr std::uint32_t tick_ms = 100;
constexpr std::size_t image_bytes = 34500;

std::vector<std::uint8_t> image_of(std::size_t length) {
    std::vector<std::uint8_t> image(length);
    for (std::size_t i = 0; i < length; ++i) {
        image[i] = static_cast<std::uint8_t>(i * 7 + i / 256);
    }
    return image;
}

/// A controller that takes segments and ticks; from outside it can be told what to report.
struct Receiver {
    elmopp_transfer_t transfer{};
    std::vector<std::uint8_t> got = std::vector<std::uint8_t>(40000);
    unsigned frames = 0;
    unsigned in_this_tick = 0;
    unsigned most_in_a_tick = 0;
    bool whole = false;
    bool deaf = false;
    std::vector<elmopp_frame_t> sent;

    void take(const elmopp_frame_t &frame) {
        const elmopp_frame_t expected = segments_frame(image.data(), static_cast<std::uint32_t>(image.size()), frames);
        TEST_ASSERT_EQUAL_HEX16(SEGMENTS_TRANSFER, frame.id);
        TEST_ASSERT_EQUAL_MEMORY(expected.data, frame.data, 8);
        ++frames;
        most_in_a_tick = std::max(most_in_a_tick, ++in_this_tick);
        if (deaf) {
            return;
        }
        if (elmopp_transfer_announced(&frame) != 0) {
            elmopp_transfer_begin(&transfer, &frame, got.data());
        } else {
            whole = elmopp_transfer_take(&transfer, &frame) == ELMOPP_TRANSFER_WHOLE;
        }
    }

    void tick() {
        in_this_tick = 0;
        elmopp_frame_t flow{};
        if (elmopp_transfer_flow(&transfer, &flow)) {
            sent.push_back(flow);
        }
    }

    void report(elmopp_transfer_state_t state, elmopp_transfer_reason_t reason = ELMOPP_TRANSFER_NO_REASON) {
        elmopp_transfer_report_t said{};
        said.kind = ELMOPP_TRANSFER_WEIGHTS;
        said.state = state;
        said.reason = reason;
        said.left_s = 300;
        sent.push_back(elmopp_transfer_make_report(&said));
    }

    std::vector<std::uint8_t> image;
};

struct Bus {
    Receiver receiver;
    ImageSender sender;
    std::uint32_t now_ms = 4294967000U; // it wraps

    explicit Bus(std::size_t length, bool until_kept = false) : sender(image_of(length), until_kept, 4294967000U) {
        receiver.image = image_of(length);
    }

    void pass() {
        for (const elmopp_frame_t &frame : receiver.sent) {
            sender.hear(frame, now_ms);
        }
        receiver.sent.clear();
        if (const auto frame = sender.due(now_ms)) {
            receiver.take(*frame);
        }
        ++now_ms;
        if (now_ms % tick_ms == 0) {
            receiver.tick();
        }
    }

    void pass(std::uint32_t ms) {
        for (std::uint32_t k = 0; k < ms; ++k) {
            pass();
        }
    }

    void until(State state, std::uint32_t limit_ms) {
        for (std::uint32_t k = 0; k < limit_ms && sender.state() != state; ++k) {
            pass();
        }
        TEST_ASSERT_TRUE_MESSAGE(sender.state() == state, sender.said().c_str());
    }

    void expect_said(const char *words) const {
        TEST_ASSERT_NOT_NULL_MESSAGE(std::strstr(sender.said().c_str(), words), sender.said().c_str());
    }
};

void test_an_image_of_any_length_comes_over_a_block_a_tick() {
    for (const std::size_t length : {20U, 2228U, 4095U, 4096U, static_cast<unsigned>(image_bytes)}) {
        Bus bus(length);
        bus.until(State::waiting, 30000);
        TEST_ASSERT_TRUE(bus.receiver.whole);
        TEST_ASSERT_EQUAL_MEMORY(bus.receiver.image.data(), bus.receiver.got.data(), length);
        TEST_ASSERT_TRUE(bus.receiver.most_in_a_tick <= ELMOPP_TRANSFER_BLOCK);
    }
}

void test_on_trial_is_the_end_unless_it_is_to_be_waited_for() {
    for (const bool until_kept : {false, true}) {
        Bus bus(2228, until_kept);
        bus.until(State::waiting, 5000);
        bus.receiver.report(ELMOPP_TRANSFER_ON_TRIAL);
        bus.until(State::running, 10);
        TEST_ASSERT_EQUAL(!until_kept, bus.sender.done());
        bus.expect_said("weights: on trial, 300 s to go");
        for (unsigned k = 0; k < 20 && until_kept; ++k) {
            bus.pass(1000);
            bus.receiver.report(k < 18 ? ELMOPP_TRANSFER_ON_TRIAL : ELMOPP_TRANSFER_STORING);
        }
        if (until_kept) {
            bus.receiver.report(ELMOPP_TRANSFER_KEPT);
            bus.until(State::kept, 10);
            bus.expect_said("kept: it outlives a reset");
        }
    }
}

void test_nobody_who_answers_is_said_within_seconds() {
    Bus bus(2228);
    bus.receiver.deaf = true;
    bus.until(State::failed, 3000);
    bus.expect_said("no controller answers");
    TEST_ASSERT_EQUAL_UINT(1U, bus.receiver.frames);
}

void test_a_controller_that_falls_silent_is_noticed_in_every_state() {
    Bus sending(image_bytes);
    sending.until(State::sending, 3000);
    sending.pass(1000);
    sending.receiver.deaf = true;
    sending.until(State::failed, 3000);
    sending.expect_said("does not answer any more, after ");
    Bus waiting(2228);
    waiting.until(State::failed, 10000);
    waiting.expect_said("does not say what became of it");
    Bus running(2228, true);
    running.until(State::waiting, 5000);
    running.receiver.report(ELMOPP_TRANSFER_ON_TRIAL);
    running.until(State::running, 10);
    running.until(State::failed, 6000);
    running.expect_said("fallen silent during the trial");
}

void test_a_refusal_or_withdrawal_is_said_in_words_and_ends_it_at_once() {
    for (unsigned reason = ELMOPP_TRANSFER_LENGTH; reason <= ELMOPP_TRANSFER_TOO_SOON; ++reason) {
        Bus bus(image_bytes);
        bus.until(State::sending, 3000);
        bus.receiver.report(ELMOPP_TRANSFER_REFUSED, static_cast<elmopp_transfer_reason_t>(reason));
        bus.pass();
        const unsigned frames = bus.receiver.frames;
        bus.pass(500);
        TEST_ASSERT_TRUE(bus.sender.state() == State::failed);
        TEST_ASSERT_EQUAL_UINT(frames, bus.receiver.frames);
        bus.expect_said("weights: refused, ");
        TEST_ASSERT_TRUE(bus.sender.said().size() > std::strlen("weights: refused, ") + 3);
    }
    Bus bus(2228, true);
    bus.until(State::waiting, 5000);
    bus.receiver.report(ELMOPP_TRANSFER_ON_TRIAL);
    bus.until(State::running, 10);
    bus.receiver.report(ELMOPP_TRANSFER_WITHDRAWN, ELMOPP_TRANSFER_DISTRUSTED);
    bus.until(State::failed, 10);
    bus.expect_said("withdrawn, the old one runs again, its forecast was no better than the mean");
}

void test_who_comes_while_somebody_else_sends_waits_for_nothing_and_sends_nothing() {
    for (const auto state : {ELMOPP_TRANSFER_RECEIVING, ELMOPP_TRANSFER_ON_TRIAL, ELMOPP_TRANSFER_STORING}) {
        Bus bus(2228);
        bus.pass(900);
        bus.receiver.report(state);
        bus.until(State::failed, 10);
        bus.expect_said("another transfer is under way: ");
        TEST_ASSERT_EQUAL_UINT(0U, bus.receiver.frames);
    }
    Bus late(2228); // both have listened to silence
    late.until(State::asking, 2000);
    late.receiver.sent.clear();
    late.receiver.transfer.receiving = false;
    late.receiver.report(ELMOPP_TRANSFER_REFUSED, ELMOPP_TRANSFER_BUSY);
    late.until(State::failed, 10);
    late.expect_said("another one is being received");
}

void test_who_was_let_go_on_does_not_mind_that_somebody_else_is_refused() {
    Bus bus(image_bytes);
    bus.until(State::sending, 3000);
    bus.receiver.report(ELMOPP_TRANSFER_REFUSED, ELMOPP_TRANSFER_BUSY);
    bus.until(State::waiting, 30000);
    TEST_ASSERT_TRUE(bus.receiver.whole);
}

void test_another_receivers_flow_control_is_heeded() {
    Bus bus(2228);
    bus.until(State::asking, 2000);
    bus.receiver.deaf = true; // from here on a receiver by the standard answers, not ours
    bus.receiver.transfer.receiving = false;
    const auto flow = [&bus](std::uint8_t status, std::uint8_t block, std::uint8_t gap) {
        bus.receiver.sent.push_back({SEGMENTS_ACK, 3U, {static_cast<std::uint8_t>(0x30U | status), block, gap}});
    };
    for (unsigned k = 0; k < 5; ++k) { // wait
        bus.pass(1000);
        flow(1, 0, 0);
    }
    bus.pass(10);
    TEST_ASSERT_EQUAL_UINT(1U, bus.receiver.frames);
    flow(0, 3, 20);
    bus.pass(300);
    TEST_ASSERT_EQUAL_UINT(4U, bus.receiver.frames);
    flow(0, 0, 20); // no limit any more
    bus.pass(1000);
    TEST_ASSERT_UINT_WITHIN(2U, 54U, bus.receiver.frames);
    Bus full(2228);
    full.until(State::asking, 2000);
    full.receiver.deaf = true;
    full.receiver.transfer.receiving = false;
    full.receiver.sent.push_back({SEGMENTS_ACK, 3U, {0x32U, 0U, 0U}});
    full.until(State::failed, 10);
    full.expect_said("no room");
}

void test_every_report_has_words_whatever_it_names() {
    for (unsigned state = 0; state <= ELMOPP_TRANSFER_WITHDRAWN; ++state) {
        for (unsigned reason = 0; reason <= ELMOPP_TRANSFER_TOO_SOON; ++reason) {
            for (unsigned named = 0; named < 256; ++named) {
                elmopp_transfer_report_t report{};
                report.kind = static_cast<elmopp_transfer_kind_t>(named % 3);
                report.state = static_cast<elmopp_transfer_state_t>(state);
                report.reason = static_cast<elmopp_transfer_reason_t>(reason);
                report.first = static_cast<std::uint8_t>(named);
                report.second = static_cast<std::uint8_t>(255 - named);
                const std::string words = elmopp::in_words(report);
                TEST_ASSERT_TRUE(words.size() > 10 && words.find('\n') == std::string::npos);
            }
        }
    }
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_an_image_of_any_length_comes_over_a_block_a_tick);
    RUN_TEST(test_on_trial_is_the_end_unless_it_is_to_be_waited_for);
    RUN_TEST(test_nobody_who_answers_is_said_within_seconds);
    RUN_TEST(test_a_controller_that_falls_silent_is_noticed_in_every_state);
    RUN_TEST(test_a_refusal_or_withdrawal_is_said_in_words_and_ends_it_at_once);
    RUN_TEST(test_who_comes_while_somebody_else_sends_waits_for_nothing_and_sends_nothing);
    RUN_TEST(test_who_was_let_go_on_does_not_mind_that_somebody_else_is_refused);
    RUN_TEST(test_another_receivers_flow_control_is_heeded);
    RUN_TEST(test_every_report_has_words_whatever_it_names);
    return UNITY_END();
}
