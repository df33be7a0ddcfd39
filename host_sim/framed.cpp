// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "error.hpp"
#include "jobs.hpp"
#include "learning.hpp"
#include "networks.hpp"
#include "trial.hpp"

extern "C" {
#include "bus_clock.h"
#include "elmopp/sight.h"
#include "elmopp_can.h"
}

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

namespace elmopp {
namespace {

constexpr std::size_t self_test_and_cameras_s = 15; ///< what a start-up takes beyond the site's own times
constexpr float forecast_unit_veh = 0.1F;           ///< of the DBC
constexpr unsigned occupancy_every = ELMOPP_CAN_JUNCTION_OCCUPIED_CYCLE_TIME_MS / ELMOPP_CONTROLLER_TICK_MS;
constexpr double most_present_veh = ELMOPP_DETECTOR_UNKNOWN - 1U;

/// Everything on the bus that is not the controller: cameras that count without mistakes, lamp nodes that do as told.
class Street {
  public:
    explicit Street(const elmopp_junction_t &junction) : junction_(junction), total_veh_(junction.movement_count) {}

    /// One second of arrivals; the frames of every camera.
    std::vector<elmopp_frame_t> counts(const std::vector<double> &present_veh, const std::vector<double> &arrived_veh) {
        for (std::size_t j = 0; j < total_veh_.size(); ++j) {
            total_veh_[j] += arrived_veh[j];
        }
        std::vector<elmopp_frame_t> frames;
        for (std::uint32_t i = 0; i < junction_.approach_count; ++i) {
            if (elmopp_mask_has(junction_.cameras, i)) {
                frames.push_back(counts_of(i, present_veh));
                elmopp_link_seal(&frames.back(), &camera_counter_[i]);
            }
        }
        return frames;
    }

    /// What a gateway to the neighbours sends once a second.
    std::vector<elmopp_frame_t> outflow(const Announced &announced) {
        std::vector<elmopp_frame_t> frames;
        for (std::uint32_t i = 0; i < junction_.approach_count; ++i) {
            if (announced.at(i).ahead_s > 0) {
                frames.push_back(elmopp_frames_make_outflow(i, &announced.at(i)));
                elmopp_link_seal(&frames.back(), &gateway_counter_.at(i));
            }
        }
        return frames;
    }

    /// What the junction camera sends in a lamp tick: one frame in two, to a site that listens.
    std::vector<elmopp_frame_t> occupancy(std::optional<bool> occupied) {
        std::vector<elmopp_frame_t> frames;
        if (occupied && junction_.junction_wait_ds > 0 && occupancy_ticks_++ % occupancy_every == 0) {
            const elmopp_occupancy_t sign{*occupied, true, ELMOPP_REASON_OK};
            frames.push_back(elmopp_frames_make_occupancy(&sign));
            elmopp_link_seal(&frames.back(), &occupancy_counter_);
        }
        return frames;
    }

    /// What the lamps show, as every node reports it.
    std::vector<elmopp_frame_t> feedback(const elmopp_lamps_t &lamps, const Link &link) {
        std::vector<elmopp_frame_t> frames;
        for (std::uint32_t n = 0; n < ELMOPP_NODE_MAX; ++n) {
            const std::uint16_t groups = elmopp_junction_groups_of_node(&junction_, n);
            if (groups != 0 && !link.has_node(n)) {
                frames.push_back(feedback_of(n, groups, lamps));
                elmopp_link_seal(&frames.back(), &node_counter_[n]);
            }
        }
        return frames;
    }

  private:
    [[nodiscard]] elmopp_frame_t counts_of(std::uint32_t approach, const std::vector<double> &present_veh) const {
        std::array<elmopp_detector_report_t, ELMOPP_APPROACH_MOVEMENT_MAX> report{};
        std::size_t slot = 0;
        for (std::size_t j = 0; j < total_veh_.size(); ++j) {
            if (junction_.movement[j].approach == approach) {
                const double seen = std::min(std::floor(present_veh[j] + 0.5), most_present_veh);
                const double modulo = std::fmod(std::floor(total_veh_[j]), ELMOPP_DETECTOR_MODULO);
                report.at(slot) = {static_cast<std::uint16_t>(seen), static_cast<std::uint8_t>(modulo), true};
                ++slot;
            }
        }
        return elmopp_frames_make_counts(approach, report.data(), ELMOPP_REASON_OK);
    }

