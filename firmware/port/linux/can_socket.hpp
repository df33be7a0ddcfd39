// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// A raw CAN socket of Linux: classic frames in and out, error frames counted, an interface that goes and comes back.
///
/// Decides nothing about what a frame means. The kernel filters by id before a frame is copied. An interface that goes
/// down keeps its socket; one that disappears is looked for again, once a second, when somebody sends or receives.

#pragma once

extern "C" {
#include "elmopp/link.h"
}

#include <cstdint>
#include <ctime>
#include <optional>
#include <string>
#include <vector>

namespace elmopp {

/// What the interface has said about itself since the start, in error frames and refused sends.
struct CanTroubles {
    std::uint64_t bus_off = 0;       ///< the controller left the bus
    std::uint64_t restarted = 0;     ///< ... and came back
    std::uint64_t error_passive = 0; ///< many errors on the wire
    std::uint64_t overruns = 0;      ///< frames lost in the controller
    std::uint64_t other_errors = 0;  ///< no acknowledge, protocol, transmit time-out
    std::uint64_t unsent = 0;        ///< frames that could not be sent: down, gone or full
    std::uint64_t lost = 0;          ///< frames that the socket had no room for
    std::uint64_t reopened = 0;      ///< the interface was gone and is there again
};

class CanSocket {
  public:
    /// `ids`: 11-bit ids to receive; empty: all. Throws BadRequest naming the interface if it is missing, is no CAN
    /// interface, or may not be opened.
    CanSocket(std::string interface, std::vector<std::uint16_t> ids);
    ~CanSocket();
    CanSocket(const CanSocket &) = delete;
    CanSocket &operator=(const CanSocket &) = delete;
    CanSocket(CanSocket &&) = delete;
    CanSocket &operator=(CanSocket &&) = delete;

    /// From now on other ids, for another junction.
    void listen_to(std::vector<std::uint16_t> ids);

    /// To wait on; -1 while the interface is gone.
    [[nodiscard]] int descriptor() const {
        return descriptor_;
    }

    /// The next data frame with an 11-bit id, without waiting. Error frames are counted and left out.
    std::optional<elmopp_frame_t> receive();

    /// Sends without waiting. False if it could not be sent; it is counted, not kept: a late lamp command is worthless.
    bool send(const elmopp_frame_t &frame);

    /// The same, waiting up to a second for room: for lockstep, where nothing may be lost.
    bool send_surely(const elmopp_frame_t &frame);

    [[nodiscard]] const CanTroubles &troubles() const {
        return troubles_;
    }

  private:
    void open(bool at_start);
    [[nodiscard]] bool filter() const;
    void close();
    void find_again();
    void count_error(std::uint32_t what, std::uint32_t controller);

    std::string interface_;
    std::vector<std::uint16_t> ids_;
    CanTroubles troubles_;
    int descriptor_ = -1;
    std::time_t tried_s_ = 0;
    std::uint32_t dropped_ = 0;
};

constexpr unsigned frames_between_looks = 64; ///< a flood does not keep the lamps waiting

/// Hands over what has come, to a socket or to anything else that can receive(), but only so many frames: whoever calls
/// looks at the clock then, and comes again for the rest.
template <typename Source, typename Take> void take_what_came(Source &source, Take take) {
    for (unsigned k = 0; k < frames_between_looks; ++k) {
        const std::optional<elmopp_frame_t> frame = source.receive();
        if (!frame) {
            return;
        }
        take(*frame);
    }
}

} // namespace elmopp
