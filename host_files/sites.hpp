// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The sites: those built in, and those read from a file.

#pragma once

#include "core.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

extern "C" {
extern const elmopp_junction_t elmopp_site_five_way;
extern const elmopp_junction_t elmopp_site_four_way;
extern const elmopp_junction_t elmopp_site_left_lanes;
extern const elmopp_junction_t elmopp_site_one_way;
extern const elmopp_junction_t elmopp_site_paper;
extern const elmopp_junction_t elmopp_site_shared_lanes;
extern const elmopp_junction_t elmopp_site_three_way;
}

namespace elmopp {

/// A Python tool that belongs to this program: of the source tree around the build, or of the installed share folder.
std::filesystem::path find_tool(const std::string &name);

/// A file that belongs to this program, such as "weights/long_memory.json", of the same places; empty if it is not
/// there.
std::filesystem::path find_data(const std::string &name);

struct ToolResult {
    int exit_code;
    std::string last_line; ///< of what it said on stderr
};

/// Runs a program by its path to its end. Throws Failure if it cannot be run.
ToolResult run_words(std::vector<std::string> words);

/// Runs such a tool to its end.
ToolResult run_tool(const std::string &name, const std::vector<std::string> &arguments);

/// The junction of a site image in memory. Throws BadRequest with what is wrong.
elmopp_junction_t site_of_image(const std::uint8_t *image, std::size_t length);

/// Reads a site image (.bin) or, through tools/site, a site file (.toml). Throws BadRequest with what is wrong.
elmopp_junction_t read_site(const std::filesystem::path &file);

/// The same of a site that may drive lamps: refuses one that is simulation_only.
elmopp_junction_t read_street(const std::filesystem::path &file);

/// A verdict in words, naming the groups, movements or stages that it indexes.
std::string describe(const elmopp_site_verdict_t &verdict, const elmopp_junction_t &junction);

} // namespace elmopp
