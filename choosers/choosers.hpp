// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Choosers by name: what `--choosers` and `--chooser` accept, and what they build.
///
///     NAME[@OPTION[=VALUE]...][:FORECAST]      cumulative:ar8   naive@frozen   itlc@ready=60   pressure@h=2@max=90

#pragma once

#include "core.hpp"
#include "plugged.hpp"
#include "setting.hpp"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace elmopp {

/// A parsed chooser. `options` maps a name to its value, empty for a switch.
struct ChooserSpec {
    std::string name;
    std::map<std::string, std::string> options;
    std::string forecast = "none";

    [[nodiscard]] std::string label() const; ///< NAME[@OPTION...] without the forecast: the column `chooser`
    [[nodiscard]] bool operator==(const ChooserSpec &other) const;
};

/// LABEL[:FORECAST], without a forecast of none: a row's name in tables, figures and messages.
std::string full_name(const std::string &label, const std::string &forecast);

struct ChooserKind {
    std::string name;
    std::string what;                 ///< one line for list
    bool rival;                       ///< not part of the firmware
    bool forecasts;                   ///< reads a forecast
    std::vector<std::string> options; ///< "NAME" for a switch, "NAME=DEFAULT" otherwise
};

const std::vector<ChooserKind> &chooser_kinds();
const std::vector<std::string> &forecast_names();

/// Throws BadRequest naming the chooser, option or forecast that is unknown, and those there are.
ChooserSpec parse_chooser(const std::string &text);

/// A comma-separated list of the above; `all` is every chooser with every forecast that it reads.
std::vector<ChooserSpec> parse_choosers(const std::string &text);

/// The rows of the paper's table, as far as built.
std::vector<ChooserSpec> paper_table();

/// The site's own chooser and forecast.
ChooserSpec site_chooser(const elmopp_junction_t &junction);

/// ELMOPP_FORECAST_* of a name; `oracle` counts as none, its rows come from outside. What learns on, such as
/// `lstm-learn`, has its network's: whoever runs it hands a learner in (host_files/learning.hpp).
std::uint8_t forecast_kind(const std::string &name);

/// Builds it. Throws BadRequest naming an option whose value does not fit the setting: the window comes from the
/// setting's junction unless the options say otherwise.
std::unique_ptr<Plugged> make_chooser(const ChooserSpec &spec, const Setting &setting);

} // namespace elmopp
