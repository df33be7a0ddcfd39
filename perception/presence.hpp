// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Vehicles present in the zone of one lane: how many are there, moving or standing, for as long as they stand.
///
/// Rows of the zone that vehicles cover are held in the background, so a queue is never absorbed. How many vehicles a
/// covered stretch is comes from perspective: the view angle of each row follows from how fast the zone grows towards
/// the camera, and gives a standing vehicle's length and pitch there. Entries and exits at the line refine it, within
/// bounds.
///
/// Stretches that were full of edges while the road was learnt may be a queue or a marking. They count as vehicles and
/// are `unknown` until something has moved there. Owner: the counter. Not thread-safe.

#pragma once

#include "background.hpp"
#include "lanes.hpp"
#include "patch.hpp"

#include <deque>
#include <vector>

namespace elmopp {

class Presence {
  public:
    Presence(const Lane &lane, cv::Size picture, const Settings &settings = Settings{});

    [[nodiscard]] const Patch &patch() const {
        return patch_;
    }

    /// Before the road is known: takes this one picture for it.
    void assume(const Background::Sample &sample);

    void learn(const std::vector<Background::Sample> &samples);

    /// In pieces; see Background.
    void begin(const std::vector<Background::Sample> &samples);
    bool learn_more(int &pixels);

    /// What was learnt is the empty road: nothing is unknown.
    void known();

    void feed(const Background::Sample &sample, double dt_s);

    /// See Background.
    void rebase(double gain) {
        background_.rebase(gain);
    }

    /// Vehicles that crossed the lane's own line.
    void crossed(int vehicles);

    [[nodiscard]] int present() const;

    /// True while rows of the zone were never seen empty.
    [[nodiscard]] bool unknown() const;

    /// Share of the zone that vehicles cover.
    [[nodiscard]] double covered_share() const;

  private:
    struct Stretch {
        int first;
        int last;
    };

    void find_unknown();
    void clear_moved(const std::vector<Background::Sample> &samples);
    void clear_unknown(const Background::Seen &seen, double dt_s);
    [[nodiscard]] std::vector<char> rows_passed(const cv::Mat &moving) const;
    void find_covered(const Background::Seen &seen);
    void balance(double dt_s);
    [[nodiscard]] std::vector<Stretch> stretches() const;
    void calibrate(const std::vector<Stretch> &found);
    [[nodiscard]] double length_m(const Stretch &stretch) const;
    [[nodiscard]] double away_m(int row) const;
    [[nodiscard]] double vehicles_in(const Stretch &stretch) const;
    [[nodiscard]] double textured(const cv::Mat &texture, int row) const;

    Patch patch_;
    Background background_;
    std::vector<double> vehicle_rows_; ///< [row] one vehicle's length
    std::vector<char> covered_;
    std::vector<char> unknown_;
    std::vector<double> quiet_s_;            ///< [row] since something moved there; negative: nothing ever has
    std::vector<Background::Sample> lesson_; ///< what is being learnt
    cv::Mat before_;
    double line_at_ = 1.0; ///< where along the zone the lane's line is, 0 to 1
    double count_ = 0.0;
    double empty_s_ = 0.0;
    double outside_s_ = 0.0;
    double focal_px_ = 1.0;
    double camera_m_ = 8.0;        ///< above the road
    bool near_is_last_ = true;     ///< the last row is nearest to the camera
    std::deque<double> lengths_m_; ///< of single vehicles, as measured
    double scale_ = 1.0;           ///< metres measured for a metre
    int last_middle_ = -1;
    int left_ = 0; ///< vehicles that have just left
    double left_s_ = 1e9;
    bool started_ = false;
};

} // namespace elmopp
