// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "jobs.hpp"

#include "error.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace elmopp {
namespace {

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

extern "C" void remember_interrupt(int /*signal*/) {
    interrupted = true;
}

/// Threads that are joined whatever happens.
class Crew {
  public:
    ~Crew() {
        for (auto &thread : threads_) {
            thread.join();
        }
    }
    Crew() = default;
    Crew(const Crew &) = delete;
    Crew &operator=(const Crew &) = delete;
    Crew(Crew &&) = delete;
    Crew &operator=(Crew &&) = delete;

    void hire(const std::function<void()> &work) {
        threads_.emplace_back(work);
    }

  private:
    std::vector<std::thread> threads_;
};

/// Numbers that are given out once each, until one of the jobs fails.
class Queue {
  public:
    Queue(std::size_t count, const std::function<void(std::size_t)> &work, const std::function<void(std::size_t)> &done)
        : count_(count), work_(work), done_(done) {}

    void serve() {
        for (std::size_t index = next_++; index < count_; index = next_++) {
            try {
                check_interrupt();
                work_(index);
            } catch (...) {
                stop(std::current_exception());
                return;
            }
            const std::lock_guard<std::mutex> lock(mutex_);
            ++finished_;
            if (done_) {
                done_(finished_);
            }
        }
    }

    void stop(const std::exception_ptr &error) {
        const std::lock_guard<std::mutex> lock(mutex_);
        error_ = error_ ? error_ : error;
        next_ = count_;
    }

    void rethrow() const {
        if (error_) {
            std::rethrow_exception(error_);
        }
    }

  private:
    std::size_t count_;
    const std::function<void(std::size_t)> &work_;
    const std::function<void(std::size_t)> &done_;
    std::atomic<std::size_t> next_{0};
    std::mutex mutex_;
    std::size_t finished_ = 0;
    std::exception_ptr error_;
};

} // namespace

void run_jobs(std::size_t count, unsigned jobs, const std::function<void(std::size_t)> &work,
              const std::function<void(std::size_t)> &done) {
    Queue queue(count, work, done);
    {
        Crew crew;
        try {
            for (std::size_t i = 1; i < std::min<std::size_t>(jobs, count); ++i) {
                crew.hire([&queue] { queue.serve(); });
            }
        } catch (...) {
            queue.stop(std::current_exception()); // no further thread to be had
        }
        queue.serve();
    }
    queue.rethrow();
}

void catch_interrupts() {
    (void)std::signal(SIGINT, remember_interrupt);
    (void)std::signal(SIGTERM, remember_interrupt);
}

bool interrupt_has_come() {
    return interrupted;
}

void check_interrupt() {
    if (interrupt_has_come()) {
        throw Failure("interrupted; nothing was written");
    }
}

} // namespace elmopp