    [[nodiscard]] static elmopp_frame_t feedback_of(std::uint32_t node, std::uint16_t groups, elmopp_lamps_t lamps) {
        const auto only = [groups](std::uint16_t mask) { return static_cast<std::uint16_t>(mask & groups); };
        const elmopp_feedback_t feedback{{only(lamps.red), only(lamps.amber), only(lamps.green), 0}, false, false};
        return elmopp_frames_make_feedback(node, &feedback);
    }

    const elmopp_junction_t &junction_;
    std::vector<double> total_veh_;
    std::array<std::uint8_t, ELMOPP_APPROACH_MAX> camera_counter_{};
    std::array<std::uint8_t, ELMOPP_NODE_MAX> node_counter_{};
    std::array<std::uint8_t, ELMOPP_APPROACH_MAX> gateway_counter_{};
    std::uint8_t occupancy_counter_ = 0;
    unsigned occupancy_ticks_ = 0;
};

/// What the frames say of the controller, for the log.
class Heard {
  public:
    /// Counts as the cameras sent them: where no DecisionTrace comes, the best that is known.
    void sent(std::size_t movement, double present_veh, double arrived_veh) {
        present_veh_.at(movement) = static_cast<float>(present_veh);
        arrived_veh_.at(movement) = static_cast<float>(arrived_veh);
    }

    void hear(const elmopp_frame_t &frame) {
        const unsigned approach = frame.id - ELMOPP_CAN_FORECAST_FRAME_ID;
        if (elmopp_frames_lamps(&frame, &lamps_)) {
            return;
        }
        if (frame.id == ELMOPP_CAN_CONTROLLER_STATUS_FRAME_ID) {
            hear_status(frame);
        } else if (approach < ELMOPP_APPROACH_MAX) {
            hear_forecast(frame, approach);
        } else if (frame.id == ELMOPP_CAN_DECISION_TRACE_FRAME_ID) {
            hear_trace(elmopp_bus_clock_read(&frame));
        }
    }

    [[nodiscard]] const elmopp_lamps_t &lamps() const {
        return lamps_;
    }

    [[nodiscard]] Told told() const {
        return {stage_,
                mode_,
                fault_,
                foresight_,
                present_veh_.data(),
                arrived_veh_.data(),
                score_.data(),
                foreseen_veh_.data()};
    }

  private:
    void hear_status(const elmopp_frame_t &frame) {
        elmopp_can_controller_status_t status{};
        (void)elmopp_can_controller_status_unpack(&status, std::begin(frame.data), ELMOPP_LINK_BYTES);
        stage_ = status.stage < ELMOPP_STAGE_MAX ? status.stage : static_cast<elmopp_stage_t>(ELMOPP_STAGE_NONE);
        mode_ = static_cast<elmopp_mode_t>(status.mode);
        fault_ = static_cast<elmopp_fault_t>(status.first_fault);
    }

    void hear_forecast(const elmopp_frame_t &frame, unsigned approach) {
        elmopp_can_forecast_t forecast{};
        (void)elmopp_can_forecast_unpack(&forecast, std::begin(frame.data), ELMOPP_LINK_BYTES);
        foreseen_veh_.at(approach) = static_cast<float>(forecast.next60) * forecast_unit_veh;
        static const std::map<unsigned, elmopp_foresight_t> others{
            {ELMOPP_MODEL_GIVEN, ELMOPP_FORESIGHT_GIVEN},
            {ELMOPP_MODEL_COLD, ELMOPP_FORESIGHT_COLD},
            {ELMOPP_MODEL_UNARMED, ELMOPP_FORESIGHT_UNARMED},
            {ELMOPP_MODEL_DISTRUSTED, ELMOPP_FORESIGHT_DISTRUSTED}};
        const auto found = others.find(forecast.model);
        foresight_ = found == others.end() ? ELMOPP_FORESIGHT_OWN : found->second;
    }

