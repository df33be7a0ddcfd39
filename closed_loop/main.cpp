// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// elmopp-closed-loop: the command line of the whole chain. tools/closed-loop builds it and runs it.

#include "jobs.hpp"
#include "loop.hpp"
#include "program.hpp"

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>

namespace elmopp {
namespace {

void describe(CLI::App &app, LoopRequest &request) {
    app.description("Drawn road, camera counter, CAN frames, controller, lamps and the road again: what the cameras "
                    "count, and what their mistakes cost.");
    app.add_option("--seconds", request.seconds, "Simulated seconds, 1 to 2000")->capture_default_str();
    app.add_option("--vehicles", request.vehicles, "Vehicles of an approach in 2000 s")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    app.add_option("--seed", request.seed, "Of traffic and drawing")
        ->check(CLI::Range(0, 1000000000))
        ->capture_default_str();
    app.add_option("--out", request.out, "Folder for closed_loop.json, street.jsonl and lane files")->required();
    app.add_option("--site", request.site, "Site of a street")->capture_default_str();
    app.add_option("--chooser", request.chooser, "Chooser, the site's unless given");
    app.add_option("--demand", request.demand, "Pattern of the traffic")->capture_default_str();
    app.add_option("--link", request.link, "inproc, can:IFACE or slcan:PLACE")->capture_default_str();
    app.add_option("--scene", request.scene, "day, shadows, dusk, headlights, noise or rain")->capture_default_str();
    app.add_option("--overlay", request.overlay, "Video (.avi, .mp4) or last picture (.png) with what is counted");
    app.add_option("--faults", request.faults,
                   "List of KIND:WHO@FROM-TO: black, freeze, turn or gone of an approach or all, lose:PERCENT, reset; "
                   "without -TO to the end of the run, a reset for a moment");
    app.add_option("--reset-command", request.reset, "What resets the controller at the other end of --link");
}

void run(const LoopRequest &request) {
    cv::setNumThreads(1);
    catch_interrupts();
    run_loop(request);
}

} // namespace
} // namespace elmopp

int main(int argc, char **argv) {
    return elmopp::run_program<elmopp::LoopRequest>("elmopp-closed-loop", argc, argv, elmopp::describe, elmopp::run);
}
