// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// PageServer: the live page, for browsers of this machine and nobody else.
///
///     GET /          the page            GET /site      the junction and what may be controlled, as JSON
///     GET /events    the stream          POST /control  a wish, as JSON; only where there is somebody to wish from
///
/// Listens on 127.0.0.1 only and answers only who calls it by that address or by localhost, so that no page of the
/// network can reach it by a name that it points here (DNS rebinding); a wish from another page is refused by its
/// Origin. Bodies are 1 kB at most. Refusals are one line of text. Every onlooker has a thread of his own,
/// `onlookers_max` at most: who reads slowly holds up nobody, and after five seconds in which nothing could be sent is
/// let go.
///
/// It decides nothing about the junction and holds no state but the stream.

#pragma once

#include "event_stream.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace elmopp {

constexpr unsigned onlookers_max = 16;

/// What people may change.
struct Controls {
    std::string state; ///< at the beginning, as JSON
    /// Takes a wish and returns the new state of the controls, both JSON. Throws BadRequest. Called from the server's
    /// threads, one at a time; whoever looks on is told.
    std::function<std::string(const std::string &body)> wish;
};

class PageServer {
  public:
    /// `port` 0: any. Without controls there is nothing to wish. Throws BadRequest if the port cannot be had.
    PageServer(std::string site, std::uint16_t port, const std::optional<Controls> &controls);
    /// Ends the stream and every connection.
    ~PageServer();
    PageServer(const PageServer &) = delete;
    PageServer &operator=(const PageServer &) = delete;
    PageServer(PageServer &&) = delete;
    PageServer &operator=(PageServer &&) = delete;

    [[nodiscard]] std::string address() const;
    [[nodiscard]] EventStream &stream();

  private:
    class Listening;
    std::unique_ptr<Listening> listening_;
};

} // namespace elmopp
