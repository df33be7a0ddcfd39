// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// A running junction in words, from its frames alone: lamps, counts, forecasts, what neighbours announce, mode,
/// faults, and who is silent.
///
/// Judges no more than whether a frame is whole: it is for people who look on, and says nothing to anybody. Needs the
/// site for names and for what belongs together.

#pragma once

extern "C" {
#include "elmopp/detector.h"
#include "elmopp/frames.h"
}

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace elmopp {

class JunctionView {
  public:
    explicit JunctionView(const elmopp_junction_t &junction) : junction_(junction) {}

    struct Status {
        elmopp_mode_t mode;
        unsigned stage;
        unsigned elapsed_ds;
        elmopp_fault_t fault;
        unsigned fault_group;
        unsigned refused;
    };
    struct Counts {
        std::array<elmopp_detector_report_t, ELMOPP_APPROACH_MOVEMENT_MAX> report;
        unsigned reason;
    };
    struct Forecast {
        unsigned model;
        std::array<double, 3> next_veh; ///< 10, 30 and 60 seconds
    };
    /// What was said lately; nothing of those who are silent.
    struct Seen {
        std::optional<Status> status;
        std::optional<elmopp_lamps_t> lamps;
        std::array<std::optional<Counts>, ELMOPP_APPROACH_MAX> counts;
        std::array<std::optional<Forecast>, ELMOPP_APPROACH_MAX> forecast;
        std::array<std::string, ELMOPP_GROUP_MAX> differs; ///< what the lamps do that were not told so; empty: as told
    };

    /// A frame that was heard at this time. One that is not whole is counted, one of another kind is none of ours.
    void hear(const elmopp_frame_t &frame, std::uint32_t now_ms);

    /// What is to be seen now, a line each.
    [[nodiscard]] std::vector<std::string> lines(std::uint32_t now_ms) const;

    /// The same as values.
    [[nodiscard]] Seen seen(std::uint32_t now_ms) const;

    /// What a Model of Forecast is called. Never null, whatever the number.
    static const char *model_word(unsigned model);

  private:
    /// Something that comes again and again.
    template <typename Value> struct Latest {
        Value value{};
        std::optional<std::uint32_t> at_ms;

        void set(const Value &heard, std::uint32_t now_ms) {
            value = heard;
            at_ms = now_ms;
        }
        [[nodiscard]] bool is_fresh(std::uint32_t now_ms, std::uint32_t cycle_ms) const {
            return at_ms && now_ms - *at_ms < 3 * cycle_ms;
        }
        [[nodiscard]] std::optional<Value> if_fresh(std::uint32_t now_ms, std::uint32_t cycle_ms) const {
            return is_fresh(now_ms, cycle_ms) ? std::optional<Value>(value) : std::nullopt;
        }
    };

    /// What a lamp node measures, and which of its groups that differs for from what it was told.
    struct Node {
        elmopp_feedback_t feedback;
        std::uint16_t off;
        std::uint16_t off_before;
    };

    void hear_feedback(const elmopp_feedback_t &feedback, unsigned node, std::uint32_t now_ms);
    [[nodiscard]] std::string differs(std::uint32_t group, std::uint32_t now_ms) const;
    void hear_approach(const elmopp_frame_t &frame, std::uint32_t now_ms);
    void hear_status(const elmopp_frame_t &frame, std::uint32_t now_ms);
    void hear_forecast(const elmopp_frame_t &frame, unsigned approach, std::uint32_t now_ms);
    [[nodiscard]] std::string status_line(std::uint32_t now_ms) const;
    [[nodiscard]] std::string lamps_line(std::uint32_t now_ms) const;
    [[nodiscard]] std::string junction_line(std::uint32_t now_ms) const;
    [[nodiscard]] std::string approach_line(std::uint32_t approach, std::uint32_t now_ms) const;
    [[nodiscard]] std::string counts_of(std::uint32_t approach, std::uint32_t now_ms) const;
    [[nodiscard]] std::string forecast_of(std::uint32_t approach, std::uint32_t now_ms) const;
    [[nodiscard]] std::string neighbour_of(std::uint32_t approach, std::uint32_t now_ms) const;

    const elmopp_junction_t &junction_;
    Latest<Status> status_;
    Latest<elmopp_lamps_t> lamps_;
    Latest<elmopp_occupancy_t> occupancy_;
    std::array<Latest<Node>, ELMOPP_NODE_MAX> nodes_;
    std::array<Latest<Counts>, ELMOPP_APPROACH_MAX> counts_;
    std::array<Latest<Forecast>, ELMOPP_APPROACH_MAX> forecast_;
    std::array<Latest<elmopp_outflow_t>, ELMOPP_APPROACH_MAX> outflow_;
    std::uint64_t spoilt_ = 0;
};

} // namespace elmopp
