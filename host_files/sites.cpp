// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "sites.hpp"

#include "error.hpp"
#include "temporary_folder.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <vector>

namespace elmopp {
namespace {

namespace fs = std::filesystem;

std::vector<std::uint8_t> read_bytes(const fs::path &file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) {
        throw BadRequest("--site " + file.string() + ": cannot be read; right would be a .toml or .bin site file");
    }
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// What a refused image holds, to name it in a message; nothing if it has another length.
elmopp_junction_t body_of(const std::uint8_t *image, std::size_t length) {
    elmopp_junction_t junction{};
    if (length == ELMOPP_IMAGE_HEADER + sizeof junction) {
        std::memcpy(&junction, image + ELMOPP_IMAGE_HEADER, sizeof junction);
    }
    for (auto &group : junction.group) {
        group.name[ELMOPP_NAME_SIZE - 1U] = '\0';
    }
    return junction;
}

elmopp_junction_t load_image(const fs::path &file) {
    const auto bytes = read_bytes(file);
    try {
        return site_of_image(bytes.data(), bytes.size());
    } catch (const BadRequest &error) {
        throw BadRequest("--site " + file.string() + ": " + error.what());
    }
}

} // namespace

fs::path find_data(const std::string &name) {
    const fs::path program = fs::read_symlink("/proc/self/exe").parent_path();
    for (const auto *const candidate : {"../../..", "../share/elmopp"}) {
        const fs::path file = (program / candidate / name).lexically_normal();
        if (fs::exists(file)) {
            return file;
        }
    }
    return {};
}

fs::path find_tool(const std::string &name) {
    const fs::path tool = find_data("tools/" + name);
    if (tool.empty()) {
        throw BadRequest("tools/" + name + " was not found near " +
                         fs::read_symlink("/proc/self/exe").parent_path().string() +
                         "; right would be the build tree or an installed copy");
    }
    return tool;
}

ToolResult run_words(std::vector<std::string> words) {
    const TemporaryFolder folder;
    const std::string said = (folder.path() / "said").string();
    std::vector<char *> argv;
    argv.reserve(words.size() + 1);
    for (auto &word : words) {
        argv.push_back(word.data());
    }
    argv.push_back(nullptr);
    const pid_t child = fork();
    if (child == 0) {
        if (std::freopen(said.c_str(), "w", stderr) != nullptr && std::freopen("/dev/null", "w", stdout) != nullptr) {
            execv(argv[0], argv.data());
        }
        _exit(127);
    }
    int status = 0;
    if (child < 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status)) {
        throw Failure(words[0] + " could not be run");
    }
    ToolResult result{WEXITSTATUS(status), {}};
    std::ifstream stream(said);
    for (std::string line; std::getline(stream, line);) {
        result.last_line = line.empty() ? result.last_line : line;
    }
    return result;
}

