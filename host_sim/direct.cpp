// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "error.hpp"
#include "learning.hpp"
#include "trial.hpp"

#include <algorithm>
#include <array>

namespace elmopp {
namespace {

class Direct final : public Control {
  public:
    Direct(const Scenario &scenario, const ChooserSpec &spec, const Demand &demand)
        : scenario_(scenario), demand_(demand), oracle_(spec.forecast == "oracle"),
          plugged_(make_chooser(spec, scenario.setting())), present_veh_(scenario.capacity_veh.size()),
          arrived_veh_(scenario.capacity_veh.size()) {
        elmopp_forecast_config_t config = forecast_of(spec, demand);
        if (demand.foresight == nullptr) {
            learning_ = make_learning(spec.forecast, config.weights, scenario.junction.approach_count);
            config.learner = learner_of(learning_);
        }
        elmopp_pilot_init(&pilot_, &scenario.junction, &plugged_->chooser, &config);
        Arrivals(scenario, demand).absorb_known(pilot_, 0);
    }

    void count(const Counted &world, std::size_t t_s) override {
        for (std::size_t j = 0; j < present_veh_.size(); ++j) {
            present_veh_[j] = static_cast<float>(world.queue_veh()[j]);
            arrived_veh_[j] = static_cast<float>(world.arrived_veh()[j]);
        }
        occupied_ = world.junction_occupied().value_or(false);
        const elmopp_counts_t counts{present_veh_.data(), arrived_veh_.data(), 0U,
                                     demand_.announced != nullptr ? demand_.announced->data() : nullptr};
        const bool given = oracle_ || demand_.foresight != nullptr;
        const elmopp_foreseen_t foreseen = given ? rows_from_outside(t_s) : elmopp_foreseen_t{};
        if (!elmopp_pilot_step(&pilot_, &counts, given ? &foreseen : nullptr)) {
            throw Failure("second " + std::to_string(t_s) + ": the pilot refused the counts");
        }
        elmopp_pilot_look_on(&pilot_);
    }

    elmopp_lamps_t lamp_tick() override {
        return elmopp_pilot_lamp_tick(&pilot_, pilot_.wanted, occupied_);
    }

    [[nodiscard]] Told told() const override {
        return {pilot_.plan.stage,   ELMOPP_MODE_COUNT,   ELMOPP_FAULT_NONE, pilot_.foresight,
                present_veh_.data(), arrived_veh_.data(), pilot_.score,      pilot_.foreseen_sum_veh};
    }

  private:
    elmopp_foreseen_t rows_from_outside(std::size_t t_s) {
        elmopp_foreseen_t foreseen{};
        foreseen.steps = oracle_ ? std::uint16_t{ELMOPP_HORIZON_MAX} : demand_.foresight->steps;
        for (std::size_t i = 0; i < scenario_.junction.approach_count; ++i) {
            if (oracle_) {
                foreseen.row_veh[i] = &demand_.future_veh[i][t_s];
                continue;
            }
            const float *unit = demand_.foresight->row(t_s, i);
            const auto scale = static_cast<float>(demand_.vehicles_per_approach);
            std::transform(unit, unit + foreseen.steps, scaled_veh_[i].begin(),
                           [scale](float value) { return value * scale; });
            foreseen.row_veh[i] = scaled_veh_[i].data();
        }
        return foreseen;
    }

    const Scenario &scenario_;
    const Demand &demand_;
    bool oracle_;
    bool occupied_ = false;
    std::unique_ptr<Plugged> plugged_;
    std::array<std::array<float, ELMOPP_HORIZON_MAX>, ELMOPP_APPROACH_MAX> scaled_veh_{};
    std::array<std::array<float, ELMOPP_HORIZON_MAX>, ELMOPP_APPROACH_MAX> told_veh_{};
    std::unique_ptr<Learning> learning_;
    elmopp_pilot_t pilot_{};
    std::vector<float> present_veh_;
    std::vector<float> arrived_veh_;
};

} // namespace

std::unique_ptr<Control> make_direct(const Scenario &scenario, const ChooserSpec &spec, const Demand &demand) {
    return std::make_unique<Direct>(scenario, spec, demand);
}

} // namespace elmopp
