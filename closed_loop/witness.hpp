// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Witness: somebody beside the road who looks at the lamps alone, in every lamp tick, and writes down what must not
/// be.
///
/// A third opinion beside plan and monitor, which it does not know: no two conflicting groups off red at once; from the
/// end of a green to the beginning of a conflicting one no less than the site's intergreen; from green to red by amber,
/// for the site's time. Lamps that begin to flash or go dark have no amber to show. It stops nobody.

#pragma once

#include "core.hpp"

#include <array>
#include <cstdint>
#include <optional>

namespace elmopp {

struct Findings {
    std::uint64_t ticks = 0;        ///< looked at
    std::uint64_t conflicts = 0;    ///< ticks in which two conflicting groups were off red
    std::uint64_t early_greens = 0; ///< that began too early after a conflicting one
    std::uint64_t short_ambers = 0; ///< from green to red without its amber, or with a shorter one

    Findings &operator+=(const Findings &other) {
        ticks += other.ticks;
        conflicts += other.conflicts;
        early_greens += other.early_greens;
        short_ambers += other.short_ambers;
        return *this;
    }
};

class Witness {
  public:
    /// The site must outlive it.
    explicit Witness(const elmopp_junction_t &site) : site_(site) {}

    /// What the lamps show in this lamp tick.
    void see(const elmopp_lamps_t &lamps);

    [[nodiscard]] const Findings &findings() const {
        return found_;
    }

  private:
    void see_start(std::uint32_t group);
    void see_amber(std::uint32_t group, elmopp_aspect_t aspect);

    const elmopp_junction_t &site_;
    std::uint32_t green_ = 0;
    std::array<std::uint64_t, ELMOPP_GROUP_MAX> ended_ds_{}; ///< tick at which its last green ended; 0: it had none
    std::array<std::optional<std::uint64_t>, ELMOPP_GROUP_MAX> amber_ds_{}; ///< so far; nothing: no green before it
    Findings found_;
};

} // namespace elmopp
