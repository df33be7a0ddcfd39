// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "results.hpp"

#include "csv.hpp"
#include "error.hpp"
#include "stats.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>

namespace elmopp {
namespace {

constexpr int digits = 12; ///< enough for conservation to 1e-6 of some thousand vehicles

const std::vector<Metric> &all_metrics() {
    static const std::vector<Metric> metrics{
        {"throughput_veh_per_s", &Metrics::throughput_veh_per_s},
        {"served_share", &Metrics::served_share},
        {"mean_delay_s", &Metrics::mean_delay_s},
        {"longest_red_s", &Metrics::longest_red_s},
        {"switches", &Metrics::switches},
        {"figure_throughput_veh_per_s", &Metrics::figure_throughput_veh_per_s},
        {"vehicles_in", &Metrics::vehicles_in},
        {"vehicles_out", &Metrics::vehicles_out},
        {"vehicles_queued", &Metrics::vehicles_queued},
        {"vehicles_outside", &Metrics::vehicles_outside},
    };
    return metrics;
}

/// Distinct values of one kind, in the order in which they appear.
template <typename Value>
std::vector<Value> distinct(const std::vector<Row> &rows, const std::function<Value(const Row &)> &value_of) {
    std::vector<Value> found;
    for (const auto &row : rows) {
        const Value value = value_of(row);
        if (std::find(found.begin(), found.end(), value) == found.end()) {
            found.push_back(value);
        }
    }
    return found;
}

using Name = std::pair<std::string, std::string>; ///< chooser, forecast

std::vector<Row> of_profile(const std::vector<Row> &rows, const std::string &profile) {
    std::vector<Row> found;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(found),
                 [&](const Row &row) { return row.profile == profile; });
    return found;
}

std::vector<unsigned> vehicles_of(const std::vector<Row> &rows) {
    return distinct<unsigned>(rows, [](const Row &row) { return row.vehicles; });
}

std::vector<Name> names_of(const std::vector<Row> &rows) {
    return distinct<Name>(rows, [](const Row &row) { return Name{row.chooser, row.forecast}; });
}

std::vector<std::string> profiles_of(const std::vector<Row> &rows) {
    return distinct<std::string>(rows, [](const Row &row) { return row.profile; });
}

/// The columns that say which trial a row is.
constexpr const char *names_of_row = "profile,chooser,forecast,vehicles,trial,seed";

void write_names(std::ofstream &out, const Row &row) {
    out << row.profile << ',' << row.chooser << ',' << row.forecast << ',' << row.vehicles << ',' << row.trial << ','
        << row.seed;
}

/// Throws Failure if not all has been written.
void finish(std::ofstream &out, const std::filesystem::path &file) {
    if (!out.flush()) {
        throw Failure(file.string() + ": could not be written");
    }
}

void write_pair(std::ofstream &out, const std::vector<Row> &rows, const std::string &profile, unsigned vehicles,
                const Name &a, const Name &b) {
    for (const char *const metric_name : {"throughput_veh_per_s", "mean_delay_s", "longest_red_s"}) {
        const Metric &metric = find_metric(metric_name);
        const auto of_a = pick(rows, {profile, a.first, a.second, vehicles}, metric);
        const auto of_b = pick(rows, {profile, b.first, b.second, vehicles}, metric);
        if (of_a.size() != of_b.size()) {
            continue; // different trials: nothing to pair
        }
        const Interval interval = paired_interval(pick_by_trial(rows, {profile, a.first, a.second, vehicles}, metric),
                                                  pick_by_trial(rows, {profile, b.first, b.second, vehicles}, metric));
        const Welch test = welch(of_a, of_b);
        out << profile << ',' << (vehicles == 0 ? "pooled" : std::to_string(vehicles)) << ','
            << full_name(a.first, a.second) << ',' << full_name(b.first, b.second) << ',' << metric.name;
        for (const double value : {summarize(of_a).mean - summarize(of_b).mean, interval.low, interval.high, test.t,
                                   test.df, test.p_one_sided}) {
            out << ',' << format_number(value, 9);
        }
        out << '\n';
    }
}

} // namespace

const std::vector<Metric> &summarized_metrics() {
    static const std::vector<Metric> metrics(all_metrics().begin(), all_metrics().begin() + 6);
    return metrics;
}

const Metric &find_metric(const std::string &name) {
    for (const auto &metric : all_metrics()) {
        if (metric.name == name) {
            return metric;
        }
    }
    throw BadRequest("unknown metric \"" + name + "\"");
}

