// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "loop.hpp"

#include "bus.hpp"
#include "csv.hpp"
#include "decision_log.hpp"
#include "error.hpp"
#include "overlay.hpp"
#include "sites.hpp"
#include "street_trial.hpp"
#include "whole_file.hpp"

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>

namespace elmopp {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The controller's side through frames, and lamps as the street sees them.
class Chain final : public Control {
  public:
    Chain(std::unique_ptr<Control> framed, StreetBus &bus) : framed_(std::move(framed)), bus_(bus) {}

    void count(const Counted &world, std::size_t t_s) override {
        framed_->count(world, t_s);
    }
    elmopp_lamps_t lamp_tick() override {
        (void)framed_->lamp_tick();
        return bus_.shown();
    }
    [[nodiscard]] Told told() const override {
        return framed_->told();
    }

  private:
    std::unique_ptr<Control> framed_;
    StreetBus &bus_;
};

/// All cameras side by side, two by two.
class Mosaic {
  public:
    explicit Mosaic(const std::string &file) : overlay_(file) {}

    void add(const std::vector<std::unique_ptr<Film>> &films, double t_s) {
        const cv::Size one = films[0]->picture().size();
        const int rows = (static_cast<int>(films.size()) + 1) / 2;
        cv::Mat all =
            cv::Mat::zeros(one.height * rows, one.width * std::min<int>(2, static_cast<int>(films.size())), CV_8UC3);
        for (std::size_t i = 0; i < films.size(); ++i) {
            const cv::Point corner(static_cast<int>(i % 2) * one.width, static_cast<int>(i / 2) * one.height);
            films[i]->drawn().copyTo(all(cv::Rect(corner, one)));
        }
        overlay_.add(all, t_s);
    }
    void finish() {
        overlay_.finish();
    }

  private:
    Overlay overlay_;
};

/// The folder of the results. One that was made for a run that then wrote nothing goes again.
class OutFolder {
  public:
    /// Throws BadRequest if it cannot be made.
    explicit OutFolder(const fs::path &folder) : folder_(fs::absolute(folder).lexically_normal()) {
        std::error_code error;
        for (fs::path part = folder_; !fs::exists(part, error) && part.has_relative_path(); part = part.parent_path()) {
            made_.push_back(part);
        }
        fs::create_directories(folder_, error);
        if (error) {
            remove_empty();
            throw BadRequest("--out \"" + folder.string() +
                             "\": cannot be written; right would be a folder in which files can be made");
        }
    }
    ~OutFolder() {
        remove_empty();
    }
    OutFolder(const OutFolder &) = delete;
    OutFolder &operator=(const OutFolder &) = delete;
    OutFolder(OutFolder &&) = delete;
    OutFolder &operator=(OutFolder &&) = delete;

  private:
    void remove_empty() noexcept {
        for (const fs::path &part : made_) {
            std::error_code ignored; // what holds something stays
            fs::remove(part, ignored);
        }
    }

    fs::path folder_;
    std::vector<fs::path> made_; ///< the innermost first
};

/// What one run was like.
struct Run {
    Metrics metrics;
    Findings found;
    std::vector<LaneTally> lanes;
    double present_error_veh = 0.0; ///< mean over seconds and movements
    unsigned doubted_s = 0;         ///< seconds in which a counter did not believe its camera
};

const char *mode_name(elmopp_mode_t mode) {
    static const std::vector<const char *> names{"starting",  "start_flash", "start_red", "first_stage",
                                                 "automatic", "fixed_time",  "manual",    "all_red",
                                                 "flashing",  "dark",        "fail_safe"};
    return static_cast<std::size_t>(mode) < names.size() ? names[static_cast<std::size_t>(mode)] : "none";
}

std::string aspects_of(const elmopp_lamps_t &lamps, const elmopp_junction_t &site) {
    std::string digits;
    for (std::uint32_t g = 0; g < site.group_count; ++g) {
        digits += std::to_string(static_cast<unsigned>(elmopp_lamps_aspect(&lamps, g)));
    }
    return digits;
}

class StreetRun;

class LoopProgram {
    friend class StreetRun;

