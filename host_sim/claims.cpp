// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "claims.hpp"

#include "csv.hpp"
#include "error.hpp"
#include "stats.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

namespace elmopp {
namespace {

constexpr double alpha = 0.05;
constexpr double t_tolerance = 0.10; ///< a printed t counts as reproduced within a tenth
constexpr double printed_lyapunov_s = 417.0;
constexpr double horizon_tolerance = 0.15;
constexpr double longest_green_s = 60.0;
constexpr double many_greens = 5.0;        ///< "far greater than any reasonable maximum activation time"
constexpr double positive_exponent = 0.05; ///< an exponent below is noise of the estimate
constexpr double working_share = 0.90;
constexpr double printed_count_error = 0.01;

/// A chooser's row of the comparison.
struct Player {
    std::string label;
    std::string forecast;
};

class Judge {
  public:
    Judge(const std::vector<Row> &trials, const std::vector<Row> &beside, const Facts &facts)
        : rows_(trials), facts_(facts) {
        rows_.insert(rows_.end(), beside.begin(), beside.end());
        elmopp_ = {"cumulative", pooled({"cumulative", "lstm"}).empty() ? "ar8" : "lstm"};
        itlc_ = {best_label(rows_, "paper", "itlc", throughput_, true), "none"};
        oaf_ = {best_label(rows_, "paper", "oaf", throughput_, true), "none"};
    }

    [[nodiscard]] std::vector<Claim> all() const {
        return {ranking(),
                falling(),
                greater("elmopp_gt_itlc", "ELMOPP's throughput is significantly above ITLC's", elmopp_, itlc_),
                greater("elmopp_gt_oaf", "ELMOPP's throughput is significantly above OAF's", elmopp_, oaf_),
                greater("itlc_gt_oaf", "ITLC's throughput is significantly above OAF's", itlc_, oaf_),
                t_value("t_elmopp_itlc", 17.6799, elmopp_, itlc_),
                t_value("t_elmopp_oaf", 69.4727, elmopp_, oaf_),
                t_value("t_itlc_oaf", 85.0275, itlc_, oaf_),
                prediction(),
                horizon(),
                hyperchaos(),
                literal(),
                three_levels(),
                counting()};
    }

  private:
    /// A verdict needs the numbers of vehicles that the paper printed, all of them and no other.
    [[nodiscard]] bool has_printed_grid(const Player &player, const std::string &profile) const {
        std::set<unsigned> vehicles;
        for (const auto &row : rows_) {
            if (row.profile == profile && row.chooser == player.label && row.forecast == player.forecast) {
                vehicles.insert(row.vehicles);
            }
        }
        return vehicles == std::set<unsigned>{200, 400, 600, 800, 1000};
    }

    /// All of a player's trials; none if the printed grid was not run.
    [[nodiscard]] std::vector<double> pooled(const Player &player, const std::string &profile = "paper") const {
        return has_printed_grid(player, profile) ? pick(rows_, {profile, player.label, player.forecast, 0}, throughput_)
                                                 : std::vector<double>();
    }

    [[nodiscard]] static std::string name(const Player &player) {
        return full_name(player.label, player.forecast);
    }

    [[nodiscard]] static Claim missing(const std::string &id, const std::string &claim, const std::string &printed) {
        return {id, claim, printed, "the rows that it needs were not run", Verdict::not_run};
    }

    [[nodiscard]] static Verdict verdict(bool holds) {
        return holds ? Verdict::reproduced : Verdict::not_reproduced;
    }

    [[nodiscard]] Claim ranking() const {
        const std::string claim = "mean throughput ranks ELMOPP before ITLC before OAF";
        const std::string printed = "2.09133 > 1.83414 > 1.12108 vehicles/s";
        const auto a = pooled(elmopp_), b = pooled(itlc_), c = pooled(oaf_);
        if (a.empty() || b.empty() || c.empty()) {
            return missing("ranking_throughput", claim, printed);
        }
        const double ma = summarize(a).mean, mb = summarize(b).mean, mc = summarize(c).mean;
        const std::string measured = name(elmopp_) + " " + format_number(ma, 6) + ", " + name(itlc_) + " " +
                                     format_number(mb, 6) + ", " + name(oaf_) + " " + format_number(mc, 6) +
                                     " vehicles/s";
        return {"ranking_throughput", claim, printed, measured, verdict(ma > mb && mb > mc)};
    }

