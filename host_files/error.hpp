// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The two ways in which a request can end badly; main() turns them into exit codes 2 and 1 and one line on stderr.

#pragma once

#include <stdexcept>

namespace elmopp {

/// The request cannot be run. The message names the value and what would be right.
class BadRequest : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// It ran and a check failed.
class Failure : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

} // namespace elmopp
