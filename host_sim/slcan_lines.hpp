// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// SLCAN lines: what an adaptor's characters say to the program at the other end of its serial line.
///
/// Characters come in pieces of any length. A line ends with a carriage return; BEL is an answer by itself. What is too
/// long or no line of an adaptor is left out and counted, up to the next end.

#pragma once

extern "C" {
#include "slcan.h"
}

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <variant>

namespace elmopp {

/// An answer to something that was sent.
struct SlcanAnswer {
    bool good;
};

/// A line that an adaptor may say and that is neither: its version, frames that no junction sends.
struct SlcanOther {
    std::string line;
};

using SlcanEvent = std::variant<elmopp_frame_t, SlcanAnswer, SlcanOther>;

class SlcanLines {
  public:
    /// Takes characters; what they complete is behind what is in `events`.
    void take(const char *text, std::size_t length, std::deque<SlcanEvent> &events);

    /// Lines that were no line of an adaptor.
    [[nodiscard]] std::uint64_t rubbish() const {
        return rubbish_;
    }

  private:
    void end_line(std::deque<SlcanEvent> &events);

    std::string line_;
    bool overlong_ = false;
    std::uint64_t rubbish_ = 0;
};

} // namespace elmopp
