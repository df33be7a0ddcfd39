// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "bus_log.hpp"

#include "program.hpp"
#include "wakeups.hpp"

#include <array>
#include <utility>

namespace elmopp {

const char *mode_name(elmopp_mode_t mode) {
    static const std::array<const char *, ELMOPP_MODE_COUNT> names{
        "starting", "start: flashing", "start: all red", "first stage", "automatic", "fixed time",
        "manual",   "all red",         "flashing",       "dark",        "fail-safe"};
    const auto number = static_cast<std::size_t>(mode);
    return number < names.size() ? names.at(number) : "unknown mode";
}

BusLog::BusLog(std::string program, std::string interface)
    : program_(std::move(program)), interface_(std::move(interface)) {}

bool BusLog::look(elmopp_mode_t mode, elmopp_fault_t fault, const CanTroubles &troubles) {
    std::string status = std::string("mode ") + mode_name(mode);
    if (fault != ELMOPP_FAULT_NONE) {
        status += std::string(", fault ") + elmopp_fault_name(fault) + " (" + std::to_string(fault) + ")";
    }
    const bool news = status != status_;
    if (news) {
        status_ = status;
        say(program_, status_);
    }
    look_at_bus(troubles);
    return news;
}

void BusLog::look_at_bus(const CanTroubles &troubles) {
    struct Counted {
        const char *what;
        std::uint64_t CanTroubles::*count;
    };
    static constexpr std::array<Counted, 8> counted{{{"bus-off", &CanTroubles::bus_off},
                                                     {"restarted", &CanTroubles::restarted},
                                                     {"error-passive", &CanTroubles::error_passive},
                                                     {"overruns", &CanTroubles::overruns},
                                                     {"other errors", &CanTroubles::other_errors},
                                                     {"unsent frames", &CanTroubles::unsent},
                                                     {"lost frames", &CanTroubles::lost},
                                                     {"opened again", &CanTroubles::reopened}}};
    constexpr std::uint32_t pause_ms = 1000;
    std::string text;
    for (const auto &[what, count] : counted) {
        if (troubles.*count != said_.*count) {
            text += (text.empty() ? "" : ", ") + std::string(what) + " " + std::to_string(troubles.*count);
        }
    }
    const std::uint32_t now_ms = monotonic_ms();
    if (!text.empty() && now_ms - said_ms_ >= pause_ms) {
        said_ = troubles;
        said_ms_ = now_ms;
        say(program_, interface_ + ": " + text + " since the start");
    }
}

} // namespace elmopp
