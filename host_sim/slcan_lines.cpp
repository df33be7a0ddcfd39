// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "slcan_lines.hpp"

#include <algorithm>

namespace elmopp {
namespace {

constexpr char line_end = '\r';
constexpr char refusal = '\a';

bool is_acknowledgement(const std::string &line) {
    return line.empty() || line == "z" || line == "Z";
}

/// Version, serial number, status flags, and frames that no junction sends.
bool is_other(const std::string &line) {
    const std::string letters = "VvNFTrR";
    const auto plain = [](char c) { return c >= '0' && c <= 'Z'; };
    return letters.find(line[0]) != std::string::npos && std::all_of(line.begin() + 1, line.end(), plain);
}

} // namespace

void SlcanLines::end_line(std::deque<SlcanEvent> &events) {
    elmopp_frame_t frame{};
    if (overlong_) {
        ++rubbish_;
    } else if (is_acknowledgement(line_)) {
        events.emplace_back(SlcanAnswer{true});
    } else if (elmopp_slcan_read(line_.data(), static_cast<std::uint32_t>(line_.size()), &frame)) {
        events.emplace_back(frame);
    } else if (is_other(line_)) {
        events.emplace_back(SlcanOther{line_});
    } else {
        ++rubbish_;
    }
    line_.clear();
    overlong_ = false;
}

void SlcanLines::take(const char *text, std::size_t length, std::deque<SlcanEvent> &events) {
    for (std::size_t k = 0; k < length; ++k) {
        const char character = text[k];
        if (character == line_end) {
            end_line(events);
        } else if (character == refusal) {
            rubbish_ += line_.empty() && !overlong_ ? 0U : 1U; // what stood before it has no end of its own
            line_.clear();
            overlong_ = false;
            events.emplace_back(SlcanAnswer{false});
        } else if (line_.size() < ELMOPP_SLCAN_LINE_MAX) {
            line_.push_back(character);
        } else {
            overlong_ = true;
        }
    }
}

} // namespace elmopp
