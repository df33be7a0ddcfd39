// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "choosers.hpp"

#include "csv.hpp"
#include "error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace elmopp {
namespace {

constexpr unsigned pressure_max_s = 600;
const std::vector<std::string> urgency_options{"min",          "max",          "hysteresis=1", "frozen",
                                               "constant-age", "printed-sign", "stage-age",    "windowless"};

const ChooserKind &find_kind(const std::string &name) {
    std::vector<std::string> names;
    for (const auto &kind : chooser_kinds()) {
        if (kind.name == name) {
            return kind;
        }
        names.push_back(kind.name);
    }
    throw BadRequest("unknown chooser \"" + name + "\"; right would be one of " + join(names, ", "));
}

bool is_switch(const std::string &option) {
    static const std::array<std::string, 5> switches{"frozen", "constant-age", "printed-sign", "stage-age",
                                                     "windowless"};
    return std::find(switches.begin(), switches.end(), option) != switches.end();
}

void check_option(const ChooserKind &kind, const std::string &name, const std::string &value) {
    const auto names_it = [&name](const std::string &option) { return split(option, '=').front() == name; };
    if (std::none_of(kind.options.begin(), kind.options.end(), names_it)) {
        throw BadRequest("unknown option \"" + name + "\" of chooser " + kind.name + "; right would be " +
                         (kind.options.empty() ? "none" : "one of " + join(kind.options, ", ")));
    }
    double number = 0.0;
    const bool good = is_switch(name)        ? value.empty()
                      : value == "unlimited" ? name == "ready"
                                             : parse_number(value, number) && number > 0.0;
    if (!good) {
        throw BadRequest("option \"" + name + "\" of chooser " + kind.name + " has value \"" + value +
                         "\"; right would be " + (is_switch(name) ? "no value" : "a number above 0"));
    }
}

std::pair<std::string, std::string> parse_option(const std::string &text) {
    const auto equals = text.find('=');
    return equals == std::string::npos ? std::make_pair(text, std::string())
                                       : std::make_pair(text.substr(0, equals), text.substr(equals + 1));
}

void add_option(ChooserSpec &spec, const ChooserKind &kind, const std::string &word, const std::string &whole) {
    const auto [name, value] = parse_option(word);
    check_option(kind, name, value);
    if (!spec.options.emplace(name, value).second) {
        throw BadRequest("option \"" + name + "\" is given twice in \"" + whole + "\"; right would be once");
    }
}

bool has(const ChooserSpec &spec, const std::string &option) {
    return spec.options.count(option) != 0;
}

/// An option's number, or the default.
double number_or(const ChooserSpec &spec, const std::string &option, double otherwise) {
    const auto found = spec.options.find(option);
    if (found == spec.options.end()) {
        return otherwise;
    }
    double value = ready_unlimited;
    (void)parse_number(found->second, value);
    return value;
}

/// A whole number of seconds between bounds. Throws BadRequest naming the value.
std::uint16_t seconds_or(const ChooserSpec &spec, const std::string &option, unsigned otherwise, unsigned lowest,
                         unsigned highest) {
    const double value = number_or(spec, option, otherwise);
    if (value != std::floor(value) || value < lowest || value > highest) {
        throw BadRequest("option " + option + " of chooser " + spec.name + " is " + format_number(value, 9) +
                         "; right would be a whole number of seconds from " + std::to_string(lowest) + " to " +
                         std::to_string(highest));
    }
    return static_cast<std::uint16_t>(value);
}

/// The window, each end held against the other: the message names the one that was given.
std::pair<std::uint16_t, std::uint16_t> window_of(const ChooserSpec &spec, unsigned min_s, unsigned max_s,
                                                  unsigned highest) {
    const unsigned min_highest = has(spec, "max") ? highest : std::min(max_s, highest);
    const std::uint16_t shortest = seconds_or(spec, "min", min_s, 1, min_highest);
    return {shortest, seconds_or(spec, "max", max_s, shortest, highest)};
}

float factor_or(const ChooserSpec &spec, const std::string &option, double otherwise) {
    const double value = number_or(spec, option, otherwise);
    if (!(value >= 1.0 && value <= 1e6)) {
        throw BadRequest("option " + option + " of chooser " + spec.name + " is " + format_number(value, 9) +
                         "; right would be 1 to 1000000");
    }
    return static_cast<float>(value);
}

/// Under profile `literal` both take the best stage of every second; naive keeps eq. 2 (T per subedge), cumulative is
/// Algorithm 1 with its age per configuration and the printed sign, which leaves T constant inside the sum.
elmopp_urgency_options_t urgency_options_of(const ChooserSpec &spec, const Scenario &scenario) {
    const bool literal = scenario.profile.literal;
    const bool cumulative = spec.name == "cumulative";
    elmopp_urgency_options_t options{};
    std::tie(options.min_s, options.max_s) =
        window_of(spec, literal ? 1U : scenario.junction.hold_min_s, scenario.junction.hold_max_s, ELMOPP_HORIZON_MAX);
    options.hysteresis = factor_or(spec, "hysteresis", 1.0);
    options.cumulative = cumulative;
    options.frozen = has(spec, "frozen");
    options.constant_age = has(spec, "constant-age") || (literal && cumulative);
    options.printed_sign = has(spec, "printed-sign") || (literal && cumulative);
    options.stage_age = has(spec, "stage-age") || (literal && cumulative);
    options.windowless = has(spec, "windowless") || literal;
    return options;
}

/// The specification's window of pressure is for the paper's junction; a site's own window holds for every chooser.
elmopp_pressure_t pressure_of(const ChooserSpec &spec, const Scenario &scenario) {
    const unsigned site_min_s = scenario.own_site ? scenario.junction.hold_min_s : ELMOPP_PRESSURE_MIN_S;
    const unsigned site_max_s = scenario.own_site ? scenario.junction.hold_max_s : ELMOPP_PRESSURE_MAX_S;
    const auto [min_s, max_s] = window_of(spec, site_min_s, site_max_s, pressure_max_s);
    return {factor_or(spec, "h", static_cast<double>(ELMOPP_PRESSURE_RATIO)), min_s, max_s};
}

} // namespace

