// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Wire: frames in and out, whatever carries them: a CAN interface of this machine, or a serial line with SLCAN on it.

#pragma once

extern "C" {
#include "elmopp/link.h"
}

#include <memory>
#include <optional>
#include <string>

namespace elmopp {

class Wire {
  public:
    Wire() = default;
    Wire(const Wire &) = delete;
    Wire &operator=(const Wire &) = delete;
    virtual ~Wire() = default;

    /// As it stands behind --link.
    [[nodiscard]] virtual std::string name() const = 0;

    /// What ought to be at the other end, for whoever finds nobody there.
    [[nodiscard]] virtual std::string peer() const = 0;

    /// To wait on.
    [[nodiscard]] virtual int descriptor() const = 0;

    /// The next frame, without waiting.
    virtual std::optional<elmopp_frame_t> receive() = 0;

    /// Sends without waiting; false if it could not.
    virtual bool send(const elmopp_frame_t &frame) = 0;

    /// Sends, waiting up to a second for room.
    virtual bool send_surely(const elmopp_frame_t &frame) = 0;

    /// All that was sent has arrived, and what came until then is forgotten: as far as the wire can tell.
    virtual void settle() = 0;
};

/// A CAN interface. Throws BadRequest naming it if it cannot be used.
std::unique_ptr<Wire> make_can_wire(const std::string &interface);

/// An SLCAN adaptor: "unix:PATH", a socket, or "tty:PATH", a serial device. Closes and opens its channel. Throws
/// BadRequest naming the place if there is nothing, Failure if nobody answers.
std::unique_ptr<Wire> make_slcan_wire(const std::string &place);

} // namespace elmopp
