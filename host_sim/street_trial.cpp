// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

#include "street_trial.hpp"

#include "jobs.hpp"
#include "signals.hpp"

#include <algorithm>

namespace elmopp {
namespace {

/// One junction's lamps and what the metrics keep of them.
class Post {
  public:
    explicit Post(const Site &site)
        : site_(site), signals_(site.scenario.junction), red_s_(site.scenario.junction.movement_count),
          waited_s_(red_s_.size()) {}

    std::uint32_t lamp_tick() {
        lamps_ = site_.control.lamp_tick();
        signals_.show(lamps_);
        return signals_.open();
    }

    void end_second(const Streets &streets, std::size_t junction) {
        for (std::size_t j = 0; j < red_s_.size(); ++j) {
            red_s_[j] = signals_.red_s(j);
            waited_s_[j] = red_s_[j] > 0.0 && streets.late_veh(junction, j) > 0 ? waited_s_[j] + 1.0 : 0.0;
            longest_red_s_ = std::max(longest_red_s_, std::min(red_s_[j], waited_s_[j]));
        }
        switches_.see(site_.control.told().stage);
    }

    void add_to(Metrics &metrics) const {
        metrics.switches += switches_.count();
        metrics.longest_red_s = std::max(metrics.longest_red_s, longest_red_s_);
    }

    [[nodiscard]] const elmopp_lamps_t &lamps() const {
        return lamps_;
    }
    [[nodiscard]] const std::vector<double> &red_s() const {
        return red_s_;
    }

  private:
    const Site &site_;
    Signals signals_;
    elmopp_lamps_t lamps_{};
    std::vector<double> red_s_;
    std::vector<double> waited_s_; ///< on red, without a break
    double longest_red_s_ = 0.0;
    Switches switches_;
};

Metrics totals(const Streets &streets, std::size_t seconds, double out_squared) {
    Metrics metrics = metrics_of({static_cast<double>(streets.total_in_veh()),
                                  static_cast<double>(streets.total_out_veh()), out_squared, streets.delay_veh_s()},
                                 seconds);
    metrics.vehicles_queued = static_cast<double>(streets.inside_veh());
    metrics.vehicles_outside = static_cast<double>(streets.outside_veh());
    metrics.longest_wait_s = streets.longest_wait_s();
    return metrics;
}

} // namespace

Metrics run_streets(const StreetPlan &plan, const std::vector<Site> &sites, std::size_t seconds,
                    const Observer &observer, const Neighbours &neighbours, const Spectator &spectator) {
    std::vector<Comings> comings;
    std::vector<Post> posts;
    comings.reserve(sites.size());
    posts.reserve(sites.size());
    for (const auto &site : sites) {
        comings.push_back(site.demand.comings);
        posts.emplace_back(site);
    }
    Streets streets(plan, std::move(comings));
    std::vector<std::uint32_t> open(sites.size());
    double out_squared = 0.0;
    if (spectator) {
        spectator(streets);
    }
    for (std::size_t t = 0; t < seconds; ++t) {
        check_interrupt();
        if (neighbours) {
            neighbours(streets);
        }
        for (std::size_t v = 0; v < sites.size(); ++v) {
            sites[v].control.count(streets.counts(v), t);
        }
        const auto out_before = static_cast<double>(streets.total_out_veh());
        streets.begin_second();
        for (unsigned tick = 0; tick < ELMOPP_LAMP_TICKS_PER_S; ++tick) {
            for (std::size_t v = 0; v < sites.size(); ++v) {
                open[v] = posts[v].lamp_tick();
            }
            streets.tick(open);
            if (spectator) {
                spectator(streets);
            }
        }
        streets.end_second();
        streets.check_conservation();
        const double out = static_cast<double>(streets.total_out_veh()) - out_before;
        out_squared += out * out;
        for (std::size_t v = 0; v < sites.size(); ++v) {
            posts[v].end_second(streets, v);
        }
        if (observer) {
            observer({t, sites[0].control.told(), posts[0].lamps(), streets.counts(0), posts[0].red_s()});
        }
    }
    Metrics metrics = totals(streets, seconds, out_squared);
    for (const auto &post : posts) {
        post.add_to(metrics);
    }
    return metrics;
}

} // namespace elmopp
