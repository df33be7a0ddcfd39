// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "serve.hpp"

#include "choosers.hpp"
#include "csv.hpp"
#include "error.hpp"
#include "jobs.hpp"
#include "junction_json.hpp"
#include "junction_view.hpp"
#include "page_server.hpp"
#include "run.hpp"
#include "sites.hpp"
#include "trial.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <iostream>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace elmopp {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr unsigned most_vehicles_served = 100000;
constexpr unsigned most_steps = 600;
constexpr auto look_at_interrupts = std::chrono::milliseconds(100);

/// Leaves a run: somebody wishes another one.
struct Anew final : std::exception {};

/// What people may change, while it runs.
struct Settings {
    ChooserSpec chooser;
    unsigned vehicles;
    double speed;
    bool paused;
    bool straight;

    [[nodiscard]] std::string json() const {
        return Json{{"chooser", full_name(chooser.label(), chooser.forecast)},
                    {"vehicles", vehicles},
                    {"speed", speed},
                    {"paused", paused},
                    {"straight", straight}}
            .dump();
    }
};

[[noreturn]] void refuse(const std::string &key, const nlohmann::json &value, const std::string &right) {
    throw BadRequest(key + " is " + value.dump() + "; right would be " + right);
}

double number_of(const std::string &key, const nlohmann::json &value, double lowest, double highest, bool whole) {
    const double number = value.is_number() ? value.get<double>() : std::nan("");
    if (!(number >= lowest && number <= highest) || (whole && number != std::floor(number))) {
        refuse(key, value,
               std::string("a ") + (whole ? "whole " : "") + "number from " + format_number(lowest, 6) + " to " +
                   format_number(highest, 6));
    }
    return number;
}

bool truth_of(const std::string &key, const nlohmann::json &value) {
    if (!value.is_boolean()) {
        refuse(key, value, "true or false");
    }
    return value.get<bool>();
}

/// A chooser that can be made here and whose forecast is no secret to a street.
ChooserSpec chooser_of(const std::string &text, const Scenario &scenario) {
    ChooserSpec spec = parse_chooser(text);
    if (spec.forecast == "oracle") {
        throw BadRequest("chooser \"" + text +
                         "\": nobody on a street knows the future; right would be another forecast");
    }
    (void)make_chooser(spec, scenario.setting());
    return spec;
}

/// The wishes of everybody who looks on, and the pace of the simulation. One mutex, held for moments.
class Desk {
  public:
    Desk(const Scenario &scenario, Settings settings) : scenario_(scenario), settings_(std::move(settings)) {}

    /// Takes a wish {vehicles, chooser, straight, paused, speed, step, restart}, all or nothing of it.
    std::string take(const std::string &body);

    [[nodiscard]] Settings settings() const {
        const std::lock_guard<std::mutex> lock(mutex_);
        return settings_;
    }

    /// Waits until the next second is due. Throws Anew or, after an interrupt, Failure.
    void wait();

  private:
    struct Wished {
        Settings settings;
        unsigned steps = 0;
        bool anew = false;
    };

    void wish(const std::string &key, const nlohmann::json &value, Wished &wished) const;
    [[nodiscard]] bool is_due(Clock::time_point begun) const;

    const Scenario &scenario_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    Settings settings_;
    unsigned steps_ = 0;
    bool anew_ = false;
};

void Desk::wish(const std::string &key, const nlohmann::json &value, Wished &wished) const {
    if (key == "vehicles") {
        wished.settings.vehicles = static_cast<unsigned>(number_of(key, value, 1, most_vehicles_served, true));
    } else if (key == "speed") {
        wished.settings.speed = number_of(key, value, lowest_speed, highest_speed, false);
    } else if (key == "paused") {
        wished.settings.paused = truth_of(key, value);
    } else if (key == "straight") {
        wished.settings.straight = truth_of(key, value);
        wished.anew = wished.anew || wished.settings.straight != settings_.straight;
    } else if (key == "step") {
        wished.steps = static_cast<unsigned>(number_of(key, value, 1, most_steps, true));
        wished.settings.paused = true;
    } else if (key == "restart") {
        wished.anew = truth_of(key, value);
    } else if (key == "chooser") {
        if (!value.is_string()) {
            refuse(key, value, "a text such as cumulative:lstm");
        }
        wished.settings.chooser = chooser_of(value.get<std::string>(), scenario_);
        wished.anew = wished.anew || !(wished.settings.chooser == settings_.chooser);
    } else {
        throw BadRequest("unknown key \"" + key +
                         "\"; right would be some of vehicles, chooser, straight, paused, speed, step, restart");
    }
}

std::string Desk::take(const std::string &body) {
    const auto json = nlohmann::json::parse(body, nullptr, false);
    if (!json.is_object() || json.empty()) {
        throw BadRequest("the body is no JSON object; right would be one such as {\"paused\": true}");
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    Wished wished{settings_};
    for (const auto &[key, value] : json.items()) {
        wish(key, value, wished);
    }
    settings_ = wished.settings;
    steps_ = settings_.paused ? std::min(steps_ + wished.steps, most_steps) : 0;
    anew_ = anew_ || wished.anew;
    changed_.notify_all();
    return settings_.json();
}

bool Desk::is_due(Clock::time_point begun) const {
    if (anew_ || steps_ > 0) {
        return true;
    }
    return !settings_.paused && std::chrono::duration<double>(Clock::now() - begun).count() * settings_.speed >= 1.0;
}

void Desk::wait() {
    const Clock::time_point begun = Clock::now();
    std::unique_lock<std::mutex> lock(mutex_);
    while (!is_due(begun)) {
        const auto second =
            std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / settings_.speed));
        changed_.wait_until(lock, settings_.paused ? Clock::now() + look_at_interrupts
                                                   : std::min(begun + second, Clock::now() + look_at_interrupts));
        check_interrupt();
    }
    steps_ -= steps_ > 0 ? 1U : 0U;
    if (std::exchange(anew_, false)) {
        throw Anew();
    }
}

