// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "run.hpp"

#include "csv.hpp"
#include "decision_log.hpp"
#include "error.hpp"
#include "networks.hpp"
#include "results.hpp"
#include "sites.hpp"
#include "whole_file.hpp"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <system_error>
#include <utility>

namespace elmopp {
namespace {

namespace fs = std::filesystem;

/// Seconds in which the chooser saw the mean because the forecast that was asked for could not be had.
struct FallBacks {
    std::size_t cold_s = 0;
    std::size_t unarmed_s = 0;
    std::size_t distrusted_s = 0;

    void count(elmopp_foresight_t foresight) {
        cold_s += foresight == ELMOPP_FORESIGHT_COLD ? 1U : 0U;
        unarmed_s += foresight == ELMOPP_FORESIGHT_UNARMED ? 1U : 0U;
        distrusted_s += foresight == ELMOPP_FORESIGHT_DISTRUSTED ? 1U : 0U;
    }
};

nlohmann::ordered_json summary_of(const Scenario &scenario, const ChooserSpec &chooser, const RunRequest &request,
                                  std::size_t seconds, const FallBacks &fallback, const Metrics &metrics) {
    nlohmann::ordered_json summary{{"profile", scenario.profile.name},
                                   {"site", scenario.junction.name},
                                   {"chooser", chooser.label()},
                                   {"forecast", chooser.forecast}};
    if (request.trace) {
        summary["trace"] = request.trace->string();
    } else {
        summary["vehicles"] = request.vehicles;
        summary["seed"] = request.seed;
        summary["trial"] = request.trial;
    }
    summary["seconds"] = seconds;
    summary["fallback_s"] = {
        {"cold", fallback.cold_s}, {"unarmed", fallback.unarmed_s}, {"distrusted", fallback.distrusted_s}};
    for (const char *const name :
         {"throughput_veh_per_s", "served_share", "mean_delay_s", "longest_red_s", "switches",
          "figure_throughput_veh_per_s", "vehicles_in", "vehicles_out", "vehicles_queued", "vehicles_outside"}) {
        summary[name] = metrics.*find_metric(name).value;
    }
    if (metrics.longest_wait_s) {
        summary["longest_wait_s"] = *metrics.longest_wait_s;
    }
    return summary;
}

Scenario scenario_of(const RunRequest &request) {
    const std::string profile = request.profile.value_or(request.site ? "saturation" : "paper");
    if (!request.site) {
        return make_scenario(profile, nullptr, request.split);
    }
    const elmopp_junction_t site = read_site(*request.site);
    return make_scenario(profile, &site, request.split);
}

bool is_same_file(const fs::path &a, const fs::path &b) {
    std::error_code ignored;
    return fs::weakly_canonical(a, ignored) == fs::weakly_canonical(b, ignored);
}

std::size_t checked_seconds(const RunRequest &request, std::size_t available) {
    const std::size_t seconds = request.seconds.value_or(available);
    if (seconds < 1 || seconds > available) {
        throw BadRequest("--seconds " + std::to_string(seconds) + ": right would be 1 to " + std::to_string(available) +
                         (request.trace ? ", the length of the trace" : ""));
    }
    return seconds;
}

/// The controller behind the link that was asked for.
std::unique_ptr<Control> control_of(const RunRequest &request, const Scenario &scenario, const ChooserSpec &chooser,
                                    const Demand &demand) {
    if (request.link.empty()) {
        return make_direct(scenario, chooser, demand);
    }
    if (request.link == "inproc") {
        return make_framed(scenario, chooser, demand, make_inproc(scenario, chooser, demand));
    }
    if (scenario.junction.simulation_only != 0) {
        throw BadRequest("--link " + request.link + ": site " + scenario.junction.name +
                         " is simulation_only and drives no lamps; right would be --site with another, such as "
                         "sites/four_way.toml");
    }
    if (!(chooser == site_chooser(scenario.junction))) {
        throw BadRequest("--chooser " + full_name(chooser.label(), chooser.forecast) + " with --link " + request.link +
                         ": the controller on the bus runs what its site names; right would be none, or " +
                         full_name(site_chooser(scenario.junction).label(), site_chooser(scenario.junction).forecast));
    }
    const std::string place = request.link.substr(request.link.find(':') + 1);
    auto wire = request.link.rfind("slcan:", 0) == 0 ? make_slcan_wire(place) : make_can_wire(place);
    return make_framed(scenario, chooser, demand, make_bus(std::move(wire), request.bus_clock));
}

} // namespace

std::string log_line(const Second &second, const elmopp_junction_t &junction, bool full) {
    const Told &told = second.told;
    const std::size_t movements = junction.movement_count;
    std::string text = decision_line({second.t_s, told.stage, second.lamps, &junction, told.present_veh,
                                      told.arrived_veh, told.score, told.foreseen_veh, told.fault});
    if (full) {
        text += ",\"queue_veh\":" + list_of(second.world.queue_veh(), movements) +
                ",\"outside_veh\":" + list_of(second.world.outside_veh(), movements) +
                ",\"red_s\":" + list_of(second.red_s, movements) +
                ",\"out_veh\":" + list_of(second.world.left_veh(), movements);
    }
    if (full && told.mode != ELMOPP_MODE_COUNT) {
        text += ",\"mode\":" + std::to_string(static_cast<unsigned>(told.mode));
    }
    return text + "}";
}

void run_once(const RunRequest &request) {
    const Scenario scenario = scenario_of(request);
    const ChooserSpec chooser = request.chooser ? parse_chooser(*request.chooser) : site_chooser(scenario.junction);
    const Integrator integrator = request.integrator.value_or(scenario.profile.integrator);
    const Source generated =
        make_source(integrator, request.mapping, request.seed, request.trial, scenario.junction.approach_count);
    const Series unit = request.trace ? read_trace(*request.trace, scenario.approach_names()) : generated.unit;
    const std::size_t origin = request.trace ? 0 : training_points;
    const std::size_t seconds = checked_seconds(request, request.trace ? unit[0].size() : simulated_points);
    const double each =
        request.trace ? 1.0 : vehicles_per_approach(scenario.profile.scope, request.vehicles, unit.size());
    // A trace has no training points: the regression is the shipped one, as on the street, and its demand scale a
    // running mean.
    const std::vector<elmopp_ar8_t> street(unit.size(), shipped_weights("lstm")->ar8);
    if (scenario.street && request.trace) {
        throw BadRequest("--trace " + request.trace->string() +
                         " with profile discrete: it draws its own vehicles; right would be profile saturation");
    }
    Demand demand = scenario.street ? make_discrete_demand(scenario, unit, each, request.seed, request.trial, seconds)
                                    : make_demand(unit, each, origin, request.trace ? street : generated.ar8,
                                                  !request.trace, seconds);
    std::optional<elmopp_weights_t> weights;
    if (request.weights) {
        weights = read_weights(*request.weights);
        if (!can_forecast(*weights, chooser.forecast)) {
            const std::string overflow = overflow_of(*weights);
            throw BadRequest("--weights " + request.weights->string() + ": " +
                             (overflow.empty() ? "" : overflow + "; ") + std::to_string(weights->lstm.levels) +
                             " level(s) for chooser " + full_name(chooser.label(), chooser.forecast) +
                             "; right would be a chooser with forecast " + networks_in(*weights));
        }
        demand.weights = &*weights;
    }
    if (request.log && request.summary && is_same_file(*request.log, *request.summary)) {
        throw BadRequest("--log and --summary are both \"" + request.log->string() + "\"; right would be two files");
    }
    std::optional<WholeFile> log;
    if (request.log) {
        log.emplace("--log", *request.log);
    }
    // The log on stdout keeps it for itself.
    const fs::path beside_log = request.log == fs::path("-") ? "/dev/stderr" : "-";
    WholeFile summary("--summary", request.summary.value_or(beside_log));
    FallBacks fallback;
    const Observer observer = [&](const Second &second) {
        fallback.count(second.told.foresight);
        if (log) {
            log->out() << log_line(second, scenario.junction, request.full) << "\n";
        }
    };
    const auto control = control_of(request, scenario, chooser, demand);
    const Metrics metrics = run_trial(scenario, *control, demand, seconds, observer);
    if (log) {
        log->flush(); // nothing is summed up of a log that could not be written
    }
    summary.out() << summary_of(scenario, chooser, request, seconds, fallback, metrics).dump(1) << "\n";
    summary.flush();
    if (log) {
        log->commit();
    }
    summary.commit();
}

void write_inflow(Integrator integrator, std::optional<Mapping> mapping, Scope scope, unsigned vehicles,
                  std::uint64_t seed, std::uint64_t trial, std::size_t points, const fs::path &file) {
    constexpr std::size_t approaches = 4;
    constexpr int exact = 17; // every double comes back as it was
    const Trajectory trajectory = draw_trajectory(integrator, seed, trial, approaches);
    WholeFile csv("--csv", file);
    csv.out() << (mapping ? "t_s,N,E,S,W" : "t,x,y,z,w") << "\n";
    const Series unit = mapping ? unit_inflow(trajectory, *mapping, approaches) : Series();
    const double each = vehicles_per_approach(scope, vehicles, approaches);
    for (std::size_t t = 0; t < points; ++t) {
        csv.out() << t;
        for (std::size_t i = 0; i < approaches; ++i) {
            csv.out() << ',' << format_number(mapping ? unit[i][t] * each : trajectory.parts[0][t][i], exact);
        }
        csv.out() << "\n";
    }
    csv.commit();
}

} // namespace elmopp
