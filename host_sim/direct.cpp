// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "error.hpp"
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
        const elmopp_forecast_config_t config = forecast_of(spec, demand);
        elmopp_pilot_init(&pilot_, &scenario.junction, &plugged_->chooser, &config);
        if (demand.announced != nullptr) {
            elmopp_forecast_init(&base_, &scenario.junction, &config);
        }
        Arrivals(scenario, demand).absorb_known(pilot_, 0);
    }

    void count(const Counted &world, std::size_t t_s) override {
        for (std::size_t j = 0; j < present_veh_.size(); ++j) {
            present_veh_[j] = static_cast<float>(world.queue_veh()[j]);
            arrived_veh_[j] = static_cast<float>(world.arrived_veh()[j]);
        }
        occupied_ = world.junction_occupied().value_or(false);
        const elmopp_counts_t counts{present_veh_.data(), arrived_veh_.data(), 0U};
        const bool told = demand_.announced != nullptr;
        const bool given = oracle_ || told || demand_.foresight != nullptr;
        const elmopp_foreseen_t foreseen = told    ? rows_with_neighbours(t_s)
                                           : given ? rows_from_outside(t_s)
                                                   : elmopp_foreseen_t{};
        if (!elmopp_pilot_step(&pilot_, &counts, given ? &foreseen : nullptr)) {
            throw Failure("second " + std::to_string(t_s) + ": the pilot refused the counts");
        }
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

    /// The forecast's rows, told what the neighbours have announced: as long as the road takes, nobody comes whom they
    /// do not know of. Without a forecast, and with the oracle's, it is laid over their beginning here.
    elmopp_foreseen_t rows_with_neighbours(std::size_t t_s) {
        elmopp_foreseen_t foreseen{};
        const float *rows[ELMOPP_APPROACH_MAX] = {};
        elmopp_forecast_observe(&base_, arrived_veh_.data());
        for (std::uint32_t i = 0; i < scenario_.junction.approach_count; ++i) {
            if ((*demand_.announced)[i].is_announced) {
                announce((*demand_.announced)[i], told_veh_[i]);
                elmopp_forecast_tell(&base_, i, told_veh_[i].data(), sure_of((*demand_.announced)[i]));
            }
        }
        (void)elmopp_forecast_look(&base_, ELMOPP_HORIZON_MAX, rows);
        foreseen.steps = ELMOPP_HORIZON_MAX;
        for (std::size_t i = 0; i < scenario_.junction.approach_count; ++i) {
            const float *row = oracle_ ? &demand_.future_veh[i][t_s] : rows[i];
            if (row == nullptr) {
                scaled_veh_[i].fill(0.0F); // forecast none
            } else {
                std::copy_n(row, scaled_veh_[i].size(), scaled_veh_[i].begin());
            }
            if ((*demand_.announced)[i].is_announced) {
                std::copy_n(told_veh_[i].begin(), sure_of((*demand_.announced)[i]), scaled_veh_[i].begin());
            }
            foreseen.row_veh[i] = scaled_veh_[i].data();
        }
        return foreseen;
    }

    /// The seconds of which an announcement says who comes.
    static std::uint16_t sure_of(const Announced &announced) {
        return static_cast<std::uint16_t>(std::min<std::size_t>(announced_span_s, announced.sure_s));
    }

    static constexpr std::size_t announced_span_s = 60; ///< of NeighbourOutflow
    using Row = std::array<float, ELMOPP_HORIZON_MAX>;

    /// The vehicles of each span of the frame, evenly over its seconds as far as they are sure.
    static void announce(const Announced &announced, Row &row) {
        const auto spread = [&](std::size_t from_s, std::size_t until_s, unsigned tenths) {
            const std::size_t end_s = std::min(until_s, announced.sure_s);
            for (std::size_t k = from_s; k < end_s; ++k) {
                row[k] = static_cast<float>(tenths) / (10.0F * static_cast<float>(end_s - from_s));
            }
        };
        const Outflow &outflow = announced.outflow;
        spread(0, 10, outflow.next10);
        spread(10, 30, outflow.next30 - outflow.next10);
        spread(30, announced_span_s, outflow.next60 - outflow.next30);
    }

    const Scenario &scenario_;
    const Demand &demand_;
    bool oracle_;
    bool occupied_ = false;
    std::unique_ptr<Plugged> plugged_;
    std::array<std::array<float, ELMOPP_HORIZON_MAX>, ELMOPP_APPROACH_MAX> scaled_veh_{};
    std::array<std::array<float, ELMOPP_HORIZON_MAX>, ELMOPP_APPROACH_MAX> told_veh_{};
    elmopp_pilot_t pilot_{};
    elmopp_forecast_t base_{}; ///< as the pilot's own, for rows that neighbours add to
    std::vector<float> present_veh_;
    std::vector<float> arrived_veh_;
};

} // namespace

std::unique_ptr<Control> make_direct(const Scenario &scenario, const ChooserSpec &spec, const Demand &demand) {
    return std::make_unique<Direct>(scenario, spec, demand);
}

} // namespace elmopp
