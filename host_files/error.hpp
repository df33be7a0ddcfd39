// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The two ways in which a request can end badly; main() turns them into exit codes 2 and 1 and one line on stderr.

#pragma once

#include <stdexcept>
#include <string>

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

/// What an exception says, without the mark of the library that threw it: "[json.exception.out_of_range.403] " and
/// such.
inline std::string said_by(const std::exception &error) {
    const std::string text = error.what();
    const auto end = text.rfind('[', 0) == 0 ? text.find("] ") : std::string::npos;
    return end == std::string::npos ? text : text.substr(end + 2);
}

} // namespace elmopp
