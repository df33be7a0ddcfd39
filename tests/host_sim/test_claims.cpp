// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The judge of the paper's claims, fed with made-up results (tests/golden/make_claims.py) and with single changes of
/// them, so that each verdict is seen on both sides of its line. With the files that results are written to.

#include <nlohmann/json.hpp> // before Unity, which makes a macro of isnan

#include "claims.hpp"
#include "csv.hpp"
#include "error.hpp"
#include "expect.hpp"
#include "stats.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <sstream>

using namespace elmopp;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

namespace {

const std::vector<std::string> ids{"ranking_throughput", "curve_falls",   "elmopp_gt_itlc",   "elmopp_gt_oaf",
                                   "itlc_gt_oaf",        "t_elmopp_itlc", "t_elmopp_oaf",     "t_itlc_oaf",
                                   "prediction_helps",   "horizon_417",   "hyperchaos_euler", "literal_works",
                                   "three_levels",       "count_accuracy"};

/// Results and facts, ready to be changed.
struct Evidence {
    std::vector<Row> trials;
    std::vector<Row> beside;
    Facts facts;
};

Evidence holding() {
    return {read_trials("tests/golden/claims_hold_trials.csv"),
            read_trials("tests/golden/claims_hold_beside.csv"),
            {{0.2398, 0.2, 0.0, -7.5}, {0.2, 0.1, 0.0, -7.4}, 0.005, LongMemory{{4.0, 5.0, 4.5}, {3.5, 4.4, 4.05}}}};
}

Evidence failing() {
    return {
        read_trials("tests/golden/claims_fail_trials.csv"),
        read_trials("tests/golden/claims_fail_beside.csv"),
        {{0.35, 0.2, 0.0, -7.5}, {0.002, -0.003, -0.005, -7.1}, 0.02, LongMemory{{4.0, 5.0, 4.5}, {3.9, 5.1, 4.4}}}};
}

std::map<std::string, Claim> judged(const Evidence &evidence) {
    std::map<std::string, Claim> found;
    for (const auto &claim : judge(evidence.trials, evidence.beside, evidence.facts)) {
        found[claim.id] = claim;
    }
    return found;
}

std::string verdict_of(const Evidence &evidence, const std::string &id) {
    return to_string(judged(evidence).at(id).verdict);
}

void expect_verdict(const std::string &expected, const Evidence &evidence, const std::string &id) {
    TEST_ASSERT_EQUAL_STRING_MESSAGE(expected.c_str(), verdict_of(evidence, id).c_str(), id.c_str());
}

/// Applies a change to the rows of one chooser in both files.
void change(Evidence &evidence, const std::string &profile, const std::string &chooser, const std::string &forecast,
            const std::function<void(Row &)> &work) {
    for (auto *rows : {&evidence.trials, &evidence.beside}) {
        for (auto &row : *rows) {
            if (row.profile == profile && row.chooser == chooser && row.forecast == forecast) {
                work(row);
            }
        }
    }
}

void add_throughput(Evidence &evidence, const std::string &chooser, const std::string &forecast, double more) {
    change(evidence, "paper", chooser, forecast, [&](Row &row) { row.metrics.throughput_veh_per_s += more; });
}

/// Takes out the rows that fit.
void drop(Evidence &evidence, const std::function<bool(const Row &)> &fits) {
    for (auto *rows : {&evidence.trials, &evidence.beside}) {
        rows->erase(std::remove_if(rows->begin(), rows->end(), fits), rows->end());
    }
}

/// What remains: exactly these claims are not run.
void expect_not_run(const Evidence &evidence, const std::vector<std::string> &expected) {
    const auto claims = judged(evidence);
    for (const auto &id : ids) {
        const bool missing = std::find(expected.begin(), expected.end(), id) != expected.end();
        TEST_ASSERT_EQUAL_MESSAGE(missing, claims.at(id).verdict == Verdict::not_run, id.c_str());
    }
}

void test_order_of_the_claims() {
    const Evidence evidence = holding();
    std::vector<std::string> found;
    for (const auto &claim : judge(evidence.trials, evidence.beside, evidence.facts)) {
        found.push_back(claim.id);
        TEST_ASSERT_FALSE(claim.claim.empty() || claim.printed.empty() || claim.measured.empty());
    }
    TEST_ASSERT_TRUE(found == ids);
}

void test_every_claim_that_can_hold_holds() {
    const Evidence evidence = holding();
    for (const auto &id : ids) {
        expect_verdict("reproduced", evidence, id);
    }
}

void test_every_claim_can_fail() {
    const Evidence evidence = failing();
    for (const auto &id : ids) {
        expect_verdict("not_reproduced", evidence, id);
    }
}

void test_measured_values_are_told() {
    const auto claims = judged(holding());
    expect_words(claims.at("ranking_throughput").measured,
                 {"cumulative:ar8 2.09133", "itlc@ready=60 1.83414", "oaf@platoon=20 1.12108"});
    expect_words(claims.at("curve_falls").measured, {"2.17133 2.13133 2.09133 2.05133 2.01133", "200 to 1000"});
    expect_words(claims.at("t_elmopp_itlc").measured, {"t = 17.68,", "itlc@ready=60", "n = 30"});
    expect_words(claims.at("t_elmopp_oaf").measured, {"t = 69.473,", "oaf@platoon=20"});
    expect_words(claims.at("t_itlc_oaf").measured, {"t = 85.028,"});
    TEST_ASSERT_EQUAL_STRING("17.6799", claims.at("t_elmopp_itlc").printed.c_str());
    TEST_ASSERT_EQUAL_STRING("69.4727", claims.at("t_elmopp_oaf").printed.c_str());
    TEST_ASSERT_EQUAL_STRING("85.0275", claims.at("t_itlc_oaf").printed.c_str());
    expect_words(claims.at("prediction_helps").measured,
                 {"to naive and to cumulative", "cumulative:ar8 [-10.2, -9.12], [-9.16, -8.34]"});
    expect_words(claims.at("horizon_417").measured, {"417 steps", "0.24"});
    expect_words(claims.at("hyperchaos_euler").measured, {"0.2 0.1 0 -7.4"});
    expect_words(claims.at("literal_works").measured, {"eq. 2: 91 %", "Algorithm 1: 91 %"});
    expect_words(claims.at("three_levels").measured, {"3 seeds", "one level 4.5", "three 3.983", "[-0.706, -0.327]"});
    expect_words(claims.at("count_accuracy").measured, {"99.5 %"});
}

void test_every_forecast_stands_beside_elmopps_own() {
    Evidence evidence = holding();
    std::vector<Row> more;
    for (const auto &row : evidence.trials) {
        if (row.profile == "paper" && row.chooser == "cumulative" && row.forecast == "ar8") {
            more.push_back(row);
            more.back().forecast = "lstm";
            more.back().metrics.mean_delay_s -= 1.0;
        }
    }
    evidence.trials.insert(evidence.trials.end(), more.begin(), more.end());
    const std::string measured = judged(evidence).at("prediction_helps").measured;
    expect_words(measured, {"cumulative:lstm [-11.2, -10.1], [-10.2, -9.34]; cumulative:ar8 [-10.2, -9.12]"});
}

// One seed in which three levels are worse, or an interval that reaches 0, is a doubt.
void test_three_levels_must_be_better_in_every_seed_and_beyond_doubt() {
    Evidence evidence = holding();
    evidence.facts.long_memory = LongMemory{{4.0, 4.0, 4.0}, {3.0, 3.01, 4.001}};
    expect_verdict("not_reproduced", evidence, "three_levels");
    evidence.facts.long_memory = LongMemory{{4.0, 4.0, 4.0}, {3.9, 3.99, 3.999}};
    expect_verdict("not_reproduced", evidence, "three_levels");
    evidence.facts.long_memory = LongMemory{{4.0, 4.0, 4.0}, {3.9, 3.91, 3.9}};
    expect_verdict("reproduced", evidence, "three_levels");
}

void test_long_memory_is_read_from_the_training() {
    const TextFile good(R"({"rmse": {"lstm1": {"60": [1.0, 2.0]}, "lstm3": {"60": [3.0, 4.0]}}})");
    const LongMemory memory = read_long_memory(good.path());
    TEST_ASSERT_TRUE((memory.rmse_1 == std::vector<double>{1.0, 2.0}));
    TEST_ASSERT_TRUE((memory.rmse_3 == std::vector<double>{3.0, 4.0}));
    for (const char *const bad : {"", "{}", R"({"rmse": {"lstm1": {"60": [1.0]}, "lstm3": {"60": [3.0]}}})",
                                  R"({"rmse": {"lstm1": {"60": [1.0, 2.0]}, "lstm3": {"60": [3.0]}}})",
                                  R"({"rmse": {"lstm1": {"60": [1.0, "two"]}, "lstm3": {"60": [3.0, 4.0]}}})"}) {
        const TextFile file(bad);
        expect_words(message_of<BadRequest>([&] { (void)read_long_memory(file.path()); }),
                     {file.path().string(), "rmse.lstm1.60", "tools/train"});
    }
}

void test_missing_rows_are_not_run() {
    const std::vector<std::string> rivals{"ranking_throughput", "elmopp_gt_itlc", "elmopp_gt_oaf", "itlc_gt_oaf",
                                          "t_elmopp_itlc",      "t_elmopp_oaf",   "t_itlc_oaf"};
    Evidence nothing = holding();
    drop(nothing, [](const Row &) { return true; });
    nothing.facts.count_error.reset();
    nothing.facts.long_memory.reset();
    auto all = rivals;
    all.insert(all.end(), {"curve_falls", "prediction_helps", "literal_works", "three_levels", "count_accuracy"});
    expect_not_run(nothing, all);

    Evidence without = holding();
    drop(without, [](const Row &row) { return row.forecast == "ar8"; });
    expect_not_run(without, {"ranking_throughput", "curve_falls", "elmopp_gt_itlc", "elmopp_gt_oaf", "t_elmopp_itlc",
                             "t_elmopp_oaf", "prediction_helps"});
    without = holding();
    drop(without, [](const Row &row) { return row.chooser.rfind("itlc", 0) == 0; });
    expect_not_run(without, {"ranking_throughput", "elmopp_gt_itlc", "itlc_gt_oaf", "t_elmopp_itlc", "t_itlc_oaf"});
    without = holding();
    drop(without, [](const Row &row) { return row.chooser.rfind("oaf", 0) == 0; });
    expect_not_run(without, {"ranking_throughput", "elmopp_gt_oaf", "itlc_gt_oaf", "t_elmopp_oaf", "t_itlc_oaf"});
    without = holding();
    drop(without, [](const Row &row) { return row.profile == "paper" && row.chooser == "naive"; });
    expect_not_run(without, {"prediction_helps", "literal_works"});
    without = holding();
    drop(without, [](const Row &row) {
        return row.profile == "paper" && row.chooser == "cumulative" && row.forecast == "none";
    });
    expect_not_run(without, {"prediction_helps"});
    for (const std::string chooser : {"naive", "cumulative"}) {
        without = holding();
        drop(without, [&](const Row &row) { return row.profile == "literal" && row.chooser == chooser; });
        expect_not_run(without, {"literal_works"});
    }
    without = holding();
    drop(without, [](const Row &row) { return row.profile == "paper"; });
    auto paper = rivals;
    paper.insert(paper.end(), {"curve_falls", "prediction_helps", "literal_works"});
    expect_not_run(without, paper);
    without = holding();
    without.facts.count_error.reset();
    expect_not_run(without, {"count_accuracy"});
}

/// All that needs the five numbers of vehicles.
const std::vector<std::string> of_the_grid{"ranking_throughput", "curve_falls",   "elmopp_gt_itlc", "elmopp_gt_oaf",
                                           "itlc_gt_oaf",        "t_elmopp_itlc", "t_elmopp_oaf",   "t_itlc_oaf",
                                           "prediction_helps",   "literal_works"};

void test_another_grid_than_the_printed_one_is_not_judged() {
    for (const unsigned vehicles : {200U, 600U, 1000U}) {
        Evidence lacking = holding();
        drop(lacking, [=](const Row &row) { return row.vehicles == vehicles; });
        expect_not_run(lacking, of_the_grid);
    }
    Evidence other = holding();
    for (auto *rows : {&other.trials, &other.beside}) {
        for (auto &row : *rows) {
            row.vehicles = row.vehicles == 600 ? 500 : row.vehicles;
        }
    }
    expect_not_run(other, of_the_grid);
    Evidence more = holding();
    for (Row row : holding().trials) {
        row.vehicles = 1200;
        more.trials.push_back(row);
    }
    drop(more, [](const Row &row) { return row.profile == "literal"; });
    expect_not_run(more, of_the_grid);
}

void test_a_grid_with_a_hole_is_not_judged() {
    Evidence evidence = holding();
    drop(evidence,
         [](const Row &row) { return row.profile == "paper" && row.forecast == "ar8" && row.vehicles == 400; });
    expect_not_run(evidence, {"ranking_throughput", "curve_falls", "elmopp_gt_itlc", "elmopp_gt_oaf", "t_elmopp_itlc",
                              "t_elmopp_oaf", "prediction_helps"});
}

// Five values of one trial are no pairs.
void test_a_single_trial_is_no_pair() {
    Evidence evidence = holding();
    drop(evidence, [](const Row &row) { return row.trial != 0; });
    expect_not_run(evidence, {"prediction_helps"});
}

void test_ranking_needs_both_steps() {
    Evidence evidence = holding();
    add_throughput(evidence, "cumulative", "ar8", -0.26); // below ITLC by a hair
    expect_verdict("not_reproduced", evidence, "ranking_throughput");
    evidence = holding();
    add_throughput(evidence, "oaf@platoon=20", "none", 0.72); // above ITLC
    expect_verdict("not_reproduced", evidence, "ranking_throughput");
    evidence = holding();
    add_throughput(evidence, "cumulative", "ar8", -0.25);
    add_throughput(evidence, "oaf@platoon=20", "none", 0.71);
    expect_verdict("reproduced", evidence, "ranking_throughput");
}

void test_curve_falls_at_every_step() {
    for (const unsigned vehicles : {400U, 600U, 800U, 1000U}) {
        Evidence evidence = holding();
        change(evidence, "paper", "cumulative", "ar8",
               [&](Row &row) { row.metrics.throughput_veh_per_s += row.vehicles == vehicles ? 0.041 : 0.0; });
        expect_verdict("not_reproduced", evidence, "curve_falls");
    }
    Evidence evidence = holding();
    change(evidence, "paper", "cumulative", "ar8",
           [&](Row &row) { row.metrics.throughput_veh_per_s += row.vehicles == 1000 ? 0.039 : 0.0; });
    expect_verdict("reproduced", evidence, "curve_falls");
}

/// Shifts one player so that Welch's t against the other comes near to `wanted`, as far as a shift can.
void set_t(Evidence &evidence, const std::string &chooser, const std::string &forecast, double mean, double standard,
           double wanted) {
    const Metric &throughput = find_metric("throughput_veh_per_s");
    std::vector<Row> rows = evidence.trials;
    rows.insert(rows.end(), evidence.beside.begin(), evidence.beside.end());
    const double now = summarize(pick(rows, {"paper", chooser, forecast, 0}, throughput)).mean;
    add_throughput(evidence, chooser, forecast, mean + wanted * standard - now);
}

struct Pair {
    std::string id, t_id;
    double printed, mean_b, standard;
    std::string chooser, forecast;
};

const std::vector<Pair> pairs{
    {"elmopp_gt_itlc", "t_elmopp_itlc", 17.6799, 1.83414, (2.09133 - 1.83414) / 17.6799, "cumulative", "ar8"},
    {"elmopp_gt_oaf", "t_elmopp_oaf", 69.4727, 1.12108, (2.09133 - 1.12108) / 69.4727, "cumulative", "ar8"},
    {"itlc_gt_oaf", "t_itlc_oaf", 85.0275, 1.12108, (1.83414 - 1.12108) / 85.0275, "itlc@ready=60", "none"}};

void test_t_values_hold_within_a_tenth() {
    for (const auto &pair : pairs) {
        for (const auto &[factor, expected] : std::vector<std::pair<double, std::string>>{
                 {0.89, "not_reproduced"}, {0.91, "reproduced"}, {1.09, "reproduced"}, {1.11, "not_reproduced"}}) {
            Evidence evidence = holding();
            set_t(evidence, pair.chooser, pair.forecast, pair.mean_b, pair.standard, factor * pair.printed);
            expect_verdict(expected, evidence, pair.t_id);
        }
    }
}

// One-sided at 0.05: with some 30 degrees of freedom and more, t must exceed 1.65 to 1.70.
void test_significance_is_one_sided_at_five_percent() {
    for (const auto &pair : pairs) {
        for (const auto &[t, expected] : std::vector<std::pair<double, std::string>>{
                 {-10.0, "not_reproduced"}, {0.0, "not_reproduced"}, {1.6, "not_reproduced"}, {1.75, "reproduced"}}) {
            Evidence evidence = holding();
            // ITLC must stay the best of its sweep: its plain row is out of the way.
            add_throughput(evidence, "itlc", "none", -5.0);
            set_t(evidence, pair.chooser, pair.forecast, pair.mean_b, pair.standard, t);
            expect_verdict(expected, evidence, pair.id);
        }
    }
}

void test_prediction_must_help_against_both() {
    Evidence evidence = holding();
    change(evidence, "paper", "naive", "none", [](Row &row) { row.metrics.mean_delay_s -= 9.7; });
    expect_verdict("not_reproduced", evidence, "prediction_helps");
    evidence = holding();
    change(evidence, "paper", "cumulative", "none", [](Row &row) { row.metrics.mean_delay_s -= 8.7; });
    expect_verdict("not_reproduced", evidence, "prediction_helps");
    evidence = holding();
    change(evidence, "paper", "naive", "none", [](Row &row) { row.metrics.mean_delay_s -= 9.0; });
    change(evidence, "paper", "cumulative", "none", [](Row &row) { row.metrics.mean_delay_s -= 8.2; });
    expect_verdict("reproduced", evidence, "prediction_helps");
}

// A mean that is lower is not enough: the 95 % interval must not reach 0.
void test_prediction_must_help_beyond_doubt() {
    Evidence evidence = holding();
    change(evidence, "paper", "cumulative", "ar8", [](Row &row) {
        row.metrics.mean_delay_s =
            100.0 + 0.5 * static_cast<double>(row.trial) + row.vehicles / 100.0 + (row.trial % 2 == 0 ? 20.0 : -21.0);
    });
    expect_verdict("not_reproduced", evidence, "prediction_helps");
}

void test_unpaired_delays_are_not_compared() {
    Evidence evidence = holding();
    drop(evidence, [](const Row &row) { return row.profile == "paper" && row.chooser == "naive" && row.trial == 0; });
    expect_not_run(evidence, {"prediction_helps"});
}

void test_horizon_needs_the_printed_time() {
    for (const auto &[steps, expected] : std::vector<std::pair<double, std::string>>{
             {350.0, "not_reproduced"}, {358.0, "reproduced"}, {476.0, "reproduced"}, {484.0, "not_reproduced"}}) {
        Evidence evidence = holding();
        evidence.facts.exponents_rk4[0] = 100.0 / steps;
        expect_verdict(expected, evidence, "horizon_417");
    }
}

void test_hyperchaos_needs_a_second_exponent_above_the_noise() {
    for (const auto &[second, expected] : std::vector<std::pair<double, std::string>>{
             {-0.003, "not_reproduced"}, {0.049, "not_reproduced"}, {0.051, "reproduced"}}) {
        Evidence evidence = holding();
        evidence.facts.exponents_euler[1] = second;
        expect_verdict(expected, evidence, "hyperchaos_euler");
    }
}

void test_literal_needs_nine_tenths_of_both() {
    for (const std::string chooser : {"naive", "cumulative"}) {
        Evidence evidence = holding();
        change(evidence, "literal", chooser, "none", [](Row &row) { row.metrics.throughput_veh_per_s = 0.895 * 1.9; });
        expect_verdict("not_reproduced", evidence, "literal_works");
        change(evidence, "literal", chooser, "none", [](Row &row) { row.metrics.throughput_veh_per_s = 0.905 * 1.9; });
        expect_verdict("reproduced", evidence, "literal_works");
    }
}

void test_counting_needs_less_than_one_percent() {
    for (const auto &[error, expected] : std::vector<std::pair<double, std::string>>{
             {0.0, "reproduced"}, {0.0099, "reproduced"}, {0.01, "not_reproduced"}, {0.5, "not_reproduced"}}) {
        Evidence evidence = holding();
        evidence.facts.count_error = error;
        expect_verdict(expected, evidence, "count_accuracy");
    }
}

void test_lstm_is_preferred_to_ar8() {
    Evidence evidence = holding();
    for (Row row : holding().trials) {
        if (row.profile == "paper" && row.forecast == "ar8") {
            row.forecast = "lstm";
            row.metrics.throughput_veh_per_s = 0.1;
            evidence.trials.push_back(row);
        }
    }
    expect_words(judged(evidence).at("ranking_throughput").measured, {"cumulative:lstm 0.1"});
    expect_verdict("not_reproduced", evidence, "elmopp_gt_oaf");
}

Row row_of(const std::string &chooser, double throughput, double delay) {
    Row row{"paper", chooser, "none", 800, 0, 1, {}};
    row.metrics.throughput_veh_per_s = throughput;
    row.metrics.mean_delay_s = delay;
    return row;
}

void test_best_label_of_a_sweep() {
    const Metric &throughput = find_metric("throughput_veh_per_s");
    const Metric &delay = find_metric("mean_delay_s");
    const std::vector<Row> rows{row_of("itlc", 1.0, 10.0), row_of("itlc@ready=5", 0.5, 5.0),
                                row_of("itlc@ready=60", 2.0, 20.0), row_of("itlc-rounds", 9.0, 1.0)};
    TEST_ASSERT_EQUAL_STRING("itlc@ready=60", best_label(rows, "paper", "itlc", throughput, true).c_str());
    TEST_ASSERT_EQUAL_STRING("itlc@ready=5", best_label(rows, "paper", "itlc", throughput, false).c_str());
    TEST_ASSERT_EQUAL_STRING("itlc@ready=5", best_label(rows, "paper", "itlc", delay, false).c_str());
    TEST_ASSERT_EQUAL_STRING("", best_label(rows, "saturation", "itlc", delay, false).c_str());
    TEST_ASSERT_EQUAL_STRING("", best_label(rows, "paper", "oaf", delay, false).c_str());
    auto more = rows;
    more.push_back(row_of("itlc", 1.0, 10.0)); // two trials of the plain one, one of the others
    TEST_ASSERT_EQUAL_STRING("itlc", best_label(more, "paper", "itlc", throughput, true).c_str());
}

void test_claims_are_written_as_a_list_of_objects() {
    const Evidence evidence = failing();
    const auto claims = judge(evidence.trials, evidence.beside, evidence.facts);
    const TextFile file("");
    write_claims(file.path(), claims);
    std::ifstream stream(file.path());
    const auto list = nlohmann::ordered_json::parse(stream);
    TEST_ASSERT_EQUAL_UINT(ids.size(), list.size());
    for (std::size_t i = 0; i < ids.size(); ++i) {
        std::string keys;
        for (const auto &[key, value] : list[i].items()) {
            keys += key + " ";
        }
        TEST_ASSERT_EQUAL_STRING("id claim printed measured verdict ", keys.c_str());
        TEST_ASSERT_EQUAL_STRING(ids[i].c_str(), list[i]["id"].get<std::string>().c_str());
        TEST_ASSERT_EQUAL_STRING(to_string(claims[i].verdict).c_str(), list[i]["verdict"].get<std::string>().c_str());
        TEST_ASSERT_EQUAL_STRING(claims[i].measured.c_str(), list[i]["measured"].get<std::string>().c_str());
    }
}

void test_count_error_is_read_from_the_scores() {
    const TextFile good(R"({"clips": {}, "pooled": {"count_error": 0.0125, "f1": 0.9}})");
    TEST_ASSERT_EQUAL_DOUBLE(0.0125, read_count_error(good.path()));
    const TextFile odd(R"({"pooled": {"count_error": 1.5}})");
    expect_words(message_of<BadRequest>([&] { (void)read_count_error(odd.path()); }), {"1.5", "0 to 1"});
    const TextFile negative(R"({"pooled": {"count_error": -0.25}})");
    expect_words(message_of<BadRequest>([&] { (void)read_count_error(negative.path()); }), {"-0.25", "0 to 1"});
    expect_words(message_of<BadRequest>([] { (void)read_count_error("tests"); }), {"--count-scores tests"});
    for (const std::string text : {"", "{", "[]", "{}", R"({"pooled": 3})", R"({"pooled": {}})",
                                   R"({"pooled": {"count_error": "none"}})", R"({"pooled": {"count_error": null}})"}) {
        const TextFile bad(text);
        expect_words(message_of<BadRequest>([&] { (void)read_count_error(bad.path()); }, text),
                     {"--count-scores", bad.path().string(), "pooled.count_error", "tools/score-counter"});
    }
    expect_words(message_of<BadRequest>([] { (void)read_count_error("/nowhere/scores.json"); }),
                 {"/nowhere/scores.json", "no such file"});
}

void test_trials_come_back_as_they_were_written() {
    const auto rows = holding().trials;
    const TextFile file("");
    write_trials(file.path(), rows);
    const auto again = read_trials(file.path());
    TEST_ASSERT_EQUAL_UINT(rows.size(), again.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        TEST_ASSERT_TRUE(rows[i].profile == again[i].profile && rows[i].chooser == again[i].chooser &&
                         rows[i].forecast == again[i].forecast && rows[i].vehicles == again[i].vehicles &&
                         rows[i].trial == again[i].trial && rows[i].seed == again[i].seed);
        for (const auto &metric : summarized_metrics()) {
            TEST_ASSERT_TRUE(rows[i].metrics.*metric.value == again[i].metrics.*metric.value);
        }
        TEST_ASSERT_TRUE(rows[i].metrics.vehicles_in == again[i].metrics.vehicles_in);
        TEST_ASSERT_TRUE(rows[i].metrics.vehicles_outside == again[i].metrics.vehicles_outside);
    }
}

void test_trials_that_cannot_be_read_are_refused() {
    const TextFile lacking("profile,chooser\npaper,naive\n");
    expect_words(message_of<BadRequest>([&] { (void)read_trials(lacking.path()); }),
                 {lacking.path().string(), "no column forecast", "profile,chooser"});
    std::ifstream stream("tests/golden/claims_hold_trials.csv");
    std::string header, line;
    std::getline(stream, header);
    std::getline(stream, line);
    line.replace(line.find(",200,"), 5, ",many,");
    const TextFile bad(header + "\n" + line + "\n");
    expect_words(message_of<BadRequest>([&] { (void)read_trials(bad.path()); }), {":2", "vehicles", "\"many\""});
}

void test_unknown_metric_is_refused() {
    expect_words(message_of<BadRequest>([] { (void)find_metric("delay"); }), {"\"delay\""});
}

void test_pick() {
    const std::vector<Row> rows{row_of("itlc", 1.0, 10.0), row_of("oaf", 2.0, 20.0), row_of("itlc", 3.0, 30.0)};
    const Metric &delay = find_metric("mean_delay_s");
    TEST_ASSERT_TRUE((pick(rows, {"", "itlc", "", 0}, delay) == std::vector<double>{10.0, 30.0}));
    TEST_ASSERT_TRUE((pick(rows, {}, delay) == std::vector<double>{10.0, 20.0, 30.0}));
    TEST_ASSERT_TRUE(pick(rows, {"saturation", "", "", 0}, delay).empty());
    TEST_ASSERT_TRUE(pick(rows, {"", "", "ar8", 0}, delay).empty());
    TEST_ASSERT_TRUE(pick(rows, {"", "", "", 200}, delay).empty());
    TEST_ASSERT_EQUAL_UINT(3, pick(rows, {"paper", "", "none", 800}, delay).size());
}

void test_pick_by_trial_averages_over_the_numbers_of_vehicles() {
    std::vector<Row> rows{row_of("itlc", 1.0, 10.0), row_of("itlc", 1.0, 20.0), row_of("itlc", 1.0, 40.0)};
    rows[0].trial = 7;
    rows[1].vehicles = 200;
    rows[2].vehicles = 400;
    const Metric &delay = find_metric("mean_delay_s");
    TEST_ASSERT_TRUE((pick_by_trial(rows, {"", "itlc", "", 0}, delay) == std::vector<double>{30.0, 10.0}));
    TEST_ASSERT_TRUE((pick_by_trial(rows, {"", "", "", 400}, delay) == std::vector<double>{40.0}));
    TEST_ASSERT_TRUE(pick_by_trial(rows, {"", "oaf", "", 0}, delay).empty());
}

void test_samples_of_different_trials_are_not_paired() {
    std::vector<Row> rows{row_of("itlc", 1.0, 10.0), row_of("oaf", 2.0, 20.0), row_of("itlc", 3.0, 30.0)};
    const TextFile file("");
    write_pairs(file.path(), rows);
    TEST_ASSERT_EQUAL_UINT(0, read_csv(file.path()).rows.size());
    rows.push_back(row_of("oaf", 2.5, 25.0));
    write_pairs(file.path(), rows);
    const CsvTable table = read_csv(file.path());
    TEST_ASSERT_EQUAL_UINT(6, table.rows.size()); // three metrics, at 800 and pooled
    TEST_ASSERT_EQUAL_STRING("800", table.rows[0][1].c_str());
    TEST_ASSERT_EQUAL_STRING("pooled", table.rows[3][1].c_str());
    TEST_ASSERT_EQUAL_DOUBLE(-0.25, table.number(0, table.column("diff")));
}

} // namespace