    [[nodiscard]] Claim falling() const {
        const std::string claim = "ELMOPP's throughput falls as the vehicles become more";
        const std::string printed = "2.31937 2.17839 2.06249 1.97497 1.92143 vehicles/s at 200 to 1000";
        std::map<unsigned, std::vector<double>> by_vehicles;
        for (const auto &row : rows_) {
            if (row.profile == "paper" && row.chooser == elmopp_.label && row.forecast == elmopp_.forecast) {
                by_vehicles[row.vehicles].push_back(row.metrics.throughput_veh_per_s);
            }
        }
        if (!has_printed_grid(elmopp_, "paper")) {
            return missing("curve_falls", claim, printed);
        }
        std::vector<std::string> texts;
        bool falls = true;
        double last = INFINITY;
        for (const auto &[vehicles, values] : by_vehicles) {
            const double mean = summarize(values).mean;
            falls = falls && mean < last;
            last = mean;
            texts.push_back(format_number(mean, 6));
        }
        const std::string measured = name(elmopp_) + " " + join(texts, " ") + " vehicles/s at " +
                                     std::to_string(by_vehicles.begin()->first) + " to " +
                                     std::to_string(by_vehicles.rbegin()->first);
        return {"curve_falls", claim, printed, measured, verdict(falls)};
    }

    [[nodiscard]] std::string test_text(const Player &a, const Player &b, const Welch &test, std::size_t n) const {
        return name(a) + " v. " + name(b) + ", pooled: t = " + format_number(test.t, 5) +
               ", df = " + format_number(test.df, 4) + ", one-sided p = " + format_number(test.p_one_sided, 3) +
               ", n = " + std::to_string(n);
    }

    [[nodiscard]] Claim greater(const std::string &id, const std::string &claim, const Player &a,
                                const Player &b) const {
        const std::string printed = "significant at 0.05";
        const auto of_a = pooled(a), of_b = pooled(b);
        if (of_a.size() < 2 || of_b.size() < 2) {
            return missing(id, claim, printed);
        }
        const Welch test = welch(of_a, of_b);
        return {id, claim, printed, test_text(a, b, test, of_a.size()), verdict(test.p_one_sided < alpha)};
    }

    [[nodiscard]] Claim t_value(const std::string &id, double printed_t, const Player &a, const Player &b) const {
        const std::string claim = "Welch's t of this pair has the printed value (within a tenth)";
        const std::string printed = format_number(printed_t, 6);
        const auto of_a = pooled(a), of_b = pooled(b);
        if (of_a.size() < 2 || of_b.size() < 2) {
            return missing(id, claim, printed);
        }
        const Welch test = welch(of_a, of_b);
        return {id, claim, printed, test_text(a, b, test, of_a.size()),
                verdict(std::abs(test.t - printed_t) <= t_tolerance * printed_t)};
    }

    /// A player's delay less that of a chooser without a forecast, paired by trial: the numbers of vehicles of one
    /// trial share its initial state and count once.
    [[nodiscard]] std::optional<Interval> saved(const Player &player, const Player &without) const {
        if (!has_printed_grid(player, "paper") || !has_printed_grid(without, "paper")) {
            return std::nullopt;
        }
        const Metric &delay = find_metric("mean_delay_s");
        const auto with = pick_by_trial(rows_, {"paper", player.label, player.forecast, 0}, delay);
        const auto other = pick_by_trial(rows_, {"paper", without.label, without.forecast, 0}, delay);
        if (with.size() < 2 || with.size() != other.size()) {
            return std::nullopt;
        }
        return paired_interval(with, other);
    }

    /// The forecasts that were run, ELMOPP's own first.
    [[nodiscard]] std::vector<Player> foreseeing() const {
        std::vector<Player> players{elmopp_};
        std::set<std::string> seen{elmopp_.forecast, "none"};
        for (const auto &row : rows_) {
            if (row.profile == "paper" && row.chooser == elmopp_.label && seen.insert(row.forecast).second) {
                players.push_back({elmopp_.label, row.forecast});
            }
        }
        return players;
    }

