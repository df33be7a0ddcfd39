// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Choosers by name: what is accepted, what it becomes, and that a refusal names the value and what would be right.

#include "choosers.hpp"

#include "actuated.hpp"
#include "cyclic.hpp"
#include "error.hpp"
#include "expect.hpp"
#include "greedy.hpp"
#include "rounds.hpp"
#include "scats.hpp"
#include "scenario.hpp"
#include "scoot.hpp"
#include "self_control.hpp"
#include "sites.hpp"
#include "surtrac.hpp"

#include <set>

using namespace elmopp;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

namespace {

const std::string all_choosers = "naive, cumulative, pressure, priced, rollout, itlc, oaf, fixed, webster, actuated, "
                                 "max-pressure, longest-queue, max-wave, "
                                 "max-wave-hold, elmopp-hold, itlc-rounds, scats, scoot, surtrac, self-control, random";
const std::string all_forecasts =
    "none, mean, persistence, ewma, ar8, lstm, nlstm, ann, gcn, lstm-q15, nlstm-q15, oracle, "
    "lstm-learn, nlstm-learn, lstm-literal";

std::unique_ptr<Plugged> made(const std::string &text, const std::string &profile = "paper") {
    static std::map<std::string, Scenario> scenarios; // they outlive what is made for them
    const Scenario &scenario =
        scenarios.try_emplace(profile, make_scenario(find_profile(profile), nullptr)).first->second;
    return make_chooser(parse_chooser(text), scenario.setting());
}

/// The state of a chooser that is known to be of this kind.
template <typename State> const State &state_of(const Plugged &plugged) {
    return dynamic_cast<const PluggedAs<State> &>(plugged).state;
}

template <typename State> State state_of(const std::string &text) {
    return state_of<State>(*made(text));
}

elmopp_urgency_options_t urgency(const std::string &text, const std::string &profile = "paper") {
    return state_of<elmopp_urgency_t>(*made(text, profile)).options;
}

std::string refusal(const std::string &text) {
    return message_of<BadRequest>([&] { (void)parse_chooser(text); }, text);
}

std::string late_refusal(const std::string &text) {
    return message_of<BadRequest>([&] { (void)made(text); }, text);
}

void test_names_options_and_forecast_are_taken_apart() {
    const ChooserSpec plain = parse_chooser("naive");
    TEST_ASSERT_EQUAL_STRING("naive", plain.name.c_str());
    TEST_ASSERT_EQUAL_STRING("none", plain.forecast.c_str());
    TEST_ASSERT_TRUE(plain.options.empty());
    const ChooserSpec full = parse_chooser("cumulative@min=5@frozen@hysteresis=1.25:ar8");
    TEST_ASSERT_EQUAL_STRING("cumulative", full.name.c_str());
    TEST_ASSERT_EQUAL_STRING("ar8", full.forecast.c_str());
    TEST_ASSERT_TRUE(
        (full.options == std::map<std::string, std::string>{{"frozen", ""}, {"hysteresis", "1.25"}, {"min", "5"}}));
    TEST_ASSERT_EQUAL_STRING("none", parse_chooser("naive:none").forecast.c_str());
}

void test_label_holds_the_options_in_one_order_and_no_forecast() {
    TEST_ASSERT_EQUAL_STRING("naive", parse_chooser("naive").label().c_str());
    TEST_ASSERT_EQUAL_STRING("cumulative@frozen@min=5", parse_chooser("cumulative@min=5@frozen:mean").label().c_str());
    TEST_ASSERT_TRUE(parse_chooser("cumulative@min=5@frozen") == parse_chooser("cumulative@frozen@min=5"));
    TEST_ASSERT_FALSE(parse_chooser("cumulative") == parse_chooser("cumulative:mean"));
    TEST_ASSERT_FALSE(parse_chooser("cumulative") == parse_chooser("cumulative@frozen"));
}

void test_unknown_names_are_refused_with_those_there_are() {
    expect_words(refusal("naiv"), {"unknown chooser \"naiv\"", all_choosers});
    expect_words(refusal(""), {"unknown chooser \"\"", all_choosers});
    expect_words(refusal("Naive"), {"\"Naive\""});
    expect_words(refusal("naive "), {"\"naive \""});
    expect_words(refusal("cumulative:lstn"), {"unknown forecast \"lstn\"", all_forecasts});
    expect_words(refusal("cumulative:"), {"unknown forecast \"\"", all_forecasts});
    expect_words(refusal("cumulative:mean:mean"), {"\"mean:mean\""});
    expect_words(refusal("naive@greed=1"), {"unknown option \"greed\"", "naive", "min", "max", "hysteresis", "frozen"});
    expect_words(refusal("naive@"), {"unknown option \"\""});
    expect_words(refusal("itlc@min=5"), {"unknown option \"min\"", "itlc", "ready=30"});
    expect_words(refusal("fixed@ready=5"), {"unknown option \"ready\"", "fixed", "green=20"});
}

void test_forecast_for_a_chooser_that_reads_none_is_refused() {
    for (const std::string name : {"naive", "pressure", "itlc", "oaf", "fixed"}) {
        expect_words(refusal(name + ":mean"), {name, "reads no forecast", "mean", "right would be " + name});
    }
}

void test_values_that_are_none_are_refused() {
    for (const std::string text :
         {"naive@min=0", "naive@min=-5", "naive@min=abc", "naive@min", "naive@min=nan", "naive@min=5s", "pressure@h=0",
          "itlc@ready=-1", "oaf@platoon=inf", "fixed@green=", "oaf@platoon=unlimited", "naive@max=unlimited"}) {
        const auto equals = text.find('=');
        const std::string value = equals == std::string::npos ? "" : text.substr(equals + 1);
        expect_words(refusal(text), {"\"" + value + "\"", "a number above 0"});
    }
    expect_words(refusal("naive@frozen=1"), {"frozen", "\"1\"", "no value"});
    expect_words(refusal("cumulative@printed-sign=yes"), {"printed-sign", "\"yes\"", "no value"});
}

void test_seconds_out_of_range_are_refused() {
    expect_words(late_refusal("naive@min=61"), {"min", "naive", "61", "1 to 60"});
    expect_words(late_refusal("naive@min=2.5"), {"min", "2.5", "whole number of seconds"});
    expect_words(late_refusal("naive@max=151"), {"max", "151", "10 to 150"});
    expect_words(late_refusal("naive@min=0.5"), {"0.5", "1 to 60"});
    expect_words(late_refusal("pressure@max=601"), {"max", "pressure", "601", "5 to 600"});
    expect_words(late_refusal("pressure@min=121"), {"min", "121", "1 to 120"});
    expect_words(late_refusal("fixed@green=601"), {"green", "fixed", "601", "1 to 600"});
    expect_words(late_refusal("fixed@green=0.5"), {"green", "0.5"});
    TEST_ASSERT_EQUAL_UINT(60, urgency("naive@min=60").min_s);
    TEST_ASSERT_EQUAL_UINT(150, urgency("naive@max=150").max_s);
    TEST_ASSERT_EQUAL_UINT(600, state_of<elmopp_pressure_t>("pressure@max=600").max_s);
}

// The value named must be the one that was given, not the site's minimum that it collides with.
void test_option_given_twice_is_refused() {
    expect_words(refusal("naive@min=5@min=6"), {"\"min\"", "twice", "naive@min=5@min=6", "once"});
}

// The specification's window of pressure is for the paper's junction.
void test_pressure_takes_the_window_of_a_site_file() {
    const Scenario street = make_scenario(find_profile("saturation"), &elmopp_site_four_way);
    const auto plain = make_chooser(parse_chooser("pressure"), street.setting());
    TEST_ASSERT_EQUAL_UINT(elmopp_site_four_way.hold_min_s, state_of<elmopp_pressure_t>(*plain).min_s);
    TEST_ASSERT_EQUAL_UINT(elmopp_site_four_way.hold_max_s, state_of<elmopp_pressure_t>(*plain).max_s);
    const auto given = make_chooser(parse_chooser("pressure@min=7@max=99"), street.setting());
    TEST_ASSERT_EQUAL_UINT(7, state_of<elmopp_pressure_t>(*given).min_s);
    TEST_ASSERT_EQUAL_UINT(99, state_of<elmopp_pressure_t>(*given).max_s);
}

void test_maximum_below_the_sites_minimum_names_the_maximum() {
    expect_words(late_refusal("naive@max=5"), {"max", "5", "10"});
}

void test_factors_out_of_range_are_refused() {
    expect_words(late_refusal("pressure@h=0.5"), {"h of chooser pressure", "0.5", "1 to 1000000"});
    expect_words(late_refusal("naive@hysteresis=0.99"), {"hysteresis", "0.99", "1 to"});
    expect_words(late_refusal("naive@hysteresis=1e7"), {"1 to 1000000"});
    TEST_ASSERT_EQUAL_FLOAT(1.0F, urgency("naive@hysteresis=1").hysteresis);
}

void test_defaults() {
    const auto naive = urgency("naive");
    TEST_ASSERT_EQUAL_UINT(10, naive.min_s);
    TEST_ASSERT_EQUAL_UINT(60, naive.max_s);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, naive.hysteresis);
    TEST_ASSERT_FALSE(naive.cumulative || naive.frozen || naive.constant_age || naive.printed_sign || naive.stage_age ||
                      naive.windowless);
    TEST_ASSERT_TRUE(urgency("cumulative").cumulative);
    const auto pressure = state_of<elmopp_pressure_t>("pressure");
    TEST_ASSERT_EQUAL_FLOAT(3.0F, pressure.ratio);
    TEST_ASSERT_EQUAL_UINT(5, pressure.min_s);
    TEST_ASSERT_EQUAL_UINT(120, pressure.max_s);
    TEST_ASSERT_EQUAL_DOUBLE(30.0, state_of<Itlc>("itlc").ready_veh);
    TEST_ASSERT_EQUAL_DOUBLE(10.0, state_of<Oaf>("oaf").platoon_veh);
    TEST_ASSERT_EQUAL_UINT(20, state_of<Fixed>("fixed").green_s);
}

