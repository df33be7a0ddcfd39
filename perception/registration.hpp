// SPDX-License-Identifier: Apache-2.0
// Copyright 2026 The ELMOPP authors

/// Where the picture has moved to, and how much brighter it has become: what the whole camera does, so that the lanes
/// need not take it for traffic.
///
/// Shift: small pieces of the picture outside of the lanes are looked for around the last shift; most of those that
/// are found must agree. A shift that nobody agrees on is held, and says so. The first picture stays the anchor: pieces
/// are taken anew only when most have gone, from where they are then, so that a long drift cannot run away. A picture
/// whose pieces are not found again from the start cannot be followed, and is taken to stay where it is.
/// Gain: median change of the logarithm of grey from frame to frame, summed.
/// Doubt: after a cut or a long pause hold() keeps pieces, place and light as they were before the last picture, and
/// nothing that follows may renew them. Then fits() says whether the camera sees again what it saw: half of the pieces
/// are found about where they were, and beside the lanes the light has not changed but for its brightness. recover()
/// goes on from there, release() forgets it.
///
/// Owner: the counter. Not thread-safe.

#pragma once

#include <opencv2/core.hpp>

#include <vector>

namespace elmopp {

class Registration {
  public:
    /// `traffic`: 255 where vehicles move, in the size of the picture.
    explicit Registration(const cv::Mat &traffic);

    struct Result {
        cv::Point2d shift_px;   ///< of the content, since the anchor
        double gain = 0.0;      ///< logarithm of the brightness, since the anchor
        double gain_step = 0.0; ///< of this frame
        double agreement = 0.0; ///< share of the pieces that agree on the shift
        double change = 0.0;    ///< mean change of the picture without gain, 100 x log
        bool sure = false;      ///< the shift is known
    };

    Result follow(const cv::Mat &bgr);

    /// The last picture is in doubt; see above.
    void hold();

    /// While held: the last picture shows what was seen before it was held.
    [[nodiscard]] bool fits() const;

    /// What was held is seen again. Returns the gain, since the anchor, without what the pictures of doubt added to it.
    double recover();

    /// What was held is seen no more: the present brightness is gain 0.
    void release();

    /// False of a picture that cannot be followed: nobody can say where it is.
    [[nodiscard]] bool followed() const;

    /// The present brightness is gain 0 from here on; returns what it was.
    double rebase() {
        const double gain = light_.gain;
        light_.gain = 0;
        return gain;
    }

  private:
    struct Piece {
        cv::Point at;
        cv::Mat look;
    };

    struct Light {
        cv::Mat bright;    ///< logarithm of grey, in cells, at the place of the anchor
        cv::Mat factor;    ///< the same with an offset that leaves the factor of the dark
        double gain = 0.0; ///< logarithm of the brightness, since the anchor
    };
    struct Known {
        Light light;
        cv::Point2d at; ///< shift in small pixels, since the anchor
    };

    void capture(const cv::Mat &grey);
    bool vote(const cv::Mat &grey, int reach, Result &result);
    void renew_pieces(const cv::Mat &grey, const Result &result);
    void prove_pieces(bool sure);
    void follow_gain(const cv::Mat &grey, Result &result);

    double scale_ = 1.0;
    cv::Mat traffic_;
    std::vector<Piece> pieces_;
    cv::Point2d base_; ///< shift at which the pieces were taken, in small pixels
    cv::Point2d last_; ///< shift in small pixels, since the anchor
    cv::Mat beside_;   ///< 255 in the cells of the light beside the lanes
    Light light_;      ///< of the last picture
    Known known_;      ///< what was seen before the last picture, or before it was held
    bool held_ = false;
    double agreement_ = 0.0; ///< of the last picture; 0: nobody agreed
    int astray_ = 0;         ///< frames without agreement
    int tried_ = 0;          ///< frames since the pieces were taken
    int found_ = 0;          ///< ... in which they agreed
    int few_ = 0;            ///< frames in which few pieces agreed
};

} // namespace elmopp
