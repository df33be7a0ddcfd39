// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// elmopp-view: the live page of a controller on a bus. It listens and sends nothing.

#include "bus_seconds.hpp"
#include "can_interface.hpp"
#include "can_socket.hpp"
#include "csv.hpp"
#include "error.hpp"
#include "junction_json.hpp"
#include "page_server.hpp"
#include "program.hpp"
#include "sites.hpp"
#include "wakeups.hpp"

#include <CLI/CLI.hpp>

#include <cmath>
#include <csignal>
#include <cstdint>
#include <iostream>
#include <optional>
#include <string>

namespace elmopp {
namespace {

const char *const program_name = "elmopp-view";
constexpr std::uint32_t second_ms = 1000;

struct Request {
    std::string can;
    std::string site;
    std::string port = "8137";
};

std::uint16_t port_of(const std::string &text) {
    constexpr double most = 65535.0;
    double value = 0.0;
    if (!parse_number(text, value) || value != std::floor(value) || value < 0.0 || value > most) {
        throw BadRequest("--port \"" + text + "\": right would be a whole number from 0 to 65535");
    }
    return static_cast<std::uint16_t>(value);
}

void run(const Request &request) {
    const std::uint16_t port = port_of(request.port);
    const elmopp_junction_t junction = read_site(request.site);
    check_can(program_name, request.can);
    CanSocket socket(request.can, {});
    Wakeups wakeups(second_ms, {SIGINT, SIGTERM}); // before there are threads that a signal could come to
    nlohmann::ordered_json site = junction_json(junction);
    site["controls"] = false;
    PageServer server(site.dump(), port, std::nullopt);
    server.stream().begin(nlohmann::ordered_json{{"site", junction.name}, {"can", request.can}}.dump());
    std::cout << program_name << ": " << server.address() << " shows " << junction.name << " on " << request.can
              << "; ctrl-C ends it\n"
              << std::flush;
    BusSeconds seconds(junction);
    while (!wakeups.signal()) {
        wakeups.wait(socket.descriptor());
        take_what_came(socket, [&seconds](const elmopp_frame_t &frame) { seconds.hear(frame, monotonic_ms()); });
        if (wakeups.ticks() > 0) {
            server.stream().second(seconds.line(monotonic_ms()));
        }
    }
}

void add_options(CLI::App &app, Request &request) {
    app.description(
        "elmopp-view: the live page of a controller on a bus, for a browser of this machine. It listens and "
        "sends nothing.");
    app.footer("Exit codes: 0 done, 2 the request cannot be run (one line says why).");
    add_bus_options(app, request.can, request.site);
    app.add_option("--port", request.port, "Port on 127.0.0.1; 0: any")->type_name("N")->capture_default_str();
}

} // namespace
} // namespace elmopp

int main(int argc, char **argv) {
    return elmopp::run_program(elmopp::program_name, argc, argv, elmopp::add_options, elmopp::run);
}
