// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "can_interface.hpp"
#include "can_socket.hpp"
#include "wire.hpp"

extern "C" {
#include "elmopp/bounds.h"
#include "elmopp_can.h"
}

#include <cstdint>
#include <vector>

namespace elmopp {
namespace {

/// What a controller and lamp nodes send; the kernel drops the rest.
std::vector<std::uint16_t> answers() {
    std::vector<std::uint16_t> ids{ELMOPP_CAN_LAMP_COMMAND_FRAME_ID, ELMOPP_CAN_CONTROLLER_STATUS_FRAME_ID,
                                   ELMOPP_CAN_DECISION_TRACE_FRAME_ID};
    const auto add = [&ids](unsigned first, unsigned count) {
        for (unsigned i = 0; i < count; ++i) {
            ids.push_back(static_cast<std::uint16_t>(first + i));
        }
    };
    add(ELMOPP_CAN_FORECAST_FRAME_ID, ELMOPP_APPROACH_MAX);
    add(ELMOPP_CAN_LAMP_FEEDBACK_FRAME_ID, ELMOPP_NODE_MAX);
    return ids;
}

class CanWire final : public Wire {
  public:
    explicit CanWire(const std::string &interface) : interface_(interface), socket_(interface, answers()) {}

    [[nodiscard]] std::string name() const override {
        return "can:" + interface_;
    }

    [[nodiscard]] std::string peer() const override {
        return "a running elmopp-controller --can " + interface_ + " --clock bus with the same site";
    }

    [[nodiscard]] int descriptor() const override {
        return socket_.descriptor();
    }

    std::optional<elmopp_frame_t> receive() override {
        return socket_.receive();
    }

    bool send(const elmopp_frame_t &frame) override {
        return socket_.send(frame);
    }

    bool send_surely(const elmopp_frame_t &frame) override {
        return socket_.send_surely(frame);
    }

    /// A socket does not tell what has arrived, and nobody has spoken to it before.
    void settle() override {}

  private:
    std::string interface_;
    CanSocket socket_;
};

} // namespace

std::unique_ptr<Wire> make_can_wire(const std::string &interface) {
    check_can("host_sim", interface);
    return std::make_unique<CanWire>(interface);
}

} // namespace elmopp
