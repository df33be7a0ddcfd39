// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// A folder of results that appears as a whole: drafts are made inside the wanted folder and take their names at the
/// end.

#pragma once

#include <filesystem>
#include <vector>

namespace elmopp {

class OutputFolder {
  public:
    /// Makes the folder, with its parents, and a draft folder inside. `names` are the files that it may get. Throws
    /// BadRequest if files cannot be made there or if one of the names is a folder.
    OutputFolder(const std::filesystem::path &wanted, std::vector<std::filesystem::path> names);
    /// What was not committed goes, and so do the folders that were made for it.
    ~OutputFolder();
    OutputFolder(const OutputFolder &) = delete;
    OutputFolder &operator=(const OutputFolder &) = delete;
    OutputFolder(OutputFolder &&) = delete;
    OutputFolder &operator=(OutputFolder &&) = delete;

    /// Where to write the drafts.
    [[nodiscard]] const std::filesystem::path &drafts() const {
        return drafts_;
    }

    /// Moves the drafts to their places and returns their names, sorted. Of `names`, those that were not made go: they
    /// are of an earlier run. Other files stay.
    [[nodiscard]] std::vector<std::filesystem::path> commit() const;

  private:
    void make_folders();
    void remove_folders() const;

    std::vector<std::filesystem::path> names_;
    std::vector<std::filesystem::path> made_; ///< folders that were not there before, outermost first
    std::filesystem::path wanted_;
    std::filesystem::path drafts_;
};

} // namespace elmopp