  public:
    explicit LoopProgram(const LoopRequest &request)
        : request_(request), site_(read_street(request.site)),
          scenario_(make_scenario("discrete@demand=" + request.demand, &site_)),
          chooser_(request.chooser ? parse_chooser(*request.chooser) : site_chooser(site_)),
          troubles_(parse_troubles(request.faults, site_)) {
        check();
        const Source source =
            make_source(scenario_.profile.integrator, Mapping::abs, request.seed, 0, site_.approach_count);
        const double each = vehicles_per_approach(scenario_.profile.scope, request.vehicles, source.unit.size());
        // Before minutes of pictures, and not after them.
        out_.emplace(request.out);
        const WholeFile probe("--out", request.out / "closed_loop.json");
        if (!request.overlay.empty()) {
            mosaic_ = std::make_unique<Mosaic>(request.overlay);
        }
        demand_ = make_discrete_demand(scenario_, source.unit, each, request.seed, 0, request.seconds);
        // The controller begins in a street that nobody has counted before.
        demand_.mean_veh_per_s.clear();
        demand_.origin = 0;
        for (std::size_t i = 0; i < site_.approach_count; ++i) {
            if (elmopp_mask_has(site_.cameras, static_cast<std::uint32_t>(i))) {
                camera_names_.emplace_back(std::begin(site_.approach_name[i]));
            }
        }
    }

    void run() {
        const Run perfect = drive(false);
        const Run camera = drive(true);
        if (mosaic_) {
            mosaic_->finish();
        }
        Findings found = camera.found;
        found += perfect.found;
        write(perfect, camera, found);
        if (found.conflicts + found.early_greens + found.short_ambers > 0) {
            throw Failure("the lamps showed what they must not: see conflicts, early_greens and short_ambers in " +
                          (request_.out / "closed_loop.json").string());
        }
    }

  private:
    void check() const {
        const auto scenes = RoadWeather::names();
        if (std::find(scenes.begin(), scenes.end(), request_.scene) == scenes.end()) {
            throw BadRequest("--scene \"" + request_.scene + "\": right would be one of " + join(scenes, ", "));
        }
        const bool is_inproc = request_.link == "inproc";
        if (!is_inproc && request_.link.rfind("can:", 0) != 0 && request_.link.rfind("slcan:", 0) != 0) {
            throw BadRequest("--link \"" + request_.link + "\": right would be inproc, can:IFACE or slcan:PLACE");
        }
        for (const Trouble &trouble : troubles_) {
            if (trouble.from_s >= static_cast<double>(request_.seconds)) {
                throw BadRequest("--faults " + trouble.kind + (trouble.who.empty() ? "" : ":" + trouble.who) + "@" +
                                 format_number(trouble.from_s, 12) + " begins when the run is over; right would be " +
                                 "before --seconds " + std::to_string(request_.seconds));
            }
        }
        const auto resets = [](const Trouble &trouble) { return trouble.kind == "reset"; };
        const bool needs_command = !is_inproc && std::any_of(troubles_.begin(), troubles_.end(), resets);
        if (needs_command && request_.reset.empty()) {
            throw BadRequest("--faults reset with --link " + request_.link +
                             ": right would be --reset-command with what resets that controller, or --link inproc");
        }
        if (!needs_command && !request_.reset.empty()) {
            throw BadRequest("--reset-command \"" + request_.reset +
                             "\" is never run: right would be reset among --faults, and a --link to a controller");
        }
        if (!is_inproc && !(chooser_ == site_chooser(site_))) {
            throw BadRequest("--chooser with --link " + request_.link +
                             ": the controller there runs what its site names; right would be none");
        }
    }

    [[nodiscard]] std::unique_ptr<Link> controller() const {
        if (request_.link == "inproc") {
            return make_inproc(scenario_, chooser_, demand_, Refused::loss);
        }
        const std::string place = request_.link.substr(request_.link.find(':') + 1);
        return make_bus(request_.link.rfind("slcan:", 0) == 0 ? make_slcan_wire(place) : make_can_wire(place), true);
    }

    /// The one in this process ends with its link.
    void reset() const {
        if (!request_.reset.empty()) {
            const ToolResult result = run_words({"/bin/sh", "-c", request_.reset});
            if (result.exit_code != 0) {
                throw Failure("--reset-command \"" + request_.reset + "\" ended with " +
                              std::to_string(result.exit_code) + (result.last_line.empty() ? "" : ": ") +
                              result.last_line);
            }
        }
    }

