// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "signals.hpp"

#include <algorithm>

namespace elmopp {

void Signals::begin_second() {
    std::fill(flowing_ds_.begin(), flowing_ds_.end(), 0U);
}

void Signals::show(const elmopp_lamps_t &lamps) {
    if (lamps.green != green_) {
        green_ = lamps.green;
        going_ = elmopp_junction_served(&junction_, green_);
    }
    const auto lit = static_cast<std::uint16_t>((std::uint32_t{lamps.green} | lamps.amber) & ~std::uint32_t{lamps.red});
    const std::uint32_t not_red = elmopp_junction_served(&junction_, lit);
    const std::uint32_t before = open_;
    open_ = going_;
    for (std::size_t j = 0; j < green_ds_.size(); ++j) {
        const auto index = static_cast<std::uint32_t>(j);
        const bool goes = elmopp_mask_has(going_, index);
        // Green time before the start-up loss is over moves nobody.
        flowing_ds_[j] += goes && green_ds_[j] >= junction_.movement[j].startup_ds ? 1U : 0U;
        green_ds_[j] = goes ? green_ds_[j] + 1U : 0U;
        red_ds_[j] = goes ? 0U : red_ds_[j] + 1U;
        if (elmopp_mask_has(before & not_red, index) && red_ds_[j] <= amber_used_ds) {
            open_ |= std::uint32_t{1} << index;
        }
    }
}

double Signals::flowing(std::size_t movement) const {
    return flowing_ds_[movement] / double{ELMOPP_LAMP_TICKS_PER_S};
}

double Signals::red_s(std::size_t movement) const {
    return red_ds_[movement] / double{ELMOPP_LAMP_TICKS_PER_S};
}

} // namespace elmopp
