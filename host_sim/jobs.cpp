// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "jobs.hpp"

#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace elmopp {

void run_jobs(std::size_t count, unsigned jobs, const std::function<void(std::size_t)> &work,
              const std::function<void(std::size_t)> &done) {
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    std::size_t finished = 0;
    std::exception_ptr error;
    const auto worker = [&] {
        for (std::size_t index = next++; index < count; index = next++) {
            try {
                work(index);
            } catch (...) {
                const std::lock_guard<std::mutex> lock(mutex);
                error = error ? error : std::current_exception();
                next = count;
                return;
            }
            const std::lock_guard<std::mutex> lock(mutex);
            ++finished;
            if (done) {
                done(finished);
            }
        }
    };
    std::vector<std::thread> threads;
    for (unsigned i = 1; i < jobs; ++i) {
        threads.emplace_back(worker);
    }
    worker();
    for (auto &thread : threads) {
        thread.join();
    }
    if (error) {
        std::rethrow_exception(error);
    }
}

} // namespace elmopp
