// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "image_sender.hpp"

#include "transfer_words.hpp"

extern "C" {
#include "elmopp_can.h"
}

#include <algorithm>
#include <iterator>

namespace elmopp {
namespace {

constexpr std::uint32_t listen_ms = 1300; ///< whoever is busy says so once a second
constexpr std::uint32_t answer_ms = 1500; ///< a lamp tick, and room for a lost frame
constexpr std::uint32_t verdict_ms = 3000;
constexpr std::uint32_t silence_ms = 5000; ///< a trial is told of once a second
constexpr std::size_t short_max = 4095;
constexpr unsigned flow = 3;
constexpr unsigned flow_go_on = 0;
constexpr unsigned flow_wait = 1;
constexpr unsigned gap_max_ms = 127; ///< from there on other units, and reserved values: the longest is right, too

bool is_busy(const elmopp_transfer_report_t &report) {
    return report.state == ELMOPP_TRANSFER_RECEIVING || report.state == ELMOPP_TRANSFER_ON_TRIAL ||
           report.state == ELMOPP_TRANSFER_STORING;
}

elmopp_frame_t empty_frame() {
    elmopp_frame_t frame{};
    frame.id = ELMOPP_CAN_TRANSFER_FRAME_ID;
    frame.length = ELMOPP_LINK_BYTES;
    return frame;
}

} // namespace

ImageSender::ImageSender(std::vector<std::uint8_t> image, bool until_kept, std::uint32_t now_ms)
    : image_(std::move(image)), until_kept_(until_kept), since_ms_(now_ms) {}

void ImageSender::fail(std::string why) {
    state_ = State::failed;
    said_ = std::move(why);
}

void ImageSender::enter(State state, std::uint32_t now_ms) {
    state_ = state;
    since_ms_ = now_ms;
}

elmopp_frame_t ImageSender::first_frame() {
    elmopp_frame_t frame = empty_frame();
    const std::size_t length = image_.size();
    std::size_t head = 2;
    if (length > short_max) {
        frame.data[0] = 0x10;
        for (std::size_t i = 0; i < 4; ++i) {
            frame.data[2 + i] = static_cast<std::uint8_t>((length >> (24 - 8 * i)) & 0xFFU);
        }
        head = 6;
    } else {
        frame.data[0] = static_cast<std::uint8_t>(0x10U | (length >> 8U));
        frame.data[1] = static_cast<std::uint8_t>(length & 0xFFU);
    }
    at_ = ELMOPP_LINK_BYTES - head;
    std::copy_n(image_.begin(), at_, std::begin(frame.data) + static_cast<std::ptrdiff_t>(head));
    return frame;
}

elmopp_frame_t ImageSender::next_frame() {
    elmopp_frame_t frame = empty_frame();
    const std::size_t piece = std::min<std::size_t>(image_.size() - at_, ELMOPP_LINK_BYTES - 1U);
    frame.data[0] = static_cast<std::uint8_t>(0x20U | number_);
    std::copy_n(image_.begin() + static_cast<std::ptrdiff_t>(at_), piece, std::begin(frame.data) + 1);
    at_ += piece;
    number_ = (number_ + 1U) % 16U;
    return frame;
}

std::optional<elmopp_frame_t> ImageSender::due(std::uint32_t now_ms) {
    const std::uint32_t waited_ms = now_ms - since_ms_;
    switch (state_) {
    case State::listening:
        if (waited_ms >= listen_ms) {
            enter(State::asking, now_ms);
            return first_frame();
        }
        break;
    case State::asking:
        if (waited_ms >= answer_ms) {
            fail("no controller answers");
        }
        break;
    case State::sending:
        if (may_send_ == 0 && !no_limit_) {
            if (waited_ms >= answer_ms) {
                fail("the controller does not answer any more, after " + std::to_string(at_) + " of " +
                     std::to_string(image_.size()) + " bytes");
            }
        } else if (now_ms - sent_ms_ >= gap_ms_) {
            sent_ms_ = now_ms;
            since_ms_ = now_ms;
            may_send_ -= no_limit_ ? 0U : 1U;
            const elmopp_frame_t frame = next_frame();
            if (at_ == image_.size()) {
                enter(State::waiting, now_ms);
            }
            return frame;
        }
        break;
    case State::waiting:
        if (waited_ms >= verdict_ms) {
            fail("everything was sent and the controller does not say what became of it");
        }
        break;
    case State::running:
        if (waited_ms >= silence_ms) {
            fail("the controller has fallen silent during the trial");
        }
        break;
    case State::kept:
    case State::failed:
        break;
    }
    return std::nullopt;
}

void ImageSender::hear_flow(const elmopp_frame_t &frame, std::uint32_t now_ms) {
    const unsigned status = frame.data[0] & 0x0FU;
    if (state_ != State::asking && state_ != State::sending) {
        return;
    }
    since_ms_ = now_ms;
    if (status == flow_go_on) {
        state_ = State::sending;
        may_send_ = frame.data[1];
        no_limit_ = frame.data[1] == 0;
        gap_ms_ = std::min<unsigned>(frame.data[2], gap_max_ms);
    } else if (status != flow_wait) {
        fail("the controller has no room for it");
    }
}

/// Whoever was told to go on is not meant when somebody else is refused.
void ImageSender::hear_report(const elmopp_transfer_report_t &report, std::uint32_t now_ms) {
    const bool began = state_ == State::sending || state_ == State::waiting || state_ == State::running;
    const bool of_others = report.state == ELMOPP_TRANSFER_REFUSED && report.reason == ELMOPP_TRANSFER_BUSY;
    if (state_ == State::listening) {
        if (is_busy(report)) {
            fail("another transfer is under way: " + in_words(report));
        }
        return;
    }
    if (began && of_others) {
        return;
    }
    since_ms_ = now_ms;
    said_ = in_words(report);
    if (report.state == ELMOPP_TRANSFER_REFUSED || report.state == ELMOPP_TRANSFER_WITHDRAWN) {
        fail(said_);
    } else if (report.state == ELMOPP_TRANSFER_KEPT && began) {
        state_ = State::kept;
    } else if (is_busy(report) && report.state != ELMOPP_TRANSFER_RECEIVING && began) {
        state_ = State::running;
    }
}

void ImageSender::hear(const elmopp_frame_t &frame, std::uint32_t now_ms) {
    elmopp_transfer_report_t report{};
    if (done() || frame.id != ELMOPP_CAN_TRANSFER_ACK_FRAME_ID) {
        return;
    }
    if (elmopp_transfer_read_report(&frame, &report)) {
        hear_report(report, now_ms);
    } else if (frame.length >= 3 && (frame.data[0] >> 4U) == flow) {
        if (state_ == State::listening) {
            fail("another transfer is under way");
        } else {
            hear_flow(frame, now_ms);
        }
    }
}

} // namespace elmopp
