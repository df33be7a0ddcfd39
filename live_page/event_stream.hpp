// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// EventStream: what has happened, for any number of onlookers who read at their own speed.
///
/// publish() never waits for anybody. An onlooker who comes late, or falls more than `events_kept` behind, is told
/// everything again from what is kept: the run, its last seconds, the state of the controls. Texts are server-sent
/// events, ready to be sent. Safe to be called from several threads.

#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>

namespace elmopp {

constexpr std::size_t events_kept = 600; ///< ten minutes of seconds

class EventStream {
  public:
    /// A new run, as JSON: what was before is forgotten.
    void begin(const std::string &run);
    /// One second's line of the decision log, without a line feed.
    void second(const std::string &line);
    /// The state of the controls, as JSON.
    void controls(const std::string &state);

    /// Nobody waits any more.
    void close();
    [[nodiscard]] bool is_closed() const;

    /// What has come after `seen`, which is moved on; 0: nothing was seen yet. Waits for it, but at most a second,
    /// after which it is a comment, by which a connection that is gone is noticed. Empty: the stream is closed.
    std::string after(std::uint64_t &seen);

  private:
    struct Event {
        std::uint64_t number;
        bool second;
        std::string text;
    };

    void publish(const std::string &kind, const std::string &data);
    [[nodiscard]] std::string everything() const;

    mutable std::mutex mutex_;
    std::condition_variable news_;
    std::deque<Event> events_;
    std::string run_;
    std::string controls_;
    std::uint64_t newest_ = 0;
    bool closed_ = false;
};

} // namespace elmopp
