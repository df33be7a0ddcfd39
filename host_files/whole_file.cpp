// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "whole_file.hpp"

#include "error.hpp"

#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <system_error>

namespace elmopp {
namespace {

namespace fs = std::filesystem;

/// Where a link leads, so that the file is replaced and not the link.
fs::path resolved(const fs::path &file) {
    constexpr int most_links = 16;
    std::error_code ignored; // a link that leads nowhere yet is an answer too
    fs::path target = file;
    for (int i = 0; i < most_links && fs::is_symlink(target, ignored); ++i) {
        target = target.parent_path() / fs::read_symlink(target, ignored); // an absolute link replaces the parent
    }
    return target;
}

bool is_written_directly(const fs::path &file) {
    std::error_code ignored; // what cannot be asked about cannot be opened either
    return file == "-" || (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored));
}

/// A name beside the file that nobody else has.
fs::path draft_of(const fs::path &file) {
    std::string pattern = file.string() + ".XXXXXX";
    const int descriptor = mkstemp(pattern.data());
    if (descriptor < 0) {
        return {};
    }
    (void)close(descriptor);
    std::error_code ignored;
    fs::permissions(pattern, fs::perms::group_read | fs::perms::others_read, fs::perm_options::add, ignored);
    return pattern;
}

} // namespace

WholeFile::WholeFile(const std::string &option, const fs::path &file)
    : file_(file), direct_(is_written_directly(file)) {
    if (file_ == "-") {
        return;
    }
    if (!direct_ && !file_.empty()) {
        file_ = resolved(file);
        building_ = draft_of(file_);
    }
    stream_.open(direct_ ? file_ : building_);
    if (!stream_) {
        throw BadRequest(option + " \"" + file.string() +
                         "\": cannot be written; right would be a file in a folder in which files can be made");
    }
}

WholeFile::~WholeFile() {
    if (!building_.empty()) {
        std::error_code ignored;
        fs::remove(building_, ignored);
    }
}

std::ostream &WholeFile::out() {
    return file_ == "-" ? std::cout : stream_;
}

void WholeFile::flush() {
    if (!out().flush()) {
        throw Failure(file_.string() + ": could not be written");
    }
}

void WholeFile::commit() {
    flush();
    if (!building_.empty()) {
        stream_.close();
        fs::rename(building_, file_);
    }
}

} // namespace elmopp
