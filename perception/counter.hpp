// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// The counter of one camera: frames in, records per lane out. No input, no output, no clock: time comes with the
/// frames.
///
/// After each start and each cut of the scene it learns for three seconds; those frames are kept and counted
/// afterwards, so that nothing of them is lost, only late. What is made of them is made over the frames that follow, so
/// that no frame takes long: a lane more, or a zone, takes some tenths of a second more until all is known. (Only a
/// cut that comes while kept frames are still being counted has the rest of them counted at once.) The same frames give
/// the same records, bit for bit.
///
/// A cut, and a pause of more than 60 s, put the known road in doubt (`learning`; such pictures count for nothing). It
/// is taken back as soon as the picture fits what was there before: half of the registration's pieces where they were,
/// at most 15 pixels from home, and at most a quarter of the picture beside the lanes in another light, but for its
/// common brightness. So a queue may stand there. In place for 1 s without fitting, it is learnt anew; elsewhere it is
/// `moved`. After a pause of more than 600 s no road is believed: the shadow of 25 m of a low sun moves by about 1.1 m
/// (a third of a lane's width) in that time, and thinner stripes are no vehicle (Presence), but the rule for light that
/// creeps on has to see it creep. A picture that cannot be followed (Registration) is learnt anew at once in both
/// cases: where the camera stands cannot be told.
///
/// Owner: whoever reads the camera. Not thread-safe. Memory: about a hundred small patches while learning, otherwise
/// bounded by lanes and zones.

#pragma once

#include "lanes.hpp"
#include "record.hpp"
#include "registration.hpp"
#include "section.hpp"

#include <opencv2/core.hpp>

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace elmopp {

class Counter {
  public:
    explicit Counter(const LaneFile &file, const Settings &settings = Settings{});
    ~Counter();
    Counter(const Counter &) = delete;
    Counter &operator=(const Counter &) = delete;
    Counter(Counter &&) = delete;
    Counter &operator=(Counter &&) = delete;

    /// Vehicles of a BGR picture as boxes, in its pixels.
    using Finder = std::function<std::vector<cv::Rect2d>(const cv::Mat &)>;

    /// Vehicles are what this one finds, in place of what differs from the road. Before the first frame.
    void find_with(Finder finder);

    /// A picture of the empty road, in the size of the lane file: nothing need be learnt. Before the first frame.
    void reference(const cv::Mat &bgr);

    /// The next frame, BGR with 8 bits each, taken at `t_s`. Times may jump; a step that is no step of a video is taken
    /// for the usual one. An empty frame and one of another size count as none.
    void feed(const cv::Mat &bgr, double t_s);

    /// There is no picture at `t_s`.
    void miss(double t_s);

    /// The video is over: what is on the line ends. Nothing is fed afterwards; the last record is of how things were.
    void finish();

    /// Crossings that have become known since the last call, with indices of the lane file.
    std::vector<Crossing> take_crossings();

    /// Closes a second: what has come since the last record, and what is there now.
    Record record();

    /// What is there now, without closing a second: inflow and occupancy go on.
    [[nodiscard]] Record glance() const;

    /// Draws lanes, zones, counts and flags on a frame of the same size.
    void draw(cv::Mat &bgr, const Record &record) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace elmopp
