// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "elmopp.h"

#include "choosers.hpp"
#include "core.hpp"
#include "error.hpp"
#include "learning.hpp"
#include "networks.hpp"
#include "sites.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <optional>
#include <string>

namespace elmopp {
/// Vehicles beyond the junction, a value a movement.
using Downstream = std::array<float, ELMOPP_MOVEMENT_MAX>;

/// What neighbours announce, a value an approach.
using Outflows = std::array<elmopp_outflow_t, ELMOPP_APPROACH_MAX>;
} // namespace elmopp

/// One junction. Not movable: pilot and chooser point into it.
struct elmopp_handle {
    elmopp_junction_t junction{};
    elmopp_weights_t weights{};
    std::array<elmopp_ar8_t, ELMOPP_APPROACH_MAX> ar8{};
    elmopp::Downstream downstream_veh{};
    std::unique_ptr<elmopp::Plugged> plugged;
    std::unique_ptr<elmopp::Learning> learning;
    elmopp_pilot_t pilot{};
    elmopp_monitor_t monitor{};
    bool oracle = false; ///< the caller foresees
    bool occupied = false;
};

namespace elmopp {
namespace {

/// A caller's struct of a size that it may have. `needed`: members without which nothing can be done.
template <typename Struct> bool is_of_known_size(const Struct *given, std::size_t needed) {
    return given != nullptr && given->size >= needed && given->size <= sizeof(Struct);
}

/// The same in our size: what an older caller does not know is zero.
template <typename Struct> Struct in_our_size(const Struct &given) {
    Struct ours{};
    std::memcpy(&ours, &given, given.size);
    return ours;
}

elmopp_options_t known_options(const elmopp_options_t *given) {
    if (!is_of_known_size(given, offsetof(elmopp_options_t, chooser))) {
        throw BadRequest(std::string("options.size is ") +
                         (given == nullptr ? "missing" : std::to_string(given->size)) + "; right would be " +
                         std::to_string(sizeof *given) + ", the size of the struct in this library");
    }
    return in_our_size(*given);
}

std::uint16_t groups_that_exist(const elmopp_handle &self) {
    return elmopp_junction_groups(&self.junction);
}

/// What is shown once the monitor has given its verdict: the plan's lamps, or the site's flashing.
elmopp_lamps_t judged(elmopp_handle &self, const elmopp_lamps_t &lamps) {
    const elmopp_monitor_input_t input{lamps, lamps, groups_that_exist(self), ELMOPP_MODE_AUTOMATIC};
    return elmopp_monitor_check(&self.monitor, &input) == ELMOPP_FAULT_NONE
               ? lamps
               : elmopp_lamps_flashing(&self.junction, groups_that_exist(self));
}

const elmopp_weights_t *weights_of(elmopp_handle &self, const elmopp_options_t &options, const std::string &forecast) {
    if (options.weights == nullptr) {
        return shipped_weights(forecast);
    }
    self.weights = weights_of_image(options.weights, options.weights_bytes);
    if (!can_forecast(self.weights, forecast)) {
        throw BadRequest("options.weights has networks for the forecasts " + networks_in(self.weights) +
                         ", the forecast is " + forecast + "; right would be weights of that forecast, or none");
    }
    return &self.weights;
}

Travel travel_of(const elmopp_options_t &options, const elmopp_junction_t &junction) {
    if (options.travel_s != ELMOPP_TRAVEL_OF_SITE) {
        return everywhere(options.travel_s);
    }
    const elmopp_sight_options_t sight = elmopp_sight_of_site(&junction);
    Travel travel_s{};
    std::copy(std::begin(sight.travel_s), std::end(sight.travel_s), travel_s.begin());
    return travel_s;
}

std::unique_ptr<elmopp_handle> open(const elmopp_options_t &options) {
    if (options.site == nullptr) {
        throw BadRequest("options.site is missing; right would be an image made by tools/site");
    }
    auto self = std::make_unique<elmopp_handle>();
    self->junction = site_of_image(options.site, options.site_bytes);
    const ChooserSpec spec = options.chooser != nullptr ? parse_chooser(options.chooser) : site_chooser(self->junction);
    self->oracle = spec.forecast == "oracle";
    self->plugged = make_chooser(spec, Setting{self->junction, true, false, travel_of(options, self->junction),
                                               options.seed, self->downstream_veh.data()});
    self->ar8.fill(shipped_weights("lstm")->ar8);
    const elmopp_weights_t *weights = weights_of(*self, options, spec.forecast);
    self->learning = make_learning(spec.forecast, weights, self->junction.approach_count);
    const elmopp_forecast_config_t forecast{
        forecast_kind(spec.forecast), self->ar8.data(), nullptr, weights, learner_of(self->learning), false};
    elmopp_pilot_init(&self->pilot, &self->junction, &self->plugged->chooser, &forecast);
    elmopp_monitor_init(&self->monitor, &self->junction);
    // A new monitor has seen flashing, after which comes red.
    (void)judged(*self, elmopp_lamps_t{groups_that_exist(*self), 0, 0, 0});
    return self;
}

/// What a second says of the roads beyond, zeros if it says nothing; nothing if a value is no count.
std::optional<Downstream> downstream_of(const elmopp_handle &self, const elmopp_second_t &second) {
    Downstream values_veh{};
    if (second.downstream_veh != nullptr) {
        std::copy_n(second.downstream_veh, self.junction.movement_count, values_veh.begin());
    }
    const bool good = std::all_of(values_veh.begin(), values_veh.end(), elmopp_pilot_is_count);
    return good ? std::optional(values_veh) : std::nullopt;
}

/// What neighbours announce, nothing if they do not; no value if a number is no count.
std::optional<Outflows> outflow_of(const elmopp_handle &self, const elmopp_second_t &second) {
    Outflows outflow{};
    for (std::uint32_t i = 0; second.announced != nullptr && i < self.junction.approach_count; ++i) {
        const elmopp_announced_t &said = second.announced[i];
        for (const float value : {said.next10_veh, said.next30_veh, said.next60_veh, said.ahead_s}) {
            if (!elmopp_pilot_is_count(value)) {
                return std::nullopt;
            }
        }
        const float ahead_s = std::min(said.ahead_s, static_cast<float>(ELMOPP_HORIZON_MAX));
        outflow.at(i) = {said.next10_veh, said.next30_veh, said.next60_veh, static_cast<std::uint16_t>(ahead_s), 0};
    }
    return outflow;
}

/// The rows of a second for an oracle, no rows for anybody else; no value if it has them for the wrong one, or if a
/// number is no count.
std::optional<elmopp_foreseen_t> foreseen_of(const elmopp_handle &self, const elmopp_second_t &second) {
    static_assert(ELMOPP_FORESEEN_MAX_S == ELMOPP_HORIZON_MAX);
    const std::uint32_t steps = second.foreseen_s;
    const bool given = second.foreseen_veh != nullptr && steps > 0;
    if (given != self.oracle || steps > ELMOPP_FORESEEN_MAX_S) {
        return std::nullopt;
    }
    elmopp_foreseen_t foreseen{};
    foreseen.steps = static_cast<std::uint16_t>(steps);
    for (std::uint32_t i = 0; given && i < self.junction.approach_count; ++i) {
        const float *row_veh = second.foreseen_veh + static_cast<std::size_t>(i) * steps;
        if (!std::all_of(row_veh, row_veh + steps, elmopp_pilot_is_count)) {
            return std::nullopt;
        }
        foreseen.row_veh[i] = row_veh;
    }
    return foreseen;
}

std::int32_t stage_or_none(const elmopp_handle &self, elmopp_stage_t stage) {
    return stage < self.junction.stage_count ? static_cast<std::int32_t>(stage) : ELMOPP_NO_STAGE;
}

void write_aspects(const elmopp_lamps_t &lamps, char *aspects) {
    for (std::uint32_t g = 0; g < ELMOPP_GROUP_MAX; ++g) {
        aspects[g] = static_cast<char>('0' + static_cast<int>(elmopp_lamps_aspect(&lamps, g)));
    }
    aspects[ELMOPP_GROUP_MAX] = '\0';
}

} // namespace
} // namespace elmopp

