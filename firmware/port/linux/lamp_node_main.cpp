// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// elmopp-lamp-node: a lamp node on a CAN bus of Linux, whose lamps are a line on stdout. Turns arguments into a node
/// and carries frames and time to it.

#include "breakage.hpp"
#include "can_interface.hpp"
#include "can_socket.hpp"
#include "error.hpp"
#include "program.hpp"
#include "sites.hpp"
#include "wakeups.hpp"

extern "C" {
#include "elmopp/lamp_node.h"
#include "elmopp_can.h"
}

#include <CLI/CLI.hpp>
#include <systemd/sd-daemon.h>

#include <sys/mman.h>

#include <csignal>
#include <iostream>
#include <string>

namespace elmopp {
namespace {

const char *const program_name = "elmopp-lamp-node";
constexpr std::uint32_t step_ms = 20; ///< so much later than its time-out it may flash

struct Request {
    std::string can;
    std::string site;
    unsigned node = 0;
    std::vector<std::string> breaks;
};

bool is_same(const elmopp_lamps_t &a, const elmopp_lamps_t &b) {
    return a.red == b.red && a.amber == b.amber && a.green == b.green && a.flash == b.flash;
}

class Program {
  public:
    Program(const Request &request, const elmopp_junction_t &junction, std::vector<Breakage> breaks)
        : junction_(junction), broken_(std::move(breaks)), socket_(request.can, {ELMOPP_CAN_LAMP_COMMAND_FRAME_ID}),
          wakeups_(step_ms, {SIGTERM, SIGINT}), start_ms_(monotonic_ms()), last_ms_(start_ms_), sent_ms_(start_ms_) {
        elmopp_lamp_node_init(&node_, &junction_, request.node);
    }

    /// Until somebody stops it: it goes dark then, as one without power.
    void run() {
        while (!wakeups_.signal()) {
            wakeups_.wait(socket_.descriptor());
            take_what_came(socket_,
                           [this](const elmopp_frame_t &frame) { (void)elmopp_lamp_node_take(&node_, &frame); });
            (void)wakeups_.ticks(); // taken, or the next wait would not wait
            pass(monotonic_ms());
        }
        (void)sd_notify(0, "STOPPING=1");
    }

  private:
    void pass(std::uint32_t now_ms) {
        elmopp_lamp_node_pass(&node_, now_ms - last_ms_);
        last_ms_ = now_ms;
        const elmopp_lamps_t burning = broken_.burning(node_.lamps, now_ms - start_ms_);
        show(burning, now_ms);
        if (now_ms - sent_ms_ >= ELMOPP_LAMP_NODE_FEEDBACK_MS) {
            // On a grid, but no two at once after a pause.
            const std::uint32_t late_ms = now_ms - sent_ms_ - ELMOPP_LAMP_NODE_FEEDBACK_MS;
            sent_ms_ = late_ms < ELMOPP_LAMP_NODE_FEEDBACK_MS ? sent_ms_ + ELMOPP_LAMP_NODE_FEEDBACK_MS : now_ms;
            for (const auto &frame :
                 broken_.pass_on(elmopp_lamp_node_feedback(&node_, &burning, false), now_ms - start_ms_)) {
                (void)socket_.send(frame);
            }
            (void)sd_notify(0, "READY=1\nWATCHDOG=1");
        }
    }

    /// One digit a group of the site, in the codes of LampCommand; groups of other nodes are dark.
    void show(const elmopp_lamps_t &burning, std::uint32_t now_ms) {
        if (shown_ && is_same(burning, last_) && node_.fail_safe == last_fail_safe_) {
            return;
        }
        std::string digits;
        for (std::uint32_t g = 0; g < junction_.group_count; ++g) {
            digits += static_cast<char>('0' + elmopp_lamps_aspect(&burning, g));
        }
        std::cout << now_ms - start_ms_ << " " << digits << (node_.fail_safe ? " by itself\n" : "\n") << std::flush;
        last_ = burning;
        last_fail_safe_ = node_.fail_safe;
        shown_ = true;
    }

    const elmopp_junction_t &junction_;
    Broken broken_;
    CanSocket socket_;
    Wakeups wakeups_;
    elmopp_lamp_node_t node_{};
    std::uint32_t start_ms_;
    std::uint32_t last_ms_;
    std::uint32_t sent_ms_;
    elmopp_lamps_t last_{};
    bool last_fail_safe_ = false;
    bool shown_ = false;
};

void check_node(const Request &request, const elmopp_junction_t &junction) {
    const std::uint32_t used = elmopp_junction_nodes(&junction);
    std::string nodes;
    for (unsigned n = 0; n < ELMOPP_NODE_MAX; ++n) {
        if (elmopp_mask_has(used, n)) {
            nodes += (nodes.empty() ? "" : ", ") + std::to_string(n);
        }
    }
    if (request.node >= ELMOPP_NODE_MAX || !elmopp_mask_has(used, request.node)) {
        throw BadRequest("--node " + std::to_string(request.node) + ": no group of " + request.site +
                         " hangs on it; right would be one of " + nodes);
    }
}

void run(const Request &request) {
    const elmopp_junction_t junction = read_street(request.site);
    check_node(request, junction);
    std::vector<Breakage> breaks;
    breaks.reserve(request.breaks.size());
    for (const auto &text : request.breaks) {
        breaks.push_back(parse_breakage(text, junction));
    }
    check_can(program_name, request.can);
    Program program(request, junction, breaks);
    (void)mlockall(MCL_CURRENT | MCL_FUTURE); // a page fault may be late; without the right to lock it goes on
    program.run();
}

void add_options(CLI::App &app, Request &request) {
    app.description("elmopp-lamp-node: holds the lamps of a junction as a controller commands over a CAN bus.");
    app.footer(
        "Prints what burns: milliseconds since the start, one digit a signal group (0 dark, 1 red, 2 red-amber,\n"
        "3 green, 4 amber, 5 flashing amber, 6 flashing red), \"by itself\" while nobody good commands.\n"
        "Exit codes: 0 stopped as asked, 1 it ran and failed, 2 the request cannot be run (one line says why).");
    add_bus_options(app, request.can, request.site);
    app.add_option("--node", request.node, "Number of the node")->type_name("N")->capture_default_str();
    app.add_option("--break", request.breaks, "stuck:GROUP:ASPECT@MS, lose:COUNT@MS or late:DELAY_MS@MS; repeatable")
        ->type_name("WHAT");
}

} // namespace
} // namespace elmopp

int main(int argc, char **argv) {
    return elmopp::run_program(elmopp::program_name, argc, argv, elmopp::add_options, elmopp::run);
}
