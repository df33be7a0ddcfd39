// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Temporary folder: a place of our own for files that one program hands to another.
///
/// Owner: who makes it; it and all that is in it go with him, also when he throws.

#pragma once

#include <filesystem>

namespace elmopp {

class TemporaryFolder {
  public:
    /// Throws Failure if the system has no room for one.
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder &) = delete;
    TemporaryFolder &operator=(const TemporaryFolder &) = delete;
    TemporaryFolder(TemporaryFolder &&) = delete;
    TemporaryFolder &operator=(TemporaryFolder &&) = delete;
    [[nodiscard]] const std::filesystem::path &path() const {
        return path_;
    }

  private:
    std::filesystem::path path_;
};

} // namespace elmopp
