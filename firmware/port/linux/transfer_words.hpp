// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// What a controller says about an image that came over the bus (elmopp/transfer.h), in words.

#pragma once

extern "C" {
#include "elmopp/transfer.h"
}

#include <string>

namespace elmopp {

/// "weights: refused, the checksum does not fit the bytes". `first` and `second` may be any numbers.
std::string in_words(const elmopp_transfer_report_t &report);

} // namespace elmopp
