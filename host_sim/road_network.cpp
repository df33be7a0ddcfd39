// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "road_network.hpp"

#include "csv.hpp"
#include "error.hpp"
#include "sites.hpp"
#include "temporary_folder.hpp"
#include "turns.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <optional>

namespace elmopp {
namespace {

constexpr double most_in_a_row = 16.0;

std::optional<std::size_t> find_node(const NetworkText &text, const std::string &name) {
    for (std::size_t v = 0; v < text.nodes.size(); ++v) {
        if (!name.empty() && text.nodes[v].name == name) {
            return v;
        }
    }
    return std::nullopt;
}

/// The side of `node` at which the junction `other` is.
std::optional<int> side_towards(const Node &node, const std::string &other) {
    for (int side = 0; side < side_count; ++side) {
        if (node.neighbours.at(static_cast<std::size_t>(side)) == other) {
            return side;
        }
    }
    return std::nullopt;
}

bool is_road(const Entry &entry) {
    return std::any_of(entry.begin(), entry.end(), [](int lanes) { return lanes != 0; });
}

std::string place(const NetworkText &text, std::size_t tail, std::size_t head) {
    return "network " + text.name + ", road from " + text.nodes[tail].name + " to " + text.nodes[head].name;
}

void check_profile(const NetworkText &text, const std::string &profile) {
    const auto words = split(profile, '@');
    const auto names_site = [](const std::string &word) { return word.rfind("site=", 0) == 0; };
    if (words.front() != "discrete" || std::any_of(words.begin(), words.end(), names_site)) {
        throw BadRequest("--profile " + profile + " with --network " + text.name +
                         ": right would be discrete without a site, as only discrete moves vehicles from junction to "
                         "junction and each has its own");
    }
}

void check_site(const NetworkText &text, const Node &node) {
    const auto names = site_names();
    if (std::find(names.begin(), names.end(), node.site) == names.end()) {
        throw BadRequest("network " + text.name + ", junction " + node.name + ": site is \"" + node.site +
                         "\"; right would be one of " + join(names, ", "));
    }
}

/// Every road of the tensor joins neighbours, and every neighbour has one.
void check(const NetworkText &text) {
    const std::size_t count = text.nodes.size();
    for (std::size_t tail = 0; tail < count; ++tail) {
        for (const auto &name : text.nodes[tail].neighbours) {
            if (!name.empty() && !find_node(text, name)) {
                throw BadRequest("network " + text.name + ", neighbour \"" + name + "\" of " + text.nodes[tail].name +
                                 ": no such junction; right would be the name of one");
            }
        }
        for (std::size_t head = 0; head < count; ++head) {
            const bool next = side_towards(text.nodes[tail], text.nodes[head].name).has_value() &&
                              side_towards(text.nodes[head], text.nodes[tail].name).has_value();
            if (is_road(text.adjacency[tail][head]) != next) {
                throw BadRequest(place(text, tail, head) +
                                 ": adjacency and neighbours differ; right would be an entry with a 1 exactly where "
                                 "each names the other");
            }
        }
    }
}

/// Where a way leads; none: outside.
std::optional<ArmId> next_arm(const NetworkText &text, const std::vector<Scenario> &scenarios, std::size_t from,
                              int exit) {
    const std::string &name = text.nodes[from].neighbours.at(static_cast<std::size_t>(exit));
    const auto to = find_node(text, name);
    if (!to) {
        return std::nullopt;
    }
    const auto side = side_towards(text.nodes[*to], text.nodes[from].name);
    if (!side) {
        throw BadRequest(place(text, from, *to) +
                         ": only one names the other; right would be that each names the other");
    }
    const auto approach = approach_of(scenarios[*to].junction, *side);
    if (!approach) {
        throw BadRequest(place(text, from, *to) + ": site " + text.nodes[*to].site + " has no approach from " +
                         side_name(*side) + "; right would be a site that has one");
    }
    return ArmId{*to, *approach};
}

/// Takes the turns away that have no lane, and shares their vehicles out to the others.
void prune(const Entry &lanes, std::vector<Way> &ways, const std::vector<Turn> &turns) {
    double sum = 0.0;
    for (std::size_t w = 0; w < ways.size(); ++w) {
        ways[w].share *= lanes.at(static_cast<std::size_t>(turns[w])) != 0 ? 1.0 : 0.0;
        sum += ways[w].share;
    }
    for (auto &way : ways) {
        way.share /= sum;
    }
}

/// One arm, with its ways led on; the scenario's shares and storage follow it.
ArmPlan make_arm(const NetworkText &text, std::vector<Scenario> &scenarios, std::size_t v, std::size_t approach) {
    Scenario &scenario = scenarios[v];
    const auto side = side_of(scenario.junction, approach);
    const std::string where = "network " + text.name + ", junction " + text.nodes[v].name + ", approach " +
                              scenario.junction.approach_name[approach];
    if (!side) {
        throw BadRequest(where + ": comes from no side; right would be a site whose approaches are N, E, S or W");
    }
    const Road &road = scenario.surroundings().roads[approach];
    ArmPlan arm{road.length_m, road.speed_m_per_s, ways_of(scenario.junction, approach, scenario.share), true};
    std::vector<Turn> turns;
    for (std::size_t j = 0; j < scenario.junction.movement_count; ++j) {
        if (scenario.junction.movement[j].approach == approach) {
            const auto more = turns_of(scenario.junction, j);
            turns.insert(turns.end(), more.begin(), more.end());
        }
    }
    if (turns.size() != arm.ways.size()) {
        throw BadRequest(where + ": a movement's name tells no turn; right would be L, M, R or T after its dot");
    }
    if (const auto tail = find_node(text, text.nodes[v].neighbours.at(static_cast<std::size_t>(*side)))) {
        arm.from_outside = false;
        prune(text.adjacency[*tail][v], arm.ways, turns);
        if (std::none_of(arm.ways.begin(), arm.ways.end(), [](const Way &way) { return way.share > 0.0; })) {
            throw BadRequest(place(text, *tail, v) + ": its lanes lead nowhere at site " + text.nodes[v].site +
                             "; right would be a lane for a turn that the site has");
        }
    }
    for (std::size_t w = 0; w < arm.ways.size(); ++w) {
        arm.ways[w].to = next_arm(text, scenarios, v, exit_of(*side, turns[w]));
    }
    return arm;
}

/// What the ways of an arm have become, for those who see the site only.
void follow(const ArmPlan &arm, Scenario &scenario) {
    for (const auto &way : arm.ways) {
        scenario.share[way.movement] = 0.0;
    }
    for (const auto &way : arm.ways) {
        scenario.share[way.movement] += way.share;
    }
    for (const auto &way : arm.ways) {
        if (scenario.share[way.movement] <= 0.0) {
            scenario.junction.movement[way.movement].capacity_veh = 0.0F;
            scenario.capacity_veh[way.movement] = 0.0;
        }
    }
}

/// The roads of a junction that differ from the others.
void pave(const NetworkText &text, const Node &node, Scenario &scenario) {
    for (int side = 0; side < side_count; ++side) {
        const RoadText &road = node.roads.at(static_cast<std::size_t>(side));
        if (!road.speed_km_per_h && !road.length_m) {
            continue;
        }
        const std::string where = "network " + text.name + ", junction " + node.name + ", road " + side_name(side);
        const auto approach = approach_of(scenario.junction, side);
        if (!approach) {
            throw BadRequest(where + ": site " + node.site +
                             " has no approach from there; right would be a side that has one");
        }
        scenario.pave(*approach, road.speed_km_per_h, road.length_m, where + ": ");
    }
}

unsigned side_length(const std::string &text, const std::string &word) {
    double value = 0.0;
    if (!parse_number(word, value) || !(value >= 1.0 && value <= most_in_a_row) ||
        value != static_cast<double>(static_cast<unsigned>(value))) {
        throw BadRequest("--network \"" + text + "\": right would be grid:ROWSxCOLUMNS with 1 to 16 each, or a file");
    }
    return static_cast<unsigned>(value);
}

std::size_t side_index(const std::string &where, const std::string &side) {
    const auto index = side_named(side);
    if (!index) {
        throw BadRequest(where + "\"" + side + "\"; right would be N, E, S or W");
    }
    return static_cast<std::size_t>(*index);
}

void tell_apart(RoadText &road, const std::string &where, const std::string &key, const nlohmann::json &value) {
    if (key != "length_m" && key != "speed_km_per_h") {
        throw BadRequest(where + ": unknown \"" + key + "\"; right would be length_m or speed_km_per_h");
    }
    if (!value.is_number()) {
        throw BadRequest(where + ": " + key + " is " + value.dump() + "; right would be a number");
    }
    (key == "length_m" ? road.length_m : road.speed_km_per_h) = value.get<double>();
}

RoadText road_of_json(const std::string &where, const nlohmann::json &json) {
    RoadText road;
    for (const auto &[key, value] : json.items()) {
        tell_apart(road, where, key, value);
    }
    return road;
}

NetworkText of_json(const nlohmann::json &json) {
    NetworkText text;
    text.name = json.at("name").get<std::string>();
    for (const auto &junction : json.at("junctions")) {
        Node node;
        node.name = junction.at("name").get<std::string>();
        node.site = junction.at("site").get<std::string>();
        const nlohmann::json neighbours = junction.value("neighbours", nlohmann::json::object());
        for (const auto &[side, name] : neighbours.items()) {
            const std::string where = "network " + text.name + ", junction " + node.name + ", neighbour at side ";
            node.neighbours.at(side_index(where, side)) = name.get<std::string>();
        }
        const nlohmann::json roads = junction.value("roads", nlohmann::json::object());
        for (const auto &[side, road] : roads.items()) {
            const std::string where = "network " + text.name + ", junction " + node.name + ", road ";
            node.roads.at(side_index(where, side)) = road_of_json(where + side, road);
        }
        text.nodes.push_back(std::move(node));
    }
    text.adjacency = json.at("adjacency").get<Tensor>();
    const std::size_t count = text.nodes.size();
    const auto wrong = [count](const auto &row) { return row.size() != count; };
    if (count == 0 || wrong(text.adjacency) || std::any_of(text.adjacency.begin(), text.adjacency.end(), wrong)) {
        throw BadRequest("network " + text.name + ": adjacency is not " + std::to_string(count) + " x " +
                         std::to_string(count) + " x 3; right would be a row and a column for each junction");
    }
    return text;
}

/// The file by way of tools/network.
nlohmann::json json_of(const std::string &file) {
    if (!std::ifstream(file)) {
        throw BadRequest("--network " + file +
                         ": cannot be read; right would be grid:ROWSxCOLUMNS or a TOML network file");
    }
    const TemporaryFolder folder;
    const std::filesystem::path read = folder.path() / "network.json";
    const ToolResult result = run_tool("network", {file, "--json", read.string()});
    std::ifstream stream(read);
    const auto json = nlohmann::json::parse(stream, nullptr, false);
    if (result.exit_code != 0 || json.is_discarded()) {
        throw BadRequest("--network " + file + ": " + result.last_line);
    }
    return json;
}

} // namespace

NetworkText grid(unsigned rows, unsigned columns) {
    NetworkText text;
    text.name = "grid:" + std::to_string(rows) + "x" + std::to_string(columns);
    const auto name = [&](unsigned row, unsigned column) {
        const bool inside = row < rows && column < columns; // one before 0 is beyond the end
        return inside ? std::to_string(row) + "." + std::to_string(column) : std::string();
    };
    for (unsigned row = 0; row < rows; ++row) {
        for (unsigned column = 0; column < columns; ++column) {
            text.nodes.push_back(
                {name(row, column),
                 "four_way",
                 {name(row - 1, column), name(row, column + 1), name(row + 1, column), name(row, column - 1)},
                 {}});
        }
    }
    text.adjacency.assign(text.nodes.size(), std::vector<Entry>(text.nodes.size(), Entry{0, 0, 0}));
    for (std::size_t tail = 0; tail < text.nodes.size(); ++tail) {
        for (std::size_t head = 0; head < text.nodes.size(); ++head) {
            if (side_towards(text.nodes[tail], text.nodes[head].name)) {
                text.adjacency[tail][head] = {1, 1, 1};
            }
        }
    }
    return text;
}

NetworkText read_network(const std::string &text, std::string &profile) {
    const std::string generated = "grid:";
    if (text.rfind(generated, 0) == 0) {
        const auto sides = split(text.substr(generated.size()), 'x');
        if (sides.size() != 2) {
            (void)side_length(text, "");
        }
        return grid(side_length(text, sides[0]), side_length(text, sides[1]));
    }
    const nlohmann::json json = json_of(text);
    try {
        const auto add = [&](const char *key, const std::string &option) {
            if (json.contains(key) && profile.find("@" + option + "=") == std::string::npos) {
                profile += "@" + option + "=" + format_number(json.at(key).get<double>(), 9);
            }
        };
        add("length_m", "length");
        add("speed_km_per_h", "speed");
        return of_json(json);
    } catch (const nlohmann::json::exception &error) {
        throw BadRequest("--network " + text + ": " + said_by(error) +
                         "; right would be name, junctions and adjacency as in networks/g_alpha.toml");
    }
}

Network make_network(const NetworkText &text, const std::string &profile) {
    check(text);
    Network network;
    network.name = text.name;
    check_profile(text, profile);
    for (const auto &node : text.nodes) {
        check_site(text, node);
        Scenario scenario = make_scenario(profile + "@site=" + node.site, nullptr);
        pave(text, node, scenario);
        network.scenarios.push_back(std::move(scenario));
    }
    for (std::size_t v = 0; v < text.nodes.size(); ++v) {
        JunctionPlan plan{&network.scenarios[v].junction, {}};
        for (std::size_t i = 0; i < network.scenarios[v].junction.approach_count; ++i) {
            plan.arms.push_back(make_arm(text, network.scenarios, v, i));
        }
        for (const auto &arm : plan.arms) {
            follow(arm, network.scenarios[v]);
        }
        network.plan.push_back(std::move(plan));
    }
    return network;
}

} // namespace elmopp
