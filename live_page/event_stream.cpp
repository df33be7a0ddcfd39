// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "event_stream.hpp"

#include <chrono>

namespace elmopp {
namespace {

std::string event_text(const std::string &kind, const std::string &data) {
    return "event: " + kind + "\ndata: " + data + "\n\n";
}

} // namespace

void EventStream::publish(const std::string &kind, const std::string &data) {
    events_.push_back({++newest_, kind == "second", event_text(kind, data)});
    if (events_.size() > events_kept) {
        events_.pop_front();
    }
    news_.notify_all();
}

void EventStream::begin(const std::string &run) {
    const std::lock_guard<std::mutex> lock(mutex_);
    events_.clear();
    run_ = event_text("run", run);
    publish("run", run);
}

void EventStream::second(const std::string &line) {
    const std::lock_guard<std::mutex> lock(mutex_);
    publish("second", line);
}

void EventStream::controls(const std::string &state) {
    const std::lock_guard<std::mutex> lock(mutex_);
    controls_ = event_text("controls", state);
    publish("controls", state);
}

void EventStream::close() {
    const std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
    news_.notify_all();
}

bool EventStream::is_closed() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return closed_;
}

std::string EventStream::everything() const {
    std::string text = "retry: 1000\n" + run_; // milliseconds until a browser tries again
    for (const auto &event : events_) {
        text += event.second ? event.text : "";
    }
    return text + controls_;
}

std::string EventStream::after(std::uint64_t &seen) {
    std::unique_lock<std::mutex> lock(mutex_);
    news_.wait_for(lock, std::chrono::seconds(1), [&] { return closed_ || newest_ > seen; });
    if (closed_) {
        return {};
    }
    if (newest_ == seen) {
        return ": still here\n\n";
    }
    std::string text;
    if (events_.front().number > seen + 1 || seen == 0) {
        text = everything();
    } else {
        for (std::size_t i = events_.size() - static_cast<std::size_t>(newest_ - seen); i < events_.size(); ++i) {
            text += events_[i].text;
        }
    }
    seen = newest_;
    return text;
}

} // namespace elmopp