int main() {
    UNITY_BEGIN();
    RUN_TEST(test_order_of_the_claims);
    RUN_TEST(test_every_claim_that_can_hold_holds);
    RUN_TEST(test_every_claim_can_fail);
    RUN_TEST(test_measured_values_are_told);
    RUN_TEST(test_every_forecast_stands_beside_elmopps_own);
    RUN_TEST(test_three_levels_must_be_better_in_every_seed_and_beyond_doubt);
    RUN_TEST(test_long_memory_is_read_from_the_training);
    RUN_TEST(test_missing_rows_are_not_run);
    RUN_TEST(test_another_grid_than_the_printed_one_is_not_judged);
    RUN_TEST(test_a_grid_with_a_hole_is_not_judged);
    RUN_TEST(test_a_single_trial_is_no_pair);
    RUN_TEST(test_ranking_needs_both_steps);
    RUN_TEST(test_curve_falls_at_every_step);
    RUN_TEST(test_t_values_hold_within_a_tenth);
    RUN_TEST(test_significance_is_one_sided_at_five_percent);
    RUN_TEST(test_prediction_must_help_against_both);
    RUN_TEST(test_prediction_must_help_beyond_doubt);
    RUN_TEST(test_unpaired_delays_are_not_compared);
    RUN_TEST(test_horizon_needs_the_printed_time);
    RUN_TEST(test_hyperchaos_needs_a_second_exponent_above_the_noise);
    RUN_TEST(test_literal_needs_nine_tenths_of_both);
    RUN_TEST(test_counting_needs_less_than_one_percent);
    RUN_TEST(test_lstm_is_preferred_to_ar8);
    RUN_TEST(test_best_label_of_a_sweep);
    RUN_TEST(test_claims_are_written_as_a_list_of_objects);
    RUN_TEST(test_count_error_is_read_from_the_scores);
    RUN_TEST(test_trials_come_back_as_they_were_written);
    RUN_TEST(test_trials_that_cannot_be_read_are_refused);
    RUN_TEST(test_unknown_metric_is_refused);
    RUN_TEST(test_pick);
    RUN_TEST(test_pick_by_trial_averages_over_the_numbers_of_vehicles);
    RUN_TEST(test_samples_of_different_trials_are_not_paired);
    return UNITY_END();
}