    [[nodiscard]] Run drive(bool with_cameras);
    void log(std::ostream &out, const Second &second, const BusSecond &bus, const std::vector<int> &there) const;
    void write(const Run &perfect, const Run &camera, const Findings &found) const;
    [[nodiscard]] std::vector<std::unique_ptr<Film>> films() const;

    const LoopRequest &request_;
    elmopp_junction_t site_;
    Scenario scenario_;
    ChooserSpec chooser_;
    std::vector<Trouble> troubles_;
    Demand demand_{};
    std::optional<OutFolder> out_;
    std::unique_ptr<Mosaic> mosaic_;
    std::vector<std::string> camera_names_;
};

/// One run from the start-up to the end, with cameras or with counts that are right.
class StreetRun {
  public:
    StreetRun(LoopProgram &loop, bool with_cameras)
        : loop_(loop), films_(with_cameras ? loop.films() : std::vector<std::unique_ptr<Film>>()),
          plan_(plan_of(loop.scenario_)), follower_(plan_, 0), there_(loop.site_.movement_count) {
        std::vector<Film *> looking;
        looking.reserve(films_.size());
        for (const auto &film : films_) {
            looking.push_back(film.get());
        }
        auto link = std::make_unique<StreetBus>(
            loop.scenario_.junction, [&loop] { return loop.controller(); }, [&loop] { loop.reset(); }, looking, places_,
            with_cameras ? loop.troubles_ : std::vector<Trouble>(), loop.request_.seed);
        bus_ = link.get();
        if (with_cameras && loop.mosaic_) {
            bus_->looked = [this](double t_s) { loop_.mosaic_->add(films_, t_s); };
        }
        if (with_cameras) {
            log_.emplace("--out", loop.request_.out / "street.jsonl");
        }
        chain_ =
            std::make_unique<Chain>(make_framed(loop.scenario_, loop.chooser_, loop.demand_, std::move(link)), *bus_);
    }

    Run run() {
        Run run;
        run.metrics = run_streets(
            plan_, {{loop_.scenario_, *chain_, loop_.demand_}}, loop_.request_.seconds,
            [this, &run](const Second &second) { note(second, run); }, {},
            [this](const Streets &streets) { follow(streets); });
        for (const auto &film : films_) {
            film->finish();
            const auto lanes = film->tally();
            run.lanes.insert(run.lanes.end(), lanes.begin(), lanes.end());
        }
        run.present_error_veh /= static_cast<double>(loop_.request_.seconds * there_.size());
        run.found = bus_->witness().findings();
        if (log_) {
            log_->commit();
        }
        return run;
    }

  private:
    void follow(const Streets &streets) {
        follower_.follow(streets);
        places_ = follower_.all();
        if (!begun_) {
            bus_->begin();
            begun_ = true;
        }
    }

    /// A second's counts were taken when it began: `there_` is of then.
    void note(const Second &second, Run &run) {
        const BusSecond noted = bus_->take_second();
        for (std::size_t j = 0; j < there_.size(); ++j) {
            run.present_error_veh += std::abs(static_cast<double>(second.told.present_veh[j]) - there_[j]);
        }
        const auto doubted = [](const Record &record) {
            return std::any_of(record.lanes.begin(), record.lanes.end(),
                               [](const LaneRecord &lane) { return !lane.valid; });
        };
        run.doubted_s += std::any_of(noted.records.begin(), noted.records.end(), doubted) ? 1U : 0U;
        if (log_) {
            loop_.log(log_->out(), second, noted, there_);
        }
        std::fill(there_.begin(), there_.end(), 0);
        for (const auto &film : films_) {
            const auto some = film->present(places_);
            std::transform(there_.begin(), there_.end(), some.begin(), there_.begin(), std::plus<>());
        }
    }