ToolResult run_tool(const std::string &name, const std::vector<std::string> &arguments) {
    std::vector<std::string> words{find_tool(name).string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return run_words(std::move(words));
}

elmopp_junction_t site_of_image(const std::uint8_t *image, std::size_t length) {
    elmopp_junction_t junction{};
    const auto verdict = elmopp_site_load(image, static_cast<std::uint32_t>(length), &junction);
    if (verdict.fault != ELMOPP_SITE_OK) {
        throw BadRequest(describe(verdict, body_of(image, length)) + "; right would be an image made by tools/site");
    }
    return junction;
}

elmopp_junction_t read_site(const fs::path &file) {
    if (file.extension() == ".bin") {
        return load_image(file);
    }
    if (file.extension() != ".toml") {
        throw BadRequest("--site " + file.string() + ": right would be a .toml or .bin site file");
    }
    (void)read_bytes(file);
    const TemporaryFolder folder;
    const fs::path image = folder.path() / "site.bin";
    const ToolResult result = run_tool("site", {file.string(), "--image", image.string()});
    if (result.exit_code != 0) {
        throw BadRequest(result.last_line.empty() ? "tools/site ended with " + std::to_string(result.exit_code)
                                                  : result.last_line);
    }
    return load_image(image);
}

elmopp_junction_t read_street(const fs::path &file) {
    const elmopp_junction_t junction = read_site(file);
    if (junction.simulation_only != 0) {
        throw BadRequest("--site " + file.string() +
                         ": is simulation_only and never drives lamps; right would be a site with amber and "
                         "intergreens, such as sites/four_way.toml");
    }
    return junction;
}

std::string describe(const elmopp_site_verdict_t &verdict, const elmopp_junction_t &junction) {
    const auto group = [&junction](unsigned index) {
        return std::string(junction.group[index % ELMOPP_GROUP_MAX].name);
    };
    const auto pair = [&] { return group(verdict.first) + " and " + group(verdict.second); };
    const std::string first = std::to_string(verdict.first);
    switch (verdict.fault) {
    case ELMOPP_SITE_OK:
        return "a good site";
    case ELMOPP_SITE_COUNTS:
        return "a count is out of bounds or a code unknown";
    case ELMOPP_SITE_NAME:
        return "a name is empty or has no end";
    case ELMOPP_SITE_HOLD:
        return "the hold window is not 1 <= min <= max <= 150 s";
    case ELMOPP_SITE_START:
        return "first stage, cameras or start-up times are out of bounds";
    case ELMOPP_SITE_WAIT:
        return "the wait for an occupied junction is " + std::to_string(junction.junction_wait_ds) +
               " ds; right would be " + std::to_string(ELMOPP_SITE_JUNCTION_WAIT_MAX_DS) + " ds or less";
    case ELMOPP_SITE_APPROACH:
        return "approach " + first + " has more movements than its counts can carry";
    case ELMOPP_SITE_RESCUE:
        return "the rescue stage of movement " + first + " does not serve it";
    case ELMOPP_SITE_GIVES_WAY:
        return "movement " + first + " gives way to movement " + std::to_string(verdict.second) +
               ", which never goes with it or is none, or by a share that is none";
    case ELMOPP_SITE_MOVEMENT:
        return "movement " + first + " is none: capacity, saturation flow, lanes, approach or groups";
    case ELMOPP_SITE_GROUP:
        return "a time of group " + first + " breaks its rule, or its lamp node or flashing is none";
    case ELMOPP_SITE_CONFLICT:
        return "groups " + pair() + " conflict one-sidedly or with themselves";
    case ELMOPP_SITE_INTERGREEN:
        return "the intergreen from " + pair() + " is too short or has no conflict";
    case ELMOPP_SITE_STAGE:
        return "stage " + first + " is empty or repeated";
    case ELMOPP_SITE_STAGE_CONFLICT:
        return "groups " + pair() + " conflict inside a stage";
    case ELMOPP_SITE_STAGE_NOT_MAXIMAL:
        return "a further group fits into stage " + first;
    case ELMOPP_SITE_RED_BOUND:
        return "the bound on red of " + std::to_string(junction.red_bound_ds) + " ds cannot be kept; right would be " +
               std::to_string(elmopp_site_red_bound_min_ds(&junction)) + " ds or more";
    case ELMOPP_SITE_PROGRAM:
        return "programme " + first + " has no good steps or leaves out a movement";
    case ELMOPP_SITE_SCHEDULE:
        return "line " + first + " of the schedule names no minute, weekday or programme";
    case ELMOPP_SITE_SPECIAL_DAY:
        return "special day " + first + " names no weekday";
    case ELMOPP_SITE_IMAGE_MAGIC:
        return "does not begin with ELMS";
    case ELMOPP_SITE_IMAGE_VERSION:
        return "another version of the layout";
    case ELMOPP_SITE_IMAGE_LENGTH:
        return "cut or too long";
    case ELMOPP_SITE_IMAGE_CRC:
    case ELMOPP_SITE_FAULT_COUNT: // no verdict
        break;
    }
    return "the checksum does not fit the bytes";
}

} // namespace elmopp
