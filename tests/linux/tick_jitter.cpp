// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

// tick_jitter SECONDS: how late the port's lamp ticks come on this machine, without any CAN. Prints one line of JSON.

#include "wakeups.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

namespace {

constexpr double us_per_s = 1e6;
constexpr double us_per_ns = 1e-3;
constexpr double tick_us = 1e5;

double now_us() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<double>(now.tv_sec) * us_per_s + static_cast<double>(now.tv_nsec) * us_per_ns;
}

} // namespace

int main(int argc, char **argv) {
    const double seconds = argc == 2 ? std::atof(argv[1]) : 0.0;
    if (!(seconds >= 1.0)) {
        std::fputs("tick_jitter: right would be tick_jitter SECONDS, 1 or more\n", stderr);
        return 2;
    }
    elmopp::Wakeups wakeups(100, {});
    const double begun_us = now_us();
    std::vector<double> late_us;
    std::uint64_t missed = 0;
    std::uint64_t all = 0;
    while (now_us() - begun_us < seconds * us_per_s) {
        wakeups.wait(-1);
        if (const std::uint64_t due = wakeups.ticks(); due > 0) {
            const double at_us = now_us();
            all += due;
            missed += due - 1;
            late_us.push_back(at_us - begun_us - static_cast<double>(all - 1) * tick_us);
        }
    }
    std::sort(late_us.begin(), late_us.end());
    const auto at = [&late_us](double share) {
        return late_us.at(static_cast<std::size_t>(share * static_cast<double>(late_us.size() - 1)));
    };
    std::printf("{\"ticks\": %zu, \"missed\": %llu, \"late_us\": {\"p50\": %.0f, \"p99\": %.0f, \"max\": %.0f}}\n",
                late_us.size(), static_cast<unsigned long long>(missed), at(0.5), at(0.99), at(1.0));
    return 0;
}
