// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Networks: whose weights a forecast's name means, those built in or those of an image.

#pragma once

#include "core.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace elmopp {

/// Which network a forecast's name means, with the weights that are shipped; null for any other forecast.
const elmopp_weights_t *shipped_weights(const std::string &forecast);

/// The weights of an ELMW image in memory. Throws BadRequest with what is wrong.
elmopp_weights_t weights_of_image(const std::uint8_t *image, std::size_t length);

/// Reads an ELMW image for the option `--weights`. Throws BadRequest naming what is wrong with it.
elmopp_weights_t read_weights(const std::filesystem::path &file);

/// Which forecast can use such weights: `lstm` with one level, otherwise `nlstm`.
std::string network_name(const elmopp_weights_t &weights);

} // namespace elmopp