void test_options_arrive() {
    const auto options = urgency("naive@min=7@max=33@hysteresis=1.5@frozen");
    TEST_ASSERT_EQUAL_UINT(7, options.min_s);
    TEST_ASSERT_EQUAL_UINT(33, options.max_s);
    TEST_ASSERT_EQUAL_FLOAT(1.5F, options.hysteresis);
    TEST_ASSERT_TRUE(options.frozen && !options.constant_age && !options.printed_sign && !options.stage_age &&
                     !options.windowless);
    TEST_ASSERT_TRUE(urgency("naive@constant-age").constant_age);
    TEST_ASSERT_TRUE(urgency("naive@printed-sign").printed_sign);
    TEST_ASSERT_TRUE(urgency("naive@stage-age").stage_age);
    TEST_ASSERT_TRUE(urgency("naive@windowless").windowless);
    const auto pressure = state_of<elmopp_pressure_t>("pressure@h=2@min=8@max=90");
    TEST_ASSERT_EQUAL_FLOAT(2.0F, pressure.ratio);
    TEST_ASSERT_EQUAL_UINT(8, pressure.min_s);
    TEST_ASSERT_EQUAL_UINT(90, pressure.max_s);
    TEST_ASSERT_EQUAL_DOUBLE(12.5, state_of<Itlc>("itlc@ready=12.5").ready_veh);
    TEST_ASSERT_EQUAL_DOUBLE(ready_unlimited, state_of<Itlc>("itlc@ready=unlimited").ready_veh);
    TEST_ASSERT_EQUAL_DOUBLE(40.0, state_of<Oaf>("oaf@platoon=40").platoon_veh);
    TEST_ASSERT_EQUAL_UINT(45, state_of<Fixed>("fixed@green=45").green_s);
}

