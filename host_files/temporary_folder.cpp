// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "temporary_folder.hpp"

#include "error.hpp"

#include <cstdlib>
#include <string>
#include <system_error>

namespace elmopp {

TemporaryFolder::TemporaryFolder() {
    const auto parent = std::filesystem::temp_directory_path();
    std::string pattern = (parent / "elmopp-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) {
        throw Failure("no temporary folder in " + parent.string());
    }
    path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

} // namespace elmopp
