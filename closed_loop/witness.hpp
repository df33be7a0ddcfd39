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

class Witness {
  public:
    /// The site must outlive it.
    explicit Witness(const elmopp_junction_t &site) : site_(site) {}

    /// What the lamps show in this lamp tick.
    void see(const elmopp_lamps_t &lamps);

    [[nodiscard]] std::uint64_t ticks() const {
        return ticks_;
    }
    /// Ticks in which two conflicting groups were off red.
    [[nodiscard]] std::uint64_t conflicts() const {
        return conflicts_;
    }
    /// Greens that began too early after a conflicting one.
    [[nodiscard]] std::uint64_t early_greens() const {
        return early_greens_;
    }

    /// Greens that went to red without their amber, or with a shorter one.
    [[nodiscard]] std::uint64_t short_ambers() const {
        return short_ambers_;
    }
    /// All of these.
    [[nodiscard]] std::uint64_t findings() const {
        return conflicts_ + early_greens_ + short_ambers_;
    }

  private:
    void see_start(std::uint32_t group);
    void see_amber(std::uint32_t group, elmopp_aspect_t aspect);

    const elmopp_junction_t &site_;
    std::uint32_t green_ = 0;
    std::array<std::uint64_t, ELMOPP_GROUP_MAX> ended_ds_{}; ///< tick at which its last green ended; 0: it had none
    std::uint64_t ticks_ = 0;
    std::uint64_t conflicts_ = 0;
    std::array<std::optional<std::uint64_t>, ELMOPP_GROUP_MAX> amber_ds_{}; ///< so far; nothing: no green before it
    std::uint64_t early_greens_ = 0;
    std::uint64_t short_ambers_ = 0;
};

} // namespace elmopp
