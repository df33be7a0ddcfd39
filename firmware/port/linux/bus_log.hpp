// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// What a port says on stderr, for people and the journal: every change of mode, fault and bus, nothing else.

#pragma once

#include "can_socket.hpp"

extern "C" {
#include "elmopp/fault.h"
#include "elmopp/mode.h"
}

#include <string>

namespace elmopp {

/// What a mode is called. Never null, whatever the number.
const char *mode_name(elmopp_mode_t mode);

class BusLog {
  public:
    BusLog(std::string program, std::string interface);

    /// Says what has changed since the last look; of troubles on the bus at most one line a second. True if the status
    /// is another one.
    bool look(elmopp_mode_t mode, elmopp_fault_t fault, const CanTroubles &troubles);

    /// The same in one line.
    [[nodiscard]] const std::string &status() const {
        return status_;
    }

  private:
    void look_at_bus(const CanTroubles &troubles);

    std::string program_;
    std::string interface_;
    std::string status_;
    CanTroubles said_;
    std::uint32_t said_ms_ = 0;
};

} // namespace elmopp
