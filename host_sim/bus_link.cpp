// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The controller at the other end of a wire: frames and time.

#include "control.hpp"
#include "error.hpp"
#include "jobs.hpp"
#include "wakeups.hpp"
#include "wire.hpp"

extern "C" {
#include "bus_clock.h"
#include "elmopp_can.h"
}

#include <poll.h>

#include <iostream>
#include <utility>

namespace elmopp {
namespace {

constexpr std::uint32_t answer_ms = 5000; ///< after which nobody is there
constexpr std::uint32_t listen_ms = 500;  ///< a lamp node speaks every 100 ms

void wait_for(const Wire &wire, int ms) {
    pollfd source{wire.descriptor(), POLLIN, 0};
    (void)poll(&source, 1, ms);
}

/// Lockstep: one SimTime, one answer.
class Lockstep final : public Link {
  public:
    explicit Lockstep(std::unique_ptr<Wire> wire) : wire_(std::move(wire)) {
        send_time(0); // begins anew
        wire_->settle();
    }

    std::vector<elmopp_frame_t> tick(const std::vector<elmopp_frame_t> &frames, elmopp_ms_t now_ms) override {
        for (const auto &frame : frames) {
            send(frame);
        }
        send_time(now_ms);
        std::vector<elmopp_frame_t> heard;
        const std::uint32_t begun_ms = monotonic_ms();
        while (monotonic_ms() - begun_ms < answer_ms) {
            while (const auto frame = wire_->receive()) {
                heard.push_back(*frame);
                if (frame->id == ELMOPP_CAN_LAMP_COMMAND_FRAME_ID) {
                    return heard;
                }
            }
            check_interrupt();
            wait_for(*wire_, 100);
        }
        throw Failure("--link " + wire_->name() + ": no answer within " + std::to_string(answer_ms / 1000) +
                      " s; right would be " + wire_->peer());
    }

    [[nodiscard]] bool has_node(std::uint32_t /*node*/) const override {
        return false;
    }

    [[nodiscard]] std::size_t history_s() const override {
        return ELMOPP_FORECAST_MEAN_WINDOW_S;
    }

  private:
    void send_time(elmopp_ms_t now_ms) {
        elmopp_frame_t frame = elmopp_bus_clock_make_time(now_ms);
        elmopp_link_seal(&frame, &counter_);
        send(frame);
    }

    void send(const elmopp_frame_t &frame) {
        if (!wire_->send_surely(frame)) {
            throw Failure("--link " + wire_->name() + ": nothing can be sent");
        }
    }

    std::unique_ptr<Wire> wire_;
    std::uint8_t counter_ = 0;
};

/// Everybody by his own clock.
class RealTime final : public Link {
  public:
    explicit RealTime(std::unique_ptr<Wire> wire) : wire_(std::move(wire)), wakeups_(ELMOPP_CONTROLLER_TICK_MS, {}) {
        listen();
    }

    std::vector<elmopp_frame_t> tick(const std::vector<elmopp_frame_t> &frames, elmopp_ms_t /*now_ms*/) override {
        for (const auto &frame : frames) {
            (void)wire_->send(frame);
        }
        std::vector<elmopp_frame_t> heard;
        std::uint64_t due = 0;
        while (due == 0) {
            wakeups_.wait(wire_->descriptor());
            while (const auto frame = wire_->receive()) {
                heard.push_back(*frame);
            }
            check_interrupt();
            due = wakeups_.ticks();
        }
        missed_ += due - 1;
        if (missed_ > 0 && !said_) {
            std::cerr << "host_sim: lamp ticks were missed; the simulated traffic is behind the clock from now on\n";
            said_ = true;
        }
        return heard;
    }

    [[nodiscard]] bool has_node(std::uint32_t node) const override {
        return elmopp_mask_has(nodes_, node);
    }

    [[nodiscard]] std::size_t history_s() const override {
        return 0;
    }

  private:
    /// Which lamp nodes are there: the others are played.
    void listen() {
        const std::uint32_t begun_ms = monotonic_ms();
        while (monotonic_ms() - begun_ms < listen_ms) {
            while (const auto frame = wire_->receive()) {
                const unsigned node = frame->id - ELMOPP_CAN_LAMP_FEEDBACK_FRAME_ID;
                nodes_ |= node < ELMOPP_NODE_MAX ? 1U << node : 0U;
            }
            wait_for(*wire_, 50);
        }
        (void)wakeups_.ticks();
    }

    std::unique_ptr<Wire> wire_;
    Wakeups wakeups_;
    std::uint32_t nodes_ = 0;
    std::uint64_t missed_ = 0;
    bool said_ = false;
};

} // namespace

std::unique_ptr<Link> make_bus(std::unique_ptr<Wire> wire, bool bus_clock) {
    if (bus_clock) {
        return std::make_unique<Lockstep>(std::move(wire));
    }
    return std::make_unique<RealTime>(std::move(wire));
}

} // namespace elmopp