std::uint32_t elmopp_abi_version(void) {
    return ELMOPP_ABI_VERSION;
}

elmopp_t *elmopp_open(const elmopp_options_t *options, char *message, std::uint32_t message_bytes) {
    std::string wrong;
    try {
        return elmopp::open(elmopp::known_options(options)).release();
    } catch (const std::exception &error) {
        wrong = error.what();
    }
    if (message != nullptr && message_bytes > 0) {
        (void)std::snprintf(message, message_bytes, "%s", wrong.c_str());
    }
    return nullptr;
}

void elmopp_close(elmopp_t *self) {
    delete self;
}

int elmopp_shape(const elmopp_t *self, elmopp_shape_t *out) {
    if (!elmopp::is_of_known_size(out, sizeof out->size)) {
        return ELMOPP_REFUSED;
    }
    const elmopp_shape_t shape{out->size, self->junction.approach_count, self->junction.movement_count,
                               self->junction.group_count, self->junction.stage_count};
    std::memcpy(out, &shape, out->size);
    return ELMOPP_DONE;
}

int elmopp_count(elmopp_t *self, const elmopp_second_t *second) {
    if (!elmopp::is_of_known_size(second, offsetof(elmopp_second_t, downstream_veh)) ||
        second->present_veh == nullptr || second->arrived_veh == nullptr) {
        return ELMOPP_REFUSED;
    }
    const elmopp_second_t ours = elmopp::in_our_size(*second);
    const auto downstream_veh = elmopp::downstream_of(*self, ours);
    const auto outflow = elmopp::outflow_of(*self, ours);
    const auto foreseen = elmopp::foreseen_of(*self, ours);
    if (!downstream_veh || !outflow || !foreseen) {
        self->occupied = false;
        elmopp_pilot_step_blind(&self->pilot);
        return ELMOPP_REFUSED;
    }
    // Only the chooser reads them, and the pilot asks it only in a second that it believes: none reads a refused one's.
    self->downstream_veh = *downstream_veh;
    const elmopp_counts_t counts{ours.present_veh, ours.arrived_veh, ours.recall, outflow->data()};
    const bool believed = elmopp_pilot_step(&self->pilot, &counts, self->oracle ? &*foreseen : nullptr);
    elmopp_pilot_look_on(&self->pilot);
    self->occupied = believed && ours.occupied != 0;
    return believed ? ELMOPP_DONE : ELMOPP_REFUSED;
}