void test_rivals_have_their_sources_defaults() {
    const auto actuated = state_of<Actuated>("actuated");
    TEST_ASSERT_EQUAL_UINT(5, actuated.min_s);
    TEST_ASSERT_EQUAL_UINT(60, actuated.max_s);
    TEST_ASSERT_EQUAL_UINT(3, actuated.gap_s);
    TEST_ASSERT_EQUAL_UINT(10, state_of<MaxPressure>("max-pressure").interval_s);
    TEST_ASSERT_EQUAL_UINT(20, state_of<MaxPressure>("max-pressure@interval=20").interval_s);
    TEST_ASSERT_EQUAL_DOUBLE(4.0, state_of<MaxWaveHold>("max-wave-hold").margin_veh);
    TEST_ASSERT_EQUAL_DOUBLE(2.0, state_of<ElmoppHold>("elmopp-hold").weight);
    TEST_ASSERT_EQUAL_DOUBLE(ready_unlimited, state_of<ItlcRounds>("itlc-rounds").ready_veh);
    TEST_ASSERT_EQUAL_UINT(120, state_of<Webster>("webster").longest_cycle_s);
    TEST_ASSERT_EQUAL_UINT(60, state_of<Scats>("scats@cycle-max=60").medium_cycle_s);
    TEST_ASSERT_EQUAL_DOUBLE(0.9, state_of<Scoot>("scoot").target);
    TEST_ASSERT_EQUAL_UINT(60, state_of<Surtrac>("surtrac").horizon_s);
    TEST_ASSERT_EQUAL_UINT(200, state_of<SelfControl>("self-control@period=200").longest_s);
    expect_words(late_refusal("self-control@period=100@longest=50"), {"longest", "50", "100 to"});
    expect_words(late_refusal("webster@cycle-max=20"), {"cycle-max", "20", "30 to 600"});
    expect_words(late_refusal("random@seed=1.5"), {"seed", "1.5", "whole number"});
}

