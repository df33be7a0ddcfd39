// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Results: one row a trial, the files made of them, and how they are read back.

#pragma once

#include "trial.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace elmopp {

struct Row {
    std::string profile;
    std::string chooser;
    std::string forecast;
    unsigned vehicles = 0;
    std::uint64_t trial = 0;
    std::uint64_t seed = 0;
    Metrics metrics;
};

/// A metric column by name.
struct Metric {
    std::string name;
    double Metrics::*value;
};

/// The metrics that are summarised, in the order of the columns.
const std::vector<Metric> &summarized_metrics();

/// Throws BadRequest if there is none of this name.
const Metric &find_metric(const std::string &name);

/// Which rows: an empty member fits all.
struct Selection {
    std::string profile;
    std::string chooser;
    std::string forecast;
    unsigned vehicles = 0; ///< 0: all
};

/// The metric of the selected rows, in the rows' order.
std::vector<double> pick(const std::vector<Row> &rows, const Selection &selection, const Metric &metric);

/// The metric of the selected rows, averaged over the numbers of vehicles of each trial, by trial.
std::vector<double> pick_by_trial(const std::vector<Row> &rows, const Selection &selection, const Metric &metric);

/// Writes trials.csv as spec'd: the same rows give the same bytes.
void write_trials(const std::filesystem::path &file, const std::vector<Row> &rows);

/// Writes waits.csv, the longest wait of a vehicle in each trial that has single vehicles; no file if there is none.
void write_waits(const std::filesystem::path &file, const std::vector<Row> &rows);

/// Reads trials.csv back. Throws BadRequest naming what is missing or no number.
std::vector<Row> read_trials(const std::filesystem::path &file);

/// summary.json: mean, trial sd and n for each profile, chooser, forecast, vehicles and metric.
void write_summary(const std::filesystem::path &file, const std::vector<Row> &rows);

/// pairs.csv: every pair of choosers, per number of vehicles and pooled. diff and its 95 % interval are paired by
/// trial (pooled: of the means over the numbers of vehicles); t, df and p are Welch's over all values, as the paper
/// pools.
void write_pairs(const std::filesystem::path &file, const std::vector<Row> &rows);

} // namespace elmopp
