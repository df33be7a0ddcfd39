// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "choosers.hpp"

#include "actuated.hpp"
#include "csv.hpp"
#include "cyclic.hpp"
#include "error.hpp"
#include "greedy.hpp"
#include "rounds.hpp"
#include "scats.hpp"
#include "scoot.hpp"
#include "self_control.hpp"
#include "surtrac.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

namespace elmopp {
namespace {

constexpr unsigned longest_s = 600; ///< of any green
constexpr unsigned rival_min_s = 5; ///< the window of a rival in the paper's junction, whose own is ELMOPP's
constexpr unsigned rival_max_s = 60;

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

/// A whole number between bounds. Throws BadRequest naming the value.
std::uint16_t whole_or(const ChooserSpec &spec, const std::string &option, unsigned otherwise, unsigned lowest,
                       unsigned highest, const std::string &what = "whole number") {
    const double value = number_or(spec, option, otherwise);
    if (value != std::floor(value) || value < lowest || value > highest) {
        throw BadRequest("option " + option + " of chooser " + spec.name + " is " + format_number(value, 9) +
                         "; right would be a " + what + " from " + std::to_string(lowest) + " to " +
                         std::to_string(highest));
    }
    return static_cast<std::uint16_t>(value);
}

std::uint16_t seconds_or(const ChooserSpec &spec, const std::string &option, unsigned otherwise, unsigned lowest,
                         unsigned highest) {
    return whole_or(spec, option, otherwise, lowest, highest, "whole number of seconds");
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
elmopp_urgency_options_t urgency_options_of(const ChooserSpec &spec, const Setting &setting) {
    const bool literal = setting.literal;
    const bool cumulative = spec.name == "cumulative";
    elmopp_urgency_options_t options{};
    std::tie(options.min_s, options.max_s) =
        window_of(spec, literal ? 1U : setting.junction.hold_min_s, setting.junction.hold_max_s, ELMOPP_HORIZON_MAX);
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
elmopp_pressure_t pressure_of(const ChooserSpec &spec, const Setting &setting) {
    const unsigned site_min_s = setting.own_site ? setting.junction.hold_min_s : ELMOPP_PRESSURE_MIN_S;
    const unsigned site_max_s = setting.own_site ? setting.junction.hold_max_s : ELMOPP_PRESSURE_MAX_S;
    const auto [min_s, max_s] = window_of(spec, site_min_s, site_max_s, longest_s);
    return {factor_or(spec, "h", static_cast<double>(ELMOPP_PRESSURE_RATIO)), min_s, max_s};
}

/// The window of a rival, of priced and of rollout: its own bounds in the paper's junction, the site's everywhere else.
std::pair<std::uint16_t, std::uint16_t> rival_window_of(const ChooserSpec &spec, const Setting &setting) {
    const unsigned site_min_s = setting.own_site ? setting.junction.hold_min_s : rival_min_s;
    const unsigned site_max_s = setting.own_site ? setting.junction.hold_max_s : rival_max_s;
    return window_of(spec, site_min_s, site_max_s, longest_s);
}

std::uint16_t min_of(const ChooserSpec &spec, const Setting &setting) {
    return seconds_or(spec, "min", setting.own_site ? setting.junction.hold_min_s : rival_min_s, 1, longest_s);
}

using Made = std::unique_ptr<Plugged>;

template <typename Rule> Made plugged(Rule rule) {
    auto made = std::make_unique<PluggedAs<Rule>>(std::move(rule));
    made->chooser = plug(made->state);
    return made;
}

Made make_urgency(const ChooserSpec &spec, const Setting &setting) {
    const auto options = urgency_options_of(spec, setting);
    auto made = std::make_unique<PluggedAs<elmopp_urgency_t>>(elmopp_urgency_t{});
    made->chooser = elmopp_urgency_init(&made->state, &options);
    return made;
}

Made make_pressure(const ChooserSpec &spec, const Setting &setting) {
    auto made = std::make_unique<PluggedAs<elmopp_pressure_t>>(pressure_of(spec, setting));
    made->chooser = elmopp_pressure_init(&made->state);
    return made;
}

Made make_priced(const ChooserSpec &spec, const Setting &setting) {
    const auto [min_s, max_s] = rival_window_of(spec, setting);
    auto made = std::make_unique<PluggedAs<elmopp_priced_t>>(elmopp_priced_t{});
    made->chooser = elmopp_priced_init(&made->state, min_s, max_s);
    return made;
}

/// A share above 0. Throws BadRequest naming the value.
float share_or(const ChooserSpec &spec, const std::string &option, float otherwise) {
    const double value = number_or(spec, option, static_cast<double>(otherwise));
    if (!(value > 0.0 && value <= 1.0)) {
        throw BadRequest("option " + option + " of chooser " + spec.name + " is " + format_number(value, 9) +
                         "; right would be above 0, at most 1");
    }
    return static_cast<float>(value);
}

/// Seconds, or 0 for unlimited.
std::uint16_t bound_or(const ChooserSpec &spec, const std::string &option, unsigned otherwise) {
    const auto found = spec.options.find(option);
    const bool unlimited = found != spec.options.end() && found->second == "unlimited";
    return unlimited ? std::uint16_t{0} : seconds_or(spec, option, otherwise, 1, longest_s);
}

elmopp_rollout_options_t rollout_options_of(const ChooserSpec &spec, const Setting &setting) {
    elmopp_rollout_options_t options = elmopp_rollout_defaults(0);
    std::transform(
        setting.travel_s.begin(), setting.travel_s.end(), std::begin(options.sight.travel_s),
        [](unsigned travel_s) { return static_cast<std::uint16_t>(std::min(travel_s, ELMOPP_SIGHT_TRAVEL_MAX_S)); });
    std::tie(options.future.min_s, options.future.max_s) = rival_window_of(spec, setting);
    elmopp_coming_options_t &coming = options.coming;
    coming.horizon_s = seconds_or(spec, "horizon", coming.horizon_s, 1, ELMOPP_HORIZON_MAX);
    coming.rows_s = seconds_or(spec, "rows", coming.rows_s, 1, ELMOPP_HORIZON_MAX);
    const auto weight = spec.options.find("weight");
    coming.weigh_skill = weight == spec.options.end() || weight->second == "by-skill";
    coming.row_weight = coming.weigh_skill ? coming.row_weight : share_or(spec, "weight", coming.row_weight);
    options.red_s = bound_or(spec, "red", options.red_s);
    // Who bounds no red is fair to nobody, unless he says so.
    const bool hurries_nobody = options.red_s == 0 && !has(spec, "patience");
    options.patience_s = hurries_nobody ? std::uint16_t{0} : bound_or(spec, "patience", options.patience_s);
    options.patience_veh_s = options.patience_s > 0 ? options.patience_veh_s : 0.0F;
    options.caution = share_or(spec, "caution", options.caution);
    options.others_max = static_cast<std::uint8_t>(
        whole_or(spec, "others", options.others_max, 1, ELMOPP_STAGE_MAX, "whole number of stages"));
    options.sight.gives_way = !has(spec, "no-gaps");
    options.future.look = !has(spec, "no-look");
    options.future.stop_s = setting.stops_free ? 0.0F : options.future.stop_s;
    options.rule_count = has(spec, "one-rule") ? std::uint8_t{1} : options.rule_count;
    return options;
}

Made make_rollout(const ChooserSpec &spec, const Setting &setting) {
    const auto options = rollout_options_of(spec, setting);
    auto made = std::make_unique<PluggedAs<elmopp_rollout_t>>(elmopp_rollout_t{});
    made->chooser = elmopp_rollout_init(&made->state, &options);
    return made;
}

Made make_itlc(const ChooserSpec &spec, const Setting & /*setting*/) {
    return plugged(Itlc{number_or(spec, "ready", 30.0)});
}

Made make_itlc_rounds(const ChooserSpec &spec, const Setting &setting) {
    return plugged(ItlcRounds{number_or(spec, "ready", ready_unlimited), Approaching(setting.travel_s)});
}

Made make_oaf(const ChooserSpec &spec, const Setting & /*setting*/) {
    return plugged(Oaf{number_or(spec, "platoon", 10.0)});
}

Made make_fixed(const ChooserSpec &spec, const Setting & /*setting*/) {
    return plugged(Fixed{seconds_or(spec, "green", 20, 1, longest_s)});
}

Made make_webster(const ChooserSpec &spec, const Setting & /*setting*/) {
    const std::uint16_t shortest_s = seconds_or(spec, "cycle-min", 30, 1, longest_s);
    const std::uint16_t longest_cycle_s = seconds_or(spec, "cycle-max", 120, shortest_s, longest_s);
    return plugged(Webster{seconds_or(spec, "green", 20, 1, longest_s), shortest_s, longest_cycle_s});
}

Made make_actuated(const ChooserSpec &spec, const Setting &setting) {
    const auto [min_s, max_s] = rival_window_of(spec, setting);
    return plugged(Actuated{min_s, max_s, seconds_or(spec, "gap", 3, 1, longest_s), Approaching(setting.travel_s)});
}

Made make_max_pressure(const ChooserSpec &spec, const Setting &setting) {
    return plugged(MaxPressure{seconds_or(spec, "interval", 10, 1, longest_s), setting.downstream_veh});
}

Made make_longest_queue(const ChooserSpec &spec, const Setting &setting) {
    return plugged(LongestQueue{min_of(spec, setting), Approaching(setting.travel_s)});
}

Made make_max_wave(const ChooserSpec &spec, const Setting &setting) {
    return plugged(MaxWave{min_of(spec, setting)});
}

Made make_max_wave_hold(const ChooserSpec &spec, const Setting &setting) {
    return plugged(MaxWaveHold{min_of(spec, setting), number_or(spec, "margin", 4.0), number_or(spec, "empty", 1.0)});
}

Made make_elmopp_hold(const ChooserSpec &spec, const Setting &setting) {
    const auto [min_s, max_s] = rival_window_of(spec, setting);
    return plugged(ElmoppHold{min_s, max_s, number_or(spec, "weight", 2.0)});
}

Made make_scats(const ChooserSpec &spec, const Setting & /*setting*/) {
    const std::uint16_t shortest_s = seconds_or(spec, "cycle-min", 40, 1, longest_s);
    const std::uint16_t longest_cycle_s = seconds_or(spec, "cycle-max", 120, shortest_s, longest_s);
    const unsigned medium_s = std::clamp<unsigned>(70, shortest_s, longest_cycle_s);
    return plugged(
        Scats{shortest_s, seconds_or(spec, "cycle-med", medium_s, shortest_s, longest_cycle_s), longest_cycle_s});
}

Made make_scoot(const ChooserSpec &spec, const Setting & /*setting*/) {
    return plugged(Scoot{seconds_or(spec, "cycle-max", 120, 1, longest_s), number_or(spec, "target", 0.9)});
}

Made make_surtrac(const ChooserSpec &spec, const Setting &setting) {
    const auto [min_s, max_s] = rival_window_of(spec, setting);
    return plugged(Surtrac{min_s, max_s, seconds_or(spec, "gap", 3, 1, longest_s),
                           seconds_or(spec, "horizon", 60, 1, longest_s), Approaching(setting.travel_s)});
}

Made make_self_control(const ChooserSpec &spec, const Setting &setting) {
    const std::uint16_t period_s = seconds_or(spec, "period", 60, 1, longest_s);
    const std::uint16_t longest_interval_s =
        seconds_or(spec, "longest", std::max<unsigned>(90, period_s), period_s, 2 * longest_s);
    return plugged(SelfControl{min_of(spec, setting), period_s, longest_interval_s, Approaching(setting.travel_s)});
}

Made make_random(const ChooserSpec &spec, const Setting &setting) {
    const bool given = has(spec, "seed");
    const std::uint64_t seed = given ? whole_or(spec, "seed", 1, 1, 0xFFFFU) : setting.seed;
    return plugged(Random{seconds_or(spec, "interval", 10, 1, longest_s), std::mt19937_64(seed)});
}

const std::map<std::string, Made (*)(const ChooserSpec &, const Setting &)> &makers() {
    static const std::map<std::string, Made (*)(const ChooserSpec &, const Setting &)> all{
        {"naive", make_urgency},
        {"cumulative", make_urgency},
        {"pressure", make_pressure},
        {"priced", make_priced},
        {"rollout", make_rollout},
        {"itlc", make_itlc},
        {"oaf", make_oaf},
        {"fixed", make_fixed},
        {"webster", make_webster},
        {"actuated", make_actuated},
        {"max-pressure", make_max_pressure},
        {"longest-queue", make_longest_queue},
        {"max-wave", make_max_wave},
        {"max-wave-hold", make_max_wave_hold},
        {"elmopp-hold", make_elmopp_hold},
        {"itlc-rounds", make_itlc_rounds},
        {"scats", make_scats},
        {"scoot", make_scoot},
        {"surtrac", make_surtrac},
        {"self-control", make_self_control},
        {"random", make_random},
    };
    return all;
}

} // namespace

std::unique_ptr<Plugged> make_chooser(const ChooserSpec &spec, const Setting &setting) {
    return makers().at(spec.name)(spec, setting);
}

} // namespace elmopp
