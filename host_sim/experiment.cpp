// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "experiment.hpp"

#include "claims.hpp"
#include "error.hpp"
#include "jobs.hpp"
#include "lyapunov.hpp"
#include "networks.hpp"
#include "output_folder.hpp"
#include "results.hpp"
#include "sites.hpp"
#include "trial.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <map>

namespace elmopp {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t paper_approaches = 4;
constexpr std::size_t lyapunov_steps = 400000;
constexpr std::size_t most_foresights = 200; ///< trajectories whose rows are kept: 2 MB each and network

/// One row to be: everything that distinguishes a trial.
struct Cell {
    std::size_t scenario;
    ChooserSpec chooser;
    unsigned vehicles; ///< 0: the trial's random number
    std::uint64_t trial;
};

/// Cells of one kind: choosers on one profile.
struct Block {
    std::string profile;
    std::vector<ChooserSpec> choosers;
};

/// Of the printed algorithm, what is printed of it: no rival had a printed form.
std::vector<ChooserSpec> literal_table() {
    return parse_choosers("naive,cumulative:none,cumulative:lstm-literal");
}

std::vector<ChooserSpec> usual_choosers(const std::string &profile) {
    return profile == "literal" ? literal_table() : paper_table();
}

/// What stands beside the paper's table: each rival's sweep, the profile of the printed figure and the literal
/// algorithm.
std::vector<Block> beside_blocks() {
    const auto sweeps =
        parse_choosers("pressure@h=1,pressure@h=2,pressure@h=5,itlc@ready=5,itlc@ready=10,itlc@ready=20,itlc@ready=60,"
                       "itlc@ready=unlimited,oaf@platoon=2,oaf@platoon=5,oaf@platoon=20,oaf@platoon=40,oaf@platoon=80,"
                       "oaf@platoon=160,fixed@green=10,"
                       "fixed@green=15,fixed@green=30,fixed@green=45");
    return {{"paper", sweeps},
            {"saturation", sweeps},
            {"figure", parse_choosers("naive,cumulative:none,cumulative:ar8,cumulative:oracle,itlc,oaf")},
            {"literal", literal_table()}};
}

class Progress {
  public:
    explicit Progress(std::size_t total) : total_(total), shown_(isatty(STDERR_FILENO) != 0) {}
    void operator()(std::size_t done) {
        const std::size_t percent = 100 * done / total_;
        if (shown_ && percent != last_) {
            last_ = percent;
            std::cerr << "\r" << percent << " % of " << total_ << " trials" << (done == total_ ? "\n" : "")
                      << std::flush;
        }
    }

  private:
    std::size_t total_;
    std::size_t last_ = 101;
    bool shown_;
};

class Experiment {
  public:
    explicit Experiment(const ExperimentRequest &request) : request_(request) {
        std::vector<Block> blocks;
        blocks.reserve(request.profiles.size());
        for (const auto &profile : request.profiles) {
            blocks.push_back({profile, request.choosers.empty() ? usual_choosers(profile) : request.choosers});
        }
        add(blocks);
        main_cells_ = cells_.size();
        if (request.beside) {
            add(beside_blocks());
        }
    }

    void run() {
        make_sources();
        look_ahead();
        rows_.resize(cells_.size());
        Progress progress(cells_.size());
        run_jobs(
            cells_.size(), request_.jobs, [this](std::size_t i) { rows_[i] = run_cell(cells_[i]); },
            std::ref(progress));
    }

    [[nodiscard]] std::vector<Row> main_rows() const {
        return {rows_.begin(), rows_.begin() + static_cast<std::ptrdiff_t>(main_cells_)};
    }
    [[nodiscard]] std::vector<Row> beside_rows() const {
        return {rows_.begin() + static_cast<std::ptrdiff_t>(main_cells_), rows_.end()};
    }

  private:
    void add(const std::vector<Block> &blocks) {
        const auto vehicles = request_.vehicles.empty() ? std::vector<unsigned>{0} : request_.vehicles;
        for (const auto &block : blocks) {
            scenarios_.push_back(make_scenario(block.profile, nullptr, request_.split));
            for (const auto &chooser : block.choosers) {
                (void)make_chooser(chooser,
                                   scenarios_.back().setting()); // a wrong option ends here, before anything runs
                for (const unsigned count : vehicles) {
                    for (std::uint64_t trial = 0; trial < request_.trials; ++trial) {
                        cells_.push_back({scenarios_.size() - 1, chooser, count, trial});
                    }
                }
            }
        }
    }

    [[nodiscard]] Integrator integrator_of(const Scenario &scenario) const {
        return request_.integrator.value_or(scenario.profile.integrator);
    }

    void make_sources() {
        for (const auto &scenario : scenarios_) {
            sources_[integrator_of(scenario)].resize(request_.trials);
        }
        for (auto &[integrator, sources] : sources_) {
            const auto make = [&, which = integrator, &list = sources](std::size_t trial) {
                list[trial] = make_source(which, request_.mapping, request_.seed, trial, paper_approaches);
            };
            run_jobs(sources.size(), request_.jobs, make, {});
        }
    }

