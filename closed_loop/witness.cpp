// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "witness.hpp"

namespace elmopp {

void Witness::see(const elmopp_lamps_t &lamps) {
    ++found_.ticks;
    const std::uint32_t steady = ~std::uint32_t{lamps.flash};
    const std::uint32_t off_red = (std::uint32_t{lamps.green} | lamps.amber) & ~std::uint32_t{lamps.red} & steady;
    bool conflict = false;
    for (std::uint32_t g = 0; g < site_.group_count; ++g) {
        conflict = conflict || (((off_red >> g) & 1U) != 0U && (off_red & site_.conflict[g]) != 0U);
    }
    found_.conflicts += conflict ? 1U : 0U;
    const std::uint32_t green = std::uint32_t{lamps.green} & steady;
    for (std::uint32_t g = 0; g < site_.group_count; ++g) {
        const bool is_green = ((green >> g) & 1U) != 0U;
        const bool was_green = ((green_ >> g) & 1U) != 0U;
        if (was_green && !is_green) {
            ended_ds_.at(g) = found_.ticks;
        }
        if (is_green && !was_green) {
            see_start(g);
        }
        see_amber(g, elmopp_lamps_aspect(&lamps, g));
    }
    green_ = green;
}

void Witness::see_start(std::uint32_t group) {
    for (std::uint32_t other = 0; other < site_.group_count; ++other) {
        const bool conflicts = ((std::uint32_t{site_.conflict[group]} >> other) & 1U) != 0U;
        if (conflicts && ended_ds_.at(other) != 0 &&
            found_.ticks - ended_ds_.at(other) < site_.intergreen_ds[other][group]) {
            ++found_.early_greens;
            return;
        }
    }
}

void Witness::see_amber(std::uint32_t group, elmopp_aspect_t aspect) {
    std::optional<std::uint64_t> &amber_ds = amber_ds_.at(group);
    if (aspect == ELMOPP_ASPECT_GREEN) {
        amber_ds = 0;
    } else if (aspect == ELMOPP_ASPECT_AMBER && amber_ds) {
        ++*amber_ds;
    } else {
        found_.short_ambers +=
            aspect == ELMOPP_ASPECT_RED && amber_ds && *amber_ds < site_.group[group].amber_ds ? 1U : 0U;
        amber_ds.reset();
    }
}

} // namespace elmopp
