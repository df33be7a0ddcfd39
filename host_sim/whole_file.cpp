// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "whole_file.hpp"

#include "error.hpp"

#include <iostream>
#include <system_error>

namespace elmopp {
namespace {

namespace fs = std::filesystem;

bool is_written_directly(const fs::path &file) {
    return file == "-" || (fs::exists(file) && !fs::is_regular_file(file));
}

} // namespace

WholeFile::WholeFile(const std::string &option, const fs::path &file)
    : file_(file), direct_(is_written_directly(file)), building_(direct_ ? file : fs::path(file.string() + ".part")) {
    if (file_ == "-") {
        return;
    }
    stream_.open(building_);
    if (!stream_) {
        throw BadRequest(option + " " + file.string() +
                         ": cannot be written; right would be a file in a folder in which files can be made");
    }
}

WholeFile::~WholeFile() {
    if (!direct_) {
        std::error_code ignored;
        fs::remove(building_, ignored);
    }
}

std::ostream &WholeFile::out() {
    return file_ == "-" ? std::cout : stream_;
}

void WholeFile::commit() {
    if (!out().flush()) {
        throw Failure(file_.string() + ": could not be written");
    }
    if (!direct_) {
        stream_.close();
        fs::rename(building_, file_);
    }
}

} // namespace elmopp