    /// Every network that a cell asks for runs once over each trajectory.
    void look_ahead() {
        if (request_.trials > most_foresights) {
            return; // each trial then runs its network for itself: slower, the same
        }
        std::map<std::pair<Integrator, std::string>, std::uint16_t> steps;
        for (const auto &cell : cells_) {
            const Scenario &scenario = scenarios_[cell.scenario];
            if (!scenario.street && shipped_weights(cell.chooser.forecast) != nullptr) {
                auto &most = steps[{integrator_of(scenario), cell.chooser.forecast}];
                const std::uint16_t asked_s = make_chooser(cell.chooser, scenario.setting())->chooser.horizon_s;
                most = std::max({most, asked_s, std::uint16_t{ELMOPP_PILOT_TRACE_S}});
            }
        }
        for (const auto &[key, most] : steps) {
            const auto &sources = sources_.at(key.first);
            auto &list = foresights_[key];
            list.resize(sources.size());
            const auto look = [&, forecast = key.second, count = most, &found = list](std::size_t trial) {
                found[trial] =
                    foresee({forecast, *shipped_weights(forecast), sources[trial].unit, count, simulated_points});
            };
            run_jobs(sources.size(), request_.jobs, look, {});
        }
    }

    [[nodiscard]] const Foresight *foresight_of(const Cell &cell) const {
        const auto found = foresights_.find({integrator_of(scenarios_[cell.scenario]), cell.chooser.forecast});
        // Single vehicles are no trajectory of the paper's: their network runs inside the trial.
        const bool looked = found != foresights_.end() && !scenarios_[cell.scenario].street;
        return looked ? &found->second[cell.trial] : nullptr;
    }

    [[nodiscard]] Row run_cell(const Cell &cell) const {
        const Scenario &scenario = scenarios_[cell.scenario];
        const Source &source = sources_.at(integrator_of(scenario))[cell.trial];
        const unsigned vehicles = cell.vehicles == 0 ? source.random_vehicles : cell.vehicles;
        const double each = vehicles_per_approach(scenario.profile.scope, vehicles, paper_approaches);
        Demand demand =
            scenario.street
                ? make_discrete_demand(scenario, source.unit, each, request_.seed, cell.trial, simulated_points)
                : make_demand(source.unit, each, training_points, source.ar8, true, simulated_points);
        demand.foresight = foresight_of(cell);
        return {scenario.profile.name,
                cell.chooser.label(),
                cell.chooser.forecast,
                vehicles,
                cell.trial,
                request_.seed,
                run_trial(scenario, cell.chooser, demand, simulated_points, {})};
    }

    const ExperimentRequest &request_;
    std::vector<Scenario> scenarios_;
    std::vector<Cell> cells_;
    std::size_t main_cells_ = 0;
    std::map<Integrator, std::vector<Source>> sources_;
    std::map<std::pair<Integrator, std::string>, std::vector<Foresight>> foresights_;
    std::vector<Row> rows_;
};

Facts measure_facts(const ExperimentRequest &request) {
    Facts facts;
    const auto measure = [&facts](std::size_t which) {
        auto &exponents = which == 0 ? facts.exponents_rk4 : facts.exponents_euler;
        exponents = lyapunov_exponents(which == 0 ? Integrator::rk4 : Integrator::euler, lyapunov_steps);
    };
    if (request.count_scores) {
        facts.count_error = read_count_error(*request.count_scores);
    }
    const fs::path long_memory = find_data("weights/long_memory.json");
    if (!long_memory.empty()) {
        facts.long_memory = read_long_memory(long_memory);
    }
    run_jobs(2, request.jobs, measure, {});
    return facts;
}

/// Everything that an experiment may write.
const std::vector<fs::path> &result_files() {
    static const std::vector<fs::path> names{"trials.csv",  "waits.csv",  "summary.json",    "pairs.csv",
                                             "claims.json", "beside.csv", "throughput.png",  "throughput.svg",
                                             "delay.png",   "delay.svg",  "longest_red.png", "longest_red.svg"};
    return names;
}

/// Ends a request for figures that cannot be drawn before anything has run.
void check_plot() {
    const ToolResult result = run_tool("plot", {"--help"});
    if (result.exit_code != 0) {
        throw BadRequest("the figures cannot be drawn (--no-figures leaves them out): " + result.last_line);
    }
}

void write_results(const fs::path &folder, const std::vector<Row> &rows, const std::vector<Row> &beside,
                   const std::vector<Claim> &claims) {
    write_trials(folder / "trials.csv", rows);
    write_waits(folder / "waits.csv", rows);
    write_summary(folder / "summary.json", rows);
    write_pairs(folder / "pairs.csv", rows);
    write_claims(folder / "claims.json", claims);
    if (!beside.empty()) {
        write_trials(folder / "beside.csv", beside);
    }
}

void print_claims(const std::vector<Claim> &claims) {
    for (const auto &claim : claims) {
        std::printf("%-16s %-20s %s\n", to_string(claim.verdict).c_str(), claim.id.c_str(), claim.measured.c_str());
    }
}

} // namespace

void run_experiment(const ExperimentRequest &request) {
    if (request.figures) {
        check_plot();
    }
    Experiment experiment(request);
    const OutputFolder folder(request.out, result_files());
    const Facts facts = measure_facts(request);
    experiment.run();
    const auto rows = experiment.main_rows();
    const auto beside = experiment.beside_rows();
    const auto claims = judge(rows, beside, facts);
    write_results(folder.drafts(), rows, beside, claims);
    const ToolResult drawn =
        request.figures ? run_tool("plot", {"--results", folder.drafts().string()}) : ToolResult{0, {}};
    std::string names;
    for (const auto &name : folder.commit()) {
        names += " " + name.string();
    }
    print_claims(claims);
    std::cout << "\nWritten to " << request.out.string() << ":" << names << "\n";
    if (drawn.exit_code != 0) {
        throw Failure("the figures could not be drawn: " + drawn.last_line);
    }
}

} // namespace elmopp
