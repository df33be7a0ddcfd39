// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// elmopp-closed-loop: the command line of the whole chain. tools/closed-loop builds it and runs it.

#include "jobs.hpp"
#include "loop.hpp"
#include "option_words.hpp"
#include "program.hpp"

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>

namespace elmopp {
namespace {

constexpr double largest_seed = 1e9;

/// The numbers as they were given: what they may be is said by our own messages.
struct LoopWords {
    LoopRequest request;
    std::string seconds{"600"};
    std::string vehicles{"400"};
    std::string seed{"1"};
};

void describe(CLI::App &app, LoopWords &words) {
    LoopRequest &request = words.request;
    app.description("Drawn road, camera counter, CAN frames, controller, lamps and the road again: what the cameras "
                    "count, and what their mistakes cost.");
    app.footer("Exit codes: 0 done, 1 it ran and failed, or lamps showed what they must not, 2 the request cannot be "
               "run (one line says why).\n"
               "Example: elmopp-closed-loop --seconds 240 --vehicles 600 --faults black:N@60-90 --out out/loop");
    app.get_formatter()->column_width(28);
    const auto option = [&app](const char *name, auto &value, const char *type, const std::string &what) {
        return app.add_option(name, value, what)->type_name(type);
    };
    option("--seconds", words.seconds, "S", "Simulated seconds, 1 to 2000")->capture_default_str();
    option("--vehicles", words.vehicles, "N", "Vehicles of an approach in 2000 s, 1 to 100000")->capture_default_str();
    option("--seed", words.seed, "N", "Of traffic and drawing")->capture_default_str();
    option("--out", request.out, "DIR", "Folder for closed_loop.json, street.jsonl and lane files")->required();
    option("--site", request.site, "FILE", "Site of a street")->capture_default_str();
    option("--chooser", request.chooser, "CHOOSER", "NAME[@OPTION=VALUE][:FORECAST] (default: the site's)");
    option("--demand", request.demand, "PATTERN", "Pattern of the traffic")->capture_default_str();
    option("--link", request.link, "NAME", "inproc, can:IFACE or slcan:PLACE")->capture_default_str();
    option("--scene", request.scene, "NAME", "day, shadows, dusk, headlights, noise or rain")->capture_default_str();
    option("--overlay", request.overlay, "FILE", "Video (.avi, .mp4) or last picture (.png) with what is counted");
    option("--faults", request.faults, "LIST",
           "KIND:WHO@FROM-TO, comma-separated: black, freeze, turn or gone of an approach or all, lose:PERCENT, reset; "
           "without -TO to the end of the run, a reset for a moment");
    option("--reset-command", request.reset, "COMMAND", "What resets the controller at the other end of --link");
}

void run(const LoopWords &words) {
    LoopRequest request = words.request;
    request.seconds = whole("--seconds", words.seconds, 1, simulated_points);
    request.vehicles = vehicles_of(words.vehicles);
    request.seed = whole("--seed", words.seed, 0, largest_seed);
    cv::setNumThreads(1);
    catch_interrupts();
    run_loop(request);
}

} // namespace
} // namespace elmopp

int main(int argc, char **argv) {
    return elmopp::run_program<elmopp::LoopWords>("elmopp-closed-loop", argc, argv, elmopp::describe, elmopp::run);
}
