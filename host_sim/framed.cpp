// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "error.hpp"
#include "trial.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace elmopp {
namespace {

constexpr std::size_t self_test_and_cameras_s = 15; ///< what a start-up takes beyond the site's own times
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

    /// What the lamps show, as every node reports it.
    std::vector<elmopp_frame_t> feedback(const elmopp_lamps_t &lamps) {
        std::vector<elmopp_frame_t> frames;
        for (std::uint32_t n = 0; n < ELMOPP_NODE_MAX; ++n) {
            const std::uint16_t groups = groups_of(n);
            if (groups != 0) {
                frames.push_back(feedback_of(n, groups, lamps));
                elmopp_link_seal(&frames.back(), &node_counter_[n]);
            }
        }
        return frames;
    }

  private:
    [[nodiscard]] std::uint16_t groups_of(std::uint32_t node) const {
        unsigned groups = 0;
        for (unsigned g = 0; g < junction_.group_count; ++g) {
            groups |= junction_.group[g].node == node ? 1U << g : 0U;
        }
        return static_cast<std::uint16_t>(groups);
    }

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
};

class Framed final : public Control {
  public:
    Framed(const Scenario &scenario, const ChooserSpec &spec, const Demand &demand)
        : plugged_(make_chooser(spec, scenario)), street_(scenario.junction) {
        const elmopp_controller_config_t config{&scenario.junction, plugged_->chooser, forecast_of(spec, demand)};
        elmopp_controller_init(&controller_, &config);
        start(scenario, demand);
    }

    void count(const Traffic &traffic, std::size_t /*t_s*/) override {
        offer(street_.counts(traffic.queue_veh(), traffic.arrived_veh()));
    }

    elmopp_lamps_t lamp_tick() override {
        offer(street_.feedback(lamps_));
        std::array<elmopp_frame_t, ELMOPP_FRAMES_PER_TICK> out{};
        now_ms_ += ELMOPP_CONTROLLER_TICK_MS;
        const std::uint32_t count = elmopp_controller_tick(&controller_, now_ms_, out.data());
        for (std::uint32_t k = 0; k < count; ++k) {
            // The lamps are those of the bus, not those that the controller remembers.
            elmopp_frames_lamps(&out.at(k), &lamps_);
        }
        return lamps_;
    }

    [[nodiscard]] const elmopp_pilot_t &pilot() const override {
        return controller_.pilot;
    }
    [[nodiscard]] const float *present_veh() const override {
        return controller_.present_veh;
    }
    [[nodiscard]] const float *arrived_veh() const override {
        return controller_.arrived_veh;
    }
    [[nodiscard]] elmopp_mode_t mode() const override {
        return controller_.mode;
    }
    [[nodiscard]] elmopp_fault_t fault() const override {
        return controller_.fault;
    }

  private:
    void offer(const std::vector<elmopp_frame_t> &frames) {
        for (const auto &frame : frames) {
            if (!elmopp_controller_take(&controller_, &frame)) {
                throw Failure("the controller refused a frame of the simulator's");
            }
        }
    }

    /// The seconds before second 0, with the arrivals that are known of them but nobody waiting.
    void start(const Scenario &scenario, const Demand &demand) {
        const elmopp_junction_t &junction = scenario.junction;
        const std::size_t own_ds =
            junction.start_flash_ds + junction.start_red_ds + elmopp_junction_change_ds(&junction);
        const std::size_t before_s = self_test_and_cameras_s + own_ds / ELMOPP_LAMP_TICKS_PER_S + 1;
        Arrivals arrivals(scenario, demand);
        arrivals.absorb_known(controller_.pilot, before_s);
        const std::vector<double> nobody(junction.movement_count);
        for (std::size_t t = before_s; t > 0; --t) {
            std::vector<double> arrived = nobody;
            if (demand.origin >= t) {
                std::copy_n(arrivals.at(demand.origin - t), arrived.size(), arrived.begin());
            }
            offer(street_.counts(nobody, arrived));
            for (unsigned tick = 0; tick < ELMOPP_LAMP_TICKS_PER_S; ++tick) {
                lamp_tick();
            }
        }
        if (controller_.mode != ELMOPP_MODE_AUTOMATIC) {
            throw Failure(std::string("the controller did not get to automatic mode; fault: ") +
                          elmopp_fault_name(controller_.fault));
        }
    }

    std::unique_ptr<Plugged> plugged_;
    Street street_;
    elmopp_controller_t controller_{};
    elmopp_lamps_t lamps_{};
    elmopp_ms_t now_ms_ = 0;
};

} // namespace

std::unique_ptr<Control> make_framed(const Scenario &scenario, const ChooserSpec &spec, const Demand &demand) {
    if (spec.forecast == "oracle") {
        throw BadRequest("--link with forecast oracle: no frame carries the future; right would be any other forecast");
    }
    return std::make_unique<Framed>(scenario, spec, demand);
}

} // namespace elmopp
