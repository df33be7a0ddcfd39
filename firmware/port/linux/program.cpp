// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "program.hpp"

#include "error.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <iostream>
#include <vector>

namespace elmopp {
namespace {

constexpr int exit_failed = 1;
constexpr int exit_bad_request = 2;

} // namespace

void say(const std::string &program, std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    std::cerr << program + ": " + text + "\n";
}

void add_bus_options(CLI::App &app, std::string &can, std::string &site) {
    app.add_option("--can", can, "CAN interface, 500 kbit/s")->type_name("IFACE")->required();
    app.add_option("--site", site, "The junction, .toml or .bin")->type_name("FILE")->required();
}

int run_program(const std::string &program, int argc, char **argv, const std::function<void(CLI::App &)> &describe,
                const std::function<void()> &body) noexcept {
    try {
        CLI::App app;
        app.name(program);
        describe(app);
        std::vector<std::string> words(argv + 1, argv + argc);
        std::reverse(words.begin(), words.end()); // as CLI11 wants them
        try {
            app.parse(words);
        } catch (const CLI::Success &success) {
            return app.exit(success);
        } catch (const CLI::ParseError &error) {
            // CLI11 asks for what is missing before it says what it does not know, which may be that one misspelt.
            std::string unknown;
            for (const auto &word : app.remaining()) {
                unknown += " " + word;
            }
            throw BadRequest((unknown.empty() ? error.what() : "not expected:" + unknown) + " (" + program +
                             " --help)");
        }
        body();
        return 0;
    } catch (const BadRequest &error) {
        say(program, error.what());
        return exit_bad_request;
    } catch (const std::exception &error) {
        say(program, error.what());
        return exit_failed;
    }
}

} // namespace elmopp
