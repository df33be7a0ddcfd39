// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The sending end of a transfer (elmopp/transfer.h), ISO 15765-2: what to send next, and what the answers mean.
///
/// It owns no socket and no clock: frames and milliseconds are arguments, so that a test can play the bus.

#pragma once

extern "C" {
#include "elmopp/transfer.h"
}

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace elmopp {

class ImageSender {
  public:
    enum class State {
        listening, ///< whether somebody else sends
        asking,    ///< the first frame is out
        sending,
        waiting, ///< everything is out
        running, ///< the image is on trial
        kept,
        failed
    };

    /// `until_kept`: on trial is not the end.
    ImageSender(std::vector<std::uint8_t> image, bool until_kept, std::uint32_t now_ms);

    /// The next frame, if one is due; also notices that nobody answers.
    std::optional<elmopp_frame_t> due(std::uint32_t now_ms);

    /// A TransferAck has come.
    void hear(const elmopp_frame_t &frame, std::uint32_t now_ms);

    [[nodiscard]] State state() const {
        return state_;
    }
    [[nodiscard]] bool done() const {
        return state_ == State::kept || state_ == State::failed || (state_ == State::running && !until_kept_);
    }
    /// The last report, and why it failed, in words.
    [[nodiscard]] const std::string &said() const {
        return said_;
    }
    [[nodiscard]] std::size_t sent_bytes() const {
        return at_;
    }

  private:
    void fail(std::string why);
    void enter(State state, std::uint32_t now_ms);
    void hear_flow(const elmopp_frame_t &frame, std::uint32_t now_ms);
    void hear_report(const elmopp_transfer_report_t &report, std::uint32_t now_ms);
    [[nodiscard]] elmopp_frame_t first_frame();
    [[nodiscard]] elmopp_frame_t next_frame();

    std::vector<std::uint8_t> image_;
    bool until_kept_;
    State state_ = State::listening;
    std::size_t at_ = 0;       ///< bytes that are out
    unsigned number_ = 1;      ///< of the next segment
    unsigned may_send_ = 0;    ///< segments
    bool no_limit_ = false;    ///< a block size of 0
    std::uint32_t gap_ms_ = 1; ///< between two segments
    std::uint32_t since_ms_;   ///< last answer, or change of state
    std::uint32_t sent_ms_ = 0;
    std::string said_;
};

} // namespace elmopp