void test_the_rollout_takes_its_options() {
    const auto options = state_of<elmopp_rollout_t>("rollout").options;
    TEST_ASSERT_EQUAL_UINT(5, options.future.min_s);
    TEST_ASSERT_EQUAL_UINT(60, options.future.max_s);
    TEST_ASSERT_EQUAL_UINT(120, options.coming.horizon_s);
    TEST_ASSERT_EQUAL_UINT(180, options.red_s);
    TEST_ASSERT_EQUAL_UINT(3, options.rule_count);
    TEST_ASSERT_EQUAL_UINT(4, options.others_max);
    TEST_ASSERT_EQUAL_FLOAT(0.5F, options.caution);
    TEST_ASSERT_TRUE(options.coming.weigh_skill);
    TEST_ASSERT_EQUAL_UINT(30, options.coming.rows_s);
    const auto given = state_of<elmopp_rollout_t>(
                           "rollout@min=7@max=33@horizon=150@weight=1@red=99@rows=150@others=2@caution=1@one-rule")
                           .options;
    TEST_ASSERT_EQUAL_UINT(2, given.others_max);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, given.caution);
    TEST_ASSERT_EQUAL_UINT(7, given.future.min_s);
    TEST_ASSERT_EQUAL_UINT(33, given.future.max_s);
    TEST_ASSERT_EQUAL_UINT(150, given.coming.horizon_s);
    TEST_ASSERT_FALSE(given.coming.weigh_skill);
    TEST_ASSERT_EQUAL_FLOAT(1.0F, given.coming.row_weight);
    TEST_ASSERT_EQUAL_UINT(150, given.coming.rows_s);
    TEST_ASSERT_TRUE(state_of<elmopp_rollout_t>("rollout@weight=by-skill").options.coming.weigh_skill);
    TEST_ASSERT_EQUAL_UINT(99, given.red_s);
    TEST_ASSERT_EQUAL_UINT(1, given.rule_count);
    TEST_ASSERT_EQUAL_UINT(0, state_of<elmopp_rollout_t>("rollout@red=unlimited").options.red_s);
    TEST_ASSERT_TRUE(options.sight.gives_way);
    TEST_ASSERT_FALSE(state_of<elmopp_rollout_t>("rollout@no-gaps").options.sight.gives_way);
    expect_words(refusal("rollout@no-gaps=1"), {"no-gaps", "no value"});
    TEST_ASSERT_EQUAL_UINT(25, state_of<elmopp_rollout_t>("rollout@patience=25").options.patience_s);
    TEST_ASSERT_EQUAL_FLOAT(60.0F, options.patience_veh_s);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, state_of<elmopp_rollout_t>("rollout@patience=unlimited").options.patience_veh_s);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, state_of<elmopp_rollout_t>("rollout@red=unlimited").options.patience_veh_s);
    const elmopp_rollout_options_t patient = state_of<elmopp_rollout_t>("rollout@red=unlimited@patience=30").options;
    TEST_ASSERT_EQUAL_UINT(30, patient.patience_s);
    TEST_ASSERT_EQUAL_FLOAT(60.0F, patient.patience_veh_s);
    expect_words(refusal("rollout@patience=long"), {"patience", "long", "a number above 0", "or unlimited"});
    expect_words(late_refusal("rollout@horizon=151"), {"horizon", "rollout", "151", "1 to 150"});
    expect_words(late_refusal("rollout@weight=1.5"), {"weight", "rollout", "1.5", "at most 1"});
    expect_words(late_refusal("rollout@caution=1.5"), {"caution", "rollout", "1.5", "at most 1"});
    expect_words(late_refusal("rollout@others=33"), {"others", "rollout", "33", "1 to 32"});
    expect_words(refusal("rollout@one-rule=2"), {"one-rule", "no value"});
    expect_words(refusal("rollout@weight=skill"), {"weight", "skill", "a number above 0"});
    expect_words(refusal("elmopp-hold@weight=by-skill"), {"weight", "by-skill", "a number above 0"});
    expect_words(refusal("rollout@horizon=unlimited"), {"unlimited", "a number above 0"});
}

