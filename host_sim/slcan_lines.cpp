// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "slcan_lines.hpp"

#include <algorithm>
#include <optional>

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

/// What a line says; nothing if it is none.
std::optional<SlcanEvent> event_of(const std::string &line) {
    elmopp_frame_t frame{};
    if (is_acknowledgement(line)) {
        return SlcanAnswer{true};
    }
    if (elmopp_slcan_read(line.data(), static_cast<std::uint32_t>(line.size()), &frame)) {
        return frame;
    }
    if (is_other(line)) {
        return SlcanOther{line};
    }
    return std::nullopt;
}

} // namespace

void SlcanLines::end_line(std::deque<SlcanEvent> &events) {
    if (const auto event = overlong_ ? std::nullopt : event_of(line_)) {
        events.push_back(*event);
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
