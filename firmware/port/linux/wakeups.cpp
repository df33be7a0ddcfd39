// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "wakeups.hpp"

#include "error.hpp"

#include <poll.h>
#include <sys/signalfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <ctime>

namespace elmopp {
namespace {

constexpr int longest_wait_ms = 1000;
constexpr std::int64_t ms_per_s = 1000;
constexpr std::int64_t ns_per_ms = 1000000;

timespec monotonic() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now;
}

} // namespace

std::uint32_t monotonic_ms() {
    const timespec now = monotonic();
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(now.tv_sec) * ms_per_s + now.tv_nsec / ns_per_ms);
}

Wakeups::Wakeups(std::uint32_t period_ms, std::initializer_list<int> signals) {
    sigset_t set;
    sigemptyset(&set);
    for (const int signal : signals) {
        sigaddset(&set, signal);
    }
    sigprocmask(SIG_BLOCK, &set, nullptr);
    signals_ = signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC);
    timer_ = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
    if (signals_ < 0 || timer_ < 0) {
        throw Failure("no timer or no signals from the kernel");
    }
    if (period_ms != 0) {
        itimerspec grid{};
        grid.it_value = monotonic();
        grid.it_interval.tv_sec = static_cast<std::time_t>(period_ms / ms_per_s);
        grid.it_interval.tv_nsec = static_cast<long>(period_ms % ms_per_s * ns_per_ms);
        timerfd_settime(timer_, TFD_TIMER_ABSTIME, &grid, nullptr);
    }
}

Wakeups::~Wakeups() {
    close(timer_);
    close(signals_);
}

void Wakeups::wait(int descriptor) const {
    std::array<pollfd, 3> sources{{{timer_, POLLIN, 0}, {signals_, POLLIN, 0}, {descriptor, POLLIN, 0}}};
    (void)poll(sources.data(), sources.size(), longest_wait_ms);
}

std::uint64_t Wakeups::ticks() {
    std::uint64_t count = 0;
    return read(timer_, &count, sizeof count) == static_cast<ssize_t>(sizeof count) ? count : 0;
}

std::optional<int> Wakeups::signal() {
    signalfd_siginfo info{};
    if (read(signals_, &info, sizeof info) != static_cast<ssize_t>(sizeof info)) {
        return std::nullopt;
    }
    return static_cast<int>(info.ssi_signo);
}

} // namespace elmopp