// What a simulator of single vehicles says, and host_sim does not.
void test_the_setting_arrives() {
    const std::vector<float> behind_veh(elmopp_site_four_way.movement_count);
    const Setting setting{elmopp_site_four_way, true, false, everywhere(8), 77, behind_veh.data()};
    const auto make = [&setting](const std::string &text) { return make_chooser(parse_chooser(text), setting); };
    TEST_ASSERT_EQUAL_UINT(8, state_of<Actuated>(*make("actuated")).approaching.travel_s(0));
    TEST_ASSERT_EQUAL_UINT(8, state_of<Surtrac>(*make("surtrac")).approaching.travel_s(0));
    TEST_ASSERT_EQUAL_UINT(8, state_of<SelfControl>(*make("self-control")).approaching.travel_s(0));
    TEST_ASSERT_EQUAL_UINT(8, state_of<LongestQueue>(*make("longest-queue")).approaching.travel_s(0));
    TEST_ASSERT_EQUAL_UINT(8, state_of<ItlcRounds>(*make("itlc-rounds")).approaching.travel_s(0));
    TEST_ASSERT_EQUAL_UINT(8, state_of<elmopp_rollout_t>(*make("rollout")).options.sight.travel_s[0]);
    TEST_ASSERT_EQUAL_UINT(112, make("rollout@rows=150")->chooser.horizon_s);
    TEST_ASSERT_EQUAL_UINT(elmopp_site_four_way.hold_max_s,
                           state_of<elmopp_rollout_t>(*make("rollout")).options.future.max_s);
    TEST_ASSERT_EQUAL_PTR(behind_veh.data(), state_of<MaxPressure>(*make("max-pressure")).downstream_veh);
    TEST_ASSERT_TRUE(state_of<Random>(*make("random")).generator == std::mt19937_64(77));
    TEST_ASSERT_TRUE(state_of<Random>(*make("random@seed=5")).generator == std::mt19937_64(5));
    TEST_ASSERT_EQUAL_UINT(elmopp_site_four_way.hold_min_s, state_of<MaxWave>(*make("max-wave")).min_s);
    TEST_ASSERT_EQUAL_UINT(elmopp_site_four_way.hold_max_s, state_of<Actuated>(*make("actuated")).max_s);
}

void test_windows_come_from_the_profile() {
    TEST_ASSERT_EQUAL_UINT(5, urgency("naive", "figure").min_s);
    TEST_ASSERT_EQUAL_UINT(20, urgency("naive", "figure").max_s);
    TEST_ASSERT_EQUAL_UINT(8, urgency("naive@min=8", "figure").min_s);
}

