// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "output_folder.hpp"

#include "error.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

namespace elmopp {
namespace {

namespace fs = std::filesystem;

bool any_is_folder(const fs::path &folder, const std::vector<fs::path> &names) {
    std::error_code ignored;
    return std::any_of(names.begin(), names.end(),
                       [&](const fs::path &name) { return fs::is_directory(folder / name, ignored); });
}

} // namespace

OutputFolder::OutputFolder(const fs::path &wanted, std::vector<fs::path> names) : names_(std::move(names)) {
    std::error_code error;
    wanted_ = fs::absolute(wanted, error).lexically_normal();
    if (!wanted.empty() && !error) {
        make_folders();
    }
    // Inside the wanted folder, so that the drafts are on its device, whatever is mounted or linked there.
    std::string pattern = (wanted_ / ".drafts-XXXXXX").string();
    if (wanted.empty() || any_is_folder(wanted_, names_) || mkdtemp(pattern.data()) == nullptr) {
        remove_folders();
        throw BadRequest("--out \"" + wanted.string() +
                         "\": cannot be written; right would be a folder in which files can be made");
    }
    drafts_ = pattern;
}

OutputFolder::~OutputFolder() {
    std::error_code ignored;
    fs::remove_all(drafts_, ignored);
    remove_folders();
}

std::vector<fs::path> OutputFolder::commit() const {
    for (const auto &name : names_) {
        if (!fs::exists(drafts_ / name)) {
            fs::remove(wanted_ / name);
        }
    }
    std::vector<fs::path> moved;
    for (const auto &entry : fs::directory_iterator(drafts_)) {
        moved.push_back(entry.path().filename());
    }
    for (const auto &name : moved) {
        fs::rename(drafts_ / name, wanted_ / name);
    }
    std::sort(moved.begin(), moved.end());
    return moved;
}

void OutputFolder::make_folders() {
    std::vector<fs::path> missing;
    std::error_code error;
    for (fs::path folder = wanted_; !folder.empty() && !fs::exists(folder, error); folder = folder.parent_path()) {
        if (folder.has_filename()) {
            missing.push_back(folder);
        }
    }
    std::reverse(missing.begin(), missing.end());
    for (const auto &folder : missing) {
        if (fs::create_directory(folder, error)) {
            made_.push_back(folder);
        }
    }
}

void OutputFolder::remove_folders() const {
    std::error_code ignored;
    for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) {
        fs::remove(*folder, ignored); // only if it is empty
    }
}

} // namespace elmopp