    LoopProgram &loop_;
    std::vector<std::unique_ptr<Film>> films_;
    StreetPlan plan_;
    Places follower_;
    std::vector<Place> places_;
    StreetBus *bus_ = nullptr;
    std::unique_ptr<Chain> chain_;
    std::optional<WholeFile> log_;
    std::vector<int> there_; ///< [movement] in truth
    bool begun_ = false;
};

void LoopProgram::log(std::ostream &out, const Second &second, const BusSecond &bus,
                      const std::vector<int> &there) const {
    Json line{{"t_s", second.t_s},
              {"mode", bus.silent ? "silent" : mode_name(second.told.mode)},
              {"fault", elmopp_fault_name(second.told.fault)},
              {"stage", second.told.stage}};
    Json cameras = Json::object();
    for (std::size_t c = 0; c < bus.records.size(); ++c) {
        // The worst of its lanes: a fault of the camera before "learning".
        Reason worst = Reason::ok;
        for (const LaneRecord &lane : bus.records[c].lanes) {
            worst = std::max(worst, lane.reason);
        }
        cameras[camera_names_[c]] = reason_name(worst);
    }
    line["cameras"] = cameras;
    line["present"] = std::vector<float>(second.told.present_veh, second.told.present_veh + site_.movement_count);
    line["true"] = there;
    Json lamps = Json::array();
    for (const elmopp_lamps_t &shown : bus.shown) {
        lamps.push_back(aspects_of(shown, site_));
    }
    line["lamps"] = lamps;
    line["lost"] = bus.lost;
    line["reset"] = bus.reset;
    out << line.dump() << "\n";
}

void LoopProgram::write(const Run &perfect, const Run &camera, const Findings &found) const {
    Json lanes = Json::array();
    std::int64_t wrong = 0;
    std::int64_t crossed = 0;
    for (const LaneTally &lane : camera.lanes) {
        lanes.push_back({{"lane", lane.lane}, {"true", lane.crossed}, {"counted", lane.counted}});
        wrong += std::abs(lane.crossed - lane.counted);
        crossed += lane.crossed;
    }
    const Json result{{"lanes", lanes},
                      {"delay_camera_s", camera.metrics.mean_delay_s},
                      {"delay_perfect_s", perfect.metrics.mean_delay_s},
                      {"lane_error", crossed > 0 ? static_cast<double>(wrong) / static_cast<double>(crossed) : 0.0},
                      {"present_error_veh", camera.present_error_veh},
                      {"longest_red_camera_s", camera.metrics.longest_red_s},
                      {"longest_red_perfect_s", perfect.metrics.longest_red_s},
                      {"vehicles_in", camera.metrics.vehicles_in},
                      {"vehicles_out_camera", camera.metrics.vehicles_out},
                      {"vehicles_out_perfect", perfect.metrics.vehicles_out},
                      {"doubted_s", camera.doubted_s},
                      {"lamp_ticks", found.ticks},
                      {"conflicts", found.conflicts},
                      {"early_greens", found.early_greens},
                      {"short_ambers", found.short_ambers},
                      {"site", site_.name},
                      {"chooser", full_name(chooser_.label(), chooser_.forecast)},
                      {"demand", request_.demand},
                      {"vehicles", request_.vehicles},
                      {"seed", request_.seed},
                      {"seconds", request_.seconds},
                      {"scene", request_.scene},
                      {"link", request_.link.substr(0, request_.link.find(':'))},
                      {"faults", request_.faults}};
    WholeFile out("--out", request_.out / "closed_loop.json");
    out.out() << result.dump(1) << "\n";
    out.commit();
}

std::vector<std::unique_ptr<Film>> LoopProgram::films() const {
    std::vector<std::unique_ptr<Film>> films;
    for (std::size_t i = 0; i < site_.approach_count; ++i) {
        if (elmopp_mask_has(site_.cameras, static_cast<std::uint32_t>(i))) {
            const std::string name = std::begin(site_.approach_name[i]);
            films.push_back(std::make_unique<Film>(scenario_.junction, i, request_.scene, request_.seed * 100 + i,
                                                   request_.out / (name + ".lanes.json")));
        }
    }
    return films;
}

Run LoopProgram::drive(bool with_cameras) {
    StreetRun street(*this, with_cameras);
    return street.run();
}

} // namespace

void run_loop(const LoopRequest &request) {
    LoopProgram(request).run();
}

} // namespace elmopp