    /// DecisionTrace is more exact than Forecast and comes after it.
    void hear_trace(const elmopp_trace_t &trace) {
        const auto keep = [&trace](auto &values) {
            if (trace.index < values.size()) {
                values[trace.index] = trace.value;
            }
        };
        switch (trace.kind) {
        case ELMOPP_TRACE_SCORE:
            return keep(score_);
        case ELMOPP_TRACE_FORECAST:
            return keep(foreseen_veh_);
        case ELMOPP_TRACE_PRESENT:
            return keep(present_veh_);
        case ELMOPP_TRACE_ARRIVED:
            return keep(arrived_veh_);
        default:
            return;
        }
    }

    elmopp_lamps_t lamps_{};
    elmopp_stage_t stage_ = ELMOPP_STAGE_NONE;
    elmopp_mode_t mode_ = ELMOPP_MODE_STARTING;
    elmopp_fault_t fault_ = ELMOPP_FAULT_NONE;
    elmopp_foresight_t foresight_ = ELMOPP_FORESIGHT_OWN;
    std::array<float, ELMOPP_MOVEMENT_MAX> present_veh_{};
    std::array<float, ELMOPP_MOVEMENT_MAX> arrived_veh_{};
    std::array<float, ELMOPP_STAGE_MAX> score_{};
    std::array<float, ELMOPP_APPROACH_MAX> foreseen_veh_{};
};

class Framed final : public Control {
  public:
    Framed(const Scenario &scenario, const Demand &demand, std::unique_ptr<Link> link)
        : link_(std::move(link)), street_(scenario.junction), announced_(demand.announced) {
        start(scenario, demand);
    }

    void count(const Counted &world, std::size_t /*t_s*/) override {
        occupied_ = world.junction_occupied();
        count(world.queue_veh(), world.arrived_veh());
        if (announced_ != nullptr) {
            const auto frames = street_.outflow(*announced_);
            pending_.insert(pending_.end(), frames.begin(), frames.end());
        }
    }

    elmopp_lamps_t lamp_tick() override {
        for (const auto &frame : street_.feedback(heard_.lamps(), *link_)) {
            pending_.push_back(frame);
        }
        for (const auto &frame : street_.occupancy(occupied_)) {
            pending_.push_back(frame);
        }
        now_ms_ += ELMOPP_CONTROLLER_TICK_MS;
        for (const auto &frame : link_->tick(pending_, now_ms_)) {
            heard_.hear(frame);
        }
        pending_.clear();
        return heard_.lamps();
    }

    [[nodiscard]] Told told() const override {
        return heard_.told();
    }

  private:
    void count(const std::vector<double> &present_veh, const std::vector<double> &arrived_veh) {
        pending_ = street_.counts(present_veh, arrived_veh);
        for (std::size_t j = 0; j < present_veh.size(); ++j) {
            heard_.sent(j, present_veh[j], arrived_veh[j]);
        }
    }

    /// The seconds before second 0, with the arrivals that are known of them but nobody waiting.
    void start(const Scenario &scenario, const Demand &demand) {
        const elmopp_junction_t &junction = scenario.junction;
        const std::size_t own_ds =
            junction.start_flash_ds + junction.start_red_ds + elmopp_junction_change_ds(&junction);
        const std::size_t start_s = self_test_and_cameras_s + own_ds / ELMOPP_LAMP_TICKS_PER_S + 1;
        const std::vector<double> nobody(junction.movement_count);
        Arrivals arrivals(scenario, demand);
        // Nobody knows the past of a network: a replay of nothing would teach the forecasts that nobody comes.
        const std::size_t history_s = demand.veh_per_s[0].empty() ? 0 : link_->history_s();
        for (std::size_t t = std::max(start_s, history_s); t > 0; --t) {
            std::vector<double> arrived = nobody;
            if (demand.origin >= t) {
                std::copy_n(arrivals.at(demand.origin - t), arrived.size(), arrived.begin());
            }
            count(nobody, arrived);
            for (unsigned tick = 0; tick < ELMOPP_LAMP_TICKS_PER_S; ++tick) {
                lamp_tick();
            }
            check_interrupt();
        }
        if (told().mode != ELMOPP_MODE_AUTOMATIC) {
            throw Failure(std::string("the controller did not get to automatic mode; fault: ") +
                          elmopp_fault_name(told().fault));
        }
    }

