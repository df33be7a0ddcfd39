// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// What the kernel knows about a CAN interface, by netlink (libmnl): is it there, up, and at which bit rate?

#pragma once

#include <cstdint>
#include <string>

namespace elmopp {

constexpr std::uint32_t can_bit_rate = 500000; ///< bits a second, of the whole junction (firmware/can/elmopp.dbc)

struct CanInterface {
    bool exists = false;
    bool up = false;
    std::string kind;             ///< "can", "vcan", "slcan", ...; empty: no virtual or CAN link
    std::uint32_t bit_rate = 0;   ///< 0: has none, as vcan
    std::uint32_t restart_ms = 0; ///< after bus-off; 0: never by itself
    bool has_restart = false;     ///< the kernel said
};

CanInterface look_at_can(const std::string &name);

/// Throws BadRequest if the interface is missing or runs at another bit rate; says for the program what there is to
/// warn of.
void check_can(const std::string &program, const std::string &name);

} // namespace elmopp
