// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Learning: the memory of a network that learns on, for the forecasts whose name says so.
///
///     lstm-learn, nlstm-learn   learns with care, behind a guard (elmopp/learner.h)
///     lstm-literal              learns as the paper has it: for the record

#pragma once

#include "core.hpp"

#include <memory>
#include <string>

namespace elmopp {

/// The network of a forecast: `lstm` for `lstm-learn`; the name itself for one that does not learn.
std::string network_of(const std::string &forecast);

/// A learner with its memory. Not copied: the core keeps pointers into it.
class Learning {
  public:
    Learning(const elmopp_weights_t &shipped, elmopp_learner_course_t course, std::uint32_t approaches);
    Learning(const Learning &) = delete;
    Learning &operator=(const Learning &) = delete;
    ~Learning() = default;

    [[nodiscard]] elmopp_learner_t *learner() {
        return &learner_;
    }

  private:
    elmopp_trainer_memory_t memory_{};
    elmopp_trainer_inner_memory_t inner_{};
    elmopp_learner_t learner_{};
};

/// Null for a forecast that does not learn, or without weights.
std::unique_ptr<Learning> make_learning(const std::string &forecast, const elmopp_weights_t *weights,
                                        std::uint32_t approaches);

/// For a forecast's configuration; null for none.
elmopp_learner_t *learner_of(const std::unique_ptr<Learning> &learning);

} // namespace elmopp
