// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Film: the camera of one approach and the counter behind it, in front of the drawn road.
///
/// Turns places of vehicles into bodies of the drawing, knows which of them crossed the counting line of which lane,
/// and lets the counter look at every picture with its defaults and a lane file that is made of the drawing's geometry.
/// What can go wrong with a camera goes wrong here: black, frozen, turned away, gone.
///
/// The mast stands 24 m before the edge of the counted reach and looks along the traffic, so that the line is where
/// vehicles are large and is the edge at which the controller wants arrivals counted; the zone reaches to the stop
/// line. Owner: the loop. Not thread-safe.

#pragma once

#include "counter.hpp"
#include "places.hpp"
#include "road_view.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace elmopp {

enum class CameraTrouble { none, black, freeze, turn, gone };

struct LaneTally {
    std::string lane;
    std::size_t movement;
    std::int64_t crossed; ///< in truth
    std::int64_t counted; ///< by the camera
};

class Film {
  public:
    /// Writes the lane file to `lane_file` and reads it back. The site must outlive it.
    Film(const elmopp_junction_t &site, std::size_t approach, const std::string &scene, std::uint64_t seed,
         const std::filesystem::path &lane_file);

    /// The next picture, at `t_s` of the camera's own clock.
    void look(const std::vector<Place> &places, const elmopp_lamps_t &lamps, CameraTrouble trouble, double t_s);

    /// Closes a second.
    Record record();

    /// The video is over: what is on a line ends.
    void finish();

    /// Crossings from now on are compared; what came before is the start-up's.
    void begin();

    [[nodiscard]] std::vector<LaneTally> tally() const;

    /// Vehicles that the zones hold in truth, [movement of the site].
    [[nodiscard]] std::vector<int> present(const std::vector<Place> &places) const;

    [[nodiscard]] std::size_t approach() const {
        return approach_;
    }
    [[nodiscard]] const LaneFile &lanes() const {
        return lanes_;
    }

    /// The last picture with what the counter makes of it.
    [[nodiscard]] cv::Mat drawn() const;

    /// ... and as the camera saw it.
    [[nodiscard]] const cv::Mat &picture() const {
        return picture_;
    }

  private:
    struct PavementLane {
        std::size_t movement;
        std::string name;
    };

    [[nodiscard]] RoadBody body_of(const Place &place) const;
    void write_lanes(const std::filesystem::path &file) const;
    void see_crossings(const std::vector<Place> &places);

    const elmopp_junction_t &site_;
    std::size_t approach_;
    std::vector<PavementLane> pavement_;
    double line_m_; ///< before the stop line
    RoadView view_;
    LaneFile lanes_;
    std::unique_ptr<Counter> counter_; ///< after the lane file
    Record last_;
    cv::Mat picture_;
    std::map<std::uint64_t, double> before_m_; ///< front of those that have not crossed the line
    std::vector<std::int64_t> crossed_;        ///< [pavement lane]
    std::vector<std::int64_t> begun_counted_;  ///< the counter's when begin() was called
};

} // namespace elmopp
