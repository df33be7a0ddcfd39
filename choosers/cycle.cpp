// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "cycle.hpp"

#include "view.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

namespace elmopp {
namespace {

/// Positions that serve a movement.
std::vector<std::size_t> positions_of(const Cycle &cycle, const elmopp_junction_t &junction, std::uint32_t movement) {
    std::vector<std::size_t> positions;
    positions.reserve(cycle.size());
    for (std::size_t i = 0; i < cycle.size(); ++i) {
        if (elmopp_junction_goes(&junction, movement, junction.stage_groups[cycle.stage(i)])) {
            positions.push_back(i);
        }
    }
    return positions;
}

/// Looks for the smallest covers: whoever is missing first has to be served by one of his stages.
class Covers {
  public:
    explicit Covers(const elmopp_junction_t &junction) {
        served_.reserve(junction.stage_count);
        for (elmopp_stage_t s = 0; s < junction.stage_count; ++s) {
            served_.push_back(served_by(junction, s));
            all_ |= served_.back();
        }
    }

    /// Covers of this size, none if there is none or the search has become too long.
    const std::set<std::vector<elmopp_stage_t>> &of_size(std::size_t size) {
        look(all_, size);
        return found_;
    }

  private:
    static constexpr unsigned longest_search = 100000;
    static constexpr std::size_t most = 8;

    void look(std::uint32_t missing, std::size_t more) {
        if (missing == 0) {
            auto cover = chosen_;
            std::sort(cover.begin(), cover.end());
            found_.insert(std::move(cover));
            return;
        }
        const std::uint32_t first = missing & (~missing + 1U);
        for (std::size_t s = 0; more > 0 && s < served_.size(); ++s) {
            if ((served_[s] & first) != 0 && found_.size() < most && ++steps_ < longest_search) {
                chosen_.push_back(static_cast<elmopp_stage_t>(s));
                look(missing & ~served_[s], more - 1);
                chosen_.pop_back();
            }
        }
    }

    std::vector<std::uint32_t> served_; ///< [stage] mask of movements
    std::uint32_t all_ = 0;
    unsigned steps_ = 0;
    std::vector<elmopp_stage_t> chosen_;
    std::set<std::vector<elmopp_stage_t>> found_;
};

double lost_in_s(const elmopp_junction_t &junction, const std::vector<elmopp_stage_t> &stages) {
    double lost_s = 0.0;
    for (std::size_t i = 0; stages.size() > 1 && i < stages.size(); ++i) {
        lost_s += switch_s(junction, stages[i], stages[(i + 1) % stages.size()]);
    }
    return lost_s;
}

int movements_in(const elmopp_junction_t &junction, const std::vector<elmopp_stage_t> &stages) {
    int count = 0;
    for (const elmopp_stage_t stage : stages) {
        for (std::uint32_t j = 0; j < junction.movement_count; ++j) {
            count += elmopp_mask_has(served_by(junction, stage), j) ? 1 : 0;
        }
    }
    return count;
}

} // namespace

std::vector<std::vector<elmopp_stage_t>> smallest_cycles(const elmopp_junction_t &junction) {
    Covers covers(junction);
    const auto covering = covering_cycle(junction);
    for (std::size_t size = 1; size <= covering.size(); ++size) {
        const auto &found = covers.of_size(size);
        if (!found.empty()) {
            return {found.begin(), found.end()};
        }
    }
    return {covering}; // too many stages to try
}

std::vector<elmopp_stage_t> covering_cycle(const elmopp_junction_t &junction) {
    std::vector<elmopp_stage_t> cycle;
    std::uint32_t covered = 0;
    for (std::size_t s = 0; s < junction.stage_count; ++s) {
        const std::uint32_t served = elmopp_junction_served(&junction, junction.stage_groups[s]);
        if ((served & ~covered) != 0) {
            cycle.push_back(static_cast<elmopp_stage_t>(s));
            covered |= served;
        }
    }
    return cycle;
}

void Cycle::prepare(const elmopp_junction_t &junction) {
    if (!stages_.empty()) {
        return;
    }
    const auto better = [&junction](const auto &a, const auto &b) {
        const int more = movements_in(junction, a) - movements_in(junction, b);
        return more != 0 ? more > 0 : lost_in_s(junction, a) < lost_in_s(junction, b);
    };
    const auto cycles = smallest_cycles(junction);
    stages_ = *std::min_element(cycles.begin(), cycles.end(), better);
}

std::size_t Cycle::position(const elmopp_view_t &view) {
    const auto here = std::find(stages_.begin(), stages_.end(), view.target);
    if (here != stages_.end()) {
        position_ = static_cast<std::size_t>(here - stages_.begin());
    }
    return position_;
}

bool Cycle::shows(const elmopp_view_t &view) const {
    return std::find(stages_.begin(), stages_.end(), view.stage) != stages_.end();
}

double Cycle::lost_s(const elmopp_junction_t &junction) const {
    return lost_in_s(junction, stages_);
}

double Cycle::startup_of_s(const elmopp_junction_t &junction, std::size_t position) const {
    return size() > 1 ? new_startup_s(junction, stage(position + size() - 1), stage(position)) : 0.0;
}

std::vector<unsigned> Cycle::min_greens_s(const elmopp_junction_t &junction) const {
    constexpr unsigned shortest_s = 5;
    std::vector<unsigned> greens_s(size());
    for (std::size_t i = 0; i < size(); ++i) {
        greens_s[i] = std::max(shortest_s, min_green_s(junction, stage(i)));
    }
    return greens_s;
}

std::vector<double> flow_ratios(const Cycle &cycle, const elmopp_junction_t &junction,
                                const std::vector<double> &flow_veh_per_s) {
    std::vector<double> ratio(cycle.size());
    // Movements with fewer stages first: the others may find that they are served well enough beside them.
    for (std::size_t stages = 1; stages <= cycle.size(); ++stages) {
        for (std::uint32_t j = 0; j < junction.movement_count; ++j) {
            const auto positions = positions_of(cycle, junction, j);
            if (positions.size() != stages) {
                continue;
            }
            double served = 0.0;
            for (const std::size_t i : positions) {
                served += ratio[i];
            }
            const double missing = flow_veh_per_s[j] / saturation_veh_per_s(junction, j) - served;
            for (const std::size_t i : positions) {
                ratio[i] += std::max(0.0, missing) / static_cast<double>(stages);
            }
        }
    }
    return ratio;
}

std::vector<unsigned> share_greens_s(const Cycle &cycle, const elmopp_junction_t &junction, double cycle_s,
                                     const std::vector<double> &weights) {
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    const double usable_s = std::max(0.0, cycle_s - cycle.lost_s(junction));
    auto greens_s = cycle.min_greens_s(junction);
    for (std::size_t i = 0; i < greens_s.size(); ++i) {
        const double share = sum > 0.0 ? weights[i] / sum : 1.0 / static_cast<double>(greens_s.size());
        const double green_s = usable_s * share + cycle.startup_of_s(junction, i);
        greens_s[i] = std::max(greens_s[i], static_cast<unsigned>(std::lround(green_s)));
    }
    return greens_s;
}

} // namespace elmopp