/// Whose the forecast is that the chooser saw.
const char *model_of(elmopp_foresight_t foresight, const ChooserSpec &chooser) {
    switch (foresight) {
    case ELMOPP_FORESIGHT_GIVEN:
        return JunctionView::model_word(ELMOPP_MODEL_GIVEN);
    case ELMOPP_FORESIGHT_COLD:
        return JunctionView::model_word(ELMOPP_MODEL_COLD);
    case ELMOPP_FORESIGHT_UNARMED:
        return JunctionView::model_word(ELMOPP_MODEL_UNARMED);
    case ELMOPP_FORESIGHT_DISTRUSTED:
        return JunctionView::model_word(ELMOPP_MODEL_DISTRUSTED);
    case ELMOPP_FORESIGHT_OWN:
        break;
    }
    return JunctionView::model_word(forecast_kind(chooser.forecast));
}

/// One run after the other, told to the stream.
class Show {
  public:
    Show(const ServeRequest &request, const Scenario &scenario)
        : request_(request), scenario_(scenario), desk_(scenario, {first_chooser(request, scenario), request.vehicles,
                                                                   request.speed, request.paused, request.straight}),
          trial_(request.trial),
          server_(page_facts(scenario), request.port,
                  Controls{desk_.settings().json(), [this](const std::string &body) { return desk_.take(body); }}) {}

    [[noreturn]] void go_on() {
        std::cout << "host_sim: " << server_.address() << " shows " << scenario_.junction.name << "; ctrl-C ends it\n"
                  << std::flush;
        for (;;) {
            try {
                run();
                ++trial_;
            } catch (const Anew &) {
                continue; // the same trial
            }
        }
    }

  private:
    static ChooserSpec first_chooser(const ServeRequest &request, const Scenario &scenario) {
        if (request.chooser) {
            return chooser_of(*request.chooser, scenario);
        }
        return request.site ? site_chooser(scenario.junction) : parse_chooser("cumulative:lstm");
    }

    static std::string page_facts(const Scenario &scenario) {
        Json site = junction_json(scenario.junction);
        site["controls"] = true;
        site["choosers"] = Json::array();
        for (const auto &kind : chooser_kinds()) {
            for (const auto &forecast : kind.forecasts ? forecast_names() : std::vector<std::string>{"none"}) {
                if (forecast != "oracle") {
                    site["choosers"].push_back(
                        {{"name", full_name(kind.name, forecast)}, {"what", kind.what}, {"rival", kind.rival}});
                }
            }
        }
        site["demand_s"] = simulated_points;
        return site.dump();
    }

    void run() {
        const Settings settings = desk_.settings();
        const Source source = make_source(scenario_.profile.integrator, Mapping::abs, request_.seed, trial_,
                                          scenario_.junction.approach_count);
        Demand demand =
            make_demand(source.unit, settings.vehicles, training_points, source.ar8, true, simulated_points);
        unsigned vehicles = settings.vehicles;
        const ChooserSpec &chooser = settings.chooser;
        const auto control = settings.straight
                                 ? make_direct(scenario_, chooser, demand)
                                 : make_framed(scenario_, chooser, demand, make_inproc(scenario_, chooser, demand));
        server_.stream().begin(Json{
            {"site", scenario_.junction.name},
            {"profile", scenario_.profile.name},
            {"chooser", full_name(chooser.label(), chooser.forecast)},
            {"straight", settings.straight},
            {"seed", request_.seed},
            {"trial", trial_}}.dump());
        (void)run_trial(scenario_, *control, demand, simulated_points, [&](const Second &second) {
            std::string line = log_line(second, scenario_.junction, true);
            line.insert(line.size() - 1,
                        std::string(",\"model\":\"") + model_of(second.told.foresight, chooser) + "\"");
            server_.stream().second(line);
            desk_.wait();
            if (const unsigned wanted = desk_.settings().vehicles; wanted != vehicles) {
                scale(demand, source, training_points + second.t_s + 1, wanted);
                vehicles = wanted;
            }
        });
    }

    /// From this point on, so many vehicles an approach.
    static void scale(Demand &demand, const Source &source, std::size_t first, unsigned vehicles) {
        for (std::size_t i = 0; i < demand.veh_per_s.size(); ++i) {
            for (std::size_t point = first; point < demand.veh_per_s[i].size(); ++point) {
                demand.veh_per_s[i][point] = source.unit[i][point] * vehicles;
            }
        }
    }

    const ServeRequest &request_;
    const Scenario &scenario_;
    Desk desk_;
    std::uint64_t trial_;
    PageServer server_; ///< the last, so that nobody wishes anything of what is gone
};

} // namespace

void serve(const ServeRequest &request) {
    const elmopp_junction_t junction = request.site ? read_site(*request.site) : elmopp_site_four_way;
    const Scenario scenario = make_scenario("saturation", &junction);
    Show show(request, scenario);
    try {
        show.go_on();
    } catch (const Failure &) {
        if (!interrupt_has_come()) {
            throw;
        }
    }
}

} // namespace elmopp