std::string ChooserSpec::label() const {
    std::string text = name;
    for (const auto &[option, value] : options) {
        text += "@" + option + (value.empty() ? "" : "=" + value);
    }
    return text;
}

std::string full_name(const std::string &label, const std::string &forecast) {
    return forecast == "none" ? label : label + ":" + forecast;
}

bool ChooserSpec::operator==(const ChooserSpec &other) const {
    return label() == other.label() && forecast == other.forecast;
}

const std::vector<ChooserKind> &chooser_kinds() {
    static const std::vector<ChooserKind> kinds{
        {"naive", "ELMOPP's urgency of the vehicles that are there", false, false, urgency_options},
        {"cumulative", "ELMOPP's urgency summed over the forecast", false, true, urgency_options},
        {"pressure", "sum of queue times flow, left for h times as much", false, false, {"h=3", "min=5", "max=120"}},
        {"itlc", "most vehicles in the ready area, green until they have crossed", true, false, {"ready=30"}},
        {"oaf", "oldest head first, green for one platoon", true, false, {"platoon=10"}},
        {"fixed", "fixed times in a covering cycle", true, false, {"green=20"}},
    };
    return kinds;
}

const std::vector<std::string> &forecast_names() {
    static const std::vector<std::string> names{"none", "mean", "persistence", "ewma",
                                                "ar8",  "lstm", "nlstm",       "oracle"};
    return names;
}

ChooserSpec parse_chooser(const std::string &text) {
    const auto colon = text.find(':');
    const auto words = split(text.substr(0, colon), '@');
    const ChooserKind &kind = find_kind(words.front());
    ChooserSpec spec{kind.name, {}, "none"};
    for (std::size_t i = 1; i < words.size(); ++i) {
        add_option(spec, kind, words[i], text);
    }
    if (colon != std::string::npos) {
        spec.forecast = text.substr(colon + 1);
        const auto &names = forecast_names();
        if (std::find(names.begin(), names.end(), spec.forecast) == names.end()) {
            throw BadRequest("unknown forecast \"" + spec.forecast + "\"; right would be one of " + join(names, ", "));
        }
        if (!kind.forecasts && spec.forecast != "none") {
            throw BadRequest("chooser " + kind.name + " reads no forecast, \"" + text + "\" asks for " + spec.forecast +
                             "; right would be " + kind.name);
        }
    }
    return spec;
}

std::vector<ChooserSpec> parse_choosers(const std::string &text) {
    std::vector<ChooserSpec> specs;
    const auto add = [&specs](const ChooserSpec &spec) {
        if (std::find(specs.begin(), specs.end(), spec) == specs.end()) {
            specs.push_back(spec);
        }
    };
    for (const auto &word : split(text, ',')) {
        if (word != "all") {
            add(parse_chooser(word));
            continue;
        }
        for (const auto &kind : chooser_kinds()) {
            for (const auto &forecast : forecast_names()) {
                if (kind.forecasts || forecast == "none") {
                    add({kind.name, {}, forecast});
                }
            }
        }
    }
    return specs;
}

std::vector<ChooserSpec> paper_table() {
    return parse_choosers("naive,cumulative:none,cumulative:mean,cumulative:persistence,cumulative:ar8,cumulative:lstm,"
                          "cumulative:nlstm,cumulative:oracle,pressure,itlc,oaf,fixed");
}

ChooserSpec site_chooser(const elmopp_junction_t &junction) {
    // In the order of ELMOPP_CHOOSER_* and ELMOPP_FORECAST_*.
    static const std::array<const char *, ELMOPP_CHOOSER_COUNT> names{"naive", "cumulative", "pressure"};
    ChooserSpec spec{names.at(junction.chooser), {}, forecast_names().at(junction.forecast)};
    spec.forecast = find_kind(spec.name).forecasts ? spec.forecast : "none";
    return spec;
}

std::uint8_t forecast_kind(const std::string &name) {
    const auto &names = forecast_names();
    const auto index = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    return static_cast<std::uint8_t>(index < ELMOPP_FORECAST_COUNT ? index : 0);
}

std::unique_ptr<Plugged> make_chooser(const ChooserSpec &spec, const Scenario &scenario) {
    auto plugged = std::make_unique<Plugged>();
    if (spec.name == "pressure") {
        plugged->chooser =
            elmopp_pressure_init(&plugged->state.emplace<elmopp_pressure_t>(pressure_of(spec, scenario)));
    } else if (spec.name == "itlc") {
        plugged->chooser = plug(plugged->state.emplace<Itlc>(Itlc{number_or(spec, "ready", 30.0)}));
    } else if (spec.name == "oaf") {
        plugged->chooser = plug(plugged->state.emplace<Oaf>(Oaf{number_or(spec, "platoon", 10.0), 0, 0.0, {}}));
    } else if (spec.name == "fixed") {
        plugged->chooser = plug(plugged->state.emplace<Fixed>(Fixed{seconds_or(spec, "green", 20, 1, 600), {}}));
    } else {
        const auto options = urgency_options_of(spec, scenario);
        plugged->chooser = elmopp_urgency_init(&plugged->state.emplace<elmopp_urgency_t>(), &options);
    }
    return plugged;
}

} // namespace elmopp
