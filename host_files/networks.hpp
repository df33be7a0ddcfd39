// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Networks: whose weights a forecast's name means, those built in or those of an image.

#pragma once

#include "core.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace elmopp {

/// The weights that are shipped for a forecast's network; null for any other forecast.
const elmopp_weights_t *shipped_weights(const std::string &forecast);

/// The weights of an ELMW image in memory. Throws BadRequest with what is wrong.
elmopp_weights_t weights_of_image(const std::uint8_t *image, std::size_t length);

/// Reads an ELMW image for the option `--weights`. Throws BadRequest naming what is wrong with it.
elmopp_weights_t read_weights(const std::filesystem::path &file);

/// Which forecasts can use such weights: `lstm` with one level, otherwise `nlstm`; the same with `-q15`, unless a row
/// could overflow; and `ann` and `gcn`.
std::vector<std::string> network_names(const elmopp_weights_t &weights);

/// Whether a forecast is one of them, or learns on from one.
bool can_forecast(const elmopp_weights_t &weights, const std::string &forecast);

/// The same names in words, for a message.
std::string networks_in(const elmopp_weights_t &weights);

/// Why the recurrent network's weights cannot be used in whole numbers: the row that could overflow. Empty if they can.
std::string overflow_of(const elmopp_weights_t &weights);

} // namespace elmopp
