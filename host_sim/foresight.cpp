// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "foresight.hpp"

#include "autoregression.hpp"
#include "choosers.hpp"
#include "error.hpp"
#include "learning.hpp"
#include "scenario.hpp"
#include "trial.hpp"

namespace elmopp {
namespace {

/// A chooser that names the first stage and keeps the rows.
elmopp_stage_t write_down(void *state, const elmopp_view_t *view, float * /*score*/) {
    auto &foresight = *static_cast<Foresight *>(state);
    for (std::size_t i = 0; i < foresight.approaches; ++i) {
        const float *row = view->foreseen_veh[i];
        foresight.unit_veh.insert(foresight.unit_veh.end(), row, row + foresight.steps);
    }
    return 0;
}

} // namespace

Foresight foresee(const Foreseen &asked) {
    const Scenario scenario = make_scenario(find_profile("paper"), nullptr);
    Foresight foresight{asked.steps, asked.unit.size(), {}, 0};
    foresight.unit_veh.reserve(asked.seconds * asked.unit.size() * asked.steps);
    const Demand demand = make_demand(asked.unit, 1.0, training_points, {}, true, asked.seconds);
    const elmopp_chooser_t chooser{write_down, &foresight, asked.steps};
    const auto learning = make_learning(asked.forecast, &asked.weights, scenario.junction.approach_count);
    const elmopp_forecast_config_t config{forecast_kind(asked.forecast), nullptr,
                                          demand.mean_veh_per_s.data(),  &asked.weights,
                                          learner_of(learning),          false};
    elmopp_pilot_t pilot;
    elmopp_pilot_init(&pilot, &scenario.junction, &chooser, &config);
    Arrivals arrivals(scenario, demand);
    for (std::size_t point = demand.origin - asked.known_s; point < demand.origin; ++point) {
        elmopp_pilot_absorb(&pilot, arrivals.at(point));
    }
    const std::vector<float> nobody(scenario.junction.movement_count, 0.0F);
    for (std::size_t t = 0; t < asked.seconds; ++t) {
        const elmopp_counts_t counts{nobody.data(), arrivals.at(demand.origin + t), 0U, nullptr};
        if (!elmopp_pilot_step(&pilot, &counts, nullptr)) {
            throw Failure("second " + std::to_string(t) + ": the pilot refused the counts");
        }
        elmopp_pilot_learn(&pilot);
        foresight.distrusted_s += pilot.foresight == ELMOPP_FORESIGHT_DISTRUSTED ? 1U : 0U;
    }
    return foresight;
}

} // namespace elmopp
