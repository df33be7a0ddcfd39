// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Signals: what a junction's lamps mean to the drivers of each movement, lamp tick by lamp tick.
///
/// A movement goes while all its groups are green. It decides nothing and knows no vehicle.

#pragma once

#include "core.hpp"

#include <cstdint>
#include <vector>

namespace elmopp {

/// Drivers go on through so much of the amber.
constexpr unsigned amber_used_ds = 10;

class Signals {
  public:
    explicit Signals(const elmopp_junction_t &junction)
        : junction_(junction), green_ds_(junction.movement_count), red_ds_(junction.movement_count),
          flowing_ds_(junction.movement_count) {}

    /// Before a second's first lamp tick.
    void begin_second();
    /// The lamps of one lamp tick.
    void show(const elmopp_lamps_t &lamps);

    /// Mask of the movements that go.
    [[nodiscard]] std::uint32_t going() const {
        return going_;
    }
    /// Mask of the movements whose vehicles may cross the stop line: those that go, and for amber_used_ds after it
    /// those whose groups show nothing but green and amber.
    [[nodiscard]] std::uint32_t open() const {
        return open_;
    }
    /// Part of the second in which a queue moves, 0..1: green without the start-up loss.
    [[nodiscard]] double flowing(std::size_t movement) const;
    /// Time since the movement went, 0 while it goes.
    [[nodiscard]] double red_s(std::size_t movement) const;

  private:
    const elmopp_junction_t &junction_;
    std::uint16_t green_ = 0;
    std::uint32_t going_ = 0;
    std::uint32_t open_ = 0;
    std::vector<unsigned> green_ds_;
    std::vector<unsigned> red_ds_;
    std::vector<unsigned> flowing_ds_;
};

/// How often a stage was shown that was not the one shown before; intergreens between them do not count.
class Switches {
  public:
    void see(elmopp_stage_t stage) {
        if (stage != ELMOPP_STAGE_NONE) {
            count_ += last_ != ELMOPP_STAGE_NONE && stage != last_ ? 1.0 : 0.0;
            last_ = stage;
        }
    }
    [[nodiscard]] double count() const {
        return count_;
    }

  private:
    double count_ = 0.0;
    elmopp_stage_t last_ = ELMOPP_STAGE_NONE;
};

} // namespace elmopp
