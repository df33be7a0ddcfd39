// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// What the words behind an option of host_sim mean: a word in, a value out, or BadRequest that names the option, the
/// word and what would be right. It knows no command and asks for nothing else.

#ifndef ELMOPP_OPTION_WORDS_HPP
#define ELMOPP_OPTION_WORDS_HPP

#include "csv.hpp"
#include "error.hpp"
#include "inflow.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace elmopp {

/// A whole number in a range.
std::uint64_t whole(const std::string &option, const std::string &text, double lowest, double highest);

/// Vehicles an approach: one number.
unsigned vehicles_of(const std::string &text);
/// ... several, each once; none for "random".
std::vector<unsigned> vehicles_list(const std::string &text);

/// Shares of an approach's movements, such as 0.2,0.6,0.2.
std::vector<double> shares_of(const std::string &text);

Integrator integrator_of(const std::string &text);
Mapping mapping_of(const std::string &text);

/// "inproc", "can:IFACE", "slcan:unix:PATH" or "slcan:tty:PATH".
std::string link_of(const std::string &text);

/// Simulated seconds a second.
double speed_of(const std::string &text);

/// A chooser that reads a forecast, without one: the command gives it several.
std::string reader_of(const std::string &text);

/// What is asked for twice is run once.
template <typename Value> std::vector<Value> distinct(const std::vector<Value> &values) {
    std::vector<Value> once;
    for (const auto &value : values) {
        if (std::find(once.begin(), once.end(), value) == once.end()) {
            once.push_back(value);
        }
    }
    return once;
}

/// One of the words, as the value that belongs to it.
template <typename Value>
Value one_of(const std::string &option, const std::string &text,
             const std::vector<std::pair<std::string, Value>> &words) {
    std::vector<std::string> names;
    for (const auto &[name, value] : words) {
        if (name == text) {
            return value;
        }
        names.push_back(name);
    }
    throw BadRequest(option + " \"" + text + "\": right would be one of " + join(names, ", "));
}

} // namespace elmopp

#endif
