// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// What every program of this port does alike: arguments in, exit code and one line on stderr out.

#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
} // namespace CLI

namespace elmopp {

/// One line on stderr, whatever the text holds.
void say(const std::string &program, std::string text);

/// --can and --site of who takes part in a junction's bus, or listens to it.
void add_bus_options(CLI::App &app, std::string &can, std::string &site);

/// Parses the arguments into the options that `describe` adds, then runs `body`. Exit codes: 0 done, or help was asked
/// for; 1 it ran and failed; 2 the request cannot be run. Never throws.
int run_program(const std::string &program, int argc, char **argv, const std::function<void(CLI::App &)> &describe,
                const std::function<void()> &body) noexcept;

/// The same with a request that the options fill in and the body runs.
template <typename Request>
int run_program(const std::string &program, int argc, char **argv, void (*describe)(CLI::App &, Request &),
                void (*body)(const Request &)) noexcept {
    Request request;
    return run_program(program, argc, argv, [&](CLI::App &app) { describe(app, request); }, [&] { body(request); });
}

} // namespace elmopp
