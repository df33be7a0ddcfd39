// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "page_server.hpp"

#include "error.hpp"
#include "page.hpp"

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace elmopp {
namespace {

constexpr std::size_t body_max = 1024;
constexpr std::size_t threads_beside_onlookers = 8;
constexpr int ok = 200;
constexpr int bad_request = 400;
constexpr int forbidden = 403;
constexpr int no_such_page = 404;
constexpr int no_such_method = 405;
constexpr int too_large = 413;
constexpr int wrong_type = 415;
constexpr int too_many = 503;

/// Nothing from elsewhere, nothing into frames of others.
const char *const policy = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; "
                           "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

void refuse(httplib::Response &response, int status, const std::string &line) {
    response.status = status;
    response.set_content(line + "\n", "text/plain; charset=utf-8");
}

/// Two programs on one port would each get some of the requests: httplib's own choice would allow that.
void own_the_port(socket_t socket) {
    const int yes = 1;
    (void)setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
}

} // namespace

class PageServer::Listening {
  public:
    Listening(std::string site, std::uint16_t port, const std::optional<Controls> &controls)
        : site_(std::move(site)), controls_(controls.value_or(Controls{})) {
        if (controls_.wish) {
            stream_.controls(controls_.state);
        }
        set_up();
        port_ = bind(port);
        names_ = {"127.0.0.1:" + std::to_string(port_), "localhost:" + std::to_string(port_)};
        add_pages();
        thread_ = std::thread([this] {
            server_.listen_after_bind();
            ended_ = true;
        });
        while (!server_.is_running() && !ended_) { // or stop() could come before there is anything to stop
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }

    ~Listening() {
        stream_.close();
        server_.stop();
        thread_.join();
    }
    Listening(const Listening &) = delete;
    Listening &operator=(const Listening &) = delete;
    Listening(Listening &&) = delete;
    Listening &operator=(Listening &&) = delete;

    [[nodiscard]] std::string address() const {
        return "http://" + names_.front() + "/";
    }

    EventStream &stream() {
        return stream_;
    }

  private:
    void set_up() {
        server_.new_task_queue = [] { return new httplib::ThreadPool(onlookers_max + threads_beside_onlookers); };
        server_.set_socket_options(own_the_port);
        server_.set_payload_max_length(body_max);
        server_.set_keep_alive_timeout(1);
        server_.set_tcp_nodelay(true);
        server_.set_default_headers({{"Content-Security-Policy", policy},
                                     {"X-Content-Type-Options", "nosniff"},
                                     {"Referrer-Policy", "no-referrer"},
                                     {"Cache-Control", "no-store"}});
    }

    std::uint16_t bind(std::uint16_t port) {
        const int got =
            port == 0 ? server_.bind_to_any_port("127.0.0.1") : (server_.bind_to_port("127.0.0.1", port) ? port : -1);
        if (got <= 0) {
            throw BadRequest("--port " + std::to_string(port) +
                             ": cannot be had, somebody may be using it; right would be another, or 0 for any");
        }
        return static_cast<std::uint16_t>(got);
    }

    [[nodiscard]] bool is_ours(const std::string &name) const {
        return name == names_.front() || name == names_.back();
    }

    void add_pages() {
        server_.set_pre_routing_handler([this](const httplib::Request &request, httplib::Response &response) {
            if (is_ours(request.get_header_value("Host"))) {
                return httplib::Server::HandlerResponse::Unhandled;
            }
            refuse(response, forbidden, "Host is not this machine; right would be " + address());
            return httplib::Server::HandlerResponse::Handled;
        });
        server_.Get("/", [](const httplib::Request & /*request*/, httplib::Response &response) {
            response.set_content(live_page_html, "text/html; charset=utf-8");
        });
        server_.Get("/site", [this](const httplib::Request & /*request*/, httplib::Response &response) {
            response.set_content(site_, "application/json");
        });
        server_.Get("/events",
                    [this](const httplib::Request & /*request*/, httplib::Response &response) { look_on(response); });
        server_.Post("/control", [this](const httplib::Request &request, httplib::Response &response) {
            control(request, response);
        });
        server_.set_error_handler([](const httplib::Request & /*request*/, httplib::Response &response) {
            if (response.body.empty() && response.status == no_such_page) {
                refuse(response, no_such_page, "no such page; right would be /");
            } else if (response.body.empty() && response.status == too_large) {
                refuse(response, too_large, "the body is too large; right would be 1024 bytes or less");
            }
        });
    }

    void look_on(httplib::Response &response) {
        // Taken at once and given back when httplib lets go of the response's provider, whatever becomes of it.
        const std::shared_ptr<void> place(nullptr, [this](void * /*none*/) { --onlookers_; });
        if (++onlookers_ > onlookers_max) {
            refuse(response, too_many, std::to_string(onlookers_max) + " look on already; right would be fewer pages");
            return;
        }
        const auto seen = std::make_shared<std::uint64_t>(0);
        response.set_chunked_content_provider("text/event-stream",
                                              [this, seen, place](std::size_t /*offset*/, httplib::DataSink &sink) {
                                                  const std::string text = stream_.after(*seen);
                                                  if (text.empty()) {
                                                      sink.done();
                                                      return true;
                                                  }
                                                  return sink.write(text.data(), text.size());
                                              });
    }

    void control(const httplib::Request &request, httplib::Response &response) {
        const std::string origin = request.get_header_value("Origin");
        const std::string scheme = "http://";
        if (!origin.empty() && (origin.rfind(scheme, 0) != 0 || !is_ours(origin.substr(scheme.size())))) {
            refuse(response, forbidden, "Origin is another page; right would be " + address());
        } else if (!controls_.wish) {
            refuse(response, no_such_method, "nothing can be controlled here: this page only looks on");
        } else if (request.get_header_value("Content-Type").rfind("application/json", 0) != 0) {
            refuse(response, wrong_type, "Content-Type is not JSON; right would be application/json");
        } else {
            answer(request.body, response);
        }
    }

    void answer(const std::string &body, httplib::Response &response) {
        try {
            const std::lock_guard<std::mutex> lock(wishing_); // the last that is told is the last that was wished
            const std::string state = controls_.wish(body);
            stream_.controls(state);
            response.set_content(state, "application/json");
            response.status = ok;
        } catch (const BadRequest &error) {
            refuse(response, bad_request, error.what());
        }
    }

    std::string site_;
    Controls controls_; ///< without a wish: none
    std::mutex wishing_;
    EventStream stream_;
    httplib::Server server_;
    std::thread thread_;
    std::vector<std::string> names_; ///< by which we may be called
    std::uint16_t port_ = 0;
    std::atomic<unsigned> onlookers_{0};
    std::atomic<bool> ended_{false};
};

PageServer::PageServer(std::string site, std::uint16_t port, const std::optional<Controls> &controls)
    : listening_(std::make_unique<Listening>(std::move(site), port, controls)) {}

PageServer::~PageServer() = default;

std::string PageServer::address() const {
    return listening_->address();
}

EventStream &PageServer::stream() {
    return listening_->stream();
}

} // namespace elmopp
