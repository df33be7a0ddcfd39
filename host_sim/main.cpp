// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// host_sim: the command line. Turns arguments into requests and exceptions into exit codes; it computes nothing.

#include "accuracy.hpp"
#include "bench.hpp"
#include "choosers.hpp"
#include "csv.hpp"
#include "error.hpp"
#include "experiment.hpp"
#include "jobs.hpp"
#include "learning_trial.hpp"
#include "option_words.hpp"
#include "road_network_trial.hpp"
#include "run.hpp"
#include "scenario.hpp"
#include "serve.hpp"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <thread>

namespace elmopp {
namespace {

constexpr int exit_failed = 1;
constexpr int exit_bad_request = 2;
constexpr double most_trials = 100000.0;
constexpr double most_jobs = 1024.0;
constexpr double largest_seed = 4294967295.0; ///< the seed is the upper half of the generator's state

/// The value if the option was given.
template <typename Value> std::optional<Value> given(const CLI::App &command, const char *option, const Value &value) {
    return command.count(option) > 0 ? std::optional<Value>(value) : std::nullopt;
}

/// Every option as text: what it may be is said by our own messages, in one place.
struct Texts {
    std::string profile{"paper,saturation"};
    std::string run_profile;
    std::string choosers;
    std::string chooser;
    std::string vehicles;
    std::string trials{"30"};
    std::string trial{"0"};
    std::string seed{"1"};
    std::string jobs;
    std::string out{"out/experiment"};
    std::string count_scores;
    std::string split;
    std::string mapping{"abs"};
    std::string integrator{"rk4"};
    std::string scope{"per_inroad"};
    std::string site;
    std::string network;
    std::string neighbours{"off"};
    std::string trace;
    std::string weights;
    std::string seconds;
    std::string link{"inproc"};
    std::string clock{"bus"};
    std::string log;
    std::string summary;
    std::string points{"10000"};
    std::string csv;
    std::string json;
    std::string port{std::to_string(usual_port)};
    std::string speed{"1"};
    bool paused = false;
    bool straight = false;
    std::vector<std::string> weight_files;
    std::string learning_vehicles{"600"};
    std::string learning_chooser{"rollout"};
    std::string updates{"6000"};
    bool full = false;
    bool no_figures = false;
    bool list_json = false;
    bool forecast_only = false;
};

/// Empty if they were not given.
std::vector<double> given_shares(const CLI::App &command, const Texts &texts) {
    return command.count("--split") > 0 ? shares_of(texts.split) : std::vector<double>();
}

unsigned jobs_of(const CLI::App &command, const Texts &texts) {
    return command.count("--jobs") > 0 ? static_cast<unsigned>(whole("--jobs", texts.jobs, 1, most_jobs))
                                       : std::max(1U, std::thread::hardware_concurrency());
}

void add_traffic_options(CLI::App *command, Texts &texts) {
    command->add_option("--seed", texts.seed, "Seed of the initial conditions")->type_name("N")->capture_default_str();
    command->add_option("--mapping", texts.mapping, "How the states become traffic: abs or shift")
        ->type_name("NAME")
        ->capture_default_str();
    command->add_option("--split", texts.split, "Shares of an approach's movements, e.g. 0.2,0.6,0.2 (default: equal)")
        ->type_name("SHARES");
}

ExperimentRequest experiment_request(const CLI::App &command, const Texts &texts) {
    ExperimentRequest request;
    const auto has = [&command](const char *option) { return command.count(option) > 0; };
    request.profiles = distinct(split(texts.profile, ','));
    request.choosers = has("--choosers") ? parse_choosers(texts.choosers) : request.choosers;
    request.vehicles = has("--vehicles") ? vehicles_list(texts.vehicles) : request.vehicles;
    request.trials = whole("--trials", texts.trials, 1, most_trials);
    request.seed = whole("--seed", texts.seed, 0, largest_seed);
    request.jobs = jobs_of(command, texts);
    request.out = texts.out;
    request.split = given_shares(command, texts);
    request.mapping = mapping_of(texts.mapping);
    request.integrator = given(command, "--integrator", integrator_of(texts.integrator));
    request.count_scores = given(command, "--count-scores", std::filesystem::path(texts.count_scores));
    // A part of the table needs no comparison with the rest of the house.
    request.beside = !has("--profile") && !has("--choosers") && !has("--vehicles");
    request.figures = !texts.no_figures;
    return request;
}

/// What of an experiment makes sense for a network.
NetworkRequest network_request(const CLI::App &command, const Texts &texts) {
    for (const auto *const option : {"--split", "--mapping", "--integrator", "--count-scores"}) {
        if (command.count(option) > 0) {
            throw BadRequest(std::string(option) + " with --network " + texts.network +
                             ": says nothing of a network; right would be no " + option);
        }
    }
    const ExperimentRequest plain = experiment_request(command, texts);
    if (plain.vehicles.empty()) {
        throw BadRequest("--vehicles random with --network " + texts.network + ": right would be numbers");
    }
    NetworkRequest request;
    request.network = texts.network;
    request.profile = command.count("--profile") > 0 ? texts.profile : request.profile;
    request.choosers = plain.choosers.empty() ? paper_table() : plain.choosers;
    request.neighbours = one_of<std::vector<bool>>("--neighbours", texts.neighbours,
                                                   {{"off", {false}}, {"on", {true}}, {"both", {false, true}}});
    if (command.count("--link") > 0) {
        request.framed = one_of<bool>("--link", texts.link, {{"inproc", true}});
    }
    request.vehicles = plain.vehicles;
    request.trials = plain.trials;
    request.seed = plain.seed;
    request.jobs = plain.jobs;
    request.out = plain.out;
    return request;
}

void run_either(const CLI::App &command, const Texts &texts) {
    if (command.count("--network") > 0) {
        return run_network_experiment(network_request(command, texts));
    }
    if (command.count("--neighbours") > 0) {
        throw BadRequest("--neighbours " + texts.neighbours + " without --network: right would be one with the other");
    }
    if (command.count("--link") > 0) {
        throw BadRequest("--link " + texts.link + " without --network: right would be host_sim run, or a network");
    }
    run_experiment(experiment_request(command, texts));
}

void add_experiment(CLI::App &app, Texts &texts) {
    auto *command = app.add_subcommand(
        "experiment", "The paper's evaluation: every chooser on the same trials; table, figures, claims");
    const auto option = [command](const char *name, std::string &text, const char *type, const std::string &what) {
        return command->add_option(name, text, what)->type_name(type);
    };
    option("--profile", texts.profile, "LIST", "Profiles, comma-separated (host_sim list)")->capture_default_str();
    option("--choosers", texts.choosers, "LIST",
           "Choosers NAME[@OPTION=VALUE][:FORECAST], comma-separated, or all (default: the paper's table; of profile "
           "literal what is printed)");
    option("--vehicles", texts.vehicles, "LIST",
           "Vehicles per approach, comma-separated, or random for 200..1000 (default: 200,400,600,800,1000)");
    option("--trials", texts.trials, "N", "Initial conditions for each number of vehicles")->capture_default_str();
    option("--jobs", texts.jobs, "N", "Trials at the same time (default: one a core); changes no result");
    option("--out", texts.out, "DIR", "Folder for the results")->capture_default_str();
    option("--count-scores", texts.count_scores, "FILE", "Scores of the camera, for the claim about counting");
    option("--integrator", texts.integrator, "NAME", "rk4 or euler (default: the profile's)");
    option("--network", texts.network, "NET",
           "Several junctions under profile discrete: grid:ROWSxCOLUMNS or a .toml file; N to every arm from outside");
    option("--neighbours", texts.neighbours, "NAME", "With --network: announced outflow off, on or both, in pairs")
        ->capture_default_str();
    option("--link", texts.link, "NAME",
           "With --network: inproc, every controller through its frames, what neighbours announce among them");
    command->add_flag("--no-figures", texts.no_figures, "Leave the figures out");
    add_traffic_options(command, texts);
    command->callback([command, &texts] { run_either(*command, texts); });
}

RunRequest run_request(const CLI::App &command, const Texts &texts) {
    RunRequest request;
    const auto has = [&command](const char *option) { return command.count(option) > 0; };
    if (has("--trace") && has("--vehicles")) {
        throw BadRequest("--vehicles " + texts.vehicles + " with --trace " + texts.trace +
                         ": right would be one of the two, a trace has its own vehicles");
    }
    request.profile = given(command, "--profile", texts.run_profile);
    request.site = given(command, "--site", std::filesystem::path(texts.site));
    request.chooser = given(command, "--chooser", texts.chooser);
    request.vehicles = has("--vehicles") ? vehicles_of(texts.vehicles) : request.vehicles;
    request.seed = whole("--seed", texts.seed, 0, largest_seed);
    request.trial = whole("--trial", texts.trial, 0, largest_seed);
    request.trace = given(command, "--trace", std::filesystem::path(texts.trace));
    request.weights = given(command, "--weights", std::filesystem::path(texts.weights));
    if (has("--seconds")) {
        request.seconds = whole("--seconds", texts.seconds, 1, 1e7);
    }
    request.log = given(command, "--log", std::filesystem::path(texts.log));
    request.full = texts.full;
    request.summary = given(command, "--summary", std::filesystem::path(texts.summary));
    request.split = given_shares(command, texts);
    request.mapping = mapping_of(texts.mapping);
    request.integrator = given(command, "--integrator", integrator_of(texts.integrator));
    if (has("--link")) {
        request.link = link_of(texts.link);
    }
    request.bus_clock = one_of<bool>("--clock", texts.clock, {{"bus", true}, {"real", false}});
    const bool bus = !request.link.empty() && request.link != "inproc";
    for (const auto *const option : {"--clock", "--weights"}) {
        const bool fits = bus == (std::string(option) == "--clock");
        if (has(option) && !fits) {
            throw BadRequest(
                std::string(option) + (bus ? " with" : " without") + " --link can:IFACE or slcan:PLACE: " +
                (bus ? "the controller on the bus has its own; right would be elmopp-controller " + std::string(option)
                     : std::string("time is not a matter; right would be no ") + option));
        }
    }
    return request;
}

void add_run(CLI::App &app, Texts &texts) {
    auto *command = app.add_subcommand("run", "One trial, with a decision log if asked for");
    const auto option = [command](const char *name, std::string &text, const char *type, const std::string &what) {
        return command->add_option(name, text, what)->type_name(type);
    };
    option("--profile", texts.run_profile, "NAME",
           "Inflow and discharge (default: paper; with --site alone saturation)");
    option("--site", texts.site, "FILE", "Junction, a .toml or .bin site file (default: the paper's)");
    option("--chooser", texts.chooser, "CHOOSER", "NAME[@OPTION=VALUE][:FORECAST] (default: the site's)");
    option("--vehicles", texts.vehicles, "N", "Vehicles per approach (default: 800)");
    option("--trial", texts.trial, "N", "Which of the seed's initial conditions")->capture_default_str();
    option("--trace", texts.trace, "FILE",
           "Recorded traffic instead: CSV with t_s and a column an approach, vehicles per second");
    option("--weights", texts.weights, "FILE",
           "ELMW image for lstm or nlstm, and ann and gcn, made by tools/weights (default: those built in)");
    option("--seconds", texts.seconds, "N", "Length (default: 2000, or the trace's)");
    option("--log", texts.log, "FILE", "Decision log, JSON lines; - is stdout");
    command->add_flag("--full", texts.full, "Queues, reds and departures in the log too");
    option(
        "--summary", texts.summary, "FILE",
        "Metrics as JSON, and how often the mean stood in for the forecast and why (default: stdout, or stderr if the "
        "log is there)");
    option(
        "--link", texts.link, "NAME",
        "inproc: the whole controller through its frames, whole vehicles and start-up included; can:IFACE: an "
        "elmopp-controller on that interface; slcan:unix:PATH or slcan:tty:PATH: an elmopp-mps2 behind that socket or "
        "serial device (default: real-valued vehicles, straight to forecast, chooser and plan)");
    option(
        "--clock", texts.clock, "NAME",
        "With can: or slcan: bus, the controller's lamp ticks are our SimTime frames; real, everybody by his own clock")
        ->capture_default_str();
    option("--integrator", texts.integrator, "NAME", "rk4 or euler (default: the profile's)");
    add_traffic_options(command, texts);
    command->callback([command, &texts] { run_once(run_request(*command, texts)); });
}

void add_inflow(CLI::App &app, Texts &texts) {
    auto *command = app.add_subcommand("inflow", "The generated traffic of one trial as CSV");
    command->add_option("--integrator", texts.integrator, "rk4 or euler")->type_name("NAME")->capture_default_str();
    command->add_option("--mapping", texts.mapping, "raw (states x,y,z,w), abs or shift (vehicles per second)")
        ->type_name("NAME")
        ->capture_default_str();
    command->add_option("--scope", texts.scope, "per_inroad (N to each approach) or total (N to all)")
        ->type_name("NAME")
        ->capture_default_str();
    auto *vehicles =
        command->add_option("--vehicles", texts.vehicles, "Vehicles in the simulated seconds (default: 800)")
            ->type_name("N");
    command->add_option("--seed", texts.seed, "Seed of the initial conditions")->type_name("N")->capture_default_str();
    command->add_option("--trial", texts.trial, "Which of the seed's initial conditions")
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--points", texts.points, "Points from 0; 0..7999 train the forecasts, second 0 is point 8000")
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--csv", texts.csv, "File to write; - is stdout")->type_name("FILE")->required();
    command->callback([vehicles, &texts] {
        using OptionalMapping = std::optional<Mapping>;
        const auto mapping = one_of<OptionalMapping>(
            "--mapping", texts.mapping, {{"raw", std::nullopt}, {"abs", Mapping::abs}, {"shift", Mapping::shift}});
        const auto scope =
            one_of<Scope>("--scope", texts.scope, {{"per_inroad", Scope::per_inroad}, {"total", Scope::total}});
        write_inflow(integrator_of(texts.integrator), mapping, scope,
                     vehicles->count() > 0 ? vehicles_of(texts.vehicles) : 800,
                     whole("--seed", texts.seed, 0, largest_seed), whole("--trial", texts.trial, 0, largest_seed),
                     whole("--points", texts.points, 1, trajectory_points), texts.csv);
    });
}

void add_bench(CLI::App &app, Texts &texts) {
    auto *command = app.add_subcommand(
        "bench", "Time of a network's step and of a forecast, simulated seconds a second, the speed-up of two jobs");
    command->add_option("--json", texts.json, "File for the figures")->type_name("FILE");
    command->add_flag("--forecast-only", texts.forecast_only, "Only the networks: a few seconds");
    command->callback([command, &texts] {
        run_bench(given(*command, "--json", std::filesystem::path(texts.json)), texts.forecast_only);
    });
}

void add_accuracy(CLI::App &app, Texts &texts) {
    auto *command = app.add_subcommand(
        "accuracy", "Errors of every forecast 1, 10, 30 and 60 s ahead, over the trials of the experiment");
    command->add_option("--trials", texts.trials, "Initial conditions")->type_name("N")->capture_default_str();
    command->add_option("--seed", texts.seed, "Seed of the initial conditions")->type_name("N")->capture_default_str();
    command->add_option("--jobs", texts.jobs, "Trials at the same time (default: one a core); changes no result")
        ->type_name("N");
    command
        ->add_option("--weights", texts.weight_files,
                     "ELMW image instead of the network of as many levels; may be given more than once")
        ->type_name("FILE");
    command->add_option("--json", texts.json, "File for the figures")->type_name("FILE");
    command->callback([command, &texts] {
        AccuracyRequest request;
        request.weights.assign(texts.weight_files.begin(), texts.weight_files.end());
        request.trials = whole("--trials", texts.trials, 1, most_trials);
        request.seed = whole("--seed", texts.seed, 0, largest_seed);
        request.jobs = jobs_of(*command, texts);
        request.json = given(*command, "--json", std::filesystem::path(texts.json));
        run_accuracy(request);
    });
}

void add_serve(CLI::App &app, Texts &texts) {
    auto *command = app.add_subcommand(
        "serve",
        "A junction that runs on and on, in a browser of this machine: profile saturation, the whole controller");
    const auto option = [command](const char *name, std::string &text, const char *type, const std::string &what) {
        return command->add_option(name, text, what)->type_name(type);
    };
    option("--site", texts.site, "FILE", "The junction, .toml or .bin (default: four_way)");
    option("--chooser", texts.chooser, "NAME",
           "Chooser NAME[@OPTION=VALUE][:FORECAST] (default: the site's; without --site cumulative:lstm)");
    option("--vehicles", texts.vehicles, "N",
           "Vehicles an approach in 2000 s, until somebody changes it (default: 600)");
    option("--seed", texts.seed, "N", "Seed of the initial conditions")->capture_default_str();
    option("--trial", texts.trial, "N", "Which of the seed's initial conditions comes first")->capture_default_str();
    option("--port", texts.port, "N", "Port on 127.0.0.1; 0: any, which is then said")->capture_default_str();
    option("--speed", texts.speed, "X", "Simulated seconds a second, until somebody changes it")->capture_default_str();
    command->add_flag("--paused", texts.paused, "Wait after the first second");
    command->add_flag("--straight", texts.straight,
                      "Real-valued vehicles straight to forecast, chooser and plan, as run has it without --link");
    command->callback([command, &texts] {
        ServeRequest request;
        request.site = given(*command, "--site", std::filesystem::path(texts.site));
        request.chooser = given(*command, "--chooser", texts.chooser);
        request.vehicles = command->count("--vehicles") > 0 ? vehicles_of(texts.vehicles) : request.vehicles;
        request.seed = whole("--seed", texts.seed, 0, largest_seed);
        request.trial = whole("--trial", texts.trial, 0, largest_seed);
        request.port = static_cast<std::uint16_t>(whole("--port", texts.port, 0, 65535));
        request.speed = speed_of(texts.speed);
        request.paused = texts.paused;
        request.straight = texts.straight;
        serve(request);
    });
}

void add_learning(CLI::App &app, Texts &texts) {
    auto *command = app.add_subcommand(
        "learning",
        "Does it pay to learn on? Errors and delays on other demand, with frozen, learning and oracle weights");
    command->add_option("--trials", texts.trials, "Initial conditions")->type_name("N")->capture_default_str();
    command->add_option("--seed", texts.seed, "Seed of the initial conditions")->type_name("N")->capture_default_str();
    command->add_option("--vehicles", texts.learning_vehicles, "Vehicles per approach")
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--chooser", texts.learning_chooser, "Who is shown the forecasts: rollout or cumulative")
        ->type_name("NAME")
        ->capture_default_str();
    command->add_option("--updates", texts.updates, "Updates in an oracle's training")
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--jobs", texts.jobs, "Trials at the same time (default: one a core); changes no result")
        ->type_name("N");
    command->add_option("--json", texts.json, "File for the figures")->type_name("FILE");
    command->callback([command, &texts] {
        LearningRequest request;
        request.trials = whole("--trials", texts.trials, 1, most_trials);
        request.seed = whole("--seed", texts.seed, 0, largest_seed);
        request.vehicles = vehicles_of(texts.learning_vehicles);
        request.chooser = reader_of(texts.learning_chooser);
        request.updates = static_cast<unsigned>(whole("--updates", texts.updates, 1, 1e6));
        request.jobs = jobs_of(*command, texts);
        request.json = given(*command, "--json", std::filesystem::path(texts.json));
        run_learning(request);
    });
}

nlohmann::ordered_json built() {
    nlohmann::ordered_json list{{"profiles", nlohmann::ordered_json::array()},
                                {"choosers", nlohmann::ordered_json::array()},
                                {"forecasts", forecast_names()},
                                {"links", {"inproc", "can"}}};
    for (const auto &profile : profiles()) {
        list["profiles"].push_back({{"name", profile.name}, {"what", profile.what}});
    }
    for (const auto &kind : chooser_kinds()) {
        list["choosers"].push_back({{"name", kind.name},
                                    {"what", kind.what},
                                    {"rival", kind.rival},
                                    {"forecasts", kind.forecasts},
                                    {"options", kind.options}});
    }
    return list;
}

void print_list() {
    std::printf("Profiles\n");
    for (const auto &profile : profiles()) {
        std::printf("  %-13s %s\n", profile.name.c_str(), profile.what.c_str());
    }
    std::printf("\nChoosers: NAME[@OPTION[=VALUE]...][:FORECAST]\n");
    for (const auto &kind : chooser_kinds()) {
        std::printf("  %-13s %s%s\n", kind.name.c_str(), kind.what.c_str(), kind.rival ? " (rival)" : "");
        std::printf("  %-13s   options: %s\n", "", join(kind.options, ", ").c_str());
    }
    std::vector<std::string> readers;
    for (const auto &kind : chooser_kinds()) {
        if (kind.forecasts) {
            readers.push_back(kind.name);
        }
    }
    std::printf("\nForecasts, read by %s: %s\n", join(readers, " and ").c_str(), join(forecast_names(), ", ").c_str());
}

void add_list(CLI::App &app, Texts &texts) {
    auto *command = app.add_subcommand("list", "What is built: profiles, choosers with their options, forecasts");
    command->add_flag("--json", texts.list_json, "As JSON");
    command->callback([&texts] {
        if (texts.list_json) {
            std::cout << built().dump(1) << "\n";
        } else {
            print_list();
        }
    });
}

/// CLI11 would only say that a subcommand is required.
void check_command(const CLI::App &app, const std::string &word) {
    std::vector<std::string> names;
    for (const auto *const command : app.get_subcommands({})) {
        names.push_back(command->get_name());
    }
    const bool known = std::find(names.begin(), names.end(), word) != names.end();
    if (!known && word != "-h" && word != "--help") {
        throw BadRequest((word.empty() ? "no command" : "unknown command \"" + word + "\"") +
                         "; right would be one of " + join(names, ", ") + " or --help");
    }
}

int run(int argc, char **argv) {
    CLI::App app{"host_sim: replays hyperchaotic traffic at one junction and lets the firmware's own core, or a rival, "
                 "run its signals."};
    app.footer("Exit codes: 0 done, 1 it ran and a check failed, 2 the request cannot be run (one line says why).\n"
               "Start with: host_sim experiment        Then look at: out/experiment/claims.json, "
               "out/experiment/throughput.png");
    app.require_subcommand(1);
    app.get_formatter()->column_width(28);
    catch_interrupts();
    Texts texts;
    add_experiment(app, texts);
    add_run(app, texts);
    add_inflow(app, texts);
    add_accuracy(app, texts);
    add_learning(app, texts);
    add_bench(app, texts);
    add_list(app, texts);
    add_serve(app, texts);
    check_command(app, argc > 1 ? argv[1] : "");
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success &success) {
        return app.exit(success);
    } catch (const CLI::ParseError &error) {
        throw BadRequest(std::string(error.what()) + " (host_sim --help, host_sim COMMAND --help)");
    }
    if (!std::cout.flush() || std::fflush(stdout) != 0) {
        throw Failure("stdout could not be written");
    }
    return 0;
}

/// One line, whatever the message held.
void complain(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    std::cerr << "host_sim: " << text << "\n";
}

} // namespace
} // namespace elmopp

int main(int argc, char **argv) {
    try {
        return elmopp::run(argc, argv);
    } catch (const elmopp::BadRequest &error) {
        elmopp::complain(error.what());
        return elmopp::exit_bad_request;
    } catch (const std::exception &error) {
        elmopp::complain(error.what());
        return elmopp::exit_failed;
    }
}