    /// The verdict is on ELMOPP's own forecast; the others stand beside it.
    [[nodiscard]] Claim prediction() const {
        const std::string claim = "predicting the inflow lowers the delay, against naive and against no forecast";
        const std::string printed = "the algorithm's purpose; no figure";
        const auto text = [](const Interval &interval) {
            return "[" + format_number(interval.low, 3) + ", " + format_number(interval.high, 3) + "]";
        };
        std::vector<std::string> texts;
        for (const auto &player : foreseeing()) {
            const auto naive = saved(player, {"naive", "none"});
            const auto blind = saved(player, {"cumulative", "none"});
            if (naive && blind) {
                texts.push_back(name(player) + " " + text(*naive) + ", " + text(*blind));
            }
        }
        const auto naive = saved(elmopp_, {"naive", "none"});
        const auto blind = saved(elmopp_, {"cumulative", "none"});
        if (!naive || !blind) {
            return missing("prediction_helps", claim, printed);
        }
        const std::string measured =
            "paired difference of delay in s, 95 % interval, to naive and to cumulative without "
            "a forecast: " +
            join(texts, "; ");
        return {"prediction_helps", claim, printed, measured, verdict(naive->high < 0.0 && blind->high < 0.0)};
    }

    [[nodiscard]] Claim three_levels() const {
        const std::string claim = "three levels remember longer: a triply nested LSTM forecasts an hour ahead better "
                                  "than one level of as many parameters";
        const std::string printed = "at least three levels are necessary; no figure";
        if (!facts_.long_memory) {
            return {"three_levels", claim, printed, "weights/long_memory.json of tools/train was not found",
                    Verdict::not_run};
        }
        const auto &[one, three] = *facts_.long_memory;
        const Interval difference = paired_interval(three, one);
        bool always = true;
        for (std::size_t seed = 0; seed < one.size(); ++seed) {
            always = always && three[seed] < one[seed];
        }
        const std::string measured = "RMSE 60 minutes ahead over " + std::to_string(one.size()) + " seeds: one level " +
                                     format_number(summarize(one).mean, 4) + ", three " +
                                     format_number(summarize(three).mean, 4) + " vehicles/min, paired difference [" +
                                     format_number(difference.low, 3) + ", " + format_number(difference.high, 3) + "]";
        return {"three_levels", claim, printed, measured, verdict(always && difference.high < 0.0)};
    }

    [[nodiscard]] Claim horizon() const {
        const double lyapunov_s = 1.0 / (facts_.exponents_rk4[0] * time_step);
        const bool holds = std::abs(lyapunov_s - printed_lyapunov_s) <= horizon_tolerance * printed_lyapunov_s &&
                           lyapunov_s >= many_greens * longest_green_s;
        return {"horizon_417", "the Lyapunov time is 417 steps, far above any green",
                "417 steps of 0.01, largest exponent 0.24",
                format_number(lyapunov_s, 4) + " steps, largest exponent " + format_number(facts_.exponents_rk4[0], 3) +
                    " (RK4)",
                verdict(holds)};
    }

    [[nodiscard]] Claim hyperchaos() const {
        std::vector<std::string> texts;
        texts.reserve(facts_.exponents_euler.size());
        for (const double exponent : facts_.exponents_euler) {
            texts.push_back(format_number(exponent, 2));
        }
        return {"hyperchaos_euler",
                "Euler with a step of 0.01 is safe: the inflow stays hyperchaotic (two positive exponents)",
                "non-stiff, safe", "exponents " + join(texts, " "),
                verdict(facts_.exponents_euler[1] > positive_exponent)};
    }

    [[nodiscard]] Claim literal() const {
        const std::string claim = "Algorithm 1 as printed works (nine tenths of the throughput with a hold window)";
        const std::string printed = "implied";
        const auto adopted = pooled({"naive", "none"});
        const auto naive = pooled({"naive", "none"}, "literal");
        const auto cumulative = pooled({"cumulative", "none"}, "literal");
        if (adopted.empty() || naive.empty() || cumulative.empty()) {
            return missing("literal_works", claim, printed);
        }
        const double reference = summarize(adopted).mean;
        const double share_naive = summarize(naive).mean / reference;
        const double share_cumulative = summarize(cumulative).mean / reference;
        return {"literal_works", claim, printed,
                "eq. 2: " + format_number(100.0 * share_naive, 3) +
                    " %, Algorithm 1: " + format_number(100.0 * share_cumulative, 3) + " %",
                verdict(share_naive >= working_share && share_cumulative >= working_share)};
    }

