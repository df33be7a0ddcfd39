// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// elmopp-monitor-tool: a running junction on a terminal, from the bus alone. It sends nothing.

#include "can_interface.hpp"
#include "can_socket.hpp"
#include "error.hpp"
#include "junction_view.hpp"
#include "program.hpp"
#include "sites.hpp"
#include "wakeups.hpp"

#include <CLI/CLI.hpp>

#include <unistd.h>

#include <csignal>
#include <iostream>
#include <string>

namespace elmopp {
namespace {

const char *const program_name = "elmopp-monitor-tool";
constexpr std::uint32_t redraw_ms = 500;

struct Request {
    std::string can;
    std::string site;
    bool once = false;
};

void run(const Request &request) {
    const elmopp_junction_t junction = read_site(request.site);
    check_can(program_name, request.can);
    CanSocket socket(request.can, {});
    Wakeups wakeups(redraw_ms, {SIGINT, SIGTERM});
    JunctionView view(junction);
    const bool terminal = isatty(STDOUT_FILENO) != 0 && !request.once;
    constexpr std::uint32_t look_ms = 3100; // everything that is sent once a second has come by then
    const std::uint32_t begun_ms = monotonic_ms();
    while (!wakeups.signal()) {
        wakeups.wait(socket.descriptor());
        take_what_came(socket, [&view](const elmopp_frame_t &frame) { view.hear(frame, monotonic_ms()); });
        const bool due = wakeups.ticks() > 0;
        const bool last = request.once && monotonic_ms() - begun_ms >= look_ms;
        if (last || (due && !request.once)) {
            std::string text = terminal ? "\x1b[H\x1b[J" : "";
            text += std::string(junction.name) + " on " + request.can + "\n";
            for (const auto &line : view.lines(monotonic_ms())) {
                text += line + "\n";
            }
            std::cout << text << (terminal || last ? "" : "\n") << std::flush;
        }
        if (last || !std::cout) {
            return;
        }
    }
}

void add_options(CLI::App &app, Request &request) {
    app.description("elmopp-monitor-tool: a running junction on a terminal, from the bus alone. It sends nothing.");
    app.footer(
        "Two times a second; ctrl-C ends it. Exit codes: 0 done, 2 the request cannot be run (one line says why).\n"
        "Frame by frame: candump -L IFACE | python -m cantools decode --single-line firmware/can/elmopp.dbc");
    add_bus_options(app, request.can, request.site);
    app.add_flag("--once", request.once, "Listen for three seconds, say what there is, and end");
}

} // namespace
} // namespace elmopp

int main(int argc, char **argv) {
    return elmopp::run_program(elmopp::program_name, argc, argv, elmopp::add_options, elmopp::run);
}
