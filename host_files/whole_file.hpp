// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// A file that takes its name when it is whole: a run that fails leaves nothing half-written.

#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace elmopp {

/// "-" is stdout; a device or pipe is written to as it is.
class WholeFile {
  public:
    /// Throws BadRequest naming `option` and the file if it cannot be made.
    WholeFile(const std::string &option, const std::filesystem::path &file);
    ~WholeFile();
    WholeFile(const WholeFile &) = delete;
    WholeFile &operator=(const WholeFile &) = delete;
    WholeFile(WholeFile &&) = delete;
    WholeFile &operator=(WholeFile &&) = delete;

    std::ostream &out();

    /// Throws Failure if what was written so far could not be.
    void flush();

    /// The file is whole. Throws Failure if it could not be written to its end.
    void commit();

  private:
    std::filesystem::path file_;
    bool direct_;
    std::filesystem::path building_; ///< the draft; empty if there is none
    std::ofstream stream_;
};

} // namespace elmopp
