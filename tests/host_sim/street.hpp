// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// A junction whose lamps follow a chooser at once: what the tests of the rivals ask their rules with.

#pragma once

#include "plugged.hpp"
#include "sites.hpp"
#include "unity.h"

#include <array>

namespace elmopp {

// Stages: 0 {N.L,S.L} 1 {N.M,N.R,S.M,S.R} 2 {E.L,W.L} 3 {E.M,E.R,W.M,W.R} 4 N 5 E 6 S 7 W.
enum LaneName : std::uint8_t { NL, NM, NR, EL, EM, ER, SL, SM, SR, WL, WM, WR, lane_count };

/// A junction whose lamps follow the chooser at once.
class Street {
  public:
    explicit Street(const elmopp_chooser_t &chooser, int discharge = ELMOPP_DISCHARGE_SATURATION)
        : Street(chooser, elmopp_site_paper, discharge) {}
    Street(const elmopp_chooser_t &chooser, const elmopp_junction_t &site, int discharge = ELMOPP_DISCHARGE_SATURATION)
        : chooser_(chooser), junction_(site) {
        junction_.discharge = static_cast<std::uint8_t>(discharge);
        view_.junction = &junction_;
        view_.queue_veh = queue.data();
        view_.arrivals_veh = arrivals.data();
        view_.stage = ELMOPP_STAGE_NONE;
        view_.target = ELMOPP_STAGE_NONE;
        view_.red_ds = red_ds.data();
        view_.share = share_.data();
    }

    /// One second: the chooser's wish.
    elmopp_stage_t second() {
        const elmopp_stage_t wish = chooser_.choose(chooser_.state, &view_, score.data());
        const unsigned before_ds = wish == view_.stage ? view_.elapsed_ds : 0U;
        view_.elapsed_ds = static_cast<std::uint16_t>(before_ds + 10U);
        show(wish);
        arrivals.fill(0.0F);
        return wish;
    }

    /// The plan shows another stage than the one that was wished, now.
    void force(elmopp_stage_t stage) {
        view_.elapsed_ds = 10;
        show(stage);
    }

    /// One second of intergreen: nothing is shown, the target stays.
    elmopp_stage_t hidden_second() {
        view_.stage = ELMOPP_STAGE_NONE;
        view_.elapsed_ds = 0;
        const elmopp_stage_t wish = chooser_.choose(chooser_.state, &view_, score.data());
        view_.stage = view_.target;
        arrivals.fill(0.0F);
        return wish;
    }

    /// Vehicles that come in this second.
    void come(LaneName lane, float vehicles) {
        queue[lane] += vehicles;
        arrivals[lane] += vehicles;
    }

    /// Seconds until the wish is another one; the queues stay as they are.
    unsigned seconds_until_change() {
        const elmopp_stage_t now = view_.target;
        for (unsigned seconds = 1; seconds <= 200; ++seconds) {
            if (second() != now) {
                return seconds;
            }
        }
        return 0;
    }

    [[nodiscard]] bool is_going(LaneName lane) const {
        return elmopp_mask_has(view_.going, lane);
    }

    /// All vehicles of a lane leave.
    void clear(LaneName lane) {
        queue[lane] = 0.0F;
    }

    std::array<float, lane_count> queue{};
    std::array<float, lane_count> arrivals{};
    std::array<float, ELMOPP_STAGE_MAX> score{};

    std::array<std::uint16_t, lane_count> red_ds{};

  private:
    void show(elmopp_stage_t stage) {
        view_.stage = stage;
        view_.target = stage;
        view_.going = elmopp_junction_served(&junction_, junction_.stage_groups[stage]);
        for (std::uint32_t j = 0; j < junction_.movement_count; ++j) {
            red_ds[j] = static_cast<std::uint16_t>(elmopp_mask_has(view_.going, j) ? 0U : red_ds[j] + 10U);
        }
    }

    elmopp_chooser_t chooser_;
    elmopp_junction_t junction_;
    std::array<float, lane_count> share_{};
    elmopp_view_t view_{};
};

} // namespace elmopp