void test_literal_profile_is_algorithm_1_as_printed() {
    const auto naive = urgency("naive", "literal"); // eq. 2
    TEST_ASSERT_EQUAL_UINT(1, naive.min_s);
    TEST_ASSERT_EQUAL_UINT(60, naive.max_s);
    TEST_ASSERT_TRUE(naive.windowless);
    TEST_ASSERT_FALSE(naive.cumulative || naive.printed_sign || naive.stage_age || naive.constant_age || naive.frozen);
    const auto cumulative = urgency("cumulative", "literal"); // Algorithm 1
    TEST_ASSERT_EQUAL_UINT(1, cumulative.min_s);
    TEST_ASSERT_TRUE(cumulative.windowless && cumulative.cumulative && cumulative.printed_sign &&
                     cumulative.stage_age && cumulative.constant_age);
    TEST_ASSERT_FALSE(cumulative.frozen);
}

std::vector<std::string> texts(const std::vector<ChooserSpec> &specs) {
    std::vector<std::string> found;
    for (const auto &spec : specs) {
        found.push_back(spec.label() + ":" + spec.forecast);
    }
    return found;
}

void test_lists() {
    TEST_ASSERT_TRUE((texts(parse_choosers("itlc,cumulative:ar8,naive,itlc")) ==
                      std::vector<std::string>{"itlc:none", "cumulative:ar8", "naive:none"}));
    expect_words(message_of<BadRequest>([] { (void)parse_choosers("naive,,itlc"); }), {"unknown chooser \"\""});
    expect_words(message_of<BadRequest>([] { (void)parse_choosers("naive,frob"); }), {"\"frob\""});
}

void test_all_is_every_chooser_with_every_forecast_that_it_reads() {
    const auto found = texts(parse_choosers("all"));
    const std::set<std::string> unique(found.begin(), found.end());
    const std::set<std::string> expected{"naive:none",
                                         "cumulative:none",
                                         "cumulative:mean",
                                         "cumulative:ewma",
                                         "cumulative:persistence",
                                         "cumulative:ar8",
                                         "cumulative:lstm",
                                         "cumulative:nlstm",
                                         "cumulative:oracle",
                                         "pressure:none",
                                         "itlc:none",
                                         "oaf:none",
                                         "fixed:none",
                                         "webster:none",
                                         "actuated:none",
                                         "max-pressure:none",
                                         "longest-queue:none",
                                         "max-wave:none",
                                         "max-wave-hold:none",
                                         "elmopp-hold:none",
                                         "itlc-rounds:none",
                                         "scats:none",
                                         "scoot:none",
                                         "surtrac:none",
                                         "self-control:none",
                                         "random:none",
                                         "priced:none",
                                         "rollout:none",
                                         "rollout:mean",
                                         "rollout:ewma",
                                         "rollout:persistence",
                                         "rollout:ar8",
                                         "rollout:lstm",
                                         "rollout:nlstm",
                                         "rollout:oracle",
                                         "cumulative:ann",
                                         "cumulative:gcn",
                                         "rollout:ann",
                                         "rollout:gcn",
                                         "cumulative:lstm-q15",
                                         "rollout:lstm-q15",
                                         "cumulative:nlstm-q15",
                                         "rollout:nlstm-q15",
                                         "cumulative:lstm-learn",
                                         "cumulative:nlstm-learn",
                                         "cumulative:lstm-literal",
                                         "rollout:lstm-learn",
                                         "rollout:nlstm-learn",
                                         "rollout:lstm-literal"};
    TEST_ASSERT_TRUE(unique == expected);
    TEST_ASSERT_EQUAL_UINT(expected.size(), found.size());
    TEST_ASSERT_EQUAL_UINT(expected.size() + 1, parse_choosers("naive,all,naive@frozen").size());
}

void test_papers_table() {
    TEST_ASSERT_TRUE(
        (texts(paper_table()) == std::vector<std::string>{"naive:none", "cumulative:none", "cumulative:mean",
                                                          "cumulative:persistence", "cumulative:ar8", "cumulative:lstm",
                                                          "cumulative:nlstm", "cumulative:oracle", "pressure:none",
                                                          "itlc:none", "oaf:none", "fixed:none"}));
}

