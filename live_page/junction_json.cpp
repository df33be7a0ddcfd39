// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "junction_json.hpp"

#include "bus_log.hpp"

extern "C" {
#include "elmopp/fault.h"
#include "elmopp/pilot.h"
}

namespace elmopp {
namespace {

using Json = nlohmann::ordered_json;

Json members(std::uint32_t mask, std::uint32_t count) {
    Json list = Json::array();
    for (std::uint32_t i = 0; i < count; ++i) {
        if (elmopp_mask_has(mask, i)) {
            list.push_back(i);
        }
    }
    return list;
}

Json movements_of_site(const elmopp_junction_t &junction) {
    Json list = Json::array();
    for (std::uint32_t j = 0; j < junction.movement_count; ++j) {
        const elmopp_movement_t &movement = junction.movement[j];
        list.push_back({{"name", movement.name},
                        {"approach", movement.approach},
                        {"groups", members(movement.groups, junction.group_count)},
                        {"lanes", movement.lanes},
                        {"capacity_veh", movement.capacity_veh}});
    }
    return list;
}

} // namespace

Json junction_json(const elmopp_junction_t &junction) {
    Json site{{"name", junction.name}, {"reach_m", junction.reach_m}, {"foreseen_s", ELMOPP_PILOT_TRACE_S}};
    site["approaches"] = Json::array();
    for (std::uint32_t i = 0; i < junction.approach_count; ++i) {
        site["approaches"].push_back(junction.approach_name[i]);
    }
    site["movements"] = movements_of_site(junction);
    site["groups"] = Json::array();
    for (std::uint32_t g = 0; g < junction.group_count; ++g) {
        site["groups"].push_back(
            {{"name", junction.group[g].name}, {"conflicts", members(junction.conflict[g], junction.group_count)}});
    }
    site["stages"] = Json::array();
    for (std::uint32_t s = 0; s < junction.stage_count; ++s) {
        const std::uint16_t groups = junction.stage_groups[s];
        site["stages"].push_back(
            {{"groups", members(groups, junction.group_count)},
             {"movements", members(elmopp_junction_served(&junction, groups), junction.movement_count)}});
    }
    site["modes"] = Json::array();
    for (int mode = 0; mode < ELMOPP_MODE_COUNT; ++mode) {
        site["modes"].push_back(mode_name(static_cast<elmopp_mode_t>(mode)));
    }
    site["faults"] = Json::array();
    for (int fault = 0; fault < ELMOPP_FAULT_COUNT; ++fault) {
        site["faults"].push_back(elmopp_fault_name(static_cast<elmopp_fault_t>(fault)));
    }
    return site;
}

} // namespace elmopp