int elmopp_tick(elmopp_t *self, std::int32_t wish, char aspects[ELMOPP_ASPECT_BYTES]) {
    const bool exists = wish >= 0 && wish < static_cast<std::int32_t>(self->junction.stage_count);
    if (aspects == nullptr || (!exists && wish != ELMOPP_NO_STAGE)) {
        return ELMOPP_REFUSED;
    }
    const elmopp_stage_t wanted = exists ? static_cast<elmopp_stage_t>(wish) : self->pilot.wanted;
    const elmopp_lamps_t lamps = elmopp_pilot_lamp_tick(&self->pilot, wanted, self->occupied);
    elmopp::write_aspects(elmopp::judged(*self, lamps), aspects);
    return self->monitor.first == ELMOPP_FAULT_NONE ? ELMOPP_DONE : ELMOPP_FAULT;
}

std::int32_t elmopp_stage(const elmopp_t *self) {
    return elmopp::stage_or_none(*self, self->pilot.plan.stage);
}

std::int32_t elmopp_target(const elmopp_t *self) {
    return elmopp::stage_or_none(*self, self->pilot.plan.target);
}

std::int32_t elmopp_wish(const elmopp_t *self) {
    return elmopp::stage_or_none(*self, self->pilot.wanted);
}

std::uint32_t elmopp_stage_groups(const elmopp_t *self, std::uint32_t stage) {
    return stage < self->junction.stage_count ? self->junction.stage_groups[stage] : 0U;
}

std::uint32_t elmopp_served(const elmopp_t *self, std::uint32_t groups) {
    const auto mask = static_cast<std::uint16_t>(groups & elmopp::groups_that_exist(*self));
    return elmopp_junction_served(&self->junction, mask);
}

float elmopp_score(const elmopp_t *self, std::uint32_t stage) {
    return stage < self->junction.stage_count ? self->pilot.score[stage] : 0.0F;
}

float elmopp_foreseen_veh(const elmopp_t *self, std::uint32_t approach) {
    return approach < self->junction.approach_count ? self->pilot.foreseen_sum_veh[approach] : 0.0F;
}

const char *elmopp_fault(const elmopp_t *self) {
    return self->monitor.first == ELMOPP_FAULT_NONE ? nullptr : elmopp_fault_name(self->monitor.first);
}