static bool fits(const Row &row, const Selection &selection) {
    return (selection.profile.empty() || row.profile == selection.profile) &&
           (selection.chooser.empty() || row.chooser == selection.chooser) &&
           (selection.forecast.empty() || row.forecast == selection.forecast) &&
           (selection.vehicles == 0 || row.vehicles == selection.vehicles);
}

std::vector<double> pick(const std::vector<Row> &rows, const Selection &selection, const Metric &metric) {
    std::vector<double> values;
    for (const auto &row : rows) {
        if (fits(row, selection)) {
            values.push_back(row.metrics.*metric.value);
        }
    }
    return values;
}

std::vector<double> pick_by_trial(const std::vector<Row> &rows, const Selection &selection, const Metric &metric) {
    std::map<std::uint64_t, std::vector<double>> by_trial;
    for (const auto &row : rows) {
        if (fits(row, selection)) {
            by_trial[row.trial].push_back(row.metrics.*metric.value);
        }
    }
    std::vector<double> means;
    means.reserve(by_trial.size());
    for (const auto &[trial, values] : by_trial) {
        means.push_back(summarize(values).mean);
    }
    return means;
}

void write_trials(const std::filesystem::path &file, const std::vector<Row> &rows) {
    std::ofstream out(file);
    out << names_of_row;
    for (const auto &metric : all_metrics()) {
        out << ',' << metric.name;
    }
    out << '\n';
    for (const auto &row : rows) {
        write_names(out, row);
        for (const auto &metric : all_metrics()) {
            out << ',' << format_number(row.metrics.*metric.value, digits);
        }
        out << '\n';
    }
    finish(out, file);
}

void write_waits(const std::filesystem::path &file, const std::vector<Row> &rows) {
    const auto has_vehicles = [](const Row &row) { return row.metrics.longest_wait_s.has_value(); };
    if (std::none_of(rows.begin(), rows.end(), has_vehicles)) {
        return;
    }
    std::ofstream out(file);
    out << names_of_row << ",longest_wait_s\n";
    for (const auto &row : rows) {
        if (row.metrics.longest_wait_s) {
            write_names(out, row);
            out << ',' << format_number(*row.metrics.longest_wait_s, digits) << '\n';
        }
    }
    finish(out, file);
}

std::vector<Row> read_trials(const std::filesystem::path &file) {
    const CsvTable table = read_csv(file);
    std::vector<Row> rows;
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        Row row;
        row.profile = table.rows[i][table.column("profile")];
        row.chooser = table.rows[i][table.column("chooser")];
        row.forecast = table.rows[i][table.column("forecast")];
        row.vehicles = static_cast<unsigned>(table.number(i, table.column("vehicles")));
        row.trial = static_cast<std::uint64_t>(table.number(i, table.column("trial")));
        row.seed = static_cast<std::uint64_t>(table.number(i, table.column("seed")));
        for (const auto &metric : all_metrics()) {
            row.metrics.*metric.value = table.number(i, table.column(metric.name));
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

void write_summary(const std::filesystem::path &file, const std::vector<Row> &rows) {
    auto list = nlohmann::ordered_json::array();
    for (const auto &profile : profiles_of(rows)) {
        const auto here = of_profile(rows, profile);
        for (const auto &[chooser, forecast] : names_of(here)) {
            for (const unsigned vehicles : vehicles_of(here)) {
                for (const auto &metric : summarized_metrics()) {
                    const Summary summary = summarize(pick(here, {profile, chooser, forecast, vehicles}, metric));
                    list.push_back({{"profile", profile},
                                    {"chooser", chooser},
                                    {"forecast", forecast},
                                    {"vehicles", vehicles},
                                    {"metric", metric.name},
                                    {"mean", summary.mean},
                                    {"sd", summary.sd},
                                    {"n", summary.n}});
                }
            }
        }
    }
    std::ofstream out(file);
    out << list.dump(1) << '\n';
    finish(out, file);
}

void write_pairs(const std::filesystem::path &file, const std::vector<Row> &rows) {
    std::ofstream out(file);
    out << "profile,vehicles,a,b,metric,diff,ci_low,ci_high,t,df,p_one_sided\n";
    for (const auto &profile : profiles_of(rows)) {
        const auto here = of_profile(rows, profile);
        const auto names = names_of(here);
        auto vehicles = vehicles_of(here);
        vehicles.push_back(0);
        for (std::size_t a = 0; a < names.size(); ++a) {
            for (std::size_t b = a + 1; b < names.size(); ++b) {
                for (const unsigned count : vehicles) {
                    write_pair(out, here, profile, count, names[a], names[b]);
                }
            }
        }
    }
    finish(out, file);
}

} // namespace elmopp
