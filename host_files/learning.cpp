// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "learning.hpp"

namespace elmopp {

std::string network_of(const std::string &forecast) {
    for (const std::string way : {"-learn", "-literal"}) {
        const std::size_t at = forecast.find(way);
        if (at != std::string::npos) {
            return forecast.substr(0, at);
        }
    }
    return forecast;
}

Learning::Learning(const elmopp_weights_t &shipped, elmopp_learner_course_t course, std::uint32_t approaches) {
    elmopp_learner_init(&learner_, &memory_, &inner_, &shipped, course, approaches);
}

std::unique_ptr<Learning> make_learning(const std::string &forecast, const elmopp_weights_t *weights,
                                        std::uint32_t approaches) {
    if (weights == nullptr || network_of(forecast) == forecast) {
        return nullptr;
    }
    const bool literal = forecast == "lstm-literal";
    return std::make_unique<Learning>(*weights, literal ? ELMOPP_LEARNER_LITERAL : ELMOPP_LEARNER_CAREFUL, approaches);
}

elmopp_learner_t *learner_of(const std::unique_ptr<Learning> &learning) {
    return learning ? learning->learner() : nullptr;
}

} // namespace elmopp
