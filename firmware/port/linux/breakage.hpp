// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// What a lamp node can be told to break, and when: for trying out what the rest of the junction makes of it.

#pragma once

extern "C" {
#include "elmopp/lamps.h"
#include "elmopp/link.h"
}

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

namespace elmopp {

struct Breakage {
    enum class Kind { stuck, lose, late };
    Kind kind = Kind::stuck;
    std::uint32_t group = 0;                     ///< stuck: whose lamps
    elmopp_aspect_t aspect = ELMOPP_ASPECT_DARK; ///< ... show what
    std::uint32_t count = 0;                     ///< lose: so many LampFeedback frames
    std::uint32_t delay_ms = 0;                  ///< late: every LampFeedback from then on
    std::uint32_t at_ms = 0;                     ///< since the node's start
};

/// "stuck:GROUP:ASPECT@MS", "lose:COUNT@MS" or "late:DELAY_MS@MS"; a group by name or number, an aspect by name or
/// number. Throws BadRequest naming what is wrong.
Breakage parse_breakage(const std::string &text, const elmopp_junction_t &junction);

/// The broken part of a node, between what it is told and what burns, and between what it says and what is sent.
class Broken {
  public:
    explicit Broken(std::vector<Breakage> all) : all_(std::move(all)) {}

    /// What burns when this is driven.
    [[nodiscard]] elmopp_lamps_t burning(elmopp_lamps_t driven, std::uint32_t now_ms) const;

    /// Takes a LampFeedback; returns what is to be sent now.
    std::vector<elmopp_frame_t> pass_on(const elmopp_frame_t &frame, std::uint32_t now_ms);

  private:
    struct Held {
        std::uint32_t due_ms;
        elmopp_frame_t frame;
    };
    std::vector<Breakage> all_;
    std::deque<Held> held_;
};

} // namespace elmopp
