// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "breakage.hpp"

#include "csv.hpp"
#include "error.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace elmopp {
namespace {

constexpr double most_ms = 86400000.0;
constexpr double most_frames = 1000000.0;

const std::array<const char *, ELMOPP_ASPECT_COUNT> aspect_names{"dark",  "red",         "red-amber", "green",
                                                                 "amber", "flash-amber", "flash-red"};

[[noreturn]] void refuse(const std::string &text, const std::string &right) {
    throw BadRequest("--break \"" + text + "\": right would be " + right);
}

std::uint32_t number(const std::string &text, const std::string &word, double lowest, double highest,
                     const std::string &what) {
    double value = 0.0;
    if (!parse_number(word, value) || value != std::floor(value) || value < lowest || value > highest) {
        refuse(text, "a whole number of " + what + " from " + format_number(lowest, 12) + " to " +
                         format_number(highest, 12) + " instead of \"" + word + "\"");
    }
    return static_cast<std::uint32_t>(value);
}

std::uint32_t group_of(const std::string &text, const std::string &word, const elmopp_junction_t &junction) {
    std::string names;
    for (std::uint32_t g = 0; g < junction.group_count; ++g) {
        if (word == junction.group[g].name || word == std::to_string(g)) {
            return g;
        }
        names += (g == 0 ? "" : ", ") + std::string(junction.group[g].name);
    }
    refuse(text, "one of the groups " + names + " instead of \"" + word + "\"");
}

elmopp_aspect_t aspect_of(const std::string &text, const std::string &word) {
    std::string names;
    for (std::size_t a = 0; a < aspect_names.size(); ++a) {
        if (word == aspect_names.at(a) || word == std::to_string(a)) {
            return static_cast<elmopp_aspect_t>(a);
        }
        names += (a == 0 ? "" : ", ") + std::string(aspect_names.at(a));
    }
    refuse(text, "one of the aspects " + names + " instead of \"" + word + "\"");
}

} // namespace

Breakage parse_breakage(const std::string &text, const elmopp_junction_t &junction) {
    const auto at = text.find('@');
    const auto words = split(text.substr(0, at), ':');
    Breakage breakage;
    const bool stuck = words.front() == "stuck" && words.size() == 3;
    const bool lose = words.front() == "lose" && words.size() == 2;
    const bool late = words.front() == "late" && words.size() == 2;
    if (at == std::string::npos || !(stuck || lose || late)) {
        refuse(text, "stuck:GROUP:ASPECT@MS, lose:COUNT@MS or late:DELAY_MS@MS");
    }
    breakage.at_ms = number(text, text.substr(at + 1), 0, most_ms, "milliseconds");
    if (stuck) {
        breakage.group = group_of(text, words[1], junction);
        breakage.aspect = aspect_of(text, words[2]);
    } else if (lose) {
        breakage.kind = Breakage::Kind::lose;
        breakage.count = number(text, words[1], 1, most_frames, "frames");
    } else {
        breakage.kind = Breakage::Kind::late;
        breakage.delay_ms = number(text, words[1], 1, most_ms, "milliseconds");
    }
    return breakage;
}

elmopp_lamps_t Broken::burning(elmopp_lamps_t driven, std::uint32_t now_ms) const {
    for (const auto &breakage : all_) {
        if (breakage.kind == Breakage::Kind::stuck && now_ms >= breakage.at_ms) {
            elmopp_lamps_show(&driven, breakage.group, breakage.aspect);
        }
    }
    return driven;
}

std::vector<elmopp_frame_t> Broken::pass_on(const elmopp_frame_t &frame, std::uint32_t now_ms) {
    std::uint32_t delay_ms = 0;
    bool lost = false;
    for (auto &breakage : all_) {
        if (now_ms < breakage.at_ms) {
            continue;
        }
        if (breakage.kind == Breakage::Kind::lose && breakage.count > 0) {
            --breakage.count;
            lost = true;
        }
        if (breakage.kind == Breakage::Kind::late) {
            delay_ms = std::max(delay_ms, breakage.delay_ms);
        }
    }
    if (!lost) {
        held_.push_back({now_ms + delay_ms, frame});
    }
    std::vector<elmopp_frame_t> due;
    while (!held_.empty() && now_ms >= held_.front().due_ms) {
        due.push_back(held_.front().frame);
        held_.pop_front();
    }
    return due;
}

} // namespace elmopp
