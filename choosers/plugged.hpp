// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Plugged: a rule with its state, as the core's chooser.
///
/// A rule is a struct with
///
///     elmopp_stage_t choose(const elmopp_view_t &view, float *score)
///
/// called once a second, in the intergreen too. The scores are 0 when it is called. It names a stage that there is;
/// what it says in the intergreen is not heard, and the plan below may show a stage that it has not asked for.

#pragma once

#include "core.hpp"

#include <algorithm>

namespace elmopp {

/// The core's chooser of a rule. The rule must stay where it is as long as the chooser is used.
template <typename Rule> elmopp_chooser_t plug(Rule &rule) {
    const auto choose = [](void *state, const elmopp_view_t *view, float *score) {
        std::fill_n(score, ELMOPP_STAGE_MAX, 0.0F);
        return static_cast<Rule *>(state)->choose(*view, score);
    };
    return {choose, &rule, 0};
}

/// A chooser with its state. Not movable: the core's pointer leads into it.
struct Plugged {
    Plugged() = default;
    Plugged(const Plugged &) = delete;
    Plugged &operator=(const Plugged &) = delete;
    virtual ~Plugged() = default;

    elmopp_chooser_t chooser{};
};

template <typename State> struct PluggedAs final : Plugged {
    explicit PluggedAs(State from) : state(std::move(from)) {}

    State state;
};

} // namespace elmopp
