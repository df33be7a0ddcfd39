// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// What the road of one patch looks like without vehicles, and what stands or drives on it now.
///
/// Vehicles are texture: the high-pass of the logarithm of picture over road. It is blind to what is smooth, the inside
/// of shadows, the cones of headlights, exposure. Colour and, by day, plain brightness help.
///
/// The road is learnt from a few seconds as the mode of each pixel, which stands traffic for more than half of them.
/// Afterwards it renews itself only where nothing stands: never under an object, never in a row that is covered. So a
/// vehicle is never absorbed, however long it stands. Three exceptions: specks that do not move; ghosts, that is
/// vehicles that the road was learnt with and that have left (the road has more edges than the picture); and what
/// became an object while nothing moved, light that has crept on.
///
/// What is more than noise is judged by the noise of each pixel: a sensor's grey values are about equally uncertain, so
/// that their logarithms are the more so the darker the road is, and a patch that is drawn between pixels evens noise
/// out where it falls between four of them and not where it falls on one.
///
/// Lengths are in lane widths of patch_unit pixels, times in seconds. Owner: a section or a zone. Not thread-safe.

#pragma once

#include "settings.hpp"

#include <opencv2/core.hpp>

#include <optional>
#include <vector>

namespace elmopp {

class Background {
  public:
    /// `valid`: 255 where a pixel counts.
    explicit Background(cv::Mat valid, const Settings &settings = Settings{});

    /// What a picture shows, in the size of the patch.
    struct Seen {
        cv::Mat light;     ///< logarithm of grey as it would be at gain 0
        cv::Mat red;       ///< logarithm of red over green
        cv::Mat blue;      ///< ... of blue over green
        cv::Mat object;    ///< 255: a vehicle
        cv::Mat candidate; ///< 255: not the road as it was, vehicle, shadow or light
        cv::Mat change;    ///< light over the road's, without what is common to both
        double gain = 0.0;
        cv::Mat covered; ///< [row] 255 if a vehicle covers the row (a column of one)
    };

    struct Sample {
        cv::Mat patch; ///< BGR
        double gain = 0.0;
        cv::Mat objects;    ///< 255 where vehicles were found by somebody else; empty: to be found here
        double clear = 1.0; ///< share of the usual contrast that the picture has (Haze)
    };

    /// Learns the road from these pictures of it, in the order of time.
    void learn(const std::vector<Sample> &samples);

    /// The same in pieces, as no frame may take long: begin(), then learn_more() until it returns true. Each takes the
    /// pixels that it has worked on from `pixels`, and does nothing when none are left. Until then the road is what it
    /// was.
    void begin(const std::vector<Sample> &samples);
    bool learn_more(int &pixels);

    /// Takes one picture for the road, until learn().
    void assume(const Sample &sample);

    [[nodiscard]] bool learnt() const {
        return learnt_;
    }

    [[nodiscard]] bool day() const {
        return day_;
    }

    [[nodiscard]] float noise() const {
        return noise_;
    }

    /// High-pass of the road, for whoever asks whether something stood there while it was learnt.
    [[nodiscard]] cv::Mat road_texture() const;

    Seen look(const Sample &sample);

    /// `seen` came `dt_s` after the last one. `held`: rows that are held whatever is seen there (a column), or empty.
    /// `ghost_s`: how long a ghost must have been still.
    void renew(const Seen &seen, double dt_s, const cv::Mat &held, double ghost_s);

    /// Gains count from here on: the road is taken over into the light of this gain.
    void rebase(double gain);

    /// Logarithms of a patch, in the light in which gain was 0.
    static void logarithms(const Sample &sample, Seen &seen);

  private:
    /// What is being learnt.
    struct Lesson {
        std::vector<Sample> samples;
        std::vector<Seen> views; ///< of some of them
        cv::Mat light;
        cv::Mat red;
        cv::Mat blue;
        int row = 0; ///< the next one
    };

    void learn_row(Lesson &lesson) const;
    void learn_noise(const std::vector<Sample> &samples);
    void follow_noise(const cv::Mat &step, double share);
    [[nodiscard]] cv::Mat beside_sharp(const cv::Mat &texture, const cv::Mat &change) const;
    void judge_road();
    void follow_crept(const Seen &seen);
    [[nodiscard]] cv::Mat ghosts(const Seen &seen, double ghost_s) const;

    cv::Mat valid_;
    Settings settings_;
    std::optional<Lesson> lesson_;
    cv::Mat light_;
    cv::Mat red_;
    cv::Mat blue_;
    cv::Mat before_; ///< light of the last picture
    cv::Mat still_s_;
    cv::Mat crept_;         ///< 255: an object that nothing brought
    cv::Mat object_before_; ///< objects of the last picture
    cv::Mat grain_;         ///< noise of each pixel
    float noise_ = 0.02F;   ///< ... and of most of them
    double grey_ = 100.0;
    double gain_ = 0.0; ///< of the last second
    double judged_s_ = 0.0;
    int fine_ = 7;
    bool day_ = true;
    bool learnt_ = false;
};

} // namespace elmopp
