// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "option_words.hpp"

#include "choosers.hpp"
#include "serve.hpp"

#include <cmath>

namespace elmopp {
namespace {

constexpr double most_vehicles = 100000.0;
constexpr double largest_share = 1e6;

double share_of(const std::string &word) {
    double share = 0.0;
    if (!parse_number(word, share) || share < 0.0 || share > largest_share) {
        throw BadRequest("--split \"" + word + "\": right would be numbers from 0 to 1000000, such as 0.2,0.6,0.2");
    }
    return share;
}

} // namespace

std::uint64_t whole(const std::string &option, const std::string &text, double lowest, double highest) {
    double value = 0.0;
    if (!parse_number(text, value) || value != std::floor(value) || value < lowest || value > highest) {
        throw BadRequest(option + " \"" + text + "\": right would be a whole number from " + format_number(lowest, 12) +
                         " to " + format_number(highest, 12));
    }
    return static_cast<std::uint64_t>(value);
}

unsigned vehicles_of(const std::string &text) {
    return static_cast<unsigned>(whole("--vehicles", text, 1, most_vehicles));
}

std::vector<unsigned> vehicles_list(const std::string &text) {
    std::vector<unsigned> vehicles;
    for (const auto &word : text == "random" ? std::vector<std::string>() : split(text, ',')) {
        vehicles.push_back(vehicles_of(word));
    }
    return distinct(vehicles);
}

std::vector<double> shares_of(const std::string &text) {
    std::vector<double> shares;
    for (const auto &word : split(text, ',')) {
        shares.push_back(share_of(word));
    }
    if (*std::max_element(shares.begin(), shares.end()) <= 0.0) {
        throw BadRequest("--split \"" + text + "\": the shares add up to 0; right would be at least one above 0");
    }
    return shares;
}

Integrator integrator_of(const std::string &text) {
    return one_of<Integrator>("--integrator", text, {{"rk4", Integrator::rk4}, {"euler", Integrator::euler}});
}

Mapping mapping_of(const std::string &text) {
    return one_of<Mapping>("--mapping", text, {{"abs", Mapping::abs}, {"shift", Mapping::shift}});
}

std::string link_of(const std::string &text) {
    const std::vector<std::string> wires{"can:", "slcan:unix:", "slcan:tty:"};
    const auto fits = [&text](const std::string &wire) {
        return text.rfind(wire, 0) == 0 && text.size() > wire.size();
    };
    if (text != "inproc" && std::none_of(wires.begin(), wires.end(), fits)) {
        throw BadRequest("--link \"" + text +
                         "\": right would be inproc, can:IFACE, such as can:vcan0, slcan:unix:PATH or slcan:tty:PATH");
    }
    return text;
}

double speed_of(const std::string &text) {
    double speed = 0.0;
    if (!parse_number(text, speed) || !(speed >= lowest_speed && speed <= highest_speed)) {
        throw BadRequest("--speed \"" + text + "\": right would be a number from " + format_number(lowest_speed, 6) +
                         " to " + format_number(highest_speed, 6));
    }
    return speed;
}

std::string reader_of(const std::string &text) {
    const std::string name = text.substr(0, text.find('@'));
    for (const auto &kind : chooser_kinds()) {
        if (kind.name == name && kind.forecasts && text.find(':') == std::string::npos) {
            (void)parse_chooser(text); // its options
            return text;
        }
    }
    throw BadRequest("--chooser \"" + text +
                     "\": right would be a chooser that reads a forecast, without one, such as rollout or cumulative");
}

} // namespace elmopp