    [[nodiscard]] Claim counting() const {
        const std::string claim = "a camera counts vehicles with an accuracy above 99 %";
        if (!facts_.count_error) {
            return {"count_accuracy", claim, "above 99 %, cited", "no camera scores were given (--count-scores)",
                    Verdict::not_run};
        }
        return {"count_accuracy", claim, "above 99 %, cited",
                format_number(100.0 * (1.0 - *facts_.count_error), 4) + " %",
                verdict(*facts_.count_error < printed_count_error)};
    }

    const Metric &throughput_ = find_metric("throughput_veh_per_s");
    std::vector<Row> rows_;
    const Facts &facts_;
    Player elmopp_;
    Player itlc_;
    Player oaf_;
};

} // namespace

std::string best_label(const std::vector<Row> &rows, const std::string &profile, const std::string &chooser,
                       const Metric &metric, bool highest) {
    std::map<std::string, std::vector<double>> by_label;
    for (const auto &row : rows) {
        if (row.profile == profile && (row.chooser == chooser || row.chooser.rfind(chooser + "@", 0) == 0)) {
            by_label[row.chooser].push_back(row.metrics.*metric.value);
        }
    }
    std::string best;
    double best_mean = 0.0;
    for (const auto &[label, values] : by_label) {
        const double mean = summarize(values).mean;
        const bool better = highest ? mean > best_mean : mean < best_mean;
        if (values.size() == by_label[chooser].size() && (best.empty() || better)) {
            best = label;
            best_mean = mean;
        }
    }
    return best;
}

std::vector<Claim> judge(const std::vector<Row> &trials, const std::vector<Row> &beside, const Facts &facts) {
    return Judge(trials, beside, facts).all();
}

std::string to_string(Verdict verdict) {
    switch (verdict) {
    case Verdict::reproduced:
        return "reproduced";
    case Verdict::not_reproduced:
        return "not_reproduced";
    case Verdict::not_run:
        break;
    }
    return "not_run";
}

void write_claims(const std::filesystem::path &file, const std::vector<Claim> &claims) {
    auto list = nlohmann::ordered_json::array();
    for (const auto &claim : claims) {
        list.push_back({{"id", claim.id},
                        {"claim", claim.claim},
                        {"printed", claim.printed},
                        {"measured", claim.measured},
                        {"verdict", to_string(claim.verdict)}});
    }
    std::ofstream out(file);
    out << list.dump(1) << '\n';
    if (!out.flush()) {
        throw Failure(file.string() + ": could not be written");
    }
}

LongMemory read_long_memory(const std::filesystem::path &file) {
    std::ifstream stream(file);
    const auto json = nlohmann::json::parse(stream, nullptr, false);
    LongMemory memory;
    try {
        memory = {json.at("rmse").at("lstm1").at("60").get<std::vector<double>>(),
                  json.at("rmse").at("lstm3").at("60").get<std::vector<double>>()};
    } catch (const nlohmann::json::exception &) {
        memory = {};
    }
    if (memory.rmse_1.size() < 2 || memory.rmse_1.size() != memory.rmse_3.size()) {
        throw BadRequest(file.string() +
                         ": no errors of at least two seeds at rmse.lstm1.60 and rmse.lstm3.60; right " +
                         "would be a file of tools/train");
    }
    return memory;
}

double read_count_error(const std::filesystem::path &file) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) {
        throw BadRequest("--count-scores " + file.string() +
                         ": no such file; right would be one of tools/score-counter");
    }
    std::ifstream stream(file);
    const auto scores = nlohmann::json::parse(stream, nullptr, false);
    const auto pointer = nlohmann::json::json_pointer("/pooled/count_error");
    if (!scores.is_object() || !scores.contains(pointer) || !scores.at(pointer).is_number()) {
        throw BadRequest("--count-scores " + file.string() +
                         ": no number at pooled.count_error; right would be a file of tools/score-counter");
    }
    const double share = scores.at(pointer).get<double>();
    if (!(share >= 0.0 && share <= 1.0)) {
        throw BadRequest("--count-scores " + file.string() + ": pooled.count_error is " + format_number(share, 6) +
                         "; right would be a share from 0 to 1");
    }
    return share;
}

} // namespace elmopp
