// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "choosers.hpp"

#include "csv.hpp"
#include "error.hpp"
#include "learning.hpp"

#include <algorithm>
#include <array>

namespace elmopp {
namespace {

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
    static const std::array<std::string, 8> switches{"frozen",     "constant-age", "printed-sign", "stage-age",
                                                     "windowless", "one-rule",     "no-gaps",      "no-look"};
    return std::find(switches.begin(), switches.end(), option) != switches.end();
}

bool may_be_unlimited(const std::string &option) {
    return option == "ready" || option == "red" || option == "patience";
}

std::string right_value(const std::string &name, const std::string &listed) {
    const bool by_skill = listed == "weight=by-skill";
    return is_switch(name) ? "no value"
                           : std::string("a number above 0") + (by_skill || name == "caution" ? ", at most 1" : "") +
                                 (by_skill ? ", or by-skill" : "") + (may_be_unlimited(name) ? ", or unlimited" : "");
}

void check_option(const ChooserKind &kind, const std::string &name, const std::string &value) {
    const auto names_it = [&name](const std::string &option) { return split(option, '=').front() == name; };
    const auto listed = std::find_if(kind.options.begin(), kind.options.end(), names_it);
    if (listed == kind.options.end()) {
        throw BadRequest("unknown option \"" + name + "\" of chooser " + kind.name + "; right would be " +
                         (kind.options.empty() ? "none" : "one of " + join(kind.options, ", ")));
    }
    double number = 0.0;
    const bool good = is_switch(name)        ? value.empty()
                      : value == "unlimited" ? may_be_unlimited(name)
                      : value == "by-skill"  ? *listed == "weight=by-skill"
                                             : parse_number(value, number) && number > 0.0;
    if (!good) {
        throw BadRequest("option \"" + name + "\" of chooser " + kind.name + " has value \"" + value +
                         "\"; right would be " + right_value(name, *listed));
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
        {"priced",
         "ELMOPP's urgency for each second, a change costing what it takes",
         false,
         false,
         {"min=5", "max=60"}},
        {"rollout",
         "the next stage that is cheapest in a model of the coming two minutes",
         false,
         true,
         {"min=5", "max=60", "horizon=120", "weight=by-skill", "red=180", "rows=30", "others=4", "caution=0.5",
          "patience=40", "one-rule", "no-gaps", "no-look"}},
        {"itlc", "most vehicles in the ready area, green until they have crossed", true, false, {"ready=30"}},
        {"oaf", "oldest head first, green for one platoon", true, false, {"platoon=10"}},
        {"fixed", "fixed times in a covering cycle", true, false, {"green=20"}},
        {"webster",
         "fixed times by Webster's formula from the first 15 minutes' flows",
         true,
         false,
         {"green=20", "cycle-min=30", "cycle-max=120"}},
        {"actuated",
         "phases in turn, each until the first gap; those that nobody calls are skipped",
         true,
         false,
         {"gap=3", "min=5", "max=60"}},
        {"max-pressure",
         "largest sum of saturation flow times (vehicles here less vehicles behind)",
         true,
         false,
         {"interval=10"}},
        {"longest-queue", "the stage that contains the longest queue", true, false, {"min=5"}},
        {"max-wave", "the stage with most vehicles, waiting or on their way", true, false, {"min=5"}},
        {"max-wave-hold",
         "the same, left for 4 more vehicles a lane or when nearly empty",
         true,
         false,
         {"min=5", "margin=4", "empty=1"}},
        {"elmopp-hold",
         "naive urgency in which what is green counts twice",
         true,
         false,
         {"min=5", "max=60", "weight=2"}},
        {"itlc-rounds",
         "ITLC in rounds: the densest stage not yet served, green until it has crossed",
         true,
         false,
         {"ready=unlimited"}},
        {"scats",
         "a cycle and a split that follow the degree of saturation",
         true,
         false,
         {"cycle-min=40", "cycle-med=70", "cycle-max=120"}},
        {"scoot", "a cycle that a model of the queues moves by seconds", true, false, {"cycle-max=120", "target=0.9"}},
        {"surtrac",
         "the first cluster of the cheapest schedule of all that are seen",
         true,
         false,
         {"min=5", "max=60", "gap=3", "horizon=60"}},
        {"self-control",
         "most vehicles for each second it takes, nobody too late",
         true,
         false,
         {"min=5", "period=60", "longest=90"}},
        {"random", "any stage, drawn anew again and again", true, false, {"interval=10", "seed=1"}},
    };
    return kinds;
}

const std::vector<std::string> &forecast_names() {
    // In the order of ELMOPP_FORECAST_*, and then what is none of the firmware's, or one of them that learns on.
    static const std::vector<std::string> names{"none",      "mean",   "persistence", "ewma",        "ar8",
                                                "lstm",      "nlstm",  "ann",         "gcn",         "lstm-q15",
                                                "nlstm-q15", "oracle", "lstm-learn",  "nlstm-learn", "lstm-literal"};
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
    static const std::array<const char *, ELMOPP_CHOOSER_COUNT> names{"naive", "cumulative", "pressure", "priced",
                                                                      "rollout"};
    const std::string learning = junction.learning != 0 ? "-learn" : "";
    ChooserSpec spec{names.at(junction.chooser), {}, forecast_names().at(junction.forecast) + learning};
    spec.forecast = find_kind(spec.name).forecasts ? spec.forecast : "none";
    return spec;
}

std::uint8_t forecast_kind(const std::string &name) {
    const auto &names = forecast_names();
    // What learns on is of its network's kind.
    const auto index =
        static_cast<std::size_t>(std::find(names.begin(), names.end(), network_of(name)) - names.begin());
    return static_cast<std::uint8_t>(index < ELMOPP_FORECAST_COUNT ? index : 0);
}

} // namespace elmopp
