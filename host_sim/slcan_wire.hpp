// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// SLCAN wire: an adaptor on a descriptor, from the program's side.
///
/// Every frame that is sent is answered by the adaptor. At most slcan_window of them are under way, so that an adaptor
/// with little room loses nothing; send_surely() takes one that has not answered for a second for one that never does.

#pragma once

#include "slcan_lines.hpp"
#include "wire.hpp"

#include <cstdint>
#include <deque>

namespace elmopp {

constexpr unsigned slcan_window = 32; ///< frames, 23 characters each: less than the board's ring

class SlcanWire final : public Wire {
  public:
    /// Takes the descriptor and closes it in the end; it must not block. Closes and opens the channel. Throws Failure
    /// if nobody answers within `answer_ms`, or what is there refuses.
    SlcanWire(std::string place, int descriptor, std::uint32_t answer_ms);
    ~SlcanWire() override;
    SlcanWire(const SlcanWire &) = delete;
    SlcanWire &operator=(const SlcanWire &) = delete;

    [[nodiscard]] std::string name() const override;
    [[nodiscard]] std::string peer() const override;
    [[nodiscard]] int descriptor() const override {
        return descriptor_;
    }
    std::optional<elmopp_frame_t> receive() override;
    bool send(const elmopp_frame_t &frame) override;
    bool send_surely(const elmopp_frame_t &frame) override;
    void settle() override;

    /// Frames that the adaptor has refused.
    [[nodiscard]] std::uint64_t refused() const {
        return refused_;
    }

  private:
    [[noreturn]] void fail(const std::string &what) const;
    void read();
    void sort();
    void wait(int ms) const;
    void write(const std::string &text);
    SlcanEvent next();
    void begin_anew();
    bool command(const std::string &text);
    bool have_room(std::uint32_t limit_ms);

    std::string place_;
    int descriptor_;
    std::uint32_t answer_ms_;
    SlcanLines lines_;
    std::deque<SlcanEvent> events_;
    std::deque<elmopp_frame_t> frames_;
    unsigned under_way_ = 0;
    std::uint64_t refused_ = 0;
};

} // namespace elmopp
