// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// A section: the lines of neighbouring lanes, and what crosses them.
///
/// The mask of objects at the line, row by row, is a picture of its own: columns across the lanes, progress along them.
/// A vehicle is a blob there. Blobs that belong to several vehicles are split at their necks, the parts get the lane on
/// which they touch the road, and fragments of one vehicle are joined.
///
/// Progress, not time: a row counts for as much as the lane has moved (Odometer). While a lane stands, its blobs
/// neither grow nor end, so that a vehicle that stops on the line, flickers or rocks there is one vehicle.
///
/// Direction: a blob that comes from behind the line and leaves before it does not count, nor does one that the
/// odometer has seen move backwards.
///
/// A crossing is reported when its blob has ended, about half a vehicle after it. Owner: the counter. Not thread-safe.

#pragma once

#include "background.hpp"
#include "lanes.hpp"
#include "odometer.hpp"
#include "patch.hpp"

#include <deque>
#include <memory>
#include <vector>

namespace elmopp {

/// A vehicle crossed the line of a lane.
struct Crossing {
    std::int64_t frame = 0; ///< in which its middle was on the line
    int lane = 0;           ///< index in the section, later in the lane file
    double t_s = 0.0;       ///< time of that frame
    double confidence = 1.0;
};

class Section {
  public:
    /// `lanes`: side by side, all of one direction.
    Section(const std::vector<Lane> &lanes, cv::Size picture, const Settings &settings = Settings{});

    [[nodiscard]] const Patch &patch() const {
        return patch_;
    }

    [[nodiscard]] Background &background() {
        return background_;
    }
    [[nodiscard]] const Background &background() const {
        return background_;
    }

    /// One picture of the patch. Background::learn() must have been called.
    void feed(const Background::Sample &sample, std::int64_t frame, double t_s, double dt_s);

    /// Everything that is on the line ends here: the scene is cut, or over.
    void close();

    /// Frames are missing: what is on the line is no longer known, the road still is.
    void interrupt();

    /// What has crossed since the last call.
    std::vector<Crossing> take();

    /// True if a vehicle covers the line of this lane.
    [[nodiscard]] bool covered(int lane) const {
        return covered_[static_cast<std::size_t>(lane)];
    }

    /// Whether the lane stands with a vehicle on its line.
    [[nodiscard]] bool standing(int lane) const;

    /// What the last picture showed, for the overlay.
    [[nodiscard]] const Background::Seen &seen() const {
        return seen_;
    }

  private:
    struct Run {
        double position; ///< progress at the end of this row
        double progress; ///< of this row
        std::int64_t frame;
        double t_s;
        int first;
        int last;
        double behind; ///< share of these columns that is covered behind the line, less that before it
    };
    struct Row {
        cv::Mat mean;   ///< of the mask at the line
        cv::Mat object; ///< the mask
        std::int64_t frame;
        double t_s;
    };
    struct Blob {
        std::vector<Run> runs;
        double position = 0.0;
        bool open = true;
        double moved = 0.0; ///< signed rows, where the odometer is sure
        int forwards = 0;   ///< measured steps in the direction of the lane
        int backwards = 0;  ///< ... and against it
    };
    struct Part {
        int lane = 0;
        double centre = 0.0; ///< lanes from the left edge of the section
        double left = 0.0;
        double right = 0.0;
        double area = 0.0; ///< lanes x typical vehicles
        double length = 0.0;
        std::int64_t frame = 0;
        double t_s = 0.0;
        double from_s = 0.0;
        double until_s = 0.0;
        double confidence = 1.0;
    };

    cv::Mat line_row(const cv::Mat &object, double dt_s);
    void grow(const cv::Mat &row, const Row &seen);
    int join_short(cv::Mat &labels, int many) const;
    void end(Blob &blob);
    [[nodiscard]] static double passage(const Blob &blob);
    [[nodiscard]] static bool against(const Blob &blob);
    cv::Mat draw(const Blob &blob, double scale, std::vector<const Run *> &row_runs, int &left) const;
    bool side_by_side(const cv::Mat &mine, const cv::Rect &box, const std::vector<const Run *> &row_runs, int left,
                      const Part &whole, std::vector<Part> &parts) const;
    void parts_of(const cv::Mat &labels, int label, const std::vector<const Run *> &row_runs, int left, double scale,
                  std::vector<Part> &parts) const;
    void guess_typical();
    void settle(double now_s);
    void learn_typical(const Part &part, double seconds);
    [[nodiscard]] bool stands(int first, int last) const;
    [[nodiscard]] double progress_of(int first, int last) const;

    std::vector<Lane> lanes_;
    Settings settings_;
    Patch patch_;
    Background background_;
    std::vector<Odometer> odometers_;
    Background::Seen seen_;
    std::deque<Row> rows_; ///< to be averaged over time
    std::vector<Blob> blobs_;
    std::vector<std::pair<std::size_t, std::pair<int, int>>> tips_; ///< blob and columns of the last row
    std::vector<Part> waiting_;
    std::vector<Crossing> done_;
    std::deque<double> durations_; ///< of single vehicles, progress in seconds
    std::deque<double> areas_;
    std::vector<bool> covered_;
    double typical_s_ = 0.5;
    double dt_s_ = 0.04;
};

} // namespace elmopp