    std::unique_ptr<Link> link_;
    Street street_;
    const Announced *announced_; ///< null: no neighbour speaks
    Heard heard_;
    std::vector<elmopp_frame_t> pending_;
    std::optional<bool> occupied_; ///< nothing: nobody knows
    elmopp_ms_t now_ms_ = 0;
};

/// A street's rollout counts with the time that the reach takes to drive and with what a stop costs, as the station
/// sets it, whatever is simulated behind the frames; the fluid, in which nobody drives, tells it of neither.
Setting street_setting(const Scenario &scenario, const ChooserSpec &spec) {
    Setting setting = scenario.setting();
    setting.stops_free = false;
    if (spec.name == "rollout") {
        const elmopp_sight_options_t sight = elmopp_sight_of_site(&scenario.junction);
        std::copy(std::begin(sight.travel_s), std::end(sight.travel_s), setting.travel_s.begin());
    }
    return setting;
}

/// The controller in this process.
class InProcess final : public Link {
  public:
    InProcess(const Scenario &scenario, const ChooserSpec &spec, const Demand &demand, Refused refused)
        : refused_(refused), setting_(street_setting(scenario, spec)), plugged_(make_chooser(spec, setting_)),
          ar8_(scenario.junction.approach_count, shipped_weights("lstm")->ar8) {
        elmopp_forecast_config_t forecast = forecast_of(spec, demand);
        forecast.ar8 = ar8_.data();
        forecast.mean_veh_per_s = nullptr;
        learning_ = make_learning(spec.forecast, forecast.weights, scenario.junction.approach_count);
        forecast.learner = learner_of(learning_);
        const elmopp_controller_config_t config{&scenario.junction, plugged_->chooser, forecast};
        elmopp_controller_init(&controller_, &config);
    }

    std::vector<elmopp_frame_t> tick(const std::vector<elmopp_frame_t> &frames, elmopp_ms_t now_ms) override {
        for (const auto &frame : frames) {
            if (!elmopp_controller_take(&controller_, &frame) && refused_ == Refused::mistake) {
                throw Failure("the controller refused a frame of the simulator's");
            }
        }
        std::vector<elmopp_frame_t> out(ELMOPP_FRAMES_PER_TICK + ELMOPP_TRACE_MAX);
        const std::uint32_t count = elmopp_controller_tick(&controller_, now_ms, out.data());
        const bool decided = elmopp_bus_clock_decided(out.data(), count);
        const std::uint32_t traced = decided ? elmopp_bus_clock_trace(&controller_, &trace_counter_, &out[count]) : 0U;
        out.resize(count + traced);
        return out;
    }

    [[nodiscard]] bool has_node(std::uint32_t /*node*/) const override {
        return false;
    }

    [[nodiscard]] std::size_t history_s() const override {
        return ELMOPP_FORECAST_MEAN_WINDOW_S;
    }

  private:
    Refused refused_;
    Setting setting_;
    std::unique_ptr<Plugged> plugged_;
    std::vector<elmopp_ar8_t> ar8_;
    std::unique_ptr<Learning> learning_;
    elmopp_controller_t controller_{};
    std::uint8_t trace_counter_ = 0;
};

} // namespace

std::unique_ptr<Link> make_inproc(const Scenario &scenario, const ChooserSpec &spec, const Demand &demand,
                                  Refused refused) {
    return std::make_unique<InProcess>(scenario, spec, demand, refused);
}

std::unique_ptr<Control> make_framed(const Scenario &scenario, const ChooserSpec &spec, const Demand &demand,
                                     std::unique_ptr<Link> link) {
    if (spec.forecast == "oracle") {
        throw BadRequest("--link with forecast oracle: no frame carries the future; right would be any other forecast");
    }
    return std::make_unique<Framed>(scenario, demand, std::move(link));
}

} // namespace elmopp