void test_site_names_its_chooser() {
    elmopp_junction_t junction = elmopp_site_four_way;
    const std::vector<std::pair<int, std::string>> choosers{{ELMOPP_CHOOSER_NAIVE, "naive:none"},
                                                            {ELMOPP_CHOOSER_CUMULATIVE, "cumulative:ewma"},
                                                            {ELMOPP_CHOOSER_PRESSURE, "pressure:none"},
                                                            {ELMOPP_CHOOSER_PRICED, "priced:none"},
                                                            {ELMOPP_CHOOSER_ROLLOUT, "rollout:ewma"}};
    junction.forecast = ELMOPP_FORECAST_EWMA;
    for (const auto &[code, text] : choosers) {
        junction.chooser = static_cast<std::uint8_t>(code);
        TEST_ASSERT_EQUAL_STRING(text.c_str(), texts({site_chooser(junction)})[0].c_str());
    }
}

void test_forecasts_have_the_codes_of_the_core() {
    const std::vector<std::pair<std::string, int>> codes{{"none", ELMOPP_FORECAST_NONE},
                                                         {"mean", ELMOPP_FORECAST_MEAN},
                                                         {"persistence", ELMOPP_FORECAST_PERSISTENCE},
                                                         {"ewma", ELMOPP_FORECAST_EWMA},
                                                         {"ar8", ELMOPP_FORECAST_AR8},
                                                         {"lstm", ELMOPP_FORECAST_LSTM},
                                                         {"nlstm", ELMOPP_FORECAST_NLSTM},
                                                         {"ann", ELMOPP_FORECAST_ANN},
                                                         {"gcn", ELMOPP_FORECAST_GCN},
                                                         {"lstm-q15", ELMOPP_FORECAST_LSTM_Q15},
                                                         {"nlstm-q15", ELMOPP_FORECAST_NLSTM_Q15},
                                                         {"oracle", ELMOPP_FORECAST_NONE},
                                                         {"lstm-learn", ELMOPP_FORECAST_LSTM},
                                                         {"nlstm-learn", ELMOPP_FORECAST_NLSTM},
                                                         {"lstm-literal", ELMOPP_FORECAST_LSTM}};
    for (const auto &[name, code] : codes) {
        TEST_ASSERT_EQUAL_UINT_MESSAGE(code, forecast_kind(name), name.c_str());
    }
}

void test_kinds_say_what_there_is() {
    std::string names;
    for (const auto &kind : chooser_kinds()) {
        names += (names.empty() ? "" : ", ") + kind.name;
        TEST_ASSERT_FALSE(kind.what.empty());
        const bool forecasts = kind.name == "cumulative" || kind.name == "rollout";
        TEST_ASSERT_EQUAL(forecasts, kind.forecasts);
        TEST_ASSERT_EQUAL(!forecasts && kind.name != "naive" && kind.name != "pressure" && kind.name != "priced",
                          kind.rival);
    }
    TEST_ASSERT_EQUAL_STRING(all_choosers.c_str(), names.c_str());
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_names_options_and_forecast_are_taken_apart);
    RUN_TEST(test_label_holds_the_options_in_one_order_and_no_forecast);
    RUN_TEST(test_unknown_names_are_refused_with_those_there_are);
    RUN_TEST(test_forecast_for_a_chooser_that_reads_none_is_refused);
    RUN_TEST(test_values_that_are_none_are_refused);
    RUN_TEST(test_seconds_out_of_range_are_refused);
    RUN_TEST(test_option_given_twice_is_refused);
    RUN_TEST(test_pressure_takes_the_window_of_a_site_file);
    RUN_TEST(test_maximum_below_the_sites_minimum_names_the_maximum);
    RUN_TEST(test_factors_out_of_range_are_refused);
    RUN_TEST(test_defaults);
    RUN_TEST(test_options_arrive);
    RUN_TEST(test_rivals_have_their_sources_defaults);
    RUN_TEST(test_the_rollout_takes_its_options);
    RUN_TEST(test_the_setting_arrives);
    RUN_TEST(test_windows_come_from_the_profile);
    RUN_TEST(test_literal_profile_is_algorithm_1_as_printed);
    RUN_TEST(test_lists);
    RUN_TEST(test_all_is_every_chooser_with_every_forecast_that_it_reads);
    RUN_TEST(test_papers_table);
    RUN_TEST(test_site_names_its_chooser);
    RUN_TEST(test_forecasts_have_the_codes_of_the_core);
    RUN_TEST(test_kinds_say_what_there_is);
    return UNITY_END();
}
